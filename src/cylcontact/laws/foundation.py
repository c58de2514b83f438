"""Elastic foundations for a pin in a hole, for comparison: Winkler's, and Liu and others'."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from numpy import arctan, isfinite, pi, sin, sqrt, where

from cylcontact.laws.adapters import scaled_model
from cylcontact.laws.formula import Formula
from cylcontact.laws.law import Law, LawModel, Parameter
from cylcontact.support.arrays import require

# Half of Z = π·E*·δ/f of Persson's law at complete contact, which gives both laws the same slope
# there.
DEPTH = 0.715238076324212


def springs(penetration, pair, depth):
    """Return load and stiffness in x = 2ε, as arccos would lose digits at small penetrations."""
    d = penetration / pair.dR
    x = 2 * arctan(sqrt(d) * sqrt(2 + d))
    sine = sin(x)
    # x − sin x by its power series where the difference loses digits.
    small = where(x < 1, x, 1)
    square = small * small
    series = 1
    for j in range(18, 2, -2):
        series = 1 - square / (j * (j + 1)) * series
    excess = where(x < 1, x * x * x / 6 * series, x - sine)
    f = pair.E_star * pair.dR / depth * ((1 + d) * excess / 2)
    return f, pair.E_star / depth * ((x + sine) / 2)


_EQUATION = (
    "f = E_star/depth*((dR + penetration)*angle - dR*sin(angle)) with "
    "cos(angle) = dR/(dR + penetration)"
)
_REMARK = "depth is that of the foundation in units of the radius, an assumption."


@dataclass(frozen=True)
class Winkler(Law):
    """A pin in a hole lined with independent springs: p = (E*/h)·u at each point.

    With u = δcos θ − ΔR(1 − cos θ) on the arc where u is positive, cos ε = ΔR/(ΔR + δ),

        f = ∫ p·cos θ·R dθ = E*·R/h·[(ΔR + δ)·ε − ΔR·sin ε],
        df/dδ = E*·R/h·(ε + sin ε·cos ε).

    Parameters
    ----------
    depth : float
        h/R, the depth of the foundation in units of the radius.

    Raises
    ------
    InputError
        If the depth is not positive and finite; when the law is evaluated, if the contact is
        external.

    Notes
    -----
    **The modulus of the foundation is an assumption**: two solid bodies have no layer whose depth
    h could be measured. Johnson (Contact Mechanics, 1985, Sect. 4.3) writes the modulus as K/h
    and chooses it for each case. Here K is E*, and the default h = 0.715R gives the slope of
    Persson's law at large loads, where the contact is complete. Johnson's own choice
    for line contact, K/h = 1.18E*/a (a the half-width), becomes h = 0.85R for a = R.

    Neighbouring springs are independent, so a contact much narrower than their depth is too soft:
    f grows like δ^1.5 at small loads, where it should be nearly linear. With h in units of R, R
    cancels, and δ/ΔR is a function of f/(E*·ΔR) and `depth` alone.

    Examples
    --------
    Against Persson's law, from small loads to complete contact:

    >>> import numpy as np
    >>> from cylcontact import CylinderPair, Material
    >>> from cylcontact.laws import Persson
    >>> pair = CylinderPair.from_dR("internal", 0.01, Material("steel", E=207e3, nu=0.3))
    >>> loads = np.array([1e-4, 1e-2, 0.1, 1.0, 10.0, 100.0]) * pair.E_star * pair.dR
    >>> ratio = Winkler().penetration(loads, pair) / Persson().penetration(loads, pair)
    >>> print(ratio.round(2))
    [3.3  1.26 0.95 0.94 0.99 1.  ]
    """

    depth: float = DEPTH
    name: ClassVar[str] = "winkler"
    formula = Formula(springs, equation=_EQUATION, remark=_REMARK)
    contacts = ("internal",)
    parameters = (
        Parameter(
            "depth", 0.05, 20.0, DEPTH, stiffness=True,
            meaning="depth of the foundation over the radius",
        ),
    )  # fmt: skip
    published = False

    def __post_init__(self) -> None:
        rule, remedy = "must be positive and finite", f"give h/R, e.g. {DEPTH:.3f}"
        positive = self.depth > 0 and isfinite(self.depth)
        require(positive, "Winkler", "depth", self.depth, rule, remedy)


def of_pins_size(penetration, pair):
    """Return f = ½π·E*·δ·√(δ/(2(ΔR + δ)))."""
    share = penetration / (2 * (pair.dR + penetration))
    return pi / 2 * pair.E_star * penetration * sqrt(share)


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
    formula = Formula(
        of_pins_size, equation="f = pi/2*E_star*d*sqrt(d/(2*(dR + d))) with the penetration d"
    )
    contacts = ("internal",)
    any_plane = False

    @classmethod
    def models(cls) -> tuple[LawModel, ...]:
        """Return how the law is fitted: by factors of modulus and clearance."""
        return (scaled_model(cls()),)
