"""Fig 2: power laws fitted to Johnson's law for one internal and one external contact."""

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims.power_fits import FIG2_DR, FIG2_LOADS, reference_pair
from cylcontact.reports.power_curves import PowerCase, power_fit_panels

# K, n and R² as the paper prints them.
STATED = {
    "internal": ("312148", "1.2370", "> 0.998"),
    "external": ("44935", "1.0935", "> 0.998"),
}
CAPTION = (
    "Load per unit length (N/mm) against penetration (µm): points of Johnson's law (Eq 1) and the "
    "line f = K δⁿ (Eq 3; K in N/mm per mmⁿ) fitted to them by least squares in ln δ and ln f; "
    "E = 207 GPa, ν = 0.3. Below: fitted load less Johnson's at equal penetration, in percent of "
    "Johnson's. The loads fitted to are our choice, as the paper names none: (a) 1, 10, 20, … "
    "1000 N/mm, which gives its constants to every digit; (b) 1, 100, 200, … 10000 N/mm, which "
    "comes close to them."
)


def draw(_bench: Bench) -> Drawing:
    cases = [
        PowerCase(reference_pair(contact, FIG2_DR[contact]), FIG2_LOADS[contact], stated)
        for contact, stated in STATED.items()
    ]
    figure, table = power_fit_panels(cases)
    headline = {}
    for case in cases:
        fit, contact = case.fit(), case.pair.contact
        headline |= {f"{contact} K": fit.K, f"{contact} n": fit.n, f"{contact} R2": fit.r_squared}
    return Drawing(figure, table, headline, CAPTION)
