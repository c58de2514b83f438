"""Section 5: the one number of the conclusions that Sections 2 to 3.4 can be asked for."""

from __future__ import annotations

from cylcontact.reports.claims.claim import Claim, joined, listed
from cylcontact.reports.claims.domain import MODERATE, Table
from cylcontact.reports.claims.section34_differences import (
    domain_choice,
    extremes_as_values,
    largest_by_material,
    magnitudes,
    shares,
)


def claims(rows: Table) -> list[Claim]:
    """Return the claims of Section 5."""
    return [below_10_percent(rows)]


def below_10_percent(rows: Table) -> Claim:
    """Return the largest difference at moderate loads against the bound of the conclusions."""
    found = largest_by_material(rows, MODERATE)
    return Claim(
        id="5-below-10-percent",
        section="5",
        statement="in practical applications under moderate loads the models differ by under 10 %",
        paper="< 10 %",
        ours=(
            "largest difference of the enhanced law from Johnson's at moderate loads: "
            + listed(found, "{}", "; ")
            + "; below 10 % over this share of them: "
            + listed(shares(rows, 10.0, MODERATE), "{:.1f} %")
        ),
        rule="below 10 % everywhere at moderate loads, for every material",
        holds=max(magnitudes(found).values()) < 10,
        choice=joined(
            domain_choice(rows, "moderate loads"),
            "finite elements, which the sentence includes, are judged in Section 3.2",
        ),
        paper_values={"bound, percent": 10.0},
        ours_values=extremes_as_values(found),
    )
