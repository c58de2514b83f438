"""A formula in one line for a pin in a hole of any two materials, by eighteen constants.

With d = δ/ΔR and φ = f/(E*·ΔR),

    φ = π·d/L,    L = c + ln[1 + (B/d)·(ln(1 + A/d + G/√d) + D)].

The five numbers depend on the materials alone. c is L at the arc that no load exceeds, from
`cylcontact.laws.parametric`; the others are polynomials in g = c − 1.4 and β:

    ln B = B0 + B1·g + B2·β + B3·g² + B4·gβ + B5·β²,    ln A = A0 + A1·g + A2·β,
    D    = D0 + D1·g + D2·β + D3·g² + D4·gβ + D5·β²,    G    = G0 + G1·g + G2·β.

The constants are calibrated (`fitting/explicit-pair.toml`) and rounded to the digits that the
accuracy needs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy import exp, log, log1p, maximum, pi, sqrt

from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.laws.arcs import CALIBRATED as P
from cylcontact.laws.arcs import arc, shares
from cylcontact.laws.formula import Formula
from cylcontact.laws.law import Constants, Law, constant
from cylcontact.support.arrays import FloatArray, as_floats


@dataclass(frozen=True)
class ExplicitPairCoefficients(Constants):
    """The eighteen constants of `ExplicitPair`.

    Raises
    ------
    InputError
        If one is not finite.
    """

    A0: float = constant(-1.0, 1.0, "coefficient of 1 in ln A", 0.108)
    A1: float = constant(-1.0, 1.0, "coefficient of g in ln A", 0.2164)
    A2: float = constant(0.0, 3.0, "coefficient of β in ln A", 1.4281)
    B0: float = constant(-2.0, 0.0, "coefficient of 1 in ln B", -0.9086)
    B1: float = constant(-2.5, -0.5, "coefficient of g in ln B", -1.4268)
    B2: float = constant(-1.0, 1.0, "coefficient of β in ln B", 0.0388)
    B3: float = constant(-3.0, 3.0, "coefficient of g² in ln B", -0.1754)
    B4: float = constant(-3.0, 3.0, "coefficient of gβ in ln B", 0.4352)
    B5: float = constant(-3.0, 3.0, "coefficient of β² in ln B", -0.1459)
    D0: float = constant(0.5, 2.5, "coefficient of 1 in D", 1.5739)
    D1: float = constant(0.5, 2.5, "coefficient of g in D", 1.4329)
    D2: float = constant(0.5, 2.5, "coefficient of β in D", 1.4019)
    D3: float = constant(-2.0, 4.0, "coefficient of g² in D", 0.8681)
    D4: float = constant(-5.0, 1.0, "coefficient of gβ in D", -1.5185)
    D5: float = constant(0.0, 5.0, "coefficient of β² in D", 2.5993)
    G0: float = constant(-2.0, 0.0, "coefficient of 1 in G", -0.9641)
    G1: float = constant(-1.5, 0.5, "coefficient of g in G", -0.6562)
    G2: float = constant(-1.0, 1.0, "coefficient of β in G", 0.0517)
    law = "ExplicitPair"


CALIBRATED = ExplicitPairCoefficients()


class PairNumbers(NamedTuple):
    """The five numbers of a pair in the formula of `ExplicitPair`."""

    c: FloatArray
    B: FloatArray
    A: FloatArray
    G: FloatArray
    D: FloatArray


def largest_arc(pair, x):
    """Return `arc` at x with the constants of `Parametric` and Johnson's datum."""
    w_i, w_j, _ = shares(pair.alpha, pair.beta)
    datum = 2 * log(2) - 2 + w_j
    return arc(x, w_i, w_j, pair.beta, datum, P.A0, P.A1, P.A2, P.A3, P.H3, P.M0, P.M1, P.M2)


def five(pair, A0, A1, A2, B0, B1, B2, B3, B4, B5, D0, D1, D2, D3, D4, D5, G0, G1, G2):
    """Return the five numbers, c by three steps of Newton's method to the arc where K = 0."""
    _, _, c0 = shares(pair.alpha, pair.beta)
    least = maximum(c0, 1e-6)
    x = log((1 - least) / least)
    for _ in range(3):
        S, rest, k, k_slope, L, L_slope, H, H_slope = largest_arc(pair, x)
        x = x - k / k_slope
    S, rest, k, k_slope, L, L_slope, H, H_slope = largest_arc(pair, x)
    g, b = L - 1.4, pair.beta
    B = exp(B0 + g * (B1 + B3 * g + B4 * b) + b * (B2 + B5 * b))
    D = D0 + g * (D1 + D3 * g + D4 * b) + b * (D2 + D5 * b)
    return L, B, exp(A0 + A1 * g + A2 * b), G0 + G1 * g + G2 * b, D


def load(penetration, pair, c, B, A, G, D):
    """Return f = π·E*·δ/L."""
    depth = penetration / pair.dR
    near = A / depth
    far = G / sqrt(depth)
    bracket = log(1 + near + far) + D
    outer = B / depth * bracket
    L = c + log1p(outer)
    return pi * pair.E_star * penetration / np.where(L > 0, L, np.nan)


_EQUATION = (
    "f = pi*E_star*penetration/L with depth = penetration/dR and "
    "L = c + ln(1 + B/depth*(ln(1 + A/depth + G/sqrt(depth)) + D))"
)
_REMARK = "The datum of the penetration is Johnson's, to whose law it tends at small loads."


@dataclass(frozen=True)
class ExplicitPair(Law):
    """A pin in a hole of any two materials in one line, within 1.1 % of `Conformal`.

    f = π·E*·δ/L with L = c + ln[1 + (B/d)·(ln(1 + A/d + G/√d) + D)] and d = δ/ΔR. `numbers` gives
    the five numbers of a pair. The penetration is counted so that it tends to Johnson's law at
    small loads.

    Parameters
    ----------
    coefficients : ExplicitPairCoefficients or mapping, optional
        By default the calibrated ones.

    Raises
    ------
    InputError
        When the law is evaluated, if the contact is external.

    Notes
    -----
    The error of the load is below 1.1 % for every α and β that two materials can have and
    1e-6 ≤ φ ≤ 60; `cylcontact figure fig_any_pair` maps it. `Parametric` is twenty times as close
    and takes five times as long; for two bodies of one material `Explicit` is ten times as close.

    Examples
    --------
    A steel pin in an aluminium plate:

    >>> from cylcontact import CylinderPair, Material
    >>> steel, aluminium = Material("steel", 207e3, 0.3), Material("aluminium", 70e3, 0.33)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.99, material=aluminium, material_j=steel)
    >>> law = ExplicitPair()
    >>> c, B, A, G, D = law.numbers(pair)
    >>> d = 0.5
    >>> L = c + np.log(1 + B / d * (np.log(1 + A / d + G / np.sqrt(d)) + D))
    >>> print(f"{np.pi * pair.E_star * 0.005 / L:.4f} N/mm, {law.load(0.005, pair):.4f} N/mm")
    400.3882 N/mm, 400.3882 N/mm
    """

    coefficients: ExplicitPairCoefficients | Mapping[str, float] | None = None
    name: ClassVar[str] = "explicit-pair"

    formula = Formula(load, five, equation=_EQUATION, remark=_REMARK)
    contacts = ("internal",)
    defaults: ClassVar[Mapping[Contact, Any]] = {"internal": CALIBRATED}
    published = False
    on_grid = True
    dimensionless = True

    def numbers(self, pair: CylinderPair) -> PairNumbers:
        """Return the five numbers of a pair, in the shape of its materials."""
        numbers = self.numbers_at(pair)
        return PairNumbers(*(as_floats(numbers[name]) for name in PairNumbers._fields))
