"""The Python target: a module that needs the standard library only."""

from __future__ import annotations

from dataclasses import replace

from cylcontact.arrays import FloatArray
from cylcontact.export.joints.element import (
    RESULTS,
    Element,
    argument_names,
    bodies_of,
    require_importable,
    rows_of,
    table_parts,
)
from cylcontact.export.python import DIALECT
from cylcontact.export.render import filled
from cylcontact.mechanism.joint import ClearanceJoint

_DIALECT = replace(
    DIALECT,
    power="{x}**{y}",
    names={**DIALECT.names, "law": "_law", **argument_names("{body}[{k}]", 0)},
)

_USAGE = """\
$imported

impact_rate = joint.start()      (the state: 0, not in contact)
wrench = joint.evaluate(impact_rate, bearing, pin)
impact_rate = joint.accept(impact_rate, bearing, pin)"""

_FRAME = """\
$comment
#
# Python 3; needs the standard library only.

import math
from typing import NamedTuple


class Wrench(NamedTuple):
    force_bearing: tuple
    moment_bearing: float
    force_pin: tuple
    moment_pin: float
    penetration: float
    penetration_rate: float
    normal_force: float
    friction_force: float
    tangential_velocity: float
    dissipated_power: float
    flag: int


def start():
    return 0.0


def evaluate(impact_rate, bearing, pin):
    $evaluate_constants
    $evaluate
    $results


def accept(impact_rate, bearing, pin):
    $accept_constants
    $accept
    return next_rate


def _law(penetration):
    # The law: N/mm at a penetration in mm.
    if penetration <= 0.0:
        return 0.0
    $lookup
    $law_constants
    $law
    return f
$table
"""

# The nodes around a penetration, by bisection.
_LOOKUP = """\
at = math.log(penetration)
low, high = 0, {last}
while high - low > 1:
    middle = (low + high) // 2
    if _X[middle] <= at:
        low = middle
    else:
        high = middle
x_0, y_0, s_0 = _X[low], _Y[low], _S[low]
x_1, y_1, s_1 = _X[high], _Y[high], _S[high]"""

_RESULTS = """\
force, opposite = ({0}, {1}), (-{0}, -{1})
return Wrench(
    force, {2}, opposite, {3}, {4}, {5}, {6}, {7}, {8}, {9}, int({10})
)"""


def source(joint: ClearanceJoint, stem: str = "") -> dict[str, str]:
    """Return the text of the module, by file name."""
    element, stem = Element(joint), stem or joint.identifier
    require_importable(stem)
    parts = {
        "imported": "import joint" if stem == "joint" else f"import {stem} as joint",
        **bodies_of(element, _DIALECT),
        **table_parts(element, _arrays, _LOOKUP, 0),
        "results": _RESULTS.format(*RESULTS),
    }
    parts["comment"] = element.comment(filled(_USAGE, parts), "#")
    return {f"{stem}.py": filled(_FRAME, parts)}


def _arrays(table: tuple[FloatArray, ...]) -> str:
    """Return the tuples of a table: ln of the penetration, ln of the load, slopes."""
    texts = [""]
    for name, numbers in zip("XYS", table, strict=True):
        inside = ",\n    ".join(rows_of(numbers))
        texts.append(f"\n_{name} = (\n    {inside},\n)")
    return "\n".join(texts)
