"""Observables of trajectories and points, and the report of results."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Iterator

import numpy as np

from . import _grainfield
from ._arrays import pandas_module, trajectory_of
from ._options import documented

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class Measurement:
    """A measured number with its standard error and the number of independent samples behind it, or
    the reason why there is none."""

    name: str
    unit: str
    value: float | None
    error: float | None
    samples: float
    reason: str

    def __float__(self) -> float:
        return float("nan") if self.value is None else self.value


class Observable:
    """What an analysis says about one observable.

    Attributes
    ----------
    name : str
    reason : str
        Why nothing could be measured; empty if something was. A measurement that is missing
        has its own: of a fit that could not be made ``fit["s0"].reason``.
    measurements : dict of str to Measurement
    curves : dict of str to dict of str to array
        Columns by name; ``observable.table("sk")`` is a DataFrame.
    """

    def __init__(self, data: dict[str, Any]):
        self.name: str = data["name"]
        self.reason: str = data["reason"]
        self.measurements = {m["name"]: Measurement(**m) for m in data["measurements"]}
        self.curves: dict[str, dict[str, Any]] = data["curves"]

    def __getitem__(self, name: str) -> Measurement:
        return self.measurements[name]

    def table(self, curve: str | None = None) -> "pandas.DataFrame":
        """A curve as a DataFrame; by default the one that is called as the observable.

        Raises KeyError, with the reason if one is known, where there is no such curve.
        """
        name = curve or self.name
        if name not in self.curves:
            missing = (m.reason for m in self.measurements.values() if m.value is None)
            why = self.reason or next(missing, "") or f"there are {', '.join(self.curves) or 'none'}"
            raise KeyError(f"no curve '{name}' of {self.name}: {why}")
        return pandas_module().DataFrame(self.curves[name])

    def __repr__(self) -> str:
        known = [name for name, m in self.measurements.items() if m.value is not None]
        said = self.reason or f"{', '.join(known)}; curves {', '.join(self.curves)}"
        return f"<grainfield.Observable {self.name}: {said}>"


class Results:
    """All observables of one run: ``results["q4"]``; what compare and save take."""

    def __init__(self, data: _grainfield.Results):
        self._data = data
        self._observables = {o["name"]: Observable(o) for o in data.observables()}

    @property
    def label(self) -> str:
        """Legend entry in reports."""
        return self._data.label

    @property
    def frames(self) -> int:
        return self._data.frames

    @property
    def particles_mean(self) -> float:
        return self._data.particles_mean

    def __getitem__(self, observable: str) -> Observable:
        return self._observables[observable]

    def __iter__(self) -> Iterator[str]:
        return iter(self._observables)

    def __len__(self) -> int:
        return len(self._observables)

    def __repr__(self) -> str:
        return f"<grainfield.Results {self.label}: {', '.join(self)}; {self.frames} frames>"

    def save(self, path: str | os.PathLike[str], overwrite: bool = False) -> None:
        """Writes a results file, as ``grainfield analyze`` does. Raises OutputError."""
        self._data.save(os.fspath(path), overwrite)


def read_results(path: str | os.PathLike[str]) -> Results:
    """Reads a results file. Raises InputError."""
    return Results(_grainfield.read_results(os.fspath(path)))


@documented
def analyze(positions: Any, observables: str = "all", *, box: Any = None,
            boundary: str | None = None, diameter: float | None = None, fps: float | None = None,
            label: str = "", threads: int = 0, **options: Any) -> Results:
    """Measures observables over all frames.

    Parameters
    ----------
    positions : Trajectory, DataFrame, array or list of arrays
        Trajectory.from_positions says which arrays. Tables of locate, batch and link bring their
        box and diameter with them.
    observables : str
        "all", or some of q4, phase, msd, sk, s4, variance, fit, synthetic, gr, height with commas
        between them.
    box, boundary, diameter, fps
        Of points; see Trajectory.from_positions.
    label : str
        Legend entry in reports.
    threads : int
        0: all. Results do not depend on it.
    **options
        See below. Where two observables share a name it is ``section_name``; or a dict a section:
        ``sk={"k_max": 3}``.

    Returns
    -------
    Results
        Lengths in a, k in 1/a. Every number has an error or a reason why it has none.

    Raises
    ------
    OptionError, InputError
        Options or positions cannot be used.
    """
    data = trajectory_of(positions, box, boundary, diameter, fps)
    return Results(_grainfield.measure(data, label=label, threads=threads,
                                       options={"observables": observables, **options}))


def _one(name: str, positions: Any, given: dict[str, Any], options: dict[str, Any]) -> Observable:
    return analyze(positions, name, **given, **{name: options})[name]


@documented
def q4(positions: Any, box: Any = None, boundary: str | None = None, *,
       diameter: float | None = None, fps: float | None = None, threads: int = 0,
       **options: Any) -> Observable:
    """Bond-orientational order: distribution, means and correlation of |Q4|.

    Q_k^j = (1/N_j) Σ_s exp(i k θ_s) over the N_j neighbours of particle j, k = 4 [nelson1979]_.
    |Q4| = 1 in a square lattice. ``gf.bond_order`` gives it particle by particle.

    Parameters
    ----------
    positions, box, boundary, diameter, fps, threads
        As for analyze.

    Returns
    -------
    Observable
        Measurements q4_mean and others; curves q4_histogram and others.
    """
    return _one("q4", positions, dict(box=box, boundary=boundary, diameter=diameter, fps=fps,
                                      threads=threads), options)


@documented
def msd(positions: Any, box: Any = None, boundary: str | None = None, *,
        diameter: float | None = None, fps: float | None = None, threads: int = 0,
        **options: Any) -> Observable:
    """Mean squared displacement of particles with identities, and by phase.

    MSD(τ) = ⟨|r_j(t + τ) − r_j(t)|²⟩ over particles and times [a²]. A drift of all
    particles is not taken off; subtract_drift does it for linked tables.

    Parameters
    ----------
    positions, box, boundary, diameter, fps, threads
        As for analyze.

    Returns
    -------
    Observable
        Curve msd (t, phase, msd, err); diffusivities where they can be fitted.
    """
    return _one("msd", positions, dict(box=box, boundary=boundary, diameter=diameter, fps=fps,
                                       threads=threads), options)


@documented
def structure_factor(positions: Any, box: Any = None, boundary: str | None = None, *,
                     diameter: float | None = None, fps: float | None = None, threads: int = 0,
                     **options: Any) -> Observable:
    """Static structure factor S(k).

    S(k) = ⟨|ρ_k|²⟩/⟨N⟩ with ρ_k = Σ_j exp(−i k·r_j), averaged over shells of |k|; between walls the
    connected one, ⟨|ρ_k|²⟩ − |⟨ρ_k⟩|² [castillo2019]_.

    Parameters
    ----------
    positions, box, boundary, diameter, fps, threads
        As for analyze.

    Returns
    -------
    Observable
        Curve sk (k, s, s_err, n) and others; k in 1/a.
    """
    return _one("sk", positions, dict(box=box, boundary=boundary, diameter=diameter, fps=fps,
                                      threads=threads), options)


@documented
def number_variance(positions: Any, box: Any = None, boundary: str | None = None, *,
                    diameter: float | None = None, fps: float | None = None, threads: int = 0,
                    **options: Any) -> Observable:
    """Variance σ²(ℓ) of the number of particles in square windows of side ℓ.

    Parameters
    ----------
    positions, box, boundary, diameter, fps, threads
        As for analyze.

    Returns
    -------
    Observable
        Curve variance (l, variance, err, mean); l in a.
    """
    return _one("variance", positions, dict(box=box, boundary=boundary, diameter=diameter, fps=fps,
                                            threads=threads), options)


@documented
def pair_distribution(positions: Any, box: Any = None, boundary: str | None = None, *,
                      diameter: float | None = None, fps: float | None = None, threads: int = 0,
                      **options: Any) -> Observable:
    """Pair distribution g(r) in the plane, and in space where heights are known.

    g = 1 for points at random with the same heights; pairs that walls cut off are made up for
    [stoyan1994]_.

    Parameters
    ----------
    positions, box, boundary, diameter, fps, threads
        As for analyze.

    Returns
    -------
    Observable
        Curves gr (s, g, err, n), gr_space (r, g, err, n, neighbours) and contacts (n, share).
    """
    return _one("gr", positions, dict(box=box, boundary=boundary, diameter=diameter, fps=fps,
                                      threads=threads), options)


@documented
def fit_hyperuniform(positions: Any, box: Any = None, boundary: str | None = None, *,
                     diameter: float | None = None, fps: float | None = None, threads: int = 0,
                     **options: Any) -> Observable:
    """Fit of S(k) = S0 + S1 k^α at small k: hyperuniform if S0 vanishes.

    Parameters
    ----------
    positions, box, boundary, diameter, fps, threads
        As for analyze.

    Returns
    -------
    Observable
        Measurements s0, s1, alpha and others, each with its error or the reason why there is none.
    """
    return _one("fit", positions, dict(box=box, boundary=boundary, diameter=diameter, fps=fps,
                                       threads=threads), options)


def bond_order(positions: Any, box: Any = None, boundary: str | None = None, *,
               diameter: float | None = None, frame: int = 0,
               **options: Any) -> tuple[np.ndarray, np.ndarray]:
    """Q_k of each particle of one frame.

    Q_k^j = (1/N_j) Σ_s exp(i k θ_s), θ_s from +x towards +y [nelson1979]_.

    Parameters
    ----------
    positions, box, boundary, diameter
        As for analyze.
    frame : int
        Which of the snapshots, from 0.
    **options
        Rule of neighbours and symmetry k, as for q4.

    Returns
    -------
    q : complex array
        One value for each position, in their order. NaN where a particle has no neighbour or its
        position is not finite.
    neighbours : int array
        0 where the position is not finite.
    """
    data = trajectory_of(positions, box, boundary, diameter, None, keeps_all=True)
    if not 0 <= frame < len(data):
        raise IndexError(f"there is no frame {frame}: there are {len(data)}")
    return _grainfield.bond_order(data, frame, options=options)


def compare(*results: Results, output: str | os.PathLike[str], title: str = "",
            figures: bool = True, paper: bool = False, overwrite: bool = False) -> list[str]:
    """Makes one HTML report of one or more results, side by side.

    Parameters
    ----------
    *results : Results
        In the order of the legend.
    output : path
        The page; `figures` go as SVG, PDF and CSV into a folder beside it.
    paper : bool
        Begin with the values of [castillo2019]_ and how ours compare.

    Returns
    -------
    list of str
        What was written.

    Raises
    ------
    OutputError
        If something is there already and `overwrite` is false, or cannot be written.
    OptionError
        Without results.
    """
    written = _grainfield.compare([r._data for r in results], os.fspath(output), title=title,
                                  figures=figures, paper=paper, overwrite=overwrite)
    return [os.fspath(path) for path in written]
