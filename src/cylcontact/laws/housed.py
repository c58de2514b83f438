"""Laws of a pin in its housing, made once for a joint: a curve of many arcs, and five constants.

At fixed materials and housing δ/ΔR = d is a function of f/(E*·ΔR) = φ alone. The arc, by x = ln b²
with b = tan(ε/2), is the parameter of that curve:

    φ = π/K(x),    d = L(x)/K(x),

with K and L those of `Parametric` and the terms of the housing (`laws.housing.Kernel.compact`), or
of the series where these are not close enough. Nodes at x = x_last − ln(1 + eᵗ), evenly in t, are
even in ln b² for small arcs and in ln K next to the largest one, so no root is sought. Between them
ln φ is a cubic in ln d with the exact slopes; with nodes 0.15 apart its error is below 1e-6.
"""

from __future__ import annotations

from dataclasses import asdict
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws.arcs import CALIBRATED, ParametricCoefficients, arc
from cylcontact.laws.conformal import Bodies
from cylcontact.laws.housing import Housing, Kernel, Sector
from cylcontact.laws.law import AtPair
from cylcontact.laws.tabulated import cubic
from cylcontact.support.arrays import FloatArray, as_floats
from cylcontact.support.errors import InputError

# The nodes in t, and their largest d.
_T = np.arange(80.0, -16.0, -0.15)
_DEEPEST = 1e6
# Relative error in the load up to which five constants stand for a curve.
_CLOSE = 0.01
# Eyes of up to this R_o/R_i are thin.
_THIN = 2.0
# Where the five constants are fitted, and the starts: factors of A, of B, and D.
_PHI = np.geomspace(1e-4, 10.0, 101)
_STARTS = ((1.0, 1.0, 1.5), (0.3, 3.0, 1.0), (3.0, 0.3, 2.0), (1.0, 10.0, 0.0))


class Curve(NamedTuple):
    """ln d, ln φ and dln φ/dln d at nodes, in increasing order."""

    x: FloatArray
    y: FloatArray
    slopes: FloatArray

    def at(self, d: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return φ and dln φ/dln d at d > 0; below the nodes the first power goes on."""
        at = np.log(d)
        low = np.clip(np.searchsorted(self.x, at) - 1, 0, self.x.size - 2)
        width, first, last = np.diff(self.x)[low], self.slopes[low], self.slopes[low + 1]
        part = (at - self.x[low]) / width
        above, slope = cubic(part, width, np.diff(self.y)[low] / width, first, last)
        below = at < self.x[0]
        y = np.where(below, self.y[0] + self.slopes[0] * (at - self.x[0]), self.y[low] + above)
        return as_floats(np.exp(y)), as_floats(np.where(below, self.slopes[0], slope))


class FiveConstants(NamedTuple):
    """c, B, A, G and D of φ = π·d/{c + ln[1 + (B/d)·(ln(1 + A/d + G/√d) + D)]}, and their error.

    The error is the largest of the load relative to the curve, for φ from 1e-4 to 10.
    """

    c: float
    B: float
    A: float
    G: float
    D: float
    error: float

    @property
    def is_close(self) -> bool:
        """Whether the explicit law takes them; otherwise it is the curve itself."""
        return self.error <= _CLOSE


class _Joint(NamedTuple):
    """One pair in a housing: all that its curve depends on."""

    kernel: Kernel
    w_i: float
    beta: float
    C: float
    constants: ParametricCoefficients
    by_series: bool


def needs_series(housing: Housing, pair: CylinderPair) -> bool:
    """Return whether a joint's curve is that of the series, the compact law not being close."""
    return _joint(housing, pair).by_series


def _joint(
    housing: Housing, pair: CylinderPair, constants: ParametricCoefficients = CALIBRATED
) -> _Joint:
    """Return one pair in a housing."""
    _, (kernel, *_) = housing.kernels(pair)
    thin = isinstance(housing.clamp, Sector) and housing.R_o < _THIN * float(pair.R_i or 0.0)
    w_i, beta, C = float(pair.shares[0]), float(pair.beta), float(housing.constant(pair))
    return _Joint(kernel, w_i, beta, C, constants, thin or kernel.needs_series)


def curve_of(
    housing: Housing, pair: CylinderPair, constants: ParametricCoefficients = CALIBRATED
) -> Curve:
    """Return the curve of one pair in a housing."""
    return _curve(_joint(housing, pair, constants))


def series_of(housing: Housing, pair: CylinderPair) -> Curve:
    """Return the curve of one pair in a housing by the series."""
    return _curve(_joint(housing, pair)._replace(by_series=True))


def not_by_itself(housing: Housing) -> InputError:
    """Return the error of a law that is to be exported for any pair."""
    rule = "depends on the radii and the materials"
    remedy = "export a joint with a table [housing], or the law by cylcontact export --R-o"
    return InputError("export", "datum", housing, rule, remedy)


def at_pair(curve: Curve, pair: CylinderPair) -> AtPair:
    """Return the law of a curve at its pair."""
    dR, E_star = as_floats(pair.dR), as_floats(pair.E_star)

    def load(depth: FloatArray) -> FloatArray:
        return as_floats(E_star * dR * curve.at(as_floats(depth / dR))[0])

    def stiffness(depth: FloatArray) -> FloatArray:
        phi, slope = curve.at(as_floats(depth / dR))
        return as_floats(E_star * dR * phi * slope / depth)

    return AtPair(load, stiffness, as_floats(np.exp(curve.x[-1]) * dR), is_single=True)


def table_of(curve: Curve, pair: CylinderPair) -> FloatArray:
    """Return a curve as `laws.tabulated.tabulate` has it: the end, ln δ, ln f and the slopes."""
    x = curve.x + np.log(float(pair.dR))
    y = curve.y + np.log(float(pair.E_star) * float(pair.dR))
    return np.concatenate([np.exp(x[-1:]), x, y, curve.slopes])


@lru_cache(maxsize=64)
def _curve(joint: _Joint) -> Curve:
    """Return the curve from the series, or from the compact law."""
    from scipy.optimize import brentq  # which takes longer to import than the package

    deepest = _DEEPEST
    if joint.by_series:
        bodies = Bodies(as_floats(joint.w_i), joint.beta, as_floats(joint.C), joint.kernel)
        x_last = float(np.log(bodies.last.b2))
        deepest = min(deepest, float(bodies.ends[1]))  # the pin leaves a thin eye within the arc
    else:
        grid = np.linspace(-60.0, 30.0, 361)
        k = _compact(grid, joint)[2]
        first = int(np.argmax(k <= 0))  # K falls to 0 at the largest arc

        def rest(x: float) -> float:
            return float(_compact(np.array([x]), joint)[2][0])

        x_last = float(brentq(rest, grid[first - 1], grid[first], xtol=1e-15))
    x = x_last - np.logaddexp(0.0, _T)
    if joint.by_series:
        b2 = np.exp(x)
        at = bodies.arc(as_floats(1 / (b2 * (1 + b2))))
        S, c, k, k_slope, L, L_slope = at.S, at.c, at.k, at.k_slope, at.L, at.L_slope
    else:
        S, c, k, k_slope, L, L_slope = _compact(x, joint)
    by_arc = c - k_slope / k
    nodes = np.log(L * S / k), np.log(np.pi * S / k), by_arc / (L_slope / L + by_arc)
    count = int(np.searchsorted(nodes[0], np.log(deepest))) + (deepest == _DEEPEST)
    return Curve(*(as_floats(each[:count]) for each in nodes))


def _compact(x: FloatArray, joint: _Joint) -> tuple[FloatArray, ...]:
    """Return S, c, k = S·K, L and the slopes by x of the last two, with the housing's terms."""
    kernel, w_i, beta, C, constants, _ = joint
    own = asdict(constants)
    S, c, k, k_slope, L, L_slope, H, H_slope = arc(x, w_i, 1 - w_i, beta, C, **own)
    gamma, gamma_S, T, T_S = kernel.compact(S)
    rise = S * c  # dS/dx
    k, k_slope = k - S * T, k_slope - rise * (T + S * T_S)
    L = L + 2 * gamma - (H - 1) * T
    L_slope = L_slope + rise * (2 * gamma_S - (H - 1) * T_S) - H_slope * T
    return S, c, k, k_slope, L, L_slope


def five_constants(housing: Housing, pair: CylinderPair) -> FiveConstants:
    """Return the constants that follow the curve of one pair in a housing most closely."""
    return _five(_joint(housing, pair))


@lru_cache(maxsize=64)
def _five(joint: _Joint) -> FiveConstants:
    """Fit the five constants to a curve, by least squares of ln φ from several starts."""
    from scipy.optimize import least_squares

    curve = _curve(joint)
    d = np.exp(np.interp(np.log(_PHI), curve.y, curve.x))
    phi = curve.at(as_floats(d))[0]
    L = np.pi * d / phi  # what the form has to give
    c, scale = float(L[-1]) * 0.98, float(np.exp(L[0] / 2) * np.sqrt(d[0]))

    def miss(p: FloatArray) -> FloatArray:
        c, ln_B, ln_A, G, D = p
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            inner = np.log(1 + np.exp(ln_A) / d + G / np.sqrt(d)) + D
            form = c + np.log1p(np.exp(ln_B) / d * inner)
            return as_floats(np.nan_to_num(np.log(form / L), nan=1.0, posinf=1.0, neginf=1.0))

    best = min(
        (
            least_squares(miss, [c, np.log(scale * by_B), np.log(scale * by_A), -0.5, D])
            for by_A, by_B, D in _STARTS
        ),
        key=lambda fit: float(fit.cost),
    )
    c, ln_B, ln_A, G, D = (float(value) for value in best.x)
    error = float(np.max(np.abs(np.expm1(miss(best.x)))))
    return FiveConstants(c, float(np.exp(ln_B)), float(np.exp(ln_A)), G, D, error)
