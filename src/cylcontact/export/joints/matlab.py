"""The MATLAB target: a file of functions for MATLAB and Octave."""

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
from cylcontact.export.matlab import DIALECT
from cylcontact.export.render import filled
from cylcontact.mechanism.joint import ClearanceJoint

_USAGE = """\
joint = $stem();                                     (this file is $stem.m)

impact_rate = joint.start();                         (the state: 0, not in contact)
wrench = joint.evaluate(impact_rate, bearing, pin);
impact_rate = joint.accept(impact_rate, bearing, pin);"""

_FRAME = """\
function joint = $stem()
$comment
%
% MATLAB or Octave.
joint.start = @() 0;
joint.evaluate = @evaluate;
joint.accept = @accept;
end

function wrench = evaluate(impact_rate, bearing, pin)
$evaluate_constants
$evaluate
$results
end

function impact_rate = accept(impact_rate, bearing, pin)
$accept_constants
$accept
impact_rate = next_rate;
end

function f = law_load(penetration)
% The law: N/mm at a penetration in mm.
$table
if penetration <= 0
    f = 0;
    return
end
$lookup
$law_constants
$law
end
"""

# The nodes around a penetration, by bisection.
_LOOKUP = """\
at = log(penetration);
low = 1;
high = {last};
while high - low > 1
    middle = floor((low + high) / 2);
    if x(middle) <= at
        low = middle;
    else
        high = middle;
    end
end
x_0 = x(low);
y_0 = y(low);
s_0 = s(low);
x_1 = x(high);
y_1 = y(high);
s_1 = s(high);"""

_RESULTS = """\
wrench.force_bearing = [{0}, {1}];
wrench.moment_bearing = {2};
wrench.force_pin = [-{0}, -{1}];
wrench.moment_pin = {3};
wrench.penetration = {4};
wrench.penetration_rate = {5};
wrench.normal_force = {6};
wrench.friction_force = {7};
wrench.tangential_velocity = {8};
wrench.dissipated_power = {9};
wrench.flag = {10};"""

# For numbers, not arrays as the laws are exported.
_DIALECT = replace(
    DIALECT,
    branch="if {test}\n    {name} = {yes};\nelse\n    {name} = {no};\nend",
    names={**DIALECT.names, "law": "law_load", **argument_names("{body}({k})", 1)},
    helpers={},
)


def source(joint: ClearanceJoint, stem: str = "") -> dict[str, str]:
    """Return the text of the file, by its name, which is that of the function."""
    element, stem = Element(joint), stem or joint.identifier
    require_importable(stem)
    parts = {
        "stem": stem,
        **bodies_of(element, _DIALECT),
        **table_parts(element, _arrays, _LOOKUP, 1),
        "results": _RESULTS.format(*RESULTS),
    }
    parts["comment"] = element.comment(filled(_USAGE, parts), "%")
    return {f"{stem}.m": filled(_FRAME, parts)}


def _arrays(table: tuple[FloatArray, ...]) -> str:
    """Return the arrays of a table, made once: ln of the penetration, ln of the load, slopes."""
    texts = ["persistent x y s", "if isempty(x)"]
    for name, numbers in zip("xys", table, strict=True):
        inside = ", ...\n        ".join(rows_of(numbers))
        texts.append(f"    {name} = [ ...\n        {inside}];")
    return "\n".join([*texts, "end"])
