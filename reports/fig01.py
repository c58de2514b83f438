"""Fig 1: the geometry of internal and external contact and of the contact strip, drawn."""

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.geometry import DrawnPair, draw_geometry

INTERNAL = DrawnPair("internal", R_i=10.0, R_j=7.0, penetration=0.6)
EXTERNAL = DrawnPair("external", R_i=6.0, R_j=4.5, penetration=0.6)
CAPTION = (
    "Symbols. (a) Internal contact: a pin of radius R_j in a hole of radius R_i, ΔR = R_i - R_j, "
    "pressed by the load f per unit length until the axes are ΔR + δ apart; dashed, the pin with "
    "its axis on the hole's. (b) External contact: two rollers, ΔR = R_i + R_j, the axes ΔR - δ "
    "apart. (c) The contact strip of length L and width 2b under the elliptic pressure of Hertz. "
    "Not to scale: the penetration δ, drawn as the overlap of the undeformed outlines, and the "
    "strip's width are far too large; lengths are as drawn, in mm."
)


def draw(_bench: Bench) -> Drawing:
    figure, table = draw_geometry(INTERNAL, EXTERNAL)
    headline = {
        f"{pair.contact} {name}": value
        for pair in (INTERNAL, EXTERNAL)
        for name, value in (("dR, mm", pair.dR), ("centre distance, mm", pair.centre_distance))
    }
    return Drawing(figure, table, headline, CAPTION)
