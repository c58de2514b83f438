"""Robust losses, which reduce the influence of large residuals.

A loss minimises the sum of C²·ρ(z) with z = (r/C)², in scipy's definitions. For least squares
ρ(z) = z. The residual C·sign(r)·√ρ(z) has squares that add up to this sum, so that every solver
for least squares can minimise it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from cylcontact.arrays import FloatArray, as_floats

# C in standard deviations: with Huber's loss 1.345 keeps 95 % of the efficiency of least squares
# (Huber 1981), and the other losses are similar.
TUNING = 1.345


def _linear(z: FloatArray) -> FloatArray:
    return z


def _soft_l1(z: FloatArray) -> FloatArray:
    # 2(√(1+z) − 1) without its cancellation.
    return as_floats(2 * z / (np.sqrt(1 + z) + 1))


def _huber(z: FloatArray) -> FloatArray:
    return as_floats(np.where(z <= 1, z, 2 * np.sqrt(np.maximum(z, 1)) - 1))


def _cauchy(z: FloatArray) -> FloatArray:
    return as_floats(np.log1p(z))


def _slope_linear(z: FloatArray) -> FloatArray:
    return np.ones_like(z)


def _slope_soft_l1(z: FloatArray) -> FloatArray:
    return as_floats(1 / np.sqrt(1 + z))


def _slope_huber(z: FloatArray) -> FloatArray:
    return as_floats(1 / np.sqrt(np.maximum(z, 1)))


def _slope_cauchy(z: FloatArray) -> FloatArray:
    return as_floats(1 / (1 + z))


_Curve = Callable[[FloatArray], FloatArray]
# ρ and dρ/dz of each loss.
_RHO: Mapping[str, tuple[_Curve, _Curve]] = {
    "linear": (_linear, _slope_linear),
    "soft_l1": (_soft_l1, _slope_soft_l1),
    "huber": (_huber, _slope_huber),
    "cauchy": (_cauchy, _slope_cauchy),
}
LOSSES = tuple(_RHO)


@dataclass(frozen=True)
class Loss:
    """A loss and its scale C, in the units of the residuals.

    Examples
    --------
    Least squares leaves residuals unchanged; a robust loss shrinks large ones:

    >>> r = np.array([0.1, -10.0])
    >>> print(Loss().residual(r), Loss("cauchy").residual(r).round(3))
    [  0.1 -10. ] [ 0.1   -2.148]
    """

    name: str = "linear"
    scale: float = 1.0

    @property
    def is_linear(self) -> bool:
        """Whether it is plain least squares."""
        return self.name == "linear"

    def residual(self, r: FloatArray) -> FloatArray:
        """Return the residuals whose squares add up to the loss."""
        rho, _ = _RHO[self.name]
        if self.is_linear:
            return r
        return as_floats(np.sign(r) * self.scale * np.sqrt(rho((r / self.scale) ** 2)))

    def psi(self, r: FloatArray) -> FloatArray:
        """Return half the derivative of the loss; r for least squares."""
        _, slope = _RHO[self.name]
        return as_floats(r * slope((r / self.scale) ** 2))

    def psi_slope(self, r: FloatArray) -> FloatArray:
        """Return the derivative of `psi`; a central difference for robust losses."""
        if self.is_linear:
            return np.ones_like(r)
        step = 1e-6 * self.scale
        return as_floats((self.psi(r + step) - self.psi(r - step)) / (2 * step))
