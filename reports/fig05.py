"""Fig 5: contact stress at clearances of 1 mm and 0.01 mm, beside Hertz."""

from cylcontact.datasets.finite_element import solve
from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.finite_element.data import (
    STRESS_LOAD,
    STRESS_LOAD_CHOICE,
    choices,
    study,
)
from cylcontact.reports.finite_element.stress import (
    largest_departure,
    profile_table,
    stress_panels,
)

CLEARANCES = (1.0, 0.01)  # mm, the paper's
CAPTION = (
    "Contact stress by finite elements at ΔR = 1 mm and 0.01 mm, f = 20 N/mm; {load_choice}. "
    "(a, b) Stress along the load in MPa, compression positive, "
    "one value per cell; x, y in mm. (c, d) Pressure (MPa) at the pairs of nodes, beside Hertz's "
    "ellipse and Persson's conformal solution. {choices}"
)


def draw(bench: Bench) -> Drawing:
    setup = study(bench, "recommended").setups["base"]
    solutions = [solve(setup, dR, [STRESS_LOAD])[0] for dR in CLEARANCES]
    table = profile_table(solutions)
    headline = {}
    for dR in CLEARANCES:
        for theory in ("hertz", "persson"):
            key = f"{dR:g} mm: largest departure from {theory.capitalize()}, % of its peak"
            headline[key] = largest_departure(table, dR, theory)
    caption = CAPTION.format(load_choice=STRESS_LOAD_CHOICE, choices=choices(bench))
    return Drawing(stress_panels(solutions), table, headline, caption)
