"""The compiled time loop: adaptive steps in pieces in which the forces are smooth.

The forces have kinks: at the onset and the release of contact, at the four speeds where friction
bends (Eq 15), and where the tangent continues a law. Between them the loop holds every force in its
present piece, if need be beyond its end. A step that has passed an end is an event: it is repeated,
shorter, until it ends there, and then the piece changes. States at events are results of steps,
never of interpolation, which would lose energy at every impact. Of several joints the first event
counts, and with it those at the same time.

A root finder that compares signs at the ends of a step can overlook a shallow contact or a short
release. Therefore a step in which δ turns is looked at more closely, and a step in flight moves a
pin by no more than a part of its clearance.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from cylcontact.joint import contact
from cylcontact.joint.contact import Joint
from cylcontact.mechanism import dop853
from cylcontact.mechanism.dop853 import STAGES, Model, later, rates_at, step
from cylcontact.mechanism.slider_crank import Turn
from cylcontact.support.arrays import BoolArray, FloatArray
from cylcontact.support.numba_cache import called, compiled, copy_to, inlined, merged

# Where a run is: time in s, the next step in s (0 at a start), the error of the last one,
# evaluations so far, how many steps have ended at the kink that they start from since one last
# ended at another, and the joint of the last event.
Now = Any
NOW = np.dtype(
    [
        *((name, np.float64) for name in ("time", "step", "error")),
        *((name, np.int64) for name in ("evaluations", "held", "joint")),
    ]
)

# Why `integrate` returns: the end is reached, the buffers are full, the law ends, no step is small
# enough.
END, FULL, LAW_LEFT, COLLAPSED = 0, 1, 2, 3

# What a step may meet.
_NOTHING, _GAP, _SLOWER, _FASTER, _LAW = 0, 1, 2, 3, 4
_RETRY = -1

# Steps in s: the first one after a start, the first one in flight, and the shortest before an event
# that the state stands at already is taken as passed.
_FIRST, _FIRST_IN_FLIGHT, _SHORTEST = 1e-9, 1e-6, 1e-10
# Depth in m that the first step of a contact reaches, and above which δⁿ is smooth enough.
_SHALLOW = 2e-9
# How close in s a step must end at an onset or release, or at a kink.
_AT_GAP, _AT_KINK = 1e-10, 2e-11
# Time in s over which the slope of a margin is taken.
_AT_SLOPE = 1e-9
_ATTEMPTS = 60
# How many steps in a row may end at the kink that they start from. Up to 41 have been seen to go on
# by themselves, mostly 1; runs that do are as they always were.
_MOST_HELD = 64
# δ in m, δ̇ and v_t in m/s, and the two components of ė in m/s.
Look = tuple[float, float, float, float, float]
# The controller of Hairer and Wanner's code, with less stabilisation and more growth.
_SAFETY, _BETA, _SHRINK, _GROW = 0.9, 0.04, 1 / 3, 8.0


class Space(NamedTuple):
    """Room to work in, zero at first: the next state, looks, and |ë| of every joint."""

    new: FloatArray
    looks: FloatArray
    after: FloatArray
    accelerations: FloatArray

    @classmethod
    def of(cls, size: int, joints: int) -> Space:
        """Return the room for a state of a size, and for joints."""
        shapes = size, (joints, 5), (joints, 5), joints
        return cls(*[np.zeros(shape) for shape in shapes])


class Start(NamedTuple):
    """The start of a step: time in s, the crank's angle, the state, and the look at every joint."""

    time: float
    turn: Turn
    y: FloatArray
    looks: FloatArray


@called
def _look(turn: Turn, y: FloatArray, joint: Joint, m: Model) -> Look:
    """Return δ, δ̇, v_t and ė of a joint at a state."""
    e_x, e_y, u_x, u_y, spin_i, spin_j = dop853.motion(turn, y, joint, m.crank, m.pin, m.linkage)
    distance = math.sqrt(e_x * e_x + e_y * e_y)
    delta = distance - joint.clearance
    if distance == 0.0:
        return delta, 0.0, 0.0, u_x, u_y
    n_x, n_y = e_x / distance, e_y / distance
    sliding = spin_i * joint.R_bearing - spin_j * (joint.R_pin - delta)
    return delta, u_x * n_x + u_y * n_y, u_x * n_y - u_y * n_x + sliding, u_x, u_y


@compiled
def penetration(t: float, y: FloatArray, joint: Joint, m: Model) -> float:
    """Return δ of a joint at a state."""
    turn = dop853.clock(t, m.crank)
    e_x, e_y, _, _, _, _ = dop853.motion(turn, y, joint, m.crank, m.pin, m.linkage)
    return math.sqrt(e_x * e_x + e_y * e_y) - float(joint.clearance)


@called
def _look_at_all(turn: Turn, y: FloatArray, m: Model, looks: FloatArray) -> None:
    """Write the `Look` of every joint to a row of `looks`."""
    for k in range(m.joints.shape[0]):
        looks[k, 0], looks[k, 1], looks[k, 2], looks[k, 3], looks[k, 4] = _look(
            turn, y, m.joints[k], m
        )


@inlined
def _choose_pieces(delta: float, v_t: float, joint: Joint) -> None:
    """Set the branch of friction and the regime of the law by the state."""
    speed = abs(v_t)
    branch = 0 if speed <= joint.v0 else (1 if speed <= joint.v1 else 2)
    joint.branch = 0 if joint.friction == 0.0 else (branch if v_t >= 0.0 else -branch)
    if joint.last_penetration < math.inf and joint.stop_penetration == math.inf:
        beyond = delta * 1e3 > joint.last_penetration
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
def _margin(kind: int, delta: float, v_t: float, joint: Joint) -> float:
    """Return how far a state is inside the present piece; negative outside."""
    if kind == _GAP:
        return delta if joint.touching else -delta
    if kind in (_SLOWER, _FASTER):
        low, high = _bounds(joint)
        return v_t - low if kind == _SLOWER else high - v_t
    if joint.stop_penetration < math.inf:
        return float(joint.stop_penetration - delta)
    inside = float(joint.last_penetration * 1e-3 - delta)
    return -inside if joint.regime == contact.LINE else inside


@called
def _turning(h: float, start: FloatArray, end: FloatArray) -> tuple[float, float]:
    """Return the fraction of a step at which δ turns, and δ there, by Hermite's cubic."""
    a, b, c = h * start[1], end[0] - start[0], h * end[1]
    cubic, square = a + c - 2 * b, 3 * b - 2 * a - c
    low, high = 0.0, 1.0
    for _ in range(40):
        x = 0.5 * (low + high)
        if ((3 * cubic * x + 2 * square) * x + a) * a > 0:
            low = x
        else:
            high = x
    return low, start[0] + low * (a + low * (square + low * cubic))


@called
def _first_event(
    start: FloatArray, end: FloatArray, joints: Any, but: int
) -> tuple[int, int, bool]:
    """Return what a step has passed first, of which joint but one, and if its start was inside."""
    event, at, starts_inside, earliest = _NOTHING, but, True, 2.0
    for k in range(joints.shape[0]):
        joint = joints[k]
        if k == but:
            continue
        last = _LAW if joint.touching else _GAP
        for kind in range(_GAP, last + 1):
            after = _margin(kind, end[k, 0], end[k, 2], joint)
            if after < 0.0:
                before = _margin(kind, start[k, 0], start[k, 2], joint)
                fraction = before / (before - after) if before > 0.0 else 0.0
                if fraction < earliest:
                    event, at, starts_inside, earliest = kind, k, before > 0.0, fraction
    return event, at, starts_inside


@merged
def _interpolate(
    x: float, h: float, y: FloatArray, new: FloatArray, rates: FloatArray, out: FloatArray
) -> None:
    """Write the state at a fraction x of a step, by Hermite's quintic from first and last rates."""
    half, last = y.size // 2, rates.shape[0] - 1
    for n in range(half):
        d, v = new[n] - y[n], h * y[half + n]
        w, a, b = h * new[half + n], h * h * rates[0, half + n], h * h * rates[last, half + n]
        c3 = 10 * d - 6 * v - 4 * w - 1.5 * a + 0.5 * b
        c4 = -15 * d + 8 * v + 7 * w + 1.5 * a - b
        c5 = 6 * d - 3 * (v + w) - 0.5 * (a - b)
        out[n] = y[n] + x * (v + x * (0.5 * a + x * (c3 + x * (c4 + x * c5))))
        out[half + n] = (v + x * (a + x * (3 * c3 + x * (4 * c4 + x * 5 * c5)))) / h


@merged
def _guess(
    kind: int, k: int, h: float, margins: tuple[float, float], at: Start, new: FloatArray, m: Model
) -> float:
    """Return about when an event of a joint occurs within a step, from margins at its ends."""
    rates_at(at.time + h, later(at.turn, h, m.crank), new, STAGES, m)
    low, high, last = 0.0, 1.0, 2.0
    g_low, g_high = margins
    x = 0.5
    for _ in range(_ATTEMPTS):  # regula falsi, Illinois' variant
        x = (low * g_high - high * g_low) / (g_high - g_low)
        if abs(x - last) * h < 0.1 * _AT_KINK:
            break
        _interpolate(x, h, at.y, new, m.rates, m.stage)
        delta, _, v_t, _, _ = _look(later(at.turn, x * h, m.crank), m.stage, m.joints[k], m)
        g = _margin(kind, delta, v_t, m.joints[k])
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
    kind: int, k: int, h: float, at: Start, after: FloatArray, new: FloatArray, m: Model, now: Now
) -> tuple[float, float]:
    """Repeat a step until it ends at an event, as close as a shift by a very short time.

    `new` is the state at its end, which is updated, and `after` has the looks there. Returned are
    the length of the step and the time from its end to the event, in s; a length of 0 if the step
    ends at the kink that it starts from, as too many before.
    """
    joint, tolerance = m.joints[k], _AT_GAP if kind == _GAP else _AT_KINK
    margins = (
        _margin(kind, at.looks[k, 0], at.looks[k, 2], joint),
        _margin(kind, after[k, 0], after[k, 2], joint),
    )
    x = _guess(kind, k, h, margins, at, new, m)
    now.evaluations += 1
    low, high = 0.0, h
    for _ in range(_ATTEMPTS):
        step(at.time, x, at.turn, at.y, new, m)
        now.evaluations += STAGES - 1
        turn = later(at.turn, x, m.crank)
        delta, _, v_t, _, _ = _look(turn, new, joint, m)
        g = _margin(kind, delta, v_t, joint)
        if g > 0.0:
            low = x
        else:
            high = x
        copy_to(new, m.stage)
        _shift(_AT_SLOPE, m.stage, m.rates)
        delta, _, v_t, _, _ = _look(later(turn, _AT_SLOPE, m.crank), m.stage, joint, m)
        rise = _margin(kind, delta, v_t, joint) - g
        correction = -g / rise * _AT_SLOPE if rise != 0.0 else math.inf
        if abs(correction) < tolerance or high - low < tolerance:
            if x >= tolerance:
                now.held = 0
            elif kind != _GAP and rise > 0.0:
                now.held += 1
                if now.held > _MOST_HELD:
                    return 0.0, 0.0
            return x, min(max(correction, -tolerance), tolerance)
        x += correction
        if not low < x < high:
            x = 0.5 * (low + high)
    return x, 0.0


@called
def _shift(dt: float, y: FloatArray, rates: FloatArray) -> None:
    """Move a state by a very short time, with the rates of the last stage."""
    half, last = y.size // 2, STAGES - 1
    for n in range(half):
        y[n] += dt * (y[half + n] + 0.5 * dt * rates[last, half + n])
        y[half + n] += dt * rates[last, half + n]


@called
def _switch(kind: int, look: FloatArray, now: Now, joint: Joint) -> None:
    """Change a joint to the piece beyond an event, and set the first step there."""
    delta, rate, v_t = look[0], look[1], look[2]
    if kind in (_SLOWER, _FASTER):
        joint.branch += 1 if kind == _FASTER else -1
    elif kind == _LAW:
        joint.regime = contact.LINE if joint.regime == contact.LAW else contact.LAW
    elif joint.touching:
        joint.touching, joint.onset_rate = 0, 0.0
        now.step = _FIRST_IN_FLIGHT
    else:
        joint.touching, joint.onset_rate = 1, rate
        joint.impact_rate = max(rate, joint.rate_floor)
        _choose_pieces(delta, v_t, joint)
        now.step = min(_SHALLOW / max(rate, 1e-3 * joint.rate_floor), 1e-7)


@merged
def _switch_others(looks: FloatArray, now: Now, joints: Any) -> None:
    """Begin and end contacts that do so at the time of the event of another joint."""
    for k in range(joints.shape[0]):
        outwards = looks[k, 0] >= 0.0 and looks[k, 1] > 0.0
        inwards = looks[k, 0] <= 0.0 and looks[k, 1] < 0.0
        if k != now.joint and (inwards if joints[k].touching else outwards):
            _switch(_GAP, looks[k], now, joints[k])


@merged
def _length(
    now: Now, looks: FloatArray, accelerations: FloatArray, end: float, max_step: float, joints: Any
) -> float:
    """Return the next step in s, bounded towards a release, in flight, and by the end."""
    h = min(now.step, max_step)
    for k in range(joints.shape[0]):
        c, delta, rate = joints[k].clearance, looks[k, 0], looks[k, 1]
        if joints[k].touching:
            if rate < 0.0 and delta > _SHALLOW:
                h = min(h, 0.85 * delta / -rate)
            continue
        speed = math.sqrt(looks[k, 3] * looks[k, 3] + looks[k, 4] * looks[k, 4])
        if speed > 0.0:
            h = min(h, c / (2.0 * speed))
        if accelerations[k] > 0.0:
            h = min(h, 0.5 * math.sqrt(c / accelerations[k]))
    return float(end - now.time if now.time + h * (1.0 + 1e-9) >= end else h)


@merged
def _turn(h: float, start: FloatArray, end: FloatArray, joints: Any) -> tuple[float, bool]:
    """Return where a step should end as some δ turns in it, and whether it missed an event."""
    length, missed = h, False
    for k in range(joints.shape[0]):
        if start[k, 1] * end[k, 1] >= 0.0:
            continue
        at, depth = _turning(h, start[k], end[k])
        touching = joints[k].touching != 0
        overlooked = (depth < 0.0) == touching
        deepest = touching and start[k, 1] > 0.0
        if 0.05 < at < 0.95 and (overlooked or deepest) and at * h < length:
            length, missed = at * h, overlooked
    return length, missed


@merged
def _examine(
    h: float, at: Start, after: FloatArray, new: FloatArray, m: Model, now: Now
) -> tuple[int, float, float]:
    """Find the first event in a step within its tolerance, and end the step there.

    `new` is the state at its end, which is updated, and `after` is written. Returned are what is
    at the end (`_RETRY` if the step must be repeated with the step in `now`), its length, and the
    time from its end to the event, in s.
    """
    _look_at_all(later(at.turn, h, m.crank), new, m, after)
    event, k, starts_inside = _first_event(at.looks, after, m.joints, -1)
    if event == _NOTHING:
        length, missed = _turn(h, at.looks, after, m.joints)
        if missed:
            now.step = length
            return _RETRY, length, 0.0
        if length < h:
            step(at.time, length, at.turn, at.y, new, m)
            now.evaluations += STAGES - 1
        return _NOTHING, length, 0.0
    allowed = m.joints[k].allowed_penetration
    if event == _GAP and allowed > 0.0 and after[k, 0] > 0.0:
        now.step = 0.5 * h
        return (_GAP if after[k, 0] <= allowed else _RETRY), h, 0.0
    if starts_inside:
        return _land_on_first(event, k, h, at, after, new, m, now)
    return _at_once(event, k, h, now)


@merged
def _at_once(event: int, k: int, h: float, now: Now) -> tuple[int, float, float]:
    """Return that an event at the start of a step is taken if the step is very short."""
    now.joint, now.step = k, 0.25 * h
    return (_RETRY if h > _SHORTEST else event), h, 0.0


@merged
def _land_on_first(
    event: int, k: int, h: float, at: Start, after: FloatArray, new: FloatArray, m: Model, now: Now
) -> tuple[int, float, float]:
    """End a step at an event of a joint, or at an earlier one of another joint; see `_examine`."""
    while True:
        length, rest = _land(event, k, h, at, after, new, m, now)
        if length == 0.0:
            # The state has just passed a kink, and turns within the step to pass it again. Ended
            # at its start, such steps change between the two pieces without end.
            now.step = 0.5 * h
            return _RETRY, h, 0.0
        now.joint = k
        if m.joints.shape[0] == 1:
            return event, length, rest
        # Events were put in order by straight lines: that of another joint may be earlier.
        _look_at_all(later(at.turn, length, m.crank), new, m, after)
        earlier, other, starts_inside = _first_event(at.looks, after, m.joints, k)
        if earlier == _NOTHING:
            return event, length, rest
        event, k, h = earlier, other, length
        if not starts_inside:
            return _at_once(event, k, h, now)


@called
def _record(
    row: int,
    now: Now,
    y: FloatArray,
    ledgers: FloatArray,
    joints: Any,
    buffers: tuple[FloatArray, FloatArray, BoolArray, FloatArray],
) -> int:
    """Write a row and return the number of the next."""
    times, states, touching, onset_rates = buffers
    times[row] = now.time
    for n in range(y.size):
        states[row, n] = y[n]
    for n in range(ledgers.size):
        states[row, y.size + n] = ledgers[n]
    for k in range(joints.shape[0]):
        touching[row, k], onset_rates[row, k] = joints[k].touching != 0, joints[k].onset_rate
    return row + 1


@merged
def _begin(looks: FloatArray, joints: Any, now: Now) -> None:
    """Choose the pieces of all joints by the state, and the first step."""
    for k in range(joints.shape[0]):
        joints[k].impact_rate = max(joints[k].onset_rate, joints[k].rate_floor)
        _choose_pieces(looks[k, 0], looks[k, 2], joints[k])
    if now.step == 0.0:
        now.step, now.error = _FIRST, 1e-4


@merged
def _accelerate(h: float, before: FloatArray, after: FloatArray, out: FloatArray) -> None:
    """Write the mean size of ë over a step for every joint, and update the looks before it."""
    for k in range(out.size):
        out[k] = math.hypot(after[k, 3] - before[k, 3], after[k, 4] - before[k, 4]) / h
        copy_to(after[k], before[k])


@called
def _good_step(
    now: Now,
    at: Start,
    after: FloatArray,
    new: FloatArray,
    accelerations: FloatArray,
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
        h = _length(now, at.looks, accelerations, end, max_step, m.joints)
        if not t + h > t:
            return _NOTHING, 0.0, 0.0
        step(t, h, at.turn, at.y, new, m)
        now.evaluations += STAGES - 1
        measure = dop853.error(h, at.y, new, m.rates, relative, absolute)
        if not measure <= 1.0:
            shrink = _SAFETY * measure**-0.125 if measure < math.inf else 0.0
            now.step, grow = h * max(shrink, _SHRINK), 1.0
            continue
        event, length, rest = _NOTHING, h, 0.0
        if m.joints.shape[0]:
            event, length, rest = _examine(h, at, after, new, m, now)
            if event == _RETRY:
                continue
        now.time = end if length == h and t + h * (1.0 + 1e-9) >= end else t + (length + rest)
        if event == _NOTHING:
            factor = _SAFETY * now.error**_BETA / max(measure, 1e-10) ** (0.125 - 0.2 * _BETA)
            now.step, now.error = length * min(max(factor, _SHRINK), grow), max(measure, 1e-4)
        else:
            now.step, now.error = wanted, 1e-4
        return event, length, rest


@compiled
def integrate(
    now: Now,
    y: FloatArray,
    ledgers: FloatArray,
    end: float,
    m: Model,
    tolerances: tuple[float, FloatArray, float],
    space: Space,
    buffers: tuple[FloatArray, FloatArray, BoolArray, FloatArray],
) -> tuple[int, int]:
    """Integrate until the time `end`, or until something else stops it.

    `now`, the state `y`, its ledgers and the joints are those of the start, and are advanced.
    `tolerances` are the relative and the absolute one, and the longest step in s. Time, state with
    ledgers, contacts and δ̇⁽⁻⁾ after each step are written to `buffers`; an onset and a release have
    two rows, one in each mode. Returned are the rows filled, and `END`, `FULL`, `LAW_LEFT` or
    `COLLAPSED`.
    """
    new, looks, after, accelerations = space
    joints, turn = m.joints, dop853.clock(now.time, m.crank)
    _look_at_all(turn, y, m, looks)
    _begin(looks, joints, now)
    rows = 0
    while now.time < end:
        if rows + 2 > buffers[0].size:
            return rows, FULL
        rates_at(now.time, turn, y, 0, m)
        now.evaluations += 1
        at = Start(now.time, turn, y, looks)
        event, length, rest = _good_step(now, at, after, new, accelerations, end, tolerances, m)
        if length == 0.0:
            return rows, COLLAPSED
        dop853.sum_ledgers(length, rest, ledgers, m.rates)
        _shift(rest, new, m.rates)
        copy_to(new, y)
        turn = dop853.clock(now.time, m.crank)
        _look_at_all(turn, y, m, after)
        _accelerate(length, looks, after, accelerations)
        rows = _record(rows, now, y, ledgers, joints, buffers)
        if event == _LAW and joints[now.joint].stop_penetration < math.inf:
            return rows, LAW_LEFT
        if event != _NOTHING:
            _switch(event, looks[now.joint], now, joints[now.joint])
            _switch_others(looks, now, joints)
            if event == _GAP and now.time < end:
                rows = _record(rows, now, y, ledgers, joints, buffers)
    return rows, END
