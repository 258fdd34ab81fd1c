"""From frames to positions and tracks."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Iterable, Iterator, Sequence

import numpy as np

from . import _grainfield
from ._arrays import (columns_to_link, film_files, is_table, pandas_module, table_of,
                      whole_frames)
from ._options import documented, from_trackpy
from .trajectory import Trajectory

if TYPE_CHECKING:
    import pandas

_FEATURES = ("x", "y", "x_std", "y_std", "layer", "quality", "frame")


def _features(trajectory: Trajectory) -> "pandas.DataFrame":
    columns = trajectory.columns()
    count = len(columns["frame"])
    absent = {"layer": np.full(count, -1, np.int8)}
    filled = {name: columns.get(name, absent.get(name, np.full(count, np.nan)))
              for name in _FEATURES}
    return table_of(filled, trajectory.info)


@documented
def locate(image: Any, diameter: float | None = None, *, mask: Any = None, threads: int = 0,
           **options: Any) -> "pandas.DataFrame":
    """Finds every sphere of one image.

    The darkness of the image is fitted by discs of one profile P(r; D, w), a tanh edge of width w
    at r = D/2, that multiply in transmission; all positions at once, by least squares. What is not
    given is estimated on the image.

    Parameters
    ----------
    image : array, shape (height, width)
        Counts of any real type that span 2 or more.
    diameter : float, optional
        Apparent diameter D of the discs [px]. It is not the odd integer of trackpy, which is larger
        than the sphere: leave it out where it is not known.
    mask : array of the same shape, optional
        Where it is zero is not looked at.
    threads : int
        0: all. Results do not depend on it.
    **options
        See below and ``gf.options("locate")``. trackpy's `invert` is understood; its words without
        a counterpart are ignored with a warning.

    Returns
    -------
    DataFrame
        x, y [px], pixel centres at integers, y down; x_std, y_std: standard errors [px]; layer: −1
        unknown, 0 bottom, 1 top; quality: RMS residual of the fit near the sphere [contrast];
        frame. There is no mass: the fit has one darkness for all spheres.

    Raises
    ------
    InputError
        If the image is not two-dimensional, empty, not finite, or spans less than 2 counts.
    OptionError
        If an option is unknown or out of range.
    """
    keywords = {"disc_diameter": diameter, **from_trackpy(options)}
    data, summary = _grainfield.locate(image, mask=mask, threads=threads, options=keywords)
    features = _features(Trajectory(data, summary))
    number = getattr(image, "frame_no", None)
    return features.assign(frame=0 if number is None else int(number))


# fps and mask are parameters of their own.
_OF_FILES = frozenset(row["keyword"] for row in _grainfield.options_of_tracking("track")
                      if not row["section"])


def _of_files(fps: float | None, mask: Any, options: dict[str, Any]) -> dict[str, Any]:
    if mask is not None and not isinstance(mask, (str, os.PathLike)):
        raise _grainfield.OptionError("mask: of a film by name it is a picture by name.")
    return {"fps": fps, "mask": mask, **options}


def _track(film: Any, fps: float | None, mask: Any, threads: int,
           options: dict[str, Any]) -> Trajectory:
    files = film_files(film)
    if files is None:
        for name in options:
            if name in _OF_FILES:
                raise _grainfield.OptionError(f"'{name}' is for films by name: do the same to the "
                                              "arrays.")
        data, summary = _grainfield.track_frames(film, fps=fps, mask=mask, threads=threads,
                                                 options=options)
    else:
        data, summary = _grainfield.track_files(files, threads=threads,
                                                options=_of_files(fps, mask, options))
    return Trajectory(data, summary)


@documented
def batch(frames: Any, diameter: float | None = None, *, fps: float | None = None,
          mask: Any = None, threads: int = 0, **options: Any) -> "pandas.DataFrame":
    """Finds every sphere of every frame.

    The image model is calibrated once, on the first frame that can be used; frames start from the
    positions of the frame before.

    Parameters
    ----------
    frames : path, paths, array or iterable
        A film or images by name; or 2D arrays: an array (frames, height, width), a list, a pims
        sequence, a generator, an iterator over a camera. None stands for a missing frame.
    diameter : float, optional
        Apparent diameter D of the discs [px].
    fps : float, optional
        Frames a second.
    mask : array or path, optional
        Where it is zero is not looked at.
    threads : int
        0: all. Results do not depend on it.
    **options
        As for locate.

    Returns
    -------
    DataFrame
        The columns of locate; `frame` is frame_no of a frame that has one, else its position.

    Raises
    ------
    InputError, OptionError
        As locate; and whatever the iterable raises.
    """
    keywords = {"disc_diameter": diameter, **from_trackpy(options)}
    return _features(_track(frames, fps, mask, threads, keywords))


@documented
def track(film: Any, diameter: float | None = None, *, fps: float | None = None, mask: Any = None,
          threads: int = 0, output: str | os.PathLike[str] | None = None, overwrite: bool = False,
          resume: bool = False, **options: Any) -> Trajectory:
    """Finds every sphere of every frame and follows it through time.

    Links are those of least summed squared displacement, weighted by the standard errors of the
    positions [crocker1996]_, the exact minimum.

    Parameters
    ----------
    film : path, paths, array or iterable
        As for batch.
    diameter : float, optional
        Apparent diameter D of the discs [px]; `sphere_diameter` is the true a, the unit of results.
    fps, mask, threads
        As for batch.
    output : path, optional
        Of a film by name: the H5MD file that ``grainfield track`` writes, with its checkpoints.
        What comes back is read from it. Arrays: use Trajectory.save.
    overwrite, resume : bool
        Of `output`: replace it; go on from its checkpoint.
    **options
        See below and ``gf.options("track")``.

    Returns
    -------
    Trajectory
        Positions in pixels. `summary` has disc_diameter and edge_width [px], polarity,
        residual_rms [contrast], frames, particles_mean, binning: the side of the blocks
        of pixels that frames were fitted by [px], and binning_reason: why by these.

    Raises
    ------
    InputError, OptionError, OutputError
        Frames, options or output cannot be used. What the iterable raises comes through.
    """
    keywords = {"disc_diameter": diameter, **from_trackpy(options)}
    if output is None:
        return _track(film, fps, mask, threads, keywords)
    files = film_files(film)
    if files is None:
        raise _grainfield.OptionError("output: for a film by name; save what comes of arrays with "
                                      "Trajectory.save.")
    summary = _grainfield.track_to_file(
        files, os.fspath(output), overwrite=overwrite, resume=resume, threads=threads,
        options=_of_files(fps, mask, keywords))
    return Trajectory(_grainfield.read_trajectory(os.fspath(output)), summary)


@documented
def link(f: Any, search_range: float | None = None, pos_columns: Sequence[str] | None = None,
         t_column: str = "frame", memory: int = 0, **options: Any) -> "pandas.DataFrame":
    """Gives the points of a table their identity through time.

    Of all ways to join points of consecutive frames not farther apart than R, the one that
    minimises Σ d² + R² · (tracks left alone) [crocker1996]_. Where the table has x_std and y_std,
    d² is weighted by them. Ambiguous groups are solved to the optimum, however large.

    Parameters
    ----------
    f : DataFrame
        Points; `t_column` numbers the frames. Frames that are absent count as missing. Times that
        are no whole numbers only order the frames.
    search_range : float, optional
        R: the largest step between two frames, unit of the positions. Without it R follows the
        motion between D/2 and D, D being what locate or batch measured.
    pos_columns : two names, optional
        By default x and y.
    memory : int
        Frames for which a particle may be missing. 0 as in trackpy; ``gf.track`` has 2.
    **options
        See below. Of trackpy's words those without a counterpart are ignored with a warning.

    Returns
    -------
    DataFrame
        A copy in order of frames, with the column `particle`.

    Raises
    ------
    InputError
        If a column is missing or a position is not finite.
    OptionError
        If an option is out of range, or neither `search_range` nor D is known.
    """
    pandas_module()
    if not is_table(f):
        raise _grainfield.InputError(f"link takes a table of points, not {type(f).__name__}.")
    positions = tuple(pos_columns) if pos_columns is not None else ("x", "y")
    frame, position = columns_to_link(f, positions, t_column)
    order = np.argsort(frame, kind="stable")
    linked = f.iloc[order].copy()
    errors = None
    if {"x_std", "y_std"} <= set(f.columns) and set(positions) == {"x", "y"}:
        errors = f[[f"{name}_std" for name in positions]].to_numpy(float)[order]
    diameter = f.attrs.get("grainfield", {}).get("diameter", 0.0)
    if (np.floor(frame) == frame).all():
        number = whole_frames(frame, t_column)
        linked[t_column] = number[order]
    else:
        number = np.unique(frame, return_inverse=True)[1]
    linked["particle"] = _grainfield.link(
        number[order], position[order], errors, diameter=diameter,
        options={"search_range": search_range, "memory": memory, **_linking(options)})
    return linked[linked["particle"] >= 0]


def _linking(options: dict[str, Any]) -> dict[str, Any]:
    predictor = options.get("predictor", "none")
    if not isinstance(predictor, str):
        raise _grainfield.OptionError("predictor: a function cannot be called from here; expected none, nearest-velocity "
                                      "or drift, or link_df of a class in grainfield.predict.")
    return from_trackpy(options, linking=True)


link_df = link


def link_df_iter(f_iter: Iterable[Any], search_range: float | None = None,
                 pos_columns: Sequence[str] | None = None, t_column: str = "frame", memory: int = 0,
                 **options: Any) -> "Iterator[pandas.DataFrame]":
    """Links tables of one frame each, and yields them with `particle`.

    All are linked before the first is yielded: which tracks are long enough is known at the end.

    Parameters
    ----------
    f_iter : iterable of DataFrame
        Tables of one frame each, in order.
    search_range, pos_columns, t_column, memory, **options
        As for link.

    Yields
    ------
    DataFrame
        Each table, with the column `particle`; an empty one for an empty table.

    Raises
    ------
    InputError, OptionError
        As link.
    """
    frames = list(f_iter)
    if not any(len(frame) > 0 for frame in frames):
        for frame in frames:
            yield frame.assign(particle=np.empty(0, dtype=np.int64))
        return
    filled = [frame for frame in frames if len(frame) > 0]
    linked = link(pandas_module().concat(filled, ignore_index=True), search_range, pos_columns, t_column,
                  memory, **options)
    linked = linked.sort_index()
    row, particle = linked.index.to_numpy(), linked["particle"].to_numpy()
    start = np.concatenate([[0], np.cumsum([len(frame) for frame in frames])])
    first = np.searchsorted(row, start)
    for i, frame in enumerate(frames):
        mine = slice(first[i], first[i + 1])
        yield frame.iloc[row[mine] - start[i]].assign(particle=particle[mine])
