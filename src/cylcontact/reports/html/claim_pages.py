"""The pages of claims: one for each section of the paper, a long section on several."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from cylcontact.reports.claims import Claim
from cylcontact.reports.claims_text import grouped

__all__ = ["ClaimPage", "claim_pages"]

# A page has at most this many, and is then no longer than eight screens of a telephone.
MOST = 17


@dataclass(frozen=True)
class ClaimPage:
    """The claims of one page.

    Attributes
    ----------
    name : str
        Of the file, without its ending.
    section, title : str
        The section of the paper, and the page's title.
    claims : tuple of Claim
        In the order of their verdicts.
    """

    name: str
    section: str
    title: str
    claims: tuple[Claim, ...]


def claim_pages(claims: Sequence[Claim]) -> Iterator[ClaimPage]:
    """Yield the pages in the order of the sections.

    Parameters
    ----------
    claims : sequence of Claim
        In the order of the sections.

    Yields
    ------
    ClaimPage

    Examples
    --------
    >>> from cylcontact.reports.claims import Finding
    >>> many = [Claim(f"2-{i}", "", "", "", Finding("1", holds=i > 3)) for i in range(20)]
    >>> [(page.name, page.title, len(page.claims)) for page in claim_pages(many)]
    [('claims-2', 'Section 2, part 1 of 2', 10), ('claims-2-part2', 'Section 2, part 2 of 2', 10)]
    """
    for section, each in groupby(claims, key=lambda claim: claim.section):
        members = [claim for group in grouped(each).values() for claim in group]
        parts = -(-len(members) // MOST)
        size = -(-len(members) // parts)
        title = f"Section {section}" if section[:1].isdigit() else section.capitalize()
        name = "claims-" + re.sub(r"[^\w.]+", "-", section)
        for part in range(parts):
            yield ClaimPage(
                f"{name}-part{part + 1}" if part else name,
                section,
                f"{title}, part {part + 1} of {parts}" if parts > 1 else title,
                tuple(members[part * size : (part + 1) * size]),
            )
