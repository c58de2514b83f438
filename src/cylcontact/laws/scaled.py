"""A law with both of its axes stretched: how laws without numbers of their own are fitted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, require
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.laws.logarithmic import LogarithmicLaw
from cylcontact.pair import CylinderPair


@dataclass(frozen=True)
class Scaled:
    """f = B·f₀(δ/D): a law whose load is stretched by B and whose penetration by D.

    For a law that depends on f/(E*·ΔR) and δ/ΔR alone, such as Persson's and Liu's, D is an
    effective clearance over the real one and B/D an effective modulus. Every logarithmic law is a
    stretched Johnson's law: see `adjusted_logarithmic`.

    Parameters
    ----------
    base : ContactLaw
        The law f₀.
    load_factor, penetration_factor : float
        B and D, positive.

    Raises
    ------
    InputError
        If a factor is not positive and finite.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material, laws
    >>> pair = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    >>> law = Scaled(laws.Johnson(), load_factor=2.0)
    >>> print(law.load(1e-3, pair) / laws.Johnson().load(1e-3, pair))
    2.0
    """

    base: ContactLaw
    load_factor: float = 1.0
    penetration_factor: float = 1.0

    def __post_init__(self) -> None:
        for key in ("load_factor", "penetration_factor"):
            value = getattr(self, key)
            require(
                bool(value > 0 and np.isfinite(value)),
                "Scaled",
                key,
                value,
                "must be positive and finite",
                "1 leaves the law as it is",
            )

    @property
    def name(self) -> str:
        """The name of the law that is stretched."""
        return self.base.name

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm."""
        stretched = self.base.penetration(as_floats(load) / self.load_factor, pair)
        return as_floats(self.penetration_factor * stretched)

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        stretched = self.base.load(as_floats(penetration) / self.penetration_factor, pair)
        return as_floats(self.load_factor * stretched)

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm²."""
        ratio = self.load_factor / self.penetration_factor
        stretched = self.base.stiffness(as_floats(penetration) / self.penetration_factor, pair)
        return as_floats(ratio * stretched)

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return the largest load in N/mm."""
        return as_floats(self.load_factor * self.base.max_load(pair))

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return the largest penetration in mm."""
        return as_floats(self.penetration_factor * self.base.max_penetration(pair))


def adjusted_logarithmic(
    base: LogarithmicLaw, kappa: float, c: float, Lambda_factor: float = 1.0
) -> Scaled:
    """Return δ = κ/(π·E*)·f·[ln(F·Λ·E*/f) + c] with the Λ of a logarithmic law.

    With B = F·exp(c − c₀) it is (κ·B/κ₀)·δ₀(f/B), the law δ₀ of κ₀, c₀ and Λ stretched. F and c
    act only through ln F + c.

    Parameters
    ----------
    base : LogarithmicLaw
        The law that supplies Λ.
    kappa, c : float
        κ, positive, and c.
    Lambda_factor : float
        F, positive.

    Returns
    -------
    Scaled

    Raises
    ------
    InputError
        If κ or F is not positive.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material, laws
    >>> pair = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    >>> law = adjusted_logarithmic(laws.Johnson(), kappa=1.0, c=2 / 3)
    >>> print(law.penetration(100.0, pair) / laws.Radzimovsky().penetration(100.0, pair))
    1.0
    """
    load_factor = Lambda_factor * float(np.exp(c - base.shift))
    return Scaled(base, load_factor, kappa * load_factor / base.kappa)
