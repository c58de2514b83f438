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

from cylcontact.laws.kernels import kernel_load
from cylcontact.numba_cache import compiled

__all__ = [
    "ALLOWED_PENETRATION",
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
    "LAYOUT",
    "LENGTH",
    "MODE",
    "MODEL_START",
    "RATE_FLOOR",
    "R_BEARING",
    "R_JOURNAL",
    "SIZE",
    "STATES",
    "STOP_PENETRATION",
    "V0",
    "V1",
    "bounded_ratio",
    "contact_at_rate",
    "contact_force",
    "elastic_force",
    "friction_force",
]

# Positions in the parameter block of a compiled right-hand side. The block is one array of floats,
# because CVODE passes a single pointer to a compiled callback.
SIZE, LAYOUT, STATES, MODE, IMPACT_RATE = 0, 1, 2, 3, 4
CHI, FRICTION, V0, V1 = 5, 6, 7, 8
CLEARANCE, R_BEARING, R_JOURNAL, LENGTH = 9, 10, 11, 12
LAST_PENETRATION, LAST_LOAD, LAST_SLOPE, STOP_PENETRATION = 13, 14, 15, 16
KERNEL, KERNEL_START, KERNEL_SIZE, MODEL_START = 17, 18, 19, 20
ALLOWED_PENETRATION, RATE_FLOOR = 21, 22
HEADER = 23

FREE, CONTACT = 0.0, 1.0


@compiled
def elastic_force(penetration: float, p: NDArray[np.float64]) -> float:
    """Return the elastic force in N at a penetration in m.

    Beyond `LAST_PENETRATION` (in mm) the load continues along a straight line.
    """
    delta = penetration * 1e3
    if delta <= 0.0:
        return 0.0
    if delta > p[LAST_PENETRATION]:
        load = p[LAST_LOAD] + p[LAST_SLOPE] * (delta - p[LAST_PENETRATION])
    else:
        start = int(p[KERNEL_START])
        parameters = p[start : start + int(p[KERNEL_SIZE])]
        load = kernel_load(int(p[KERNEL]), parameters, delta)
    return float(load * p[LENGTH])


@compiled
def bounded_ratio(ratio: float) -> float:
    """Return `dissipation.bounded_ratio` of one number."""
    v = abs(ratio) - 1.0
    if v <= 0.0:
        return ratio
    return math.copysign(1.0 + v / math.hypot(1.0, v), ratio)


@compiled
def friction_force(normal: float, v_t: float, p: NDArray[np.float64]) -> float:
    """Return f_t = −c_f·c_d·f_n·sgn(v_t) in N (Eqs 14–15), v_t in m/s."""
    c_d = min(max((abs(v_t) - p[V0]) / (p[V1] - p[V0]), 0.0), 1.0)
    return float(-p[FRICTION] * c_d * normal * np.sign(v_t))


@compiled
def contact_force(
    e: tuple[float, float],
    e_dot: tuple[float, float],
    omega_i: float,
    omega_j: float,
    p: NDArray[np.float64],
) -> tuple[float, float, float, float, float, float, float]:
    """Return the contact of a pair in contact mode.

    Parameters
    ----------
    e, e_dot : pair of float
        Eccentricity in m and its rate in m/s.
    omega_i, omega_j : float
        Spins of the bodies with the bearing and with the journal, rad/s.
    p : array of float
        The parameter block.

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
    """
    return contact_at_rate(e, e_dot, omega_i, omega_j, p[IMPACT_RATE], p)


@compiled
def contact_at_rate(
    e: tuple[float, float],
    e_dot: tuple[float, float],
    omega_i: float,
    omega_j: float,
    impact_rate: float,
    p: NDArray[np.float64],
) -> tuple[float, float, float, float, float, float, float]:
    """Return `contact_force` for a δ̇⁽⁻⁾ in m/s that is not the block's."""
    distance = math.hypot(e[0], e[1])
    n_x, n_y = e[0] / distance, e[1] / distance
    delta = distance - p[CLEARANCE]
    rate = e_dot[0] * n_x + e_dot[1] * n_y
    arm_i, arm_j = p[R_BEARING], p[R_JOURNAL] - delta
    v_t = e_dot[0] * n_y - e_dot[1] * n_x + omega_i * arm_i - omega_j * arm_j

    elastic = elastic_force(delta, p)
    damping = p[CHI] * bounded_ratio(rate / impact_rate)
    normal = max(elastic * (1.0 + damping), 0.0)
    tangential = friction_force(normal, v_t, p)
    force_x = -normal * n_x + tangential * n_y
    force_y = -normal * n_y - tangential * n_x
    # (−a·n) × (f_t·t) = a·f_t, as n × t = −1.
    moment_i, moment_j = arm_i * tangential, -arm_j * tangential
    return (
        force_x,
        force_y,
        moment_i,
        moment_j,
        normal,
        (normal - elastic) * rate,
        -tangential * v_t,
    )
