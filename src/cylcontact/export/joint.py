"""The clearance joint in the plane as an element: the steps of `cylcontact.mechanism.joint`."""

from __future__ import annotations

import numpy as np

from cylcontact.export.element import Constant, Element, Motion, Result, law_steps
from cylcontact.impact import RATIO_BEND
from cylcontact.laws.formula import steps_of
from cylcontact.laws.kernels import TABLE
from cylcontact.materials import Material
from cylcontact.mechanism.joint import TANGENT_FROM, ClearanceJoint, JointState, JointWrench
from cylcontact.plain_text import comment

_MOTION = (
    Motion("x", "length", "position of the reference point", "x + ahead*v_x"),
    Motion("y", "length", "position of the reference point", "y + ahead*v_y"),
    Motion("angle", "angle", "angle, anticlockwise", "angle + ahead*spin"),
    Motion("v_x", "speed", "velocity of the reference point"),
    Motion("v_y", "speed", "velocity of the reference point"),
    Motion("spin", "spin", "rate of the angle"),
)
_RESULTS = (
    Result("force_bearing", ("force_x", "force_y"), "force", "force on the body with the hole"),
    Result("moment_bearing", ("moment_b",), "moment", "about the reference point of this body"),
    Result("force_pin", ("-force_x", "-force_y"), "force", "force on the body with the pin"),
    Result("moment_pin", ("moment_p",), "moment", "about the reference point of this body"),
    Result("penetration", ("delta",), "length", "negative where the bodies do not touch"),
    Result("penetration_rate", ("rate",), "speed", "rate of the penetration"),
    Result("normal_force", ("normal",), "force",
           "not negative, on the hole along -n, n from the pin's centre to the hole's"),
    Result("friction_force", ("tangential",), "force", "on the hole along t = (n_y, -n_x)"),
    Result("tangential_velocity", ("v_t",), "speed", "of the hole against the pin, along t"),
    Result("dissipated_power", ("power",), "power", "by damping and friction, not negative"),
    Result("flag", ("flag",), "", "1 above first yield, plus 2 beyond the law's domain"),
)  # fmt: skip

_MOTION_STEPS = """
cos_b = cos(bearing_angle)
sin_b = sin(bearing_angle)
cos_p = cos(pin_angle)
sin_p = sin(pin_angle)
arm_bx = cos_b*point_bearing_x - sin_b*point_bearing_y
arm_by = sin_b*point_bearing_x + cos_b*point_bearing_y
arm_px = cos_p*point_pin_x - sin_p*point_pin_y
arm_py = sin_p*point_pin_x + cos_p*point_pin_y
e_x = bearing_x + arm_bx - (pin_x + arm_px)
e_y = bearing_y + arm_by - (pin_y + arm_py)
u_x = bearing_v_x - bearing_spin*arm_by - (pin_v_x - pin_spin*arm_py)
u_y = bearing_v_y + bearing_spin*arm_bx - (pin_v_y + pin_spin*arm_px)
distance = sqrt(e_x*e_x + e_y*e_y)
n_x = e_x/distance if distance > 0 else 1
n_y = e_y/distance if distance > 0 else 0
delta = distance - clearance
rate = u_x*n_x + u_y*n_y
first_rate = impact_rate if impact_rate > 0 else max(rate, rate_floor)
next_rate = 0 if delta <= 0 else first_rate
radius = r_pin - delta
v_t = u_x*n_y - u_y*n_x + bearing_spin*r_bearing - pin_spin*radius
depth = in_mm*delta
"""
_LOAD_STEPS = "load = law(depth)\n"
_TANGENT_STEPS = """
tangent = last_load + last_slope*(depth - last_depth)
load = tangent if depth > last_depth else law(depth)
"""
_FORCE_STEPS = """
elastic = load*length
ratio = rate/first_rate
size = ratio if ratio > 0 else -ratio
beyond = max(size/bend - 1, 0)
bent = bend*(1 + beyond/hypot(1, beyond))
bound = bent if ratio > 0 else -bent
bounded = ratio if size <= bend else bound
normal = max(elastic*(1 + chi*bounded), 0)
speed = v_t if v_t > 0 else -v_t
ramp = (speed - v_0)/(v_1 - v_0)
part = ramp if ramp < 1 else 1
c_d = max(part, 0)
along = 1 if v_t > 0 else -1
tangential = -(friction*c_d*normal*along)
force_x = tangential*n_y - normal*n_x
force_y = -(normal*n_y) - tangential*n_x
moment_b = r_bearing*tangential + arm_bx*force_y - arm_by*force_x
moment_p = -(radius*tangential) - arm_px*force_y + arm_py*force_x
power = (normal - elastic)*rate - tangential*v_t
"""


def element_of(joint: ClearanceJoint) -> Element:
    """Return a joint as steps, constants and words."""
    pair = joint.pair
    ends = bool(np.isfinite(joint.block["last_penetration"]))
    beyond, above = "2 if depth > last_depth else 0", "1 if elastic > first_yield else 0"
    flag = f"flag = {beyond if ends else above if joint.can_yield else 0}\n"
    if ends and joint.can_yield:
        flag = f"past = {beyond}\nyields = {above}\nflag = past + yields\n"
    load = _TANGENT_STEPS if ends else _LOAD_STEPS
    form = "its formula at this pair"
    if joint.kernel.kind == TABLE:
        form = "a table, cubic in ln f over ln d"
    origin = f"; {comment(joint.origin)}" if joint.origin else ""
    bodies = {"hole": (pair.material_i, pair.R_i), "pin": (pair.material_j, pair.R_j)}
    return Element(
        name=joint.identifier,
        title=joint.name,
        units=joint.units,
        law=law_steps(joint.law, pair, joint.kernel),
        law_text=f"'{comment(joint.law.name)}', {form}{origin}",
        motion=_MOTION,
        results=_RESULTS,
        steps=steps_of(_MOTION_STEPS + load + _FORCE_STEPS + flag),
        constants=_constants(joint, ends),
        about=[_body_text(name, *body) for name, body in bodies.items()],
        assumptions=_assumptions(joint, ends),
        checks=_checks(joint),
    )


def _constants(joint: ClearanceJoint, ends: bool) -> dict[str, Constant]:
    """Return the constants of the steps."""
    p, mm, u = joint.block, joint.in_mm, "m" if joint.units == "SI" else "mm"
    R_i, R_j = (float(R) / mm for R in joint.pair.radii("the joint"))
    rows = {
        "clearance": (joint.radial / mm, u, "radial clearance"),
        "r_bearing": (R_i, u, "radius of the hole"),
        "r_pin": (R_j, u, "radius of the pin"),
        "point_bearing_x": (joint.point_bearing[0] / mm, u, "centre of the hole, in the"),
        "point_bearing_y": (joint.point_bearing[1] / mm, u, "  axes of its body"),
        "point_pin_x": (joint.point_pin[0] / mm, u, "centre of the pin, in the"),
        "point_pin_y": (joint.point_pin[1] / mm, u, "  axes of its body"),
        "length": (float(p["length"]), "mm", "axial length; the law is per mm"),
        "in_mm": (mm, f"mm/{u}", "the law takes the penetration in mm"),
        "rate_floor": (joint.rate_floor, f"{u}/s", "slowest impact rate that counts"),
        "chi": (joint.chi, "-", "hysteresis factor"),
        "bend": (RATIO_BEND, "-", "ratio of rates from which the damping bends"),
        "friction": (joint.friction, "-", "friction coefficient"),
        "v_0": (joint.v0 / mm, f"{u}/s", "no friction up to this speed"),
        "v_1": (joint.v1 / mm, f"{u}/s", "all of the friction from this speed"),
    }
    if ends:
        rows |= {
            "last_depth": (float(p["last_penetration"]), "mm", "end of the law;"),
            "last_load": (float(p["last_load"]), "N/mm", "  beyond it the tangent:"),
            "last_slope": (float(p["last_slope"]), "N/mm^2", "  its load and slope"),
        }
    if joint.can_yield:
        rows["first_yield"] = (joint.first_yield, "N", "elastic force at first yield")
    return {name: Constant(*row) for name, row in rows.items()}


def _assumptions(joint: ClearanceJoint, ends: bool) -> list[str]:
    """Return what the element assumes, in words."""
    tangent = (
        f"beyond last_depth, {TANGENT_FROM:.0%} of the largest penetration of the law or its "
        "table, the load goes on along the tangent, and flag has the bit 2"
    )
    return [
        "two rigid bodies in the plane; the contact is a line load over the length, at one point "
        "on the surface of the hole",
        "load = law(penetration)*length*(1 + chi*s), never negative, with s the ratio of the "
        "penetration rate to the impact rate",
        "s itself up to bend, bounded by 2*bend beyond (bend*(1 + v/sqrt(1 + v^2)) with v = "
        "abs(s)/bend - 1), so that damping is at most 2*bend*chi times the elastic load in "
        "sustained contact",
        "an impact slower than rate_floor counts as one at rate_floor",
        "friction = friction*normal force, linearly from none at v_0 to all at v_1",
        *([tangent] if ends else []),
        "the material is elastic; above first_yield, von Mises, flag has the bit 1"
        if joint.can_yield
        else "the material is elastic, and as the yield stresses are not both known, flag never "
        "has the bit 1",
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


def _body_text(name: str, material: Material, radius: object) -> str:
    """Return radius and material of a body on one line."""
    stress = "unknown" if material.yield_stress is None else f"{material.yield_stress!r} MPa"
    return (
        f"{name}: R = {radius!r} mm, {comment(material.name)}, E = {float(material.E)!r} MPa, "
        f"nu = {float(material.nu)!r}, yield stress {stress}"
    )
