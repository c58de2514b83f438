"""What each choice that Section 3.2 leaves open does to the finite elements' penetration."""

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.finite_element.data import choices, table
from cylcontact.reports.finite_element.sensitivity import sensitivity_panels, sensitivity_table

CAPTION = (
    "What changing one choice of the finite-element set-up does to the penetration (mm) of the "
    "pin's centre; open marks 20 N/mm, filled ones 100 N/mm. (a) Change in percent. (b) The same "
    "as a change of the additive constant C in δ = f/(πE*)·(ln(πE*ΔR/f) + C): outer radius, load "
    "and clamp shift it alike at every clearance and load, and neither the contact nor the law "
    "that follows from it. The 'cells' are those over the contact's half-width; 16 in the set-up "
    "itself. Variants are our choice. {choices}"
)


def draw(bench: Bench) -> Drawing:
    numbers = sensitivity_table(table(bench, "sensitivity"))
    sizes = numbers.groupby("variant", sort=False)["change_percent"]
    headline = {f"{name}: largest change, %": values.abs().max() for name, values in sizes}
    return Drawing(
        sensitivity_panels(numbers), numbers, headline, CAPTION.format(choices=choices(bench))
    )
