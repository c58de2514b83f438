"""The multiplier form: any planar mechanism in Cartesian coordinates (Eq 10).

With a diagonal mass matrix the accelerations follow from the multipliers,

    (Φ_q·M⁻¹·Φ_qᵀ)·λ = Φ_q·M⁻¹·g − γ*,    q̈ = M⁻¹·(g − Φ_qᵀ·λ),

and Baumgarte's stabilisation replaces γ by γ* = γ − 2α·dΦ/dt − β²·Φ. The matrix on the left is
symmetric and positive definite unless constraints are redundant, and is factored as L·D·Lᵀ. A
constraint concerns two bodies at most, and only their columns of Φ_q enter the products.

The state is q, q̇ and the ledgers.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cylcontact.mechanism import constraints, contact
from cylcontact.numba_cache import compiled

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
    "joint_motion",
    "work_size",
]

# Positions in the model's part of the parameter block. The masses follow, their reciprocals, the
# two bodies of every constraint, and the table. A negative row of the driver means that there is
# none.
BODIES, JOINTS, ROWS, DRIVER_ROW, DRIVER_I, DRIVER_J = 0, 1, 2, 3, 4, 5
BODY_I, I_X, I_Y, BODY_J, J_X, J_Y, ALPHA, BETA, GRAVITY_X, GRAVITY_Y = (
    6, 7, 8, 9, 10, 11, 12, 13, 14, 15,
)  # fmt: skip
MODEL_HEADER = 16


@compiled
def work_size(m: NDArray[np.float64]) -> int:
    """Return the size of the work array of `derivatives`."""
    size, rows = 3 * int(m[BODIES]), int(m[ROWS])
    return 2 * size // 3 + size + 2 * rows * size + rows * rows + 3 * rows


@compiled
def joint_motion(
    y: NDArray[np.float64], m: NDArray[np.float64], work: NDArray[np.float64]
) -> tuple[float, float, float, float, float, float]:
    """Return e = r_i − r_j in m, its rate in m/s, and the spins of bearing and journal in rad/s.

    In global axes; `work` is that of `derivatives`.
    """
    size = 3 * int(m[BODIES])
    turns = work[: 2 * size // 3].reshape(size // 3, 2)
    constraints.turn(y, turns)
    q, v = y[:size], y[size:]
    at_i = constraints.point(q, v, turns, int(m[BODY_I]), m[I_X], m[I_Y])
    at_j = constraints.point(q, v, turns, int(m[BODY_J]), m[J_X], m[J_Y])
    e_x, e_y = at_i[2] - at_j[2], at_i[3] - at_j[3]
    return e_x, e_y, at_i[4] - at_j[4], at_i[5] - at_j[5], at_i[6], at_j[6]


@compiled
def _apply(force: NDArray[np.float64], body: int, f_x: float, f_y: float, moment: float) -> None:
    if body >= 0:
        force[3 * body] += f_x
        force[3 * body + 1] += f_y
        force[3 * body + 2] += moment


@compiled
def _solve_positive(matrix: NDArray[np.float64], right: NDArray[np.float64]) -> None:
    """Solve a symmetric positive definite system in place, from its lower triangle."""
    n = right.size
    for k in range(n):
        for i in range(k):
            for l in range(i):  # noqa: E741
                matrix[k, i] -= matrix[k, l] * matrix[i, l]
        # So far row k holds L·D; the diagonal keeps 1/D.
        for i in range(k):
            product = matrix[k, i]
            matrix[k, i] *= matrix[i, i]
            matrix[k, k] -= product * matrix[k, i]
            right[k] -= matrix[k, i] * right[i]
        matrix[k, k] = 1.0 / matrix[k, k]
    for k in range(n - 1, -1, -1):
        right[k] *= matrix[k, k]
        for l in range(k + 1, n):  # noqa: E741
            right[k] -= matrix[l, k] * right[l]


@compiled
def contact_on_bodies(
    q: NDArray[np.float64],
    v: NDArray[np.float64],
    turns: NDArray[np.float64],
    force: NDArray[np.float64],
    p: NDArray[np.float64],
    law: NDArray[np.float64],
    m: NDArray[np.float64],
) -> tuple[float, float, float, float]:
    """Add the contact forces of Eq 13 to `force`; return the rates of the ledgers.

    These are the powers that the normal and the friction force dissipate in W, the penetration
    in m and the normal force in N.
    """
    i, j = int(m[BODY_I]), int(m[BODY_J])
    ai_x, ai_y, i_x, i_y, vi_x, vi_y, spin_i = constraints.point(q, v, turns, i, m[I_X], m[I_Y])
    aj_x, aj_y, j_x, j_y, vj_x, vj_y, spin_j = constraints.point(q, v, turns, j, m[J_X], m[J_Y])
    f_x, f_y, moment_i, moment_j, normal, normal_power, friction_power, delta = contact.forces(
        i_x - j_x,
        i_y - j_y,
        vi_x - vj_x,
        vi_y - vj_y,
        spin_i,
        spin_j,
        p[contact.IMPACT_RATE],
        p,
        law,
    )
    _apply(force, i, f_x, f_y, ai_x * f_y - ai_y * f_x + moment_i)
    _apply(force, j, -f_x, -f_y, -(aj_x * f_y - aj_y * f_x) + moment_j)
    return normal_power, friction_power, delta, normal


@compiled
def _schur(
    jacobian: NDArray[np.float64],
    over_mass: NDArray[np.float64],
    mobility: NDArray[np.float64],
    force: NDArray[np.float64],
    bodies: NDArray[np.float64],
    matrix: NDArray[np.float64],
    right: NDArray[np.float64],
) -> None:
    """Write the lower triangle of Φ_q·M⁻¹·Φ_qᵀ to `matrix` and add Φ_q·M⁻¹·g to `right`."""
    for row in range(right.size):
        for s in range(row + 1):
            matrix[row, s] = 0.0
        for end in range(2):
            body = int(bodies[2 * row + end])
            if body < 0:
                continue
            for k in range(3 * body, 3 * body + 3):
                weighted = jacobian[row, k] * mobility[k]
                over_mass[row, k] = weighted
                right[row] += weighted * force[k]
                for s in range(row + 1):
                    matrix[row, s] += weighted * jacobian[s, k]


@compiled
def derivatives(
    t: float,
    y: NDArray[np.float64],
    rates: NDArray[np.float64],
    row: int,
    p: NDArray[np.float64],
    law: NDArray[np.float64],
    m: NDArray[np.float64],
    work: NDArray[np.float64],
) -> None:
    """Write the rates of coordinates and ledgers to a row of `rates`.

    p, law and m are the parameter block and its parts of the law and of the model. `work` is an
    array of `work_size` to work in; it must be zero at first.
    """
    size, joints, rows = 3 * int(m[BODIES]), int(m[JOINTS]), int(m[ROWS])
    q, v = y[:size], y[size:]
    mass, mobility = m[MODEL_HEADER:], m[MODEL_HEADER + size :]
    bodies, first = mobility[size:], MODEL_HEADER + 2 * (size + rows)
    table = m[first : first + joints * constraints.COLUMNS].reshape(joints, constraints.COLUMNS)
    turns, work = work[: 2 * size // 3].reshape(size // 3, 2), work[2 * size // 3 :]
    force, rest = work[:size], work[size:]
    jacobian = rest[: rows * size].reshape(rows, size)
    over_mass = rest[rows * size : 2 * rows * size].reshape(rows, size)
    rest = rest[2 * rows * size :]
    matrix, rest = rest[: rows * rows].reshape(rows, rows), rest[rows * rows :]
    value, rate, lam = rest[:rows], rest[rows : 2 * rows], rest[2 * rows :]

    constraints.turn(q, turns)
    for n in range(0, size, 3):
        force[n], force[n + 1], force[n + 2] = (
            mass[n] * m[GRAVITY_X], mass[n] * m[GRAVITY_Y], 0.0,
        )  # fmt: skip
    lost, rubbed, delta, normal = 0.0, 0.0, 0.0, 0.0
    if p[contact.MODE] == contact.CONTACT:
        lost, rubbed, delta, normal = contact_on_bodies(q, v, turns, force, p, law, m)

    constraints.evaluate(t, q, v, turns, table, value, rate, jacobian, lam)
    for r in range(rows):
        # lam holds γ; the right-hand side is Φ_q·M⁻¹·g − γ*.
        lam[r] = 2.0 * m[ALPHA] * rate[r] + m[BETA] ** 2 * value[r] - lam[r]
    _schur(jacobian, over_mass, mobility, force, bodies, matrix, lam)
    _solve_positive(matrix, lam)

    for n in range(size):
        rates[row, n], rates[row, size + n] = v[n], force[n] * mobility[n]
    for r in range(rows):
        for end in range(2):
            body = int(bodies[2 * r + end])
            if body < 0:
                continue
            for n in range(3 * body, 3 * body + 3):
                rates[row, size + n] -= over_mass[r, n] * lam[r]
    power = 0.0
    if m[DRIVER_ROW] >= 0:
        i, j = int(m[DRIVER_I]), int(m[DRIVER_J])
        relative = v[3 * j + 2] - (v[3 * i + 2] if i >= 0 else 0.0)
        power = -lam[int(m[DRIVER_ROW])] * relative
    first = 2 * size
    rates[row, first], rates[row, first + 1], rates[row, first + 2] = power, lost, rubbed
    rates[row, first + 3], rates[row, first + 4] = delta, normal
