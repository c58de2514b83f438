"""The Fortran target: a Fortran 2008 module of elemental procedures."""

from __future__ import annotations

import ast
from string import Template
from textwrap import indent, wrap

import numpy as np

from cylcontact.export.comments import WIDTH, comment_lines
from cylcontact.export.formula import Formula, Step, names_in
from cylcontact.export.render import Dialect

__all__ = ["to_fortran"]


def _literal(value: float) -> str:
    """Return a literal of kind wp."""
    return f"{value!r}_wp"


_DIALECT = Dialect(
    number=_literal,
    power="{x}**{y}",
    names={"pi": _literal(np.pi), "nan": "ieee_value(1.0_wp, ieee_quiet_nan)"},
    symbols={ast.And: ".and.", ast.Or: ".or."},
)

_FILE = Template("""\
$comment
!
! Fortran 2008. The procedures are elemental: the arguments may be arrays.
module ${name}_law
    use, intrinsic :: iso_fortran_env, only: wp => real64
    use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
    implicit none
    private
    public :: $name
    public :: ${name}_load
    public :: ${name}_stiffness

contains

    elemental subroutine $name( &
        $arguments, load, stiffness)
        real(wp), intent(in) :: $arguments
        real(wp), intent(out) :: load, stiffness
$declarations

        if (.not. ($domain)) then
            load = ieee_value(1.0_wp, ieee_quiet_nan)
            stiffness = ieee_value(1.0_wp, ieee_quiet_nan)
            return
        end if
$body
        load = f
        stiffness = k
    end subroutine $name

    elemental function ${name}_load($arguments) &
        result(load)
        real(wp), intent(in) :: $arguments
        real(wp) :: load, stiffness

        call $name($arguments, load, stiffness)
    end function ${name}_load

    elemental function ${name}_stiffness($arguments) &
        result(stiffness)
        real(wp), intent(in) :: $arguments
        real(wp) :: load, stiffness

        call $name($arguments, load, stiffness)
    end function ${name}_stiffness
$helpers
end module ${name}_law
""")

# Fortran has no log1p. atanh is accurate for small x, also with a compiler that reorders sums.
_LOG1P = """
    elemental function log1p(x) result(y)
        real(wp), intent(in) :: x
        real(wp) :: y

        if (abs(x) < 0.5_wp) then
            y = 2.0_wp * atanh(x / (2.0_wp + x))
        else
            y = log(1.0_wp + x)
        end if
    end function log1p
"""


def to_fortran(formula: Formula) -> str:
    """Return the Fortran source of a formula.

    Examples
    --------
    >>> from cylcontact.export.formulas import formula_of
    >>> from cylcontact.laws.liu import Liu
    >>> source = to_fortran(formula_of(Liu(), "internal"))
    >>> print(*[line.strip() for line in source.splitlines() if "root =" in line])
    root = sqrt(penetration / (2.0_wp * (dR + penetration)))
    """
    used = set().union(*(names_in(step.value) for step in formula.steps))
    constants = [
        f"real(wp), parameter :: {name} = {_literal(value)}"
        for name, value in formula.constants.items()
    ]
    variables = wrap(", ".join(step.name for step in formula.steps), WIDTH - 24)
    declarations = [*constants, "real(wp) :: " + " &\n    ".join(variables)]
    return _FILE.substitute(
        comment=comment_lines(formula, "!"),
        name=formula.name,
        arguments=", ".join(formula.arguments),
        declarations=indent("\n".join(declarations), " " * 8),
        domain=" .and. &\n            ".join(_DIALECT.conditions(formula.requirements)),
        body=indent("\n".join(_assignment(step) for step in formula.steps), " " * 8),
        helpers=_LOG1P if "log1p" in used else "",
    )


def _assignment(step: Step) -> str:
    """Return the assignment of a step; a condition evaluates one side only."""
    if not isinstance(step.value, ast.IfExp):
        return f"{step.name} = {_DIALECT.render(step.value)}"
    condition, yes, no = map(_DIALECT.render, (step.value.test, step.value.body, step.value.orelse))
    return f"if ({condition}) then\n    {step.name} = {yes}\nelse\n    {step.name} = {no}\nend if"
