"""The MATLAB target: a function file for MATLAB and Octave, elementwise on arrays."""

from __future__ import annotations

import ast
from string import Template

from cylcontact.export.comments import comment_lines
from cylcontact.export.formula import Formula, Step
from cylcontact.export.render import Dialect

__all__ = ["to_matlab"]

_DIALECT = Dialect(
    number=lambda value: repr(value).removesuffix(".0"),
    power="{x}.^{y}",
    names={"nan": "NaN"},
    symbols={ast.And: "&", ast.Or: "|", ast.Mult: ".*", ast.Div: "./"},
)

# Only elements inside the domain are used, so that no logarithm or power becomes complex.
_FILE = Template("""\
function [f, k] = $name($arguments)
$comment
%
% MATLAB R2016b or newer, or Octave; save as $name.m.
% The arguments may be arrays, which expand against each other; f is the load, k the stiffness.
inside = $domain;
f = NaN(size(inside));
k = f;
$selection
$body
end

function x = select(x, inside)
% The elements of x inside the domain, as a column.
x = x + zeros(size(inside));
x = reshape(x(inside), [], 1);
end
$helpers""")

_CHOOSE = """
function x = choose(condition, yes, no)
% Elementwise: yes where the condition holds, no elsewhere.
x = no + zeros(size(condition));
yes = yes + zeros(size(condition));
x(condition) = yes(condition);
end
"""


def to_matlab(formula: Formula) -> str:
    """Return the MATLAB source of a formula.

    Examples
    --------
    >>> from cylcontact.export.formulas import formula_of
    >>> from cylcontact.laws.liu import Liu
    >>> source = to_matlab(formula_of(Liu(), "internal"))
    >>> print(*[line for line in source.splitlines() if "root =" in line])
    root = sqrt(penetration ./ (2 .* (dR + penetration)));
    """
    constants = [f"{name} = {value!r};" for name, value in formula.constants.items()]
    steps = [f"{_target(step)} = {_value(step)};" for step in formula.steps]
    conditional = any(isinstance(step.value, ast.IfExp) for step in formula.steps)
    return _FILE.substitute(
        comment=comment_lines(formula, "%"),
        name=formula.name,
        arguments=", ".join(formula.arguments),
        domain=" & ".join(f"({text})" for text in _DIALECT.conditions(formula.requirements)),
        selection="\n".join(f"{name} = select({name}, inside);" for name in formula.arguments),
        body="\n".join(constants + steps),
        helpers=_CHOOSE if conditional else "",
    )


def _target(step: Step) -> str:
    """Return the target of an assignment; the results are assigned inside the domain only."""
    return f"{step.name}(inside)" if step.name in {"f", "k"} else step.name


def _value(step: Step) -> str:
    """Return the value of a step."""
    if not isinstance(step.value, ast.IfExp):
        return _DIALECT.render(step.value)
    sides = map(_DIALECT.render, (step.value.test, step.value.body, step.value.orelse))
    return f"choose({', '.join(sides)})"
