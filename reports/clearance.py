"""Curves over clearance, one line per material, for Figs 7 to 9."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import pandas as pd
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.arrays import FloatArray
from cylcontact.materials import MaterialRow
from cylcontact.pair import CylinderPair
from cylcontact.plots import new_figure, plot_limits
from cylcontact.plots.figure import panel_title
from cylcontact.plots.limit_curves import limit_clearances
from cylcontact.plots.maps import RIM

from .paper import FIG7_CLEARANCES, RADII

# Where the curves are evaluated, in mm.
CLEARANCES: FloatArray = limit_clearances(FIG7_CLEARANCES)

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
    rows: Mapping[str, MaterialRow], quantity: Quantity, column: str, **limits: Any
) -> tuple[Figure, list[Axes], pd.DataFrame]:
    """Draw a limit against clearance, a panel per radius of the hole and a line per material.

    `limits` are settings of `plot_limits` that make it draw the quantity that the table lists.
    """
    figure = new_figure("full", 72.0)
    panels = list(figure.subplots(1, len(RADII), sharey=True))
    tables = []
    for number, (axes, R_i) in enumerate(zip(panels, RADII, strict=True)):
        draw_materials(axes, rows, R_i=R_i, **limits)
        panel_title(axes, number, f"$R_i$ = {R_i:g} mm")
        tables.append(clearance_table(rows, quantity, column, R_i).assign(R_i_mm=R_i))
    for axes in panels[1:]:
        axes.set_ylabel("")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(
        handles,
        labels,
        loc="outside lower center",
        ncols=len(labels),
        title="material; all yield stresses are assumed",
    )
    return figure, panels, pd.concat(tables, ignore_index=True)


def draw_materials(axes: Axes, rows: Mapping[str, MaterialRow], **limits: Any) -> None:
    """Draw one line per material."""
    for name, row in rows.items():
        plot_limits(row.material, dR=FIG7_CLEARANCES, ax=axes, label=name, **limits)


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
    style = list(rcParams["axes.prop_cycle"])[number]
    colour = style["color"]
    ends = ([CLEARANCES[0], dR], [stress, stress])
    axes.plot(*ends, **style | {"marker": ""}, linewidth=0.5)
    axes.plot(dR, stress, marker="*", color=colour, markerfacecolor=colour, markersize=6, zorder=5)
