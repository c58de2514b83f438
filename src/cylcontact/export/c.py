"""The C target: one C99 file with prototypes and definitions."""

from __future__ import annotations

import ast
from string import Template

import numpy as np

from cylcontact.export.comments import comment_lines
from cylcontact.export.formula import Formula, Step
from cylcontact.export.render import Dialect

__all__ = ["to_c"]

_DIALECT = Dialect(
    number=repr,
    power="pow({x}, {y})",
    names={"pi": repr(np.pi), "nan": "(double)NAN", "max": "fmax"},
    symbols={ast.And: "&&", ast.Or: "||"},
)

_FILE = Template("""\
$comment
//
// C99; link with -lm.

#include <math.h>

// The declarations, for a header of your own.
void $name(
    $arguments,
    double *load, double *stiffness);
double ${name}_load(
    $arguments);
double ${name}_stiffness(
    $arguments);

void $name(
    $arguments,
    double *load, double *stiffness)
{
    if (!($domain)) {
        *load = NAN;
        *stiffness = NAN;
        return;
    }
$body
    *load = f;
    *stiffness = k;
}

double ${name}_load(
    $arguments)
{
    double load, stiffness;
    $name($names, &load, &stiffness);
    return load;
}

double ${name}_stiffness(
    $arguments)
{
    double load, stiffness;
    $name($names, &load, &stiffness);
    return stiffness;
}
""")


def to_c(formula: Formula) -> str:
    """Return the C source of a formula.

    Examples
    --------
    >>> from cylcontact.export.formulas import formula_of
    >>> from cylcontact.laws.liu import Liu
    >>> source = to_c(formula_of(Liu(), "internal"))
    >>> print(*[line for line in source.splitlines() if "root =" in line])
        const double root = sqrt(penetration / (2.0 * (dR + penetration)));
    """
    constants = [f"    const double {n} = {v!r};" for n, v in formula.constants.items()]
    steps = [f"    const double {step.name} = {_value(step)};" for step in formula.steps]
    return _FILE.substitute(
        comment=comment_lines(formula, "//"),
        name=formula.name,
        arguments=", ".join(f"double {name}" for name in formula.arguments),
        names=", ".join(formula.arguments),
        domain=" && ".join(_DIALECT.conditions(formula.requirements)),
        body="\n".join(constants + steps),
    )


def _value(step: Step) -> str:
    """Return the value of a step; a condition evaluates one side only."""
    if not isinstance(step.value, ast.IfExp):
        return _DIALECT.render(step.value)
    condition, yes, no = map(_DIALECT.render, (step.value.test, step.value.body, step.value.orelse))
    return f"({condition}) ? {yes} : {no}"
