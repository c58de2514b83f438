"""Section 3.3: where yield and where the mathematics end the laws."""

from __future__ import annotations

from cylcontact.reports.claims import section33_limit, section33_yield
from cylcontact.reports.claims.claim import Claim
from cylcontact.reports.claims.domain import Table

SECTION = "3.3"


def claims(rows: Table) -> list[Claim]:
    """Return the claims of Section 3.3."""
    return [*section33_yield.claims(SECTION, rows), *section33_limit.claims(SECTION, rows)]
