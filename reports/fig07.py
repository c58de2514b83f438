"""Fig 7: the load at which Hertz's peak pressure reaches the yield stress, against clearance."""

from functools import partial

from cylcontact.limits import yield_load
from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench

from .clearance import clearance_panels
from .paper import (
    ELASTIC,
    LOADS,
    MATERIALS,
    RADII,
    YIELD,
    clearance_pair,
    origins,
)

hertz_yield_load = partial(yield_load, criterion="Hertz")

HEADLINE_DR_MM = 0.1
CAPTION = (
    "Load per unit length (N/mm) at which the peak pressure of Hertz's line contact (Eq 7) equals "
    "the yield stress, against radial clearance (mm); internal contact, hole of radius R_i, both "
    "bodies of one material, elastic below its line. Grey band: the loads of Figs 10 to 14, 10 to "
    "1000 N/mm. Material values that are not the paper's: {origins}."
)


def draw(bench: Bench) -> Drawing:
    rows = {name: bench.material(name) for name in MATERIALS}
    figure, panels, table = clearance_panels(
        rows, hertz_yield_load, "load_N_per_mm", criterion="Hertz", johnson=False
    )
    panels[0].set_ylabel("load at yield (N/mm)")
    for axes in panels:
        axes.axhspan(*LOADS, color="0.88", zorder=0, linewidth=0)
        axes.set_ylim(1, 1e9)
    panels[0].text(0.0013, 100, "loads of\nFigs 10 to 14", va="center")
    headline = {
        f"{name}, R_i = {R_i:g} mm, dR = {HEADLINE_DR_MM:g} mm": float(
            hertz_yield_load(clearance_pair(HEADLINE_DR_MM, row.material, R_i))
        )
        for R_i in RADII
        for name, row in rows.items()
    }
    caption = CAPTION.format(origins=origins(rows, rows, ELASTIC, YIELD))
    return Drawing(figure, table, headline, caption)
