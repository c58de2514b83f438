"""Fig 6: penetration against clearance: finite elements, Johnson, the enhanced and other laws."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.laws import LAWS
from cylcontact.materials import Material
from cylcontact.pair import CylinderPair
from cylcontact.plots.figure import Drawing, new_figure, panel_title, plain_log
from cylcontact.plots.style import COLOURS, LINE_STYLES
from cylcontact.reports.bench import Bench

from .finite_elements import LAWS_COMPARED, choices, penetrations, table

CAPTION = (
    "Penetration of the pin's centre against ΔR (mm) at 20, 40 and 100 N/mm, E = 207 GPa, ν = 0.3, "
    "hole of radius 2.245 mm. Above (µm): finite elements, embedded and by CalculiX, beside "
    "Johnson's law (Eq 1), the enhanced law with the published coefficients (Eqs 5-6), our "
    "explicit law and Persson's conformal solution. Below: each law less finite elements, in "
    "percent, interpolated between the clearances computed; grey, the 3 % that the paper states "
    "above 0.445 mm, and lines at its 10 %. {choices}"
)
LABELS = {
    "johnson": "Johnson",
    "enhanced": "enhanced",
    "explicit": "explicit (ours)",
    "persson": "Persson",
}
TICKS = (0.005, 0.05, 0.5)


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
    caption = CAPTION.format(choices=choices(bench))
    return Drawing(_draw_panels(numbers), numbers, headline, caption)


def _draw_panels(table: pd.DataFrame) -> Figure:
    """Draw penetration above, and the laws' difference from finite elements below, by load."""
    loads = sorted(table["load_N_per_mm"].unique())
    figure = new_figure("full", 112.0)
    panels = figure.subplots(2, len(loads), sharex=True, sharey="row", height_ratios=(1.15, 1))
    for number, load in enumerate(loads):
        rows = table[table["load_N_per_mm"] == load]
        _draw_penetrations(panels[0, number], rows)
        panel_title(panels[0, number], number, f"{load:g} N/mm")
        _draw_differences(panels[1, number], rows)
        panels[1, number].set_xlabel(r"$\Delta R$ (mm)")
    panels[0, 0].set_ylabel("penetration (µm)")
    panels[1, 0].set_ylabel("law less finite\nelements (%)")
    handles, labels = panels[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


def _draw_penetrations(axes: Axes, rows: pd.DataFrame) -> None:
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


def _curves(rows: pd.DataFrame) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return clearances in mm and the laws' penetrations in mm at the rows' load."""
    dR = np.geomspace(rows["dR_mm"].min(), rows["dR_mm"].max(), 300)
    first = rows.iloc[0]
    material = Material("steel", 1e3 * first["E_GPa"], first["nu"])
    pair = CylinderPair.from_dR("internal", dR, material)
    load = first["load_N_per_mm"]
    return dR, {name: LAWS[name]().penetration(load, pair) for name in LAWS_COMPARED}


def _style(number: int) -> dict[str, Any]:
    """Return the line style of a law."""
    return {"color": COLOURS[number], "linestyle": LINE_STYLES[number], "marker": ""}


def _draw_differences(axes: Axes, rows: pd.DataFrame) -> None:
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
