"""The ledger as text for a terminal, as a table, as CSV and as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from itertools import groupby
from textwrap import wrap
from typing import Any

import pandas as pd

from cylcontact.reports.claims.claim import Claim
from cylcontact.reports.claims.domain import DEFINITIONS
from cylcontact.reports.claims.ledger import counts

LABEL_WIDTH = 10


def to_text(claims: Sequence[Claim], width: int = 100) -> str:
    """Return the ledger for reading: definitions, claims by section, count of verdicts.

    Parameters
    ----------
    claims : sequence of Claim
        In the order to print.
    width : int
        Columns of the terminal.

    Returns
    -------
    str
    """
    lines = ["Definitions", ""]
    for term, meaning in DEFINITIONS.items():
        lines += [*_entry(f"{term}:", meaning, width, len(term) + 2), ""]
    for section, members in groupby(claims, key=lambda claim: claim.section):
        lines += [f"Section {section}", "─" * width, ""]
        for claim in members:
            lines += [*_claim_lines(claim, width), ""]
    return "\n".join([*lines, *_count_lines(claims)]) + "\n"


def _claim_lines(claim: Claim, width: int) -> list[str]:
    """Return one claim: a heading with the verdict, then what stands behind it."""
    heading = f"{claim.id}  [{claim.verdict}]"
    told = (
        ("claim", claim.statement),
        ("paper", claim.paper),
        ("ours", claim.ours),
        ("rule", claim.rule),
        (_choice_label(claim), claim.choice),
        ("otherwise", claim.alternatives),
    )
    lines = [heading]
    for label, text in told:
        if text:
            lines += _entry(f"  {label}", text, width, LABEL_WIDTH + 2)
    return lines


def _choice_label(claim: Claim) -> str:
    """Return what the text in `choice` is for this verdict."""
    return {"not testable": "reason", "not reproduced": "basis"}.get(claim.verdict, "choice")


def _entry(label: str, text: str, width: int, indent: int) -> list[str]:
    """Return a label with its text wrapped beside it."""
    start = f"{label:<{indent}}"
    rest = " " * (LABEL_WIDTH + 2)
    return wrap(text, width, initial_indent=start, subsequent_indent=rest, break_on_hyphens=False)


def _count_lines(claims: Sequence[Claim]) -> list[str]:
    """Return the closing count."""
    return [
        "Verdicts",
        *(f"  {number:3d}  {verdict}" for verdict, number in counts(claims).items()),
        f"  {len(claims):3d}  in all",
    ]


def to_records(claims: Iterable[Claim]) -> list[dict[str, Any]]:
    """Return each claim as plain values, the verdict among them."""
    return [
        {
            "id": claim.id,
            "section": claim.section,
            "statement": claim.statement,
            "paper": claim.paper,
            "ours": claim.ours,
            "rule": claim.rule,
            "verdict": claim.verdict,
            "choice": claim.choice,
            "alternatives": claim.alternatives,
            "paper_values": {k: float(v) for k, v in claim.paper_values.items()},
            "ours_values": {k: float(v) for k, v in claim.ours_values.items()},
        }
        for claim in claims
    ]


def to_table(claims: Iterable[Claim]) -> pd.DataFrame:
    """Return the ledger as a table, one row per claim; the values are JSON text in their cells."""
    records = to_records(claims)
    for record in records:
        for column in ("paper_values", "ours_values"):
            record[column] = json.dumps(record[column], ensure_ascii=False)
    return pd.DataFrame.from_records(records)


def to_csv(claims: Iterable[Claim]) -> str:
    """Return the table as CSV text."""
    return to_table(claims).to_csv(index=False, lineterminator="\n")


def to_json(claims: Sequence[Claim]) -> str:
    """Return definitions, claims and counts as JSON text."""
    whole = {
        "definitions": dict(DEFINITIONS),
        "claims": to_records(claims),
        "counts": counts(claims),
    }
    return json.dumps(whole, ensure_ascii=False, indent=2) + "\n"
