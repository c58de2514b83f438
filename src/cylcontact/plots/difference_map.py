"""The map of the difference between two laws against clearance and load, as in Figs 10 to 14."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import TickedStroke, withStroke
from matplotlib.text import Text

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import difference_percent
from cylcontact.laws.law import ContactLaw
from cylcontact.limits import yield_load
from cylcontact.limits.yield_search import Criterion
from cylcontact.plots.arguments import (
    AnyLaw,
    Range,
    as_law,
    axes_for,
    law_label,
    pins_in_hole,
    require_range,
)
from cylcontact.plots.figure import legend_below, plain_log, round_ticks
from cylcontact.plots.maps import add_scale, draw_contours, label_contours
from cylcontact.support.arrays import FloatArray, as_floats, require

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["DR", "LOAD", "map_grid", "map_table", "plot_map"]

DR: Range = (0.0075, 2.0)  # mm, of Figs 10 to 14
LOAD: Range = (10.0, 1000.0)  # N/mm
POINTS = (161, 81)  # along ΔR and along the load
BEYOND: dict[str, Any] = {"facecolor": "0.72", "edgecolor": "0.4", "hatch": "xxxxx", "linewidth": 0}
# Along each side of a text, and along a line, that labels avoid.
TEXT_POINTS, LINE_POINTS = 9, 41


def plot_map(
    law: AnyLaw,
    reference: AnyLaw,
    material: Material,
    *,
    dR: Range = DR,
    load: Range = LOAD,
    R_i: float = 10.0,
    length: float | None = None,
    material_j: Material | None = None,
    criterion: Criterion | None = "von Mises",
    colorbar: bool = True,
    labels: bool = True,
    ax: Axes | None = None,
) -> Axes:
    """Map how far a law's penetration is from a reference's, in percent (Eq 9, Figs 10 to 14).

    Over radial clearance and load, for a pin in a hole. Contours are solid above zero and dashed
    below. Hatched: loads beyond the largest of the reference. White: the law is undefined.

    Parameters
    ----------
    law, reference : ContactLaw or str
        The law and the one that it is compared with, or names in `cylcontact.laws.LAWS`.
    material : Material
        Of both bodies, or of the hole if `material_j` is given.
    dR : tuple of float, optional
        Lowest and highest radial clearance in mm.
    load : tuple of float, optional
        Lowest and highest load per unit length in N/mm.
    R_i : float, optional
        Radius of the hole in mm, on which the yield line depends.
    length : float, optional
        Axial length in mm, for the laws that need it.
    material_j : Material, optional
        Of the pin.
    criterion : {"von Mises", "Tresca", "Hertz"} or None
        Of the yield line, as in `cylcontact.limits.yield_load`; its ticks point to where the
        contact yields. None, or a material without a yield stress, draws none.
    colorbar : bool, optional
        Whether to put the colour scale beside the axes.
    labels : bool, optional
        Whether to label the contours; a small map is read by its colours.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; by default a new figure with a key of the line and the hatching. In your
        own axes call `ax.legend()`; contour labels avoid what is already there.

    Returns
    -------
    matplotlib.axes.Axes
        Both axes logarithmic; `ax.figure.savefig` writes the figure.

    Raises
    ------
    InputError
        If a law, a range, a radius, a criterion or `ax` is wrong, or the difference is not
        defined anywhere in the window.

    Examples
    --------
    >>> from cylcontact import laws
    >>> bronze = Material("bronze", E=110e3, nu=0.34, yield_stress=220.0)
    >>> ax = plot_map(laws.Enhanced(), laws.Johnson(), bronze, load=(10.0, 5000.0))
    >>> ax.get_legend_handles_labels()[1]
    ["beyond Johnson's largest load",
    'first yield (von Mises), $R_i$ = 10 mm; ticked side yields']
    """
    law, reference = as_law(law, "plot_map", "law"), as_law(reference, "plot_map", "reference")
    pair, loads = map_grid(
        reference, material, dR=dR, load=load, R_i=R_i, length=length, material_j=material_j
    )
    percent = difference_percent(law, reference, loads, pair)
    require(
        np.isfinite(percent).any(),
        "plot_map",
        "law, reference",
        (law.name, reference.name),
        "one of them is undefined in the whole window",
        "choose other loads or clearances",
    )
    clearances = as_floats(pair.dR)[:, 0]
    with axes_for(ax, "plot_map", "column", 84.0) as axes:
        plain_log(axes, "x", round_ticks(*dR))
        plain_log(axes, "y", round_ticks(*load))
        axes.set(xlim=dR, ylim=load)
        axes.set(xlabel=r"radial clearance $\Delta R$ (mm)", ylabel="load (N/mm)")
        if colorbar:
            label = f"penetration, {law_label(law.name)} less {law_label(reference.name, True)} (%)"
            add_scale(axes.figure, axes, label)
        lines = draw_contours(axes, np.broadcast_to(pair.dR, loads.shape), loads, percent)
        ends = np.broadcast_to(reference.max_load(pair), (POINTS[0], 1))[:, 0]
        _shade_beyond(axes, clearances, ends, load, law_label(reference.name, True))
        if criterion is not None and _has_yield_stress(pair):
            words = f"first yield ({criterion}), $R_i$ = {R_i:g} mm"
            _draw_yield_line(axes, clearances, yield_load(pair, criterion)[:, 0], load, words)
        if ax is None:
            legend_below(axes)
        if labels:
            _settle_layout(axes)
            label_contours(axes, lines, _taken(axes))
    return axes


def map_grid(
    reference: ContactLaw,
    material: Material,
    *,
    dR: Range = DR,
    load: Range = LOAD,
    R_i: float = 10.0,
    length: float | None = None,
    material_j: Material | None = None,
) -> tuple[CylinderPair, FloatArray]:
    """Return the clearances and loads at which `plot_map` evaluates the laws.

    They are spaced logarithmically; the loads end where the reference does, so that a map is
    filled exactly to that line.

    Examples
    --------
    >>> from cylcontact import laws
    >>> aluminium = Material("aluminium", E=69e3, nu=0.33)
    >>> pair, loads = map_grid(laws.Johnson(), aluminium)
    >>> print(f"{loads[0, -1]:.1f} N/mm at {pair.dR[0, 0]} mm, {loads[-1, -1]:.0f} at 2 mm")
    493.8 N/mm at 0.0075 mm, 1000 at 2 mm
    """
    require_range(dR, "plot_map", "dR", "mm")
    require_range(load, "plot_map", "load", "N/mm")
    u, v = (np.linspace(0.0, 1.0, count) for count in POINTS)
    # The bounds themselves, not a rounding error beyond them: a law may end there.
    clearances = np.clip(dR[0] * (dR[1] / dR[0]) ** u, *dR)[:, np.newaxis]
    pair = pins_in_hole(as_floats(clearances), "plot_map", material, R_i, material_j, length)
    low = load[0]
    top = np.minimum(reference.max_load(pair), load[1])
    top = np.where(top >= low, top, np.nan)
    return pair, as_floats(np.minimum(low * (top / low) ** v, top) * np.ones(POINTS))


def map_table(
    law: ContactLaw, reference: ContactLaw, material: Material, **window: Any
) -> pd.DataFrame:
    """Return the numbers of `plot_map` at clearances and loads of a rectangular grid.

    The loads are the same for every clearance; beyond the end of the reference its penetration and
    the difference are NaN.

    Parameters
    ----------
    law, reference : ContactLaw
        As for `plot_map`.
    material : Material
        Of both bodies, or of the hole if `material_j` is given.
    **window
        `dR`, `load`, `R_i`, `length` and `material_j` of `plot_map`.

    Returns
    -------
    pandas.DataFrame
        Clearance in mm, load in N/mm, both penetrations in mm, their difference in percent (Eq 9)
        and, where the yield stress is given, the load at first yield in N/mm.

    Examples
    --------
    >>> from cylcontact import laws
    >>> aluminium = Material("aluminium", E=69e3, nu=0.33)
    >>> table = map_table(laws.Enhanced(), laws.Johnson(), aluminium)
    >>> len(table), table["difference_percent"].abs().max().round(1)
    (13041, np.float64(69.1))
    """
    import pandas as pd

    pair, _ = map_grid(reference, material, **window)
    low, high = window.get("load", LOAD)
    load = as_floats(np.broadcast_to(np.geomspace(low, high, POINTS[1]), POINTS))
    columns = {
        "dR_mm": pair.dR,
        "load_N_per_mm": load,
        "penetration_mm": law.penetration(load, pair),
        f"{reference.name}_penetration_mm": reference.penetration(load, pair),
        "difference_percent": difference_percent(law, reference, load, pair),
    }
    if _has_yield_stress(pair):
        columns["yield_load_N_per_mm"] = yield_load(pair)
    rows = {name: np.broadcast_to(value, load.shape).ravel() for name, value in columns.items()}
    return pd.DataFrame(rows)


def _has_yield_stress(pair: CylinderPair) -> bool:
    """Return whether both materials have a yield stress."""
    return None not in (pair.material_i.yield_stress, pair.material_j.yield_stress)


def _shade_beyond(axes: Axes, dR: FloatArray, ends: FloatArray, load: Range, whose: str) -> None:
    """Shade the loads beyond the reference's largest one, if there are any in the window."""
    low, high = load
    if (ends >= high).all():
        return
    words = f"beyond {whose} largest load"
    axes.fill_between(dR, np.clip(ends, low, high), high, **BEYOND, label=words)
    axes.plot(dR, ends, "-", color="black", linewidth=0.8, marker="")


def _draw_yield_line(
    axes: Axes, dR: FloatArray, limit: FloatArray, load: Range, words: str
) -> None:
    """Draw the load at which the contact yields, with ticks on the side that yields."""
    comb = TickedStroke(spacing=6, angle=90, length=0.6, linewidth=0.8, foreground="black")
    line: dict[str, Any] = {
        "color": "black",
        "linewidth": 1.6,
        "marker": "",
        "path_effects": [withStroke(linewidth=3.2, foreground="white"), comb],
    }
    if ((limit > load[0]) & (limit < load[1])).any():
        axes.plot(dR, limit, linestyle="-", **line, label=f"{words}; ticked side yields")


def _settle_layout(axes: Axes) -> None:
    """Let a figure that arranges itself do so, because labels are placed in pixels."""
    figure = axes.figure.canvas.figure  # the whole one, where the axes are in a part of it
    if figure.get_layout_engine() is not None:
        figure.draw_without_rendering()


def _taken(axes: Axes) -> FloatArray:
    """Return points along the lines and over the texts in the axes, in data coordinates."""
    # Of an annotation the words alone, not its arrow.
    boxes = [Text.get_window_extent(text) for text in axes.texts]
    share = np.linspace(0.0, 1.0, TEXT_POINTS)
    grid = np.stack(np.meshgrid(share, share), axis=-1).reshape(-1, 2)
    texts = [box.min + grid * box.size for box in boxes if box.overlaps(axes.bbox)]
    paths = [line.get_transform().transform_path(line.get_path()) for line in axes.lines]
    lines = [path.interpolated(max(1, LINE_POINTS // len(path))).vertices for path in paths]
    points = np.concatenate([np.empty((0, 2)), *texts, *lines])
    inside = np.isfinite(points).all(axis=1) & (abs(points - axes.bbox.min) < 1e4).all(axis=1)
    return as_floats(axes.transData.inverted().transform(points[inside]))
