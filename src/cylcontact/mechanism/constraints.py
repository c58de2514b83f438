"""The kinematic constraints of planar joints, their Jacobian and their acceleration terms.

The coordinates of a body are (x, y, θ) of its centre of mass; the ground is body −1, at rest at the
origin. Each joint is a row of a table,

    kind, i, j, a_x, a_y, b_x, b_y, c, d, cos c, sin c,

with a a point of body i and b a point of body j, both in the body's own axes, and

- a revolute (two constraints): r_i + A_i·a − r_j − A_j·b = 0;
- a prismatic (two): the distance of b from the line through a in the direction c (an angle in
  body i) is 0, and θ_j − θ_i − d = 0;
- a driver (one): θ_j − θ_i − c − d·t = 0.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cylcontact.numba_cache import compiled

__all__ = ["COLUMNS", "CONSTRAINTS", "DRIVER", "PRISMATIC", "REVOLUTE", "evaluate", "point", "turn"]

REVOLUTE, PRISMATIC, DRIVER = 0.0, 1.0, 2.0
COLUMNS = 11
CONSTRAINTS = {REVOLUTE: 2, PRISMATIC: 2, DRIVER: 1}


@compiled
def turn(q: NDArray[np.float64], turns: NDArray[np.float64]) -> None:
    """Write cosine and sine of the angle of every body to `turns`, shape (bodies, 2)."""
    for body in range(turns.shape[0]):
        angle = q[3 * body + 2]
        turns[body, 0], turns[body, 1] = math.cos(angle), math.sin(angle)


@compiled
def point(
    q: NDArray[np.float64],
    v: NDArray[np.float64],
    turns: NDArray[np.float64],
    body: int,
    x: float,
    y: float,
) -> tuple[float, float, float, float, float, float, float]:
    """Return a body's point: arm from the centre, position, velocity (global axes) and spin."""
    if body < 0:
        return x, y, x, y, 0.0, 0.0, 0.0
    k = 3 * body
    c, s = turns[body, 0], turns[body, 1]
    arm_x, arm_y, spin = c * x - s * y, s * x + c * y, v[k + 2]
    return (
        arm_x,
        arm_y,
        q[k] + arm_x,
        q[k + 1] + arm_y,
        v[k] - spin * arm_y,
        v[k + 1] + spin * arm_x,
        spin,
    )


@compiled
def _put(
    jacobian: NDArray[np.float64], row: int, body: int, x: float, y: float, turn: float
) -> None:
    """Write a body's three entries of a row of the Jacobian."""
    if body >= 0:
        k = 3 * body
        jacobian[row, k], jacobian[row, k + 1], jacobian[row, k + 2] = x, y, turn


@compiled
def evaluate(
    t: float,
    q: NDArray[np.float64],
    v: NDArray[np.float64],
    turns: NDArray[np.float64],
    table: NDArray[np.float64],
    value: NDArray[np.float64],
    rate: NDArray[np.float64],
    jacobian: NDArray[np.float64],
    gamma: NDArray[np.float64],
) -> None:
    """Write Φ, dΦ/dt, Φ_q and γ of Φ_q·q̈ = γ (Eq 10).

    `turns` is that of `turn`. `jacobian` must be zero on entry, or that of an earlier call.
    """
    row = 0
    for number in range(table.shape[0]):
        joint = table[number]
        kind, i, j = joint[0], int(joint[1]), int(joint[2])
        if kind == DRIVER:
            angle_i, spin_i = (0.0, 0.0) if i < 0 else (q[3 * i + 2], v[3 * i + 2])
            value[row] = q[3 * j + 2] - angle_i - joint[7] - joint[8] * t
            rate[row] = v[3 * j + 2] - spin_i - joint[8]
            _put(jacobian, row, i, 0.0, 0.0, -1.0)
            _put(jacobian, row, j, 0.0, 0.0, 1.0)
            gamma[row] = 0.0
            row += 1
            continue
        a_x, a_y, i_x, i_y, vi_x, vi_y, spin_i = point(q, v, turns, i, joint[3], joint[4])
        b_x, b_y, j_x, j_y, vj_x, vj_y, spin_j = point(q, v, turns, j, joint[5], joint[6])
        d_x, d_y, u_x, u_y = j_x - i_x, j_y - i_y, vj_x - vi_x, vj_y - vi_y
        # Centripetal part of the relative acceleration of the two points.
        w_x = -spin_j * spin_j * b_x + spin_i * spin_i * a_x
        w_y = -spin_j * spin_j * b_y + spin_i * spin_i * a_y
        if kind == REVOLUTE:
            value[row], value[row + 1] = -d_x, -d_y
            rate[row], rate[row + 1] = -u_x, -u_y
            _put(jacobian, row, i, 1.0, 0.0, -a_y)
            _put(jacobian, row, j, -1.0, 0.0, b_y)
            _put(jacobian, row + 1, i, 0.0, 1.0, a_x)
            _put(jacobian, row + 1, j, 0.0, -1.0, -b_x)
            gamma[row], gamma[row + 1] = w_x, w_y
        else:
            angle_i = 0.0 if i < 0 else q[3 * i + 2]
            c, s = (1.0, 0.0) if i < 0 else (turns[i, 0], turns[i, 1])
            n_x, n_y = -(s * joint[9] + c * joint[10]), c * joint[9] - s * joint[10]
            along = n_y * d_x - n_x * d_y  # of the relative position; ṅ = −ω·(direction)
            value[row] = n_x * d_x + n_y * d_y
            rate[row] = n_x * u_x + n_y * u_y - spin_i * along
            _put(jacobian, row, i, -n_x, -n_y, n_x * a_y - n_y * a_x - along)
            _put(jacobian, row, j, n_x, n_y, n_y * b_x - n_x * b_y)
            gamma[row] = (
                2.0 * spin_i * (n_y * u_x - n_x * u_y)
                + spin_i * spin_i * (n_x * d_x + n_y * d_y)
                - (n_x * w_x + n_y * w_y)
            )
            value[row + 1] = q[3 * j + 2] - angle_i - joint[8]
            rate[row + 1] = spin_j - spin_i
            _put(jacobian, row + 1, i, 0.0, 0.0, -1.0)
            _put(jacobian, row + 1, j, 0.0, 0.0, 1.0)
            gamma[row + 1] = 0.0
        row += 2
