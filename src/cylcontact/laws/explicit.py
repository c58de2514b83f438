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
from typing import Any, ClassVar

import numpy as np
from numpy import log, log1p, pi

from cylcontact.bodies.pair import Contact
from cylcontact.laws.formula import Formula
from cylcontact.laws.law import Constants, Law, constant
from cylcontact.support.arrays import require


def load(penetration, E_star, dR, c, A, B):
    """Return f = π·E*·δ/L."""
    d = penetration / dR
    ratio = A / d
    first = log(B / d)
    second = c + log1p(ratio * first)
    third = c + log1p(ratio * second)
    return pi * E_star * penetration / third


def stiffness(penetration, E_star, dR, c, A, B):
    """Return df/dδ = π·E*·(1 − d·L'/L)/L, with the fall −d·L' of each logarithm."""
    d = penetration / dR
    ratio = A / d
    first = log(B / d)
    second = c + log1p(ratio * first)
    third = c + log1p(ratio * second)
    second_fall = ratio * (first + 1) / (1 + ratio * first)
    third_fall = ratio * (second + second_fall) / (1 + ratio * second)
    return pi * E_star * (1 + third_fall / third) / third


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

    c: float = constant(0.5, 3.0, "constant in L")
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

    Notes
    -----
    Against Persson's load for internal contact the error is below 0.12 % for
    1e-6 ≤ φ ≤ 60, and against Johnson's for external contact below 0.07 % for
    1e-9 ≤ φ ≤ 0.02; `cylcontact figure fig_accuracy` shows the former. For different materials the
    law uses the E* of the pair.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> pair = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    >>> law = Explicit()
    >>> delta = law.penetration(100.0, pair)
    >>> print(f"{delta * 1e3:.4f} µm, {law.load(delta, pair):.10f} N/mm")
    1.5629 µm, 100.0000000000 N/mm
    """

    coefficients: ExplicitCoefficients | Mapping[str, float] | None = None
    name: ClassVar[str] = "explicit"
    formula: ClassVar[Formula] = Formula(load, stiffness, equation=_EQUATION, remark=_REMARK)
    defaults: ClassVar[Mapping[Contact, Any]] = CALIBRATED
    origin: ClassVar[str] = "calibrated by this package"
