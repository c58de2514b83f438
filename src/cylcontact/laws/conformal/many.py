"""Conformal contact of many joints, each of its own materials, in compiled code.

A joint is its hole's share w_i, Dundurs' β and the datum's C. What β adds to the closed forms are
Chebyshev series in ε (`series.Remainder`). Over β, their coefficients are smooth functions of
|β|^(1/4) on each side of 0, and Chebyshev series of it are made once for all β. For each joint they
are summed, and then its arc is sought by Newton's method in q = (1 − S)²/S within a bracket, as
`arcs.Bodies` does for one pair of materials. A joint takes about 1 µs on one core, where the curve
of a pair takes 16 ms.

The results agree with `Bodies` to 1e-9. A joint whose steps have not converged, or whose arc is
longer than the series, is left to `Bodies`.

This module imports numba, which is slow: import it where it is needed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from cylcontact.laws.conformal import series
from cylcontact.laws.conformal.arcs import Bodies, require_increasing
from cylcontact.laws.conformal.curve import MOST
from cylcontact.support.arrays import FloatArray, as_floats, on_one_thread
from cylcontact.support.numba_cache import compiled, inlined

# How many β of each sign have a solution, and the ends of |β|^(1/4).
_BETAS = 20
LEAST_BETA = series.SMALL_BETA
FIRST_R, LAST_R = LEAST_BETA**0.25, 0.5**0.25
# What the columns of the series add to: a, h, M, their derivatives by ε, and the largest pressure.
COLUMNS = 7
# Steps at most. After a step of this relative size the next evaluation is the last one, because a
# further step would be its square.
STEPS, SMALL_STEP = 80, 1e-5
LEAST_Q, MOST_Q = 1e-70, 1e308
SERIES_END = series.SERIES_END
SERIES = tuple(series.SERIES_OF_HOOP.tolist())
FAST = {"contract", "nsz", "reassoc"}  # sums in any order


class State(NamedTuple):
    """What joints do: d or φ, dφ/dd, U/(φ·d), ε in radians, and the largest R·p/f."""

    other: FloatArray
    stiffness: FloatArray
    work: FloatArray
    angle: FloatArray
    peak: FloatArray


@dataclass(eq=False)
class Many:
    """The answers of `Bodies` for elements of other w_i, β and C, all of shape (n,).

    All answers come from one search, which is remembered for the array that was asked last.
    """

    w_i: FloatArray
    beta: FloatArray
    C: FloatArray
    _known: list[tuple[FloatArray, bool, State]] = field(default_factory=list, init=False)
    end: ClassVar[tuple[float, float]] = (math.inf, math.inf)

    def load(self, d: FloatArray) -> FloatArray:
        """Return φ at d."""
        return self.state(d, by_load=False).other

    def penetration(self, phi: FloatArray) -> FloatArray:
        """Return d under φ."""
        return self.state(phi, by_load=True).other

    def stiffness(self, d: FloatArray) -> FloatArray:
        """Return dφ/dd at d."""
        return self.state(d, by_load=False).stiffness

    def energy(self, d: FloatArray) -> FloatArray:
        """Return the stored energy over E*·ΔR² at d."""
        state = self.state(d, by_load=False)
        return as_floats(state.other * d * state.work)

    def angle(self, phi: FloatArray) -> FloatArray:
        """Return ε in radians under φ."""
        return self.state(phi, by_load=True).angle

    def peak(self, phi: FloatArray) -> FloatArray:
        """Return the largest R·p/f under φ."""
        return self.state(phi, by_load=True).peak

    def require_increasing(self) -> None:
        """Raise `InputError` if the datum makes δ decrease with the load for some element."""
        d = self.penetration(np.full(self.w_i.shape, MOST))
        require_increasing(as_floats(d * (np.pi / MOST)), self.C)

    def state(self, x: FloatArray, *, by_load: bool) -> State:
        """Return all answers under the loads x, or at the penetrations x, of shape (n,)."""
        for known, known_by_load, state in self._known:
            if known is x and known_by_load == by_load:
                return state
        table, out = table_of_arcs(), np.empty((len(State._fields), x.size))
        scratch = np.empty(table.shape[1] + table.shape[2])
        _solved((self.w_i, self.beta, self.C), x, by_load, table, scratch, out)
        for k in np.flatnonzero(np.isnan(out[0])):
            joint = float(self.w_i[k]), float(self.beta[k]), float(self.C[k])
            out[:, k] = _alone(*joint, float(x[k]), by_load=by_load)
        state = State(*out)
        other = state._replace(other=x)  # the same from the other side
        self._known = [(x, by_load, state), (state.other, not by_load, other)]
        return state


def _alone(w_i: float, beta: float, C: float, x: float, *, by_load: bool) -> State:
    """Return the state of one joint by the series of its own β."""
    bodies, at = Bodies(as_floats(w_i), beta, as_floats(C)), as_floats(x)
    arc = bodies.arc_of_load(at) if by_load else bodies.arc_of_penetration(at)
    d = as_floats(at * arc.L / np.pi) if by_load else at
    other = d if by_load else as_floats(np.pi * at / arc.L)
    return State(other, bodies.stiffness(d), bodies.work(arc), arc.angle, bodies.pressure(arc)[0])


@cache
def table_of_arcs() -> FloatArray:
    """Return the series over β of what β adds to the arcs."""
    return over_beta(lambda beta: series.of_beta(beta)[:, :COLUMNS])


@on_one_thread()
def over_beta(of_beta: Callable[[float], FloatArray]) -> FloatArray:
    """Return the series in |β|^(1/4) of those in ε over |β|, shape (2, betas, nodes·columns)."""
    r = FIRST_R + (LAST_R - FIRST_R) * (1 + chebyshev.chebpts1(_BETAS)) / 2
    table = []
    for sign in (-1, 1):
        rows = [of_beta(sign * x**4) / x**4 for x in r.tolist()]
        table.append(series.fitted(np.reshape(rows, (_BETAS, -1))))
    return np.stack(table)


@inlined
def largest_c(share: float) -> float:
    """Return `series.estimated_c`, about cos²(ε/2) of the largest arc."""
    return math.sqrt(2 * share) / (1 + 1.17 * math.sqrt(share))


@inlined
def hoop_of(S: float, c: float, fall: float) -> float:
    """Return (H − 1)/S for β = 0, as `series.closed_forms` does; `fall` is −ln c."""
    if S >= SERIES_END:
        return (2 * S - 1 + c * c * fall / S) / S
    total = 0.0
    for n in range(len(SERIES) - 1, -1, -1):
        total = total * S + SERIES[n]
    return total


@inlined
def sum_over_beta(beta: float, table: FloatArray, T: FloatArray, columns: FloatArray) -> float:
    """Put the series in ε of one β into `columns`, and return the angle up to which they hold."""
    size = abs(beta)
    at_least = max(size, LEAST_BETA)
    x = 2 * (math.sqrt(math.sqrt(at_least)) - FIRST_R) / (LAST_R - FIRST_R) - 1
    T[0] = size
    T[1] = x * size
    for n in range(2, T.size):
        T[n] = 2 * x * T[n - 1] - T[n - 2]
    rows = table[1 if beta > 0 else 0]
    for k in range(columns.size):
        columns[k] = T[0] * rows[0, k]
    for n in range(1, T.size):
        factor = T[n]
        for k in range(columns.size):
            columns[k] += factor * rows[n, k]
    return 2 * math.acos(math.sqrt(0.9 * largest_c(at_least)))


class Arc(NamedTuple):
    """A contact arc: b = tan(ε/2), S, c = 1 − S, k = S·K, L, and slopes by ln b².

    `y` is the place of ε in the series, from −1 to 1, and `h` what β adds to (H − 1)/S.
    """

    b: float
    S: float
    c: float
    k: float
    k_slope: float
    L: float
    L_slope: float
    y: float
    h: float


@inlined
def arc_of(q: float, w: float, C: float, top: float, columns: FloatArray) -> Arc:
    """Return the arc with (1 − S)²/S = q, as `Bodies.arc` does."""
    b2 = 2 / (q * (1 + math.sqrt(1 + 4 / q)))
    c = 1 / (1 + b2)
    S, b, fall = b2 * c, math.sqrt(b2), math.log1p(b2)
    y = min(4 * math.atan(b) / top - 1, 1.0)
    twice = 2 * y
    a = h = M = a_rate = h_rate = M_rate = 0.0
    a1 = h1 = M1 = a_rate1 = h_rate1 = M_rate1 = 0.0
    for i in range(columns.size - COLUMNS, -1, -COLUMNS):  # Clenshaw's recurrence of six series
        a, a1 = columns[i] + twice * a - a1, a
        h, h1 = columns[i + 1] + twice * h - h1, h
        M, M1 = columns[i + 2] + twice * M - M1, M
        a_rate, a_rate1 = columns[i + 3] + twice * a_rate - a_rate1, a_rate
        h_rate, h_rate1 = columns[i + 4] + twice * h_rate - h_rate1, h_rate
        M_rate, M_rate1 = columns[i + 5] + twice * M_rate - M_rate1, M_rate
    h -= y * h1
    rate = b * c  # dε/dln b²
    part = q * fall
    H = 2 * S + part
    H_slope = c * (2 * S + c - 2 * c * fall - part)
    more = S * h
    more_slope = S * (c * h + rate * (h_rate - y * h_rate1))
    k = c * c + (a - y * a1) - w * (S * (H + more))
    k_slope = -2 * S * c * c + rate * (a_rate - y * a_rate1)
    k_slope -= w * (S * (c * (H + more) + H_slope + more_slope))
    L = fall - math.log(b2) + S * S / 2 + w * H + C + (M - y * M1) - (1 - w) * more
    L_slope = c * (S * S - 1) + w * H_slope + rate * (M_rate - y * M_rate1) - (1 - w) * more_slope
    return Arc(b, S, c, k, k_slope, L, L_slope, y, h)


@inlined
def end_of(w: float, beta: float) -> float:
    """Return about the q of the largest arc."""
    c = largest_c(max(w + beta, 1e-35))
    return c * c / (1 - c)


@inlined
def start_at_penetration(
    w: float, beta: float, C: float, each: float, top: float, columns: FloatArray
) -> float:
    """Return about the q of the arc at d = 1/`each`, exact for small and large ones."""
    end = end_of(w, beta)
    L = arc_of(end, w, C, top, columns).L
    of_L = math.exp(min(C + w - L, 10.0)) * each
    return (L + math.log1p(of_L * (L + math.log1p(2.7 * of_L)))) * each + end


@inlined
def arc_sought(
    q: float, w: float, C: float, each: float, by_load: bool, top: float, columns: FloatArray
) -> tuple[Arc, float]:
    """Return the arc where K, or K/L, is `each`, and the last step to it in ln b², from a start q.

    The step is NaN if the arc is not found.
    """
    low, high, is_last = LEAST_Q, MOST_Q, False
    arc = arc_of(q, w, C, top, columns)
    for _ in range(STEPS):
        goal = arc.S * each
        miss, slope = arc.k - goal, arc.k_slope - arc.c * arc.k
        if not by_load:
            miss, slope = arc.k - goal * arc.L, slope - goal * arc.L_slope
        step = -miss / slope
        if is_last:
            return arc, (step if abs(step) < SMALL_STEP else math.nan)
        if miss > 0:
            high = q
        else:
            low = q
        new = q - q * (1 + arc.S) * step
        if not (new > low and new < high):
            new = math.sqrt(low) * math.sqrt(high)
        is_last = abs(new - q) <= SMALL_STEP * q
        q = new
        arc = arc_of(q, w, C, top, columns)
    return arc, math.nan


@inlined
def highest_pressure(b: float, y: float, columns: FloatArray) -> float:
    """Return the largest R·p/f."""
    more = more1 = 0.0
    for i in range(columns.size - 1, -1, -COLUMNS):
        more, more1 = columns[i] + 2 * y * more - more1, more
    b2 = b * b
    of_persson = 2 * b / math.sqrt(1 + b2) + math.asinh(b) / (b2 * (1 + b2))
    return of_persson / math.pi * (1 + more - y * more1)


def _solve(
    joints: tuple[FloatArray, FloatArray, FloatArray], x: FloatArray, by_load: bool,
    table: FloatArray, scratch: FloatArray, out: FloatArray,
) -> None:  # fmt: skip
    """Put the state of each joint at φ, or at d, into a row of `out`; NaN if it is not found."""
    T, columns = scratch[: table.shape[1]], scratch[table.shape[1] :]
    w_i, beta, C = joints
    top = math.pi
    for n in range(x.size):
        w = w_i[n]
        if n == 0 or beta[n] != beta[n - 1]:
            top = sum_over_beta(beta[n], table, T, columns)
        each = math.pi / x[n] if by_load else 1 / x[n]
        if by_load:
            q = each + end_of(w, beta[n])
        else:
            q = start_at_penetration(w, beta[n], C[n], each, top, columns)
        arc, step = arc_sought(q, w, C[n], each, by_load, top, columns)
        L = arc.L + arc.L_slope * step
        S, c = arc.S * (1 + arc.c * step), arc.c * (1 - arc.S * step)
        k = S * each if by_load else S * each * L
        hoop = hoop_of(arc.S, arc.c, math.log1p(arc.b * arc.b)) + arc.h
        b = arc.b * (1 + step / 2)
        out[0, n] = L / each if by_load else math.pi / (each * L)
        out[1, n] = math.pi / (L + arc.L_slope / (c - arc.k_slope / k))
        out[2, n] = (1 - k * hoop / L) / 2
        out[3, n] = 2 * math.atan(b)
        out[4, n] = highest_pressure(b, arc.y, columns)


_solved: Any = compiled(_solve, fastmath=FAST)
