"""Fig 8: the largest load of Johnson's law against clearance, with the limits the text quotes."""

from cylcontact.limits import johnson_limit_load
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims.domain import ELASTIC, LOADS, clearance_pair, origins
from cylcontact.reports.curves import clearance_table, draw_materials, mark_point
from cylcontact.reports.drawing import Drawing
from cylcontact.reports.style import new_figure

# Material and clearance (mm) of the limits that Sect. 3.4 states; where their labels go.
STATED = {
    ("aluminium alloy", 0.0075): (8, -16),
    ("aluminium alloy", 0.010): (14, -9),
    ("titanium alloy", 0.0075): (-62, 40),
}
CAPTION = (
    "Largest load per unit length (N/mm) that Johnson's law can carry, 4π E* ΔR / e² (Eq 8), "
    "against radial clearance (mm), internal contact, both bodies of one material. Grey line: the "
    "highest load of Figs 10 to 14. Stars: the three limits that the paper's text states as 494, "
    "658 and 865 N/mm, as computed here. Material values that are not the paper's: {told}; so the "
    "stars show that the moduli derived from these limits are consistent, no more."
)


def draw(bench: Bench) -> Drawing:
    rows = bench.materials()
    table = clearance_table(rows, johnson_limit_load, "load_N_per_mm")
    figure = new_figure("middle", 88.0)
    axes = figure.subplots()
    draw_materials(axes, table, "load_N_per_mm")
    axes.axhline(LOADS[1], color="0.6", linewidth=0.8, linestyle="-", marker="", zorder=0)
    axes.text(1.8, LOADS[1] * 1.08, f"{LOADS[1]:g} N/mm", ha="right")
    headline = {}
    for (name, dR), offset in STATED.items():
        limit = float(johnson_limit_load(clearance_pair(dR, rows[name].material)))
        mark_point(axes, dR, limit, f"{limit:.0f} N/mm", offset)
        headline[f"{name}, dR = {dR:g} mm"] = limit
    axes.set(ylabel="Johnson's limit load (N/mm)", ylim=(30, 3e6))
    axes.legend(loc="upper left")
    caption = CAPTION.format(told=origins(rows, rows, ELASTIC))
    return Drawing(figure, table, headline, caption)
