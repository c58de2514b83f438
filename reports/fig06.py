"""Fig 6: penetration against clearance by finite elements, and the laws' differences from it."""

from __future__ import annotations

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from cylcontact.plots.figure import Drawing, legend_below, new_figure, panel_title, plain_log
from cylcontact.plots.maps import signed
from cylcontact.plots.style import QUIET
from cylcontact.reports.bench import Bench

from .finite_elements import choices, penetrations, table
from .paper import FIG6_WIDE

CAPTION = (
    "(a) Penetration (µm) of the pin's centre by our finite elements against ΔR (mm); E = 207 "
    "GPa, ν = 0.3, R_i = 2.245 mm. (b-d) Penetrations by three laws less those of (a), in percent "
    "of (a); scale linear within ±1 %, logarithmic beyond. Grey: the paper's bounds for Johnson's "
    "and the enhanced law."
)
METHOD = (
    "The laws are Johnson's (Eq 1), the enhanced law with the published coefficients (Eqs 5-6), "
    "and our explicit law. CalculiX, with the same mesh, and Persson's conformal solution are in "
    "the table. Points are at the clearances computed; the "
    "lines between them guide the eye. The paper states 3 % above 0.445 mm and 10 % over all "
    "clearances, for its two laws only; (d) repeats the bounds. {choices}"
)
MODELS = {
    "johnson": "Johnson's law",
    "enhanced": "enhanced law",
    "explicit": "explicit law",
}
LEVELS = (-10, -3, -1, 0, 1, 3, 10)  # percent
TICKS = (0.01, 0.1, 1.0)
WIDEST = 2.0


def draw(bench: Bench) -> Drawing:
    rows = table(bench, "recommended")
    calculix = table(bench, "recommended", "calculix")
    numbers = penetrations(rows).rename(columns={"fe_mm": "embedded_mm"})
    numbers.insert(3, "calculix_mm", calculix["penetration_mm"].to_numpy())
    numbers = numbers.assign(E_GPa=rows["E_GPa"], nu=rows["nu"])
    headline = {}
    for load, group in numbers.groupby("load_N_per_mm"):
        for law in ("johnson", "enhanced", "explicit", "calculix"):
            difference = (100 * (group[f"{law}_mm"] / group["embedded_mm"] - 1)).abs().max()
            headline[f"{load:g} N/mm: {law} less finite elements, largest, %"] = difference
    method = METHOD.format(choices=choices(bench))
    return Drawing(_draw_panels(numbers), numbers, headline, CAPTION, method)


def _draw_panels(table: pd.DataFrame) -> Figure:
    """Draw the penetration, and in a panel for each other model its difference, a line per load."""
    figure = new_figure("full", 62.0)
    panels = figure.subplots(1, 4, sharex=True)
    first, *others = panels.flat
    _draw_loads(first, table, 1e3 * table["embedded_mm"])
    panel_title(first, 0, "finite elements")
    first.set(ylabel="penetration (µm)", ylim=(0, 2.8))
    for number, (axes, (model, name)) in enumerate(zip(others, MODELS.items(), strict=True), 1):
        _draw_loads(axes, table, 100 * (table[f"{model}_mm"] / table["embedded_mm"] - 1))
        panel_title(axes, number, name)
        axes.set(ylabel="difference (%)", ylim=(-20, 20))
        axes.set_yscale("symlog", linthresh=1.0, linscale=0.7)
        axes.yaxis.set_major_locator(FixedLocator(LEVELS))
        axes.yaxis.set_major_formatter(lambda percent, _: signed(percent))
        axes.yaxis.set_minor_locator(NullLocator())
        axes.axhspan(-10, 10, color="0.93", linewidth=0, zorder=0, label="paper: within 10 %")
        wide = {"color": "0.82", "linewidth": 0, "zorder": 0.1}
        from_wide = f"within 3 % from {FIG6_WIDE:g} mm on"
        axes.fill_between([FIG6_WIDE, WIDEST], -3, 3, **wide, label=from_wide)
        axes.axhline(0, color=QUIET, linewidth=0.6, linestyle="-", marker="", zorder=0.2)
    legend_below(others[0], 5)
    return figure


def _draw_loads(axes: Axes, table: pd.DataFrame, values: pd.Series[float]) -> None:
    """Draw values in the order of the table's rows against clearance, a line per load."""
    for load, drawn in values.groupby(table["load_N_per_mm"]):
        axes.plot(table.loc[drawn.index, "dR_mm"], drawn, label=f"{load:g} N/mm")
    plain_log(axes, "x", TICKS)
    axes.set(xlim=(0.004, WIDEST), xlabel=r"$\Delta R$ (mm)")
