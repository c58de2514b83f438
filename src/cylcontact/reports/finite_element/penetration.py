"""Fig 6: penetration against clearance, finite elements beside the laws."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.laws import LAWS
from cylcontact.materials import Material
from cylcontact.pair import CylinderPair
from cylcontact.plots.figure import new_figure, panel_title, plain_log
from cylcontact.plots.style import COLOURS, LINE_STYLES
from cylcontact.reports.finite_element.data import LAWS_SHOWN

LABELS = {
    "johnson": "Johnson",
    "enhanced": "enhanced",
    "explicit": "explicit (ours)",
    "persson": "Persson",
}
TICKS = (0.005, 0.05, 0.5)


def penetration_panels(table: pd.DataFrame) -> Figure:
    """Draw penetration above, and the laws' difference from finite elements below, by load.

    Parameters
    ----------
    table : pandas.DataFrame
        Columns dR_mm, load_N_per_mm, E_GPa, nu, embedded_mm, calculix_mm.
    """
    loads = sorted(table["load_N_per_mm"].unique())
    figure = new_figure("full", 112.0)
    panels = figure.subplots(2, len(loads), sharex=True, sharey="row", height_ratios=(1.15, 1))
    for number, load in enumerate(loads):
        rows = table[table["load_N_per_mm"] == load]
        _penetrations(panels[0, number], rows)
        panel_title(panels[0, number], number, f"{load:g} N/mm")
        _differences(panels[1, number], rows)
        panels[1, number].set_xlabel(r"$\Delta R$ (mm)")
    panels[0, 0].set_ylabel("penetration (µm)")
    panels[1, 0].set_ylabel("law less finite\nelements (%)")
    handles, labels = panels[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


def _curves(rows: pd.DataFrame) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return clearances in mm and the laws' penetrations in mm at the rows' load."""
    dR = np.geomspace(rows["dR_mm"].min(), rows["dR_mm"].max(), 300)
    first = rows.iloc[0]
    material = Material("steel", 1e3 * first["E_GPa"], first["nu"])
    pair = CylinderPair.from_dR("internal", dR, material)
    load = first["load_N_per_mm"]
    return dR, {name: LAWS[name]().penetration(load, pair) for name in LAWS_SHOWN}


def _style(number: int) -> dict[str, Any]:
    """Return how the curve of a law is drawn."""
    return {"color": COLOURS[number], "linestyle": LINE_STYLES[number], "marker": ""}


def _penetrations(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw every model's penetration."""
    dR, curves = _curves(rows)
    for number, (name, curve) in enumerate(curves.items()):
        axes.plot(dR, 1e3 * curve, label=LABELS[name], **_style(number))
    marks: dict[str, Any] = {"linestyle": "none", "color": COLOURS[0]}
    for column, name, marker in (("embedded", "embedded", "o"), ("calculix", "CalculiX", "x")):
        depths = 1e3 * rows[f"{column}_mm"]
        axes.plot(rows["dR_mm"], depths, marker=marker, label=f"finite elements, {name}", **marks)
    plain_log(axes, "x", TICKS)
    axes.set(xlim=(0.004, 2.0), ylim=(0, 2.8))


def _differences(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw the laws' differences from finite elements."""
    dR, curves = _curves(rows)
    reference = np.exp(np.interp(np.log(dR), np.log(rows["dR_mm"]), np.log(rows["embedded_mm"])))
    for number, curve in enumerate(curves.values()):
        axes.plot(dR, 100 * (curve / reference - 1), **_style(number))
    axes.axhspan(-3, 3, color="0.88", linewidth=0, zorder=0)
    for bound in (-10, 10):
        axes.axhline(bound, color="0.45", linewidth=0.6, linestyle="-", marker="")
    plain_log(axes, "x", TICKS)
    axes.set(xlim=(0.004, 2.0), ylim=(-16, 16))
