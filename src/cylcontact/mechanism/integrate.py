"""The compiled time loop: steps of DOP853 in pieces in which the force is smooth.

The force has kinks: at the onset and the release of contact, at the four speeds where friction
bends (Eq 15), and where the tangent continues a law. Between them the loop holds the force in its
present piece, if need be beyond its end. A step that has passed an end is an event: it is repeated,
shorter, until it ends there, and then the piece changes. States at events are results of steps,
never of interpolation, which would lose energy at every impact.

A root finder that compares signs at the ends of a step can overlook a shallow contact or a short
release. Therefore a step in which δ turns is looked at more closely, and a step in flight moves the
pin by no more than a part of its clearance.

DOP853 is Dormand and Prince's Runge–Kutta pair of order 8(5,3), with SciPy's coefficients (Hairer,
Nørsett and Wanner, Solving Ordinary Differential Equations I, Sect. II.10). The ledgers feed
nothing back and are summed with its weights, without error control.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import DOP853

from cylcontact.joint import contact
from cylcontact.joint.contact import Joint
from cylcontact.mechanism.slider_crank import (
    COORDINATES,
    Crank,
    Turn,
    crank_turn,
    derivatives,
    joint_motion,
    later,
)
from cylcontact.support.arrays import BoolArray, FloatArray
from cylcontact.support.numba_cache import called, compiled, inlined, merged

STAGES = 12
# Stage i is at t + C[i]·h, from the rates of the stages before it weighted by A[i]. The solution is
# the last row; E3 and E5 weight its differences to solutions of the orders 3 and 5.
A = np.vstack((DOP853.A[:STAGES, :STAGES], DOP853.B))
C, E3, E5 = DOP853.C[:STAGES].copy(), DOP853.E3[:STAGES].copy(), DOP853.E5[:STAGES].copy()

# Where a run is: time in s, the next step in s (0 at a start), the error of the last one,
# evaluations so far, and how many steps have ended at the kink that they start from.
Now = Any
NOW = np.dtype(
    [
        *((name, np.float64) for name in ("time", "step", "error")),
        *((name, np.int64) for name in ("evaluations", "stuck")),
    ]
)
# Why `integrate` returns: the end is reached, the buffers are full, the law ends, no step is small
# enough, the pin has left its hole.
END, FULL, LAW_LEFT, COLLAPSED, HOLE_LEFT = 0, 1, 2, 3, 4
# What a step may meet.
_NOTHING, _TOUCH, _SLOWER, _FASTER, _LAW = 0, 1, 2, 3, 4
_RETRY = -1

# Steps in s: the first one after a start, the first one in flight, and the shortest before an event
# that the state stands at already is taken as passed.
_FIRST, _FIRST_IN_FLIGHT, _SHORTEST = 1e-9, 1e-6, 1e-10
# Depth in m that the first step of a contact reaches, and above which δⁿ is smooth enough.
_SHALLOW = 2e-9
# How close in s a step must end at an onset or release, or at a kink.
_AT_TOUCH, _AT_KINK = 1e-10, 2e-11
# Time in s over which the slope of a margin is taken.
_AT_SLOPE = 1e-9
_ATTEMPTS = 60
# How many steps in a row may end at the kink that they start from. Up to 41 have been seen to go on
# by themselves, mostly 1.
_MOST_STUCK = 64
# The controller of Hairer and Wanner's code, with less stabilisation and more growth.
_SAFETY, _BETA, _SHRINK, _GROW = 0.9, 0.04, 1 / 3, 8.0


class Model(NamedTuple):
    """What is integrated, and work arrays: the rates at the stages of a step, and a state."""

    joint: Any
    law: FloatArray
    crank: Any
    rates: FloatArray
    stage: FloatArray


class Gap(NamedTuple):
    """The gap of the joint: δ in m, δ̇ and v_t in m/s, and the two components of ė in m/s."""

    delta: float
    rate: float
    v_t: float
    u_x: float
    u_y: float


class Start(NamedTuple):
    """The start of a step: time in s, the crank's angle, the state, and the gap."""

    time: float
    turn: Turn
    y: FloatArray
    gap: Gap


# --- a step -------------------------------------------------------------------------------------


@inlined
def _rates_at(turn: Turn, y: FloatArray, row: int, m: Model) -> None:
    """Write the rates of coordinates and ledgers at a state to a row of `rates`."""
    derivatives(turn, y, m.rates[row], m.joint, m.law, m.crank)


@called
def _step(h: float, at: Start, new: FloatArray, m: Model) -> None:
    """Write the state after a step to `new`, from that at its start and its rates in row 0."""
    for i in range(1, STAGES):
        _combine(i, h, at.y, m.rates, m.stage)
        _rates_at(later(at.turn, C[i] * h, m.crank), m.stage, i, m)
    _combine(STAGES, h, at.y, m.rates, new)


@inlined
def _combine(i: int, h: float, y: FloatArray, k: FloatArray, out: FloatArray) -> None:
    """Write y + h·Σ a_ij·k_j to `out`: four sums that stay in registers."""
    k0, k1, k2, k3 = 0.0, 0.0, 0.0, 0.0
    for j in range(i):
        a = A[i, j]
        k0 += a * k[j, 0]
        k1 += a * k[j, 1]
        k2 += a * k[j, 2]
        k3 += a * k[j, 3]
    out[0], out[1], out[2], out[3] = y[0] + h * k0, y[1] + h * k1, y[2] + h * k2, y[3] + h * k3


@merged
def _error(
    h: float, y: FloatArray, new: FloatArray, k: FloatArray, relative: float, absolute: FloatArray
) -> float:
    """Return the error of a step relative to the tolerances; the step is good up to 1."""
    third, fifth = 0.0, 0.0
    for n in range(COORDINATES):
        e3, e5 = 0.0, 0.0
        for j in range(STAGES):
            e3 += E3[j] * k[j, n]
            e5 += E5[j] * k[j, n]
        scale = absolute[n] + relative * max(abs(y[n]), abs(new[n]))
        third += (e3 / scale) ** 2
        fifth += (e5 / scale) ** 2
    if fifth == 0.0:
        return 0.0
    return abs(h) * fifth / math.sqrt(COORDINATES * (fifth + 0.01 * third))


@merged
def _sum_ledgers(h: float, rest: float, ledgers: FloatArray, rates: FloatArray) -> None:
    """Add what a step contributes to the ledgers, and a very short time after it."""
    for n in range(ledgers.size):
        total = ledgers[n]
        for j in range(STAGES):
            total += h * A[STAGES, j] * rates[j, COORDINATES + n]
        ledgers[n] = total + rest * rates[STAGES - 1, COORDINATES + n]


@called
def _shift(dt: float, y: FloatArray, rates: FloatArray) -> None:
    """Move a state by a very short time, with the rates of the last stage."""
    for n in range(2):
        y[n] += dt * (y[2 + n] + 0.5 * dt * rates[STAGES - 1, 2 + n])
        y[2 + n] += dt * rates[STAGES - 1, 2 + n]


# --- pieces and their ends ----------------------------------------------------------------------


@called
def _gap_at(turn: Turn, y: FloatArray, joint: Joint, m: Crank) -> Gap:
    """Return the gap of the joint at a state."""
    e = joint_motion(turn, y, m)
    distance = math.sqrt(e.e_x * e.e_x + e.e_y * e.e_y)
    delta = distance - joint.clearance
    if distance == 0.0:
        return Gap(delta, 0.0, 0.0, e.u_x, e.u_y)
    n_x, n_y = e.e_x / distance, e.e_y / distance
    sliding = e.omega_i * joint.R_bearing - e.omega_j * (joint.R_pin - delta)
    rate, v_t = e.u_x * n_x + e.u_y * n_y, e.u_x * n_y - e.u_y * n_x + sliding
    return Gap(delta, rate, v_t, e.u_x, e.u_y)


@inlined
def _choose_pieces(gap: Gap, joint: Joint) -> None:
    """Set the branch of friction and the regime of the law by the state."""
    speed = abs(gap.v_t)
    branch = 0 if speed <= joint.v0 else (1 if speed <= joint.v1 else 2)
    joint.branch = 0 if joint.friction == 0.0 else (branch if gap.v_t >= 0.0 else -branch)
    if joint.last_penetration < math.inf and joint.stop_penetration == math.inf:
        beyond = gap.delta * 1e3 > joint.last_penetration
        joint.regime = contact.LINE if beyond else contact.LAW


@inlined
def _bounds(joint: Joint) -> tuple[float, float]:
    """Return the tangential velocities between which the branch of friction holds."""
    if joint.friction == 0.0:
        return -math.inf, math.inf
    if joint.branch == 0:
        return -joint.v0, joint.v0
    inner, outer = (joint.v0, joint.v1) if abs(joint.branch) == 1 else (joint.v1, math.inf)
    return (inner, outer) if joint.branch > 0 else (-outer, -inner)


@inlined
def _margin(kind: int, gap: Gap, joint: Joint) -> float:
    """Return how far a state is inside the present piece; negative outside."""
    if kind == _TOUCH:
        return gap.delta if joint.touching else -gap.delta
    if kind in (_SLOWER, _FASTER):
        low, high = _bounds(joint)
        return gap.v_t - low if kind == _SLOWER else high - gap.v_t
    if joint.stop_penetration < math.inf:
        return float(joint.stop_penetration - gap.delta)
    inside = float(joint.last_penetration * 1e-3 - gap.delta)
    return -inside if joint.regime == contact.LINE else inside


@called
def _first_event(start: Gap, end: Gap, joint: Joint) -> tuple[int, bool]:
    """Return what a step has passed first, and whether its start was inside."""
    event, starts_inside, earliest = _NOTHING, True, 2.0
    for kind in range(_TOUCH, (_LAW if joint.touching else _TOUCH) + 1):
        after = _margin(kind, end, joint)
        if after < 0.0:
            before = _margin(kind, start, joint)
            fraction = before / (before - after) if before > 0.0 else 0.0
            if fraction < earliest:
                event, starts_inside, earliest = kind, before > 0.0, fraction
    return event, starts_inside


@called
def _switch(kind: int, gap: Gap, now: Now, joint: Joint) -> None:
    """Change to the piece beyond an event, and set the first step there."""
    if kind in (_SLOWER, _FASTER):
        joint.branch += 1 if kind == _FASTER else -1
    elif kind == _LAW:
        joint.regime = contact.LINE if joint.regime == contact.LAW else contact.LAW
    elif joint.touching:
        joint.touching, joint.onset_rate = 0, 0.0
        now.step = _FIRST_IN_FLIGHT
    else:
        joint.touching, joint.onset_rate = 1, gap.rate
        joint.impact_rate = max(gap.rate, joint.rate_floor)
        _choose_pieces(gap, joint)
        now.step = min(_SHALLOW / max(gap.rate, 1e-3 * joint.rate_floor), 1e-7)


# --- landing on an end --------------------------------------------------------------------------


@merged
def _interpolate(
    x: float, h: float, y: FloatArray, new: FloatArray, rates: FloatArray, out: FloatArray
) -> None:
    """Write the state at a fraction x of a step, by Hermite's quintic from first and last rates."""
    last = rates.shape[0] - 1
    for n in range(2):
        d, v = new[n] - y[n], h * y[2 + n]
        w, a, b = h * new[2 + n], h * h * rates[0, 2 + n], h * h * rates[last, 2 + n]
        c3 = 10 * d - 6 * v - 4 * w - 1.5 * a + 0.5 * b
        c4 = -15 * d + 8 * v + 7 * w + 1.5 * a - b
        c5 = 6 * d - 3 * (v + w) - 0.5 * (a - b)
        out[n] = y[n] + x * (v + x * (0.5 * a + x * (c3 + x * (c4 + x * c5))))
        out[2 + n] = (v + x * (a + x * (3 * c3 + x * (4 * c4 + x * 5 * c5)))) / h


@merged
def _guess(
    kind: int, h: float, margins: tuple[float, float], at: Start, new: FloatArray, m: Model
) -> float:
    """Return about when an event occurs within a step, from margins at its ends."""
    _rates_at(later(at.turn, h, m.crank), new, STAGES, m)
    low, high, last = 0.0, 1.0, 2.0
    g_low, g_high = margins
    x = 0.5
    for _ in range(_ATTEMPTS):  # regula falsi, Illinois' variant
        x = (low * g_high - high * g_low) / (g_high - g_low)
        if abs(x - last) * h < 0.1 * _AT_KINK:
            break
        _interpolate(x, h, at.y, new, m.rates, m.stage)
        gap = _gap_at(later(at.turn, x * h, m.crank), m.stage, m.joint, m.crank)
        g = _margin(kind, gap, m.joint)
        if g > 0.0:
            g_high *= 0.5 if low == last else 1.0
            low, g_low = x, g
        else:
            g_low *= 0.5 if high == last else 1.0
            high, g_high = x, g
        last = x
    return x * h


@called
def _land(
    kind: int, h: float, at: Start, after: Gap, new: FloatArray, m: Model, now: Now
) -> tuple[float, float]:
    """Repeat a step until it ends at an event, as close as a shift by a very short time.

    `new` is the state at its end, which is updated. Returned are the length of the step and the
    time from its end to the event, in s; a length of 0 if the step ends at the kink that it starts
    from, as too many before.
    """
    joint, tolerance = m.joint, _AT_TOUCH if kind == _TOUCH else _AT_KINK
    x = _guess(kind, h, (_margin(kind, at.gap, joint), _margin(kind, after, joint)), at, new, m)
    now.evaluations += 1
    low, high = 0.0, h
    for _ in range(_ATTEMPTS):
        _step(x, at, new, m)
        now.evaluations += STAGES - 1
        turn = later(at.turn, x, m.crank)
        g = _margin(kind, _gap_at(turn, new, joint, m.crank), joint)
        if g > 0.0:
            low = x
        else:
            high = x
        for n in range(COORDINATES):
            m.stage[n] = new[n]
        _shift(_AT_SLOPE, m.stage, m.rates)
        gap = _gap_at(later(turn, _AT_SLOPE, m.crank), m.stage, joint, m.crank)
        rise = _margin(kind, gap, joint) - g
        correction = -g / rise * _AT_SLOPE if rise != 0.0 else math.inf
        if abs(correction) < tolerance or high - low < tolerance:
            if x >= tolerance:
                now.stuck = 0
            elif kind != _TOUCH and rise > 0.0:
                now.stuck += 1
                if now.stuck > _MOST_STUCK:
                    return 0.0, 0.0
            return x, min(max(correction, -tolerance), tolerance)
        x += correction
        if not low < x < high:
            x = 0.5 * (low + high)
    return x, 0.0


@called
def _turning(h: float, start: Gap, end: Gap) -> tuple[float, float]:
    """Return the fraction of a step at which δ turns, and δ there, by Hermite's cubic."""
    a, b, c = h * start.rate, end.delta - start.delta, h * end.rate
    cubic, square = a + c - 2 * b, 3 * b - 2 * a - c
    low, high = 0.0, 1.0
    for _ in range(40):
        x = 0.5 * (low + high)
        if ((3 * cubic * x + 2 * square) * x + a) * a > 0:
            low = x
        else:
            high = x
    return low, start.delta + low * (a + low * (square + low * cubic))


@merged
def _turn(h: float, start: Gap, end: Gap, joint: Joint) -> tuple[float, bool]:
    """Return where a step should end as δ turns in it, and whether it missed an event."""
    if start.rate * end.rate >= 0.0:
        return h, False
    at, depth = _turning(h, start, end)
    touching = joint.touching != 0
    overlooked = (depth < 0.0) == touching
    deepest = touching and start.rate > 0.0
    if 0.05 < at < 0.95 and (overlooked or deepest):
        return at * h, overlooked
    return h, False


@merged
def _examine(h: float, at: Start, new: FloatArray, m: Model, now: Now) -> tuple[int, float, float]:
    """Find the first event in a step, and end the step there.

    `new` is the state at its end, which is updated. Returned are what is at the end (`_RETRY` if
    the step must be repeated with the step in `now`), its length, and the time from its end to the
    event, in s.
    """
    after = _gap_at(later(at.turn, h, m.crank), new, m.joint, m.crank)
    event, starts_inside = _first_event(at.gap, after, m.joint)
    if event == _NOTHING:
        length, missed = _turn(h, at.gap, after, m.joint)
        if missed:
            now.step = length
            return _RETRY, length, 0.0
        if length < h:
            _step(length, at, new, m)
            now.evaluations += STAGES - 1
        return _NOTHING, length, 0.0
    if not starts_inside:
        now.step = 0.25 * h
        return (_RETRY if h > _SHORTEST else event), h, 0.0
    length, rest = _land(event, h, at, after, new, m, now)
    if length == 0.0:
        # The state has just passed a kink, and turns within the step to pass it again. Ended at its
        # start, such steps change between the two pieces without end.
        now.step = 0.5 * h
        return _RETRY, h, 0.0
    return event, length, rest


# --- the loop -----------------------------------------------------------------------------------


@merged
def _length(
    now: Now, gap: Gap, acceleration: float, end: float, max_step: float, joint: Joint
) -> float:
    """Return the next step in s, bounded towards a release, in flight, and by the end."""
    h = min(now.step, max_step)
    if joint.touching:
        if gap.rate < 0.0 and gap.delta > _SHALLOW:
            h = min(h, 0.85 * gap.delta / -gap.rate)
    else:
        speed = math.sqrt(gap.u_x * gap.u_x + gap.u_y * gap.u_y)
        if speed > 0.0:
            h = min(h, joint.clearance / (2.0 * speed))
        if acceleration > 0.0:
            h = min(h, 0.5 * math.sqrt(joint.clearance / acceleration))
    return float(end - now.time if now.time + h * (1.0 + 1e-9) >= end else h)


@called
def _good_step(
    now: Now,
    at: Start,
    new: FloatArray,
    acceleration: float,
    end: float,
    tolerances: tuple[float, FloatArray, float],
    m: Model,
) -> tuple[int, float, float]:
    """Repeat a step, shorter, until it is within the tolerances and ends at the first event in it.

    Written are the state at its end, the time there, and the next step. Returned are what
    `_examine` does; a length of 0 if no step is small enough.
    """
    relative, absolute, max_step = tolerances
    t, grow = at.time, _GROW
    while True:
        wanted = min(now.step, max_step)
        h = _length(now, at.gap, acceleration, end, max_step, m.joint)
        if not t + h > t:
            return _NOTHING, 0.0, 0.0
        _step(h, at, new, m)
        now.evaluations += STAGES - 1
        measure = _error(h, at.y, new, m.rates, relative, absolute)
        if not measure <= 1.0:
            shrink = _SAFETY * measure**-0.125 if measure < math.inf else 0.0
            now.step, grow = h * max(shrink, _SHRINK), 1.0
            continue
        event, length, rest = _examine(h, at, new, m, now)
        if event == _RETRY:
            continue
        now.time = end if length == h and t + h * (1.0 + 1e-9) >= end else t + (length + rest)
        if event == _NOTHING:
            factor = _SAFETY * now.error**_BETA / max(measure, 1e-10) ** (0.125 - 0.2 * _BETA)
            now.step, now.error = length * min(max(factor, _SHRINK), grow), max(measure, 1e-4)
        else:
            now.step, now.error = wanted, 1e-4
        return event, length, rest


@called
def _record(
    row: int,
    now: Now,
    y: FloatArray,
    ledgers: FloatArray,
    joint: Joint,
    buffers: tuple[FloatArray, FloatArray, BoolArray, FloatArray],
) -> int:
    """Write a row and return the number of the next."""
    times, states, touching, onset_rates = buffers
    times[row] = now.time
    for n in range(COORDINATES):
        states[row, n] = y[n]
    for n in range(ledgers.size):
        states[row, COORDINATES + n] = ledgers[n]
    touching[row], onset_rates[row] = joint.touching != 0, joint.onset_rate
    return row + 1


@compiled
def integrate(
    now: Now,
    y: FloatArray,
    ledgers: FloatArray,
    end: float,
    m: Model,
    tolerances: tuple[float, FloatArray, float],
    new: FloatArray,
    buffers: tuple[FloatArray, FloatArray, BoolArray, FloatArray],
) -> tuple[int, int]:
    """Integrate until the time `end`, or until something else stops it.

    `now`, the state `y`, its ledgers and the joint are those of the start, and are advanced.
    `tolerances` are the relative and the absolute one, and the longest step in s; `new` is a work
    array for a state. Time, state with ledgers, contact and δ̇⁽⁻⁾ after each step are written to
    `buffers`; an onset and a release have two rows, one in each mode. Returned are the rows filled,
    and why it returns.
    """
    joint, turn, acceleration, rows = m.joint, crank_turn(now.time, m.crank), 0.0, 0
    gap = _gap_at(turn, y, joint, m.crank)
    joint.impact_rate = max(joint.onset_rate, joint.rate_floor)
    _choose_pieces(gap, joint)
    if now.step == 0.0:
        now.step, now.error = _FIRST, 1e-4
    while now.time < end:
        if rows + 2 > buffers[0].size:
            return rows, FULL
        _rates_at(turn, y, 0, m)
        now.evaluations += 1
        at = Start(now.time, turn, y, gap)
        event, length, rest = _good_step(now, at, new, acceleration, end, tolerances, m)
        if length == 0.0:
            return rows, COLLAPSED
        _sum_ledgers(length, rest, ledgers, m.rates)
        _shift(rest, new, m.rates)
        for n in range(COORDINATES):
            y[n] = new[n]
        turn, before = crank_turn(now.time, m.crank), gap
        gap = _gap_at(turn, y, joint, m.crank)
        acceleration = math.hypot(gap.u_x - before.u_x, gap.u_y - before.u_y) / length
        rows = _record(rows, now, y, ledgers, joint, buffers)
        if event == _LAW and joint.stop_penetration < math.inf:
            return rows, LAW_LEFT
        if gap.delta > contact.DEEPEST_SHARE * joint.R_bearing:
            return rows, HOLE_LEFT
        if event != _NOTHING:
            _switch(event, gap, now, joint)
            if event == _TOUCH and now.time < end:
                rows = _record(rows, now, y, ledgers, joint, buffers)
    return rows, END
