"""Where a particle is looked for in the next frame, in trackpy's words.

``gf.link(table, R, predictor="nearest-velocity")`` says the same in one word. Velocities are per frame: give frames that
are evenly spaced.
"""
from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, Iterable, Iterator

from . import _grainfield
from .tracking import link, link_df_iter

if TYPE_CHECKING:
    import pandas


class NullPredict:
    """Particles are looked for where they were."""

    predictor = "none"

    def link_df(self, f: Any, search_range: float, **options: Any) -> "pandas.DataFrame":
        """``gf.link`` with this prediction."""
        return link(f, search_range, predictor=self.predictor, **options)

    link = link_df

    def link_df_iter(self, f_iter: Iterable[Any], search_range: float,
                     **options: Any) -> "Iterator[pandas.DataFrame]":
        """``gf.link_df_iter`` with this prediction."""
        return link_df_iter(f_iter, search_range, predictor=self.predictor, **options)


def _without_guess(**given: Any) -> None:
    for name, value in given.items():
        if value is not None:
            raise _grainfield.OptionError(f"{name}: velocities are not guessed here; leave it out. The first step is "
                                          "looked for within the search range.")


def _without_span(span: int) -> None:
    if span != 1:
        warnings.warn("'span': velocities are those of the last step, whatever it says",
                      _grainfield.GrainfieldWarning, stacklevel=3)


class NearestVelocityPredict(NullPredict):
    """A particle goes on with the velocity of its last step, a new one with that of its nearest neighbour."""

    predictor = "nearest-velocity"

    def __init__(self, initial_guess_positions: Any = None, initial_guess_vels: Any = None,
                 pos_columns: Any = None, span: int = 1) -> None:
        _without_guess(initial_guess_positions=initial_guess_positions, initial_guess_vels=initial_guess_vels)
        _without_span(span)


class DriftPredict(NullPredict):
    """A particle goes on with the median velocity of all."""

    predictor = "drift"

    def __init__(self, initial_guess: Any = None, pos_columns: Any = None, span: int = 1) -> None:
        _without_guess(initial_guess=initial_guess)
        _without_span(span)


class ChannelPredict(NullPredict):
    """For flow along a channel: as NearestVelocityPredict, which needs no bins."""

    predictor = "nearest-velocity"

    def __init__(self, bin_size: float | None = None, flow_axis: str = "x", minsamples: int = 20,
                 initial_profile_guess: Any = None, pos_columns: Any = None, span: int = 1) -> None:
        _without_guess(initial_profile_guess=initial_profile_guess)
        _without_span(span)
