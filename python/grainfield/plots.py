"""Pictures of what was found, in trackpy's words. They need matplotlib."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from . import _grainfield

if TYPE_CHECKING:
    import matplotlib.axes
    import pandas


def _axes(ax: Any) -> Any:
    if ax is not None:
        return ax
    try:
        import matplotlib.pyplot as plt
    except ImportError as missing:
        raise ImportError("plots need matplotlib (Debian: python3-matplotlib)") from missing
    return plt.gca()


def _show(ax: Any, image: Any, **style: Any) -> None:
    ax.imshow(np.asarray(image), **{"cmap": "gray", "origin": "upper", "interpolation": "nearest", **style})


def annotate(centroids: "pandas.DataFrame", image: Any, color: Any = "r", ax: Any = None,
             imshow_style: dict[str, Any] | None = None,
             plot_style: dict[str, Any] | None = None) -> "matplotlib.axes.Axes":
    """Circles around what was found in an image.

    Parameters
    ----------
    centroids : DataFrame
        x and y; circles have the diameter that locate measured, else 15 points.
    image : array, shape (height, width)
    color : color
    ax : Axes, optional
        The current ones by default.
    imshow_style, plot_style : dict, optional
        For ``Axes.imshow`` and ``Axes.plot``.

    Returns
    -------
    Axes
    """
    ax = _axes(ax)
    _show(ax, image, **(imshow_style or {}))
    diameter = centroids.attrs.get("grainfield", {}).get("diameter")
    if diameter and not plot_style:
        from matplotlib.collections import EllipseCollection

        size = np.full(len(centroids), diameter)
        ax.add_collection(EllipseCollection(size, size, 0, units="xy", offsets=centroids[["x", "y"]].to_numpy(),
                                            offset_transform=ax.transData, facecolors="none", edgecolors=color))
    else:
        ax.plot(centroids["x"], centroids["y"], **{"marker": "o", "linestyle": "none", "markersize": 15,
                                                   "markerfacecolor": "none", "markeredgecolor": color,
                                                   **(plot_style or {})})
    return ax


def plot_traj(traj: "pandas.DataFrame", colorby: str = "particle", mpp: float | None = None, label: bool = False,
              superimpose: Any = None, cmap: Any = None, ax: Any = None, t_column: str = "frame",
              pos_columns: tuple[str, str] = ("x", "y"), plot_style: dict[str, Any] | None = None) -> "matplotlib.axes.Axes":
    """Lines along the tracks, y down as in the frames.

    Parameters
    ----------
    traj : DataFrame
        Linked: particle, `t_column` and positions.
    colorby : {"particle", "frame"}
        One colour a track, or one a frame.
    mpp : float, optional
        Micrometres a pixel; without it pixels.
    label : bool
        Write the identity at the begin of each track.
    superimpose : array, optional
        An image below them.
    cmap : colormap, optional
        For ``colorby="frame"``.
    ax, t_column, pos_columns, plot_style
        Axes, columns, and what ``Axes.plot`` is to be told.

    Returns
    -------
    Axes

    Raises
    ------
    InputError
        If the table is empty.
    """
    if len(traj) == 0:
        raise _grainfield.InputError("there are no tracks to plot.")
    ax = _axes(ax)
    scale = 1.0 if mpp is None else float(mpp)
    if superimpose is not None:
        height, width = np.shape(superimpose)[:2]
        _show(ax, superimpose, extent=(-0.5 * scale, (width - 0.5) * scale, (height - 0.5) * scale, -0.5 * scale))
    style = {"linewidth": 1, **(plot_style or {})}
    x, y = pos_columns
    ordered = traj.sort_values(["particle", t_column])
    for particle, track in ordered.groupby("particle", sort=False):
        places = scale * track[[x, y]].to_numpy(float)
        if colorby == "frame":
            from matplotlib.collections import LineCollection

            lines = LineCollection(np.stack([places[:-1], places[1:]], axis=1), cmap=cmap or "winter",
                                   array=track[t_column].to_numpy(float)[1:], **style)
            lines.set_clim(float(traj[t_column].min()), float(traj[t_column].max()))
            ax.add_collection(lines)
            ax.autoscale_view()
        else:
            ax.plot(places[:, 0], places[:, 1], **style)
        if label:
            ax.text(*places[0], f"{particle:d}", ha="center", va="center")
    unit = "px" if mpp is None else "µm"
    ax.set(xlabel=f"{x} [{unit}]", ylabel=f"{y} [{unit}]")
    if not ax.yaxis_inverted():
        ax.invert_yaxis()
    return ax
