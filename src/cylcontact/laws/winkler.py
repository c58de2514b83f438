"""Winkler's elastic foundation for a pin in a hole, for comparison."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, inside_or_nan, require
from cylcontact.html_repr import law_html
from cylcontact.laws.conformal import in_units_of
from cylcontact.laws.contact_law import Unlimited, depth_of, require_hole
from cylcontact.laws.definition import Definition, KernelSteps, LawModel, Parameter
from cylcontact.laws.formula import Formula, function_name
from cylcontact.pair import Contact, CylinderPair

__all__ = ["DEFINITION", "DEPTH", "Winkler"]

# Half of Z = π·E*·δ/f of Persson's law at complete contact, which gives both laws the same slope
# there.
DEPTH = 0.715238076324212

# Beyond these a power would underflow or overflow; the law is a pure power below, linear above.
_SMALL, _LARGE = 1e-200, 1e200


@dataclass(frozen=True)
class Winkler(Unlimited):
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

    >>> from cylcontact import CylinderPair, Material
    >>> from cylcontact.laws.conformal import Persson
    >>> pair = CylinderPair.from_dR("internal", 0.01, Material("steel", E=207e3, nu=0.3))
    >>> loads = np.array([1e-4, 1e-2, 0.1, 1.0, 10.0, 100.0]) * pair.E_star * pair.dR
    >>> ratio = Winkler().penetration(loads, pair) / Persson().penetration(loads, pair)
    >>> print(ratio.round(2))
    [3.3  1.26 0.95 0.94 0.99 1.  ]
    """

    depth: float = DEPTH
    name: ClassVar[str] = "winkler"
    _repr_html_ = law_html

    def __post_init__(self) -> None:
        require(
            self.depth > 0 and np.isfinite(self.depth),
            "Winkler",
            "depth",
            self.depth,
            "must be positive and finite",
            f"give h/R, e.g. {DEPTH:.3f}",
        )

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm."""
        touching, g = in_units_of(self._load_unit(pair), as_floats(load))
        return inside_or_nan(as_floats(pair.dR) * _penetration_number(g), touching)

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        d = depth_of(penetration) / as_floats(pair.dR)
        return as_floats(self._load_unit(pair) * _load_and_slope(d)[0])

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm² at `penetration` in mm."""
        d = depth_of(penetration) / as_floats(pair.dR)
        modulus = self._load_unit(pair) / as_floats(pair.dR)
        return as_floats(modulus * _load_and_slope(d)[1])

    def require_pair(self, pair: CylinderPair) -> None:
        """Raise `InputError` for external contact."""
        require_hole("Winkler", pair)

    def _load_unit(self, pair: CylinderPair) -> FloatArray:
        """Return E*·ΔR·R/h in N/mm; raise `InputError` for an external pair."""
        self.require_pair(pair)
        return as_floats(pair.E_star * as_floats(pair.dR) / self.depth)


def _load_and_slope(d: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return (1 + d)·ε − sin ε and its derivative ε + sin ε·cos ε, with cos ε = 1/(1 + d)."""
    # In x = 2ε, with ε by arctan, because arccos and the difference lose digits at small d.
    x = 2 * np.arctan(np.sqrt(d) * np.sqrt(2 + d))
    sine = np.sin(x)
    return as_floats((1 + d) * _excess_over_sine(x, sine) / 2), as_floats((x + sine) / 2)


def _penetration_number(g: FloatArray) -> FloatArray:
    """Return the d whose load number is g.

    The start, the sum of the laws for small and for large loads, is within 54 %. Five Newton steps
    reach machine precision, from above because the load is convex in d.
    """
    inner = np.clip(g, _SMALL, _LARGE)
    d = (1.5 * inner) ** (2 / 3) / 2 + 2 / np.pi * inner
    for _ in range(5):
        value, slope = _load_and_slope(d)
        d = d + (inner - value) / slope
    return as_floats(d * (g / inner))


def _excess_over_sine(x: FloatArray, sine: FloatArray) -> FloatArray:
    """Return x − sin x for x ≥ 0, by its power series where the difference loses digits."""
    square = np.minimum(x, 1.0) ** 2
    series = np.ones_like(square)
    for k in range(18, 2, -2):
        series = 1 - square / (k * (k + 1)) * series
    return as_floats(np.where(x < 1, x * x * x / 6 * series, x - sine))


# x - sin x by its power series where the difference loses digits, as `_excess_over_sine`.
_STEPS = """
d = penetration / dR
x = 2 * atan(sqrt(d) * sqrt(2 + d))
small = x if x < 1 else 1
square = small * small
s18 = 1 - square / 342
s16 = 1 - square / 272 * s18
s14 = 1 - square / 210 * s16
s12 = 1 - square / 156 * s14
s10 = 1 - square / 110 * s12
s8 = 1 - square / 72 * s10
s6 = 1 - square / 42 * s8
s4 = 1 - square / 20 * s6
excess = x * x * x / 6 * s4 if x < 1 else x - sin(x)
f = E_star * dR / depth * ((1 + d) * excess / 2)
k = E_star / depth * ((x + sin(x)) / 2)
"""


def _numbers(law: Winkler, pair: CylinderPair) -> tuple[float, float, float]:
    """Return E*, ΔR and h/R."""
    return float(pair.E_star), float(np.asarray(pair.dR)), float(law.depth)


def _formula(law: Winkler, _: Contact | None) -> Formula:
    """Return the formula for export."""
    numbers = {"depth": float(law.depth)}
    chosen = "assumed, for the slope of conformal contact at large loads"
    return Formula(
        name=function_name(law.name),
        law=law,
        contact="internal",
        equation=(
            "f = E_star/depth*((dR + penetration)*angle - dR*sin(angle)) with "
            "cos(angle) = dR/(dR + penetration)"
        ),
        text=_STEPS,
        coefficients=numbers,
        constants=numbers,
        remark="depth is that of the foundation in units of the radius, an assumption.",
        origin=chosen if law.depth == DEPTH else "",
    )


_DEPTH = Parameter(
    "depth",
    0.05,
    20.0,
    nominal=DEPTH,
    stiffness=True,
    meaning="depth of the foundation over the radius",
)
DEFINITION = Definition(
    law=Winkler,
    formula=_formula,
    kernel=KernelSteps(("E_star", "dR", "depth"), _numbers, _STEPS),
    models=(
        LawModel(
            "winkler",
            "internal",
            (_DEPTH,),
            lambda values: Winkler(depth=values["depth"]),
            nominal_is_published=False,
        ),
    ),
    contacts=("internal",),
)
