"""Laws built on another law: the datum, rig and offset of a reading, scaled axes, true inputs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws.law import ContactLaw, depth_of
from cylcontact.support.arrays import FloatArray, as_floats, inside_or_nan, require

# Newton's method takes about eight steps, more only near the end of a law's domain.
_STEPS = 100
# Halvings of the logarithm of a penetration between these shares of ΔR.
_HALVINGS, _SHALLOW, _DEEP = 60, 1e-12, 1e6
_ROUNDING = 4e-15
# Clearances that differ relatively by less are one.
_SAME_CLEARANCE = 1e-9
# The stiffness may be infinite where a law ends; the search stays below the end by this fraction.
_SHORT_OF_THE_END = 1e-13


@dataclass(frozen=True, eq=False)
class ContactAlone:
    """A contact under loads in N/mm, without its rig."""

    law: ContactLaw
    load: FloatArray
    pair: CylinderPair

    @cached_property
    def penetration(self) -> FloatArray:
        """In mm."""
        return self.law.penetration(self.load, self.pair)

    @cached_property
    def stiffness(self) -> FloatArray:
        """In N/mm²."""
        return self.law.stiffness(self.penetration, self.pair)


@dataclass(frozen=True)
class RigCompliance:
    """δ = δ₀(f) + compliance·f + offset: the reading of a test rig, with δ₀ the law of the contact.

    Offset and compliance, in mm and mm per N/mm, are those of the rig and of another datum than the
    law's, so the compliance has either sign. With a negative one the domain ends where the reading
    would no longer increase with the load, at dδ₀/df = −compliance.
    """

    base: ContactLaw
    offset: float = 0.0
    compliance: float = 0.0

    def __post_init__(self) -> None:
        for key, unit in (("offset", "mm"), ("compliance", "mm per N/mm")):
            value = getattr(self, key)
            remedy = f"give it in {unit}"
            require(np.isfinite(value), "RigCompliance", key, value, "must be finite", remedy)

    @property
    def name(self) -> str:
        """The name of the law of the contact."""
        return self.base.name

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the reading in mm under `load` in N/mm."""
        return self.reading_of(ContactAlone(self.base, as_floats(load), pair))

    def reading_of(self, contact: ContactAlone) -> FloatArray:
        """Return the reading in mm of a contact under its loads."""
        reading = as_floats(contact.penetration + self.compliance * contact.load + self.offset)
        if self.compliance >= 0:
            return reading
        return inside_or_nan(reading, np.asarray(self._slope(contact.stiffness) > 0))

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at a reading `penetration` in mm; 0 before first touch."""
        depth = depth_of(as_floats(penetration) - self.offset)
        if self.compliance == 0:
            return self.base.load(depth, pair)
        inside = np.asarray(depth <= self.max_penetration(pair) - self.offset)
        alone = self._contact_alone(np.where(inside, depth, 0.0), pair)
        return inside_or_nan(self.base.load(alone, pair), inside)

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(reading) in N/mm²: contact and rig in series."""
        alone = self.base.penetration(self.load(penetration, pair), pair)
        with np.errstate(divide="ignore"):
            k = 1 / (1 / self.base.stiffness(alone, pair) + self.compliance)
        return as_floats(np.where(as_floats(penetration) < self.offset, 0.0, k))

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return the largest load in N/mm."""
        return self._end(pair)[1]

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return the largest reading in mm."""
        deepest, largest = self._end(pair)
        rig = np.where(np.isinf(deepest), 0.0, self.compliance * np.nan_to_num(largest))
        return as_floats(deepest + rig + self.offset)

    def _slope(self, stiffness: FloatArray) -> FloatArray:
        """Return d(reading)/d(penetration) of the contact alone, from its stiffness k: 1 + C·k."""
        with np.errstate(invalid="ignore"):
            return as_floats(1 + self.compliance * stiffness)

    def _end(self, pair: CylinderPair) -> tuple[FloatArray, FloatArray]:
        """Return the penetration of the contact alone and the load where the domain ends.

        With a negative compliance that is where the slope falls to 0, sought by halving.
        """
        deepest, largest = self.base.max_penetration(pair), self.base.max_load(pair)
        if self.compliance >= 0:
            return deepest, largest
        low = np.log(_SHALLOW * as_floats(pair.dR)) + np.zeros_like(deepest)
        high = last = np.log(np.minimum(deepest * (1 - _SHORT_OF_THE_END), _DEEP * pair.dR))
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            rises = self._slope(self.base.stiffness(np.exp(middle), pair)) > 0
            low, high = np.where(rises, middle, low), np.where(rises, high, middle)
        turn = np.exp(low)
        is_earlier = high < last
        return (
            as_floats(np.where(is_earlier, turn, deepest)),
            as_floats(np.where(is_earlier, self.base.load(turn, pair), largest)),
        )

    def _contact_alone(self, depth: FloatArray, pair: CylinderPair) -> FloatArray:
        """Return the penetration d of the contact that solves d + compliance·f(d) = depth.

        Newton's method converges monotonically for a convex f, from above, or from below for a
        negative compliance; a bracket makes it converge for other laws.
        """
        end = self._end(pair)[0] * (1 - _SHORT_OF_THE_END)
        first = np.minimum(depth, end)
        low, high = np.zeros_like(first), first
        if self.compliance < 0:
            low, high = first, end + np.zeros_like(first)
        d = first
        for _ in range(_STEPS):
            excess = d + self.compliance * self.base.load(d, pair) - depth
            low, high = np.where(excess < 0, d, low), np.where(excess < 0, high, d)
            with np.errstate(divide="ignore", invalid="ignore"):  # at 0 and at the ends
                step = d - excess / self._slope(self.base.stiffness(d, pair))
            new = np.where((step >= low) & (step <= high), step, (low + high) / 2)
            if np.all(np.abs(new - d) <= _ROUNDING * d):
                break
            d = new
        return as_floats(d)


@dataclass(frozen=True)
class ScaledLaw:
    """f = B·f₀(δ/D): a law with the load scaled by B and the penetration by D."""

    base: ContactLaw
    load_factor: float = 1.0
    penetration_factor: float = 1.0

    def __post_init__(self) -> None:
        for key in ("load_factor", "penetration_factor"):
            value = getattr(self, key)
            rule, remedy = "must be positive and finite", "1 leaves the law as it is"
            require(bool(0 < value < np.inf), "ScaledLaw", key, value, rule, remedy)

    @property
    def name(self) -> str:
        """The name of the scaled law."""
        return self.base.name

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm."""
        alone = self.base.penetration(as_floats(load) / self.load_factor, pair)
        return as_floats(self.penetration_factor * alone)

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        scaled = self.base.load(as_floats(penetration) / self.penetration_factor, pair)
        return as_floats(self.load_factor * scaled)

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm²."""
        ratio = self.load_factor / self.penetration_factor
        scaled = self.base.stiffness(as_floats(penetration) / self.penetration_factor, pair)
        return as_floats(ratio * scaled)

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return the largest load in N/mm."""
        return as_floats(self.load_factor * self.base.max_load(pair))

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return the largest penetration in mm."""
        return as_floats(self.penetration_factor * self.base.max_penetration(pair))


def without_rig(law: ContactLaw) -> ContactLaw:
    """Return the law of the contact, without the offset and compliance of a rig."""
    if isinstance(law, CorrectedInputs):
        return replace(law, base=without_rig(law.base))
    return law.base if isinstance(law, RigCompliance) else law


@dataclass(frozen=True)
class CorrectedInputs:
    """A law for pairs whose clearance or moduli differ from what was stated of them.

    `dR` holds, for each stated clearance, the true one in mm; `E` the factors of the moduli of
    bodies i and j; `load` the factor of the true load over the stated one. A pair of another
    clearance keeps its own.
    """

    base: ContactLaw
    dR: tuple[tuple[float, float], ...] = ()
    E: tuple[float, float] = (1.0, 1.0)
    load_factor: float = 1.0

    @property
    def name(self) -> str:
        """The name of the law."""
        return self.base.name

    def true_pair(self, pair: CylinderPair) -> CylinderPair:
        """Return the pair as it is, from the pair as stated."""
        dR = as_floats(pair.dR)
        for stated, true in self.dR:
            dR = np.where(np.isclose(pair.dR, stated, rtol=_SAME_CLEARANCE, atol=0.0), true, dR)
        sign = 1.0 if pair.contact == "internal" else -1.0
        # The pin, or the second roller, takes up the difference: its radius hardly changes.
        R_j = None if pair.R_i is None or pair.R_j is None else sign * (pair.R_i - dR)
        i, j = pair.material_i, pair.material_j
        return replace(
            pair,
            dR=as_floats(dR),
            R_j=R_j,
            material_i=replace(i, E=i.E * self.E[0]),
            material_j=replace(j, E=j.E * self.E[1]),
        )

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under a stated `load` in N/mm."""
        true = as_floats(load) * self.load_factor
        return self.base.penetration(true, self.true_pair(pair))

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm, as it would be stated, at a penetration in mm."""
        return as_floats(self.base.load(penetration, self.true_pair(pair)) / self.load_factor)

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm²."""
        return as_floats(self.base.stiffness(penetration, self.true_pair(pair)) / self.load_factor)

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return the largest load in N/mm."""
        return as_floats(self.base.max_load(self.true_pair(pair)) / self.load_factor)

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return the largest penetration in mm."""
        return self.base.max_penetration(self.true_pair(pair))
