"""Curves over clearance, one line per material, for Figs 7 to 9."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator

from cylcontact.bodies.material import MaterialRow
from cylcontact.bodies.pair import CylinderPair
from cylcontact.plots import new_figure
from cylcontact.plots.figure import StyledFigure, panel_title, plain_log, round_ticks
from cylcontact.plots.limit_curves import limit_clearances
from cylcontact.plots.style import staggered
from cylcontact.support.arrays import FloatArray

from .paper import FIG7_CLEARANCES, LOADS, RADII

# Where the curves are evaluated, in mm.
CLEARANCES: FloatArray = limit_clearances(FIG7_CLEARANCES)
BAND: dict[str, Any] = {"color": "0.88", "zorder": 0, "linewidth": 0}

Quantity = Callable[[CylinderPair], FloatArray]


def clearance_table(
    rows: Mapping[str, MaterialRow], quantities: Mapping[str, Quantity], R_i: float | None = None
) -> pd.DataFrame:
    """Evaluate quantities by column over the clearances of Figs 7 to 9 for every material."""
    parts = []
    for name, row in rows.items():
        pair = CylinderPair.from_dR("internal", CLEARANCES, row.material, R_i=R_i)
        values = {column: quantity(pair) for column, quantity in quantities.items()}
        parts.append(pd.DataFrame({"material": name, "dR_mm": CLEARANCES, **values}))
    return pd.concat(parts, ignore_index=True)


def tables_by_radius(
    rows: Mapping[str, MaterialRow], quantities: Mapping[str, Quantity]
) -> pd.DataFrame:
    """Return `clearance_table` for every radius of the hole in one table."""
    tables = [clearance_table(rows, quantities, R_i).assign(R_i_mm=R_i) for R_i in RADII]
    return pd.concat(tables, ignore_index=True)


def clearance_panels(
    table: pd.DataFrame, values: pd.Series[float], fine: pd.Series[float] | float = np.nan
) -> tuple[StyledFigure, list[Axes]]:
    """Draw values against clearance, a panel per radius of the hole and a line per material.

    The values, and those of a fine line beside each, are in the order of the table's rows.
    """
    figure = new_figure("full", 78.0)
    panels = list(figure.subplots(1, len(RADII), sharey=True))
    table = table.assign(drawn=values, fine=fine)
    for number, (axes, R_i) in enumerate(zip(panels, RADII, strict=True)):
        draw_materials(axes, table[table["R_i_mm"] == R_i])
        panel_title(axes, number, f"$R_i$ = {R_i:g} mm")
    return figure, panels


def draw_materials(axes: Axes, table: pd.DataFrame) -> None:
    """Draw a line per material through the column `drawn`, and a fine one through `fine`."""
    for number, (name, line) in enumerate(table.groupby("material", sort=False)):
        every = staggered(number, len(line))
        (curve,) = axes.plot(line["dR_mm"], line["drawn"], label=str(name), markevery=every)
        colour = curve.get_color()
        axes.plot(line["dR_mm"], line["fine"], "-", color=colour, linewidth=0.5, marker="")
    plain_log(axes, "x", round_ticks(*FIG7_CLEARANCES))
    axes.set(xlim=FIG7_CLEARANCES, xlabel=r"radial clearance $\Delta R$ (mm)", yscale="log")
    axes.yaxis.set_major_locator(LogLocator(numticks=20))


def mark_loads(axes: Axes) -> None:
    """Shade the loads of Figs 10 to 14."""
    axes.axhspan(*LOADS, **BAND, label="loads of Figs 10 to 14")
