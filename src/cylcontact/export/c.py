"""The C target: one C99 file with prototypes and definitions."""

from __future__ import annotations

import ast

import numpy as np

from cylcontact.export.render import Dialect
from cylcontact.laws.formula import Formula

__all__ = ["DIALECT", "source"]

DIALECT = Dialect(
    comment="//",
    number=repr,
    power="pow({x}, {y})",
    assignment="const double {name} = {value};",
    choice="const double {name} = ({test}) ? {yes} : {no};",
    joint=" && ",
    names={"pi": repr(np.pi), "nan": "(double)NAN", "max": "fmax"},
    symbols={ast.And: "&&", ast.Or: "||"},
)

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

void $name(
    $parameters,
    double *load, double *stiffness)
{
    if (penetration < 0.0) {
        *load = 0.0;
        *stiffness = 0.0;
        return;
    }
    if (!($domain)) {
        *load = NAN;
        *stiffness = NAN;
        return;
    }
    $constants
    $steps
    *load = f;
    *stiffness = k;
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


def source(formula: Formula) -> str:
    """Return the C source of a formula.

    Examples
    --------
    >>> from cylcontact.export.formulas import formula_of
    >>> from cylcontact.laws.liu import Liu
    >>> text = source(formula_of(Liu(), "internal"))
    >>> print(*[line for line in text.splitlines() if "root =" in line])
        const double root = sqrt(penetration / (2.0 * (dR + penetration)));
    """
    parameters = ", ".join(f"double {name}" for name in formula.arguments)
    return DIALECT.source(formula, _FRAME, parameters=parameters)
