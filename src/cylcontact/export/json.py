"""The JSON target: the law as data, with values to test a port against."""

from __future__ import annotations

import ast
import json
import math
from collections.abc import Iterable, Iterator
from importlib.metadata import version
from itertools import product
from typing import Any

import numpy as np

from cylcontact.errors import InputError
from cylcontact.export.exported_law import MEANINGS, RESULTS, ExportedLaw, renamed
from cylcontact.export.render import lambert_steps
from cylcontact.laws.formula import FUNCTIONS, Step, names_in
from cylcontact.materials import Material
from cylcontact.pair import Contact, CylinderPair
from cylcontact.reading import marked

_CALLED = ", ".join(name for name in FUNCTIONS if name not in ("where", "branch_distance"))
_SYNTAX = (
    "assignments in order, some names more than once, in Python's syntax, with the names of "
    f"arguments and constants, pi, nan, inf, {_CALLED}; the results are f, the load, and k, the "
    "stiffness"
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


def source(law: ExportedLaw) -> str:
    """Return a law as a JSON document."""
    rows = list(_check_values(law))
    steps = [*_unrolled(law.steps)]
    for name in ("f", "k"):  # at first touch the steps may have no value, as ln 0
        steps.append(f"{name} = {name} if penetration > 0 or {name} >= 0 else 0")
        if law.ends:
            steps.append(f"{name} = {name} if {law.ends} else nan")
    described = {
        name: {"unit": unit, "meaning": meaning}
        for name, (unit, meaning) in {**MEANINGS, **RESULTS}.items()
    }
    document: dict[str, Any] = {
        "function": law.name,
        "law": law.law.name,
        "contact": law.contact,
        "formula": law.formula.equation,
        "remark": law.formula.remark,
        "coefficients": dict(law.listed),
        "arguments": {name: described[name] for name in law.arguments},
        "results": {name: described[name] for name in RESULTS},
        "domain": ", ".join(filter(None, (*law.conditions, law.ends))),
        "outside_domain": _OUTSIDE,
        "without_contact": _APART,
        "conditions": list(law.conditions),
        "constants": {name: x for name, x in law.constants.items() if name != "pi"},
        "steps": steps,
        "syntax_of_steps": _SYNTAX,
        "provenance": {"cylcontact": version("cylcontact"), "coefficients": law.origin},
        "check_values": {name: [row[name] for row in rows] for name in rows[0]},
    }
    return json.dumps(marked(document), indent=1, allow_nan=False) + "\n"


def _unrolled(steps: Iterable[Step]) -> Iterator[str]:
    """Yield steps as text, turn after turn, with those of Lambert's function in its place."""
    for step in steps:
        match step.value:
            case ast.Call(func=ast.Name(id="range"), args=limits):
                for number in range(*(ast.literal_eval(ast.unparse(each)) for each in limits)):
                    if any(step.name in names_in(each.value) for each in step.body):
                        yield f"{step.name} = {number}"
                    yield from _unrolled(step.body)
            case ast.Call(func=ast.Name(id="branch_distance"), args=[p]):
                names = {each.name: f"{step.name}_{each.name}" for each in lambert_steps()}
                names |= {"penetration": f"{step.name}_p", "f": step.name}
                yield f"{names['penetration']} = {ast.unparse(p)}"
                yield from (renamed(each, names).text for each in lambert_steps())
            case _:
                yield step.text


def _check_values(exported: ExportedLaw) -> Iterator[dict[str, float | str]]:
    """Yield arguments and results of a law by name, inside and outside its domain.

    NaN is text, because JSON has none.
    """
    law, contact = exported.law, exported.contact or "internal"
    lengths = _LENGTHS if "length" in exported.arguments else _LENGTHS[:1]
    pins = _MATERIALS if "alpha" in exported.arguments else (None,)
    build = CylinderPair.internal if contact == "internal" else CylinderPair.external
    for material, pin, (R_i, R_j), length in product(_MATERIALS, pins, _RADII[contact], lengths):
        pair = build(R_i, R_j, material, length, pin)
        arguments = {
            **{name: float(getattr(pair, name)) for name in ("E_star", "dR", "alpha", "beta")},
            **{"R_i": R_i, "R_j": R_j, "length": length},
        }
        try:
            largest = float(law.max_penetration(pair))
        except InputError:  # some laws are for steel alone
            continue
        ends = math.isfinite(largest)
        parts, whole = (_OF_LARGEST, largest) if ends else (_OF_DR, float(pair.dR))
        for penetration in (whole * part for part in parts):
            values = {"penetration": penetration, **arguments}
            row: dict[str, float | str] = {name: values[name] for name in exported.arguments}
            row["load"] = _plain(law.load(penetration, pair))
            row["stiffness"] = _plain(law.stiffness(penetration, pair))
            yield row


def _plain(value: np.floating | np.ndarray) -> float | str:
    """Return a number, or NaN or Infinity as text."""
    number = float(value)
    if math.isnan(number):
        return "NaN"
    return number if math.isfinite(number) else "Infinity"
