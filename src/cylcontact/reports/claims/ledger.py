"""All claims in the order of the paper."""

from __future__ import annotations

from collections.abc import Iterable

from cylcontact.reports.claims import (
    section1,
    section2,
    section2_models,
    section5,
    section31,
    section33,
    section34,
)
from cylcontact.reports.claims.claim import VERDICTS, Claim, Verdict
from cylcontact.reports.claims.domain import Table, five_materials


def ledger(materials: Table, more: Iterable[Claim] = ()) -> list[Claim]:
    """Compute every claim.

    Parameters
    ----------
    materials : mapping of str to MaterialRow
        The table of materials, as `read_materials` returns it: the five materials of
        Sect. 3.4 with E and yield stress in MPa, each number with its provenance.
    more : iterable of Claim, optional
        Claims that need something else to be computed, such as fit results; each is put
        after the others of its section.

    Returns
    -------
    list of Claim
        In the order of the paper's sections.

    Raises
    ------
    InputError
        If one of the five materials or its yield stress is missing.
    """
    five_materials(materials)
    own = [
        *section1.claims(materials),
        *section2.claims(materials),
        *section2_models.claims(materials),
        *section31.claims(materials),
        *section33.claims(materials),
        *section34.claims(materials),
        *section5.claims(materials),
    ]
    return sorted([*own, *more], key=lambda claim: claim.section)


def counts(claims: Iterable[Claim]) -> dict[Verdict, int]:
    """Return how many claims have each verdict, zeros included."""
    verdicts = [claim.verdict for claim in claims]
    return {verdict: verdicts.count(verdict) for verdict in VERDICTS}
