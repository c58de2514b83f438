"""The MATLAB target: a function file for MATLAB and Octave, elementwise on arrays."""

from __future__ import annotations

import ast

from cylcontact.export.exported_law import ExportedLaw
from cylcontact.export.render import Dialect

_CHOOSE = """
function x = choose(condition, yes, no)
% Elementwise: yes where the condition holds, no elsewhere.
condition = condition & true(size(yes + no));
x = no + zeros(size(condition));
yes = yes + zeros(size(condition));
x(condition) = yes(condition);
end"""

# Lambert's w = -1 - W(-p/e), W the lower branch: a start in closed form and one step.
_LAMBERT = """
function w = branch_distance(p)
$steps
w = $w;
end"""

DIALECT = Dialect(
    comment="%",
    number=lambda value: repr(value).removesuffix(".0"),
    power="{x}.^{y}",
    assignment="{name} = {value};",
    choice="choose({test}, {yes}, {no})",
    loop="for {name} = {first}:{step}:{last}\n{body}\nend",
    continued=" ...",
    names={"nan": "NaN", "inf": "Inf", "pi": "pi"},
    symbols={ast.And: "&", ast.Or: "|", ast.Mult: ".*", ast.Div: "./"},
    helpers={"choose": _CHOOSE},
    lambert=_LAMBERT,
)

# Outside the domain the arguments are NaN, so that no logarithm or power becomes complex.
_FRAME = """\
function [load, stiffness] = $name($arguments)
$comment
%
% MATLAB R2016b or newer, or Octave; save as $name.m.
% The arguments may be arrays, which expand against each other.
numbers = zeros(size($total));
$expanded
apart = penetration < 0;
outside = ~($domain);
$hidden
$constants
$at_pair
$last
$at_depth
% At first touch the steps may have no value, as log(0).
load = f + numbers;
stiffness = k + numbers;
load((penetration == 0 & isnan(load)) | apart) = 0;
stiffness((penetration == 0 & isnan(stiffness)) | apart) = 0;
load(outside & ~apart) = NaN;
stiffness(outside & ~apart) = NaN;
end
$helpers
"""
_LAST = """\
outside = outside | ~($ends);
penetration(outside) = NaN;"""


def source(law: ExportedLaw) -> str:
    """Return the MATLAB source of a law."""
    names = law.arguments
    return law.source(
        DIALECT,
        _FRAME,
        total=" + ".join(names),
        expanded="\n".join(f"{name} = {name} + numbers;" for name in names),
        hidden="\n".join(f"{name}(outside) = NaN;" for name in names),
        last=_LAST if law.ends else "",
    )
