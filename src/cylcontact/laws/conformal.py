"""The reference law for a pin in a hole of any two materials; Persson's is its case of equal ones.

A pin (disk j) is pressed without friction into a hole of nearly its own radius R in an infinite
plate (i), and touches it from −ε to ε. Each takes the share w of the compliance (w_i + w_j = 1,
see `CylinderPair.shares`), and α = w_j − w_i and β are Dundurs' parameters. With φ = f/(E*·ΔR) and
d = δ/ΔR, pressure p in units of f/R, ψ = θ − s and Λ = −ln(2|sin(ψ/2)|), Michell's solution for
the disk and the infinite plate makes the condition of contact on |θ| < ε

    2∫p(s)·[cos ψ·Λ(ψ) + β|sin ψ|(π − |ψ|)/2 − w_j/2]ds + K − (K + L − C)·cos θ = 0,

with K = π/φ and L = π·d/φ. The term of cos θ is a rigid displacement: **two-dimensional bodies have
no absolute approach**, and C is the choice of a datum. The operator 1 + d²/dθ² removes cos θ and
leaves the equation that `cylcontact.laws.glauert` solves, with 2Â = K + w_i·H and H = ∫p dθ. Then

    K = 2Â − w_i·H,    L = M − w_j·H + C,

and 2Â, H and M depend on ε and β alone: **α enters linearly**. For β = 0, with S = sin²(ε/2) and
c = 1 − S, they are

    2Â = c²/S,    H = 2S − c²·ln(c)/S,    M = −ln S + S²/2 + H,

and the pressure is that of Persson (On the Stress Distribution of Cylindrical Elastic Bodies in
Contact, Chalmers 1964; see Ciavarella and Decuzzi, Int. J. Solids Struct. 38 (2001) 4507–4523) at
the same ε. With y = tan(θ/2), b = tan(ε/2), B² = 1 + b² and s² = b² − y²

    R·p/f = 2s/(πB(1 + y²)) + ln((B + s)/(B − s))/(2π·b²B²).

For equal materials w_i = 1/2, and K vanishes where 2 − 2b⁴ = ln(1 + b²), at 84.83°: no load makes
the arc larger.

**Reciprocity.** The kernel is symmetric, so a change of the arc does the same work on the pressure
and the change of the pressure on the displacement: dL = −(1 − H)·dK − K·dH. M therefore follows
from 2Â and H without a quadrature of the logarithmic kernel.

**The search.** K is nearly a linear function of q = c²/S, and exactly q − w_i·H for β = 0, so
Newton's method in q takes three or four steps from any start. No digits are lost at small arcs,
and none near the largest, because load and penetration follow from each other through L alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.laws.adapters import scaled_model
from cylcontact.laws.glauert import Housed, Remainder, estimated_c, housed, persson_peak, remainder
from cylcontact.laws.housing import Housing, Kernel, is_number
from cylcontact.laws.law import BLOCK, LawModel, OverLength, depth_of, require_hole
from cylcontact.support.arrays import (
    BoolArray,
    FloatArray,
    IndexArray,
    as_floats,
    inside_or_nan,
    require,
)
from cylcontact.support.errors import InputError
from cylcontact.support.html_repr import law_html

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


@dataclass(frozen=True)
class Bodies:
    """Bodies of one β: the share w_i of the hole, Dundurs' β, the datum's C, and the housing.

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
        """The series in ε that β and the housing add to 2Â, H and M; None if they add nothing."""
        if self.kernel is None:
            return remainder(self.beta)
        return housed(self.beta, float(np.min(self.w_i)), self.kernel)

    @cached_property
    def last(self) -> Arc:
        """The arc that no load exceeds, where K = 0."""
        c = estimated_c(np.maximum(self.w_i + self.beta, np.sqrt(_LEAST_Q)))
        end = _LEAST_Q if self.remainder is None else _q_of_angle(self.remainder.top)
        return self._root(lambda arc: (arc.k, arc.k_slope), as_floats(c**2 / (1 - c)), end)

    @cached_property
    def ends(self) -> tuple[FloatArray, FloatArray]:
        """φ and d where the pin would leave a housing within the arc, inf where it never does."""
        whole_to = self.remainder.whole_to if isinstance(self.remainder, Housed) else np.inf
        if whole_to >= self.last.angle:
            return as_floats(np.inf), as_floats(np.inf)
        arc = self.arc(_q_of_angle(whole_to))
        phi = np.pi * arc.S / arc.k
        return phi, phi * arc.L / np.pi

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

        return self._one_arc(self._root(miss, K + end, end))

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
        return self._one_arc(self._root(miss, L * each + end, end))

    def compliance(self, d: FloatArray) -> FloatArray:
        """Return π·E*·dδ/df, that is d(φL)/dφ, at the penetration d."""
        b2 = self.arc_of_penetration(d).b2
        arc = self.arc(1 / (b2 * (1 + b2)))  # with the slopes there, not a step before
        return arc.L - arc.L_slope * arc.k / (arc.k_slope - arc.c * arc.k)

    def energy(self, d: FloatArray) -> FloatArray:
        """Return the stored energy over E*·ΔR², φ·(d − H + 1)/2, half the work of the pressure."""
        arc = self.arc_of_penetration(d)
        H = 2 * arc.S + arc.c**2 / arc.S * np.log1p(arc.b2)
        if self.remainder is not None:
            H = H + arc.S * self.remainder.additions(arc.angle)[1]
        phi = np.pi * arc.S / arc.k
        return as_floats(phi / 2 * (phi * arc.L / np.pi + 1 - H))

    def peak(self, phi: FloatArray) -> FloatArray:
        """Return R·p/f at θ = 0 under the load φ."""
        arc = self.arc_of_load(phi)
        peak = persson_peak(np.sqrt(arc.b2))
        return peak if self.remainder is None else peak * (1 + self.remainder.peak(arc.angle))

    def _root(
        self,
        miss: Callable[[Arc], tuple[FloatArray, FloatArray]],
        q: FloatArray,
        end: FloatArray | float,
    ) -> Arc:
        """Return the arc q ≥ `end` where a function that increases with q vanishes, but for slopes.

        `miss` gives it and its slope by ln b², both times S. Where a step of Newton's method leaves
        the bracket, its middle in ln q takes its place.
        """
        low, high = end, _MOST_Q
        for _ in range(_STEPS):
            arc = self.arc(q)
            value, slope = miss(arc)
            low, high = _where(value > 0, low, q), _where(value > 0, q, high)
            new = q + q * (1 + arc.S) * value / slope
            inside = (new >= low) & (new <= high)
            if not inside.all():
                new = _where(inside, new, np.sqrt(low) * np.sqrt(high))
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

    def _one_arc(self, arc: Arc) -> Arc:
        """Return an arc, NaN where the pin would leave a housing within it."""
        if not isinstance(self.remainder, Housed):
            return arc
        whole = arc.angle <= self.remainder.whole_to
        return Arc(*(as_floats(np.where(whole, value, np.nan)) for value in arc))


def _where(condition: Any, one: Any, other: Any) -> Any:
    """Return `np.where`, for single numbers at a tenth of its cost."""
    return (one if condition else other) if condition.ndim == 0 else np.where(condition, one, other)


def _q_of_angle(angle: FloatArray | float) -> FloatArray:
    """Return (1 − S)²/S of the arc from −`angle` to `angle` in radians."""
    return as_floats((np.cos(as_floats(angle) / 2) ** 2 / np.sin(as_floats(angle) / 2)) ** 2)


Datum = Literal["johnson"] | float | Housing


@dataclass(frozen=True)
class Conformal(OverLength):
    """A pin in a hole of any two materials: the reference law, exact for large arcs as well.

    δ = f·L/(π·E*) and f = π·E*·ΔR/K, with the semi-angle ε of the contact as parameter. For two
    bodies of β = 0, with S = sin²(ε/2), w_i and w_j the shares of hole and pin in the compliance
    and H = 2S − (1 − S)²·ln(1 − S)/S,

        K = (1 − S)²/S − w_i·H,    L = −ln S + S²/2 + w_i·H + C.

    For β ≠ 0 a series of Glauert's adds to K, L and H what depends on ε and β. δ/ΔR depends
    on f/(E*·ΔR), α, β and C alone. The law has no largest load.

    Parameters
    ----------
    datum : "johnson", float or Housing
        Where the penetration is counted from. A plane body has no absolute approach, and δ is
        known up to C·f/(π·E*). "johnson" is C = 2·ln 2 − 2 + w_j, with which δ tends to Johnson's
        law at small loads; a number is C itself; a `Housing` is clamped on its rim, and its
        compliance is part of the law.

    Raises
    ------
    InputError
        If the datum is unknown; when the law is evaluated, if the contact is external, or the
        datum makes the penetration decrease with the load.

    Notes
    -----
    The pressure is that of Persson (1964) for β = 0. Ciavarella and Decuzzi (Int. J. Solids
    Struct. 38 (2001) 4507–4523) treat unlike bodies. `cylcontact.laws.conformal` derives the law.
    Plane strain, or plane stress if the pair says so. ΔR is small beside the radii, and there is no
    friction.

    Relative errors are those of rounding for β = 0. For other pairs they are below 1e-11 in load,
    penetration, stiffness and angle, and below 1e-9 in the largest pressure, against four times
    the terms over every possible (α, β); for |β| < 1e-5 and arcs beyond 172.7°, which only a pin
    1e5 times softer than the plate reaches, below 1e-7. No ratio of the moduli is too large.

    In a housing of at least 1.3 times the hole's radius they are below 1e-9, and below 1e-4 in the
    largest pressure, which leaves the line of the load in thin eyes. Where the pin would leave a
    thin eye between two places of contact, the answer is NaN. Each β costs 0.02 s once, each
    housing as much with its whole rim clamped, about 0.1 s with a sector.

    Examples
    --------
    A steel pin in an aluminium plate, and in a lug of twice the hole's radius that is clamped on
    its rim, the pin under a body force:

    >>> from cylcontact import CylinderPair, Material, laws
    >>> steel, aluminium = Material("steel", 207e3, 0.3), Material("aluminium", 70e3, 0.33)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.99, material=aluminium, material_j=steel)
    >>> law, joint = Conformal(), Conformal(datum=Housing(R_o=20.0))
    >>> f = pair.E_star * pair.dR
    >>> print(f"{law.penetration(f, pair) / pair.dR:.6f}, {law.contact_angle(f, pair):.5f} degrees")
    0.655212, 50.50110 degrees
    >>> print(f"{joint.penetration(f, pair) / pair.dR:.6f}")
    0.577766
    """

    datum: Datum = "johnson"
    name: ClassVar[str] = "conformal"
    contacts: ClassVar[tuple[Contact, ...]] = ("internal",)

    def _repr_html_(self) -> str:
        return law_html(self)

    def __post_init__(self) -> None:
        known = self.datum == "johnson" if isinstance(self.datum, str) else is_number(self.datum)
        known = known or isinstance(self.datum, Housing)
        rule = "must be 'johnson', a finite number C or a Housing"
        remedy = "e.g. datum=laws.Housing(R_o=20.0)"
        require(known, type(self).__name__, "datum", self.datum, rule, remedy)

    @classmethod
    def models(cls) -> tuple[LawModel, ...]:
        """Return none: a fit on equal bodies would try the same curve as Persson's twice."""
        return ()

    def constant(self, pair: CylinderPair) -> FloatArray:
        """Return C, which is π·E*·δ/f's additive constant, for a pair."""
        if isinstance(self.datum, Housing):
            return self.datum.constant(pair)
        johnson = isinstance(self.datum, str)
        return as_floats(2 * np.log(2) - 2 + pair.shares[1] if johnson else self.datum)

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm."""
        f = as_floats(load)
        touching, phi = in_units_of(self.load_unit(pair), f)
        L = self._each(lambda bodies, phi: self._checked(bodies).arc_of_load(phi).L, phi, pair)
        return inside_or_nan(f / (np.pi * pair.E_star) * L, touching)

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        delta = depth_of(penetration)
        touching, d = in_units_of(self.load_unit(pair) / pair.E_star, delta)
        L = self._each(lambda bodies, d: self._checked(bodies).arc_of_penetration(d).L, d, pair)
        return inside_or_nan(np.pi * pair.E_star * (delta / L), touching)

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm² at `penetration` in mm; 0 at first touch."""
        delta = depth_of(penetration)
        touching, d = in_units_of(self.load_unit(pair) / pair.E_star, delta)
        compliance = self._each(lambda bodies, d: self._checked(bodies).compliance(d), d, pair)
        stiffness = np.pi * pair.E_star / compliance
        return inside_or_nan(np.where(delta == 0, 0.0, stiffness), touching)

    def energy(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the stored elastic energy per unit length in N, ∫f dδ up to `penetration` in mm.

        It is half the work of the pressure, f·(δ − ΔR·∫(1 − cos θ)·p dθ)/2 with p in f/R.
        """
        delta, unit = depth_of(penetration), self.load_unit(pair) * as_floats(pair.dR)
        touching, d = in_units_of(self.load_unit(pair) / pair.E_star, delta)
        energy = self._each(lambda bodies, d: self._checked(bodies).energy(d), d, pair)
        return inside_or_nan(np.where(delta == 0, 0.0, unit * energy), touching)

    def require_pair(self, pair: CylinderPair) -> None:
        """Raise `InputError` for external contact."""
        require_hole(type(self).__name__, pair)

    def require_datum(self, pair: CylinderPair) -> None:
        """Raise `InputError` if the datum makes the penetration of a pair decrease."""
        if self.datum != "johnson":
            self._each(lambda bodies, _: self._checked(bodies).last.L, as_floats(0.0), pair)

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return inf, but the load in N/mm at which the pin leaves a thin eye within the arc."""
        return self._end(0, self.load_unit(pair), pair)

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return inf, but the penetration in mm at `max_load` where there is one."""
        return self._end(1, self.load_unit(pair) / pair.E_star, pair)

    def load_unit(self, pair: CylinderPair) -> FloatArray:
        """Return E*·ΔR in N/mm; raise `InputError` for a pair that the law is not for."""
        self.require_pair(pair)
        return pair.E_star * as_floats(pair.dR)

    def contact_angle(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the semi-angle ε of the contact arc in degrees under `load` in N/mm.

        It stays below a limit angle at any load: 72.35° for a rigid pin, 84.83° for equal bodies,
        180° for a rigid plate and β = 0.
        """
        touching, phi = in_units_of(self.load_unit(pair), as_floats(load))
        angle = self._each(lambda bodies, phi: bodies.arc_of_load(phi).angle, phi, pair)
        return inside_or_nan(np.where(phi == 0, 0.0, np.degrees(angle)), touching)

    def peak_pressure(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the largest pressure in MPa under `load` in N/mm.

        It is on the line of the load, but in thin eyes, which press on the pin from both sides.
        The radii must be known. The theory makes no difference between them; R here is √(R_i·R_j),
        so that small loads give exactly Hertz's pressure.
        """
        f = as_floats(load)
        touching, phi = in_units_of(self.load_unit(pair), f)
        R_i, R_j = pair.radii("the contact pressure")
        peak = self._each(Bodies.peak, phi, pair)
        return inside_or_nan(f / np.sqrt(R_i * R_j) * peak, touching)

    def _end(self, which: int, unit: FloatArray, pair: CylinderPair) -> FloatArray:
        """Return where a law ends in a housing, φ or d, in its unit."""
        if not isinstance(self.datum, Housing):
            return as_floats(np.full_like(unit, np.inf))
        return unit * self._each(lambda bodies, _: bodies.ends[which], unit, pair)

    def _each(
        self,
        answer: Callable[[Bodies, FloatArray], FloatArray],
        numbers: FloatArray,
        pair: CylinderPair,
    ) -> FloatArray:
        """Return `answer` of numbers that broadcast against a pair, by β and housing."""
        w_i, beta = pair.shares[0], pair.beta.round(15)  # rounding makes no other β
        which: IndexArray = np.array(0)
        kernels: Sequence[Kernel | None] = [None]
        if isinstance(self.datum, Housing):
            which, kernels = self.datum.kernels(pair)
        parts = numbers, w_i, beta, self.constant(pair), which
        if all(part.size == 1 for part in parts[1:]):
            bodies = _bodies(*(part.item() for part in parts[1:4]), kernels[0])
            if not any(part.ndim for part in parts):
                return answer(bodies, numbers)
            results = np.empty(np.broadcast_shapes(*(part.shape for part in parts)))
            flat, filled = np.broadcast_to(numbers, results.shape).ravel(), results.reshape(-1)
            for first in range(0, flat.size, BLOCK):
                block = slice(first, first + BLOCK)
                filled[block] = answer(bodies, flat[block])
            return results
        numbers, w_i, beta, C, which = np.broadcast_arrays(*parts)
        results = np.empty(numbers.shape)
        for value, k in np.unique(np.stack([beta.ravel(), which.ravel()]), axis=1).T:
            here = (beta == value) & (which == k)
            bodies = Bodies(w_i[here], float(value), C[here], kernels[int(k)])
            results[here] = answer(bodies, numbers[here])
        return results

    def _checked(self, bodies: Bodies) -> Bodies:
        """Return the bodies; raise `InputError` if δ decreases with the load at the last arc."""
        least = bodies.last.L
        if not (least > 0).all():
            rule = "makes the penetration decrease at large loads"
            remedy = f"this pair needs C > {np.max(bodies.C - least):.6g}"
            raise InputError(type(self).__name__, "datum", self.datum, rule, remedy)
        return bodies


@dataclass(frozen=True)
class Persson(Conformal):
    """The reference law for a pin in a hole, exact for large contact arcs as well.

    δ = f·Z(u)/(π·E*) with u = tan²(ε/2) from f/(E*·ΔR) = 2π·u(1 + u)/(2 − 2u² − ln(1 + u)) and

        Z = ln(4(1 + u)/u) − 2/(1 + u) + 1/(2(1 + u)²) + ln(1 + u)/(2u(1 + u)).

    δ/ΔR depends on f/(E*·ΔR) alone. The law has no largest load: it tends to Johnson's law at small
    loads and to the straight line f = π·E*·δ/1.43048 at large ones.

    Raises
    ------
    InputError
        When the law is evaluated, if the contact is external or the materials differ.

    Notes
    -----
    Persson (1964) gives the load and the pressure for two bodies of the same E and ν, without
    friction, in an infinite plate; Z follows by reciprocity. It is `Conformal` for bodies of one
    material, with Johnson's datum: differences between this law and Johnson's are due to conformity
    alone. Load and penetration are inverted to a few units in the last place, for every positive
    number.

    Examples
    --------
    Johnson's penetration is 10 % too low at f/(E*·ΔR) = 0.37:

    >>> from cylcontact import CylinderPair, Material, laws
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.from_dR("internal", dR=0.01, material=steel)
    >>> f = 0.37 * pair.E_star * pair.dR
    >>> ratio = laws.Johnson().penetration(f, pair) / Persson().penetration(f, pair)
    >>> print(f"{f:.1f} N/mm: {100 * (ratio - 1):.2f} %")
    420.8 N/mm: -10.00 %
    """

    datum: Datum = field(default="johnson", init=False, repr=False)
    name: ClassVar[str] = "persson"

    @classmethod
    def models(cls) -> tuple[LawModel, ...]:
        """Return how the law is fitted: by factors of modulus and clearance."""
        return (scaled_model(cls()),)

    def require_pair(self, pair: CylinderPair) -> None:
        """Raise `InputError` for external contact or bodies of different materials."""
        law = "Persson's law"
        require_hole(law, pair)
        rule = "must have the same E and ν as material_i, or the solution does not hold"
        remedy = "give a pair of one material, or use laws.Conformal()"
        other = pair.material_j.name
        require(pair.of_one_material, law, "pair.material_j", other, rule, remedy)


def pressure(angle: ArrayLike, load: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return the pressure in MPa at `angle` in radians from the line of the load in N/mm.

    Persson's for a pair of one material, 0 outside the contact. R is √(R_i·R_j), so that small
    loads give exactly Hertz's peak pressure √(f·E*·ΔR/(π·R_i·R_j)) (Eq 7).

    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.99, material=steel)
    >>> print(pressure(np.radians([-20.0, 0.0, 20.0, 80.0]), 1000.0, pair).round(2))
    [75.32 83.25 75.32  0.  ]
    """
    f = as_floats(load)
    touching, phi = in_units_of(Persson().load_unit(pair), f)
    R_i, R_j = pair.radii("the contact pressure")
    b2 = Persson()._each(lambda bodies, phi: bodies.arc_of_load(phi).b2, phi, pair)
    # NaN for an infinite angle, or an infinite load outside the contact.
    with np.errstate(invalid="ignore"):
        p = f / np.sqrt(R_i * R_j) * persson_pressure(np.tan(as_floats(angle) / 2), b2)
    return inside_or_nan(p, touching)


def persson_pressure(y: FloatArray, b2: FloatArray) -> FloatArray:
    """Return R·p/f at y = tan(θ/2) on the arc of b² = tan²(ε/2) for β = 0; zero outside it."""
    b, B = np.sqrt(b2), np.sqrt(1 + b2)
    s = np.sqrt(np.maximum((b - y) * (b + y), 0.0))
    even = 2 * s / (np.pi * B * (1 + y**2))
    return as_floats(even + np.arctanh(s / B) / (np.pi * b2 * (1 + b2)))


def in_units_of(unit: FloatArray, values: FloatArray) -> tuple[BoolArray, FloatArray]:
    """Return where loads or penetrations are not negative, and their values in units of `unit`."""
    touching = np.asarray(values >= 0)
    with np.errstate(over="ignore"):
        return touching, as_floats(np.where(touching, values, 0.0) / unit)


@lru_cache(maxsize=1024)
def _bodies(w_i: float, beta: float, C: float, kernel: Kernel | None = None) -> Bodies:
    """Return two bodies, whose last arc is sought once."""
    return Bodies(as_floats(w_i), beta, as_floats(C), kernel)
