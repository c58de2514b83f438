"""Fig 8: the largest load of Johnson's law, and where it departs from conformal contact."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from cylcontact.limits import johnson_limit_load
from cylcontact.plots.figure import Drawing, legend_below, new_figure
from cylcontact.plots.style import COLOURS, small_text
from cylcontact.reports.bench import Bench
from cylcontact.reports.laws_bounds import DEPARTURES, departure_number, johnson_end

from .clearance import clearance_table, draw_materials, mark_loads
from .paper import ELASTIC, JOHNSON_LIMITS, MATERIALS, clearance_pair, origins

# Where a label is that begins right of the end of a line.
BESIDE: dict[str, Any] = {
    "xytext": (3, 0),
    "textcoords": "offset points",
    "annotation_clip": False,
}
# The material whose loads of departure from conformal contact are drawn, below all the limits.
DEPARTING = "aluminium alloy"
CAPTION = (
    "Largest load per unit length (N/mm) of Johnson's law, 4π E* ΔR / e² (Eq 8), against radial "
    "clearance (mm), for pin and hole of one material. Thin lines: loads at which Johnson's "
    "penetration is {percents} % below conformal contact's, for {departing}. Stars: the three "
    "limits in the paper's text, {limits} N/mm."
)
METHOD = (
    "Internal contact. Johnson's penetration grows with the load up to this limit and would fall "
    "beyond it. Grey band: the loads of Figs 10 to 14. The stars are the limits as computed "
    "here. Material values that are not the paper's: {origins}. The moduli are derived from these "
    "limits, so the stars show that they are consistent, no more. Eq 8 bounds the algebra, not the "
    "physics: the thin lines are the loads φ E* ΔR at which Johnson's penetration is {percents} % "
    "below Persson's conformal solution, φ = {numbers}. The datum of that solution is matched to "
    "Johnson's law at small loads, which is our choice. The loads of the other materials are in "
    "proportion to E*."
)


def draw(bench: Bench) -> Drawing:
    rows = {name: bench.material(name) for name in MATERIALS}
    table = clearance_table(rows, {"load_N_per_mm": johnson_limit_load})
    numbers = {percent: departure_number(percent) for percent in DEPARTURES}
    for percent, number in numbers.items():
        loads = number / johnson_end() * table["load_N_per_mm"]
        table[f"johnson_low_by_{percent:g}_percent_load_N_per_mm"] = loads
    limits = {
        (name, dR): float(johnson_limit_load(clearance_pair(dR, rows[name].material)))
        for name, dR in JOHNSON_LIMITS
    }
    figure = new_figure("middle", 105.0)
    axes = figure.subplots()
    draw_materials(axes, table.assign(drawn=table["load_N_per_mm"], fine=np.nan))
    _draw_departures(axes, table[table["material"] == DEPARTING], numbers)
    stars: dict[str, Any] = {
        "color": "black",
        "markerfacecolor": "black",
        "markersize": 6,
        "zorder": 5,
    }
    places = [dR for _, dR in limits]
    axes.plot(places, list(limits.values()), "*", **stars, label="limits in the paper's text")
    mark_loads(axes)
    axes.set(ylabel="load (N/mm)", ylim=(1, 1e5))
    legend_below(axes, 3)
    headline = {f"{name}, dR = {dR:g} mm": limit for (name, dR), limit in limits.items()}
    for percent, number in numbers.items():
        headline[f"phi at which Johnson's penetration is {percent:g} % low"] = number
    words = {
        "origins": origins(rows, rows, ELASTIC),
        "percents": ", ".join(f"{percent:g}" for percent in numbers),
        "numbers": ", ".join(f"{number:.4f}" for number in numbers.values()),
        "departing": DEPARTING,
        "limits": ", ".join(f"{limit:.0f}" for limit in limits.values()),
    }
    return Drawing(figure, table, headline, CAPTION.format(**words), METHOD.format(**words))


def _draw_departures(axes: Axes, table: pd.DataFrame, numbers: Mapping[float, float]) -> None:
    """Draw a material's loads of departure from conformal contact, labelled at their ends."""
    style: dict[str, Any] = {"color": COLOURS[4], "linewidth": 0.6, "linestyle": "-", "marker": ""}
    label: str | None = f"Johnson's penetration {min(numbers):g} to {max(numbers):g} % low"
    for percent in numbers:
        loads = table[f"johnson_low_by_{percent:g}_percent_load_N_per_mm"]
        axes.plot(table["dR_mm"], loads, **style, label=label)
        end = (table["dR_mm"].iloc[-1], loads.iloc[-1])
        axes.annotate(f"{percent:g} %", end, **BESIDE, va="center", fontsize=small_text())
        label = None
