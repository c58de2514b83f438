"""Fig 9: Hertz's peak pressure at Johnson's largest load, relative to the yield stress."""

from cylcontact.limits import elastic_limit_clearance, stress_at_johnson_limit
from cylcontact.plots.figure import Drawing, legend_below
from cylcontact.plots.style import QUIET
from cylcontact.reports.bench import Bench

from .clearance import BAND, clearance_panels, tables_by_radius
from .paper import ELASTIC, MATERIALS, RADII, YIELD, clearance_pair, origins, strength

CAPTION = (
    "Hertz's peak pressure (Eq 7) at the largest load of Johnson's law (Eq 8), relative to the "
    "yield stress, against radial clearance (mm), for a pin in a hole of radius R_i, both of one "
    "material. In the grey part the material yields below that load; elsewhere above "
    "it. Yield stresses assumed."
)
METHOD = (
    "Internal contact. The headline numbers are the clearances at which the pressure equals the "
    "yield stress. Contact at these loads is conformal, so Hertz's pressure is nominal. Material "
    "values that are not the paper's: {origins}."
)
HIGHEST = 1e3  # of the vertical axis


def draw(bench: Bench) -> Drawing:
    rows = {name: bench.material(name) for name in MATERIALS}
    table = tables_by_radius(rows, {"stress_MPa": stress_at_johnson_limit})
    strengths = {name: strength(row.material) for name, row in rows.items()}
    table["yield_stress_MPa"] = table["material"].map(strengths)
    figure, panels = clearance_panels(table, table["stress_MPa"] / table["yield_stress_MPa"])
    panels[0].set(ylabel="peak pressure / yield stress (-)", ylim=(1e-3, HIGHEST))
    for axes in panels:
        axes.axhspan(1, HIGHEST, **BAND, label="yields below the largest load")
        axes.axhline(1, color=QUIET, linewidth=0.6, linestyle="-", marker="", zorder=1)
    legend_below(panels[0], 3)
    headline = {}
    for R_i in RADII:
        for name, row in rows.items():
            dR = float(elastic_limit_clearance(R_i, clearance_pair(R_i / 2, row.material, R_i)))
            headline[f"{name}, R_i = {R_i:g} mm: dR (mm) at the yield stress"] = dR
    method = METHOD.format(origins=origins(rows, rows, ELASTIC, YIELD))
    return Drawing(figure, table, headline, CAPTION, method)
