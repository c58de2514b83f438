"""The elastic foundation of Liu and others for a pin in a hole, for comparison."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from numpy import pi, sqrt

from cylcontact.bodies.pair import Contact
from cylcontact.laws.formula import Formula
from cylcontact.laws.law import Law


def load(penetration, E_star, dR):
    """Return f = ½π·E*·δ·√(δ/(2(ΔR + δ)))."""
    return pi / 2 * E_star * penetration * sqrt(penetration / (2 * (dR + penetration)))


def stiffness(penetration, E_star, dR):
    """Return df/dδ, f/δ·(1 + ΔR/(2(ΔR + δ)))."""
    total = dR + penetration
    return pi / 2 * E_star * sqrt(penetration / (2 * total)) * (1 + dR / (2 * total))


@dataclass(frozen=True)
class Liu(Law):
    """f = ½·π·E*·δ·√(δ/(2(ΔR + δ))), from an elastic foundation of the pin's size.

    Liu, Zhang and Yang, *The FEM analysis and approximate model for cylindrical joints with
    clearances*, Mechanism and Machine Theory 42 (2007) 183–197. The law is explicit, dimensionless
    in δ/ΔR and f/(E*·ΔR), without a largest load, and for internal contact only. As printed and
    with the E* of this package it carries about half the load of conformal contact (`Persson`) from
    f/(E*·ΔR) = 0.1 on. A factor of two in the source's E* would explain that (its convention is
    unverified). At smaller loads it carries still less, because f ∝ δ^1.5 there.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> pair = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    >>> law = Liu()
    >>> delta = law.penetration(100.0, pair)
    >>> print(f"{delta * 1e3:.4f} µm, {law.load(delta, pair):.10f} N/mm")
    3.2187 µm, 100.0000000000 N/mm
    """

    name: ClassVar[str] = "liu"
    formula: ClassVar[Formula] = Formula(
        load, stiffness,
        equation="f = pi/2*E_star*d*sqrt(d/(2*(dR + d))) with the penetration d",
    )  # fmt: skip
    contacts: ClassVar[tuple[Contact, ...]] = ("internal",)
    any_plane: ClassVar[bool] = False
