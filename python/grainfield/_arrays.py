"""Between tables or arrays of points and the compiled part."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Sequence

import numpy as np

from . import _grainfield

if TYPE_CHECKING:
    import pandas

    from .trajectory import Trajectory


def pandas_module() -> Any:
    try:
        import pandas
    except ImportError as missing:
        raise ImportError("tables need pandas (Debian: python3-pandas); Trajectory.columns() "
                          "gives the same as arrays") from missing
    return pandas


def film_files(film: Any) -> list[str] | None:
    """The paths, if `film` is one or a list of them; None if it is made of arrays."""
    if isinstance(film, (str, os.PathLike)):
        return [os.fspath(film)]
    if isinstance(film, (list, tuple)) and film and all(
            isinstance(part, (str, os.PathLike)) for part in film):
        return [os.fspath(part) for part in film]
    return None


def table_of(columns: dict[str, np.ndarray], info: dict[str, Any]) -> "pandas.DataFrame":
    """A DataFrame whose attrs["grainfield"] says box, diameter and frame rate of the points."""
    frame = pandas_module().DataFrame(columns, copy=False)
    kept = ("origin", "length_unit", "diameter", "diameter_origin", "frame_rate", "box")
    frame.attrs["grainfield"] = {name: info[name] for name in kept}
    return frame


def is_table(data: Any) -> bool:
    return hasattr(data, "columns") and hasattr(data, "to_numpy")


def columns_to_link(table: "pandas.DataFrame", positions: Sequence[str],
                    time: str) -> tuple[np.ndarray, np.ndarray]:
    for name in (*positions, time):
        if name not in table.columns:
            raise _grainfield.InputError(f"the table has no column '{name}': it has "
                                         f"{', '.join(map(str, table.columns))}.")
    frame = table[time].to_numpy(float)
    if not (np.isfinite(frame) & (np.abs(frame) < 2.0**53)).all():
        raise _grainfield.InputError(f"the column '{time}' does not number frames: it holds "
                                     f"{frame[~(np.isfinite(frame) & (np.abs(frame) < 2.0**53))][0]:g}.")
    return frame, table[list(positions)].to_numpy(float)


def whole_frames(frame: np.ndarray, time: str) -> np.ndarray:
    """Numbers of frames that are counted."""
    whole = frame.astype(np.int64)
    if not (whole == frame).all():
        raise _grainfield.InputError(f"the column '{time}' holds {frame[whole != frame][0]:g}; expected whole numbers of "
                                     "frames.")
    return whole


def _box_numbers(box: Any) -> list[float] | None:
    """x, y of the corner and lengths."""
    if box is None:
        return None
    if isinstance(box, dict):
        return [*box["origin"], *box["length"]]
    numbers = [float(number) for number in box]
    if len(numbers) == 2:
        return [0.0, 0.0, *numbers]
    if len(numbers) == 4:
        return numbers
    raise _grainfield.OptionError(f"a box is (LX, LY) or (X, Y, LX, LY): {len(numbers)} numbers.")


def _points_of(data: Any, keeps_all: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """Frame, position and identity of each point, by frame. Of lists of arrays those that are not
    finite are left out unless all are kept."""
    if is_table(data):
        time = data["frame"] if "frame" in data.columns else np.zeros(len(data), np.int64)
        data = data.assign(frame=time).sort_values("frame", kind="stable")
        frame, position = columns_to_link(data, ("x", "y"), "frame")
        particle = data["particle"].to_numpy(np.int64) if "particle" in data.columns else None
        return whole_frames(frame, "frame"), position, particle
    if isinstance(data, np.ndarray) and data.ndim == 2:
        return np.zeros(len(data), np.int64), np.asarray(data, float), None
    is_linked = isinstance(data, np.ndarray) and data.ndim == 3
    frames = [np.asarray(points, float).reshape(-1, 2) for points in data]
    counts = [len(points) for points in frames]
    frame = np.repeat(np.arange(len(frames)), counts)
    position = np.concatenate(frames) if frames else np.empty((0, 2))
    particle = np.concatenate([np.arange(n) for n in counts]) if is_linked else None
    if keeps_all:
        return frame, position, particle
    seen = np.isfinite(position).all(axis=1)
    return frame[seen], position[seen], None if particle is None else particle[seen]


def trajectory_of(data: Any, box: Any, boundary: str | None, diameter: float | None,
                  fps: float | None, keeps_all: bool = False) -> _grainfield.Trajectory:
    """The compiled form of whatever holds positions. `keeps_all`: also those that are not finite,
    for a value each."""
    from .trajectory import Trajectory

    if isinstance(data, Trajectory):
        if (box, boundary, diameter, fps) != (None, None, None, None):
            raise _grainfield.OptionError("a Trajectory has its own box, boundary, diameter and "
                                          "fps: leave them out.")
        return data._data
    known = getattr(data, "attrs", {}).get("grainfield", {})
    box = known.get("box") if box is None else box
    if boundary is None:
        boundary = box["boundary"][0] if isinstance(box, dict) else "walls"
    if boundary not in ("walls", "periodic"):
        raise _grainfield.OptionError(f"boundary: '{boundary}'; expected walls or periodic.")
    if boundary == "periodic" and box is None:
        raise _grainfield.OptionError("a periodic boundary needs the box: (LX, LY), the periods in "
                                      "the unit of the positions.")
    diameter = known.get("diameter", 1.0) if diameter is None else diameter
    frame, position, particle = _points_of(data, keeps_all)
    return _grainfield.trajectory_from_points(
        frame, position, particle, box=_box_numbers(box), periodic=boundary == "periodic",
        diameter=diameter, pixels=known.get("length_unit", "a" if diameter == 1 else "px") == "px",
        fps=known.get("frame_rate") if fps is None else fps)
