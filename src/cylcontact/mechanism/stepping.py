"""The loop over CVODE's steps, compiled: every step is kept, events are recognised."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cylcontact.arrays import FloatArray
from cylcontact.compiled import compiled
from cylcontact.mechanism import contact, events
from cylcontact.mechanism.sundials import call_interpolate, call_roots, call_step, call_two

ONE_STEP = 2
ROOT_RETURN = 2
BISECTIONS = 60

# Where things are, by position in an array of addresses: CVODE's functions, the model's roots,
# CVODE's memory, the two N_Vectors, the time, the flags of the roots, a place for roots, and
# the parameter block.
CVODE, INTERPOLATE, WHICH, CURRENT_TIME, ROOTS = 0, 1, 2, 3, 4
MEMORY, VECTOR, OTHER, CLOCK, FLAGS, SCRATCH, BLOCK = 5, 6, 7, 8, 9, 10, 11
ADDRESSES = 12


@compiled
def step(
    at: NDArray[np.intp],
    y: FloatArray,
    other: FloatArray,
    now: FloatArray,
    found: NDArray[np.int32],
    scratch: FloatArray,
    p: FloatArray,
    end: float,
    times: FloatArray,
    states: FloatArray,
) -> tuple[int, int]:
    """Step until the buffers are full, the time `end` is reached or an event is found.

    Parameters
    ----------
    at : array of int
        The addresses.
    y, other, now, found, scratch : array
        What stands at `VECTOR`, `OTHER`, `CLOCK`, `FLAGS` and `SCRATCH`.
    p : array of float
        The parameter block.
    end : float
        In s.
    times, states : array of float
        To fill, one row for each step.

    Returns
    -------
    rows, flag : int
        Rows filled and CVODE's flag; an event is in `found`, by `events`.
    """
    in_contact = p[contact.MODE] == contact.CONTACT
    for n in range(times.size):
        before = now[0]
        flag = call_step(at[CVODE], (at[MEMORY], end, at[VECTOR], at[CLOCK], ONE_STEP))
        times[n], states[n] = now[0], y
        if flag == ROOT_RETURN:
            call_two(at[WHICH], (at[MEMORY], at[FLAGS]))
            if found[events.CROSSING] != 0:
                if p[contact.ALLOWED_PENETRATION] > 0.0 and not in_contact:
                    times[n] = _onset_in_step(at, now, scratch, p, before)
                    states[n] = other
            elif found[events.TURNING] != 0:
                delta = _gap(at, now[0], at[VECTOR], scratch)
                if (delta > 0.0) != in_contact:
                    # On the wrong side of the circle: a crossing was leapt over.
                    times[n] = _bisect(at, scratch, p, before, now[0], 0.0)
                    states[n], found[events.CROSSING] = other, 1
            if found[events.CROSSING] != 0 or found[events.LIMIT] != 0:
                return n + 1, flag
        elif flag != 0:
            return n + 1, flag
    return times.size, 0


@compiled
def _gap(at: NDArray[np.intp], t: float, vector: int, scratch: FloatArray) -> Any:
    """Return δ of the state in an N_Vector."""
    call_roots(at[ROOTS], (t, vector, at[SCRATCH], at[BLOCK]))
    return scratch[events.CROSSING]


@compiled
def _inside(at: NDArray[np.intp], t: float, scratch: FloatArray) -> Any:
    """Put the state at a time inside the last step into `OTHER` and return its δ."""
    call_interpolate(at[INTERPOLATE], (at[MEMORY], t, 0, at[OTHER]))
    return _gap(at, t, at[OTHER], scratch)


@compiled
def _bisect(
    at: NDArray[np.intp],
    scratch: FloatArray,
    p: FloatArray,
    before: float,
    after: float,
    high: float,
) -> float:
    """Find a time with 0 ≤ δ ≤ high; δ passes there upwards in flight, downwards in contact."""
    rising = p[contact.MODE] == contact.FREE
    for _ in range(BISECTIONS):
        middle = 0.5 * (before + after)
        delta = _inside(at, middle, scratch)
        if 0.0 <= delta <= high:
            return middle
        if (delta > high) == rising:
            after = middle
        else:
            before = middle
    _inside(at, after, scratch)
    return after


@compiled
def _onset_in_step(
    at: NDArray[np.intp], now: FloatArray, scratch: FloatArray, p: FloatArray, before: float
) -> float:
    """Halve the step until contact begins shallow enough, the paper's control."""
    call_two(at[CURRENT_TIME], (at[MEMORY], at[CLOCK]))
    allowed = p[contact.ALLOWED_PENETRATION]
    if _inside(at, now[0], scratch) > allowed:
        return _bisect(at, scratch, p, before, now[0], allowed)
    return float(now[0])
