"""Johnson's law, and the common form of the logarithmic laws.

Every logarithmic law of cylindrical contact has the form

    δ = A·f·[ln(Λ·E*/f) + c],    A = κ/(π·E*),

and differs from the others only in κ, c and the reach Λ (mm), a length that depends on the radii.
The largest load is f_max = Λ·E*·exp(c − 1); beyond it the penetration would decrease with the
load. In q = f/f_max and p = δ/δ_max, with δ_max = A·f_max, all of them are the single curve
p = q(1 − ln q), with the inverse q = p/(1 + w) and w from Lambert's function.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, inside_or_nan
from cylcontact.html_repr import law_html
from cylcontact.laws.lambert import branch_distance, to_load_fraction
from cylcontact.pair import CylinderPair

__all__ = ["Johnson", "LogarithmicLaw"]


@dataclass(frozen=True)
class LogarithmicLaw(ABC):
    """The common form δ = κ/(π·E*)·f·[ln(Λ·E*/f) + c]; a law supplies κ, c and Λ."""

    name: ClassVar[str]
    kappa: ClassVar[float]
    shift: ClassVar[float]
    _repr_html_ = law_html

    @abstractmethod
    def reach(self, pair: CylinderPair) -> FloatArray:
        """Return Λ in mm."""

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm; NaN outside [0, max_load]."""
        q = _fraction(load, self.max_load(pair))
        inside = (q >= 0) & (q <= 1)
        p = q * (1 - np.log(np.where(inside & (q > 0), q, 1.0)))
        return inside_or_nan(self.max_penetration(pair) * p, inside)

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm; NaN outside [0, max_penetration]."""
        f = to_load_fraction(_fraction(penetration, self.max_penetration(pair)))
        f *= self.max_load(pair)
        return f

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm²; infinite at max_penetration."""
        w = branch_distance(_fraction(penetration, self.max_penetration(pair)))
        with np.errstate(divide="ignore"):
            return as_floats(1 / (self._compliance(pair) * w))

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return the largest load in N/mm, Λ·E*·exp(c − 1)."""
        return as_floats(self.reach(pair) * pair.E_star * np.exp(self.shift - 1))

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm at the largest load."""
        return as_floats(self._compliance(pair) * self.max_load(pair))

    def _compliance(self, pair: CylinderPair) -> FloatArray:
        """Return A = κ/(π·E*) in mm²/N."""
        return as_floats(self.kappa / (np.pi * pair.E_star))


def _fraction(values: ArrayLike, limit: FloatArray) -> FloatArray:
    """Return `values` in units of `limit`; inf (outside the domain) where that overflows."""
    with np.errstate(over="ignore"):
        return as_floats(as_floats(values) / limit)


class Johnson(LogarithmicLaw):
    """Johnson's law, Eq 1: f = π·E*·δ/[ln(4π·E*·ΔR/f) − 1] per unit length.

    The paper solves it for the load by iteration. `load` evaluates the exact inverse,
    f = π·E*·δ/(−W₋₁(−e·δ/(4ΔR))). The domain ends at f = 4π·E*·ΔR/e² (Eq 8), δ = 4ΔR/e².

    For bodies of different materials the reach is
    Λ = 4π·R_i^(2w_i)·R_j^(2w_j)/R with w_k = E*(1 − ν_k²)/E_k (each body's own half-plane
    compression, Johnson's Contact Mechanics, Sect. 5.6). As w_i + w_j = 1 and R = R_i·R_j/ΔR,
    that is Λ = 4π·ΔR·(R_i/R_j)^(w_i − w_j), and equal materials give Λ = 4π·ΔR.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.from_dR("internal", dR=0.05, material=steel)
    >>> law = Johnson()
    >>> delta = law.penetration(100.0, pair)
    >>> print(f"{delta * 1e3:.5f} µm, {law.load(delta, pair):.10f} N/mm")
    1.55935 µm, 100.0000000000 N/mm
    """

    name = "johnson"
    kappa = 1.0
    shift = -1.0

    def reach(self, pair: CylinderPair) -> FloatArray:
        """Return Λ in mm: 4π·ΔR for equal materials, else 4π·ΔR·(R_i/R_j)^(w_i − w_j)."""
        modulus_i = pair.material_i.plane_strain_modulus
        modulus_j = pair.material_j.plane_strain_modulus
        if np.all(modulus_i == modulus_j):
            return as_floats(4 * np.pi * as_floats(pair.dR))
        R_i, R_j = pair.radii("Johnson's law for different materials")
        w_i, w_j = pair.E_star / modulus_i, pair.E_star / modulus_j
        return as_floats(4 * np.pi * as_floats(pair.dR) * (R_i / R_j) ** (w_i - w_j))
