"""The interface of contact laws."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, require
from cylcontact.pair import CylinderPair


class ContactLaw(Protocol):
    """Load per unit length against penetration for a pair of parallel cylinders.

    Loads are in N/mm, penetrations in mm, stiffness in N/mm². All arguments broadcast, also
    against array-valued pairs. At a negative penetration the bodies do not touch: load and
    stiffness are 0. Elements outside a law's domain are NaN, as is the penetration under a negative
    load.
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


class OverLength:
    """The total force of a law that gives the load per unit length."""

    def force(self: ContactLaw, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the force in N at `penetration` in mm: the load times the length of the pair."""
        return as_floats(self.load(penetration, pair) * pair.contact_length("the force"))


def require_hole(law: str, pair: CylinderPair) -> None:
    """Raise `InputError` for external contact."""
    require(
        pair.contact == "internal",
        law,
        "pair.contact",
        pair.contact,
        "must be internal: the law is for a pin in a hole",
        "use laws.Johnson() for external contact",
    )


def depth_of(penetration: ArrayLike) -> FloatArray:
    """Return the penetration, 0 where it is negative and the bodies do not touch.

    Examples
    --------
    >>> depth_of([-1.0, 2.0, np.nan])
    array([ 0.,  2., nan])
    """
    return as_floats(np.maximum(as_floats(penetration), 0.0))
