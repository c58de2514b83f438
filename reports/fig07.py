"""Fig 7: the load at first yield, and the paper's estimate of it, against clearance."""

from functools import partial

from cylcontact.limits import yield_load
from cylcontact.plots.figure import Drawing, legend_below
from cylcontact.reports.bench import Bench

from .clearance import Quantity, clearance_panels, mark_loads, tables_by_radius
from .paper import ELASTIC, MATERIALS, RADII, YIELD, clearance_pair, origins

hertz_yield_load = partial(yield_load, criterion="Hertz")

HEADLINE_DR_MM = 0.1
CAPTION = (
    "Load per unit length (N/mm) at first yield by von Mises, against radial clearance (mm), for a "
    "pin in a hole of radius R_i, both of one material. Fine: the paper's estimate, where Hertz's "
    "peak pressure (Eq 7) is the yield stress; unsafe where it is above. Yield stresses assumed. "
    "In (a) two materials yield above 10⁵ N/mm."
)
METHOD = (
    "Internal contact in plane strain. First yield is by the stress below Persson's conformal "
    "pressure. Grey band: the loads of Figs 10 to 14, 10 to 1000 N/mm. Material values that are "
    "not the paper's: {origins}."
)


def draw(bench: Bench) -> Drawing:
    rows = {name: bench.material(name) for name in MATERIALS}
    quantities: dict[str, Quantity] = {
        "load_N_per_mm": yield_load,
        "hertz_load_N_per_mm": hertz_yield_load,
    }
    table = tables_by_radius(rows, quantities)
    figure, panels = clearance_panels(
        table, table["load_N_per_mm"], fine=table["hertz_load_N_per_mm"]
    )
    panels[0].set(ylabel="load at first yield (N/mm)", ylim=(5, 1e5))
    for axes in panels:
        mark_loads(axes)
    panels[0].plot([], [], "k-", linewidth=0.5, marker="", label="the paper's estimate")
    legend_below(panels[0], 4)
    headline = {
        f"{name}, R_i = {R_i:g} mm, dR = {HEADLINE_DR_MM:g} mm{words}": float(
            load(clearance_pair(HEADLINE_DR_MM, row.material, R_i))
        )
        for words, load in (("", hertz_yield_load), (": von Mises", yield_load))
        for R_i in RADII
        for name, row in rows.items()
    }
    method = METHOD.format(origins=origins(rows, rows, ELASTIC, YIELD))
    return Drawing(figure, table, headline, CAPTION, method)
