"""Stresses inside a pin and inside the plate around its hole, under a known contact pressure.

Lengths are in units of R and stresses in units of f/R; the load acts along θ = 0. The pressure
along an arc depends on its semi-angle and on Dundurs' β alone (`cylcontact.laws.conformal`). Once
it is known, each body is loaded by tractions alone, so the fields below hold for any two materials.

**The pressure as an analytic function.** Let F be analytic inside the unit circle, its real part on
the circle the pressure p and F(0) = p₀ real, the mean of p over the whole circle. The point w of
the disk is w = (1 + iη)/(1 − iη) with η in the upper half plane, and the rim is the real axis,
η = y = tan(θ/2). With b = tan(ε/2), B = √(1 + b²) and s = √(b² − η²) (positive on the arc,
s ~ −iη far away), Schwarz's integral gives for p = Σ aₘ·sin nv, n = 2m + 1, y = b·cos v

    F = i·Σ aₘ·ωⁿ,    ω = b/(η + is),    dF/dη = −Σ n·aₘ·ωⁿ/s,

because ∫sin nv·sin v/(cos v − ζ) dv over half a turn is −π·(ζ − √(ζ² − 1))ⁿ. For β = 0 the sum is

    F = 2b²/(πB·(s − iBη)) + ln((B + s)/(1 − iη))/(πb²B²),

whose real part on the arc is Persson's pressure.

**The bodies.** With P = (F − p₀)/2, P' = dP/dw and p₁ = 1/(2π), the Fourier coefficient that
carries the load, Kolosov and Muskhelishvili's potentials

    Σ = σ_rr + σ_θθ = 4·Re Φ,    D = σ_θθ − σ_rr + 2i·σ_rθ = 2e^{2iθ}·(z̄Φ' + Ψ)

follow by comparing powers of z on the rim, where σ_rr = −p and σ_rθ = 0.

*Pin*, z = w, its load balanced by an even body force 2p₁ = 1/π. The hydrostatic stress −2p₁·x is in
equilibrium with that force, and adds to Φ = −p₀/2 − P + p₁z, Ψ = (P' − p₁)/z:

    Σ = −2p₀ − 4·Re P,    D = 2(P' − p₁)(1 − |z|²)/z̄.

*Plate*, z = 1/w, its load balanced at infinity. Single-valued displacements fix the terms of 1/z,
the only place where κ enters: with q = p₁·κ/(κ + 1), Φ = −P + qw and
Ψ = qw + p₀w² + 2qw³ − w³P', so

    Σ = 4·Re(qw − P),    D = 2[w(1 − |w|²)P' − q(w − w̄) + |w|²(p₀ + 2qw)].

On the rim D is real and these are σ_θθ = −p in the pin and σ_θθ = −p + 2p₀ + 4q·cos θ in the plate.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cylcontact.laws.conformal.series import enough_terms, glauert
from cylcontact.support.arrays import FloatArray, as_floats

ComplexArray = NDArray[np.complex128]

# The Fourier coefficient of the pressure that carries the load.
_P1 = 1 / (2 * np.pi)
# Half the distance from the centre of the pin at which the stresses of the centre are computed.
_NEAR = 1e-6


class PlaneStress(NamedTuple):
    """In-plane stresses in units of f/R: σ_rr + σ_θθ and σ_θθ − σ_rr + 2i·σ_rθ."""

    total: FloatArray
    difference: ComplexArray


@dataclass(frozen=True)
class Pressure:
    """The pressure along k arcs as an analytic function; build it with `pressure_along`."""

    b: FloatArray  # tan(ε/2) of each arc, shape (k, 1)
    coefficients: FloatArray | None  # of Glauert's series, shape (terms, k, 1); None for β = 0

    @cached_property
    def mean(self) -> FloatArray:
        """p₀, shape (k, 1)."""
        return as_floats(self.at(np.full(self.b.shape, 1j))[0].real)

    def at(self, eta: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Return F and dF/dη at points η of the upper half plane, shape (k, points)."""
        # Two roots, because the branch of √(b² − η²) that is wanted is cut along the arc alone.
        s = -1j * np.sqrt(eta - self.b) * np.sqrt(eta + self.b)
        if self.coefficients is None:
            return _closed(eta, s, self.b)
        omega = self.b / (eta + 1j * s)
        square = omega**2
        total, slope = np.zeros_like(square), np.zeros_like(square)
        for m in reversed(range(len(self.coefficients))):
            a = self.coefficients[m]
            total = total * square + a
            slope = slope * square + (2 * m + 1) * a
        return 1j * total * omega, -slope * omega / s


def pressure_along(b: FloatArray, beta: float) -> Pressure:
    """Return the pressure along arcs of b = tan(ε/2), shape (k,), between bodies of one β."""
    arcs = b[:, None]
    if beta == 0:
        return Pressure(arcs, None)
    # Half the terms of the laws: the stresses are within 2e-8 then.
    solution = glauert(b, beta, enough_terms(float(np.max(b))) // 2)
    return Pressure(arcs, as_floats(solution.coefficients.T[:, :, None]))


def _closed(eta: ComplexArray, s: ComplexArray, b: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Return F and dF/dη for β = 0, written so that small arcs lose no digits."""
    square = b**2
    B = np.sqrt(1 + square)
    scale = np.pi * square * B**2
    lower, conjugate = 1 - 1j * eta, s - 1j * B * eta
    even = 2 * square / (np.pi * B)
    log = _log1p((square / (1 + B) + square / (s - 1j * eta)) / lower)
    slope = 1j * (s * B + square + 1j * eta) / (s * (B + s) * lower)
    return (
        even / conjugate + log / scale,
        even * (eta / s + 1j * B) / conjugate**2 + slope / scale,
    )


def _log1p(z: ComplexArray) -> ComplexArray:
    """Return ln(1 + z), also accurate for small z, of which NumPy's loses digits."""
    real, imaginary = z.real, z.imag
    modulus = np.log1p(real * (2 + real) + imaginary**2) / 2
    return np.asarray(modulus + 1j * np.arctan2(imaginary, 1 + real), dtype=np.complex128)


def in_pin(eta: ComplexArray, pressure: Pressure) -> PlaneStress:
    """Return the stresses in the pin at z = (1 + iη)/(1 − iη), shape (k, points)."""
    # At the centre the formula is 0/0; the stresses are smooth there.
    w, inside, P, slope = _disk(np.where(eta == 1j, (1 + _NEAR) * 1j, eta), pressure)
    total = -2 * pressure.mean - 4 * P.real
    return PlaneStress(as_floats(total), 2 * (slope - _P1) * inside / np.conj(w))


def in_plate(eta: ComplexArray, pressure: Pressure, kappa: float) -> PlaneStress:
    """Return the stresses in the plate at z = (1 − iη)/(1 + iη), shape (k, points)."""
    w, inside, P, slope = _disk(eta, pressure)
    q = _P1 * kappa / (kappa + 1)
    difference = w * inside * slope - q * (w - np.conj(w))
    difference = difference + (1 - inside) * (pressure.mean + 2 * q * w)
    return PlaneStress(as_floats(4 * (q * w - P).real), 2 * difference)


def _disk(
    eta: ComplexArray, pressure: Pressure
) -> tuple[ComplexArray, FloatArray, ComplexArray, ComplexArray]:
    """Return w, 1 − |w|², P and dP/dw at points η."""
    F, rate = pressure.at(eta)
    lower = 1 - 1j * eta
    inside = as_floats(4 * eta.imag / np.abs(lower) ** 2)
    return (1 + 1j * eta) / lower, inside, (F - pressure.mean) / 2, -0.25j * lower**2 * rate
