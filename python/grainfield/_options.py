"""Options come from the tables of the compiled part: names, units, ranges and defaults stand there
and nowhere else."""
from __future__ import annotations

import warnings
from typing import Any, Callable, TypeVar

from . import _grainfield

_LISTED: dict[str, Callable[[str], list[dict[str, Any]]]] = {
    **dict.fromkeys(("locate", "batch", "track", "link"), _grainfield.options_of_tracking),
    **dict.fromkeys(("simulate_md", "simulate_field", "render"), _grainfield.options_of_simulation),
    "analyze": _grainfield.options_of_analysis,
}
_OBSERVABLES = {"q4": "q4", "msd": "msd", "structure_factor": "sk", "number_variance": "variance",
                "fit_hyperuniform": "fit", "pair_distribution": "gr"}

# Words of trackpy's locate and batch that name steps which a fit of the whole image does not have.
_WITHOUT_COUNTERPART = frozenset({
    "characterize", "engine", "filter_after", "filter_before", "max_iterations", "maxsize",
    "minmass", "noise_size", "percentile", "preprocess", "processes", "separation",
    "smoothing_size", "threshold", "topn"})
# And of its link: there is one exact solver here, for groups of any size. What would change the
# distance (dist_func, to_eucl) is refused as unknown.
_OF_LINKING = frozenset({
    "adaptive_step", "adaptive_stop", "box_size", "copy_features", "diagnostics", "hash_generator",
    "hash_size", "link_strategy", "neighbor_strategy", "retain_index", "verify_integrity"})


def options(job: str) -> list[dict[str, Any]]:
    """The options of a function, as a list of dicts.

    Parameters
    ----------
    job : str
        Name of the function: "locate", "track", "link", "analyze", "q4", "simulate_md", …

    Returns
    -------
    list of dict
        With section, keyword, unit, domain (range or choices), default and meaning;
        ``pandas.DataFrame(gf.options("track"))`` is a table of them.

    Raises
    ------
    OptionError
        If no function of that name has options.
    """
    if job in _OBSERVABLES:
        return _grainfield.options_of_analysis(_OBSERVABLES[job])
    if job not in _LISTED:
        known = ", ".join(sorted([*_LISTED, *_OBSERVABLES]))
        raise _grainfield.OptionError(f"no function with options: '{job}'; expected one of {known}.")
    return _LISTED[job](job)


Function = TypeVar("Function", bound=Callable[..., Any])


def documented(function: Function) -> Function:
    """Adds the options of a function to its docstring."""
    lines = []
    for row in options(function.__name__):
        lines.append(f"    {row['keyword']} : {row['domain']}\n        {row['meaning'].capitalize()}.")
    text = function.__doc__ or ""
    mark = "    Returns\n    -------\n"
    section = "    Other Parameters\n    ----------------\n" + "\n".join(lines) + "\n\n"
    function.__doc__ = text.replace(mark, section + mark, 1)
    return function


def from_trackpy(keywords: dict[str, Any], linking: bool = False) -> dict[str, Any]:
    """Keywords as ours are: trackpy's `invert` is the polarity, others are left out with a warning."""
    ours = {}
    ignored = _OF_LINKING if linking else _WITHOUT_COUNTERPART
    for name, value in keywords.items():
        if name == "invert" and not linking:
            ours["polarity"] = "dark" if value else "bright"
        elif name in ignored:
            warnings.warn(f"'{name}' has no counterpart here and is ignored",
                          _grainfield.GrainfieldWarning, stacklevel=3)
        else:
            ours[name] = value
    return ours
