"""The multiplier form: any planar mechanism in Cartesian coordinates (Eq 10).

With a diagonal mass matrix the accelerations follow from the multipliers,

    (Φ_q·M⁻¹·Φ_qᵀ)·λ = Φ_q·M⁻¹·g − γ*,    q̈ = M⁻¹·(g − Φ_qᵀ·λ),

and Baumgarte's stabilisation replaces γ by γ* = γ − 2α·dΦ/dt − β²·Φ. The matrix on the left is
symmetric and positive definite unless constraints are redundant, and is factored by Cholesky.

The state is q, q̇ and the ledgers.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba.np.numpy_support import carray
from numpy.typing import NDArray

from cylcontact.mechanism import constraints, contact
from cylcontact.mechanism.cvode import RHS_SIGNATURE, ROOTS_SIGNATURE, block, values
from cylcontact.mechanism.events import EVENTS, fill_roots
from cylcontact.numba_cache import callback, compiled

__all__ = [
    "ALPHA",
    "BETA",
    "BODIES",
    "BODY_I",
    "BODY_J",
    "DRIVER_I",
    "DRIVER_J",
    "DRIVER_ROW",
    "GRAVITY_X",
    "GRAVITY_Y",
    "I_X",
    "I_Y",
    "JOINTS",
    "J_X",
    "J_Y",
    "MODEL_HEADER",
    "ROWS",
    "contact_on_bodies",
    "derivatives",
    "eccentricity",
    "rhs",
    "roots",
]

# Positions in the model's part of the parameter block; the masses and the table follow. A negative
# row of the driver means that there is none.
BODIES, JOINTS, ROWS, DRIVER_ROW, DRIVER_I, DRIVER_J = 0, 1, 2, 3, 4, 5
BODY_I, I_X, I_Y, BODY_J, J_X, J_Y, ALPHA, BETA, GRAVITY_X, GRAVITY_Y = (
    6, 7, 8, 9, 10, 11, 12, 13, 14, 15,
)  # fmt: skip
MODEL_HEADER = 16


@compiled
def eccentricity(
    t: float,  # noqa: ARG001 - for models whose joint moves with time
    y: NDArray[np.float64],
    p: NDArray[np.float64],
) -> tuple[float, float, float, float]:
    """Return e = r_i − r_j in m and its rate in m/s, in global axes."""
    m = p[int(p[contact.MODEL_START]) :]
    coordinates = 3 * int(m[BODIES])
    q, v = y[:coordinates], y[coordinates : 2 * coordinates]
    at_i = constraints.point(q, v, int(m[BODY_I]), m[I_X], m[I_Y])
    at_j = constraints.point(q, v, int(m[BODY_J]), m[J_X], m[J_Y])
    return at_i[2] - at_j[2], at_i[3] - at_j[3], at_i[4] - at_j[4], at_i[5] - at_j[5]


@compiled
def _apply(force: NDArray[np.float64], body: int, f_x: float, f_y: float, moment: float) -> None:
    if body >= 0:
        force[3 * body] += f_x
        force[3 * body + 1] += f_y
        force[3 * body + 2] += moment


@compiled
def _solve_positive(matrix: NDArray[np.float64], right: NDArray[np.float64]) -> None:
    """Solve a symmetric positive definite system in place, by Cholesky."""
    n = right.size
    for k in range(n):
        for i in range(k + 1):
            total = matrix[k, i]
            for l in range(i):  # noqa: E741
                total -= matrix[k, l] * matrix[i, l]
            matrix[k, i] = math.sqrt(total) if i == k else total / matrix[i, i]
        for l in range(k):  # noqa: E741
            right[k] -= matrix[k, l] * right[l]
        right[k] /= matrix[k, k]
    for k in range(n - 1, -1, -1):
        for l in range(k + 1, n):  # noqa: E741
            right[k] -= matrix[l, k] * right[l]
        right[k] /= matrix[k, k]


@compiled
def contact_on_bodies(
    q: NDArray[np.float64],
    v: NDArray[np.float64],
    force: NDArray[np.float64],
    p: NDArray[np.float64],
) -> tuple[float, float, float, float]:
    """Add the contact forces of Eq 13 to `force`; return the rates of the ledgers.

    These are the powers that the normal and the friction force dissipate in W, the penetration
    in m and the normal force in N.
    """
    m = p[int(p[contact.MODEL_START]) :]
    i, j = int(m[BODY_I]), int(m[BODY_J])
    ai_x, ai_y, i_x, i_y, vi_x, vi_y, spin_i = constraints.point(q, v, i, m[I_X], m[I_Y])
    aj_x, aj_y, j_x, j_y, vj_x, vj_y, spin_j = constraints.point(q, v, j, m[J_X], m[J_Y])
    e = (i_x - j_x, i_y - j_y)
    f_x, f_y, moment_i, moment_j, normal, normal_power, friction_power = contact.contact_force(
        e, (vi_x - vj_x, vi_y - vj_y), spin_i, spin_j, p
    )
    _apply(force, i, f_x, f_y, ai_x * f_y - ai_y * f_x + moment_i)
    _apply(force, j, -f_x, -f_y, -(aj_x * f_y - aj_y * f_x) + moment_j)
    return normal_power, friction_power, math.hypot(e[0], e[1]) - p[contact.CLEARANCE], normal


@compiled
def derivatives(
    t: float, y: NDArray[np.float64], out: NDArray[np.float64], p: NDArray[np.float64]
) -> None:
    """Write dy/dt to `out`: velocities, accelerations and the rates of the ledgers."""
    m = p[int(p[contact.MODEL_START]) :]
    size, joints, rows = 3 * int(m[BODIES]), int(m[JOINTS]), int(m[ROWS])
    q, v = y[:size], y[size : 2 * size]
    mass = m[MODEL_HEADER : MODEL_HEADER + size]
    first = MODEL_HEADER + size
    table = m[first : first + joints * constraints.COLUMNS].reshape(joints, constraints.COLUMNS)

    force = np.empty(size)
    for k in range(0, size, 3):
        force[k], force[k + 1], force[k + 2] = (
            mass[k] * m[GRAVITY_X], mass[k] * m[GRAVITY_Y], 0.0,
        )  # fmt: skip
    rates = (0.0, 0.0, 0.0, 0.0)
    if p[contact.MODE] == contact.CONTACT:
        rates = contact_on_bodies(q, v, force, p)

    work = np.empty((3, rows))
    value, rate, lam = work[0], work[1], work[2]
    jacobian = np.zeros((rows, size))
    constraints.evaluate(t, q, v, table, value, rate, jacobian, lam)
    matrix = np.empty((rows, rows))
    for r in range(rows):
        # lam holds γ; the right-hand side is Φ_q·M⁻¹·g − γ*.
        total = 2.0 * m[ALPHA] * rate[r] + m[BETA] ** 2 * value[r] - lam[r]
        for k in range(size):
            total += jacobian[r, k] * force[k] / mass[k]
        lam[r] = total
        for s in range(r + 1):
            product = 0.0
            for k in range(size):
                product += jacobian[r, k] * jacobian[s, k] / mass[k]
            matrix[r, s] = product
    _solve_positive(matrix, lam)

    for k in range(size):
        total = force[k]
        for r in range(rows):
            total -= jacobian[r, k] * lam[r]
        out[k] = v[k]
        out[size + k] = total / mass[k]
    power, lost, penetration, normal = rates
    out[2 * size :] = np.array((0.0, power, lost, penetration, normal))
    if m[DRIVER_ROW] < 0:
        return
    i, j = int(m[DRIVER_I]), int(m[DRIVER_J])
    relative = v[3 * j + 2] - (v[3 * i + 2] if i >= 0 else 0.0)
    out[2 * size] = -lam[int(m[DRIVER_ROW])] * relative


@callback(RHS_SIGNATURE)
def rhs(t: float, y: Any, out: Any, data: Any) -> int:
    """CVODE's right-hand side."""
    p = block(data)
    derivatives(t, values(y, p), values(out, p), p)
    return 0


@callback(ROOTS_SIGNATURE)
def roots(t: float, y: Any, out: Any, data: Any) -> int:
    """CVODE's root functions."""
    p = block(data)
    e_x, e_y, u_x, u_y = eccentricity(t, values(y, p), p)
    fill_roots(e_x, e_y, u_x, u_y, carray(out, (EVENTS,)), p)
    return 0
