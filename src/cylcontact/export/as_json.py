"""The JSON target: the law as data, with values to check a port against."""

from __future__ import annotations

import json
from importlib.metadata import version
from typing import Any

from cylcontact.export.check_values import check_values
from cylcontact.export.comments import domain
from cylcontact.export.formula import MEANINGS, RESULTS, Formula
from cylcontact.laws.contact_law import ContactLaw

SYNTAX = (
    "assignments in order, in Python's syntax, with the names of arguments and constants, pi, nan, "
    "log, log1p, exp, sqrt, sin, atan and max; the results are f, the load, and k, the stiffness"
)
OUTSIDE = "load and stiffness are NaN, also for a negative penetration"


def to_json(formula: Formula, law: ContactLaw) -> str:
    """Return a law as a JSON document.

    Examples
    --------
    >>> from cylcontact.export.formulas import formula_of
    >>> from cylcontact.laws.liu import Liu
    >>> document = json.loads(to_json(formula_of(Liu(), "internal"), Liu()))
    >>> document["steps"][0]
    'root = sqrt(penetration / (2 * (dR + penetration)))'
    """
    rows = list(check_values(law, formula))
    document: dict[str, Any] = {
        "function": formula.name,
        "law": formula.law,
        "contact": formula.contact,
        "formula": formula.equation,
        "remark": formula.remark,
        "coefficients": dict(formula.coefficients),
        "arguments": {name: _described(*MEANINGS[name]) for name in formula.arguments},
        "results": {name: _described(*about) for name, about in RESULTS.items()},
        "domain": domain(formula),
        "outside_domain": OUTSIDE,
        "conditions": list(formula.requirements),
        "constants": dict(formula.constants),
        "steps": [step.text for step in formula.steps],
        "syntax_of_steps": SYNTAX,
        "provenance": {"cylcontact": version("cylcontact"), "coefficients": formula.origin},
        "check_values": {name: [row[name] for row in rows] for name in rows[0]},
    }
    return json.dumps(document, indent=1, allow_nan=False) + "\n"


def _described(unit: str, meaning: str) -> dict[str, str]:
    """Return a unit and a meaning as data."""
    return {"unit": unit, "meaning": meaning}
