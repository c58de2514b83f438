"""The clearance joint in the plane as an element, from the functions of `mechanism.contact`."""

from __future__ import annotations

import numpy as np

from cylcontact.bodies.material import Material
from cylcontact.export.element import Element, Motion, law_function
from cylcontact.export.program import Program
from cylcontact.impact import RATIO_BEND
from cylcontact.joint import contact
from cylcontact.joint.clearance import TANGENT_FROM, ClearanceJoint, JointState, JointWrench
from cylcontact.joint.contact import DEEPEST_SHARE, LEFT_HOLE
from cylcontact.laws.kernels import CURVE, TABLE
from cylcontact.support.plain_text import comment

_MOTION = (
    Motion("x", "length", "position of the reference point", "x + ahead*v_x"),
    Motion("y", "length", "position of the reference point", "y + ahead*v_y"),
    Motion("angle", "angle", "angle, anticlockwise", "angle + ahead*spin"),
    Motion("v_x", "speed", "velocity of the reference point"),
    Motion("v_y", "speed", "velocity of the reference point"),
    Motion("spin", "spin", "rate of the angle"),
)
_MEANINGS = {
    "force_bearing": ("force", "force on the body with the hole"),
    "moment_bearing": ("moment", "about the reference point of this body"),
    "force_pin": ("force", "force on the body with the pin"),
    "moment_pin": ("moment", "about the reference point of this body"),
    "penetration": ("length", "negative where the bodies do not touch"),
    "penetration_rate": ("speed", "rate of the penetration"),
    "normal_force": (
        "force", "not negative, on the hole along -n, n from the pin's centre to the hole's"
    ),
    "friction_force": ("force", "on the hole along t = (n_y, -n_x)"),
    "tangential_velocity": ("speed", "of the hole against the pin, along t"),
    "dissipated_power": ("power", "by damping and friction, not negative"),
    "flag": ("", "sum of 1 above first yield, 2 beyond the law's domain, 32 pin left its hole"),
}  # fmt: skip
# Units and meanings of the numbers of a joint's record.
_CONSTANTS = {
    "clearance": ("m", "radial clearance"),
    "R_bearing": ("m", "radius of the hole"),
    "R_pin": ("m", "radius of the pin"),
    "x_i": ("m", "centre of the hole, in the"),
    "y_i": ("m", "  axes of its body"),
    "x_j": ("m", "centre of the pin, in the"),
    "y_j": ("m", "  axes of its body"),
    "length": ("mm", "axial length; the law is per mm"),
    "metres": ("m", "the unit of length"),
    "rate_floor": ("m/s", "slowest impact rate that counts"),
    "chi": ("-", "hysteresis factor"),
    "friction": ("-", "friction coefficient"),
    "v0": ("m/s", "no friction up to this speed"),
    "v1": ("m/s", "all of the friction from this speed"),
    "last_penetration": ("mm", "end of the law;"),
    "last_load": ("N/mm", "  beyond it the tangent:"),
    "last_slope": ("N/mm^2", "  its load and slope"),
    "first_yield": ("N", "elastic force at first yield"),
}
_FUNCTIONS = (
    contact.elastic_force, contact.bounded_ratio, contact.friction_force, contact.relative_motion,
    contact.forces, contact.move, contact.evaluate, contact.accept,
)  # fmt: skip


def element_of(joint: ClearanceJoint) -> Element:
    """Return a joint as functions, constants and words."""
    pair = joint.pair
    form = "its formula at this pair"
    if joint.kernel.kind == TABLE:
        form = "a table, cubic in ln f over ln d"
    elif joint.kernel.kind == CURVE:
        form = "a curve, a cubic between even nodes in ln(1 + D/d), within 1e-8 of the load"
    origin = f"; {comment(joint.origin)}" if joint.origin else ""
    R_i, R_j = map(float, pair.radii("the joint"))
    bodies = {"hole": (pair.material_i, R_i), "pin": (pair.material_j, R_j)}
    law, numbers = law_function(joint.law, pair, joint.kernel)
    return Element(
        name=joint.identifier,
        title=joint.name,
        units=joint.units,
        law_text=f"'{comment(joint.law.name)}', {form}{origin}",
        motion=_MOTION,
        meanings=_MEANINGS,
        constants={
            f"joint_{name}": (float(joint.block[name]), *about)
            for name, about in _CONSTANTS.items()
        },
        about=[_body_text(name, *body) for name, body in bodies.items()],
        assumptions=_assumptions(joint),
        checks=_checks(joint),
        program=Program(_FUNCTIONS, joint.block, contact.WORK, law, numbers),
    )


def _assumptions(joint: ClearanceJoint) -> list[str]:
    """Return what the element assumes, in words."""
    tangent = (
        f"beyond last_penetration, {TANGENT_FROM:.0%} of the largest penetration of the law or its "
        "table, the load goes on along the tangent, and flag has the bit 2"
    )
    return [
        "two rigid bodies in the plane; the contact is a line load over the length, at one point "
        "on the surface of the hole",
        "load = law(penetration)*length*(1 + chi*s), never negative, with s the ratio of the "
        "penetration rate to the impact rate",
        f"s itself up to {RATIO_BEND:g}, bounded smoothly by twice that beyond, so that damping is "
        f"at most {2 * RATIO_BEND:g}*chi times the elastic load in sustained contact",
        "an impact slower than rate_floor counts as one at rate_floor",
        "friction = friction*normal force, linearly from none at v0 to all at v1",
        *([tangent] if np.isfinite(joint.block["last_penetration"]) else []),
        "the material is elastic; above first_yield, von Mises, flag has the bit 1"
        if joint.can_yield
        else "the material is elastic, and as the yield stresses are not both known, flag never "
        "has the bit 1",
        f"beyond a penetration of {DEEPEST_SHARE:g} times the hole's radius the pin has left its "
        f"hole: flag has the bit {LEFT_HOLE}",
    ]


def _checks(joint: ClearanceJoint) -> list[tuple[float, list[float], list[float], JointWrench]]:
    """Return states and their wrenches: free, first touch, pressed and sliding, leaving."""
    mm, checks = joint.in_mm, []
    start, speed = [x / mm for x in joint.point_bearing], 50.0 / mm
    for kept, part, rate, spin in (
        (0.0, 0.5, 1.0, 0.0), (0.0, 1.001, 1.0, 2.0), (1.0, 1.004, 0.25, -30.0),
        (1.0, 1.002, -0.75, 30.0),
    ):  # fmt: skip
        away, fast = part * (joint.radial / mm), rate * speed
        bearing = [0.0, 0.0, 0.0, 0.0, 0.0, spin]
        pin = [start[0] + 0.6 * away, start[1] + 0.8 * away, 0.0, 0.6 * fast, 0.8 * fast, 0.0]
        wrench = joint.evaluate(JointState(kept * speed), bearing, pin)
        checks.append((kept * speed, bearing, pin, wrench))
    return checks


def _body_text(name: str, material: Material, radius: float) -> str:
    """Return radius and material of a body on one line."""
    stress = "unknown" if material.yield_stress is None else f"{material.yield_stress!r} MPa"
    return (
        f"{name}: R = {radius!r} mm, {comment(material.name)}, E = {float(material.E)!r} MPa, "
        f"nu = {float(material.nu)!r}, yield stress {stress}"
    )
