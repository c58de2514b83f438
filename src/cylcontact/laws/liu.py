"""The law of Liu, Zhang and co-workers (2007) for a pin in a hole."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, inside_or_nan
from cylcontact.html_repr import law_html
from cylcontact.laws.adapters import scaled_model
from cylcontact.laws.contact_law import Unlimited, depth_of, require_hole
from cylcontact.laws.definition import Definition, KernelSteps
from cylcontact.laws.formula import Formula, function_name
from cylcontact.pair import Contact, CylinderPair

__all__ = ["DEFINITION", "Liu"]


@dataclass(frozen=True)
class Liu(Unlimited):
    """f = ½·π·E*·δ·√(δ/(2(ΔR + δ))), from an elastic foundation of the pin's size.

    Liu, Zhang and Yang, *The FEM analysis and approximate model for cylindrical joints with
    clearances*, Mechanism and Machine Theory 42 (2007) 183–197. The law is explicit, dimensionless
    in δ/ΔR and f/(E*·ΔR), without a largest load, and for internal contact only. As printed and
    with the E* of this package it carries about half the load of conformal contact (`Persson`) from
    f/(E*·ΔR) = 0.1 on. A factor of two in the source's E* would explain that (its convention is
    unverified). At smaller loads it carries still less, because f ∝ δ^1.5 there.

    Examples
    --------
    >>> from cylcontact import Material
    >>> pair = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    >>> law = Liu()
    >>> delta = law.penetration(100.0, pair)
    >>> print(f"{delta * 1e3:.4f} µm, {law.load(delta, pair):.10f} N/mm")
    3.2187 µm, 100.0000000000 N/mm
    """

    name: ClassVar[str] = "liu"
    _repr_html_ = law_html

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm.

        In d = δ/ΔR and φ = f/(E*·ΔR) it is the positive root of the cubic d³ = γ(1 + d),
        γ = 8φ²/π².
        """
        dR = self._clearance(pair)
        f = as_floats(load)
        touching = f >= 0
        phi = np.where(touching, f, 0.0) / (pair.E_star * dR)
        return inside_or_nan(_positive_root(8 * (phi / np.pi) ** 2) * dR, touching)

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        dR, depth = self._clearance(pair), depth_of(penetration)
        root = np.sqrt(depth / (2 * (dR + depth)))
        return as_floats(np.pi / 2 * pair.E_star * depth * root)

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm²."""
        dR, depth = self._clearance(pair), depth_of(penetration)
        root = np.sqrt(depth / (2 * (dR + depth)))
        return as_floats(np.pi / 4 * pair.E_star * root * (3 * dR + 2 * depth) / (dR + depth))

    def require_pair(self, pair: CylinderPair) -> None:
        """Raise `InputError` for external contact or plane stress."""
        pair.require_plane_strain("Liu")
        require_hole("Liu", pair)

    def _clearance(self, pair: CylinderPair) -> FloatArray:
        """Return ΔR in mm of a pair that the law is for."""
        self.require_pair(pair)
        return as_floats(pair.dR)


def _positive_root(gamma: FloatArray) -> FloatArray:
    """Return the positive root of d³ = γ(1 + d) by Cardano's formulas.

    Below γ = 27/4 there is one real root, the sum of two cube roots; the second is γ/3 over the
    first, which avoids cancellation. Above there are three, and the largest is a cosine.
    """
    few = gamma < 27 / 4
    low = np.where(few, gamma, 0.0)
    first = np.cbrt(low / 2 + np.sqrt(low**2 / 4 - low**3 / 27))
    sum_of_roots = first + np.divide(low, 3 * first, out=np.zeros_like(first), where=first > 0)
    high = np.where(few, 27 / 4, gamma)
    angle = np.arccos(np.minimum(1.0, np.sqrt(27 / (4 * high))))
    cosine = 2 * np.sqrt(high / 3) * np.cos(angle / 3)
    return as_floats(np.where(few, sum_of_roots, cosine))


_STEPS = """
root = sqrt(penetration / (2 * (dR + penetration)))
f = pi / 2 * E_star * penetration * root
k = pi / 4 * E_star * root * (3 * dR + 2 * penetration) / (dR + penetration)
"""


def _numbers(_: Liu, pair: CylinderPair) -> tuple[float, float]:
    """Return E* and ΔR."""
    return float(pair.E_star), float(np.asarray(pair.dR))


def _formula(law: Liu, _: Contact | None) -> Formula:
    """Return the formula for export."""
    return Formula(
        name=function_name(law.name),
        law=law,
        contact="internal",
        equation="f = pi/2*E_star*d*sqrt(d/(2*(dR + d))) with the penetration d",
        text=_STEPS,
        coefficients={},
        constants={},
        remark="No largest penetration.",
        origin="the law has none",
    )


DEFINITION = Definition(
    law=Liu,
    formula=_formula,
    kernel=KernelSteps(("E_star", "dR"), _numbers, _STEPS),
    models=(scaled_model(Liu()),),
    contacts=("internal",),
)
