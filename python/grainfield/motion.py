"""What trackpy offers on linked tables: stubs, drift, mean squared displacements."""
from __future__ import annotations

from typing import TYPE_CHECKING, Sequence

import numpy as np

from ._arrays import pandas_module

if TYPE_CHECKING:
    import pandas


def filter_stubs(tracks: "pandas.DataFrame", threshold: int = 30) -> "pandas.DataFrame":
    """The rows of particles that were seen in at least `threshold` frames."""
    seen = tracks.groupby("particle")["frame"].transform("size")
    return tracks[seen >= threshold]


def compute_drift(traj: "pandas.DataFrame", smoothing: int = 0,
                  pos_columns: Sequence[str] = ("x", "y")) -> "pandas.DataFrame":
    """Mean displacement of all particles since the first frame.

    x̄(t) = Σ_{s ≤ t} ⟨x_j(s) − x_j(s − 1)⟩_j over the particles seen in both frames.

    Parameters
    ----------
    traj : DataFrame
        Linked: frame, particle and positions.
    smoothing : int
        Steps are averaged over so many frames before they are summed.

    Returns
    -------
    DataFrame
        Indexed by frame, unit of the positions.
    """
    columns = list(pos_columns)
    ordered = traj.sort_values(["particle", "frame"])
    steps = ordered[["particle", "frame", *columns]].diff()
    is_step = (steps["particle"] == 0) & (steps["frame"] == 1)
    means = steps.loc[is_step, columns].groupby(ordered.loc[is_step, "frame"]).mean()
    if smoothing > 0:
        means = means.rolling(smoothing, min_periods=0).mean()
    return means.cumsum()


def subtract_drift(traj: "pandas.DataFrame",
                   drift: "pandas.DataFrame | None" = None) -> "pandas.DataFrame":
    """A copy of the table without the drift, by default that of compute_drift."""
    drift = compute_drift(traj) if drift is None else drift
    still = traj.copy()
    for column in drift.columns:
        still[column] -= drift[column].reindex(still["frame"]).fillna(0.0).to_numpy()
    return still


def _squared_steps(traj: "pandas.DataFrame", most: int) -> tuple[np.ndarray, ...]:
    """Sum and number of squared displacements by particle and lag, and the particles. Gaps of a
    track are no steps."""
    particles, column = np.unique(traj["particle"].to_numpy(), return_inverse=True)
    frame = traj["frame"].to_numpy(np.int64)
    most = int(min(most, frame.max() - frame.min())) if len(frame) else 0
    order = np.lexsort((frame, column))
    frame, column = frame[order], column[order]
    place = traj[["x", "y"]].to_numpy(float)[order]
    # One number a particle and frame, so that pairs of a lag are found by one search.
    span = int(frame.max() - frame.min() + most + 1) if len(frame) else 1
    key = column * span + (frame - frame.min() if len(frame) else frame)
    sums = np.zeros((most, len(particles)))
    counts = np.zeros((most, len(particles)))
    for lag in range(1, most + 1):
        later = np.searchsorted(key, key + lag)
        found = later < len(key)
        found[found] = key[later[found]] == key[found] + lag
        squared = ((place[later[found]] - place[found]) ** 2).sum(axis=1)
        sums[lag - 1] = np.bincount(column[found], squared, len(particles))
        counts[lag - 1] = np.bincount(column[found], minlength=len(particles))
    return sums, counts, particles


def imsd(traj: "pandas.DataFrame", mpp: float, fps: float,
         max_lagtime: int = 100) -> "pandas.DataFrame":
    """Mean squared displacement of each particle.

    ⟨|r(t + τ) − r(t)|²⟩_t over all pairs of frames, a gap of the track being no pair.

    Parameters
    ----------
    traj : DataFrame
        Linked: x, y, frame, particle.
    mpp : float
        Micrometres a pixel.
    fps : float
        Frames a second.
    max_lagtime : int
        Longest lag [frames].

    Returns
    -------
    DataFrame
        Lag time [s] × particle, in µm²; NaN without a pair.
    """
    sums, counts, particles = _squared_steps(traj, max_lagtime)
    values = mpp**2 * np.divide(sums, counts, out=np.full_like(sums, np.nan), where=counts > 0)
    pandas = pandas_module()
    lags = pandas.Index(np.arange(1, len(values) + 1) / fps, name="lag time [s]")
    return pandas.DataFrame(values, index=lags, columns=particles)


def emsd(traj: "pandas.DataFrame", mpp: float, fps: float,
         max_lagtime: int = 100) -> "pandas.Series":
    """Mean squared displacement over all particles and pairs of frames, µm² by lag time [s]; its
    parameters are those of imsd. ``gf.msd`` gives it with errors, and by phase."""
    sums, counts, _ = _squared_steps(traj, max_lagtime)
    total = counts.sum(axis=1)
    values = mpp**2 * np.divide(sums.sum(axis=1), total, out=np.full(len(sums), np.nan),
                                where=total > 0)
    pandas = pandas_module()
    lags = pandas.Index(np.arange(1, len(values) + 1) / fps, name="lag time [s]")
    return pandas.Series(values, index=lags, name="msd")
