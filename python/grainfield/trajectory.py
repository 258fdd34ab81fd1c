"""Positions per frame with identity and time."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Iterator

import numpy as np

from . import _grainfield
from ._arrays import table_of, trajectory_of

if TYPE_CHECKING:
    import MDAnalysis
    import pandas
    import xarray


class Trajectory:
    """Positions per frame with identity, time and box: what tracking and simulations give and what
    the analysis takes.

    ``trajectory[i]`` is a dict of one snapshot: frame, time, box, and position [N × 2],
    position_error, z, velocity, spin, quality and particle as arrays that share the memory of the
    trajectory (read-only), or None where they do not apply. Lengths are in `length_unit`: "px" or
    "a", the sphere diameter; times in `time_unit`.

    Attributes
    ----------
    info : dict
        origin ("video", "md", "rendered", "points"), length_unit, time_unit, diameter (a in
        length_unit), diameter_origin ("given", "apparent", "simulated", "stated"), frame_rate,
        vibration_frequency, source, box.
    summary : dict
        What the tracker says of its run; empty for others.
    """

    def __init__(self, data: _grainfield.Trajectory, summary: dict[str, Any] | None = None):
        self._data = data
        self.info: dict[str, Any] = data.info()
        self.summary: dict[str, Any] = summary or {}

    @classmethod
    def from_positions(cls, positions: Any, box: Any = None, boundary: str | None = None,
                       diameter: float | None = None, fps: float | None = None) -> "Trajectory":
        """From points of any origin.

        Parameters
        ----------
        positions : DataFrame or array or list of arrays
            Columns x, y and perhaps frame and particle; or (N, 2), one frame; or (frames, N, 2),
            row j being the same particle in each (NaN: absent); or one (N, 2) array a frame.
        box : (LX, LY) or (X, Y, LX, LY), optional
            Unit of the positions; by default the extent of the points.
        boundary : {"walls", "periodic"}
            "periodic" needs the box.
        diameter : float
            a, in the unit of the positions; 1 by default: positions in units of a.
        fps : float, optional
            Frames a second; without it times count frames.

        Raises
        ------
        InputError
            If these are not positions.
        OptionError
            If box, boundary or diameter are not usable.
        """
        return cls(trajectory_of(positions, box, boundary, diameter, fps))

    def __len__(self) -> int:
        return len(self._data)

    def __getitem__(self, index: int) -> dict[str, Any]:
        return self._data.snapshot(index)

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        return (f"<grainfield.Trajectory: {self.info['origin']}, {len(self)} snapshots, lengths in "
                f"{self.info['length_unit']}, times in {self.info['time_unit']}>")

    @property
    def frames(self) -> np.ndarray:
        """Index of each snapshot in its source; gaps keep their index."""
        return self._data.frames_and_times()[0]

    @property
    def times(self) -> np.ndarray:
        """Time of each snapshot [time_unit]."""
        return self._data.frames_and_times()[1]

    def columns(self) -> dict[str, np.ndarray]:
        """One array a column over all snapshots: x, y, frame and, where they apply, z, particle,
        x_std, y_std, vx, vy, vz, layer (−1 unknown, 0 bottom, 1 top), quality."""
        return self._data.columns()

    def to_pandas(self) -> "pandas.DataFrame":
        """A table with one row a particle and frame; columns as columns() has them."""
        return table_of(self.columns(), self.info)

    def to_xarray(self) -> "xarray.Dataset":
        """A Dataset over (frame, particle); NaN where a particle is absent. Without identities,
        particles are numbered in each frame. Coordinate `time`; attributes as in `info`."""
        import xarray

        columns = self.columns()
        frames, times = self._data.frames_and_times()
        row = np.searchsorted(frames, columns.pop("frame"))
        particle = columns.pop("particle", None)
        if particle is None:
            first = np.searchsorted(row, np.arange(len(frames)))
            particle = np.arange(len(row)) - first[row]
        identities, column = np.unique(particle, return_inverse=True)
        data = {}
        for name, values in columns.items():
            grid = np.full((len(frames), len(identities)), np.nan)
            grid[row, column] = values
            data[name] = (("frame", "particle"), grid)
        attributes = {k: v for k, v in self.info.items() if v is not None and k != "box"}
        return xarray.Dataset(data, attrs=attributes, coords={
            "frame": frames, "particle": identities, "time": ("frame", times)})

    def to_mdanalysis(self) -> "MDAnalysis.Universe":
        """An MDAnalysis Universe in memory: one atom of type "grain" a particle, positions
        (x, y, z or 0) in length_unit, NaN where it is absent. It keeps single precision."""
        import MDAnalysis

        dataset = self.to_xarray()
        shape = dataset["x"].shape
        z = dataset["z"].values if "z" in dataset else np.zeros(shape)
        positions = np.stack([dataset["x"].values, dataset["y"].values, z], axis=-1)
        universe = MDAnalysis.Universe.empty(shape[1], trajectory=True)
        universe.add_TopologyAttr("type", ["grain"] * shape[1])
        universe.add_TopologyAttr("id", dataset["particle"].values)
        times = dataset["time"].values
        box = self.info["box"]
        universe.load_new(positions.astype(np.float32), order="fac", dt=float(
            np.diff(times).mean()) if len(times) > 1 else 1.0,
            dimensions=np.array([*box["length"], box["height"] or 1.0, 90, 90, 90], np.float32))
        return universe

    def save(self, path: str | os.PathLike[str], overwrite: bool = False) -> None:
        """Writes an H5MD file, which the program, MDAnalysis and h5py open.

        Raises
        ------
        OutputError
            If the file exists and `overwrite` is false, or cannot be written.
        """
        self._data.save(os.fspath(path), overwrite, _grainfield.version)


def read(path: str | os.PathLike[str]) -> Trajectory:
    """Reads a trajectory: an H5MD file of this program or of another one, or a CSV table of points.

    Raises
    ------
    InputError
        If the file is missing, damaged or something else.
    """
    return Trajectory(_grainfield.read_trajectory(os.fspath(path)))
