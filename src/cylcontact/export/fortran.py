"""The Fortran target: a Fortran 2008 module of elemental procedures."""

from __future__ import annotations

import ast
from textwrap import wrap

import numpy as np

from cylcontact.export.comments import WIDTH
from cylcontact.export.render import Dialect
from cylcontact.laws.formula import Formula

__all__ = ["DIALECT", "source"]

# atanh is accurate for small x, also with a compiler that reorders sums.
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

DIALECT = Dialect(
    comment="!",
    number="{!r}_wp".format,
    power="{x}**{y}",
    assignment="{name} = {value}",
    choice="if ({test}) then\n    {name} = {yes}\nelse\n    {name} = {no}\nend if",
    joint=" .and. &\n            ",
    constant="real(wp), parameter :: {name} = {value}_wp",
    names={"pi": f"{np.pi!r}_wp", "nan": "ieee_value(1.0_wp, ieee_quiet_nan)"},
    symbols={ast.And: ".and.", ast.Or: ".or."},
    helpers={"log1p": _LOG1P},
)

_FRAME = """\
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
        $constants
        $variables

        if (penetration < 0.0_wp) then
            load = 0.0_wp
            stiffness = 0.0_wp
            return
        end if
        if (.not. ($domain)) then
            load = ieee_value(1.0_wp, ieee_quiet_nan)
            stiffness = ieee_value(1.0_wp, ieee_quiet_nan)
            return
        end if
        $steps
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
"""


def source(formula: Formula) -> str:
    """Return the Fortran source of a formula.

    Examples
    --------
    >>> from cylcontact.export.formulas import formula_of
    >>> from cylcontact.laws.liu import Liu
    >>> text = source(formula_of(Liu(), "internal"))
    >>> print(*[line.strip() for line in text.splitlines() if "root =" in line])
    root = sqrt(penetration / (2.0_wp * (dR + penetration)))
    """
    names = wrap(", ".join(step.name for step in formula.steps), WIDTH - 24)
    return DIALECT.source(formula, _FRAME, variables="real(wp) :: " + " &\n    ".join(names))
