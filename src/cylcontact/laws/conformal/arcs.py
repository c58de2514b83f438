"""Contact along one arc: its load and penetration, and the search for the arc of either.

K is nearly a linear function of q = (1 − S)²/S, and exactly q − w_i·H for β = 0, so Newton's
method in q takes three or four steps from any start. No digits are lost at small arcs, and none
near the largest, because load and penetration follow from each other through L alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from cylcontact.laws.conformal.housings import Kernel
from cylcontact.laws.conformal.series import (
    Housed,
    Remainder,
    closed_forms,
    estimated_c,
    housed,
    persson_peak,
    persson_peak_slope,
    remainder,
)
from cylcontact.support.arrays import FloatArray, as_floats, require

# A step of Newton's method of this relative size is the last, because it leaves its square.
_STEPS, _LAST_STEP = 100, 1e-8
# Used instead of zero and infinity for φ and d, and the largest and the smallest arc.
_TINY, _SMALL, _HUGE = 1e-307, 1e-300, 1e300
_LEAST_Q, _MOST_Q = 1e-70, 1e308


class Arc(NamedTuple):
    """A contact arc: b² = tan²(ε/2), S, c = 1 − S, k = S·K and L; slopes are by ln b²."""

    b2: FloatArray
    S: FloatArray
    c: FloatArray
    k: FloatArray
    k_slope: FloatArray
    L: FloatArray
    L_slope: FloatArray

    @property
    def angle(self) -> FloatArray:
        """The semi-angle ε in radians."""
        return as_floats(2 * np.arctan(np.sqrt(self.b2)))

    @property
    def q(self) -> FloatArray:
        """(1 − S)²/S, by which arcs are sought."""
        return as_floats(self.c**2 / self.S)

    @property
    def phi(self) -> FloatArray:
        """The load φ = f/(E*·ΔR)."""
        return as_floats(np.pi * self.S / self.k)

    @property
    def phi_slope(self) -> FloatArray:
        """The slope of ln φ by ln b²."""
        return as_floats(self.c - self.k_slope / self.k)


@dataclass(frozen=True, eq=False)
class Bodies:
    """A hole's share w_i of the compliance, Dundurs' β, the datum's C, and a housing.

    Without a housing each element may have its own w_i and C; `many` is for elements of other β.

    The largest arcs of a rigid pin, equal bodies, and a hole of three times the pin's modulus:

    >>> bodies = Bodies(np.array([1.0, 0.5, 0.25]), beta=0.0, C=np.float64(0.0))
    >>> print(np.degrees(bodies.last.angle).round(2))
    [72.35 84.83 96.64]
    """

    w_i: FloatArray
    beta: float
    C: FloatArray
    kernel: Kernel | None = None

    @cached_property
    def remainder(self) -> Remainder | None:
        """What β and the housing add to 2Â, H and M; None if they add nothing."""
        if self.kernel is not None:
            return housed(self.beta, float(self.w_i), self.kernel)
        return remainder(self.beta)

    @cached_property
    def last(self) -> Arc:
        """The arc that no load exceeds, where K = 0."""
        c = estimated_c(np.maximum(self.w_i + self.beta, np.sqrt(_LEAST_Q)))
        end = _LEAST_Q if self.remainder is None else _q_of_angle(self.remainder.top)
        return self._root(lambda arc: (arc.k, arc.k_slope), as_floats(c**2 / (1 - c)), end)

    @cached_property
    def end(self) -> tuple[float, float]:
        """φ and d where the law of a housing ends, inf where it does not."""
        whole_to = self.remainder.whole_to if isinstance(self.remainder, Housed) else np.inf
        if np.all(whole_to >= self.last.angle):
            return np.inf, np.inf
        arc = self.arc(_q_of_angle(whole_to))
        return float(arc.phi), float(arc.phi * arc.L / np.pi)

    def require_increasing(self) -> None:
        """Raise `InputError` if the datum makes δ decrease with the load at the last arc."""
        require_increasing(self.last.L, self.C)

    def arc(self, q: FloatArray) -> Arc:
        """Return the arc with (1 − S)²/S = 1/(b²(1 + b²)) = q."""
        b2 = 2 / (q * (1 + np.sqrt(1 + 4 / q)))
        c = 1 / (1 + b2)
        S, cc, fall = b2 * c, c * c, np.log1p(b2)  # fall = −ln c
        part = q * fall
        H = 2 * S + part
        H_slope = c * (2 * S + c - 2 * c * fall - part)
        k = cc - self.w_i * (S * H)
        k_slope = -2 * S * cc - self.w_i * (S * (c * H + H_slope))
        L = fall - np.log(b2) + S * S / 2 + self.w_i * H + self.C
        L_slope = c * (S * S - 1) + self.w_i * H_slope
        if self.remainder is not None:
            b = np.sqrt(b2)
            rate = b * c  # dε/dln b²
            a, h, M, a_rate, h_rate, M_rate = self.remainder.additions(2 * np.arctan(b))
            H, H_slope = S * h, S * (c * h + rate * h_rate)
            k = k + a - self.w_i * (S * H)
            k_slope = k_slope + rate * a_rate - self.w_i * (S * (c * H + H_slope))
            L = L + M - (1 - self.w_i) * H
            L_slope = L_slope + rate * M_rate - (1 - self.w_i) * H_slope
        return Arc(b2, S, c, k, k_slope, L, L_slope)

    def arc_of_load(self, phi: FloatArray) -> Arc:
        """Return the arc under the load φ = f/(E*·ΔR) ≥ 0, where K = π/φ."""
        K, end = np.pi / np.minimum(np.maximum(phi, _TINY), _HUGE), self.last.q

        def miss(arc: Arc) -> tuple[FloatArray, FloatArray]:
            return arc.k - arc.S * K, arc.k_slope - arc.c * arc.k

        return self._root(miss, K + end, end)

    def arc_of_penetration(self, d: FloatArray) -> Arc:
        """Return the arc at the penetration d = δ/ΔR ≥ 0, where d·K = L.

        The start is exact for small and large d, where L tends to ln(L/d) and to a constant.
        """
        each = 1 / np.minimum(np.maximum(d, _SMALL), _HUGE)

        def miss(arc: Arc) -> tuple[FloatArray, FloatArray]:
            part = arc.S * each
            return arc.k - part * arc.L, arc.k_slope - arc.c * arc.k - part * arc.L_slope

        end, least = self.last.q, self.last.L
        small = self.C + self.w_i + (0.0 if self.kernel is None else self.kernel.h)
        each_of_L = np.exp(np.minimum(small - least, 10.0)) * each
        L = least + np.log1p(each_of_L * (least + np.log1p(2.7 * each_of_L)))
        return self._root(miss, L * each + end, end)

    def with_slopes(self, arc: Arc) -> Arc:
        """Return an arc that was sought with its slopes, which are those of a step before."""
        return self.arc(as_floats(1 / (arc.b2 * (1 + arc.b2))))

    def hoop(self, arc: Arc) -> FloatArray:
        """Return (H − 1)/S."""
        h = closed_forms(arc.b2).h
        return (
            h if self.remainder is None else as_floats(h + self.remainder.additions(arc.angle)[1])
        )

    def work(self, arc: Arc) -> FloatArray:
        """Return the stored energy U over φ·d, (1 − (H − 1)/d)/2, half the work of the pressure."""
        return as_floats((1 - arc.k * self.hoop(arc) / arc.L) / 2)

    def pressure(self, arc: Arc) -> tuple[FloatArray, FloatArray]:
        """Return the largest R·p/f, and its slope by ln b²."""
        b = np.sqrt(arc.b2)
        peak, slope = persson_peak(b), persson_peak_slope(b)
        if self.remainder is None:
            return peak, slope
        more, rate = self.remainder.peak(arc.angle)
        return peak * (1 + more), slope * (1 + more) + peak * rate * (b * arc.c)

    # --- what a curve gives as well -----------------------------------------------------------

    def load(self, d: FloatArray) -> FloatArray:
        """Return φ at d."""
        return as_floats(np.pi * d / self.arc_of_penetration(d).L)

    def penetration(self, phi: FloatArray) -> FloatArray:
        """Return d under φ."""
        return as_floats(phi * self.arc_of_load(phi).L / np.pi)

    def stiffness(self, d: FloatArray) -> FloatArray:
        """Return dφ/dd at d."""
        arc = self.with_slopes(self.arc_of_penetration(d))
        return as_floats(np.pi / (arc.L + arc.L_slope / arc.phi_slope))

    def energy(self, d: FloatArray) -> FloatArray:
        """Return the stored energy over E*·ΔR² at d."""
        arc = self.arc_of_penetration(d)
        return as_floats(arc.phi * arc.phi * arc.L / np.pi * self.work(arc))

    def angle(self, phi: FloatArray) -> FloatArray:
        """Return ε in radians under φ."""
        return self.arc_of_load(phi).angle

    def peak(self, phi: FloatArray) -> FloatArray:
        """Return the largest R·p/f under φ."""
        return self.pressure(self.arc_of_load(phi))[0]

    # --- the search ---------------------------------------------------------------------------

    def _root(
        self,
        miss: Callable[[Arc], tuple[FloatArray, FloatArray]],
        q: FloatArray,
        end: FloatArray | float,
    ) -> Arc:
        """Return the arc q ≥ `end` where an increasing function of q vanishes, without its slopes.

        `miss` gives it and its slope by ln b², both times S. Where a step of Newton's method leaves
        the bracket, its middle in ln q takes its place.
        """
        low, high = as_floats(end), as_floats(_MOST_Q)
        for _ in range(_STEPS):
            arc = self.arc(q)
            value, slope = miss(arc)
            low, high = np.where(value > 0, low, q), np.where(value > 0, q, high)
            new = q + q * (1 + arc.S) * value / slope
            inside = (new >= low) & (new <= high)
            if not inside.all():
                new = np.where(inside, new, np.sqrt(low) * np.sqrt(high))
            if (abs(new - q) <= _LAST_STEP * q).all():
                break
            q = new
        step = (q - new) / (q * (1 + arc.S))  # in ln b²; its square is below rounding
        return arc._replace(
            b2=arc.b2 * (1 + step),
            S=arc.S * (1 + arc.c * step),
            c=arc.c * (1 - arc.S * step),
            k=arc.k + arc.k_slope * step,
            L=arc.L + arc.L_slope * step,
        )


def require_increasing(least: FloatArray, C: FloatArray) -> None:
    """Raise `InputError` if L is not positive at the last arc, where it is `least`."""
    rule = "makes the penetration decrease at large loads"
    remedy = f"this pair needs C > {np.max(C - least):.6g}"
    require(least > 0, "Conformal", "datum", np.ravel(C)[0], rule, remedy)


def _q_of_angle(angle: FloatArray | float) -> FloatArray:
    """Return (1 − S)²/S of the arc from −`angle` to `angle` in radians."""
    return as_floats((np.cos(as_floats(angle) / 2) ** 2 / np.sin(as_floats(angle) / 2)) ** 2)
