"""From a drawing: how stiff a contact may be within a fit."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from cylcontact.bodies.fits import Fit
from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import Parametric
from cylcontact.limits import yield_load
from cylcontact.plots.figure import Drawing, new_figure, plain_log
from cylcontact.plots.style import COLOURS, LINE_STYLES
from cylcontact.reports.bench import Bench

from .paper import ELASTIC, YIELD, origins

PIN, HOLE = "high-strength steel", "bronze"
CODES = ("20H7/g6", "20H7/f7", "20H9/d9")
LOADS = np.geomspace(10.0, 1000.0, 41)  # N/mm
CAPTION = (
    "Stiffness of the contact (N/mm for each mm of length) against load, for a high-strength steel "
    "pin in a bronze hole, by three fits of ISO 286. Areas: from the tightest to the loosest "
    "pair that the drawing allows; lines: the middle."
)
METHOD = (
    "The law for two materials, parametric, in an infinite plate, whose datum is a convention: a "
    "housing changes the stiffness as well. First yield by von Mises is at {least:,.0f} N/mm or "
    "above, beyond the loads drawn. Material values that are not the paper's: {origins}."
)


def draw(bench: Bench) -> Drawing:
    rows = {name: bench.material(name) for name in (PIN, HOLE)}
    pairs = {
        code: CylinderPair.of_fit(code, pin=rows[PIN].material, hole=rows[HOLE].material)
        for code in CODES
    }
    table = pd.concat([_stiffness(code, pair) for code, pair in pairs.items()], ignore_index=True)
    headline = {}
    for code, part in table.groupby("fit", sort=False):
        at = part.iloc[(part["load_N_per_mm"] - 100.0).abs().argmin()]
        for end in ("least", "greatest"):
            headline[f"{code}: {end} stiffness at 100 N/mm"] = float(at[f"{end}_N_per_mm_mm"])
    least = min(float(np.min(yield_load(pair))) for pair in pairs.values())
    method = METHOD.format(least=least, origins=origins(rows, rows, ELASTIC, YIELD))
    return Drawing(_draw(table), table, headline, CAPTION, method)


def _stiffness(code: str, pair: CylinderPair) -> pd.DataFrame:
    """Return the stiffness of the loosest, the middle and the tightest pair over the load."""
    law, load = Parametric(), LOADS[:, None]
    values = law.stiffness(law.penetration(load, pair), pair)
    return pd.DataFrame(
        {
            "fit": code,
            "load_N_per_mm": LOADS,
            "least_N_per_mm_mm": values.min(axis=1),
            "middle_N_per_mm_mm": values[:, 1],
            "greatest_N_per_mm_mm": values.max(axis=1),
        }
    )


def _draw(table: pd.DataFrame) -> Figure:
    """Draw an area and a line for each fit."""
    figure = new_figure("column", 62.0)
    axes = figure.subplots()
    for number, (code, part) in enumerate(table.groupby("fit", sort=False)):
        colour, load = COLOURS[number + 1], part["load_N_per_mm"]
        low, high = part["least_N_per_mm_mm"] / 1e3, part["greatest_N_per_mm_mm"] / 1e3
        axes.fill_between(load, low, high, color=colour, alpha=0.25, linewidth=0)
        gap = Fit.read(str(code)).clearance
        label = rf"{code}: $\Delta R$ = {1e3 * gap[0]:g} to {1e3 * gap[1]:g} µm"
        style = {"color": colour, "linestyle": LINE_STYLES[number], "marker": ""}
        axes.plot(load, part["middle_N_per_mm_mm"] / 1e3, label=label, **style)
    plain_log(axes, "x", (10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0))
    axes.set(xlim=(LOADS[0], LOADS[-1]), xlabel="load (N/mm)")
    axes.set(ylabel="stiffness (kN/mm per mm)", ylim=(0, None))
    axes.legend(loc="lower right")
    return figure
