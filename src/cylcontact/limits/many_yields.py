"""First yield of many pins in holes, each of its own materials, in compiled code.

It is the search of `yield_search` without its tables: on each arc the stresses on the axis of the
contact are computed from the pressure, and the load is sought at which the largest equivalent
stress reaches the yield stress of a body. On the axis, at η = iτ with s = √(b² + τ²), Schwarz's
integral F and X = −i·dF/dη of `cylcontact.limits.stress` are real. For β = 0 they are closed forms;
to these β adds Σ Δaₘ·(−1)ᵐ·ρⁿ and Σ n·Δaₘ·(−1)ᵐ·ρⁿ/s with ρ = b/(τ + s), n = 2m + 1. The Δaₘ are
Chebyshev series in ε and in |β|^(1/4), as all that β adds (`cylcontact.laws.conformal.many`).

This module imports numba, which is slow: import it where it is needed.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from cylcontact.laws.conformal import series
from cylcontact.laws.conformal.many import (
    FAST,
    arc_sought,
    end_of,
    over_beta,
    sum_over_beta,
    table_of_arcs,
)
from cylcontact.support.arrays import FloatArray
from cylcontact.support.numba_cache import compiled, inlined

# Terms Δaₘ of the pressure: the rest changes the stresses by less than 1e-6.
TERMS = 16
# Points on the axis from the surface on, closer towards it; to so many half-widths or, in the plate
# and the pin, nearly to infinity and some way beyond the centre; parabolas through the largest.
POINTS, REACH, FARTHEST_IN_HOLE, FARTHEST_IN_PIN, PARABOLAS = 24, 3.0, 0.9, 3.0, 3
# Loads tried at most, and the error of ln φm from which one more step is the last.
STEPS, CLOSE = 40, 1e-3
# tan(ε/2) of the longest arc for which the terms are enough, 166°.
LARGEST_B = 8.0
P1 = 1 / (2 * math.pi)
NEAR = 1e-6  # the centre of the pin
HERTZ = 0.36  # m over √φ at small loads and ν = 0.3, for a start
LEAST_Q = 1e-60
HOLE, PIN = 0, 1
VON_MISES, TRESCA_IN_PLANE, TRESCA_ACROSS = 0, 1, 2


@cache
def table_of_pressures() -> FloatArray:
    """Return the series over β of Δaₘ·(−1)ᵐ·tan(ε/2)/β, as `over_beta` makes them."""
    signs = (-1.0) ** np.arange(TERMS)

    def of_beta(beta: float) -> FloatArray:
        top = float(series.largest_angle(abs(beta)))
        angle = top * (1 + chebyshev.chebpts1(series.NODES)) / 2
        b = np.tan(angle / 2)
        terms = series.enough_terms(float(b[-1]))
        more = series.glauert(b, beta, terms).coefficients[:, :TERMS]
        less = series.glauert(b, 0.0, terms).coefficients[:, :TERMS]
        return series.fitted((more - less) * b[:, None] * signs)

    return over_beta(of_beta)


@inlined
def field_at(tau: float, b: float, terms: FloatArray) -> tuple[float, float]:
    """Return F and X at η = iτ."""
    b2 = b * b
    B = math.sqrt(1 + b2)
    s = math.sqrt(b2 + tau * tau)
    even, scale, lower = 2 * b2 / (math.pi * B), math.pi * b2 * B * B, 1 + tau
    conjugate = s + B * tau
    log = math.log1p((b2 / (1 + B) + b2 / (s + tau)) / lower)
    F = even / conjugate + log / scale
    X = even * (tau / s + B) / (conjugate * conjugate)
    X += (s * B + b2 - tau) / (s * (B + s) * lower) / scale
    rho = b / (tau + s)
    square = rho * rho
    total = slope = 0.0
    for m in range(TERMS - 1, -1, -1):
        total = total * square + terms[m]
        slope = slope * square + (2 * m + 1) * terms[m]
    return F + total * rho, X + slope * rho / s


class Body(NamedTuple):
    """A body, as `yield_search.Body`, and which stress is compared with its yield stress."""

    which: int  # HOLE or PIN
    kappa: float
    nu: float
    stress: int  # VON_MISES, TRESCA_IN_PLANE or TRESCA_ACROSS


@inlined
def stress_at(tau: float, F: float, X: float, p0: float, body: Body) -> float:
    """Return the equivalent stress at η = iτ; of Tresca's two, each smooth, the larger counts."""
    lower = 1 + tau
    w, inside = (1 - tau) / lower, 4 * tau / (lower * lower)
    P, slope = (F - p0) / 2, lower * lower * X / 4
    if body.which == PIN:
        if abs(w) < NEAR:  # the centre, where the formula is 0/0
            return -1.0
        total, difference = -2 * p0 - 4 * P, 2 * (slope - P1) * inside / w
    else:
        q = P1 * body.kappa / (body.kappa + 1)
        total = 4 * (q * w - P)
        difference = 2 * (w * inside * slope + (1 - inside) * (p0 + 2 * q * w))
    half, across = abs(difference) / 2, abs(0.5 - body.nu) * abs(total)
    if body.stress == VON_MISES:
        return math.sqrt(3 * half * half + across * across)
    return 2 * half if body.stress == TRESCA_IN_PLANE else half + across


@inlined
def largest_in(
    body: Body, b: float, p0: float, terms: FloatArray, axis: FloatArray
) -> tuple[float, float]:
    """Return the largest equivalent stress of a body and its τ; `axis` has τ, F and X of points."""
    farthest = FARTHEST_IN_PIN if body.which == PIN else FARTHEST_IN_HOLE
    tau, F, X, values = axis[0], axis[1], axis[2], axis[3]
    for i in range(POINTS):
        values[i] = stress_at(tau[i], F[i], X[i], p0, body)
    at = 0
    for i in range(1, POINTS):
        if values[i] > values[at] and tau[i] <= farthest:
            at = i
    if at == 0 or at == POINTS - 1:
        return values[at], tau[at]
    left, middle, right = tau[at - 1], tau[at], tau[at + 1]
    of_left, best, of_right = values[at - 1], values[at], values[at + 1]
    for _ in range(PARABOLAS):
        one, other = (middle - left) * (best - of_right), (middle - right) * (best - of_left)
        new = middle - ((middle - left) * one - (middle - right) * other) / (2 * (one - other))
        if not (new > left and new < right) or new == middle:
            break
        value = stress_at(new, *field_at(new, b, terms), p0, body)
        if value > best:  # `middle` becomes an end of the bracket, or else `new`
            new, middle, value, best = middle, new, best, value
        if new < middle:
            left, of_left = new, value
        else:
            right, of_right = new, value
    return best, middle


@inlined
def strongest(
    which: int, kappa: float, nu: float, tresca: bool, b: float, p0: float, terms: FloatArray,
    axis: FloatArray,
) -> tuple[float, float]:  # fmt: skip
    """Return the largest equivalent stress of a body by a criterion, and its τ."""
    first = TRESCA_IN_PLANE if tresca else VON_MISES
    best, tau = largest_in(Body(which, kappa, nu, first), b, p0, terms, axis)
    if tresca:
        other, at = largest_in(Body(which, kappa, nu, TRESCA_ACROSS), b, p0, terms, axis)
        if other > best:
            best, tau = other, at
    return best, tau


@inlined
def fill_terms(b: float, y: float, columns: FloatArray, terms: FloatArray) -> None:
    """Put Δaₘ·(−1)ᵐ into `terms`, from the series at y, by Clenshaw's recurrence."""
    for m in range(2 * TERMS):
        terms[m] = 0.0
    for i in range(columns.size - TERMS, -1, -TERMS):
        for m in range(TERMS):
            new = columns[i + m] + 2 * y * terms[m] - terms[TERMS + m]
            terms[TERMS + m], terms[m] = terms[m], new
    for m in range(TERMS):
        terms[m] = (terms[m] - y * terms[TERMS + m]) / b


@inlined
def fill_axis(b: float, terms: FloatArray, axis: FloatArray) -> float:
    """Put τ, F and X of points on the axis into `axis`, and return p₀, which is F at τ = 1."""
    # In loops of their own, all but the logarithm for several points at once.
    b2 = b * b
    B = math.sqrt(1 + b2)
    even, scale = 2 * b2 / (math.pi * B), 1 / (math.pi * b2 * B * B)
    tau, F, X, rho, total = axis[0], axis[1], axis[2], axis[3], axis[4]
    tau[POINTS] = 1.0  # for p₀
    reach = min(REACH * b, FARTHEST_IN_PIN)
    for i in range(POINTS):
        tau[i] = reach * (i * i) / ((POINTS - 1) * (POINTS - 1))
    for i in range(POINTS + 1):
        s = math.sqrt(b2 + tau[i] * tau[i])
        lower, conjugate = 1 + tau[i], 1 / (s + B * tau[i])
        F[i] = (b2 / (1 + B) + b2 / (s + tau[i])) / lower
        X[i] = even * (tau[i] + B * s) * conjugate * conjugate
        X[i] = (X[i] + (s * B + b2 - tau[i]) / ((B + s) * lower) * scale) / s
        rho[i] = b / (tau[i] + s)
        total[i] = even * conjugate
    for i in range(POINTS + 1):
        F[i] = math.log1p(F[i]) * scale + total[i]
    slope = axis[5]
    for i in range(POINTS + 1):
        total[i] = slope[i] = 0.0
    for m in range(TERMS - 1, -1, -1):
        a, n_a = terms[m], (2 * m + 1) * terms[m]
        for i in range(POINTS + 1):
            square = rho[i] * rho[i]
            total[i] = total[i] * square + a
            slope[i] = slope[i] * square + n_a
    for i in range(POINTS + 1):
        F[i] += total[i] * rho[i]
        X[i] += slope[i] * rho[i] / math.sqrt(b2 + tau[i] * tau[i])
    return float(F[POINTS])


@inlined
def slope_of_peak(b: float) -> float:
    """Return the slope of the logarithm of Persson's largest pressure by ln b²."""
    b2 = b * b
    B, log = math.sqrt(1 + b2), math.asinh(b) / (b2 * (1 + b2))
    slope = 2 * b / (B * B * B) + 1 / (b * B * B * B) - log * (2 + 4 * b2) / (1 + b2)
    return slope / 2 / (2 * b / B + log)


def _seek(
    joints: FloatArray, strengths: FloatArray, tresca: bool, tables: tuple[FloatArray, FloatArray],
    scratch: FloatArray, axis: FloatArray, out: FloatArray,
) -> None:  # fmt: skip
    """Put φ of first yield, its body and its depth over R into a row of `out`; NaN if not found.

    `joints` has w_i, β, and κ and ν of hole and pin; `strengths` T of both.
    """
    T = scratch[: tables[0].shape[1]]
    arcs = scratch[T.size : T.size + tables[0].shape[2]]
    pressures = scratch[T.size + arcs.size : T.size + arcs.size + tables[1].shape[2]]
    terms = scratch[T.size + arcs.size + pressures.size :]
    top = math.pi
    for n in range(joints.shape[1]):
        w, beta = joints[0, n], joints[1, n]
        if n == 0 or beta != joints[1, n - 1]:
            top = sum_over_beta(beta, tables[0], T, arcs)
            sum_over_beta(beta, tables[1], T, pressures)
        T_hole, T_pin = strengths[0, n], strengths[1, n]
        weaker = min(T_hole, T_pin)
        x = math.log(min(math.pi * (weaker / HERTZ) ** 2, 2 * weaker))  # ln φ
        low, high = -math.inf, math.inf
        x_before = miss_before = slope = 0.0
        q = math.pi * math.exp(-x) + end_of(w, beta)
        K_before = math.pi * math.exp(-x)
        out[0, n] = out[1, n] = out[2, n] = math.nan
        for attempt in range(STEPS):
            K = math.pi * math.exp(-x)
            q = max(q + K - K_before, LEAST_Q)
            K_before = K
            arc, step = arc_sought(q, w, 0.0, K, True, top, arcs)
            b = arc.b * (1 + step / 2)
            q = 1 / (b * b * (1 + b * b))
            if not b < LARGEST_B:
                break
            fill_terms(b, arc.y, pressures, terms)
            p0 = fill_axis(b, terms, axis)
            m, tau = strongest(HOLE, joints[2, n], joints[3, n], tresca, b, p0, terms, axis)
            m_pin, tau_pin = strongest(PIN, joints[4, n], joints[5, n], tresca, b, p0, terms, axis)
            share, share_of_pin = m / T_hole, m_pin / T_pin
            in_pin = share_of_pin > share
            miss = x + math.log(max(share, share_of_pin))  # grows with x
            if attempt == 0:
                slope = 1 + slope_of_peak(b) / (arc.c - arc.k_slope / (arc.S * K))
            elif x != x_before:
                slope = min(max((miss - miss_before) / (x - x_before), 0.3), 1.5)
            new = x - miss / slope
            if abs(miss) < CLOSE and attempt > 0:
                out[0, n] = math.exp(new)
                out[1, n] = PIN if in_pin else HOLE
                out[2, n] = 2 * tau_pin / (1 + tau_pin) if in_pin else 2 * tau / (1 - tau)
                break
            if miss > 0:
                high = x
            else:
                low = x
            if not (new > low and new < high):
                new = (low + high) / 2
            x_before, miss_before, x = x, miss, new


_sought: Any = compiled(_seek, fastmath=FAST)


def tables() -> tuple[FloatArray, FloatArray]:
    """Return the series over β of arcs and of pressures, which are made once."""
    return table_of_arcs(), table_of_pressures()


def yields_of_many(joints: FloatArray, strengths: FloatArray, tresca: bool) -> FloatArray:
    """Return φ of first yield, whether it is in the pin, and the depth over R, of shape (3, n).

    NaN where the search does not end or the arc is beyond 166°.

    Parameters
    ----------
    joints : array, shape (6, n)
        w_i, β, and κ and σ_zz/(σ_rr + σ_θθ) of the hole and of the pin.
    strengths : array, shape (2, n)
        σ_Y·R/(E*·ΔR) of the hole and of the pin.
    """
    both, out = tables(), np.empty((3, joints.shape[1]))
    size = both[0].shape[1] + both[0].shape[2] + both[1].shape[2] + 2 * TERMS
    _sought(joints, strengths, tresca, both, np.empty(size), np.empty((6, POINTS + 1)), out)
    return out
