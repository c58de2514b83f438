"""Fig 8: the largest load of Johnson's law, and where it departs from conformal contact."""

from collections.abc import Mapping
from typing import Any

from matplotlib.axes import Axes

from cylcontact.limits import johnson_limit_load
from cylcontact.materials import Material
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.maps import RIM
from cylcontact.plots.style import COLOURS
from cylcontact.reports.bench import Bench
from cylcontact.reports.laws_bounds import DEPARTURES, departure_number, johnson_end

from .clearance import CLEARANCES, clearance_table, draw_materials, mark_point
from .paper import ELASTIC, LOADS, MATERIALS, clearance_pair, origins

# Material and clearance (mm) of the limits in Sect. 3.4, and the offsets of their labels in points.
STATED = {
    ("aluminium alloy", 0.0075): (-15, -16),
    ("aluminium alloy", 0.010): (10, -10),
    ("titanium alloy", 0.0075): (-62, 40),
}
# The material whose loads of departure from conformal contact are drawn, below all the limits,
# and the load (N/mm) of their labels.
DEPARTING = "aluminium alloy"
LABELS_AT = 30.0
CAPTION = (
    "Largest load per unit length (N/mm) that Johnson's law can carry, 4π E* ΔR / e² (Eq 8), "
    "against radial clearance (mm), internal contact, both bodies of one material. Grey line: the"
    " highest load of Figs 10 to 14. Stars: the three limits that the paper's text states as 494,"
    " 658 and 865 N/mm, as computed here. Material values that are not the paper's: {origins}; so"
    " the stars show that the moduli derived from these limits are consistent, no more. Eq 8 "
    "bounds the algebra, not the physics: thin lines are the loads φ E* ΔR at which Johnson's "
    "penetration is {percents} % below Persson's conformal solution (its datum matched to "
    "Johnson's law at small loads, our choice), φ = {numbers}; drawn for {departing} only, and in"
    " proportion to E* for the others."
)


def draw(bench: Bench) -> Drawing:
    rows = {name: bench.material(name) for name in MATERIALS}
    table = clearance_table(rows, johnson_limit_load, "load_N_per_mm")
    numbers = {percent: departure_number(percent) for percent in DEPARTURES}
    for percent, number in numbers.items():
        loads = number / johnson_end() * table["load_N_per_mm"]
        table[f"johnson_low_by_{percent:g}_percent_load_N_per_mm"] = loads
    figure = new_figure("middle", 100.0)
    axes = figure.subplots()
    draw_materials(axes, rows, criterion=None)
    _draw_departures(axes, rows[DEPARTING].material, numbers)
    axes.axhline(LOADS[1], color="0.6", linewidth=0.8, linestyle="-", marker="", zorder=0)
    axes.text(1.8, LOADS[1] * 0.92, f"{LOADS[1]:g} N/mm", ha="right", va="top")
    headline = {}
    for (name, dR), offset in STATED.items():
        limit = float(johnson_limit_load(clearance_pair(dR, rows[name].material)))
        mark_point(axes, dR, limit, f"{limit:.0f} N/mm", offset)
        headline[f"{name}, dR = {dR:g} mm"] = limit
    for percent, number in numbers.items():
        headline[f"phi at which Johnson's penetration is {percent:g} % low"] = number
    axes.set_ylim(1.5, 3e6)
    axes.legend(loc="upper left", title="limit of Johnson's law (Eq 8)", alignment="left")
    caption = CAPTION.format(
        origins=origins(rows, rows, ELASTIC),
        percents=", ".join(f"{percent:g}" for percent in numbers),
        numbers=", ".join(f"{number:.4f}" for number in numbers.values()),
        departing=DEPARTING,
    )
    return Drawing(figure, table, headline, caption)


def _draw_departures(axes: Axes, material: Material, numbers: Mapping[float, float]) -> None:
    """Draw and label a material's loads of departure from conformal contact."""
    E_star = float(clearance_pair(1.0, material).E_star)
    style: dict[str, Any] = {"color": COLOURS[4], "linewidth": 0.6, "linestyle": "-", "marker": ""}
    for percent, number in numbers.items():
        axes.plot(CLEARANCES, number * E_star * CLEARANCES, **style)
        dR = float(LABELS_AT / (number * E_star))
        axes.text(dR, LABELS_AT, f"{percent:g} %", ha="center", va="center", path_effects=[RIM])
    note = f"thin: Johnson's penetration that far below\nconformal contact's, {material.name}"
    axes.text(1.8, 2.2, note, ha="right")
