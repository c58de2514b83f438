"""The C target: one C99 file with prototypes and definitions."""

from __future__ import annotations

import ast

from cylcontact.export.exported_law import ExportedLaw
from cylcontact.export.render import Dialect

# Lambert's w = -1 - W(-p/e), W the lower branch: a start in closed form and one step.
_LAMBERT = """
static double branch_distance(double p)
{
    $steps
    return $w;
}"""

DIALECT = Dialect(
    comment="//",
    number=repr,
    power="pow({x}, {y})",
    assignment="const double {name} = {value};",
    variable="double {name} = {value};",
    again="{name} = {value};",
    choice="{test} ? {yes} : {no}",
    loop=("for (int {name} = {first}; {name} {before} {stop}; {name} += {step}) {{\n{body}\n}}"),
    counter="(double){name}",
    names={"nan": "(double)NAN", "inf": "(double)INFINITY", "max": "fmax"},
    symbols={ast.And: "&&", ast.Or: "||"},
    lambert=_LAMBERT,
)

# At first touch the steps may have no value, as ln 0.
_BODY = """\
*load = penetration < 0.0 ? 0.0 : (double)NAN;
*stiffness = *load;
if (!($domain)) {
    return;
}
$constants
$at_pair
$last
$at_depth
*load = penetration > 0.0 || f >= 0.0 ? f : 0.0;
*stiffness = penetration > 0.0 || k >= 0.0 ? k : 0.0;
"""
_LAST = """\
if (!($ends)) {
    return;
}"""

_FRAME = """\
$comment
//
// C99; link with -lm.

#include <math.h>

// The declarations, for a header of your own.
void $name(
    $parameters,
    double *load, double *stiffness);
double ${name}_load(
    $parameters);
double ${name}_stiffness(
    $parameters);
$helpers

void $name(
    $parameters,
    double *load, double *stiffness)
{
    $body
}

double ${name}_load(
    $parameters)
{
    double load, stiffness;
    $name($arguments, &load, &stiffness);
    return load;
}

double ${name}_stiffness(
    $parameters)
{
    double load, stiffness;
    $name($arguments, &load, &stiffness);
    return stiffness;
}
"""


def source(law: ExportedLaw, frame: str = _FRAME) -> str:
    """Return the C source of a law; `frame` may be another, as for C++."""
    parameters = ", ".join(f"double {name}" for name in law.arguments)
    last = _LAST if law.ends else ""
    return law.source(DIALECT, frame, parameters=parameters, last=last, body=_BODY)
