"""What unlike materials add to the closed forms for a pin in a hole, by Glauert's series.

With p the pressure in units of f/R and β Dundurs' second parameter (`CylinderPair.beta`), contact
without friction along |θ| < ε means (Ciavarella and Decuzzi, Int. J. Solids Struct. 38 (2001)
4507–4523; derived in `cylcontact.laws.unlike`)

    ⨍ p(s)/(4·sin²((θ − s)/2)) ds + βπ·p(θ) + (1 − β)·cos θ + Â = 0,    ∫ p·cos θ dθ = 1,

with the finite part of the integral. In y = tan(θ/2) this is Prandtl's equation of the lifting
line, and Glauert's series solves it: p = Σ aₘ·sin nv with n = 2m + 1, y = b·cos v, b = tan(ε/2).
The first term of the equation turns sin nv into −πn·(1 + y²)/(2b)·sin nv/sin v.

**Galerkin instead of collocation.** Weighted with sin kv over dθ = W dv, W = 2b·sin v/(1 + y²), the
system is symmetric: −π²n/2 on the diagonal and βπ∫sin nv·sin kv·W dv. For β ≠ 0 the pressure has
a term v³·ln v at the edge, so aₘ ~ m⁻⁴ and collocation converges slowly. In the symmetric form the
error of Â and H is the square of the error of p. 64 terms give them to 1e-12 where collocation
gives 1e-8.

**Reciprocity** (see `cylcontact.laws.unlike`) gives the penetration from Â and H alone, without a
quadrature of the logarithmic kernel.

`remainder` holds the difference to the closed forms of β = 0 for one β as Chebyshev series in ε.
All of its functions are analytic at ε = 0; their singularity at 180° is beyond the largest arc of
that β.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from cylcontact.arrays import FloatArray, as_floats

__all__ = [
    "X_TOP",
    "ClosedForms",
    "Remainder",
    "Solution",
    "closed_forms",
    "enough_terms",
    "estimated_c",
    "glauert",
    "persson_peak",
    "remainder",
]

# Terms of the series, as many again for each 8 of b (large arcs need a small β), and nodes in ε.
_TERMS, _B_PER_TERMS = 96, 8.0
_NODES = 24
# ln b² at the end of every search: arcs of all but a relative 1e-17 of 180°.
X_TOP = 80.0
# Below this the remainder is proportional to β: what is of second order in β is below 1e-10.
_SMALL_BETA = 1e-5
# Terms of the power series in S, and where they are better than the closed form.
_SERIES, _SERIES_END = 12, 0.1


class Solution(NamedTuple):
    """The contact along arcs: S·2Â, (H − 1)/S with H = ∫p dθ, and the pressure at θ = 0.

    `coefficients`, shape (k, terms), are the aₘ of the pressure.
    """

    a: FloatArray
    h: FloatArray
    peak: FloatArray
    coefficients: FloatArray


class ClosedForms(NamedTuple):
    """The same for β = 0 with derivatives by x = ln b², and S = sin²(ε/2), c = 1 − S."""

    S: FloatArray
    c: FloatArray
    a: FloatArray
    h: FloatArray
    a_slope: FloatArray
    h_slope: FloatArray


def closed_forms(b2: FloatArray) -> ClosedForms:
    """Return the solution for β = 0 at b² = tan²(ε/2): a = c² and H = 2S − c²·ln(c)/S.

    Below S = 0.1 (H − 1)/S and its slope are summed as power series, Σ 2Sⁿ⁻¹/((n − 1)n(n + 1))
    beside 1/2, because the closed form loses digits.

    Examples
    --------
    >>> print(closed_forms(np.array([1e-30, 1.0])).h.round(6))
    [0.5      0.693147]
    """
    c = 1 / (1 + b2)
    S = b2 * c
    series, series_slope = _h_series(np.minimum(S, _SERIES_END))
    inner = np.maximum(S, _SERIES_END)
    log = np.log1p(np.maximum(b2, _SERIES_END))  # -ln c
    H_less_1 = 2 * inner - 1 + (1 - inner) ** 2 * log / inner
    H_slope = 2 + (1 - inner) / inner * (1 - log * (1 + inner) / inner)  # by S
    h = np.where(S < _SERIES_END, series, H_less_1 / inner)
    h_slope = np.where(S < _SERIES_END, c * series_slope, c * (H_slope - h))
    return ClosedForms(S, c, c**2, h, -2 * S * c**2, h_slope)


def _h_series(S: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return (H − 1)/S for β = 0 as a power series in S, and S times its derivative."""
    n = np.arange(2, _SERIES + 2)
    terms = np.concatenate([[0.5], 2 / ((n - 1.0) * n * (n + 1))])
    slopes = terms * np.arange(terms.size)
    return (
        as_floats(np.polynomial.polynomial.polyval(S, terms)),
        as_floats(np.polynomial.polynomial.polyval(S, slopes)),
    )


def persson_peak(b: FloatArray) -> FloatArray:
    """Return Persson's R·p/f at θ = 0, which is that of every pair with β = 0."""
    b2 = b * b
    return as_floats((2 * b / np.sqrt(1 + b2) + np.arcsinh(b) / (b2 * (1 + b2))) / np.pi)


def enough_terms(b: float) -> int:
    """Return how many terms an arc of b = tan(ε/2) and all smaller ones need."""
    return _TERMS * (1 + int(b / _B_PER_TERMS))


def glauert(b: FloatArray, beta: float, terms: int = _TERMS) -> Solution:
    """Solve the contact along arcs of b = tan(ε/2) > 0, shape (k,), by Galerkin's method.

    Parameters
    ----------
    b : array of float, shape (k,)
        tan(ε/2) of each arc.
    beta : float
        Dundurs' β, as `CylinderPair.beta`.
    terms : int
        The number of terms of the series.

    Returns
    -------
    Solution

    Examples
    --------
    Without β it is the closed form:

    >>> b = np.array([0.5, 1.0])
    >>> np.abs(glauert(b, 0.0).h - closed_forms(b**2).h).max() < 1e-12
    np.True_
    """
    rule = _rule(terms)
    y2 = (b[:, None] * np.cos(rule.v)) ** 2
    weight = rule.weights * 2 * b[:, None] * np.sin(rule.v) / (1 + y2)
    m = np.arange(terms)
    moments = weight @ rule.cosines
    products = (moments[:, abs(m[:, None] - m)] - moments[:, m[:, None] + m + 1]) / 2
    total, versine = weight @ rule.sines, (weight * 2 * y2 / (1 + y2)) @ rule.sines
    carried = total - versine  # of cos θ
    system = beta * np.pi * products
    system[:, m, m] -= np.pi**2 / 2 * (2 * m + 1)
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


class _Rule(NamedTuple):
    """Gauss's rule for the half range of v, doubled, with sin nv and cos 2jv at its nodes."""

    v: FloatArray
    weights: FloatArray
    sines: FloatArray
    cosines: FloatArray


@lru_cache(maxsize=4)
def _rule(terms: int) -> _Rule:
    """Return the rule for a number of terms; 80 nodes more than the sines need are for W."""
    x, weights = np.polynomial.legendre.leggauss(2 * terms + 80)
    v = (x + 1) * np.pi / 4
    sines = np.sin(np.outer(v, 2 * np.arange(terms) + 1))
    return _Rule(v, weights * np.pi / 2, sines, np.cos(np.outer(v, 2 * np.arange(2 * terms))))


@dataclass(frozen=True)
class Remainder:
    """What β adds to the closed forms, as Chebyshev series in ε from 0 to `top`.

    Attributes
    ----------
    top : float
        The end of the series in radians, beyond the largest arc of every pair with this β.
    x_top : float
        The largest ln b² that a search needs.
    series : array of float, shape (n, 4)
        Coefficients of the additions to a and h, and of their derivatives by ε.
    approach_series, peak_series : array of float, shape (n,)
        Those of the addition to M = π·E*·δ/f + w_j·H − C, and to the ratio of the largest pressure
        to Persson's on the same arc.
    """

    top: float
    x_top: float
    series: FloatArray
    approach_series: FloatArray
    peak_series: FloatArray

    def additions(self, angle: FloatArray) -> FloatArray:
        """Return the additions to a and h and their derivatives by ε, stacked."""
        return as_floats(chebyshev.chebval(self._position(angle), self.series))

    def approach(self, angle: FloatArray) -> FloatArray:
        """Return the addition to M."""
        return as_floats(chebyshev.chebval(self._position(angle), self.approach_series))

    def peak(self, angle: FloatArray) -> FloatArray:
        """Return the largest pressure over Persson's on the same arc, less 1."""
        return as_floats(chebyshev.chebval(self._position(angle), self.peak_series))

    def _position(self, angle: FloatArray) -> FloatArray:
        """Return ε on the interval from −1 to 1, its end in place of what is beyond."""
        return as_floats(np.minimum(2 * angle / self.top - 1, 1.0))


@lru_cache(maxsize=1024)
def remainder(beta: float) -> Remainder | None:
    """Return the remainder for one β, None for β = 0, where there is none.

    Examples
    --------
    The series end some degrees beyond the largest arc:

    >>> print(f"{np.degrees(remainder(0.5).top):.1f}")
    90.9
    """
    if beta == 0:
        return None
    if abs(beta) < _SMALL_BETA:
        return _scaled(_built(float(np.copysign(_SMALL_BETA, beta))), abs(beta) / _SMALL_BETA)
    return _built(beta)


@lru_cache(maxsize=1024)
def _built(beta: float) -> Remainder:
    """Return the remainder from the solutions at Chebyshev's nodes."""
    # w_i is at least 0 and at least −2β, so that w_i + β is at least |β|.
    c_top = 0.9 * float(estimated_c(abs(beta)))
    x_top = float(np.log((1 - c_top) / c_top))
    top = float(2 * np.arctan(np.exp(x_top / 2)))
    position = chebyshev.chebpts1(_NODES)
    angle = top * (1 + position) / 2
    b = np.tan(angle / 2)
    solution, closed = glauert(b, beta, enough_terms(b[-1])), closed_forms(b**2)

    def fitted(values: FloatArray) -> FloatArray:
        return as_floats(chebyshev.chebfit(position, values, _NODES - 1))

    series = fitted(np.stack([solution.a - closed.a, solution.h - closed.h], axis=-1))
    slopes = np.zeros_like(series)
    slopes[:-1] = chebyshev.chebder(series) * 2 / top
    slopes_there = as_floats(chebyshev.chebval(position, slopes))
    rate = _approach_rate(angle, solution, closed, slopes_there)
    return Remainder(
        top,
        x_top,
        np.concatenate([series, slopes], axis=1),
        as_floats(chebyshev.chebint(fitted(rate), lbnd=-1) * top / 2),
        fitted(solution.peak / persson_peak(b) - 1),
    )


def estimated_c(share: FloatArray | float) -> FloatArray:
    """Return about cos²(ε/2) of the largest arc for share = w_i + β; exact to 1 % at β = 0.

    For β ≠ 0 it is too small by up to 15 %, that is the arc too large.
    """
    return as_floats(np.sqrt(2 * share) / (1 + 1.17 * np.sqrt(share)))


def _approach_rate(
    angle: FloatArray, solution: Solution, closed: ClosedForms, additions: FloatArray
) -> FloatArray:
    """Return the derivative by ε of what β adds to M, by reciprocity.

    dM = (1 − 2Â)·dH − (1 − H)·d(2Â), written in a = S·2Â and h = (H − 1)/S so that no digits are
    lost at small arcs, is h·dS + (S − a)·dh + h·da + (1 − 2ah)/S·dS less dS/S.
    """
    S, half_sine = closed.S, np.sin(angle) / 2  # of dS/dε
    x_rate = 2 / np.sin(angle)
    a_slope, h_slope = closed.a_slope * x_rate, closed.h_slope * x_rate
    da, dh = solution.a - closed.a, solution.h - closed.h
    product = da * solution.h + closed.a * dh  # the addition to a·h
    return as_floats(
        dh * half_sine
        + (S - solution.a) * additions[1]
        - da * h_slope
        + solution.h * additions[0]
        + dh * a_slope
        - 2 * product / np.tan(angle / 2)
    )


def _scaled(full: Remainder, factor: float) -> Remainder:
    """Return a remainder times a factor, searched as far as the closed forms are."""
    return Remainder(
        full.top,
        X_TOP,
        full.series * factor,
        full.approach_series * factor,
        full.peak_series * factor,
    )
