"""The Fortran target: a Fortran 2008 module of pure procedures."""

from __future__ import annotations

from dataclasses import replace

from cylcontact.arrays import FloatArray
from cylcontact.export.fortran import DIALECT, declared
from cylcontact.export.joints.element import (
    RESULTS,
    Element,
    argument_names,
    bodies_of,
    rows_of,
    table_parts,
)
from cylcontact.export.render import filled
from cylcontact.mechanism.joint import ClearanceJoint

# The standard allows 255 lines for a statement; a table is cut into arrays of as many nodes.
_NODES = 800

_USAGE = """\
use $name

type(${name}_state) :: state
type(${name}_wrench) :: wrench
call ${name}_start(state)
call ${name}_evaluate(state, bearing, pin, wrench)   (state is not changed)
call ${name}_accept(state, bearing, pin)"""

_FRAME = """\
$comment
!
! Fortran 2008.
module $name
    use, intrinsic :: iso_fortran_env, only: wp => real64
    $nan_module
    implicit none
    private
    public :: ${name}_state
    public :: ${name}_wrench
    public :: ${name}_start
    public :: ${name}_evaluate
    public :: ${name}_accept

    type :: ${name}_state
        real(wp) :: impact_rate = 0.0_wp ! 0: not in contact
    end type ${name}_state

    type :: ${name}_wrench
        real(wp) :: force_bearing(2), moment_bearing
        real(wp) :: force_pin(2), moment_pin
        real(wp) :: penetration, penetration_rate
        real(wp) :: normal_force, friction_force, tangential_velocity
        real(wp) :: dissipated_power
        integer :: flag
    end type ${name}_wrench

contains

    pure subroutine ${name}_start(state)
        type(${name}_state), intent(out) :: state

        state%impact_rate = 0.0_wp
    end subroutine ${name}_start

    pure subroutine ${name}_evaluate(state, bearing, pin, wrench)
        type(${name}_state), intent(in) :: state
        real(wp), intent(in) :: bearing(6), pin(6)
        type(${name}_wrench), intent(out) :: wrench
        $evaluate_constants
        $evaluate_variables

        $evaluate
        $results
    end subroutine ${name}_evaluate

    pure subroutine ${name}_accept(state, bearing, pin)
        type(${name}_state), intent(inout) :: state
        real(wp), intent(in) :: bearing(6), pin(6)
        $accept_constants
        $accept_variables

        $accept
        state%impact_rate = next_rate
    end subroutine ${name}_accept

    ! The law: N/mm at a penetration in mm.
    pure function law(penetration) result(f)
        real(wp), intent(in) :: penetration
        real(wp) :: f
        $law_constants
        $law_variables
        $table

        if (penetration <= 0.0_wp) then
            f = 0.0_wp
            return
        end if
        $lookup
        $law
    end function law
    $helpers

end module $name
"""

# The nodes around a penetration, by bisection.
_LOOKUP = """\
at = log(penetration)
low = 1
high = {last}
do while (high - low > 1)
    middle = (low + high) / 2
    if (x(middle) <= at) then
        low = middle
    else
        high = middle
    end if
end do
x_0 = x(low)
y_0 = y(low)
s_0 = s(low)
x_1 = x(high)
y_1 = y(high)
s_1 = s(high)"""

_RESULTS = """\
wrench%force_bearing = [{0}, {1}]
wrench%moment_bearing = {2}
wrench%force_pin = [-{0}, -{1}]
wrench%moment_pin = {3}
wrench%penetration = {4}
wrench%penetration_rate = {5}
wrench%normal_force = {6}
wrench%friction_force = {7}
wrench%tangential_velocity = {8}
wrench%dissipated_power = {9}
wrench%flag = nint({10})"""


def source(joint: ClearanceJoint, stem: str = "") -> dict[str, str]:
    """Return the text of the module, by file name."""
    element, stem = Element(joint), stem or joint.identifier
    names = argument_names("{body}({k})", 1) | {"impact_rate": "state%impact_rate"}
    bodies = bodies_of(element, replace(DIALECT, names={**DIALECT.names, **names}))
    parts = {
        "name": joint.identifier,
        **bodies,
        "evaluate_variables": declared(element.evaluate),
        "accept_variables": declared(element.accept),
        "law_variables": declared(step for step in element.law if step.name != "f"),
        **table_parts(element, _arrays, _LOOKUP, 1),
        "results": _RESULTS.format(*RESULTS),
        "helpers": DIALECT.helpers_of(bodies["law"]),
        "nan_module": "",
    }
    if "ieee_value" in bodies["law"]:
        parts["nan_module"] = "use, intrinsic :: ieee_arithmetic"
    parts["comment"] = element.comment(filled(_USAGE, parts), "!")
    return {f"{stem}.f90": filled(_FRAME, parts)}


def _arrays(table: tuple[FloatArray, ...]) -> str:
    """Return the declarations for a table: ln of the penetration, ln of the load, slopes."""
    texts = ["real(wp) :: at, x_0, y_0, s_0, x_1, y_1, s_1", "integer :: low, high, middle"]
    for name, numbers in zip("xys", table, strict=True):
        parts = []
        for k in range(0, numbers.size, _NODES):
            rows = rows_of(numbers[k : k + _NODES], DIALECT.number)
            parts.append(f"{name}_from_{k}")
            size = min(_NODES, numbers.size - k)
            inside = ", &\n    ".join(rows)
            texts.append(f"real(wp), parameter :: {parts[-1]}({size}) = [ &\n    {inside}]")
        texts.append(f"real(wp), parameter :: {name}({numbers.size}) = [{', '.join(parts)}]")
    return "\n".join(texts)
