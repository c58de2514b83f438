"""The C target: C99, a source and its header."""

from __future__ import annotations

from dataclasses import replace

from cylcontact.arrays import FloatArray
from cylcontact.export.c import DIALECT
from cylcontact.export.joints.element import (
    RESULTS,
    Element,
    argument_names,
    bodies_of,
    rows_of,
    table_parts,
)
from cylcontact.export.render import filled
from cylcontact.mechanism.joint import ClearanceJoint

_USAGE = """\
#include "$stem.h" and link with -lm:

  ${name}_state state;
  ${name}_wrench wrench;
  ${name}_start(&state);
  ${name}_evaluate(&state, bearing, pin, &wrench);   (state is not changed)
  ${name}_accept(&state, bearing, pin);"""

_HEADER = """\
$comment

#ifndef CYLCONTACT_${capitals}_H
#define CYLCONTACT_${capitals}_H

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    double impact_rate; // 0: not in contact
} ${name}_state;

typedef struct {
    double force_bearing[2], moment_bearing;
    double force_pin[2], moment_pin;
    double penetration, penetration_rate;
    double normal_force, friction_force, tangential_velocity;
    double dissipated_power;
    int flag;
} ${name}_wrench;

void ${name}_start(${name}_state *state);
void ${name}_evaluate(const ${name}_state *state, const double bearing[6], const double pin[6],
    ${name}_wrench *wrench);
void ${name}_accept(${name}_state *state, const double bearing[6], const double pin[6]);

#ifdef __cplusplus
}
#endif

#endif
"""

_SOURCE = """\
// $name: what it is and how to call it stands in $stem.h.
//
// C99; link with -lm.

#include <math.h>

#include "$stem.h"

// The law: N/mm at a penetration in mm.
static double ${name}_law(double penetration)
{
    $table
    if (penetration <= 0.0) {
        return 0.0;
    }
    $lookup
    $law_constants
    $law
    return f;
}

void ${name}_start(${name}_state *state)
{
    state->impact_rate = 0.0;
}

void ${name}_evaluate(const ${name}_state *state, const double bearing[6], const double pin[6],
    ${name}_wrench *wrench)
{
    const double impact_rate = state->impact_rate;
    $evaluate_constants
    $evaluate
    $results
}

void ${name}_accept(${name}_state *state, const double bearing[6], const double pin[6])
{
    const double impact_rate = state->impact_rate;
    $accept_constants
    $accept
    state->impact_rate = next_rate;
}
"""

# The nodes around a penetration, by bisection.
_LOOKUP = """\
const double at = log(penetration);
int low = 0, high = {last};
while (high - low > 1) {{
    const int middle = (low + high) / 2;
    if (x[middle] <= at) {{
        low = middle;
    }} else {{
        high = middle;
    }}
}}
const double x_0 = x[low], y_0 = y[low], s_0 = s[low];
const double x_1 = x[high], y_1 = y[high], s_1 = s[high];"""

_RESULTS = """\
{wrench}force_bearing[0] = {0};
{wrench}force_bearing[1] = {1};
{wrench}moment_bearing = {2};
{wrench}force_pin[0] = -{0};
{wrench}force_pin[1] = -{1};
{wrench}moment_pin = {3};
{wrench}penetration = {4};
{wrench}penetration_rate = {5};
{wrench}normal_force = {6};
{wrench}friction_force = {7};
{wrench}tangential_velocity = {8};
{wrench}dissipated_power = {9};
{wrench}flag = (int){10};"""


def source(joint: ClearanceJoint, stem: str = "") -> dict[str, str]:
    """Return the text of the source and of the header, by file name."""
    element, stem = Element(joint), stem or joint.identifier
    names = {"name": joint.identifier, "stem": stem, "capitals": joint.identifier.upper()}
    comment = element.comment(filled(_USAGE, names), "//")
    parts = {
        **names,
        "comment": comment,
        **body_parts(element, "wrench->", f"{joint.identifier}_law"),
    }
    return {f"{stem}.c": filled(_SOURCE, parts), f"{stem}.h": filled(_HEADER, parts)}


def body_parts(element: Element, wrench: str, law: str) -> dict[str, str]:
    """Return the bodies of the functions, for C and C++.

    `wrench` is what stands before its members, `law` the name of the function of the law.
    """
    names = {**DIALECT.names, **argument_names("{body}[{k}]", 0), "law": law}
    return {
        **bodies_of(element, replace(DIALECT, names=names)),
        **table_parts(element, _arrays, _LOOKUP, 0),
        "results": _RESULTS.format(*RESULTS, wrench=wrench),
    }


def _arrays(table: tuple[FloatArray, ...]) -> str:
    """Return the arrays of a table: ln of the penetration, ln of the load, slopes."""
    texts = []
    for name, numbers in zip("xys", table, strict=True):
        inside = ",\n    ".join(rows_of(numbers))
        texts.append(f"static const double {name}[{numbers.size}] = {{\n    {inside}}};")
    return "\n".join(texts)
