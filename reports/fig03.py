"""Fig 3: the exponent of power laws fitted to Johnson's law, against ΔR, E and ν."""

import numpy as np

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims.power_fits import TRAINING_DR, TRAINING_LOADS
from cylcontact.reports.exponents import ExponentStudy, exponent_panels, exponent_spreads

TICKS = {
    "internal": (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10),
    "external": (5, 10, 20, 50, 100, 200, 500),
}
MODULI_GPA = (20.7, 69.0, 207.0, 600.0, 10000.0)
RATIOS = (0.1, 0.3, 0.5)
CAPTION = (
    "Exponent n (-) of the power law f = K δⁿ fitted to Johnson's law pair by pair, against ΔR "
    "(mm). Lines: ν = 0.3 and five values of E. Light band: ν from 0.1 to 0.5 at 207 GPa; E and ν "
    "act through E* = E/(2(1 - ν²)) alone, and E* and ΔR only through their product. Thick grey "
    "line: the published exponent (Eq 6c). The fit is least squares in ln δ and ln f over 41 loads "
    "from 10 to 1000 N/mm spaced logarithmically; loads beyond Johnson's limit (Eq 8) are left "
    "out. The spacing of the loads, the values of E and the fit are our choice, as the paper names "
    "none."
)


def draw(_bench: Bench) -> Drawing:
    studies = [
        ExponentStudy(contact, np.geomspace(*TRAINING_DR[contact], 47), ticks)
        for contact, ticks in TICKS.items()
    ]
    figure, table = exponent_panels(studies, MODULI_GPA, RATIOS, TRAINING_LOADS)
    return Drawing(figure, table, exponent_spreads(table), CAPTION)
