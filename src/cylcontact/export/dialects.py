"""The notation of each language, for laws and joints."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import replace

from cylcontact.export.render import Dialect

# Lambert's w = -1 - W(-p/e), W the lower branch: a start in closed form and one step.
_C_LAMBERT = """
static double branch_distance(double p)
{
    $steps
    return $w;
}"""
_FORTRAN_LAMBERT = """
elemental function branch_distance(p) result(distance)
    real(wp), intent(in) :: p
    real(wp) :: distance
    real(wp) :: $names

    $steps
    distance = $w
end function branch_distance"""
_MATLAB_LAMBERT = """
function w = branch_distance(p)
$steps
w = $w;
end"""
_PYTHON_LAMBERT = '''
def branch_distance(p):
    """Return w = -1 - W(-p/e), W the lower branch of Lambert's function."""
    $steps
    return $w

'''
_JAX_LAMBERT = '''
@jax.custom_jvp
def branch_distance(p):
    """Return w = -1 - W(-p/e), W the lower branch of Lambert's function."""
    $steps
    return $w


@branch_distance.defjvp
def _(primals, tangents):
    (p,), (slope,) = primals, tangents
    w = branch_distance(p)
    return w, -(1.0 + w) / (p * w) * slope

'''
# Functions that a language lacks; atanh is accurate for small x, however sums are reordered.
_LOG1P = """
elemental function log1p(x) result(y)
    real(wp), intent(in) :: x
    real(wp) :: y

    if (abs(x) < 0.5_wp) then
        y = 2.0_wp * atanh(x / (2.0_wp + x))
    else
        y = log(1.0_wp + x)
    end if
end function log1p"""
_CHOOSE = """
function x = choose(condition, yes, no)
% Elementwise: yes where the condition holds, no elsewhere.
condition = condition & true(size(yes + no));
x = no + zeros(size(condition));
yes = yes + zeros(size(condition));
x(condition) = yes(condition);
end"""
_POWER = """
def power(x, y):
    \"\"\"Return x**y, as C has it.\"\"\"
    try:
        return math.pow(x, y)
    except ValueError:
        return math.inf if x == 0 else math.nan
    except OverflowError:
        return math.inf

"""

_C = Dialect(
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
    lambert=_C_LAMBERT,
)
_FORTRAN = Dialect(
    comment="!",
    number="{!r}_wp".format,
    power="{x}**{y}",
    assignment="{name} = {value}",
    choice="merge({yes}, {no}, {test})",
    branch="if ({test}) then\n    {name} = {yes}\nelse\n    {name} = {no}\nend if",
    loop="do {name} = {first}, {last}, {step}\n{body}\nend do",
    counter="real({name}, wp)",
    constant="real(wp), parameter :: {name} = {value}",
    continued=" &",
    names={
        "nan": "ieee_value(1.0_wp, ieee_quiet_nan)",
        "inf": "ieee_value(1.0_wp, ieee_positive_inf)",
    },
    symbols={ast.And: ".and.", ast.Or: ".or."},
    helpers={"log1p": _LOG1P},
    lambert=_FORTRAN_LAMBERT,
)
_MATLAB = Dialect(
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
    lambert=_MATLAB_LAMBERT,
)
_FUNCTIONS = ("log", "log1p", "exp", "sqrt", "sin", "cos", "pi", "nan", "inf")
_PYTHON = Dialect(
    comment="#",
    number=repr,
    power="power({x}, {y})",
    assignment="{name} = {value}",
    choice="{yes} if {test} else {no}",
    loop="for {name} in range({first}, {stop}, {step}):\n{body}",
    continued=" \\",
    names={name: f"math.{name}" for name in (*_FUNCTIONS, "atan", "hypot")},
    helpers={"power": _POWER},
    lambert=_PYTHON_LAMBERT,
)
_JAX = Dialect(
    comment="#",
    number=repr,
    power="{x} ** {y}",
    assignment="{name} = {value}",
    choice="jnp.where({test}, {yes}, {no})",
    loop="for {name} in range({first}, {stop}, {step}):\n{body}",
    continued=" \\",
    names={
        **{name: f"jnp.{name}" for name in _FUNCTIONS},
        "atan": "jnp.arctan",
        "max": "jnp.maximum",
    },
    symbols={ast.And: "&", ast.Or: "|"},
    lambert=_JAX_LAMBERT,
)
# By the names of the targets.
DIALECTS: Mapping[str, Dialect] = {
    "c": _C,
    "cpp": _C,
    "fortran": _FORTRAN,
    "matlab": _MATLAB,
    "python": _PYTHON,
    "jax": _JAX,
}
# A joint takes numbers, not arrays, and no power that fails.
JOINT_DIALECTS: Mapping[str, Dialect] = {
    **DIALECTS,
    "matlab": replace(
        _MATLAB, branch="if {test}\n    {name} = {yes};\nelse\n    {name} = {no};\nend", helpers={}
    ),
    "python": replace(_PYTHON, power="{x}**{y}"),
}
