"""What unlike materials add to the closed forms for a pin in a hole, by Glauert's series.

With p the pressure in units of f/R and β Dundurs' second parameter (`CylinderPair.beta`), contact
without friction along |θ| < ε means (Ciavarella and Decuzzi, Int. J. Solids Struct. 38 (2001)
4507–4523; derived in `cylcontact.laws.conformal`)

    ⨍ p(s)/(4·sin²((θ − s)/2)) ds + βπ·p(θ) + (1 − β)·cos θ + Â = 0,    ∫ p·cos θ dθ = 1,

with the finite part of the integral. In y = tan(θ/2) this is Prandtl's equation of the lifting
line, and Glauert's series solves it: p = Σ aₘ·sin nv with n = 2m + 1, y = b·cos v, b = tan(ε/2).
The first term of the equation turns sin nv into −πn·(1 + y²)/(2b)·sin nv/sin v.

**Galerkin instead of collocation.** Weighted with sin kv over dθ = W dv, W = 2b·sin v/(1 + y²), the
system is symmetric: −π²n/2 on the diagonal and βπ∫sin nv·sin kv·W dv. For β ≠ 0 the pressure has
a term v³·ln v at the edge, so aₘ ~ m⁻⁴ and collocation converges slowly. In the symmetric form the
error of Â and H is the square of the error of p. 64 terms give them to 1e-12 where collocation
gives 1e-8.

**Reciprocity** (see `cylcontact.laws.conformal`) gives the penetration from Â and H alone, without
a quadrature of the logarithmic kernel.

A housing adds Σ(1 − n²)·g_nm·P_m·cos nθ to the equation (`cylcontact.laws.conformal.housings`).

`remainder` has the difference to the closed forms of β = 0 for one β, and `housed` for one housing,
as Chebyshev series in ε; `cylcontact.laws.conformal.many` has it for all β. All of these functions
are analytic at ε = 0; their singularity at 180° is beyond the largest arc.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev, polynomial

from cylcontact.laws.conformal.housings import Kernel
from cylcontact.laws.tabulated import cubic
from cylcontact.support.arrays import FloatArray, as_floats, on_one_thread
from cylcontact.support.errors import InputError

# Terms of the series, as many again for each 8 of b (large arcs need a small β), and nodes in ε.
_TERMS, _B_PER_TERMS = 96, 8.0
NODES = 24
# For a housing: nodes until the last terms are this small, how far beyond the largest arc the
# series ends, arcs at most this long, and how many points the table of the largest pressure has.
_LAST_TERMS, _MOST_NODES = 1e-10, 144
_END_WITHIN, _LARGEST_ARC, _BEYOND = np.radians([3.0, 165.0, 165.5]).tolist()
_PEAKS = 1025
# Where the pressure is negative, sought on so many arcs and points along half of each.
_ARCS, _ALONG, _NO_PRESSURE = 129, 65, 1e-6
# Below this the remainder is proportional to β: what is of second order in β is below 1e-10.
SMALL_BETA = 1e-5
# Below this S, (H − 1)/S is 1/2 + Σ 2Sⁿ⁻¹/((n − 1)n(n + 1)), because the closed form loses digits.
SERIES_END = 0.1
_N = np.arange(2.0, 14.0)
SERIES_OF_HOOP = np.concatenate([[0.5], 2 / ((_N - 1) * _N * (_N + 1))])


class Solution(NamedTuple):
    """The contact along arcs: S·2Â, (H − 1)/S with H = ∫p dθ, and the pressure at θ = 0."""

    a: FloatArray
    h: FloatArray
    peak: FloatArray
    coefficients: FloatArray  # the aₘ of the pressure, shape (k, terms)


class ClosedForms(NamedTuple):
    """The same for β = 0 with derivatives by x = ln b², and S = sin²(ε/2)."""

    S: FloatArray
    a: FloatArray
    h: FloatArray
    a_slope: FloatArray
    h_slope: FloatArray


def closed_forms(b2: FloatArray) -> ClosedForms:
    """Return the solution for β = 0 at b²: a = c² and H = 2S − c²·ln(c)/S with c = 1 − S."""
    c = 1 / (1 + b2)
    S = b2 * c
    small, inner = np.minimum(S, SERIES_END), np.maximum(S, SERIES_END)
    log = np.log1p(np.maximum(b2, SERIES_END))  # -ln c
    h = (2 * inner - 1 + (1 - inner) ** 2 * log / inner) / inner
    H_slope = 2 + (1 - inner) / inner * (1 - log * (1 + inner) / inner)  # by S
    series = polynomial.polyval(small, SERIES_OF_HOOP)
    series_slope = polynomial.polyval(
        small, SERIES_OF_HOOP * np.arange(SERIES_OF_HOOP.size)
    )  # times S
    return ClosedForms(
        S,
        c**2,
        as_floats(np.where(S < SERIES_END, series, h)),
        -2 * S * c**2,
        as_floats(c * np.where(S < SERIES_END, series_slope, H_slope - h)),
    )


def persson_peak(b: FloatArray) -> FloatArray:
    """Return Persson's R·p/f at θ = 0, which is that of every pair with β = 0."""
    b2 = b * b
    return as_floats((2 * b / np.sqrt(1 + b2) + np.arcsinh(b) / (b2 * (1 + b2))) / np.pi)


def persson_peak_slope(b: FloatArray) -> FloatArray:
    """Return the slope of `persson_peak` by ln b²."""
    b2 = b * b
    B, log = np.sqrt(1 + b2), np.arcsinh(b) / (b2 * (1 + b2))
    slope = 2 * b / B**3 + 1 / (b * B**3) - log * (2 + 4 * b2) / (1 + b2)
    return as_floats(slope / (2 * np.pi))


def enough_terms(b: float) -> int:
    """Return how many terms an arc of b = tan(ε/2) and all smaller ones need."""
    return _TERMS * (1 + int(b / _B_PER_TERMS))


def glauert(
    b: FloatArray, beta: float, terms: int = _TERMS, g: FloatArray | None = None
) -> Solution:
    """Solve the contact along arcs of b = tan(ε/2) > 0, shape (k,), by Galerkin's method.

    `g` are the coefficients g_nm of a housing. Without β and g it is the closed form:

    >>> b = np.array([0.5, 1.0])
    >>> np.abs(glauert(b, 0.0).h - closed_forms(b**2).h).max() < 1e-12
    np.True_
    """
    v, weights, sines, cosines = _rule(terms)
    y2 = (b[:, None] * np.cos(v)) ** 2
    weight = weights * 2 * b[:, None] * np.sin(v) / (1 + y2)
    m = np.arange(terms)
    moments = weight @ cosines
    products = (moments[:, abs(m[:, None] - m)] - moments[:, m[:, None] + m + 1]) / 2
    total, versine = weight @ sines, (weight * 2 * y2 / (1 + y2)) @ sines
    carried = total - versine  # of cos θ
    system = beta * np.pi * products
    system[:, m, m] -= np.pi**2 / 2 * (2 * m + 1)
    if g is not None:
        n = np.arange(g.shape[0])
        waves = np.empty((n.size, *y2.shape))  # cos nθ by its recurrence
        waves[0], waves[1] = 1, (1 - y2) / (1 + y2)
        for k in n[2:]:
            waves[k] = 2 * waves[1] * waves[k - 1] - waves[k - 2]
        harmonics = (weight * waves) @ sines  # of each term of the pressure
        added = np.tensordot((1 - n[:, None] ** 2) * g, harmonics, 1)
        system += harmonics.transpose(1, 2, 0) @ added.transpose(1, 0, 2)
    by_load, by_shift = np.moveaxis(
        np.linalg.solve(system, -np.stack([(1 - beta) * carried, total], axis=-1)), -1, 0
    )
    A = (1 - np.sum(carried * by_load, axis=1)) / np.sum(carried * by_shift, axis=1)
    coefficients = by_load + A[:, None] * by_shift
    S = b**2 / (1 + b**2)
    return Solution(
        2 * S * A,
        np.sum(coefficients * versine, axis=1) / S,
        np.sum(coefficients * (-1.0) ** m, axis=1),
        as_floats(coefficients),
    )


@lru_cache(maxsize=4)
def _rule(terms: int) -> tuple[FloatArray, ...]:
    """Return nodes v of Gauss's rule, weights doubled for half the range, sin nv and cos 2jv."""
    x, weights = np.polynomial.legendre.leggauss(2 * terms + 80)
    v = (x + 1) * np.pi / 4
    sines = np.sin(np.outer(v, 2 * np.arange(terms) + 1))
    return v, weights * np.pi / 2, sines, np.cos(np.outer(v, 2 * np.arange(2 * terms)))


@dataclass(frozen=True, eq=False)
class Remainder:
    """What β and a housing add to the closed forms, as Chebyshev series in ε from 0 to `top`.

    `top` is beyond the largest arc of every pair with this β. The first six columns of `series` add
    to a and h, to M = π·E*·δ/f + w_j·H − C, and to their derivatives by ε. The last two are the
    largest pressure over Persson's on the same arc, less 1, and its derivative.
    """

    top: float
    series: FloatArray

    def additions(self, angle: FloatArray) -> FloatArray:
        """Return the additions to a, h and M and their derivatives by ε, stacked."""
        return self._at(angle, self.series[:, :6])

    def peak(self, angle: FloatArray) -> FloatArray:
        """Return the largest pressure over Persson's on the same arc, less 1, and its slope."""
        return self._at(angle, self.series[:, 6:])

    def _at(self, angle: FloatArray, series: FloatArray) -> FloatArray:
        """Return the columns of a series at ε, at its end for what is beyond; stacked first."""
        position = np.minimum(2 * angle / self.top - 1, 1.0)
        polynomials = chebyshev.chebvander(np.ravel(position), len(series) - 1)
        return as_floats((series.T @ polynomials.T).reshape(-1, *position.shape))


@dataclass(frozen=True, eq=False)
class Housed(Remainder):
    """The same for one housing, with the aₘ·tan(ε/2) of the pressure, shape (n, terms)."""

    coefficients: FloatArray

    @cached_property
    def whole_to(self) -> float:
        """The angle from which on the pressure would be negative, or 165° if the arc may be longer.

        It is around a soft pin, and around any pin in a hole of a material that keeps its volume.
        """
        angle, p = self._pressures(_ARCS, _ALONG)
        split = p.min(axis=1) < -_NO_PRESSURE * p.max(axis=1)
        closes = _LARGEST_ARC if self.top >= _BEYOND else math.inf
        return min(float(angle[np.argmax(split)]) if split.any() else math.inf, closes)

    @cached_property
    def _peaks(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Angles, the largest pressure over Persson's there, less 1, and its derivative."""
        angle, p = self._pressures(_PEAKS, _PEAKS)
        b = np.tan(np.maximum(angle, 1e-6) / 2)
        ratio = p.max(axis=1) / (b * persson_peak(b)) - 1
        return angle, as_floats(ratio), as_floats(np.gradient(ratio, angle))

    def _pressures(self, arcs: int, along: int) -> tuple[FloatArray, FloatArray]:
        """Return angles, and pressures times tan(ε/2) along half of each arc."""
        position, v = np.linspace(-1, 1, arcs), np.linspace(0, np.pi / 2, along + 1)[1:]
        sines = np.sin(np.outer(2 * np.arange(self.coefficients.shape[1]) + 1, v))
        p = chebyshev.chebval(position, self.coefficients).T @ sines
        return as_floats(self.top * (1 + position) / 2), as_floats(p)

    def peak(self, angle: FloatArray) -> FloatArray:
        """Return the largest pressure over Persson's on the same arc, less 1, and its slope."""
        at, ratio, slope = self._peaks
        width = at[1]
        k = np.minimum((angle / width).astype(np.intp), at.size - 2)
        part, rise = angle / width - k, (ratio[k + 1] - ratio[k]) / width
        above, rate = cubic(part, width, rise, slope[k], slope[k + 1])
        return np.stack([ratio[k] + above, rate])


@lru_cache(maxsize=1024)
def remainder(beta: float) -> Remainder | None:
    """Return the remainder for one β, None for β = 0, where there is none."""
    if beta == 0:
        return None
    if abs(beta) < SMALL_BETA:
        full, factor = remainder(math.copysign(SMALL_BETA, beta)), abs(beta) / SMALL_BETA
        assert full is not None
        return Remainder(full.top, full.series * factor)
    return Remainder(float(largest_angle(abs(beta))), of_beta(beta))


def of_beta(beta: float) -> FloatArray:
    """Return the series of a remainder for one β."""
    top = float(largest_angle(abs(beta)))
    series, solution, b = _series(top, beta, NODES)
    peak = np.zeros((NODES + 1, 2))
    peak[:-1, 0] = fitted(solution.peak / persson_peak(b) - 1)
    peak[:-2, 1] = chebyshev.chebder(peak[:-1, 0]) * 2 / top
    return np.hstack([series, peak])


def largest_angle(beta: FloatArray | float) -> FloatArray:
    """Return an angle beyond the largest arc of every pair with this |β|."""
    # w_i is at least 0 and at least −2β, so that w_i + β is at least |β|.
    return as_floats(2 * np.arccos(np.sqrt(0.9 * estimated_c(beta))))


@lru_cache(maxsize=256)
@on_one_thread()
def housed(beta: float, w_i: float, kernel: Kernel) -> Housed:
    """Return the remainder of a β and a housing, for holes of at least the share w_i."""
    top = _end(beta, w_i, kernel.g)
    for nodes in range(32 if len(kernel.g) < 30 else 48, _MOST_NODES + 1, 16):
        series, solution, b = _series(top, beta, nodes, kernel)
        values, last = np.abs(series[:, :2]), np.abs(series[-5:-2, :2])
        if np.all(last.max(axis=0) < _LAST_TERMS * np.maximum(values.max(axis=0), 1.0)):
            coefficients = fitted(solution.coefficients * b[:, None])
            return Housed(top, series, coefficients)
    rule = "makes a ring so thin that the pin does not touch it along one arc"
    raise InputError("Housing", "R_o", None, rule, "give a larger R_o: 1.3 times the hole, or more")


def _end(beta: float, w_i: float, g: FloatArray) -> float:
    """Return an angle beyond the largest arc in a housing, by at most a few degrees or 165.5°."""
    low, high = 0.0, np.pi
    angle = float(2 * np.arccos(np.sqrt(estimated_c(max(w_i + beta, 1e-6)))))
    for _ in range(40):
        b = np.tan(np.array([angle]) / 2)
        solution = glauert(b, beta, enough_terms(b[0]), g)
        S = np.sin(angle / 2) ** 2
        low, high = (
            (angle, high) if solution.a[0] > w_i * S * (1 + S * solution.h[0]) else (low, angle)
        )
        if high - low < _END_WITHIN or low > _LARGEST_ARC:
            break
        angle = low + (high - low) / 2 if high < np.pi else angle + (np.pi - angle) / 4
    return high if high < _LARGEST_ARC else _BEYOND


def _series(
    top: float, beta: float, nodes: int, kernel: Kernel | None = None
) -> tuple[FloatArray, Solution, FloatArray]:
    """Return the series of a remainder, and the solutions at Chebyshev's nodes of b = tan(ε/2)."""
    position = chebyshev.chebpts1(nodes)
    angle = top * (1 + position) / 2
    b = np.tan(angle / 2)
    g, start = (None, 0.0) if kernel is None else (kernel.g, kernel.h)
    solution, closed = glauert(b, beta, enough_terms(b[-1]), g), closed_forms(b**2)
    series = np.zeros((nodes + 1, 6))
    series[:-1, :2] = fitted(np.stack([solution.a - closed.a, solution.h - closed.h], axis=-1))
    series[:-2, 3:5] = chebyshev.chebder(series[:-1, :2]) * 2 / top
    slopes = as_floats(chebyshev.chebval(position, series[:, 3:5]))
    series[:-1, 5] = fitted(_approach_rate(angle, solution, closed, slopes))
    series[:, 2] = chebyshev.chebint(series[:-1, 5], lbnd=-1) * top / 2
    series[0, 2] += start
    return series, solution, b


def fitted(values: FloatArray) -> FloatArray:
    """Return the Chebyshev series through values at its nodes."""
    nodes = len(values)
    return as_floats(chebyshev.chebfit(chebyshev.chebpts1(nodes), values, nodes - 1))


def estimated_c(share: FloatArray | float) -> FloatArray:
    """Return about cos²(ε/2) of the largest arc for share = w_i + β; exact to 1 % at β = 0.

    For β ≠ 0 it is too small by up to 15 %, that is the arc too large.
    """
    return as_floats(np.sqrt(2 * share) / (1 + 1.17 * np.sqrt(share)))


def _approach_rate(
    angle: FloatArray, solution: Solution, closed: ClosedForms, slopes: FloatArray
) -> FloatArray:
    """Return the derivative by ε of what β adds to M, by reciprocity.

    dM = (1 − 2Â)·dH − (1 − H)·d(2Â), written in a = S·2Â and h = (H − 1)/S so that no digits are
    lost at small arcs, is h·dS + (S − a)·dh + h·da + (1 − 2ah)/S·dS less dS/S.
    """
    x_rate = 2 / np.sin(angle)
    da, dh = solution.a - closed.a, solution.h - closed.h
    return as_floats(
        dh * np.sin(angle) / 2  # dS/dε
        + (closed.S - solution.a) * slopes[1]
        - da * closed.h_slope * x_rate
        + solution.h * slopes[0]
        + dh * closed.a_slope * x_rate
        - 2 * (da * solution.h + closed.a * dh) / np.tan(angle / 2)
    )
