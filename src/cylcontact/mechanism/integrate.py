"""The compiled time loop: adaptive steps in pieces in which the forces are smooth.

The forces have kinks: at the onset and the release of contact, at the four speeds where friction
bends (Eq 15), and where the tangent continues a law. Between them the loop holds every force in its
present piece, if need be beyond its end. A step that has passed an end is an event: it is repeated,
shorter, until it ends there, and then the piece changes. States at events are results of steps,
never of interpolation, which would lose energy at every impact.

A root finder that compares signs at the ends of a step can overlook a shallow contact or a short
release. Therefore a step in which δ turns is looked at more closely, and a step in flight moves the
journal by no more than a part of the clearance.
"""

from __future__ import annotations

import math

import numpy as np

from cylcontact.arrays import BoolArray, FloatArray
from cylcontact.mechanism import contact
from cylcontact.mechanism.dop853 import (
    STAGES,
    Blocks,
    Workspace,
    crank,
    error,
    evaluate,
    motion,
    step,
    sum_ledgers,
    turned,
    workspace,
)
from cylcontact.numba_cache import compiled, inlined

__all__ = [
    "COLLAPSED",
    "CONTACT",
    "END",
    "ERROR",
    "EVALUATIONS",
    "FULL",
    "IMPACT_RATE",
    "LAW_LEFT",
    "NOW",
    "STEP",
    "TIME",
    "integrate",
]

# Positions in the array that says where a run is: time in s, whether there is contact, δ̇⁽⁻⁾ in m/s,
# the next step in s (0 at a start), the error of the last one, evaluations so far, and how
# many steps have ended at the kink that they start from since one last ended at another.
TIME, CONTACT, IMPACT_RATE, STEP, ERROR, EVALUATIONS, HELD = 0, 1, 2, 3, 4, 5, 6
NOW = 7

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


@inlined
def _look(model: int, c: float, s: float, y: FloatArray, blocks: Blocks, space: Workspace) -> Look:
    """Return δ, δ̇, v_t and ė at a state."""
    p = blocks[0]
    e_x, e_y, u_x, u_y, spin_i, spin_j = motion(model, c, s, y, blocks[2], space[2])
    distance = math.sqrt(e_x * e_x + e_y * e_y)
    delta = distance - p[contact.CLEARANCE]
    if distance == 0.0:
        return delta, 0.0, 0.0, u_x, u_y
    n_x, n_y = e_x / distance, e_y / distance
    sliding = spin_i * p[contact.R_BEARING] - spin_j * (p[contact.R_JOURNAL] - delta)
    return delta, u_x * n_x + u_y * n_y, u_x * n_y - u_y * n_x + sliding, u_x, u_y


@compiled
def _choose_pieces(delta: float, v_t: float, p: FloatArray) -> None:
    """Set the branch of friction and the regime of the law by the state."""
    speed = abs(v_t)
    branch = 0.0 if speed <= p[contact.V0] else (1.0 if speed <= p[contact.V1] else 2.0)
    p[contact.BRANCH] = 0.0 if p[contact.FRICTION] == 0.0 else math.copysign(branch, v_t)
    if p[contact.LAST_PENETRATION] < math.inf and p[contact.STOP_PENETRATION] == math.inf:
        beyond = delta * 1e3 > p[contact.LAST_PENETRATION]
        p[contact.REGIME] = contact.LINE if beyond else contact.LAW


@inlined
def _bounds(branch: float, p: FloatArray) -> tuple[float, float]:
    """Return the tangential velocities between which a branch of friction holds."""
    v0, v1 = p[contact.V0], p[contact.V1]
    if p[contact.FRICTION] == 0.0:
        return -math.inf, math.inf
    if branch == 0.0:
        return -v0, v0
    inner, outer = (v0, v1) if abs(branch) == 1.0 else (v1, math.inf)
    return (inner, outer) if branch > 0 else (-outer, -inner)


@inlined
def _margin(kind: int, look: Look, p: FloatArray) -> float:
    """Return how far a state is inside the present piece; negative outside."""
    delta, v_t = look[0], look[2]
    if kind == _GAP:
        return delta if p[contact.MODE] == contact.CONTACT else -delta
    if kind in (_SLOWER, _FASTER):
        low, high = _bounds(p[contact.BRANCH], p)
        return v_t - low if kind == _SLOWER else high - v_t
    if p[contact.STOP_PENETRATION] < math.inf:
        return float(p[contact.STOP_PENETRATION] - delta)
    inside = float(p[contact.LAST_PENETRATION] * 1e-3 - delta)
    return -inside if p[contact.REGIME] == contact.LINE else inside


@compiled
def _turning(h: float, start: tuple[float, float], end: tuple[float, float]) -> tuple[float, float]:
    """Return where δ turns within a step, as a fraction of it, and δ there.

    From δ and δ̇ at both ends by Hermite's cubic; δ̇ must have opposite signs.
    """
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


@compiled
def _first_event(start: Look, end: Look, p: FloatArray) -> tuple[int, bool]:
    """Return what a step has passed first, and whether its start was inside."""
    found, starts_inside, earliest = _NOTHING, True, 2.0
    last = _LAW if p[contact.MODE] == contact.CONTACT else _GAP
    for kind in range(_GAP, last + 1):
        after = _margin(kind, end, p)
        if after < 0.0:
            before = _margin(kind, start, p)
            fraction = before / (before - after) if before > 0.0 else 0.0
            if fraction < earliest:
                found, starts_inside, earliest = kind, before > 0.0, fraction
    return found, starts_inside


@inlined
def _limit(look: Look, acceleration: float, p: FloatArray) -> float:
    """Return the longest step in s from a state: towards the release, and in flight."""
    delta, rate, _, u_x, u_y = look
    if p[contact.MODE] == contact.CONTACT:
        if rate < 0.0 and delta > _SHALLOW:
            return 0.85 * delta / -rate
        return math.inf
    c = p[contact.CLEARANCE]
    speed, limit = math.sqrt(u_x * u_x + u_y * u_y), math.inf
    if speed > 0.0:
        limit = c / (2.0 * speed)
    if acceleration > 0.0:
        limit = min(limit, 0.5 * math.sqrt(c / acceleration))
    return limit


@compiled
def _interpolate(
    x: float, h: float, y: FloatArray, new: FloatArray, k: FloatArray, out: FloatArray
) -> None:
    """Write the state at a fraction x of a step to `out`, by quintic Hermite interpolation.

    Row 0 and the last row of `k` have the rates at its ends.
    """
    half, last = y.size // 2, k.shape[0] - 1
    for n in range(half):
        d, v = new[n] - y[n], h * y[half + n]
        w, a, b = h * new[half + n], h * h * k[0, half + n], h * h * k[last, half + n]
        c3 = 10 * d - 6 * v - 4 * w - 1.5 * a + 0.5 * b
        c4 = -15 * d + 8 * v + 7 * w + 1.5 * a - b
        c5 = 6 * d - 3 * (v + w) - 0.5 * (a - b)
        out[n] = y[n] + x * (v + x * (0.5 * a + x * (c3 + x * (c4 + x * c5))))
        out[half + n] = (v + x * (a + x * (3 * c3 + x * (4 * c4 + x * 5 * c5)))) / h


@compiled
def _guess(
    model: int,
    kind: int,
    t: float,
    h: float,
    turn: tuple[float, float],
    margins: tuple[float, float],
    y: FloatArray,
    new: FloatArray,
    blocks: Blocks,
    space: Workspace,
) -> float:
    """Return about when an event occurs within a step, from interpolation.

    `margins` are those at its ends.
    """
    p, _, m = blocks
    c, s = turned(model, turn[0], turn[1], h, m)
    evaluate(model, t + h, c, s, new, STAGES, blocks, space)
    low, high, last = 0.0, 1.0, 2.0
    g_low, g_high = margins
    x = 0.5
    for _ in range(_ATTEMPTS):  # regula falsi, Illinois' variant
        x = (low * g_high - high * g_low) / (g_high - g_low)
        if abs(x - last) * h < 0.1 * _AT_KINK:
            break
        _interpolate(x, h, y, new, space[0], space[1])
        c, s = turned(model, turn[0], turn[1], x * h, m)
        look = _look(model, c, s, space[1], blocks, space)
        g = _margin(kind, look, p)
        if g > 0.0:
            g_high *= 0.5 if low == last else 1.0
            low, g_low = x, g
        else:
            g_low *= 0.5 if high == last else 1.0
            high, g_high = x, g
        last = x
    return x * h


@compiled
def _land(
    model: int,
    kind: int,
    t: float,
    h: float,
    turn: tuple[float, float],
    margins: tuple[float, float],
    y: FloatArray,
    new: FloatArray,
    blocks: Blocks,
    space: Workspace,
    now: FloatArray,
) -> tuple[float, float]:
    """Repeat a step until it ends at an event, as close as a shift by a very short time.

    Parameters
    ----------
    kind : int
        The event.
    t, h : float
        The start of the step in s, and a length at which it has passed the event.
    turn, margins : pair of float
        That of `crank` at the start, and the margins at both ends.
    new : array of float
        The state at the end; updated.

    Returns
    -------
    length, rest : float
        The length of the step and the time from there to the event, in s; a length of 0 if the
        step ends at the kink that it starts from, as too many before.
    """
    p, tolerance = blocks[0], _AT_GAP if kind == _GAP else _AT_KINK
    x = _guess(model, kind, t, h, turn, margins, y, new, blocks, space)
    now[EVALUATIONS] += 1
    low, high = 0.0, h
    for _ in range(_ATTEMPTS):
        step(model, t, x, turn[0], turn[1], y, new, blocks, space)
        now[EVALUATIONS] += STAGES - 1
        c, s = turned(model, turn[0], turn[1], x, blocks[2])
        look = _look(model, c, s, new, blocks, space)
        g = _margin(kind, look, p)
        if g > 0.0:
            low = x
        else:
            high = x
        space[1][:] = new
        _shift(_AT_SLOPE, space[1], space[0])
        c, s = turned(model, c, s, _AT_SLOPE, blocks[2])
        look = _look(model, c, s, space[1], blocks, space)
        rise = _margin(kind, look, p) - g
        correction = -g / rise * _AT_SLOPE if rise != 0.0 else math.inf
        if abs(correction) < tolerance or high - low < tolerance:
            if x >= tolerance:
                now[HELD] = 0
            elif kind != _GAP and rise > 0.0:
                now[HELD] += 1
                if now[HELD] > _MOST_HELD:
                    return 0.0, 0.0
            return x, min(max(correction, -tolerance), tolerance)
        x += correction
        if not low < x < high:
            x = 0.5 * (low + high)
    return x, 0.0


@compiled
def _shift(dt: float, y: FloatArray, rates: FloatArray) -> None:
    """Move a state by a very short time, with the rates of the last stage."""
    half, last = y.size // 2, STAGES - 1
    for n in range(half):
        y[n] += dt * (y[half + n] + 0.5 * dt * rates[last, half + n])
        y[half + n] += dt * rates[last, half + n]


@compiled
def _switch(kind: int, look: Look, now: FloatArray, p: FloatArray) -> None:
    """Change to the piece beyond an event, and set the first step there."""
    delta, rate, v_t, _, _ = look
    if kind in (_SLOWER, _FASTER):
        p[contact.BRANCH] += 1.0 if kind == _FASTER else -1.0
    elif kind == _LAW:
        p[contact.REGIME] = contact.LINE if p[contact.REGIME] == contact.LAW else contact.LAW
    elif p[contact.MODE] == contact.CONTACT:
        p[contact.MODE] = contact.FREE
        now[CONTACT], now[IMPACT_RATE], now[STEP] = 0.0, 0.0, _FIRST_IN_FLIGHT
    else:
        p[contact.MODE] = contact.CONTACT
        p[contact.IMPACT_RATE] = max(rate, p[contact.RATE_FLOOR])
        _choose_pieces(delta, v_t, p)
        now[CONTACT], now[IMPACT_RATE] = 1.0, rate
        now[STEP] = min(_SHALLOW / max(rate, 1e-3 * p[contact.RATE_FLOOR]), 1e-7)


@compiled
def _length(
    now: FloatArray, look: Look, acceleration: float, end: float, max_step: float, p: FloatArray
) -> float:
    """Return the next step in s, which ends at `end` rather than just before it."""
    h = min(now[STEP], max_step)
    if p[contact.CLEARANCE] < math.inf:
        h = min(h, _limit(look, acceleration, p))
    return float(end - now[TIME] if now[TIME] + h * (1.0 + 1e-9) >= end else h)


@compiled
def _turn(h: float, start: Look, end: Look, p: FloatArray) -> tuple[float, bool]:
    """Return where a step should end because δ turns in it, and whether it overlooked an event.

    The deepest point of a contact becomes a row.
    """
    if start[1] * end[1] >= 0.0:
        return h, False
    at, depth = _turning(h, (start[0], start[1]), (end[0], end[1]))
    in_contact = p[contact.MODE] == contact.CONTACT
    overlooked = (depth < 0.0) == in_contact
    deepest = in_contact and start[1] > 0.0
    if 0.05 < at < 0.95 and (overlooked or deepest):
        return at * h, overlooked
    return h, False


@compiled
def _examine(
    model: int,
    t: float,
    h: float,
    turn: tuple[float, float],
    look: Look,
    y: FloatArray,
    new: FloatArray,
    blocks: Blocks,
    space: Workspace,
    now: FloatArray,
) -> tuple[int, float, float]:
    """Find the first event in a step within its tolerance, and end the step there.

    Parameters
    ----------
    t, h : float
        Its start and length in s.
    turn : pair of float
        That of `crank` at the start.
    look : Look
        At the start.
    y, new : array of float
        The states at both ends; `new` is updated.

    Returns
    -------
    event : int
        What is at the end; `_RETRY` if the step must be repeated with the step in `now`.
    length, rest : float
        Its length, and the time from its end to the event, in s.
    """
    p = blocks[0]
    c, s = turned(model, turn[0], turn[1], h, blocks[2])
    after = _look(model, c, s, new, blocks, space)
    event, starts_inside = _first_event(look, after, p)
    if event == _NOTHING:
        length, overlooked = _turn(h, look, after, p)
        if overlooked:
            now[STEP] = length
            return _RETRY, length, 0.0
        if length < h:
            step(model, t, length, turn[0], turn[1], y, new, blocks, space)
            now[EVALUATIONS] += STAGES - 1
        return _NOTHING, length, 0.0
    if event == _GAP and p[contact.ALLOWED_PENETRATION] > 0.0 and after[0] > 0.0:
        now[STEP] = 0.5 * h
        return (_GAP if after[0] <= p[contact.ALLOWED_PENETRATION] else _RETRY), h, 0.0
    if starts_inside:
        margins = _margin(event, look, p), _margin(event, after, p)
        length, rest = _land(model, event, t, h, turn, margins, y, new, blocks, space, now)
        if length > 0.0:
            return event, length, rest
        # The state has just passed a kink, and turns within the step to pass it again. Ended at
        # its start, such steps change between the two pieces without end.
        now[STEP] = 0.5 * h
        return _RETRY, h, 0.0
    now[STEP] = 0.25 * h
    return (_RETRY if h > _SHORTEST else event), h, 0.0


@inlined
def _record(
    row: int,
    now: FloatArray,
    y: FloatArray,
    ledgers: FloatArray,
    buffers: tuple[FloatArray, FloatArray, BoolArray, FloatArray],
) -> int:
    """Write a row and return the number of the next."""
    times, states, in_contact, impact_rates = buffers
    times[row], in_contact[row], impact_rates[row] = now[TIME], now[CONTACT] > 0, now[IMPACT_RATE]
    states[row, : y.size] = y
    states[row, y.size :] = ledgers
    return row + 1


@compiled
def integrate(
    model: int,
    now: FloatArray,
    y: FloatArray,
    ledgers: FloatArray,
    end: float,
    block: FloatArray,
    tolerances: tuple[float, FloatArray, float],
    buffers: tuple[FloatArray, FloatArray, BoolArray, FloatArray],
) -> tuple[int, int]:
    """Integrate until the time `end`, or until something else stops it.

    Parameters
    ----------
    model : int
        `dop853.MINIMAL` or `dop853.AUGMENTED`.
    now : array of float, shape (NOW,)
        Where the run is; updated. With a step of 0 it starts anew from the state.
    y, ledgers : array of float
        The coordinates and their rates, and the ledgers; updated.
    end : float
        In s.
    block : array of float
        The parameter block.
    tolerances : tuple
        The relative tolerance, the absolute tolerance of each coordinate and rate, and the longest
        step in s.
    buffers : tuple of array
        Output: time, state, contact and δ̇⁽⁻⁾ after each step. An onset and a release have two rows,
        one in each mode.

    Returns
    -------
    rows, status : int
        Rows filled, and `END`, `FULL`, `LAW_LEFT` or `COLLAPSED`.
    """
    p = block.copy()
    m = p[int(p[contact.MODEL_START]) :]
    blocks = (p, contact.law_of(p), m)
    space = workspace(model, y.size, m)
    relative, absolute, max_step = tolerances
    new = np.empty(y.size)

    turn, look = _begin(model, now, y, blocks, space)
    acceleration, rows, grow = 0.0, 0, _GROW
    while now[TIME] < end:
        if rows + 2 > buffers[0].size:
            return rows, FULL
        t, wanted = now[TIME], min(now[STEP], max_step)
        h = _length(now, look, acceleration, end, max_step, p)
        if not t + h > t:
            return rows, COLLAPSED
        step(model, t, h, turn[0], turn[1], y, new, blocks, space)
        now[EVALUATIONS] += STAGES - 1
        measure = error(h, y, new, space[0], relative, absolute)
        if not measure <= 1.0:
            shrink = _SAFETY * measure**-0.125 if measure < math.inf else 0.0
            now[STEP], grow = h * max(shrink, _SHRINK), 1.0
            continue
        event, length, rest = _NOTHING, h, 0.0
        if p[contact.CLEARANCE] < math.inf:
            event, length, rest = _examine(model, t, h, turn, look, y, new, blocks, space, now)
            if event == _RETRY:
                continue
        sum_ledgers(length, rest, ledgers, space[0])
        _shift(rest, new, space[0])
        y[:] = new
        now[TIME] = end if length == h and t + h * (1.0 + 1e-9) >= end else t + (length + rest)
        turn = crank(model, now[TIME], m)
        u_x, u_y = look[3], look[4]
        look = _look(model, turn[0], turn[1], y, blocks, space)
        acceleration = math.hypot(look[3] - u_x, look[4] - u_y) / length
        rows = _record(rows, now, y, ledgers, buffers)
        if event == _NOTHING:
            factor = _SAFETY * now[ERROR] ** _BETA / max(measure, 1e-10) ** (0.125 - 0.2 * _BETA)
            now[STEP] = length * min(max(factor, _SHRINK), grow)
            now[ERROR] = max(measure, 1e-4)
        elif event == _LAW and p[contact.STOP_PENETRATION] < math.inf:
            return rows, LAW_LEFT
        else:
            now[STEP], now[ERROR] = wanted, 1e-4
            _switch(event, look, now, p)
            if event == _GAP and now[TIME] < end:
                rows = _record(rows, now, y, ledgers, buffers)
        grow = _GROW
        evaluate(model, now[TIME], turn[0], turn[1], y, 0, blocks, space)
        now[EVALUATIONS] += 1
    return rows, END


@compiled
def _begin(
    model: int, now: FloatArray, y: FloatArray, blocks: Blocks, space: Workspace
) -> tuple[tuple[float, float], Look]:
    """Choose the pieces by the state and evaluate its rates; return `crank` and `_look` there."""
    p, _, m = blocks
    p[contact.MODE] = contact.CONTACT if now[CONTACT] > 0 else contact.FREE
    p[contact.IMPACT_RATE] = max(now[IMPACT_RATE], p[contact.RATE_FLOOR])
    turn = crank(model, now[TIME], m)
    look = _look(model, turn[0], turn[1], y, blocks, space)
    if now[STEP] == 0.0:
        now[STEP], now[ERROR] = _FIRST, 1e-4
    _choose_pieces(look[0], look[2], p)
    evaluate(model, now[TIME], turn[0], turn[1], y, 0, blocks, space)
    now[EVALUATIONS] += 1
    return turn, look
