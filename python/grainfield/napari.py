"""Layers for napari."""
from __future__ import annotations

from typing import Any

import numpy as np

from . import _grainfield
from ._arrays import is_table
from .trajectory import Trajectory


def to_napari(trajectory: Any, viewer: Any = None, *, frames: Any = None) -> list[tuple]:
    """Points and tracks as napari shows them.

    Parameters
    ----------
    trajectory : Trajectory or DataFrame
        Positions in pixels.
    viewer : napari.Viewer, optional
        Gets the layers, if it is given. Without it napari need not be installed.
    frames : array, shape (frames, height, width), optional
        The film, as an image layer below them.

    Returns
    -------
    list of (data, attributes, layer type)
        napari's layer tuples: an image if there are frames; points (frame, y, x); tracks (particle,
        frame, y, x) if particles have identities.

    Raises
    ------
    InputError
        If there are no positions.
    """
    if isinstance(trajectory, Trajectory):
        columns: Any = trajectory.columns()
        diameter = float(trajectory.info["diameter"])
    elif is_table(trajectory):
        columns = {name: trajectory[name].to_numpy() for name in trajectory.columns}
        diameter = float(trajectory.attrs.get("grainfield", {}).get("diameter", 10.0))
    else:
        raise _grainfield.InputError("to_napari takes a Trajectory or a table of points, not "
                                     f"{type(trajectory).__name__}.")
    layers: list[tuple] = []
    if frames is not None:
        layers.append((frames, {"name": "frames"}, "image"))
    points = np.column_stack([columns["frame"], columns["y"], columns["x"]]).astype(float)
    features = {name: columns[name] for name in ("particle", "quality", "layer", "x_std", "y_std")
                if name in columns}
    layers.append((points, {"name": "spheres", "size": diameter, "symbol": "ring",
                            "face_color": "red", "features": features}, "points"))
    if "particle" in columns:
        tracks = np.column_stack([columns["particle"], points])
        order = np.lexsort((tracks[:, 1], tracks[:, 0]))
        layers.append((tracks[order], {"name": "tracks"}, "tracks"))
    if viewer is not None:
        for data, attributes, kind in layers:
            getattr(viewer, f"add_{kind}")(data, **attributes)
    return layers
