"""One step of DOP853: Dormand and Prince's Runge–Kutta pair of order 8(5,3), for either model.

The coefficients are those of Hairer, Nørsett and Wanner (Solving Ordinary Differential Equations I,
2nd ed., Springer 1993, Sect. II.10). Only the coordinates and their rates are integrated under
error control; the ledgers feed nothing back and are summed with the weights of the method.
"""

from __future__ import annotations

import math

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.mechanism import augmented
from cylcontact.mechanism import minimal_coordinates as minimal
from cylcontact.mechanism.step_history import LEDGERS
from cylcontact.numba_cache import compiled, inlined

__all__ = [
    "AUGMENTED",
    "MINIMAL",
    "STAGES",
    "Blocks",
    "Workspace",
    "crank",
    "error",
    "evaluate",
    "motion",
    "step",
    "sum_ledgers",
    "turned",
    "workspace",
]

MINIMAL, AUGMENTED = 0, 1

# The parameter block and its parts of the law and of the model.
Blocks = tuple[FloatArray, FloatArray, FloatArray]
# The rates of coordinates and ledgers by stage, shape (STAGES + 1, n), with a row to spare; a
# stage; an array for the multiplier form to work in.
Workspace = tuple[FloatArray, FloatArray, FloatArray]

STAGES = 12

# Stage i is at t + C[i]·h, from the rates of the stages before it weighted by A[i].
_A = np.zeros((STAGES + 1, STAGES))
_A[1, 0] = 0.05260015195876773
_A[2, [0, 1]] = [0.0197250569845379, 0.0591751709536137]
_A[3, [0, 2]] = [0.02958758547680685, 0.08876275643042054]
_A[4, [0, 2, 3]] = [0.2413651341592667, -0.8845494793282861, 0.924834003261792]
_A[5, [0, 3, 4]] = [0.037037037037037035, 0.17082860872947386, 0.12546768756682242]
_A[6, [0, 3, 4, 5]] = [0.037109375, 0.17025221101954405, 0.06021653898045596, -0.017578125]
_A[7, [0, 3, 4, 5, 6]] = [
    0.03709200011850479,
    0.17038392571223998,
    0.10726203044637328,
    -0.015319437748624402,
    0.008273789163814023,
]
_A[8, [0, 3, 4, 5, 6, 7]] = [
    0.6241109587160757,
    -3.3608926294469414,
    -0.868219346841726,
    27.59209969944671,
    20.154067550477894,
    -43.48988418106996,
]
_A[9, [0, 3, 4, 5, 6, 7, 8]] = [
    0.47766253643826434,
    -2.4881146199716677,
    -0.590290826836843,
    21.230051448181193,
    15.279233632882423,
    -33.28821096898486,
    -0.020331201708508627,
]
_A[10, [0, 3, 4, 5, 6, 7, 8, 9]] = [
    -0.9371424300859873,
    5.186372428844064,
    1.0914373489967295,
    -8.149787010746927,
    -18.52006565999696,
    22.739487099350505,
    2.4936055526796523,
    -3.0467644718982196,
]
_A[11, [0, 3, 4, 5, 6, 7, 8, 9, 10]] = [
    2.273310147516538,
    -10.53449546673725,
    -2.0008720582248625,
    -17.9589318631188,
    27.94888452941996,
    -2.8589982771350235,
    -8.87285693353063,
    12.360567175794303,
    0.6433927460157636,
]
_C = np.array(
    [
        0.0,
        0.05260015195876773,
        0.0789002279381516,
        0.1183503419072274,
        0.2816496580927726,
        0.3333333333333333,
        0.25,
        0.3076923076923077,
        0.6512820512820513,
        0.6,
        0.8571428571428571,
        1.0,
    ]
)
# The solution is the last row, with zero weights for stages 1 to 4.
_A[STAGES, :] = [
    0.054293734116568765,
    0.0,
    0.0,
    0.0,
    0.0,
    4.450312892752409,
    1.8915178993145003,
    -5.801203960010585,
    0.3111643669578199,
    -0.1521609496625161,
    0.20136540080403034,
    0.04471061572777259,
]
# The weights of its differences to solutions of the orders 3 and 5.
_E3 = np.array(
    [
        -0.18980075407240762,
        0.0,
        0.0,
        0.0,
        0.0,
        4.450312892752409,
        1.8915178993145003,
        -5.801203960010585,
        -0.4226823213237919,
        -0.1521609496625161,
        0.20136540080403034,
        0.02265179219836082,
    ]
)
_E5 = np.array(
    [
        0.01312004499419488,
        0.0,
        0.0,
        0.0,
        0.0,
        -1.2251564463762044,
        -0.4957589496572502,
        1.6643771824549864,
        -0.35032884874997366,
        0.3341791187130175,
        0.08192320648511571,
        -0.022355307863886294,
    ]
)
_LEDGERS = len(LEDGERS)

# Of Taylor's series.
_COS = (-1 / 2, 1 / 24, -1 / 720, 1 / 40320)
_SIN = (-1 / 6, 1 / 120, -1 / 5040, 1 / 362880)


@compiled
def workspace(model: int, size: int, m: FloatArray) -> Workspace:
    """Return arrays to work in, for `size` coordinates and rates."""
    work = augmented.work_size(m) if model == AUGMENTED else 0
    return np.zeros((STAGES + 1, size + _LEDGERS)), np.zeros(size), np.zeros(work)


@compiled
def crank(model: int, t: float, m: FloatArray) -> tuple[float, float]:
    """Return cosine and sine of the crank's angle, which minimal coordinates need."""
    if model == AUGMENTED:
        return 1.0, 0.0
    theta = m[minimal.ANGLE] + m[minimal.OMEGA] * t
    return math.cos(theta), math.sin(theta)


@inlined
def turned(model: int, c: float, s: float, dt: float, m: FloatArray) -> tuple[float, float]:
    """Return the cosine and sine of `crank` a time dt later."""
    if model == AUGMENTED:
        return c, s
    angle = m[minimal.OMEGA] * dt
    if abs(angle) > 0.1:
        x, y = math.cos(angle), math.sin(angle)
    else:  # Taylor's series to the last digit, without divisions
        z = angle * angle
        x = 1.0 + z * (_COS[0] + z * (_COS[1] + z * (_COS[2] + z * _COS[3])))
        y = angle * (1.0 + z * (_SIN[0] + z * (_SIN[1] + z * (_SIN[2] + z * _SIN[3]))))
    return c * x - s * y, s * x + c * y


@compiled
def evaluate(
    model: int,
    t: float,
    c: float,
    s: float,
    y: FloatArray,
    row: int,
    blocks: Blocks,
    space: Workspace,
) -> None:
    """Write the rates at a state to a row of the workspace."""
    p, law, m = blocks
    rates, _, work = space
    _evaluate(model, t, c, s, y, row, p, law, m, rates, work)


@inlined
def _evaluate(
    model: int,
    t: float,
    c: float,
    s: float,
    y: FloatArray,
    row: int,
    p: FloatArray,
    law: FloatArray,
    m: FloatArray,
    rates: FloatArray,
    work: FloatArray,
) -> None:
    """Write the rates at a state to a row; the arrays are one by one because tuples are slow."""
    if model == MINIMAL:
        minimal.derivatives(c, s, y, rates, row, p, law, m)
    else:
        augmented.derivatives(t, y, rates, row, p, law, m, work)


@inlined
def motion(
    model: int, c: float, s: float, y: FloatArray, m: FloatArray, work: FloatArray
) -> tuple[float, float, float, float, float, float]:
    """Return e in m, its rate in m/s, and the spins of bearing and journal in rad/s at a state."""
    if model == MINIMAL:
        return minimal.joint_motion(c, s, y, m)
    return augmented.joint_motion(y, m, work)


@compiled
def step(
    model: int,
    t: float,
    h: float,
    c: float,
    s: float,
    y: FloatArray,
    new: FloatArray,
    blocks: Blocks,
    space: Workspace,
) -> None:
    """Write the state at t + h to `new`, from the state at t and its rates in row 0."""
    p, law, m = blocks
    rates, stage, work = space
    for i in range(1, STAGES):
        _combine(i, h, y, rates, stage)
        c_i, s_i = turned(model, c, s, _C[i] * h, m)
        _evaluate(model, t + _C[i] * h, c_i, s_i, stage, i, p, law, m, rates, work)
    _combine(STAGES, h, y, rates, new)


@inlined
def _combine(i: int, h: float, y: FloatArray, k: FloatArray, out: FloatArray) -> None:
    """Write y + h·Σ a_ij·k_j to `out`."""
    if y.size == 4:  # minimal coordinates: sums that stay in registers
        k0, k1, k2, k3 = 0.0, 0.0, 0.0, 0.0
        for j in range(i):
            a = _A[i, j]
            k0 += a * k[j, 0]
            k1 += a * k[j, 1]
            k2 += a * k[j, 2]
            k3 += a * k[j, 3]
        out[0], out[1], out[2], out[3] = y[0] + h * k0, y[1] + h * k1, y[2] + h * k2, y[3] + h * k3
        return
    for n in range(y.size):
        total = 0.0
        for j in range(i):
            total += _A[i, j] * k[j, n]
        out[n] = y[n] + h * total


@inlined
def error(
    h: float, y: FloatArray, new: FloatArray, k: FloatArray, relative: float, absolute: FloatArray
) -> float:
    """Return the error of a step relative to the tolerances; the step is good up to 1."""
    third, fifth = 0.0, 0.0
    for n in range(y.size):
        e3, e5 = 0.0, 0.0
        for j in range(STAGES):
            e3 += _E3[j] * k[j, n]
            e5 += _E5[j] * k[j, n]
        scale = absolute[n] + relative * max(abs(y[n]), abs(new[n]))
        third += (e3 / scale) ** 2
        fifth += (e5 / scale) ** 2
    if fifth == 0.0:
        return 0.0
    return abs(h) * fifth / math.sqrt(y.size * (fifth + 0.01 * third))


@inlined
def sum_ledgers(h: float, rest: float, ledgers: FloatArray, rates: FloatArray) -> None:
    """Add what a step contributes to the ledgers, and a very short time after it."""
    first = rates.shape[1] - _LEDGERS
    for n in range(_LEDGERS):
        for j in range(STAGES):
            ledgers[n] += h * _A[STAGES, j] * rates[j, first + n]
        ledgers[n] += rest * rates[STAGES - 1, first + n]
