"""The MATLAB target: a function file for MATLAB and Octave, elementwise on arrays."""

from __future__ import annotations

import ast

from cylcontact.export.render import Dialect
from cylcontact.laws.formula import Formula

__all__ = ["DIALECT", "source"]

_CHOOSE = """
function x = choose(condition, yes, no)
% Elementwise: yes where the condition holds, no elsewhere.
x = no + zeros(size(condition));
yes = yes + zeros(size(condition));
x(condition) = yes(condition);
end"""

# The results are assigned inside the domain only.
DIALECT = Dialect(
    comment="%",
    number=lambda value: repr(value).removesuffix(".0"),
    power="{x}.^{y}",
    assignment="{name} = {value};",
    choice="{name} = choose({test}, {yes}, {no});",
    joint=") & (",
    names={"nan": "NaN", "f": "f(inside)", "k": "k(inside)"},
    symbols={ast.And: "&", ast.Or: "|", ast.Mult: ".*", ast.Div: "./"},
    helpers={"choose": _CHOOSE},
)

# Only elements inside the domain are used, so that no logarithm or power becomes complex.
_FRAME = """\
function [f, k] = $name($arguments)
$comment
%
% MATLAB R2016b or newer, or Octave; save as $name.m.
% The arguments may be arrays, which expand against each other; f is the load, k the stiffness.
inside = ($domain);
f = NaN(size(inside));
f(penetration + zeros(size(inside)) < 0) = 0;
k = f;
$selection
$constants
$steps
end

function x = select(x, inside)
% The elements of x inside the domain, as a column.
x = x + zeros(size(inside));
x = reshape(x(inside), [], 1);
end
$helpers
"""


def source(formula: Formula) -> str:
    """Return the MATLAB source of a formula.

    Examples
    --------
    >>> from cylcontact.export.formulas import formula_of
    >>> from cylcontact.laws.liu import Liu
    >>> text = source(formula_of(Liu(), "internal"))
    >>> print(*[line for line in text.splitlines() if "root =" in line])
    root = sqrt(penetration ./ (2 .* (dR + penetration)));
    """
    selection = (f"{name} = select({name}, inside);" for name in formula.arguments)
    return DIALECT.source(formula, _FRAME, selection="\n".join(selection))
