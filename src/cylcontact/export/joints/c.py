"""The C target: C99, a source and its header."""

from __future__ import annotations

from dataclasses import replace

from cylcontact.arrays import FloatArray
from cylcontact.export.c import DIALECT
from cylcontact.export.joints.element import ARGUMENTS, RESULTS, Element
from cylcontact.export.render import Dialect, filled
from cylcontact.mechanism.clearance_joint import ClearanceJoint

__all__ = ["body_parts", "source"]

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
wrench->force_bearing[0] = {0};
wrench->force_bearing[1] = {1};
wrench->moment_bearing = {2};
wrench->force_pin[0] = -{0};
wrench->force_pin[1] = -{1};
wrench->moment_pin = {3};
wrench->penetration = {4};
wrench->penetration_rate = {5};
wrench->normal_force = {6};
wrench->friction_force = {7};
wrench->tangential_velocity = {8};
wrench->dissipated_power = {9};
wrench->flag = (int){10};"""


def source(joint: ClearanceJoint, stem: str = "") -> dict[str, str]:
    """Return the text of the source and of the header, by file name.

    Examples
    --------
    >>> from cylcontact.mechanism import read_joint
    >>> list(source(read_joint("datasets/joint.toml"), "pin"))
    ['pin.c', 'pin.h']
    """
    element, stem = Element(joint), stem or joint.identifier
    names = {"name": joint.identifier, "stem": stem, "capitals": joint.identifier.upper()}
    usage = filled(_USAGE, names).splitlines()
    comment = "\n".join(f"// {line}".rstrip() for line in element.description(usage))
    parts = {**names, "comment": comment, **body_parts(element)}
    return {f"{stem}.c": filled(_SOURCE, parts), f"{stem}.h": filled(_HEADER, parts)}


def body_parts(element: Element) -> dict[str, str]:
    """Return the bodies of the functions, for C and C++."""
    dialect = _dialect(element.joint.identifier)
    table = element.table
    parts = {
        "law": dialect.statements(element.law),
        "law_constants": dialect.constants(element.law_constants),
        "table": "" if table is None else _arrays(table),
        "lookup": "" if table is None else _LOOKUP.format(last=table[0].size - 1),
        "results": _RESULTS.format(*RESULTS),
    }
    for function in ("evaluate", "accept"):
        steps = getattr(element, function)
        parts[function] = dialect.statements(steps)
        parts[f"{function}_constants"] = dialect.constants(element.constants(steps))
    return parts


def _dialect(name: str) -> Dialect:
    """Return C's notation with the names of this joint's inputs."""
    inputs = {
        argument: f"{body}[{k}]"
        for body, arguments in ARGUMENTS.items()
        for k, argument in enumerate(arguments)
    }
    return replace(DIALECT, names={**DIALECT.names, **inputs, "law": f"{name}_law"})


def _arrays(table: tuple[FloatArray, ...]) -> str:
    """Return the arrays of a table: ln of the penetration, ln of the load, slopes."""
    texts = []
    for name, numbers in zip("xys", table, strict=True):
        values = [repr(float(number)) for number in numbers]
        rows = [", ".join(values[k : k + 4]) for k in range(0, len(values), 4)]
        inside = ",\n    ".join(rows)
        texts.append(f"static const double {name}[{len(values)}] = {{\n    {inside}}};")
    return "\n".join(texts)
