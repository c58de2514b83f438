"""Stresses in a housing and its pin under the pressure of the series, and where they first yield.

Lengths are in units of R and stresses in units of f/R; the load acts along θ = 0. The stresses are
those of the infinite plate under the same pressure, which `cylcontact.limits.stress` has exactly,
and a sum over harmonics of what the rim adds. With P_n = ∫p·cos ns ds the bore carries the pressure
P_n/π·cos nθ, half of it for n = 0, and

    σ = σ of the plate + Σ cos nθ·[terms of the ring − terms of the plate].

The ring's are Michell's four terms of `cylcontact.laws.conformal.housings`, for a bore under that
pressure with the rim clamped, and in an eye those of the displacements of its free arc besides,
which are linear in all P_n. The plate's have, for n ≥ 2, the coefficients 1/(2(n − 1)) and
n/(2(n + 1)); so the sum falls like ρ^(−2n) at the bore, where the pressure's own singularities are
in closed form.

The pin's load is balanced by an even body force, whatever the datum of the penetration.

**Where first yield is sought.** In the whole pin and the whole housing, except where a point of the
outer half of its wall is nearer than the wall's thickness to an end of a clamped sector: these ends
are singular, and no elastic stress says when they yield. Thin eyes that are pulled yield on the
bore beside the contact, by bending and hoop tension, or under small loads on the rim above it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws.conformal.arcs import Bodies
from cylcontact.laws.conformal.housings import Housing, Kernel, compliances, michell
from cylcontact.laws.conformal.series import Housed
from cylcontact.laws.law import require_hole
from cylcontact.limits.rings import AtRest
from cylcontact.limits.stress import ComplexArray, PlaneStress, Pressure, in_pin, in_plate
from cylcontact.limits.yield_search import Criterion, FirstYield, equivalent, of_shear
from cylcontact.support.arrays import FloatArray, as_floats, require

Field = Callable[[FloatArray, FloatArray], PlaneStress]
Equivalent = Callable[[FloatArray, FloatArray], FloatArray]

# Points of the search: along half the bore and across a wall, and as many within two and three
# half-widths of the contact; then so many times this many around the largest value.
_ALONG, _THROUGH, _NEAR_ALONG, _NEAR_THROUGH = 33, 13, 17, 13
_PASSES, _FINE = 5, 7
_END, _CENTRE = np.pi - 1e-6, 0.02
# The arcs of the search, 1 − e^−t times the largest, and the accuracy of t: so fine that a result
# does not depend on the bracket from which its search began.
_FIRST, _LAST, _EXACT = 1e-6, 23.0, 1e-12
# With stress at rest: where the scan of the arcs begins, and their number; points along a seat.
_SCAN_FROM, _SCANNED, _ALONG_SEAT = 0.02, 20, 361
# Terms of the pressure are left out from where all are below this part of the largest.
_LEAST = 1e-7


@dataclass(frozen=True, eq=False)
class HousingStress:
    """The stresses in the rings of a housing and in its pin, under the pressure along one arc."""

    kernel: Kernel
    b: float  # tan(ε/2)
    coefficients: FloatArray  # of Glauert's series

    @cached_property
    def pressure(self) -> Pressure:
        """The pressure as an analytic function."""
        return Pressure(np.array([[self.b]]), self.coefficients[:, None, None])

    @cached_property
    def terms(self) -> FloatArray:
        """The coefficients of the terms of each ring, in the first without those of the plate."""
        given = compliances(self.kernel.rings, self.kernel.sector)
        kappa = self.kernel.rings[0].kappa
        count = given.moved.shape[2]
        x, weights = _rule(2 * self.coefficients.size + count)
        v = np.pi / 4 * (1 + x)
        y = self.b * np.cos(v)
        p = np.sin(np.outer(v, 2 * np.arange(self.coefficients.size) + 1)) @ self.coefficients
        p *= np.pi * weights * self.b * np.sin(v) / (1 + y**2)
        n = np.arange(len(given.terms))
        P = np.cos(np.outer(n, 2 * np.arctan(y))) @ p
        bore = P / np.pi * np.where(n == 0, 0.5, 1.0)
        bore[count:] = 0.0  # of which nothing reaches the rim
        terms = given.terms[..., 0] * bore[:, None, None]
        smooth = np.exp(-36.0 * (n / n[-1]) ** 8)  # or the rim's sum would not converge
        moved = given.moved @ P[:count] * smooth[:, None]
        terms += np.einsum("nkji,ni->nkj", given.terms[..., 1:], moved)
        second = np.where(n == 1, -1 / (2 * (kappa + 1)), 1 / (2 * np.maximum(n - 1, 1)))
        fourth = np.where(n == 1, -(kappa - 1) / (4 * (kappa + 1)), n / (2 * (n + 1)))
        second[0], fourth[0] = 0, -1
        terms[:, 0, 1] -= second * bore
        terms[:, 0, 3] -= fourth * bore
        return as_floats(terms)

    def in_ring(self, k: int, r: FloatArray, theta: FloatArray) -> PlaneStress:
        """Return the stresses in ring k at each r and θ, shape (r, θ)."""
        n = np.arange(len(self.terms))
        rows = michell(n, self.kernel.rings[k], r)[..., 2:, :]
        radial, shear, total = np.einsum("rnij,nj->irn", rows, self.terms[:, k])
        even, odd = np.cos(np.outer(n, theta)), np.sin(np.outer(n, theta))
        added = total @ even, (total - 2 * radial) @ even + 2j * (shear @ odd)
        if k > 0:
            return PlaneStress(*added)
        w = np.exp(-1j * theta) / r[:, None]
        plate = in_plate(_eta(w), self.pressure, self.kernel.rings[0].kappa)
        return PlaneStress(*(a.reshape(w.shape) + b for a, b in zip(plate, added, strict=True)))

    def in_pin(self, r: FloatArray, theta: FloatArray) -> PlaneStress:
        """Return the stresses in the pin at each r and θ, shape (r, θ)."""
        w = np.exp(1j * theta) * r[:, None]
        return PlaneStress(*(each.reshape(w.shape) for each in in_pin(_eta(w), self.pressure)))

    def bodies(self) -> Iterator[tuple[Field, FloatArray]]:
        """Yield the stresses of each ring and of the pin, and the radii where they are sought."""
        near = 2 * self.b * np.linspace(0, 1.5, _NEAR_THROUGH)
        through = np.linspace(0, 1, _THROUGH)
        for k, ring in enumerate(self.kernel.rings):
            r = np.append(ring.inner + (ring.outer - ring.inner) * through, ring.inner + near)
            yield partial(self._sought, k), np.unique(np.minimum(r, ring.outer))
        r = 1 - np.append(near, through)
        yield self.in_pin, np.unique(np.maximum(r, _CENTRE))

    def _sought(self, k: int, r: FloatArray, theta: FloatArray) -> PlaneStress:
        """Return the stresses in ring k, none at the ends of a clamped sector."""
        total, difference = self.in_ring(k, r, theta)
        ring, sector = self.kernel.rings[k], self.kernel.sector
        if sector is not None and ring is self.kernel.rings[-1]:
            end = np.radians(sector.angle / 2)
            away = ring.outer * np.abs(theta - (end if sector.side == "pushed" else np.pi - end))
            beyond = r > (ring.inner + ring.outer) / 2
            out = beyond[:, None] & (away < ring.outer - ring.inner)
            total, difference = np.where(out, 0.0, total), np.where(out, 0.0, difference)
        return PlaneStress(total, difference)

    def largest(self, equivalent_at: Equivalent, r: FloatArray) -> tuple[float, float, float]:
        """Return the largest equivalent stress of a body, and r and θ there."""
        near = 2 * np.arctan(self.b * np.linspace(0, 2.03, _NEAR_ALONG))  # not at its very end
        theta = np.unique(np.append(near, np.linspace(0, _END, _ALONG)))
        for _ in range(1 + _PASSES):
            values = equivalent_at(r, theta)
            i, j = divmod(int(np.argmax(values)), theta.size)
            at = float(values[i, j]), float(r[i]), float(theta[j])
            r, theta = (
                np.linspace(x[max(k - 1, 0)], x[min(k + 1, x.size - 1)], _FINE)
                for x, k in ((r, i), (theta, j))
            )
        return at


@lru_cache(maxsize=64)
def _rule(count: int) -> tuple[FloatArray, FloatArray]:
    """Return so many nodes of Gauss's rule, and their weights."""
    return np.polynomial.legendre.leggauss(count)


def _eta(w: ComplexArray) -> ComplexArray:
    """Return the η of points w of the unit disk in one row; rounding may leave its half plane."""
    eta = 1j * (1 - w.reshape(1, -1)) / (1 + w.reshape(1, -1))
    return np.asarray(eta.real + 1j * np.maximum(eta.imag, 0.0))


def first_yield_in(
    housing: Housing,
    pair: CylinderPair,
    stresses: Sequence[ArrayLike],
    criterion: Criterion,
    at_rest: AtRest | None = None,
) -> FirstYield:
    """Return the first yield of a pin in a housing: of its rings, from within, and the pin.

    It is NaN where the pin leaves a thin eye within the arc before anything yields.
    """
    return _searched(housing, pair, stresses, criterion, at_rest, lambda s, _: [s.any()])[0]


def first_yields_in(
    housing: Housing,
    pair: CylinderPair,
    stresses: Sequence[ArrayLike],
    criterion: Criterion,
    at_rest: AtRest | None = None,
) -> list[FirstYield]:
    """Return the first yield of each ring of a housing, from within, and of its pin.

    A body whose yield stress is inf has NaN.
    """
    return _searched(housing, pair, stresses, criterion, at_rest, lambda s, _: s.each())


def seat_opens_in(housing: Housing, pair: CylinderPair, at_rest: AtRest) -> FloatArray:
    """Return the load in N/mm at which a seat between rings, or the rim in its frame, first opens.

    It is inf where no load opens a seat, and no seat counts that is loose at rest.
    """
    stresses = [np.inf] * (len(at_rest.materials) + 1)
    found = _searched(housing, pair, stresses, "von Mises", at_rest, lambda s, _: [s.opens()])[0]
    return as_floats(np.where(np.isnan(found.load), np.inf, found.load))


def largest_hoop_in(
    housing: Housing, pair: CylinderPair, load: float, at_rest: AtRest | None = None
) -> FloatArray:
    """Return the largest σ_θθ in MPa around the hole's own ring under a load in N/mm.

    It is NaN where the pin leaves the housing at a smaller load.
    """
    stresses = [np.inf] * (len(housing.layers) + 2)

    def ask(search: _Search, unit: float) -> list[_Found]:
        return [_Found(search.hoop(load / unit) / unit, 0, 1.0, 0.0)]

    return _searched(housing, pair, stresses, "von Mises", at_rest, ask)[0].load


def _searched(
    housing: Housing,
    pair: CylinderPair,
    stresses: Sequence[ArrayLike],
    criterion: Criterion,
    at_rest: AtRest | None,
    ask: Callable[[_Search, float], list[_Found]],
) -> list[FirstYield]:
    """Return what is asked of each element of a pair, with E*·ΔR in N/mm."""
    require_hole("the yield load in a housing", pair)
    require(
        housing.g is None, "yield limit", "housing", housing,
        "is given by compliances, which have no stresses",
        "give its R_o and clamp instead",
    )  # fmt: skip
    R_i, R_j = pair.radii("the yield load")
    which, kernels = housing.kernels(pair)
    layers = [material for material, _ in housing.layers]
    across = 0.0 if pair.plane == "stress" else 1.0
    rest: list[FloatArray] = []
    if at_rest is not None:
        rings, own = len(at_rest.materials), 1 + len(layers)
        rule, remedy = f"has {rings} rings for {own} of the housing", "give the same rings"
        require(rings == own, "yield limit", "at_rest", None, rule, remedy)
        pressures = np.where(at_rest.open, 0.0, at_rest.pressures)
        numbers = np.concatenate([at_rest.constants, pressures[..., None]], axis=-1)
        rest = [as_floats(at_rest.radii[0])]
        rest += [as_floats(numbers[..., k, j]) for k in range(rings) for j in range(4)]
    columns = np.broadcast_arrays(
        np.sqrt(R_i * R_j),
        pair.E_star * as_floats(pair.dR),
        pair.shares[0],
        np.round(pair.beta, 15),
        which,
        *(across * as_floats(body.nu) for body in (pair.material_i, *layers, pair.material_j)),
        *map(as_floats, stresses),
        *rest,
    )
    each, which_row = np.unique(
        np.stack([column.ravel() for column in columns]), axis=1, return_inverse=True
    )
    rows, count = [], len(stresses)
    for R, unit, w_i, beta, k, *others in each.T.tolist():
        arcs = _arcs_of(w_i, beta, kernels[int(k)], tuple(others[:count]), criterion)
        strengths = others[count : 2 * count]
        bore, *constants = others[2 * count :] or [0.0]
        before = _Before(bore, as_floats(np.reshape(constants, (-1, 4)))) if rest else None
        search = _Search(arcs, unit / R, strengths, before)
        rows.append([(f * unit, k, abs(r - 1) * R, theta) for f, k, r, theta in ask(search, unit)])
    names = np.array(["hole", *(f"layer {k + 1}" for k in range(len(layers))), "pin"])
    answers = []
    for one in zip(*rows, strict=True):
        load, number, depth, angle = (
            np.array(values)[which_row].reshape(columns[0].shape)[()]
            for values in zip(*one, strict=True)
        )
        answers.append(FirstYield(load, names[number], depth, criterion, np.degrees(angle)))
    return answers


class _Before(NamedTuple):
    """The state at rest of the rings of one pair: the bore's radius in mm; C, D, S and pressure."""

    bore: float
    constants: FloatArray  # shape (rings, 4), with the pressure at the outer edge

    def stress(self, k: int, r: FloatArray) -> tuple[FloatArray, FloatArray, float]:
        """Return σ_r, σ_θ and σ_z in MPa in ring k at r in units of R."""
        C, D, S, _ = self.constants[k]
        return C - D / (r * self.bore) ** 2, C + D / (r * self.bore) ** 2, float(S)


class _Found(NamedTuple):
    """φ at which something happens, the number of the body, and r and θ there."""

    phi: float
    body: int
    r: float
    theta: float


@dataclass(frozen=True, eq=False)
class _Arcs:
    """The arcs of one shape of joint, 1 − e^−t times the largest; their stresses are in f/R.

    The largest equivalent stresses without stress at rest are sought once for all loads and sizes.
    """

    pair: Bodies
    nus: Sequence[float]
    criterion: Criterion
    known: dict[tuple[float, int], tuple[float, float, float, float]]

    @cached_property
    def end(self) -> float:
        """The last t at which the pin touches its housing along one arc."""
        series, last = self.pair.remainder, float(self.pair.last.angle)
        assert isinstance(series, Housed)
        return _LAST if series.whole_to >= last else -float(np.log1p(-series.whole_to / last))

    def stress_at(self, t: float) -> tuple[float, HousingStress]:
        """Return φ, and the stresses in units of f/R."""
        series, kernel = self.pair.remainder, self.pair.kernel
        assert isinstance(series, Housed)
        assert kernel is not None
        angle = -float(self.pair.last.angle) * np.expm1(-t)
        b = float(np.tan(angle / 2))
        arc = self.pair.arc(as_floats(1 / (b**2 * (1 + b**2))))
        coefficients = chebyshev.chebval(2 * angle / series.top - 1, series.coefficients) / b
        size = np.flatnonzero(np.abs(coefficients) > _LEAST * np.abs(coefficients).max())[-1] + 1
        stress = HousingStress(kernel, b, as_floats(coefficients[:size]))
        return float(np.pi * arc.S / arc.k), stress

    def largest(self, t: float, bodies: Sequence[int]) -> list[tuple[float, float, float, float]]:
        """Return φ, the largest equivalent stress, and r and θ there, of some bodies."""
        if any((t, k) not in self.known for k in bodies):
            phi, stress = self.stress_at(t)
            fields = list(stress.bodies())
            for k in bodies:
                field, radii = fields[k]

                def of_load(
                    r: FloatArray, theta: FloatArray, k: int = k, field: Field = field
                ) -> FloatArray:
                    return equivalent(field(r, theta), self.nus[k], self.criterion)

                self.known[t, k] = (phi, *stress.largest(of_load, radii))
        return [self.known[t, k] for k in bodies]


@lru_cache(maxsize=256)
def _arcs_of(
    w_i: float, beta: float, kernel: Kernel, nus: tuple[float, ...], criterion: Criterion
) -> _Arcs:
    """Return the arcs of one shape of joint, which its joints share."""
    return _Arcs(Bodies(as_floats(w_i), beta, np.zeros(()), kernel), nus, criterion, {})


@dataclass(frozen=True, eq=False)
class _Search:
    """The search for first yield of one joint over its arcs."""

    arcs: _Arcs
    unit: float  # E*·ΔR/R in MPa
    strengths: Sequence[float]  # in MPa
    before: _Before | None

    @property
    def bodies(self) -> list[int]:
        """The bodies that yield."""
        return [k for k, strength in enumerate(self.strengths) if np.isfinite(strength)]

    def shares(self, t: float, bodies: Sequence[int]) -> list[tuple[float, _Found]]:
        """Return the largest stress over strength on an arc, and where, of some bodies."""
        if self.before is None:
            return [
                (phi * self.unit * m / self.strengths[k], _Found(phi, k, r, theta))
                for k, (phi, m, r, theta) in zip(bodies, self.arcs.largest(t, bodies), strict=True)
            ]
        phi, stress = self.arcs.stress_at(t)
        fields, found = list(stress.bodies()), []
        for k in bodies:
            field, radii = fields[k]
            m, r, theta = stress.largest(self._with_rest(k, field, phi), radii)
            found.append((m / self.strengths[k], _Found(phi, k, r, theta)))
        return found

    def _with_rest(self, k: int, field: Field, phi: float) -> Equivalent:
        """Return the function of the equivalent stress in MPa of body k, with that at rest."""
        before, per = self.before, phi * self.unit
        nu, criterion = self.arcs.nus[k], self.arcs.criterion
        assert before is not None

        def of_load(r: FloatArray, theta: FloatArray) -> FloatArray:
            return per * equivalent(field(r, theta), nu, criterion)

        def of_both(r: FloatArray, theta: FloatArray) -> FloatArray:
            total, difference = field(r, theta)
            radial, hoop, axial = before.stress(k, r[:, None])
            half = np.abs(per * difference + hoop - radial) / 2
            across = np.abs(per * (0.5 - nu) * total + (radial + hoop) / 2 - axial)
            return of_shear(as_floats(half), as_floats(across), criterion)

        return of_load if k == len(before.constants) else of_both

    def any(self) -> _Found:
        """Return the first yield of all bodies."""
        if self.before is not None:
            found = self.each()
            return min(found, key=lambda each: np.nan_to_num(each.phi, nan=np.inf))

        def largest(t: float) -> tuple[float, _Found]:
            return max(self.shares(t, self.bodies), key=lambda each: each[0])

        return self._bracketed(largest, self.bodies, _FIRST, self.arcs.end)

    def each(self) -> list[_Found]:
        """Return the first yield of each body, with φ = 0 where it yields at rest."""
        if self.before is None:
            return [
                self._bracketed(partial(self._one, body), [body], _FIRST, self.arcs.end)
                for body in range(len(self.strengths))
            ]
        brackets: dict[int, tuple[float, float]] = {}
        low, count, end = _FIRST, len(self.bodies), self.arcs.end
        for t in np.geomspace(_SCAN_FROM, end, _SCANNED).tolist():
            for share, where in self.shares(t, self.bodies):
                if share >= 1:
                    brackets.setdefault(where.body, (low, t))
            if len(brackets) == count:
                break
            low = t
        return [
            self._at_rest(body)
            or self._bracketed(partial(self._one, body), [], *brackets.get(body, (_FIRST, end)))
            for body in range(len(self.strengths))
        ]

    def _one(self, body: int, t: float) -> tuple[float, _Found]:
        """Return the largest stress over strength of one body."""
        if body not in self.bodies:
            return 0.0, _Found(np.nan, body, np.nan, np.nan)
        return self.shares(t, [body])[0]

    def _at_rest(self, body: int) -> _Found | None:
        """Return φ = 0 at the inner edge of a ring, where it yields first, if it yields at rest."""
        before = self.before
        if before is None or body == len(before.constants):
            return None
        kernel = self.arcs.pair.kernel
        assert kernel is not None
        inner = kernel.rings[body].inner
        radial, hoop, axial = before.stress(body, as_floats(inner))
        half, across = abs(hoop - radial) / 2, abs((radial + hoop) / 2 - axial)
        yields = of_shear(half, across, self.arcs.criterion) >= self.strengths[body]
        return _Found(0.0, body, inner, 0.0) if yields else None

    def opens(self) -> _Found:
        """Return the load at which an edge that is pressed together at rest first pulls."""
        before, kernel = self.before, self.arcs.pair.kernel
        assert before is not None
        assert kernel is not None
        theta = np.linspace(0, _END, _ALONG_SEAT)
        pressed = {k: p for k, p in enumerate(before.constants[:, 3].tolist()) if p > 0}

        def pull(t: float) -> tuple[float, _Found]:
            phi, stress = self.arcs.stress_at(t)
            found = [(0.0, _Found(np.nan, 0, np.nan, np.nan))]
            for k, pressure in pressed.items():
                r = kernel.rings[k].outer
                total, difference = stress.in_ring(k, as_floats([r]), theta)
                radial = phi * self.unit * (total - difference.real)[0] / 2
                j = int(np.argmax(radial))
                at = _Found(phi, k, r, float(theta[j]))
                found.append((float(radial[j]) / pressure, at))
            return max(found, key=lambda each: each[0])

        low = _FIRST
        for t in np.geomspace(_SCAN_FROM, self.arcs.end, _SCANNED).tolist():
            if pull(t)[0] >= 1:
                return self._bracketed(pull, [], low, t)
            low = t
        return _Found(np.nan, 0, np.nan, np.nan)

    def hoop(self, phi: float) -> float:
        """Return the largest σ_θθ in MPa beyond the hole's own ring under φ, with that at rest."""
        pair = self.arcs.pair
        if phi > pair.end[0]:
            return np.nan
        angle = float(pair.arc_of_load(as_floats(phi)).angle)
        _, stress = self.arcs.stress_at(-float(np.log1p(-angle / float(pair.last.angle))))
        largest = -np.inf
        for k, (field, radii) in enumerate(stress.bodies()):

            def along(
                r: FloatArray, theta: FloatArray, k: int = k, field: Field = field
            ) -> FloatArray:
                total, difference = field(r, theta)
                rest = 0.0 if self.before is None else self.before.stress(k, r[:, None])[1]
                return as_floats(phi * self.unit * (total + difference.real) / 2 + rest)

            if 0 < k < len(self.strengths) - 1:
                largest = max(largest, stress.largest(along, radii)[0])
        return largest

    def _bracketed(
        self,
        of: Callable[[float], tuple[float, _Found]],
        bodies: Sequence[int],
        low: float,
        high: float,
    ) -> _Found:
        """Return what is found where a share is 1: NaN if it is less at `high`.

        Arcs that are known of all `bodies` narrow the search.
        """
        from scipy.optimize import brentq  # which takes longer to import than the package

        share, found = of(high)
        if share < 1:  # the pin leaves the eye within the arc before
            return _Found(np.nan, found.body, np.nan, np.nan)
        share, found = of(low)
        if share >= 1:  # below the first arc the contact is Hertz's, and the stress as √φ
            return found._replace(phi=found.phi / share**2 if self.before is None else found.phi)
        known = self.arcs.known
        for t in [t for t, k in known if k in bodies[:1]]:
            if low < t < high and all((t, k) in known for k in bodies):
                low, high = (low, t) if of(t)[0] >= 1 else (t, high)
        return of(brentq(lambda t: np.log(of(t)[0]), low, high, rtol=_EXACT))[1]
