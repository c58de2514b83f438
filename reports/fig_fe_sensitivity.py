"""Effect on the finite elements' penetration of each choice that Section 3.2 leaves open."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedFormatter, FixedLocator

from cylcontact.plots.figure import Drawing, figure_of_lines, legend_below, panel_title
from cylcontact.plots.maps import signed
from cylcontact.plots.style import COLOURS, MARKERS, QUIET
from cylcontact.reports.bench import Bench

from .finite_elements import choices, sensitivity_table, table

CAPTION = (
    "What changing one choice of the finite-element set-up does to the penetration of the pin's "
    "centre, for four clearances ΔR (mm) and two loads. (a) Change (%). (b) The same as a change "
    "of the constant C (-) in δ = f/(πE*)·(ln(πE*ΔR/f) + C). Axes are linear in the grey band and "
    "logarithmic outside."
)
METHOD = (
    "Outer radius, the load's distribution and clamp shift C alike at every clearance and load; "
    "neither the contact nor the law that follows from it changes. The cells are those over the "
    "contact's half-width. The variants are our choice. {choices}"
)


class Quantity(NamedTuple):
    """A column of the table, how a panel calls it, and the decades of its axis."""

    column: str
    title: str
    label: str
    decades: tuple[float, float]


QUANTITIES = (
    Quantity("change_percent", "change of the penetration", "change (%)", (1.0, 100.0)),
    Quantity("constant", "change of the constant", "change of $C$ (-)", (0.1, 10.0)),
)
# Distance of the clearances in a row, and the size of their marks relative to the style's.
APART, SMALL = 0.21, 0.9


def draw(bench: Bench) -> Drawing:
    numbers = sensitivity_table(table(bench, "sensitivity"))
    sizes = numbers.groupby("variant", sort=False)["change_percent"]
    headline = {f"{name}: largest change, %": values.abs().max() for name, values in sizes}
    method = METHOD.format(choices=choices(bench))
    return Drawing(_draw_panels(numbers), numbers, headline, CAPTION, method)


def _draw_panels(table: pd.DataFrame) -> Figure:
    """Draw a row for each variant: the change in percent, and of the additive constant."""
    variants = list(dict.fromkeys(table["variant"]))
    figure = figure_of_lines("full", 2 * len(variants) + 8)
    panels = figure.subplots(1, 2, sharey=True)
    for number, (axes, quantity) in enumerate(zip(panels, QUANTITIES, strict=True)):
        _draw_changes(axes, table, quantity, variants)
        _signed_log(axes, *quantity.decades)
        axes.set_xlabel(quantity.label)
        panel_title(axes, number, quantity.title)
    panels[0].set_yticks(range(len(variants)), variants)
    panels[0].set_ylim(len(variants) - 0.5, -0.7)
    legend_below(panels[0], 4)
    return figure


def _draw_changes(
    axes: Axes, table: pd.DataFrame, quantity: Quantity, variants: Sequence[str]
) -> None:
    """Draw one quantity of all cases, the clearances of a variant below each other."""
    for row in range(1, len(variants), 2):
        axes.axhspan(row - 0.5, row + 0.5, color="0.96", linewidth=0, zorder=0)
    lowest = table["load_N_per_mm"].min()
    for place, (dR, rows) in enumerate(table.groupby("dR_mm")):
        for load, marked in rows.groupby("load_N_per_mm"):
            axes.plot(
                marked[quantity.column],
                marked["variant"].map(variants.index) + APART * (place - 1.5),
                linestyle="none",
                marker=MARKERS[place],
                markersize=SMALL * rcParams["lines.markersize"],
                color=COLOURS[place],
                markerfacecolor="white" if load == lowest else COLOURS[place],
                label=rf"$\Delta R$ = {dR:g} mm, {load:g} N/mm",
            )


def _signed_log(axes: Axes, smallest: float, largest: float) -> None:
    """Make an axis linear between plus and minus the first decade, which is grey."""
    decades = np.geomspace(smallest, largest, round(np.log10(largest / smallest)) + 1)
    axes.axvspan(-smallest, smallest, color="0.88", linewidth=0, zorder=0.5)
    axes.axvline(0, color=QUIET, linewidth=0.6, linestyle="-", marker="", zorder=0.6)
    axes.set_xscale("symlog", linthresh=smallest, linscale=0.6)
    ticks = [*-decades[-2::-1], 0.0, *decades]
    axes.xaxis.set_major_locator(FixedLocator(ticks))
    axes.xaxis.set_major_formatter(FixedFormatter([signed(tick) for tick in ticks]))
    axes.set_xlim(-3 * decades[-2], 1.3 * largest)
