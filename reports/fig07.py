"""Fig 7: the load at which Hertz's peak pressure reaches the yield stress, against clearance."""

from functools import partial

from cylcontact.arrays import FloatArray
from cylcontact.laws import Persson
from cylcontact.limits import yield_load
from cylcontact.pair import CylinderPair
from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench

from .clearance import Quantity, clearance_panels, legend_below, mark_loads, tables_by_radius
from .paper import ELASTIC, MATERIALS, RADII, YIELD, clearance_pair, origins, strength

hertz_yield_load = partial(yield_load, criterion="Hertz")

HEADLINE_DR_MM = 0.1
CONFORMAL = 10.0  # percent, from where on the contact counts as conformal
CAPTION = (
    "Load per unit length (N/mm) at which Hertz's peak pressure (Eq 7) equals the yield stress, "
    "against radial clearance (mm), for a pin in a hole of radius R_i, both of one material. "
    f"Lines are thin where Hertz's pressure is more than {CONFORMAL:g} % below that of conformal "
    "contact. Yield stresses assumed."
)
METHOD = (
    "Internal contact. The criterion is the paper's, not first yield by von Mises; by it a "
    "material is elastic below its line. Conformal contact is Persson's solution at the same "
    f"load. The bound of {CONFORMAL:g} % is our choice. Where lines are thin, "
    "the pressure of conformal contact reaches the yield stress at a lower load than drawn. "
    "Grey band: the loads of Figs 10 to 14, 10 to 1000 N/mm. Material values that are not the "
    "paper's: {origins}."
)


def draw(bench: Bench) -> Drawing:
    rows = {name: bench.material(name) for name in MATERIALS}
    quantities: dict[str, Quantity] = {
        "load_N_per_mm": hertz_yield_load,
        "hertz_low_by_percent": _shortfall,
    }
    table = tables_by_radius(rows, quantities)
    thin = table["hertz_low_by_percent"] > CONFORMAL
    figure, panels = clearance_panels(table, table["load_N_per_mm"], thin)
    panels[0].set(ylabel="load at yield (N/mm)", ylim=(5, 1e6))
    for axes in panels:
        mark_loads(axes)
    panels[0].plot([], [], "k-", linewidth=0.5, marker="", label="thin: Hertz's pressure low")
    legend_below(figure, panels[0], 4)
    headline = {
        f"{name}, R_i = {R_i:g} mm, dR = {HEADLINE_DR_MM:g} mm": float(
            hertz_yield_load(clearance_pair(HEADLINE_DR_MM, row.material, R_i))
        )
        for R_i in RADII
        for name, row in rows.items()
    }
    method = METHOD.format(origins=origins(rows, rows, ELASTIC, YIELD))
    return Drawing(figure, table, headline, CAPTION, method)


def _shortfall(pair: CylinderPair) -> FloatArray:
    """Return by how many percent Hertz's peak pressure at yield is below Persson's."""
    load = hertz_yield_load(pair)
    return 100 * (1 - strength(pair.material_i) / Persson().peak_pressure(load, pair))
