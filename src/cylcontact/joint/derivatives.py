"""Compiled derivatives of the planar wrench, and the energy that its contact stores.

The wrench follows from the relative motion of the centres: e and its rate u, the two spins, and the
arms from the reference points to the centres. With t = (n_y, −n_x), a change of e gives

    dδ = n·de,    dn = t·(t·de)/|e|,    dδ̇ = n·du + (u·t)·(t·de)/|e|,
    dv_t = t·du − δ̇·(t·de)/|e| + ω_j·dδ + R_i·dω_i − (R_j − δ)·dω_j,

and these give the changes of the two loads, f_n = F_el(δ)·(1 + χ·s(δ̇/δ̇⁽⁻⁾)) and
f_t = −µ·c_d(v_t)·f_n. An angle turns its arm.

The impact rate of a state is held. At a kink (first touch, v_t at v0 or v1, the clip of the normal
force at zero, the end of the law) a derivative is that of the piece that `contact.evaluate` takes
there. Without contact all forces and their derivatives are zero.

`cylcontact.export` translates the functions, so they keep to the rules of `export.plain`.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from cylcontact.impact import RATIO_BEND
from cylcontact.joint.contact import (
    Arms,
    Body,
    Joint,
    Law,
    Relative,
    State,
    Wrench,
    arms_of,
    bounded_ratio,
    friction_share,
    load_at,
    motion_of,
    relative_motion,
)
from cylcontact.laws.kernels import kernel_stiffness
from cylcontact.support.arrays import FloatArray
from cylcontact.support.numba_cache import called, inlined

# Of force x, force y and moment of bearing and pin, row by row, by x, y and angle of bearing and
# pin, and by their rates.
JACOBIAN = np.dtype([("by_position", np.float64, 36), ("by_velocity", np.float64, 36)])
Jacobian = Annotated[Any, JACOBIAN]
Matrix = Annotated[FloatArray, 0]


class Pull(NamedTuple):
    """A load in N/mm and its stiffness in N/mm²."""

    load: float
    stiffness: float


class Loads(NamedTuple):
    """The loads in N of a pair that touches, and their derivatives.

    The elastic and the normal load, the stiffness dF_el/dδ in N/m, the derivatives of the normal
    load by δ and by δ̇, f_t/f_n, and the derivative of f_t by v_t at a constant f_n.
    """

    elastic: float
    normal: float
    stiff: float
    by_delta: float
    by_rate: float
    share: float
    viscous: float


class Change(NamedTuple):
    """The change of the force on the bearing, and of both moments about the centres."""

    f_x: float
    f_y: float
    turn_i: float
    turn_j: float


@inlined
def pull_at(depth: float, joint: Joint, law: Law) -> Pull:
    """Return load and stiffness at a penetration in mm that is positive."""
    return Pull(load_at(depth, joint, law), float(kernel_stiffness(joint.kernel, law, depth)))


@inlined
def bounded_slope(ratio: float) -> float:
    """Return the derivative of `bounded_ratio`."""
    v = abs(ratio) / RATIO_BEND - 1.0
    if v <= 0.0:
        return 1.0
    square = 1.0 + v * v
    return 1.0 / (square * math.sqrt(square))


@inlined
def loads_of(m: Relative, state: State, joint: Joint, law: Law) -> Loads:
    """Return the loads of a pair that touches, in the piece of the state."""
    depth = 1e3 * m.delta
    onset = state.impact_rate * joint.metres
    damping = joint.chi
    if onset <= 0.0:
        onset = max(m.rate, joint.rate_floor)
        if m.rate > joint.rate_floor:
            damping = 0.0  # the ratio of the rates is 1 whatever the rate
    elastic = joint.last_load + joint.last_slope * (depth - joint.last_penetration)
    stiff = joint.last_slope
    if not depth > joint.last_penetration:  # NaN too
        pull = pull_at(depth, joint, law)
        elastic = pull.load
        stiff = pull.stiffness
    elastic *= joint.length
    stiff *= 1e3 * joint.length
    ratio = m.rate / onset
    damped = 1.0 + joint.chi * bounded_ratio(ratio)
    normal = elastic * damped
    by_delta = stiff * damped
    by_rate = elastic * damping * bounded_slope(ratio) / onset
    if normal <= 0.0:
        normal = 0.0
        by_delta = 0.0
        by_rate = 0.0
    viscous = 0.0
    if abs(m.v_t) > joint.v0 and abs(m.v_t) < joint.v1:
        viscous = -joint.friction * normal / (joint.v1 - joint.v0)
    share = -joint.friction * friction_share(m.v_t, joint)
    return Loads(elastic, normal, stiff, by_delta, by_rate, share, viscous)


@inlined
def change_of(
    normal: float, tangential: float, turn: float, delta: float, m: Relative, loads: Loads,
    joint: Joint,
) -> Change:  # fmt: skip
    """Return the change of the wrench by those of f_n, f_t, the direction of n, and δ."""
    drag = loads.share * loads.normal
    by_n = -normal - drag * turn
    by_t = tangential - loads.normal * turn
    return Change(
        by_n * m.n_x + by_t * m.n_y, by_n * m.n_y - by_t * m.n_x,
        joint.R_bearing * tangential, drag * delta - (joint.R_pin - m.delta) * tangential,
    )  # fmt: skip


@inlined
def turned(
    e_x: Change, e_y: Change, u_x: Change, u_y: Change, x: float, y: float, omega: float
) -> Change:
    """Return the change by an angle: a centre at the arm (x, y) moves, and so does its velocity."""
    return Change(
        x * e_y.f_x - y * e_x.f_x - omega * (x * u_x.f_x + y * u_y.f_x),
        x * e_y.f_y - y * e_x.f_y - omega * (x * u_x.f_y + y * u_y.f_y),
        x * e_y.turn_i - y * e_x.turn_i - omega * (x * u_x.turn_i + y * u_y.turn_i),
        x * e_y.turn_j - y * e_x.turn_j - omega * (x * u_x.turn_j + y * u_y.turn_j),
    )


@inlined
def spun(u_x: Change, u_y: Change, x: float, y: float, rim: Change) -> Change:
    """Return the change by a spin: the velocity of the centre, and that of the rim about it."""
    return Change(
        x * u_y.f_x - y * u_x.f_x + rim.f_x, x * u_y.f_y - y * u_x.f_y + rim.f_y,
        x * u_y.turn_i - y * u_x.turn_i + rim.turn_i, x * u_y.turn_j - y * u_x.turn_j + rim.turn_j,
    )  # fmt: skip


@inlined
def put(
    out: Matrix, k: int, c: Change, lever_i: float, lever_j: float, scale: float, arms: Arms,
    joint: Joint,
) -> None:  # fmt: skip
    """Write a column; the levers are what the turning of an arm adds to the moments."""
    out[k] = scale * c.f_x
    out[6 + k] = scale * c.f_y
    out[12 + k] = scale * (arms.x_i * c.f_y - arms.y_i * c.f_x + c.turn_i + lever_i) / joint.metres
    out[18 + k] = -out[k]
    out[24 + k] = -out[6 + k]
    out[30 + k] = scale * (c.turn_j + lever_j - arms.x_j * c.f_y + arms.y_j * c.f_x) / joint.metres


@inlined
def mirror(out: Matrix) -> None:
    """Write the columns of the pin's centre, which counts against the bearing's."""
    for k in range(0, 36, 6):
        out[k + 3] = -out[k]
        out[k + 4] = -out[k + 1]


@called
def evaluate_jacobian(
    state: State, bearing: Body, pin: Body, jacobian: Jacobian, joint: Joint, law: Law
) -> None:
    """Write the derivatives of force and moment of both bodies, in the joint's units."""
    for k in range(36):
        jacobian.by_position[k] = 0.0
        jacobian.by_velocity[k] = 0.0
    arms = arms_of(bearing, pin, joint)
    motion = motion_of(bearing, pin, arms, joint)
    m = relative_motion(motion, joint)
    if not m.delta <= 0.0:  # NaN too
        loads = loads_of(m, state, joint, law)
        drag = loads.share * loads.normal
        f_x = -loads.normal * m.n_x + drag * m.n_y
        f_y = -loads.normal * m.n_y - drag * m.n_x
        # By e: n turns towards t, which adds to the two velocities.
        per = 1.0 / (m.delta + joint.clearance)
        u_t = motion.u_x * m.n_y - motion.u_y * m.n_x
        tau_x = m.n_y * per
        tau_y = -m.n_x * per
        normal_x = loads.by_delta * m.n_x + loads.by_rate * u_t * tau_x
        normal_y = loads.by_delta * m.n_y + loads.by_rate * u_t * tau_y
        slip_x = motion.omega_j * m.n_x - m.rate * tau_x
        slip_y = motion.omega_j * m.n_y - m.rate * tau_y
        drag_x = loads.share * normal_x + loads.viscous * slip_x
        drag_y = loads.share * normal_y + loads.viscous * slip_y
        e_x = change_of(normal_x, drag_x, tau_x, m.n_x, m, loads, joint)
        e_y = change_of(normal_y, drag_y, tau_y, m.n_y, m, loads, joint)
        # By u, and by the speed of either rim about its centre.
        rate_x = loads.by_rate * m.n_x
        rate_y = loads.by_rate * m.n_y
        pull_x = loads.share * rate_x + loads.viscous * m.n_y
        pull_y = loads.share * rate_y - loads.viscous * m.n_x
        u_x = change_of(rate_x, pull_x, 0.0, 0.0, m, loads, joint)
        u_y = change_of(rate_y, pull_y, 0.0, 0.0, m, loads, joint)
        rim_i = loads.viscous * joint.R_bearing
        rim_j = -loads.viscous * (joint.R_pin - m.delta)
        w_i = change_of(0.0, rim_i, 0.0, 0.0, m, loads, joint)
        w_j = change_of(0.0, rim_j, 0.0, 0.0, m, loads, joint)

        put(jacobian.by_position, 0, e_x, 0.0, 0.0, joint.metres, arms, joint)
        put(jacobian.by_position, 1, e_y, 0.0, 0.0, joint.metres, arms, joint)
        put(jacobian.by_velocity, 0, u_x, 0.0, 0.0, joint.metres, arms, joint)
        put(jacobian.by_velocity, 1, u_y, 0.0, 0.0, joint.metres, arms, joint)
        mirror(jacobian.by_position)
        mirror(jacobian.by_velocity)
        turn_i = turned(e_x, e_y, u_x, u_y, arms.x_i, arms.y_i, motion.omega_i)
        turn_j = turned(e_x, e_y, u_x, u_y, -arms.x_j, -arms.y_j, motion.omega_j)
        lever_i = -(arms.x_i * f_x + arms.y_i * f_y)
        lever_j = arms.x_j * f_x + arms.y_j * f_y
        put(jacobian.by_position, 2, turn_i, lever_i, 0.0, 1.0, arms, joint)
        put(jacobian.by_position, 5, turn_j, 0.0, lever_j, 1.0, arms, joint)
        spin_i = spun(u_x, u_y, arms.x_i, arms.y_i, w_i)
        spin_j = spun(u_x, u_y, -arms.x_j, -arms.y_j, w_j)
        put(jacobian.by_velocity, 2, spin_i, 0.0, 0.0, 1.0, arms, joint)
        put(jacobian.by_velocity, 5, spin_j, 0.0, 0.0, 1.0, arms, joint)


@called
def differentiate(
    state: State, bearing: Body, pin: Body, bearing_along: Body, pin_along: Body, wrench: Wrench,
    joint: Joint, law: Law,
) -> None:  # fmt: skip
    """Write the derivative of a wrench along a direction of both bodies; its flag is 0."""
    arms = arms_of(bearing, pin, joint)
    motion = motion_of(bearing, pin, arms, joint)
    m = relative_motion(motion, joint)
    arm_x_i = -bearing_along[2] * arms.y_i
    arm_y_i = bearing_along[2] * arms.x_i
    arm_x_j = -pin_along[2] * arms.y_j
    arm_y_j = pin_along[2] * arms.x_j
    e_x = joint.metres * (bearing_along[0] - pin_along[0]) + arm_x_i - arm_x_j
    e_y = joint.metres * (bearing_along[1] - pin_along[1]) + arm_y_i - arm_y_j
    u_x = joint.metres * (bearing_along[3] - pin_along[3]) - bearing_along[5] * arms.y_i
    u_x += pin_along[5] * arms.y_j - motion.omega_i * arm_y_i + motion.omega_j * arm_y_j
    u_y = joint.metres * (bearing_along[4] - pin_along[4]) + bearing_along[5] * arms.x_i
    u_y += motion.omega_i * arm_x_i - pin_along[5] * arms.x_j - motion.omega_j * arm_x_j
    distance = m.delta + joint.clearance
    turn = 0.0
    if not distance <= 0.0:  # NaN too
        turn = (m.n_y * e_x - m.n_x * e_y) / distance
    delta = m.n_x * e_x + m.n_y * e_y
    rate = m.n_x * u_x + m.n_y * u_y + (motion.u_x * m.n_y - motion.u_y * m.n_x) * turn
    slip = m.n_y * u_x - m.n_x * u_y - m.rate * turn + joint.R_bearing * bearing_along[5]
    slip += motion.omega_j * delta - (joint.R_pin - m.delta) * pin_along[5]
    loads = Loads(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if not m.delta <= 0.0:  # NaN too
        loads = loads_of(m, state, joint, law)
    drag = loads.share * loads.normal
    normal = loads.by_delta * delta + loads.by_rate * rate
    tangential = loads.share * normal + loads.viscous * slip
    f_x = -loads.normal * m.n_x + drag * m.n_y
    f_y = -loads.normal * m.n_y - drag * m.n_x
    c = change_of(normal, tangential, turn, delta, m, loads, joint)
    moment_i = arms.x_i * c.f_y - arms.y_i * c.f_x + arm_x_i * f_y - arm_y_i * f_x + c.turn_i
    moment_j = arms.y_j * c.f_x - arms.x_j * c.f_y + arm_y_j * f_x - arm_x_j * f_y + c.turn_j

    wrench.force_bearing[0] = c.f_x
    wrench.force_bearing[1] = c.f_y
    wrench.moment_bearing = moment_i / joint.metres
    wrench.force_pin[0] = -c.f_x
    wrench.force_pin[1] = -c.f_y
    wrench.moment_pin = moment_j / joint.metres
    wrench.penetration = delta / joint.metres
    wrench.penetration_rate = rate / joint.metres
    wrench.normal_force = normal
    wrench.friction_force = tangential
    wrench.tangential_velocity = slip / joint.metres
    lost = (normal - loads.stiff * delta) * m.rate + (loads.normal - loads.elastic) * rate
    wrench.dissipated_power = (lost - tangential * m.v_t - drag * slip) / joint.metres
    wrench.flag = 0


# Nodes and weights on [0, 1] for the energy, dense at first touch.
_u, _weight = np.polynomial.legendre.leggauss(12)
WORK_PART, WORK_WEIGHT = ((_u + 1) / 2) ** 3, 1.5 * ((_u + 1) / 2) ** 2 * _weight


@called
def elastic_energy(bearing: Body, pin: Body, joint: Joint, law: Law) -> float:
    """Return the energy that the contact stores, in N times the joint's unit of length."""
    arms = arms_of(bearing, pin, joint)
    m = relative_motion(motion_of(bearing, pin, arms, joint), joint)
    depth = 1e3 * m.delta
    if depth <= 0.0:
        return 0.0
    inside = min(depth, joint.last_penetration)
    total = 0.0
    for k in range(12):
        total += WORK_WEIGHT[k] * load_at(inside * WORK_PART[k], joint, law)
    total *= inside
    if depth > inside:
        more = depth - inside
        total += more * (joint.last_load + 0.5 * more * joint.last_slope)
    return float(1e-3 * total * joint.length / joint.metres)
