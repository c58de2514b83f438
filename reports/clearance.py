"""Curves over clearance, one line per material, for Figs 7 to 9."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from cylcontact.arrays import FloatArray
from cylcontact.materials import MaterialRow
from cylcontact.pair import CylinderPair
from cylcontact.plots.figure import new_figure, panel_title, plain_log
from cylcontact.plots.maps import RIM
from cylcontact.plots.style import COLOURS, LINE_STYLES, MARKERS

from .paper import FIG7_CLEARANCES, RADII

# Where the curves are evaluated, in mm.
CLEARANCES: FloatArray = np.geomspace(*FIG7_CLEARANCES, 100)
CLEARANCE_TICKS = (0.001, 0.01, 0.1, 1)
CLEARANCE_LABEL = r"radial clearance $\Delta R$ (mm)"

Quantity = Callable[[CylinderPair], FloatArray]


def clearance_table(
    rows: Mapping[str, MaterialRow], quantity: Quantity, column: str, R_i: float | None = None
) -> pd.DataFrame:
    """Evaluate a quantity over the clearances of Figs 7 to 9 for every material."""
    parts = []
    for name, row in rows.items():
        pair = CylinderPair.from_dR("internal", CLEARANCES, row.material, R_i=R_i)
        values = {"material": name, "dR_mm": CLEARANCES, column: quantity(pair)}
        parts.append(pd.DataFrame(values))
    return pd.concat(parts, ignore_index=True)


def clearance_panels(
    rows: Mapping[str, MaterialRow],
    quantity: Quantity,
    column: str,
    label: str,
) -> tuple[Figure, list[Axes], pd.DataFrame]:
    """Draw a quantity against clearance, a panel per radius of the hole and a line per material."""
    figure = new_figure("full", 72.0)
    panels = list(figure.subplots(1, len(RADII), sharey=True))
    tables = []
    for number, (axes, R_i) in enumerate(zip(panels, RADII, strict=True)):
        table = clearance_table(rows, quantity, column, R_i)
        draw_materials(axes, table, column)
        panel_title(axes, number, f"$R_i$ = {R_i:g} mm")
        tables.append(table.assign(R_i_mm=R_i))
    panels[0].set_ylabel(label)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(
        handles,
        labels,
        loc="outside lower center",
        ncols=len(labels),
        title="material; all yield stresses are assumed",
    )
    return figure, panels, pd.concat(tables, ignore_index=True)


def draw_materials(axes: Axes, table: pd.DataFrame, column: str) -> None:
    """Draw one line per material on logarithmic axes."""
    for number, (name, lines) in enumerate(table.groupby("material", sort=False)):
        # Staggered, so that no marker hides another line's.
        dR, values = lines["dR_mm"].to_numpy(), lines[column].to_numpy()
        every = (2 + 4 * number % 25, 25)
        axes.plot(dR, values, label=str(name), markevery=every, **_line_style(number))
    plain_log(axes, "x", CLEARANCE_TICKS)
    axes.set(xlabel=CLEARANCE_LABEL, xlim=(CLEARANCES[0], CLEARANCES[-1]))
    _decades_log(axes)


def _line_style(number: int) -> dict[str, Any]:
    """Return the colour, line style and marker of a material's line, unique up to 25 lines."""
    colour, turn = number % len(COLOURS), number // len(COLOURS)
    other = (colour + turn) % len(COLOURS)
    return {"color": COLOURS[colour], "linestyle": LINE_STYLES[other], "marker": MARKERS[other]}


def _decades_log(axes: Axes) -> None:
    """Make the vertical axis logarithmic with a tick at every decade, labelled as room allows."""
    axes.set_yscale("log")
    axes.yaxis.set_minor_locator(LogLocator(subs=(1.0,), numticks=20))
    axes.yaxis.set_minor_formatter(NullFormatter())


def mark_point(
    axes: Axes, dR: float, value: float, label: str, offset: tuple[float, float]
) -> None:
    """Mark a point with a star and label it, the label `offset` points away."""
    axes.plot(dR, value, marker="*", color="black", markerfacecolor="black", markersize=6, zorder=5)
    axes.annotate(
        label,
        xy=(dR, value),
        xytext=offset,
        textcoords="offset points",
        arrowprops={"arrowstyle": "-", "linewidth": 0.5, "shrinkA": 1, "shrinkB": 3},
        path_effects=[RIM],
    )


def mark_yield(axes: Axes, dR: float, stress: float, number: int) -> None:
    """Mark where the line of material `number` reaches its yield stress (MPa), at `dR` (mm)."""
    style = _line_style(number)
    colour = style["color"]
    ends = ([CLEARANCES[0], dR], [stress, stress])
    axes.plot(*ends, **style | {"marker": ""}, linewidth=0.5)
    axes.plot(dR, stress, marker="*", color=colour, markerfacecolor=colour, markersize=6, zorder=5)
