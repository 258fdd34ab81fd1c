"""grainfield: tracking, simulation and analysis of vibrated granular layers.

Find and follow spheres in frames, measure how they order, simulate such layers and film them::

    import grainfield as gf

    features = gf.batch(frames)                    # frames: arrays, a generator, a film's path
    tracks = gf.link(features, search_range=5)
    order = gf.q4(tracks, diameter=12.0)

Tables of points have the columns of trackpy (x, y, frame, particle) and x_std, y_std, layer,
quality. Options are the keyword arguments that ``gf.options("track")`` lists. Lengths of frames are
pixels: pixel centres at integers, y down. Results are in units of the sphere diameter a.
"""
from . import _grainfield
from ._grainfield import (Error, GrainfieldWarning, InputError, OptionError, OutputError,
                          PhysicsError)
from ._options import options
from .analysis import (Measurement, Observable, Results, analyze, bond_order, compare,
                       fit_hyperuniform, msd, number_variance, pair_distribution, q4, read_results,
                       structure_factor)
from .motion import compute_drift, emsd, filter_stubs, imsd, subtract_drift
from .napari import to_napari
from .simulation import FieldSeries, RenderedFilm, render, simulate_field, simulate_md
from .plots import annotate, plot_traj
from .tracking import batch, link, link_df, link_df_iter, locate, track
from .trajectory import Trajectory, read
from . import predict

__version__: str = _grainfield.version

__all__ = [
    "Error", "FieldSeries", "GrainfieldWarning", "InputError", "Measurement", "Observable",
    "OptionError", "OutputError", "PhysicsError", "RenderedFilm", "Results", "Trajectory",
    "analyze", "annotate", "batch", "bond_order", "compare", "compute_drift", "emsd", "filter_stubs",
    "fit_hyperuniform", "imsd", "link", "link_df", "link_df_iter", "locate", "msd", "number_variance",
    "options", "pair_distribution", "plot_traj", "predict", "q4", "read", "read_results", "render",
    "simulate_field", "simulate_md", "structure_factor", "subtract_drift", "to_napari", "track",
]
