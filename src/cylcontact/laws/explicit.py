"""An explicit, dimensionless law, close to conformal contact for every penetration.

In φ = f/(E*·ΔR) and d = δ/ΔR every elastic law of two cylinders of the same material is one curve.
The penetration is well approximated by d = (φ/π)·[c + ln(1 + A/φ)]: logarithmic for small loads,
linear for large ones. Substituting the relation into itself three times, starting from ln(B/d),
gives the load

    φ = π·d/L,    L = c + ln(1 + (A/d)·[c + ln(1 + (A/d)·ln(B/d))]),

with three logarithms, three constants and no iteration, smooth and increasing for every d > 0. The
constants are calibrated by this package: for internal contact to Persson's solution
(`fitting/explicit-internal.toml`), for external contact to Johnson's law
(`fitting/explicit-external.toml`). They are rounded to the digits that the accuracy needs.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy import log, log1p, pi
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.laws.explicit_pair import load as five_logarithms
from cylcontact.laws.formula import Formula
from cylcontact.laws.housed import FiveConstants, five_constants, not_by_itself
from cylcontact.laws.housing import Housing
from cylcontact.laws.law import AtPair, Constants, Law, constant, require_hole
from cylcontact.laws.parametric import Parametric
from cylcontact.support.arrays import FloatArray, as_floats, inside_or_nan, require


def load(penetration, pair, c, A, B):
    """Return f = π·E*·δ/L."""
    d = penetration / pair.dR
    ratio = A / d
    first = log(B / d)
    second = c + log1p(ratio * first)
    third = c + log1p(ratio * second)
    return pi * pair.E_star * penetration / third


_FIVE = Formula(five_logarithms)
_EQUATION = (
    "f = pi*E_star*penetration/L with d = penetration/dR and "
    "L = c + ln(1 + A/d*(c + ln(1 + A/d*ln(B/d))))"
)
_REMARK = "Dimensionless in penetration/dR and f/(E_star*dR); no largest penetration."


@dataclass(frozen=True)
class ExplicitCoefficients(Constants):
    """The constants c, A and B of the explicit law, all positive.

    Raises
    ------
    InputError
        If one is not positive and finite, or the law is not defined for every penetration.
    """

    c: float = constant(0.5, 3.0, "constant in L", shift=True)
    A: float = constant(0.05, 5.0, "factor of 1/d in the logarithms")
    B: float = constant(0.5, 20.0, "numerator of the innermost logarithm")
    law = "Explicit"

    def __post_init__(self) -> None:
        for key, value in vars(self).items():
            remedy = "leave the coefficients out to use the calibrated ones"
            positive = bool(value > 0 and np.isfinite(value))
            require(positive, "Explicit", key, value, "must be positive and finite", remedy)
        # The innermost 1 + (A/d)·ln(B/d) is least, 1 − A/(e·B), at d = e·B. If c + ln of that is
        # positive, so are the arguments of the other logarithms.
        least = 1 - self.A / (math.e * self.B)
        require(
            least > 0 and self.c + math.log(least) > 0,
            "Explicit",
            "c, A, B",
            (self.c, self.A, self.B),
            "c + ln(1 − A/(e·B)) must be positive, or a logarithm fails at some penetration",
            "raise c or B, or lower A",
        )


CALIBRATED: Mapping[Contact, ExplicitCoefficients] = {
    "internal": ExplicitCoefficients(c=1.427, A=0.3602, B=3.84),
    "external": ExplicitCoefficients(c=1.427, A=0.3597, B=2.78),
}


@dataclass(frozen=True)
class Explicit(Law):
    """The explicit law of this package, f = π·E*·δ/L(δ/ΔR) with three logarithms in L.

    Parameters
    ----------
    coefficients : ExplicitCoefficients or mapping, optional
        By default those calibrated for the contact of the pair.
    datum : "johnson" or Housing
        Where the penetration of a pin in a hole is counted from. In a housing the law is
        f = π·E*·δ/{c + ln[1 + (B/d)·(ln(1 + A/d + G/√d) + D)]} with five constants fitted to
        `Parametric` for each joint (`five_constants`), materials and all. Where they miss it by
        more than 1 %, as for thin eyes in pull, the law is that of `Parametric` itself.

    Notes
    -----
    Against Persson's load for internal contact the error is below 0.12 % for
    1e-6 ≤ φ ≤ 60, and against Johnson's for external contact below 0.07 % for
    1e-9 ≤ φ ≤ 0.02; `cylcontact figure fig_explicit` prints both. For different materials the
    law uses the E* of the pair.

    Examples
    --------
    >>> from cylcontact import Material
    >>> pair = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    >>> law = Explicit()
    >>> delta = law.penetration(100.0, pair)
    >>> print(f"{delta * 1e3:.4f} µm, {law.load(delta, pair):.10f} N/mm")
    1.5629 µm, 100.0000000000 N/mm
    """

    coefficients: ExplicitCoefficients | Mapping[str, float] | None = None
    datum: Literal["johnson"] | Housing = "johnson"
    name: ClassVar[str] = "explicit"

    def __post_init__(self) -> None:
        known = self.datum == "johnson" or isinstance(self.datum, Housing)
        remedy = "e.g. datum=laws.Housing(R_o=20.0), without coefficients"
        rule = "must be 'johnson' or a Housing, whose coefficients are fitted"
        alone = self.datum == "johnson" or self.coefficients is None
        require(known and alone, "Explicit", "datum", self.datum, rule, remedy)
        super().__post_init__()

    formula = Formula(load, equation=_EQUATION, remark=_REMARK)
    defaults = CALIBRATED
    published = False
    on_grid = True
    dimensionless = True

    def constants_for(self, contact: Contact) -> dict[str, float]:
        """Return the constants by name."""
        if isinstance(self.datum, Housing):
            raise not_by_itself(self.datum)
        return super().constants_for(contact)

    def five_constants(self, pair: CylinderPair) -> FiveConstants:
        """Return the five constants in the housing, and how far the law is from `Parametric`."""
        housing = self.datum
        require(
            isinstance(housing, Housing), "Explicit", "datum", housing, "has no five constants",
            "give a housing, e.g. datum=laws.Housing(R_o=20.0)",
        )  # fmt: skip
        require_hole("Explicit", pair)
        return five_constants(housing, pair)  # type: ignore[arg-type]

    def formula_at(self, pair: CylinderPair) -> Formula | None:
        """Return the formula; None in a housing that its five constants do not follow."""
        if not isinstance(self.datum, Housing):
            return self.formula
        return _FIVE if self.five_constants(pair).is_close else None

    def numbers_at(self, pair: CylinderPair) -> dict[str, FloatArray]:
        """Return the numbers of the formula at a pair."""
        if not isinstance(self.datum, Housing):
            return super().numbers_at(pair)
        c, B, A, G, D, _ = self.five_constants(pair)
        values = _FIVE.of_pair(E_star=pair.E_star, dR=pair.dR, c=c, B=B, A=A, G=G, D=D)
        return dict(zip(_FIVE.numbers, map(as_floats, values), strict=True))

    def table(self, pair: CylinderPair) -> FloatArray:
        """Return ln f over ln δ in a housing, as compiled code takes it."""
        return Parametric(self.datum).table(pair)

    def at_pair(self, pair: CylinderPair) -> AtPair:
        """Return the law at a pair."""
        if not isinstance(self.datum, Housing):
            return super().at_pair(pair)
        require_hole("Explicit", pair)
        parametric = Parametric(self.datum).at_pair(pair)
        has_formula = parametric.is_single and self.five_constants(pair).is_close
        return super().at_pair(pair) if has_formula else parametric


def explicit_penetration(load: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return the penetration in mm by one formula, d = (φ/π)·[1.4232 + ln(1 + 1.0942/φ)].

    Parameters
    ----------
    load : array_like
        Load per unit length in N/mm.
    pair : CylinderPair
        The pair.

    Returns
    -------
    array of float
        Within 0.37 % of Persson's penetration for 1e-6 ≤ φ ≤ 60 (internal contact); NaN where
        the load is negative. The exact inverse of `Explicit.load` is `Explicit.penetration`.

    Examples
    --------
    >>> from cylcontact import Material
    >>> pair = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    >>> print(f"{explicit_penetration(100.0, pair) * 1e3:.3f} µm")
    1.559 µm
    """
    dR, f = as_floats(pair.dR), as_floats(load)
    positive = f > 0
    phi = np.where(positive, f, 1.0) / (pair.E_star * dR)
    d = phi / np.pi * (1.4232 + np.log1p(1.0942 / phi))
    return inside_or_nan(np.where(positive, d * dR, 0.0), f >= 0)
