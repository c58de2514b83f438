"""Section 3.4: the enhanced law beside Johnson's."""

from __future__ import annotations

from cylcontact.reports.claims import (
    section34_differences,
    section34_growth,
    section34_limits,
    section34_yield,
)
from cylcontact.reports.claims.claim import Claim
from cylcontact.reports.claims.domain import Table

SECTION = "3.4"


def claims(rows: Table) -> list[Claim]:
    """Return the claims of Section 3.4."""
    return [
        *section34_limits.claims(SECTION, rows),
        *section34_yield.claims(SECTION, rows),
        *section34_differences.claims(SECTION, rows),
        *section34_growth.claims(SECTION, rows),
    ]
