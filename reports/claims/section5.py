"""Section 5: the one number of the conclusions that Sections 2 to 3.4 can be asked for."""

from __future__ import annotations

from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, joined, listed

from ..paper import MODERATE
from .section34_differences import (
    domain_choice,
    extremes_as_values,
    largest_by_material,
    magnitudes,
    shares,
)


@claim(
    "5-below-10-percent",
    "in practical applications under moderate loads the models differ by under 10 %",
    paper="< 10 %",
    rule="below 10 % everywhere at moderate loads, for every material",
    paper_values={"bound, percent": 10.0},
)
def below_10_percent(bench: Bench) -> Finding:
    """Return the largest difference at moderate loads against the bound of the conclusions."""
    found = largest_by_material(bench, MODERATE)
    return Finding(
        (
            "largest difference of the enhanced law from Johnson's at moderate loads: "
            + listed(found, "{}", "; ")
            + "; below 10 % over this share of them: "
            + listed(shares(bench, 10.0, MODERATE), "{:.1f} %")
        ),
        holds=max(magnitudes(found).values()) < 10,
        choice=joined(
            domain_choice(bench, "moderate loads"),
            "finite elements, which the sentence includes, are judged in Section 3.2",
        ),
        values=extremes_as_values(found),
    )
