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

**Where first yield is sought.** In the whole pin and the whole housing, but for what is beyond the
middle of its wall and nearer than the wall's thickness to an end of a clamped sector: these ends
are singular, and no elastic stress says when they yield. Thin eyes that are pulled yield on the
bore beside the contact, by bending and hoop tension, or under small loads on the rim above it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial

import numpy as np
from numpy.polynomial import chebyshev

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws.conformal.arcs import Bodies
from cylcontact.laws.conformal.housings import Housing, Kernel, compliances, michell
from cylcontact.laws.conformal.series import Housed
from cylcontact.laws.law import require_hole
from cylcontact.limits.stress import ComplexArray, PlaneStress, Pressure, in_pin, in_plate
from cylcontact.limits.yield_search import Criterion, FirstYield, equivalent
from cylcontact.support.arrays import FloatArray, as_floats, require

Field = Callable[[FloatArray, FloatArray], PlaneStress]

# Points of the search: along half the bore and across a wall, and as many within two and three
# half-widths of the contact; then so many times this many around the largest value.
_ALONG, _THROUGH, _NEAR_ALONG, _NEAR_THROUGH = 33, 13, 17, 13
_PASSES, _FINE = 5, 7
_END, _CENTRE = np.pi - 1e-6, 0.02
# The arcs of the search, 1 − e^−t times the largest, and the accuracy of t.
_FIRST, _LAST, _EXACT = 1e-6, 23.0, 1e-6
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

    def largest(
        self, field: Field, r: FloatArray, nu: float, criterion: Criterion
    ) -> tuple[float, float, float]:
        """Return the largest equivalent stress of a body, and r and θ there."""
        near = 2 * np.arctan(self.b * np.linspace(0, 2.03, _NEAR_ALONG))  # not at its very end
        theta = np.unique(np.append(near, np.linspace(0, _END, _ALONG)))
        for _ in range(1 + _PASSES):
            values = equivalent(field(r, theta), nu, criterion)
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
    housing: Housing, pair: CylinderPair, stresses: Sequence[float], criterion: Criterion
) -> FirstYield:
    """Return the first yield of a pin in a housing: of its rings, from within, and the pin.

    It is NaN where the pin leaves a thin eye within the arc before anything yields.
    """
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
    columns = np.broadcast_arrays(
        np.sqrt(R_i * R_j),
        pair.E_star * as_floats(pair.dR),
        pair.shares[0],
        np.round(pair.beta, 15),
        which,
        *(across * as_floats(body.nu) for body in (pair.material_i, *layers, pair.material_j)),
    )
    each, which_row = np.unique(
        np.stack([column.ravel() for column in columns]), axis=1, return_inverse=True
    )
    rows = []
    for R, unit, w_i, beta, k, *nus in each.T.tolist():
        bodies = Bodies(as_floats(w_i), beta, np.zeros(()), kernels[int(k)])
        strengths = [stress * R / unit for stress in stresses]
        phi, body, r, theta = _first_arc(bodies, nus, strengths, criterion)
        rows.append((phi * unit, body, abs(r - 1) * R, np.degrees(theta)))
    load, number, depth, angle = (
        np.array(values)[which_row].reshape(columns[0].shape)[()]
        for values in zip(*rows, strict=True)
    )
    names = np.array(["hole", *(f"layer {k + 1}" for k in range(len(layers))), "pin"])
    return FirstYield(load, names[number], depth, criterion, angle)


def _first_arc(
    bodies: Bodies, nus: Sequence[float], strengths: Sequence[float], criterion: Criterion
) -> tuple[float, int, float, float]:
    """Return φ at which φ·m = T in one of the bodies, the number of the body, and r and θ there."""
    from scipy.optimize import brentq  # which takes longer to import than the package

    series, kernel, last = bodies.remainder, bodies.kernel, float(bodies.last.angle)
    assert isinstance(series, Housed)
    assert kernel is not None

    def at(t: float) -> tuple[float, float, int, float, float]:
        """Return φ, φ·m/T, the body, r and θ on the arc of 1 − e^−t times the largest."""
        angle = -last * np.expm1(-t)
        b = float(np.tan(angle / 2))
        arc = bodies.arc(as_floats(1 / (b**2 * (1 + b**2))))
        phi = float(np.pi * arc.S / arc.k)
        coefficients = chebyshev.chebval(2 * angle / series.top - 1, series.coefficients) / b
        size = np.flatnonzero(np.abs(coefficients) > _LEAST * np.abs(coefficients).max())[-1] + 1
        stress = HousingStress(kernel, b, as_floats(coefficients[:size]))
        answers = []
        for k, (field, radii) in enumerate(stress.bodies()):
            m, r, theta = stress.largest(field, radii, nus[k], criterion)
            answers.append((phi, phi * m / strengths[k], k, r, theta))
        return max(answers, key=lambda each: each[1])

    end = _LAST if series.whole_to >= last else -float(np.log1p(-series.whole_to / last))
    _, share, body, r, theta = at(end)
    if share < 1:  # the pin leaves the eye within the arc before
        return np.nan, body, np.nan, np.nan
    t = brentq(lambda t: np.log(at(t)[1]), _FIRST, end, rtol=_EXACT)
    phi, _, body, r, theta = at(t)
    return phi, body, r, theta
