"""The recovered coefficients, searched again under other assumptions about the paper's fit.

`searched_readings` made the table.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, MultipleLocator, NullLocator

from cylcontact.plots.figure import Drawing, StyledFigure, new_figure, panel_title
from cylcontact.plots.style import COLOURS, MARKERS, QUIET
from cylcontact.reports.bench import Bench

from .searched_readings import OTHER_SAMPLES, POINTS_CHANGED, readings

CAPTION = (
    "Difference of the recovered coefficients from the published ones (%) under {count} "
    "assumptions on what the paper does not say about its fit. (a-c) The number of points on each "
    "axis of the samples. (d-f) Other choices, at 20 points; marks as above. Internal contact: x1 "
    "= a = 10b and x2 = Y_log_scale. The assumptions are ours."
)
METHOD = (
    "Each assumption changes the campaign recovered-internal or recovered-external, which has 20 "
    "points on every axis, in one respect or two. For external contact the search is made twice, "
    'with n fixed at the published value and with n free. "Spacing" is every other combination '
    'of linear and logarithmic spacing of E, ΔR and the load; "other end of E" combines it with '
    'the other of the two upper ends of E, 1000 and 10 000 GPa. "Samples of the other contact" '
    "has the spacings and the end of E of the other campaign. A lattice over the bounds and local "
    "descents find the coefficients, without a genetic search. The numbers are those of "
    "datasets/readings.csv, written by `make readings`."
)
# What the panels call the searches, and the symbols of the coefficients.
PANELS: Mapping[str, tuple[str, Mapping[str, str]]] = {
    "internal": ("internal", {"a": "$x_1$", "Y_log_scale": "$x_2$"}),
    "external, n fixed": ("external, $n$ fixed", {"a": "$a$", "b": "$b$"}),
    "external, n free": ("external, $n$ free", {"a": "$a$", "b": "$b$", "n": "$n$"}),
}
# Ends of the axes of differences, in percent.
REFINED, CHANGED = (-20.0, 55.0), (-78.0, 63.0)
APART = 0.28


def draw(bench: Bench) -> Drawing:
    table = readings(bench)
    count = len(table.drop_duplicates(["contact", "changed", "reading"]))
    headline = {"readings": float(count)}
    of_points = np.where(table["changed"] == POINTS_CHANGED, "points", "other changes")
    groups = table.groupby(["search", "coefficient", of_points], sort=False)["difference_percent"]
    for (search, name, what), differences in groups:
        headline |= {
            f"{search}: {name}, {what}: {end} difference, %": float(value)
            for end, value in (("lowest", differences.min()), ("highest", differences.max()))
        }
    return Drawing(_draw_panels(table), table, headline, CAPTION.format(count=count), METHOD)


def _draw_panels(table: pd.DataFrame) -> StyledFigure:
    """Draw refinement above every other change, a column for each search."""
    figure = new_figure("full", 118.0)
    panels = figure.subplots(2, 3, sharey="row", height_ratios=[1, 1.3])
    for column, (search, (title, names)) in enumerate(PANELS.items()):
        rows = table[table["search"] == search]
        _draw_refinement(panels[0, column], rows[rows["changed"] == POINTS_CHANGED], names)
        _draw_changes(panels[1, column], rows[rows["changed"] != POINTS_CHANGED], names)
        panel_title(panels[0, column], column, title)
        panel_title(panels[1, column], len(PANELS) + column, title)
    panels[0, 0].set_ylabel("difference (%)")
    return figure


def _draw_refinement(axes: Axes, rows: pd.DataFrame, names: Mapping[str, str]) -> None:
    """Draw the differences over the number of points per axis."""
    axes.axhline(0, color=QUIET, linewidth=0.5, marker="")
    for number, (name, symbol) in enumerate(names.items()):
        line = rows[rows["coefficient"] == name]
        axes.plot(
            line["reading"].astype(int),
            line["difference_percent"],
            color=COLOURS[number],
            marker=MARKERS[number],
            label=symbol,
        )
    axes.set(xscale="log", ylim=REFINED, xlabel="points on each axis")
    axes.xaxis.set_major_locator(FixedLocator([8, 20, 50, 100]))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter("{x:g}")
    axes.legend(loc="upper left")


def _draw_changes(axes: Axes, rows: pd.DataFrame, names: Mapping[str, str]) -> None:
    """Draw the differences of all other readings, by what is changed."""
    changes = sorted(dict.fromkeys(rows["changed"]), key=lambda change: change == OTHER_SAMPLES)
    axes.axvline(0, color=QUIET, linewidth=0.5, marker="")
    for number, name in enumerate(names):
        offset = APART * (number - (len(names) - 1) / 2)
        dots = rows[rows["coefficient"] == name]
        axes.plot(
            dots["difference_percent"],
            [changes.index(change) + offset for change in dots["changed"]],
            color=COLOURS[number],
            marker=MARKERS[number],
            linestyle="none",
        )
    for place in range(0, len(changes), 2):
        axes.axhspan(place - 0.5, place + 0.5, color="0.94", linewidth=0, zorder=0)
    axes.set(xlim=CHANGED, ylim=(len(changes) - 0.5, -0.5), xlabel="difference (%)")
    axes.xaxis.set_major_locator(MultipleLocator(25))
    axes.set_yticks(range(len(changes)), changes)
    axes.tick_params(axis="y", length=0)
