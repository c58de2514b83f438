"""The interface of contact laws."""

from __future__ import annotations

from typing import Protocol

from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray
from cylcontact.pair import CylinderPair

__all__ = ["ContactLaw"]


class ContactLaw(Protocol):
    """Load per unit length against penetration for a pair of parallel cylinders.

    Loads are in N/mm, penetrations in mm, stiffness in N/mm². All arguments broadcast, also
    against array-valued pairs. Elements outside a law's domain are NaN, as are those of a negative
    load or penetration, where the bodies do not touch.
    """

    @property
    def name(self) -> str:
        """The law's name in specs and reports."""
        ...

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm."""
        ...

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        ...

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm² at `penetration` in mm."""
        ...

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return the largest load in N/mm; inf where there is none."""
        ...

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return the largest penetration in mm; inf where there is none."""
        ...
