"""Fig 9: Hertz's peak pressure at Johnson's largest load, with each material's yield stress."""

from cylcontact.limits import elastic_limit_clearance, stress_at_johnson_limit
from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench

from .clearance import clearance_panels, mark_yield
from .paper import (
    ELASTIC,
    MATERIALS,
    RADII,
    YIELD,
    clearance_pair,
    origins,
    strength,
)

CAPTION = (
    "Peak pressure of Hertz's line contact (MPa, Eq 7) at the largest load of Johnson's law "
    "(Eq 8), against radial clearance (mm); internal contact, hole of radius R_i, both bodies of "
    "one material. Stars: where the pressure equals the yield stress, which the thin lines carry "
    "to the axis; left of its star Johnson's law ends before the material yields, right of it the "
    "material yields first. Material values that are not the paper's: {origins}."
)


def draw(bench: Bench) -> Drawing:
    rows = {name: bench.material(name) for name in MATERIALS}
    figure, panels, table = clearance_panels(
        rows, stress_at_johnson_limit, "stress_MPa", criterion=None, pressure=True
    )
    headline = {}
    for axes, R_i in zip(panels, RADII, strict=True):
        for number, (name, row) in enumerate(rows.items()):
            dR = float(elastic_limit_clearance(R_i, clearance_pair(R_i / 2, row.material, R_i)))
            mark_yield(axes, dR, strength(row.material), number)
            headline[f"{name}, R_i = {R_i:g} mm: dR (mm) of the star"] = dR
        axes.set_ylim(0.1, 1e6)
    panels[0].text(0.0013, 2e5, "stars: yield stress")
    caption = CAPTION.format(origins=origins(rows, rows, ELASTIC, YIELD))
    return Drawing(figure, table, headline, caption)
