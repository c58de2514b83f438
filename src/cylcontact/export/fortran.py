"""The Fortran target: a Fortran 2008 module of elemental procedures."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from textwrap import wrap

from cylcontact.export.exported_law import ExportedLaw, flat
from cylcontact.export.render import WIDTH, Dialect
from cylcontact.laws.formula import Step, assigned_in

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

# Lambert's w = -1 - W(-p/e), W the lower branch: a start in closed form and one step.
_LAMBERT = """
elemental function branch_distance(p) result(distance)
    real(wp), intent(in) :: p
    real(wp) :: distance
    real(wp) :: $names

    $steps
    distance = $w
end function branch_distance"""

DIALECT = Dialect(
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
    lambert=_LAMBERT,
)

_FRAME = """\
$comment
!
! Fortran 2008. The procedures are elemental: the arguments may be arrays.
module ${name}_law
    use, intrinsic :: iso_fortran_env, only: wp => real64
    use, intrinsic :: ieee_arithmetic
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

        load = ieee_value(1.0_wp, ieee_quiet_nan)
        if (penetration < 0.0_wp) load = 0.0_wp
        stiffness = load
        $check
        $at_pair
        $last
        $at_depth
        ! At first touch the steps may have no value, as ln 0.
        load = merge(f, 0.0_wp, penetration > 0.0_wp .or. f >= 0.0_wp)
        stiffness = merge(k, 0.0_wp, penetration > 0.0_wp .or. k >= 0.0_wp)
    end subroutine $name

    elemental function ${name}_load( &
        $arguments) result(load)
        real(wp), intent(in) :: $arguments
        real(wp) :: load, stiffness

        call $name( &
            $arguments, load, stiffness)
    end function ${name}_load

    elemental function ${name}_stiffness( &
        $arguments) result(stiffness)
        real(wp), intent(in) :: $arguments
        real(wp) :: load, stiffness

        call $name( &
            $arguments, load, stiffness)
    end function ${name}_stiffness
    $helpers

end module ${name}_law
"""


def source(law: ExportedLaw) -> str:
    """Return the Fortran source of a law."""
    domain = DIALECT.wrapped(f"if (.not. ({DIALECT.render(law.domain)})) return")
    return law.source(
        DIALECT,
        _FRAME,
        variables=declared(law.steps),
        check=domain,
        last="if (.not. ($ends)) return" if law.ends else "",
    )


def declared(steps: Iterable[Step]) -> str:
    """Return the declaration of the variables that steps assign, and of what loops count."""
    steps = tuple(steps)
    kinds = {
        "real(wp)": list(assigned_in(steps)),
        "integer": list(dict.fromkeys(step.name for step in flat(steps) if step.body)),
    }
    return "\n".join(
        f"{kind} :: " + " &\n    ".join(wrap(", ".join(names), WIDTH - 24))
        for kind, names in kinds.items() if names
    )  # fmt: skip
