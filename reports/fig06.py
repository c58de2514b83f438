"""Fig 6: penetration against clearance: finite elements, Johnson, the enhanced and other laws."""

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.finite_element.data import choices, penetrations, table
from cylcontact.reports.finite_element.penetration import penetration_panels

CAPTION = (
    "Penetration of the pin's centre against ΔR (mm) at 20, 40 and 100 N/mm, E = 207 GPa, ν = 0.3, "
    "hole of radius 2.245 mm. Above (µm): finite elements, embedded and by CalculiX, beside "
    "Johnson's law (Eq 1), the enhanced law with the published coefficients (Eqs 5-6), our "
    "explicit law and Persson's conformal solution. Below: each law less finite elements, in "
    "percent, interpolated between the clearances computed; grey, the 3 % that the paper states "
    "above 0.445 mm, and lines at its 10 %. {choices}"
)


def draw(bench: Bench) -> Drawing:
    rows = table(bench, "recommended")
    calculix = table(bench, "recommended", "calculix")
    numbers = penetrations(rows).rename(columns={"fe_mm": "embedded_mm"})
    numbers.insert(3, "calculix_mm", calculix["penetration_mm"].to_numpy())
    numbers = numbers.assign(E_GPa=rows["E_GPa"], nu=rows["nu"])
    headline = {}
    for load, group in numbers.groupby("load_N_per_mm"):
        for law in ("johnson", "enhanced", "explicit", "calculix"):
            off = 100 * (group[f"{law}_mm"] / group["embedded_mm"] - 1)
            headline[f"{load:g} N/mm: {law} less finite elements, largest, %"] = off.abs().max()
    caption = CAPTION.format(choices=choices(bench))
    return Drawing(penetration_panels(numbers), numbers, headline, caption)
