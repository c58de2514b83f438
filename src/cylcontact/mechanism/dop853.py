"""One step of DOP853: Dormand and Prince's Runge–Kutta pair of order 8(5,3), for either model.

The coefficients are those of Hairer, Nørsett and Wanner (Solving Ordinary Differential Equations I,
2nd ed., Springer 1993, Sect. II.10). Only the coordinates and their rates are integrated under
error control; the ledgers feed nothing back and are summed with the weights of the method.

Of a slider-crank `crank` is a record and `linkage` is None, of any other mechanism the reverse;
`pin` is a record if the crank pin has a clearance too. As numba leaves out branches on arguments
that are None, but not on fields, functions with such a branch take them as arguments, and each
model is compiled alone.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import DOP853

from cylcontact.joint.contact import Joint, Motion
from cylcontact.mechanism import linkage as cartesian
from cylcontact.mechanism import slider_crank
from cylcontact.mechanism.slider_crank import Turn
from cylcontact.support.arrays import FloatArray
from cylcontact.support.numba_cache import called, inlined, merged

STAGES = 12
# Stage i is at t + C[i]·h, from the rates of the stages before it weighted by A[i]. The solution is
# the last row; E3 and E5 weight its differences to solutions of the orders 3 and 5.
A = np.vstack((DOP853.A[:STAGES, :STAGES], DOP853.B))
C, E3, E5 = DOP853.C[:STAGES].copy(), DOP853.E3[:STAGES].copy(), DOP853.E5[:STAGES].copy()


class Model(NamedTuple):
    """What is integrated: joints with the numbers of their laws, equations, and room to work in.

    The rows of `rates` are those of coordinates and ledgers at the stages of a step, and, if need
    be, at its end; `stage` is a state.
    """

    joints: Any
    laws: FloatArray
    crank: Any
    pin: Any
    linkage: Any
    rates: FloatArray
    stage: FloatArray


@inlined
def clock(t: float, crank: Any) -> Turn:
    """Return cosine and sine of the crank's angle, which only a slider-crank needs."""
    if crank is not None:
        return slider_crank.crank_turn(t, crank)
    return 1.0, 0.0


@inlined
def later(turn: Turn, dt: float, crank: Any) -> Turn:
    """Return the `clock` a time dt later."""
    if crank is not None:
        return slider_crank.turned(turn[0], turn[1], dt, crank)
    return turn


@inlined
def _evaluate(
    t: float, turn: Turn, y: FloatArray, rates: FloatArray, row: int, joints: Any,
    laws: FloatArray, crank: Any, pin: Any, linkage: Any,
) -> None:  # fmt: skip
    if pin is not None:
        slider_crank.derivatives_of_two(turn, y, rates, row, joints, laws, crank, pin)
    elif crank is not None:
        slider_crank.derivatives(turn, y, rates, row, joints[0], laws, crank)
    if linkage is not None:
        cartesian.derivatives(t, y, rates, row, joints, laws, linkage)


@inlined
def rates_at(t: float, turn: Turn, y: FloatArray, row: int, m: Model) -> None:
    """Write the rates of coordinates and ledgers at a state to a row of `rates`."""
    joints, laws, crank, pin, linkage, rates, _ = m
    _evaluate(t, turn, y, rates, row, joints, laws, crank, pin, linkage)


@inlined
def motion(turn: Turn, y: FloatArray, joint: Joint, crank: Any, pin: Any, linkage: Any) -> Motion:
    """Return the motion of a joint at a state."""
    if crank is not None:
        return slider_crank.joint_motion(turn, y, joint, crank, pin)
    if linkage is not None:
        return cartesian.joint_motion(y, y[y.size // 2 :], joint)
    return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


@called
def step(t: float, h: float, turn: Turn, y: FloatArray, new: FloatArray, m: Model) -> None:
    """Write the state at t + h to `new`, from the state at t and its rates in row 0."""
    for i in range(1, STAGES):
        _combine(i, h, y, m.rates, m.stage, m.crank, m.pin)
        rates_at(t + C[i] * h, later(turn, C[i] * h, m.crank), m.stage, i, m)
    _combine(STAGES, h, y, m.rates, new, m.crank, m.pin)


@inlined
def _combine(
    i: int, h: float, y: FloatArray, k: FloatArray, out: FloatArray, crank: Any, pin: Any
) -> None:
    """Write y + h·Σ a_ij·k_j to `out`."""
    if crank is not None:
        _combine_four(i, h, y, k, out, 0)
        if pin is not None:
            _combine_four(i, h, y, k, out, 4)
        return
    for n in range(y.size):
        total = 0.0
        for j in range(i):
            total += A[i, j] * k[j, n]
        out[n] = y[n] + h * total


@inlined
def _combine_four(i: int, h: float, y: FloatArray, k: FloatArray, out: FloatArray, n: int) -> None:
    """Do so for four coordinates or rates from the n-th on: sums that stay in registers."""
    k0, k1, k2, k3 = 0.0, 0.0, 0.0, 0.0
    for j in range(i):
        a = A[i, j]
        k0 += a * k[j, n]
        k1 += a * k[j, n + 1]
        k2 += a * k[j, n + 2]
        k3 += a * k[j, n + 3]
    out[n], out[n + 1] = y[n] + h * k0, y[n + 1] + h * k1
    out[n + 2], out[n + 3] = y[n + 2] + h * k2, y[n + 3] + h * k3


@merged
def error(
    h: float, y: FloatArray, new: FloatArray, k: FloatArray, relative: float, absolute: FloatArray
) -> float:
    """Return the error of a step relative to the tolerances; the step is good up to 1."""
    third, fifth = 0.0, 0.0
    for n in range(y.size):
        e3, e5 = 0.0, 0.0
        for j in range(STAGES):
            e3 += E3[j] * k[j, n]
            e5 += E5[j] * k[j, n]
        scale = absolute[n] + relative * max(abs(y[n]), abs(new[n]))
        third += (e3 / scale) ** 2
        fifth += (e5 / scale) ** 2
    if fifth == 0.0:
        return 0.0
    return abs(h) * fifth / math.sqrt(y.size * (fifth + 0.01 * third))


@merged
def sum_ledgers(h: float, rest: float, ledgers: FloatArray, rates: FloatArray) -> None:
    """Add what a step contributes to the ledgers, and a very short time after it."""
    first = rates.shape[1] - ledgers.size
    for n in range(ledgers.size):
        total = ledgers[n]
        for j in range(STAGES):
            total += h * A[STAGES, j] * rates[j, first + n]
        ledgers[n] = total + rest * rates[STAGES - 1, first + n]
