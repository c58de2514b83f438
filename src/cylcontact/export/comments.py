"""The comment of an exported file: law, units, domain and provenance, in plain ASCII."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import version
from textwrap import wrap

from cylcontact.laws.formula import MEANINGS, RESULTS, Formula
from cylcontact.plain_text import comment

__all__ = ["WIDTH", "comment_lines", "domain", "paragraph", "table"]

WIDTH = 90


def comment_lines(formula: Formula, mark: str) -> str:
    """Return the comment at the top of a file, each line prefixed by the language's `mark`.

    Examples
    --------
    >>> from cylcontact.export.formulas import formula_of
    >>> from cylcontact.laws.liu import Liu
    >>> print(comment_lines(formula_of(Liu(), "internal"), "!").splitlines()[0])
    ! cylcontact_liu
    """
    return "\n".join(f"{mark} {line}".rstrip() for line in _description(formula))


def _provenance(formula: Formula) -> str:
    """Return the version of the package and the origin of the coefficients."""
    origin = formula.origin or "given by the caller"
    return f"exported by cylcontact {version('cylcontact')}; coefficients: {comment(origin)}"


def domain(formula: Formula) -> str:
    """Return the domain of the law in words."""
    return "; ".join(filter(None, (", ".join(formula.requirements), formula.domain)))


def _description(formula: Formula) -> list[str]:
    """Return the lines of the comment."""
    contact = f"{formula.contact} contact" if formula.contact else "internal or external contact"
    arguments = {name: MEANINGS[name] for name in formula.arguments}
    return [
        formula.name,
        "",
        f"The contact law '{formula.law.name}' for parallel cylinders, {contact}.",
        "",
        *paragraph("Formula", formula.equation),
        *paragraph("Remark", formula.remark),
        *paragraph("Provenance", _provenance(formula)),
        *(f"  {name} = {value!r}" for name, value in formula.coefficients.items()),
        "",
        "Arguments, in this order:",
        *table(arguments),
        "Results:",
        *table(RESULTS),
        "",
        *paragraph("Domain", domain(formula)),
        *paragraph(
            "Outside the domain",
            "load and stiffness are NaN",
        ),
        *paragraph("Without contact", "at a negative penetration load and stiffness are 0"),
    ]


def paragraph(title: str, text: str) -> list[str]:
    """Return `title: text`, wrapped."""
    return wrap(f"{title}: {text}.".replace("..", "."), WIDTH, subsequent_indent="  ")


def table(rows: Mapping[str, tuple[str, str]]) -> list[str]:
    """Return a line for each name, with unit and meaning."""
    return [f"  {name:<12} {unit:<7} {meaning}" for name, (unit, meaning) in rows.items()]
