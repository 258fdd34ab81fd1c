"""Molecular dynamics, the field model, and frames of a camera."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _grainfield
from ._options import documented
from .trajectory import Trajectory

if TYPE_CHECKING:
    import xarray


@documented
def simulate_md(*, seed: int = 1, threads: int = 0, **config: Any) -> Trajectory:
    """Molecular dynamics of a vibrated layer of frictional, inelastic spheres, event by event.

    Parameters
    ----------
    seed : int
        Of all random streams.
    threads : int
        0: all. Results do not depend on it.
    **config
        Options as keywords, or sections as dicts: what ``tomllib.load`` makes of a configuration
        file of ``grainfield simulate md`` is taken as it is.

    Returns
    -------
    Trajectory
        Lengths in a, times in sqrt(a/g), mass m = 1; every snapshot in memory.

    Raises
    ------
    OptionError
        If the system cannot be simulated.
    PhysicsError
        On inelastic collapse.
    """
    return Trajectory(_grainfield.simulate_md(seed=seed, threads=threads, options=config))


@dataclass(frozen=True)
class FieldSeries:
    """Fields of the continuum model.

    Attributes
    ----------
    time : array, shape (instants,)
    density : array, shape (instants, replicas, ny, nx)
    order : array, shape (instants, ny, nx); empty where there is none
    mean_diffusivity : array, shape (instants,)
    spacing : float
        Lattice constant δx [model length].
    """

    time: np.ndarray
    density: np.ndarray
    order: np.ndarray
    mean_diffusivity: np.ndarray
    spacing: float
    dimension: int

    def to_xarray(self) -> "xarray.Dataset":
        """A Dataset over (time, replica, y, x), cell centres as coordinates."""
        import xarray

        _, _, ny, nx = self.density.shape
        data = {"density": (("time", "replica", "y", "x"), self.density),
                "mean_diffusivity": (("time",), self.mean_diffusivity)}
        if self.order.size:
            data["order"] = (("time", "y", "x"), self.order)
        return xarray.Dataset(data, coords={
            "time": self.time, "x": (np.arange(nx) + 0.5) * self.spacing,
            "y": (np.arange(ny) + 0.5) * self.spacing})


@documented
def simulate_field(*, seed: int = 1, threads: int = 0, **config: Any) -> FieldSeries:
    """The coupled fields ψ and ρ of the continuum model [castillo2019]_.

    ∂tψ = −(ν + μ(−∇²)^{b/2})ψ + ξ,  ∂tρ = ∇·(D(ψ)∇ρ + η).

    Parameters
    ----------
    seed, threads, **config
        As for simulate_md; a file of ``grainfield simulate field`` is taken as it is.

    Returns
    -------
    FieldSeries
        One instant every `sample` after the relaxation, all in memory.

    Raises
    ------
    OptionError
        If the fields cannot be integrated, and for the adjoint scheme, which has no density.
    PhysicsError
        If the published scheme blows up.
    """
    return FieldSeries(**_grainfield.simulate_field(seed=seed, threads=threads, options=config))


@dataclass(frozen=True)
class RenderedFilm:
    """Frames as a camera sees them, and what is in them.

    Attributes
    ----------
    frames : array, shape (frames, height, width), uint8 or uint16
    truth : Trajectory
        True positions in pixels, as long as one can follow a grain under one identity.
    lost : array of bool
        Frames that the camera lost; zero in `frames`, absent in `truth`.
    """

    frames: np.ndarray
    truth: Trajectory
    lost: np.ndarray


@documented
def render(trajectory: Trajectory, camera: Any = None, *, seed: int = 1, threads: int = 0,
           **options: Any) -> RenderedFilm:
    """Camera frames of every snapshot of a trajectory.

    Parameters
    ----------
    trajectory : Trajectory
        With heights or layers, such as that of simulate_md.
    camera : path or dict, optional
        A TOML file of ``grainfield render``, or what it holds; by default the camera of the
        options. A word ("noisy", "ideal") is the option `camera`.
    seed, threads
        As for simulate_md.
    **options
        See below; they win over the file.

    Returns
    -------
    RenderedFilm

    Raises
    ------
    OptionError
        If the options do not go together or the trajectory is empty.
    InputError
        If the file cannot be read.
    """
    return _rendered(trajectory, _camera_options(camera), options, seed, threads)


def _rendered(trajectory: Trajectory, camera: dict[str, Any], options: dict[str, Any], seed: int,
              threads: int) -> RenderedFilm:
    merged = dict(camera)
    for name, value in options.items():
        is_section = isinstance(value, dict) and isinstance(merged.get(name), dict)
        merged[name] = {**merged[name], **value} if is_section else value
    # Flat keywords come last, so that they win over sections.
    ordered = {**{k: v for k, v in merged.items() if isinstance(v, dict)},
               **{k: v for k, v in merged.items() if not isinstance(v, dict)}}
    frames, truth, lost = _grainfield.render(trajectory._data, seed=seed, threads=threads,
                                             options=ordered)
    return RenderedFilm(frames, Trajectory(truth), np.asarray(lost, bool))


def _camera_options(camera: Any) -> dict[str, Any]:
    if camera is None:
        return {}
    if isinstance(camera, dict):
        return camera
    if isinstance(camera, str) and not camera.endswith(".toml"):
        return {"camera": camera}
    import tomllib

    try:
        with open(camera, "rb") as file:
            return tomllib.load(file)
    except (OSError, tomllib.TOMLDecodeError) as wrong:
        raise _grainfield.InputError(f"cannot read the camera '{os.fspath(camera)}': {wrong}.")
