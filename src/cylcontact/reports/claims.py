"""Claims of a paper, compared with computed numbers.

A claim is a function in a folder's `reports/claims.py`. Its docstring says what is claimed. It
yields the interpretations of the claim, the most literal first: how its words are understood, our
number, and whether the claim holds so. None in place of the last says that the number is no
evidence, because it follows from a choice of ours.

    @claim("3.4", "< 8 %", "differences lower than 8 %")
    def below_8_percent():
        '''The two laws differ by less than 8 % in conditions with practical applications.'''
        worst = ...
        yield "R_i = 10 mm", f"{worst:.0f} %", worst < 8
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from cylcontact.files.provenance import data_read, modules_of, origin_of
from cylcontact.files.writing import replacing
from cylcontact.reports.figures import report_module
from cylcontact.support.errors import InputError

__all__ = [
    "DEPENDS",
    "FAILS",
    "HOLDS",
    "Claim",
    "Interpretation",
    "as_records",
    "claim",
    "claims_of",
    "to_table",
    "to_text",
    "write_claims",
]

Interpretation = tuple[str, str, bool | None]
HOLDS, DEPENDS, FAILS = "holds", "depends on the interpretation", "does not hold"
_SIGNS = {True: "+", False: "-", None: "o"}
_KEY = "+ the claim holds in this interpretation, - it does not, o no evidence for or against it"
_WIDTH = 100


@dataclass(frozen=True)
class Claim:
    """A claim of a paper: its section, the printed value, a quotation, and its interpretations."""

    section: str
    printed: str
    quotation: str
    statement: str
    interpretations: tuple[Interpretation, ...]

    @property
    def verdict(self) -> str:
        """Whether the claim holds in all interpretations, in some, or in none."""
        results = {holds for *_, holds in self.interpretations if holds is not None}
        return DEPENDS if len(results) == 2 else HOLDS if results == {True} else FAILS


def claim(
    section: str, printed: str, quotation: str
) -> Callable[[Callable[[], Iterator[Interpretation]]], Callable[[], Claim]]:
    """Return a decorator that makes a claim of a function."""

    def decorate(function: Callable[[], Iterator[Interpretation]]) -> Callable[[], Claim]:
        def judge() -> Claim:
            statement = " ".join((function.__doc__ or "").split())
            results = tuple(
                (how, ours, None if holds is None else bool(holds))  # NumPy's are not JSON's
                for how, ours, holds in function()
            )
            return Claim(section, printed, quotation, statement, results)

        judge.is_claim = True  # type: ignore[attr-defined]
        return judge

    return decorate


def claims_of(root: Path) -> list[Claim]:
    """Compute the claims of a folder, in the order in which they are written.

    Raises
    ------
    InputError
        If the folder has no claims, or one of them fails.
    """
    file = root / "reports" / "claims.py"
    if not file.is_file():
        remedy = "run this where it is; cylcontact init FOLDER lays it out"
        raise InputError(str(file), "", None, "does not exist", remedy)
    module, computed = report_module(root, "claims"), []
    for name, judge in list(vars(module).items()):
        if getattr(judge, "is_claim", False):
            try:
                computed.append(judge())
            except (KeyError, ValueError, OSError) as error:
                rule = f"failed with {type(error).__name__} ({error})"
                raise InputError(str(file), name, None, rule, "correct the claim") from error
    return computed


def to_table(claims: list[Claim]) -> pd.DataFrame:
    """Return a row for each interpretation; `holds` is empty where it is no evidence."""
    return pd.DataFrame(
        [
            {
                "section": each.section,
                "claim": each.statement,
                "printed": each.printed,
                "quotation": each.quotation,
                "verdict": each.verdict,
                "interpretation": how,
                "ours": ours,
                "holds": holds,
            }
            for each in claims
            for how, ours, holds in each.interpretations
        ]
    )


def write_claims(root: Path, path: Path) -> list[Claim]:
    """Compute the claims of a folder and write them as a table, below a line on what it is from."""
    with data_read(root) as data:
        computed = claims_of(root)
    sources = modules_of(root / "reports" / "claims.py")
    origin = origin_of(root, [*sources, *data], path)
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        file.write(f"# {origin}\n")
        to_table(computed).to_csv(file, index=False, lineterminator="\n")
    return computed


def as_records(claims: list[Claim]) -> list[dict[str, Any]]:
    """Return the claims as plain data, each with its verdict and interpretations."""
    return [
        {
            "section": each.section,
            "claim": each.statement,
            "printed": each.printed,
            "quotation": each.quotation,
            "verdict": each.verdict,
            "interpretations": [
                {
                    "interpretation": how,
                    "ours": ours,
                    "holds": holds,
                }
                for how, ours, holds in each.interpretations
            ],
        }
        for each in claims
    ]


def to_text(claims: list[Claim]) -> str:
    """Return the claims by verdict, each with its interpretations."""
    lines = []
    for verdict in (HOLDS, DEPENDS, FAILS):
        chosen = [each for each in claims if each.verdict == verdict]
        lines.append(f"{verdict.capitalize()}: {len(chosen)} of {len(claims)}")
        for each in chosen:
            text = f"{each.section}  {each.statement} [{each.printed}]"
            lines += textwrap.wrap(text, _WIDTH, initial_indent="  ", subsequent_indent="       ")
            for how, ours, holds in each.interpretations:
                sign = _SIGNS[holds]
                text = f"{sign} {how}: {ours}"
                lines += textwrap.wrap(
                    text, _WIDTH, initial_indent=" " * 7, subsequent_indent=" " * 9
                )
        lines.append("")
    return "\n".join([*lines, _KEY])
