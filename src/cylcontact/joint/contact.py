"""Compiled contact of pin and bearing: Eqs 11–15 with any law of the package.

Body *i* carries the bearing, body *j* the pin. With the eccentricity e = r_i − r_j (Eq 11),
n = e/|e| points from the pin's centre to the bearing's, and the bodies touch on the side of −n.
Both contact forces act at one point, C = r_i − R_i·n on the bearing's surface, so that the pair
exchanges no net angular momentum. Relative to the pin's centre, C is at −(R_j − δ)·n, at the pin's
radius minus the penetration.

The velocities of the two bodies at C give the tangential velocity, with t = [n_y, −n_x],

    v_t = (v_i − v_j)·t = ė·t + ω_i·R_i − ω_j·(R_j − δ),

and the normal velocity is the penetration rate, (v_i − v_j)·n = ė·n = δ̇, because a rotation about
either centre moves C along t only.

**Units.** The mechanics is in SI, the laws in mm and N/mm. Only `elastic_force` and `stored_energy`
convert between them. `evaluate` and `accept`, of a joint by itself, take and give the joint's own
unit of length; `cylcontact.export` translates them, and what they call.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from cylcontact.impact import RATIO_BEND
from cylcontact.laws.kernels import inlined_load, kernel_energy
from cylcontact.support.arrays import FloatArray
from cylcontact.support.numba_cache import called, compiled, inlined

# e in m, its rate in m/s, and the spins of the bodies with the bearing and with the pin in rad/s.
Motion = tuple[float, float, float, float, float, float]
# A joint with clearance, as compiled functions take it; in Python a record is of this type.
Joint = Any
Record = Any

# The force is smooth in pieces. An integrator holds a piece through a step, beyond its ends if need
# be, and changes it at events. Branches of friction: slip (±2), ramp (±1), none (0). Regimes of the
# load: the law, or the straight line that continues it. ANY chooses by the state.
LAW, LINE = 0, 1
ANY = 9

# First what a run changes: whether there is contact, δ̇⁽⁻⁾ at the onset and bounded from below in
# m/s, and the pieces. Penetrations at which the law ends are in mm, all else is in SI.
JOINT = np.dtype(
    [
        *((name, np.int64) for name in ("touching", "branch", "regime")),
        *((name, np.float64) for name in ("onset_rate", "impact_rate")),
        *((name, np.float64) for name in ("chi", "friction", "v0", "v1", "rate_floor")),
        *((name, np.float64) for name in ("clearance", "R_bearing", "R_pin", "length")),
        *((name, np.float64) for name in ("last_penetration", "last_load", "last_slope")),
        *((name, np.float64) for name in ("stop_penetration", "allowed_penetration")),
        # The law's kind, and the centres of hole and pin in the axes of their bodies.
        ("kernel", np.int64),
        *((name, np.float64) for name in ("x_i", "y_i", "x_j", "y_j")),
        # The unit of length of a joint by itself in m, and its elastic force at first yield in N.
        *((name, np.float64) for name in ("metres", "first_yield")),
    ]
)
# What `evaluate` writes: a wrench, and the arms from the reference points to the centres in m.
WORK = np.dtype(
    [
        *(("force_bearing", np.float64, 2), ("moment_bearing", np.float64)),
        *(("force_pin", np.float64, 2), ("moment_pin", np.float64)),
        *((name, np.float64) for name in ("penetration", "penetration_rate")),
        *((name, np.float64) for name in ("normal_force", "friction_force", "tangential_velocity")),
        *((name, np.float64) for name in ("dissipated_power", "flag")),
        *((name, np.float64, 2) for name in ("arm_bearing", "arm_pin")),
    ]
)

# The bits of a wrench's flag; those between are of a joint in space.
YIELDS, BEYOND_LAW, LEFT_HOLE = 1, 2, 32
# Assumed: a penetration above this share of the hole's radius means that the pin has left its hole.
# Strains are then of the same size, far above those of any elastic contact.
DEEPEST_SHARE = 0.1


@inlined
def elastic_force(penetration: float, joint: Joint, law: FloatArray) -> float:
    """Return the elastic force in N at a penetration in m.

    Beyond `last_penetration` the load continues along a straight line.
    """
    delta = penetration * 1e3
    if delta <= 0.0:
        return 0.0
    if joint.regime == LINE or (joint.regime == ANY and delta > joint.last_penetration):
        load = joint.last_load + joint.last_slope * (delta - joint.last_penetration)
    else:
        load = inlined_load(joint.kernel, law, delta)
    return float(load * joint.length)


@compiled
def stored_energy(penetration: float, joint: Joint, law: FloatArray) -> float:
    """Return ∫ F_el dδ in J up to a penetration in m."""
    turn = joint.last_penetration * 1e-3
    # N/mm·mm times the length in mm is N mm.
    within = kernel_energy(joint.kernel, law, 1e3 * min(penetration, turn)) * joint.length * 1e-3
    if penetration <= turn:
        return float(within)
    ends = elastic_force(turn, joint, law) + elastic_force(penetration, joint, law)
    return float(within + 0.5 * (penetration - turn) * ends)


@inlined
def bounded_ratio(ratio: float) -> float:
    """Return `impact.bounded_ratio` of one number."""
    v = abs(ratio) / RATIO_BEND - 1.0
    if v <= 0.0:
        return ratio
    return math.copysign(RATIO_BEND * (1.0 + v / math.hypot(1.0, v)), ratio)


@inlined
def friction_force(normal: float, v_t: float, joint: Joint) -> float:
    """Return f_t = −c_f·c_d·f_n·sgn(v_t) in N (Eqs 14–15), v_t in m/s."""
    if joint.branch == ANY:
        correction = min(max((abs(v_t) - joint.v0) / (joint.v1 - joint.v0), 0.0), 1.0)
        correction = math.copysign(correction, v_t)
    elif abs(joint.branch) == 1:
        correction = (v_t - joint.branch * joint.v0) / (joint.v1 - joint.v0)
    else:
        correction = 0.5 * joint.branch
    return float(-joint.friction * correction * normal)


@inlined
def relative_motion(motion: Motion, joint: Joint) -> tuple[float, float, float, float, float]:
    """Return n_x, n_y, δ in m, and δ̇ and v_t in m/s.

    Centres that coincide have the normal (1, 0).
    """
    e_x, e_y, u_x, u_y, omega_i, omega_j = motion
    distance = math.sqrt(e_x * e_x + e_y * e_y)
    n_x, n_y = 1.0, 0.0
    if distance > 0.0:
        per_distance = 1.0 / distance
        n_x, n_y = e_x * per_distance, e_y * per_distance
    delta = distance - joint.clearance
    rate = u_x * n_x + u_y * n_y
    v_t = u_x * n_y - u_y * n_x + omega_i * joint.R_bearing - omega_j * (joint.R_pin - delta)
    return n_x, n_y, delta, rate, v_t


# What `forces` returns: f_i of Eq 13a in N, on the bearing at C, and the moments of it about the
# bearing's centre and of the opposite force about the pin's, in N m, positive anticlockwise; f_n in
# N, the powers in W that damping and friction dissipate, δ in m, and the elastic part of f_n in N.
Forces = tuple[float, float, float, float, float, float, float, float, float]


@inlined
def forces(motion: Motion, impact_rate: float, joint: Joint, law: FloatArray) -> Forces:
    """Return the contact of a pair that touches: δ̇⁽⁻⁾ in m/s, a joint, the numbers of its law."""
    n_x, n_y, delta, rate, v_t = relative_motion(motion, joint)
    elastic = elastic_force(delta, joint, law)
    damping = joint.chi * bounded_ratio(rate / impact_rate)
    normal = elastic * (1.0 + damping)
    if normal < 0.0:  # noqa: PLR1730 - in C the larger of 0 and NaN is 0
        normal = 0.0
    tangential = friction_force(normal, v_t, joint)
    force_x = -normal * n_x + tangential * n_y
    force_y = -normal * n_y - tangential * n_x
    # (−a·n) × (f_t·t) = a·f_t, as n × t = −1.
    moment_i, moment_j = joint.R_bearing * tangential, -(joint.R_pin - delta) * tangential
    normal_power, friction_power = (normal - elastic) * rate, -tangential * v_t
    return (
        force_x, force_y, moment_i, moment_j, normal, normal_power, friction_power, delta, elastic
    )  # fmt: skip


@called
def move(bearing: FloatArray, pin: FloatArray, w: Record, joint: Joint) -> Motion:
    """Write the arms, and return the motion of a joint from x, y, angle and rates of its bodies."""
    c, s = math.cos(bearing[2]), math.sin(bearing[2])
    w.arm_bearing[0] = c * joint.x_i - s * joint.y_i
    w.arm_bearing[1] = s * joint.x_i + c * joint.y_i
    c, s = math.cos(pin[2]), math.sin(pin[2])
    w.arm_pin[0] = c * joint.x_j - s * joint.y_j
    w.arm_pin[1] = s * joint.x_j + c * joint.y_j
    e_x = joint.metres * (bearing[0] - pin[0]) + w.arm_bearing[0] - w.arm_pin[0]
    e_y = joint.metres * (bearing[1] - pin[1]) + w.arm_bearing[1] - w.arm_pin[1]
    u_x = joint.metres * (bearing[3] - pin[3])
    u_y = joint.metres * (bearing[4] - pin[4])
    u_x = u_x - bearing[5] * w.arm_bearing[1] + pin[5] * w.arm_pin[1]
    u_y = u_y + bearing[5] * w.arm_bearing[0] - pin[5] * w.arm_pin[0]
    return e_x, e_y, u_x, u_y, bearing[5], pin[5]


@called
def evaluate(
    state: FloatArray, bearing: FloatArray, pin: FloatArray, w: Record, joint: Joint,
    law: FloatArray,
) -> None:  # fmt: skip
    """Write the wrench of bodies that move so, with this impact rate, in the joint's units."""
    motion = move(bearing, pin, w, joint)
    _, _, delta, rate, v_t = relative_motion(motion, joint)
    w.penetration = delta / joint.metres
    w.penetration_rate = rate / joint.metres
    w.tangential_velocity = v_t / joint.metres
    f_x, f_y, moment_i, moment_j = 0.0, 0.0, 0.0, 0.0
    normal, lost, rubbed, elastic = 0.0, 0.0, 0.0, 0.0
    if not delta <= 0.0:  # NaN too
        onset = state[0] * joint.metres if state[0] > 0.0 else max(rate, joint.rate_floor)
        f_x, f_y, moment_i, moment_j, normal, lost, rubbed, _, elastic = forces(
            motion, onset, joint, law
        )
        moment_i += w.arm_bearing[0] * f_y - w.arm_bearing[1] * f_x
        moment_j -= w.arm_pin[0] * f_y - w.arm_pin[1] * f_x
    w.force_bearing[0] = f_x
    w.force_bearing[1] = f_y
    w.moment_bearing = moment_i / joint.metres
    w.force_pin[0] = -f_x
    w.force_pin[1] = -f_y
    w.moment_pin = moment_j / joint.metres
    w.normal_force = normal
    w.friction_force = friction_force(normal, v_t, joint)
    w.dissipated_power = (lost + rubbed) / joint.metres
    w.flag = 0.0
    if elastic > joint.first_yield:
        w.flag += YIELDS
    if delta * 1e3 > joint.last_penetration:
        w.flag += BEYOND_LAW
    if delta > DEEPEST_SHARE * joint.R_bearing:
        w.flag += LEFT_HOLE


@called
def accept(
    state: FloatArray, bearing: FloatArray, pin: FloatArray, w: Record, joint: Joint
) -> None:
    """Update the impact rate after an accepted step."""
    motion = move(bearing, pin, w, joint)
    _, _, delta, rate, _ = relative_motion(motion, joint)
    if delta <= 0.0:
        state[0] = 0.0
    elif state[0] <= 0.0:
        state[0] = max(rate, joint.rate_floor) / joint.metres
