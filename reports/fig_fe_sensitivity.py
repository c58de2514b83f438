"""Effect on the finite elements' penetration of each choice that Section 3.2 leaves open."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FixedFormatter, FixedLocator

from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.plots.style import COLOURS, MARKERS
from cylcontact.reports.bench import Bench

from .finite_elements import choices, sensitivity_table, table

CAPTION = (
    "What changing one choice of the finite-element set-up does to the penetration (mm) of the "
    "pin's centre; open marks 20 N/mm, filled ones 100 N/mm. (a) Change in percent. (b) The same "
    "as a change of the additive constant C in δ = f/(πE*)·(ln(πE*ΔR/f) + C): outer radius, load "
    "and clamp shift it alike at every clearance and load, and neither the contact nor the law "
    "that follows from it. The 'cells' are those over the contact's half-width; 16 in the set-up "
    "itself. Variants are our choice. {choices}"
)


def draw(bench: Bench) -> Drawing:
    numbers = sensitivity_table(table(bench, "sensitivity"))
    sizes = numbers.groupby("variant", sort=False)["change_percent"]
    headline = {f"{name}: largest change, %": values.abs().max() for name, values in sizes}
    caption = CAPTION.format(choices=choices(bench))
    return Drawing(_draw_panels(numbers), numbers, headline, caption)


def _draw_panels(table: pd.DataFrame) -> Figure:
    """Draw a row for each variant: the change in percent, and of the additive constant."""
    figure = new_figure("full", 92.0)
    panels = figure.subplots(1, 2, sharey=True)
    variants = list(dict.fromkeys(table["variant"]))
    quantities = {
        "change_percent": ("change of the penetration (%)", "percent", (0.1, 1, 10, 100)),
        "constant": (
            "change of C (-)",
            r"$\pi E^* \Delta\delta / f$",
            (0.01, 0.1, 1, 10),
        ),
    }
    for number, (axes, (column, (label, title, ticks))) in enumerate(
        zip(panels, quantities.items(), strict=True)
    ):
        for place, (dR, rows) in enumerate(table.groupby("dR_mm")):
            for load, marked in rows.groupby("load_N_per_mm"):
                low = load == table["load_N_per_mm"].min()
                height = [variants.index(name) for name in marked["variant"]]
                axes.plot(
                    marked[column],
                    np.array(height) + 0.16 * (place - 1.5),
                    linestyle="none",
                    marker=MARKERS[place],
                    color=COLOURS[place],
                    markerfacecolor="white" if low else COLOURS[place],
                    label=rf"$\Delta R$ = {dR:g} mm, {load:g} N/mm",
                )
        axes.axvline(0, color="0.45", linewidth=0.6, linestyle="-", marker="")
        both = [*(-tick for tick in reversed(ticks[1:-1])), 0, *ticks[1:]]
        axes.set_xscale("symlog", linthresh=ticks[1], linscale=0.6)
        axes.xaxis.set_major_locator(FixedLocator(both))
        axes.xaxis.set_major_formatter(FixedFormatter([f"{tick:g}" for tick in both]))
        axes.set_xlim(-3 * ticks[-2], ticks[-1])
        axes.set_xlabel(label)
        panel_title(axes, number, title)
    panels[0].set_yticks(range(len(variants)), variants)
    panels[0].set_ylim(len(variants) - 0.4, -0.6)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure
