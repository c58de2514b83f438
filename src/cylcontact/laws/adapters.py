"""Laws built around another law: a test rig's compliance and offset, and stretched axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, inside_or_nan, require
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.laws.logarithmic import LogarithmicLaw
from cylcontact.pair import CylinderPair

__all__ = ["RigCompliance", "ScaledLaw", "adjusted_logarithmic"]

# Newton's method takes some eight steps, more only near the end of a law's domain.
_STEPS = 100
_ROUNDING = 4e-15
# Where a law ends its stiffness may be infinite; the search stays this share short of it.
_SHORT_OF_THE_END = 1e-13


@dataclass(frozen=True)
class RigCompliance:
    """δ = δ₀(f) + compliance·f + offset: what is measured around a law δ₀.

    No measurement of an approach knows where contact begins, and every rig yields. A plane body,
    moreover, has an approach only up to a constant times f/E*, so that a compliance of the rig is
    not to be told from c of a logarithmic law if only one E* was measured.

    Parameters
    ----------
    base : ContactLaw
        The law of the contact alone.
    offset : float
        The reading at first touch in mm.
    compliance : float
        That of the rig in mm per N/mm, not negative.

    Raises
    ------
    InputError
        If the compliance is negative, or one of them not finite.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material, laws
    >>> pair = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    >>> law = RigCompliance(laws.Johnson(), offset=1e-4, compliance=2e-6)
    >>> seen = law.penetration(100.0, pair)
    >>> print(f"{1e3 * seen:.3f} µm, {law.load(seen, pair):.9f} N/mm")
    1.859 µm, 100.000000000 N/mm
    """

    base: ContactLaw
    offset: float = 0.0
    compliance: float = 0.0

    def __post_init__(self) -> None:
        require(
            np.isfinite(self.offset),
            "RigCompliance",
            "offset",
            self.offset,
            "must be finite",
            "give it in mm",
        )
        require(
            bool(self.compliance >= 0 and np.isfinite(self.compliance)),
            "RigCompliance",
            "compliance",
            self.compliance,
            "must not be negative, and finite",
            "give it in mm per N/mm",
        )

    @property
    def name(self) -> str:
        """The name of the law of the contact."""
        return self.base.name

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return what is read in mm under `load` in N/mm."""
        f = as_floats(load)
        return as_floats(self.base.penetration(f, pair) + self.compliance * f + self.offset)

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm where `penetration` in mm is read; NaN before first touch."""
        depth = as_floats(as_floats(penetration) - self.offset)
        if self.compliance == 0:
            return self.base.load(depth, pair)
        end = self.base.max_penetration(pair)
        last = end + self.compliance * self.base.max_load(pair)
        inside = np.asarray((depth >= 0) & (depth <= last))
        alone = self._contact_alone(
            np.where(inside, depth, 0.0), end * (1 - _SHORT_OF_THE_END), pair
        )
        return inside_or_nan(self.base.load(alone, pair), inside)

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(reading) in N/mm²: contact and rig in series."""
        f = self.load(penetration, pair)
        contact = self.base.stiffness(self.base.penetration(f, pair), pair)
        with np.errstate(divide="ignore"):
            return as_floats(1 / (1 / contact + self.compliance))

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return the largest load in N/mm."""
        return self.base.max_load(pair)

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return the largest reading in mm."""
        given = self.compliance * self.base.max_load(pair) if self.compliance else 0.0
        return as_floats(self.base.max_penetration(pair) + given + self.offset)

    def _contact_alone(self, depth: FloatArray, end: FloatArray, pair: CylinderPair) -> FloatArray:
        """Return the penetration d of the contact, d + compliance·f(d) = depth, at most `end`.

        By Newton's method from above, which is monotone as f is convex, within a bracket for laws
        that are not.
        """
        low, high = np.zeros_like(depth), np.minimum(depth, end) + np.zeros_like(depth)
        d = high
        for _ in range(_STEPS):
            excess = d + self.compliance * self.base.load(d, pair) - depth
            low, high = np.where(excess < 0, d, low), np.where(excess < 0, high, d)
            with np.errstate(invalid="ignore"):  # a stiffness may be infinite at no penetration
                step = d - excess / (1 + self.compliance * self.base.stiffness(d, pair))
            new = np.where((step >= low) & (step <= high), step, (low + high) / 2)
            if np.all(np.abs(new - d) <= _ROUNDING * d):
                break
            d = new
        return as_floats(d)


@dataclass(frozen=True)
class ScaledLaw:
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
    >>> law = ScaledLaw(laws.Johnson(), load_factor=2.0)
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
                "ScaledLaw",
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
) -> ScaledLaw:
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
    ScaledLaw

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
    return ScaledLaw(base, load_factor, kappa * load_factor / base.kappa)
