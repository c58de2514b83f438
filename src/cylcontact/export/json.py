"""The JSON target: the law as data, with values to test a port against."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from importlib.metadata import version
from itertools import product
from typing import Any

import numpy as np

from cylcontact.export.comments import domain
from cylcontact.formats import marked
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.laws.formula import MEANINGS, RESULTS, Formula
from cylcontact.materials import Material
from cylcontact.pair import Contact, CylinderPair

__all__ = ["source"]

_SYNTAX = (
    "assignments in order, in Python's syntax, with the names of arguments and constants, pi, nan, "
    "log, log1p, exp, sqrt, sin, atan and max; the results are f, the load, and k, the stiffness"
)
_OUTSIDE = "load and stiffness are NaN"
_APART = "at a negative penetration load and stiffness are 0; conditions and steps do not matter"


_MATERIALS = (Material("aluminium", E=69e3, nu=0.33), Material("steel", E=207e3, nu=0.3))

# Radii of hole and pin, and of two rollers, and axial lengths, in mm.
_RADII: dict[Contact, tuple[tuple[float, float], ...]] = {
    "internal": ((10.0, 9.9975), (10.0, 9.95), (10.0, 9.0), (25.0, 10.0)),
    "external": ((10.0, 5.0), (70.0, 70.0)),
}
_LENGTHS = (10.0, 25.0)

# Penetrations, in units of the largest one or, where there is none, of dR.
_OF_LARGEST = (-0.1, 0.0, 1e-6, 1e-3, 0.1, 0.5, 0.9, 0.999, 1.001)
_OF_DR = (-0.1, 0.0, 1e-9, 1e-6, 1e-4, 1e-2, 0.1, 1.0)


def source(formula: Formula) -> str:
    """Return a law as a JSON document.

    Examples
    --------
    >>> from cylcontact.export.formulas import formula_of
    >>> from cylcontact.laws.liu import Liu
    >>> document = json.loads(source(formula_of(Liu(), "internal")))
    >>> document["steps"][0]
    'root = sqrt(penetration / (2 * (dR + penetration)))'
    """
    rows = list(_check_values(formula))
    document: dict[str, Any] = {
        "function": formula.name,
        "law": formula.law.name,
        "contact": formula.contact,
        "formula": formula.equation,
        "remark": formula.remark,
        "coefficients": dict(formula.coefficients),
        "arguments": {name: _described(*MEANINGS[name]) for name in formula.arguments},
        "results": {name: _described(*about) for name, about in RESULTS.items()},
        "domain": domain(formula),
        "outside_domain": _OUTSIDE,
        "without_contact": _APART,
        "conditions": list(formula.requirements),
        "constants": dict(formula.constants),
        "steps": [step.text for step in formula.steps],
        "syntax_of_steps": _SYNTAX,
        "provenance": {"cylcontact": version("cylcontact"), "coefficients": formula.origin},
        "check_values": {name: [row[name] for row in rows] for name in rows[0]},
    }
    return json.dumps(marked("law", document), indent=1, allow_nan=False) + "\n"


def _check_values(formula: Formula) -> Iterator[dict[str, float | str]]:
    """Yield arguments and results of a law by name, inside and outside its domain.

    NaN is text, because JSON has none.

    Examples
    --------
    >>> from cylcontact.export.formulas import formula_of
    >>> from cylcontact.laws.liu import Liu
    >>> first, *_ = _check_values(formula_of(Liu(), "internal"))
    >>> print(first["penetration"] < 0, first["load"])
    True 0.0
    """
    law, contact = formula.law, formula.contact or "internal"
    lengths = _LENGTHS if "length" in formula.extra else _LENGTHS[:1]
    pins = _MATERIALS if "alpha" in formula.extra else (None,)
    for material, pin, radii, length in product(_MATERIALS, pins, _RADII[contact], lengths):
        pair = _pair(contact, radii, material, length, pin)
        arguments = _arguments(pair)
        for penetration in _penetrations(law, pair):
            values = {"penetration": penetration, **arguments}
            row: dict[str, float | str] = {name: values[name] for name in formula.arguments}
            row["load"] = _plain(law.load(penetration, pair))
            row["stiffness"] = _plain(law.stiffness(penetration, pair))
            yield row


def _pair(
    contact: Contact,
    radii: tuple[float, float],
    material: Material,
    length: float,
    other: Material | None,
) -> CylinderPair:
    """Return the pair of two radii, of one material unless there is another for body j."""
    build = CylinderPair.internal if contact == "internal" else CylinderPair.external
    return build(*radii, material, length, other)


def _arguments(pair: CylinderPair) -> dict[str, float]:
    """Return the arguments of exported functions that depend on the pair."""
    R_i, R_j = pair.radii("the export")
    return {
        "E_star": float(pair.E_star),
        "dR": float(np.asarray(pair.dR)),
        "R_i": float(R_i),
        "R_j": float(R_j),
        "length": pair.contact_length("the export"),
        "alpha": float(pair.alpha),
        "beta": float(pair.beta),
    }


def _penetrations(law: ContactLaw, pair: CylinderPair) -> list[float]:
    """Return penetrations in mm over the domain of a law and slightly beyond."""
    largest = float(law.max_penetration(pair))
    if math.isfinite(largest):
        return [largest * part for part in _OF_LARGEST]
    return [float(np.asarray(pair.dR)) * part for part in _OF_DR]


def _plain(value: np.floating | np.ndarray) -> float | str:
    """Return a number, or NaN or Infinity as text."""
    number = float(value)
    if math.isnan(number):
        return "NaN"
    return number if math.isfinite(number) else "Infinity"


def _described(unit: str, meaning: str) -> dict[str, str]:
    """Return a unit and a meaning as data."""
    return {"unit": unit, "meaning": meaning}
