"""The ledger of claims to read and to take away: what stands, groups, text, table, JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from textwrap import wrap
from typing import Any

import pandas as pd

from cylcontact.files.reading import marked
from cylcontact.reports.claims import VERDICTS, Claim, Reading, Verdict

__all__ = [
    "MEANINGS",
    "counts",
    "described",
    "grouped",
    "to_json",
    "to_records",
    "to_table",
    "to_text",
    "what_stands",
]

MISPRINTS = "misprints"
# What the claims of each group have in common.
MEANINGS: Mapping[str, str] = {
    **{str(verdict): text for verdict, text in VERDICTS.items()},
    MISPRINTS: "what is printed, and what must be meant",
}
LABEL_WIDTH = 18


def counts(claims: Iterable[Claim]) -> dict[Verdict, int]:
    """Return how many claims have each verdict, zeros included and misprints left out."""
    verdicts = [each.verdict for each in claims if not each.misprint]
    return {verdict: verdicts.count(verdict) for verdict in VERDICTS}


def grouped(claims: Iterable[Claim]) -> dict[str, list[Claim]]:
    """Return the claims of each verdict that occurs, in the order given, and the misprints."""
    groups: dict[str, list[Claim]] = {verdict: [] for verdict in (*VERDICTS, MISPRINTS)}
    for each in claims:
        groups[MISPRINTS if each.misprint else each.verdict].append(each)
    return {name: members for name, members in groups.items() if members}


def relied_on(claims: Sequence[Claim]) -> dict[str, list[Claim]]:
    """Return which statements one can rely on, and which not; the open ones are in neither."""
    counted = [each for each in claims if not each.misprint]
    return {
        "You can rely on": [c for c in counted if c.verdict.startswith("reproduced")],
        "You cannot rely on": [c for c in counted if c.verdict == "not reproduced"],
    }


def what_stands(claims: Sequence[Claim]) -> str:
    """Return one sentence on how many of the statements stand.

    Examples
    --------
    >>> from cylcontact.reports.claims import Finding
    >>> found = [Finding("1", holds=True), Finding("2", holds=False), Finding("3", holds=None)]
    >>> print(what_stands([Claim(f"1-{f.ours}", "", "", "", f) for f in found]))
    Of 3 testable statements, 1 is reproduced, 1 is not, and 1 stays open: for 1 the
    readings disagree or the uncertainty includes the limit.
    """
    number = counts(claims)
    plain, chosen, failed, undecided, hanging, _ = number.values()
    total = sum(number.values()) - number["not testable"]
    chosen_text = f" ({plain} as printed, {chosen} with a choice that we state)" if chosen else ""
    parts = [f"{_are(plain + chosen)} reproduced{chosen_text}"]
    if failed:
        parts.append(f"{_are(failed)} not")
    if undecided or hanging:
        reasons = [
            *([f"for {undecided} the readings disagree or the uncertainty includes the limit"]
              if undecided else []),
            *([f"for {hanging} the answer depends on something that the text lacks"]
              if hanging else []),
        ]  # fmt: skip
        stay = "stays" if undecided + hanging == 1 else "stay"
        parts.append(f"{undecided + hanging} {stay} open: {'; '.join(reasons)}")
    statements = "statement" if total == 1 else "statements"
    *first, last = parts
    together = f"{', '.join(first)}, and {last}" if first else last
    return f"Of {total} testable {statements}, {together}."


def _are(number: int) -> str:
    """Return a number with its verb."""
    return f"{number} {'is' if number == 1 else 'are'}"


def to_text(
    claims: Sequence[Claim],
    terms: Mapping[str, str],
    gone: Mapping[str, str] | None = None,
    width: int = 100,
) -> str:
    """Return the ledger for reading: what to rely on, the claims by verdict, the terms."""
    lines = [*wrap(what_stands(claims), width), ""]
    for title, members in relied_on(claims).items():
        if members:
            lines += [f"{title}:", ""]
            for each in members:
                lines += _entry("  -", f"{each.statement} ({each.section})", width, 4, 4)
            lines.append("")
    for group, members in grouped(claims).items():
        title = f"{group.capitalize()} ({len(members)}): {MEANINGS[group]}"
        lines += [*wrap(title, width), "─" * width, ""]
        for each in members:
            lines += [*_claim_lines(each, width), ""]
    for title, entries in (("Withdrawn", gone or {}), ("Terms", terms)):
        lines += [title, "─" * width, ""] if entries else []
        for term, meaning in entries.items():
            lines += [*_entry(f"{term}:", meaning, width, len(term) + 2), ""]
    return "\n".join(lines[:-1])


def _claim_lines(one: Claim, width: int) -> list[str]:
    """Return the lines of one claim: what the paper says, what we find, what it rests on."""
    entries = [
        ("the print has" if one.misprint else "the paper says", says(one)),
        ("we find", one.finding.ours),
        ("it rests on", one.basis),
        *(("otherwise", described(each)) for each in one.finding.alternatives),
    ]
    lines = [one.id]
    for label, text in entries:
        if text:
            lines += _entry(f"  {label}", text, width, LABEL_WIDTH)
    return lines


def says(one: Claim) -> str:
    """Return what the paper says: of a misprint what is printed, then what is meant."""
    return f"{one.paper}: {one.statement}" if one.misprint else f"{one.statement}: {one.paper}"


def described(reading: Reading) -> str:
    """Return a reading in one line: what is chosen, what it gives, whether the rule is met.

    Examples
    --------
    >>> described(Reading("R_i = 5 mm", "12 %", holds=False, miss="2 points too much"))
    'R_i = 5 mm: 12 % (not met, 2 points too much, not heard: the text gives no ground)'
    """
    met = {True: "met", False: "not met", None: "cannot tell"}[reading.holds]
    missing = f"in place of {reading.missing}" if reading.missing else ""
    heard = "" if reading.counts else "not heard: the text gives no ground"
    told = ", ".join(filter(None, (met, reading.miss, missing, reading.ground, heard)))
    return f"{reading.choice}: {reading.ours} ({told})"


def _entry(
    label: str, text: str, width: int, indent: int, rest_indent: int = LABEL_WIDTH
) -> list[str]:
    """Return the lines of a text that is wrapped to the right of its label."""
    start = f"{label:<{indent}}"
    rest = " " * rest_indent
    return wrap(text, width, initial_indent=start, subsequent_indent=rest, break_on_hyphens=False)


def to_records(claims: Iterable[Claim]) -> list[dict[str, Any]]:
    """Return each claim as plain values, the verdict among them."""
    return [
        {
            "id": each.id,
            "section": each.section,
            "statement": each.statement,
            "paper": each.paper,
            "ours": each.finding.ours,
            "verdict": each.verdict,
            "misprint": each.misprint,
            "basis": each.basis,
            "rule": each.rule,
            "readings": [asdict(reading) for reading in each.finding.readings],
            "missing": list(each.missing),
            "figures": list(each.figures),
            "code": each.code,
            "paper_values": {k: float(v) for k, v in each.finding.paper_values.items()},
            "ours_values": {k: float(v) for k, v in each.finding.values.items()},
        }
        for each in claims
    ]


def to_table(claims: Iterable[Claim]) -> pd.DataFrame:
    """Return the ledger as a table, one row per claim; lists and values are JSON in their cells."""
    records = to_records(claims)
    for record in records:
        for column, value in record.items():
            if not isinstance(value, str):
                record[column] = json.dumps(value, ensure_ascii=False)
    return pd.DataFrame.from_records(records)


def to_json(
    claims: Sequence[Claim], terms: Mapping[str, str], gone: Mapping[str, str] | None = None
) -> str:
    """Return what stands, definitions, claims, counts and what was withdrawn, as JSON text."""
    document = {
        "what_stands": what_stands(claims),
        "definitions": dict(terms),
        "claims": to_records(claims),
        "counts": counts(claims),
        "withdrawn": dict(gone or {}),
    }
    return json.dumps(marked(document), ensure_ascii=False, indent=2) + "\n"
