"""Compiled contact of journal and bearing: Eqs 11–15 with any law of the package.

Body *i* carries the bearing, body *j* the journal. With the eccentricity e = r_i − r_j
(Eq 11), n = e/|e| points from the journal's centre to the bearing's, and the bodies touch on the
side of −n. Both contact forces act at one point, C = r_i − R_i·n on the bearing's surface, so that
the pair exchanges no net angular momentum. Relative to the journal's centre, C is at −(R_j − δ)·n,
at the journal's radius minus the penetration.

The velocities of the two bodies at C give the tangential velocity, with t = [n_y, −n_x],

    v_t = (v_i − v_j)·t = ė·t + ω_i·R_i − ω_j·(R_j − δ),

and the normal velocity is the penetration rate, (v_i − v_j)·n = ė·n = δ̇, because a rotation about
either centre moves C along t only.

**Units.** The mechanics is in SI, the laws in mm and N/mm. Only `elastic_force` converts between
them: it takes a penetration in m and returns a force in N.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cylcontact.impact import RATIO_BEND
from cylcontact.laws.kernels import kernel_load
from cylcontact.numba_cache import compiled, inlined

__all__ = [
    "ALLOWED_PENETRATION",
    "ANY",
    "BRANCH",
    "CHI",
    "CLEARANCE",
    "CONTACT",
    "FREE",
    "FRICTION",
    "HEADER",
    "IMPACT_RATE",
    "KERNEL",
    "KERNEL_SIZE",
    "KERNEL_START",
    "LAST_LOAD",
    "LAST_PENETRATION",
    "LAST_SLOPE",
    "LAW",
    "LENGTH",
    "LINE",
    "MODE",
    "MODEL_START",
    "RATE_FLOOR",
    "REGIME",
    "R_BEARING",
    "R_JOURNAL",
    "STOP_PENETRATION",
    "V0",
    "V1",
    "bounded_ratio",
    "contact_force",
    "elastic_force",
    "forces",
    "friction_force",
    "law_of",
    "relative_motion",
]

# Positions in the parameter block of a compiled model: this header, the numbers of the law and
# those of the model.
MODE, IMPACT_RATE, BRANCH, REGIME = 0, 1, 2, 3
CHI, FRICTION, V0, V1 = 4, 5, 6, 7
CLEARANCE, R_BEARING, R_JOURNAL, LENGTH = 8, 9, 10, 11
LAST_PENETRATION, LAST_LOAD, LAST_SLOPE, STOP_PENETRATION = 12, 13, 14, 15
KERNEL, KERNEL_START, KERNEL_SIZE, MODEL_START = 16, 17, 18, 19
ALLOWED_PENETRATION, RATE_FLOOR = 20, 21
HEADER = 22

FREE, CONTACT = 0.0, 1.0
# The force is smooth in pieces. An integrator holds a piece through a step, beyond its ends if need
# be, and changes it at events. Branches of friction: slip (±2), ramp (±1), none (0). Regimes of the
# load: the law, or the straight line that continues it. ANY chooses by the state.
LAW, LINE = 0.0, 1.0
ANY = 9.0


@compiled
def law_of(p: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the numbers of the law in a parameter block."""
    start = int(p[KERNEL_START])
    return p[start : start + int(p[KERNEL_SIZE])]


@compiled
def elastic_force(penetration: float, p: NDArray[np.float64]) -> float:
    """Return the elastic force in N at a penetration in m.

    Beyond `LAST_PENETRATION` (in mm) the load continues along a straight line.
    """
    return _elastic(penetration, p, law_of(p))


@inlined
def _elastic(penetration: float, p: NDArray[np.float64], law: NDArray[np.float64]) -> float:
    delta = penetration * 1e3
    if delta <= 0.0:
        return 0.0
    if p[REGIME] == LINE or (p[REGIME] == ANY and delta > p[LAST_PENETRATION]):
        load = p[LAST_LOAD] + p[LAST_SLOPE] * (delta - p[LAST_PENETRATION])
    else:
        load = kernel_load(int(p[KERNEL]), law, delta)
    return float(load * p[LENGTH])


@inlined
def bounded_ratio(ratio: float) -> float:
    """Return `impact.bounded_ratio` of one number."""
    v = abs(ratio) / RATIO_BEND - 1.0
    if v <= 0.0:
        return ratio
    return math.copysign(RATIO_BEND * (1.0 + v / math.hypot(1.0, v)), ratio)


@inlined
def friction_force(normal: float, v_t: float, p: NDArray[np.float64]) -> float:
    """Return f_t = −c_f·c_d·f_n·sgn(v_t) in N (Eqs 14–15), v_t in m/s."""
    branch = p[BRANCH]
    if branch == ANY:
        correction = min(max((abs(v_t) - p[V0]) / (p[V1] - p[V0]), 0.0), 1.0)
        correction = math.copysign(correction, v_t)
    elif abs(branch) == 1.0:
        correction = (v_t - branch * p[V0]) / (p[V1] - p[V0])
    else:
        correction = 0.5 * branch
    return float(-p[FRICTION] * correction * normal)


@inlined
def relative_motion(
    e_x: float,
    e_y: float,
    u_x: float,
    u_y: float,
    omega_i: float,
    omega_j: float,
    p: NDArray[np.float64],
) -> tuple[float, float, float, float, float]:
    """Return n_x, n_y, δ in m, and δ̇ and v_t in m/s, of the arguments of `forces`.

    Centres that coincide have the normal (1, 0).
    """
    distance = math.sqrt(e_x * e_x + e_y * e_y)
    n_x, n_y = 1.0, 0.0
    if distance > 0.0:
        per_distance = 1.0 / distance
        n_x, n_y = e_x * per_distance, e_y * per_distance
    delta = distance - p[CLEARANCE]
    rate = u_x * n_x + u_y * n_y
    v_t = u_x * n_y - u_y * n_x + omega_i * p[R_BEARING] - omega_j * (p[R_JOURNAL] - delta)
    return n_x, n_y, delta, rate, v_t


@compiled
def contact_force(
    e: tuple[float, float],
    e_dot: tuple[float, float],
    omega_i: float,
    omega_j: float,
    p: NDArray[np.float64],
) -> tuple[float, float, float, float, float, float, float]:
    """Return the contact of a pair in contact mode: all but the last of `forces`."""
    law = law_of(p)
    return forces(e[0], e[1], e_dot[0], e_dot[1], omega_i, omega_j, p[IMPACT_RATE], p, law)[:7]


@inlined
def forces(
    e_x: float,
    e_y: float,
    u_x: float,
    u_y: float,
    omega_i: float,
    omega_j: float,
    impact_rate: float,
    p: NDArray[np.float64],
    law: NDArray[np.float64],
) -> tuple[float, float, float, float, float, float, float, float]:
    """Return the contact of a pair in contact mode.

    Parameters
    ----------
    e_x, e_y, u_x, u_y : float
        Eccentricity in m and its rate in m/s.
    omega_i, omega_j : float
        Spins of the bodies with the bearing and with the journal, rad/s.
    impact_rate : float
        δ̇⁽⁻⁾ in m/s, positive.
    p : array of float
        The parameter block.
    law : array of float
        The numbers of the law, `law_of(p)`.

    Returns
    -------
    force_x, force_y : float
        f_i of Eq 13a in N, on the bearing at C; the force on the journal is opposite.
    moment_i, moment_j : float
        Moments of that force about the bearing's centre and of the opposite force about the
        journal's centre, in N m; positive anticlockwise.
    normal : float
        f_n in N.
    normal_power, friction_power : float
        Powers dissipated by the damping part of the normal force and by friction, in W.
    penetration : float
        δ in m.
    """
    n_x, n_y, delta, rate, v_t = relative_motion(e_x, e_y, u_x, u_y, omega_i, omega_j, p)
    elastic = _elastic(delta, p, law)
    damping = p[CHI] * bounded_ratio(rate / impact_rate)
    normal = max(elastic * (1.0 + damping), 0.0)
    tangential = friction_force(normal, v_t, p)
    force_x = -normal * n_x + tangential * n_y
    force_y = -normal * n_y - tangential * n_x
    # (−a·n) × (f_t·t) = a·f_t, as n × t = −1.
    moment_i, moment_j = p[R_BEARING] * tangential, -(p[R_JOURNAL] - delta) * tangential
    normal_power, friction_power = (normal - elastic) * rate, -tangential * v_t
    return force_x, force_y, moment_i, moment_j, normal, normal_power, friction_power, delta
