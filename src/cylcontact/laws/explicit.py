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
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from functools import partial
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, inside_or_nan, require
from cylcontact.html_repr import completed_law_html
from cylcontact.laws.contact_law import ContactLaw, Unlimited
from cylcontact.laws.definition import Coefficients, Definition, KernelSteps, LawModel, Parameter
from cylcontact.laws.formula import Formula, function_name, required_contact
from cylcontact.pair import CONTACTS, Contact, CylinderPair

__all__ = [
    "CALIBRATED",
    "DEFINITION",
    "Explicit",
    "ExplicitCoefficients",
    "depth_under",
    "explicit_penetration",
    "is_defined",
]

# The start has an error below half a percent; this many steps reach machine precision.
_NEWTON_STEPS = 5


@dataclass(frozen=True)
class ExplicitCoefficients:
    """The constants c, A and B of the explicit law, all positive.

    Raises
    ------
    InputError
        If one is not positive and finite, or the law is not defined for every penetration.
    """

    c: float
    A: float
    B: float

    def __post_init__(self) -> None:
        for key in ("c", "A", "B"):
            value = getattr(self, key)
            require(
                bool(value > 0 and np.isfinite(value)),
                "Explicit",
                key,
                value,
                "must be positive and finite",
                "leave the coefficients out to use the calibrated ones",
            )
        require(
            is_defined(self.c, self.A, self.B),
            "Explicit",
            "c, A, B",
            (self.c, self.A, self.B),
            "c + ln(1 − A/(e·B)) must be positive, or a logarithm fails at some penetration",
            "raise c or B, or lower A",
        )


def is_defined(c: float, A: float, B: float) -> bool:
    """Return whether the law with these constants is defined for every penetration.

    The innermost 1 + (A/d)·ln(B/d) has its minimum 1 − A/(e·B) at d = e·B. If c + ln of this
    minimum is positive, so are the arguments of the other logarithms.
    """
    least = 1 - A / (math.e * B) if B > 0 else 0.0
    return bool(min(c, A, B, least) > 0 and c + np.log(least) > 0)


CALIBRATED: Mapping[Contact, ExplicitCoefficients] = {
    "internal": ExplicitCoefficients(c=1.427, A=0.3602, B=3.84),
    "external": ExplicitCoefficients(c=1.427, A=0.3597, B=2.78),
}


@dataclass(frozen=True)
class Explicit(Unlimited):
    """The explicit law of this package, f = π·E*·δ/L(δ/ΔR) with three logarithms in L.

    Parameters
    ----------
    coefficients : ExplicitCoefficients or mapping, optional
        By default those calibrated for the contact of the pair.

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
    name: ClassVar[str] = "explicit"

    def __post_init__(self) -> None:
        if isinstance(self.coefficients, Mapping):
            object.__setattr__(self, "coefficients", ExplicitCoefficients(**self.coefficients))

    def _repr_html_(self) -> str:
        return completed_law_html(self, CALIBRATED)

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm.

        A fixed number of Newton steps on ln φ over ln d, starting from `explicit_penetration`.
        """
        dR, f = as_floats(pair.dR), as_floats(load)
        positive = f > 0
        phi = np.where(positive, f, 1.0) / (pair.E_star * dR)
        d = depth_under(phi, _start(phi), partial(self._logarithms, contact=pair.contact))
        return inside_or_nan(np.where(positive, d * dR, 0.0), f >= 0)

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        delta, d = self._depth(penetration, pair)
        L, _ = self._logarithms(d, pair.contact)
        depth = np.where(delta <= 0, 0.0, d * as_floats(pair.dR))
        return as_floats(np.pi * pair.E_star * depth / L)

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm²; zero at zero penetration."""
        delta, d = self._depth(penetration, pair)
        L, slope = self._logarithms(d, pair.contact)
        k = np.pi * pair.E_star * (1 - slope / L) / L
        return as_floats(np.where(delta <= 0, 0.0, k))

    def coefficients_for(self, contact: Contact) -> ExplicitCoefficients:
        """Return the coefficients of this law, by default those calibrated for `contact`."""
        given = self.coefficients
        return given if isinstance(given, ExplicitCoefficients) else CALIBRATED[contact]

    def _depth(self, penetration: ArrayLike, pair: CylinderPair) -> tuple[FloatArray, FloatArray]:
        """Return δ in mm, and δ/ΔR with δ replaced by 1 where it is not positive."""
        delta = as_floats(penetration)
        return delta, as_floats(np.where(delta <= 0, 1.0, delta) / as_floats(pair.dR))

    def _logarithms(self, d: FloatArray, contact: Contact) -> tuple[FloatArray, FloatArray]:
        """Return L and dL/d(ln d)."""
        chosen = self.coefficients_for(contact)
        c, ratio = chosen.c, chosen.A / d
        inner = np.log(chosen.B / d)
        middle = c + np.log1p(ratio * inner)
        outer = c + np.log1p(ratio * middle)
        middle_slope = -ratio * (inner + 1) / (1 + ratio * inner)
        outer_slope = ratio * (middle_slope - middle) / (1 + ratio * middle)
        return as_floats(outer), as_floats(outer_slope)


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
    return inside_or_nan(np.where(positive, _start(phi) * dR, 0.0), f >= 0)


def _start(phi: FloatArray) -> FloatArray:
    """Return δ/ΔR from φ by the explicit formula for the penetration."""
    return as_floats(phi / np.pi * (1.4232 + np.log1p(1.0942 / phi)))


def depth_under(
    phi: FloatArray,
    d: FloatArray,
    logarithms: Callable[[FloatArray], tuple[FloatArray, FloatArray]],
    steps: int = _NEWTON_STEPS,
) -> FloatArray:
    """Return δ/ΔR under the load φ > 0 of a law φ = π·d/L(d), from a start.

    A fixed number of Newton steps on ln φ over ln d; `logarithms` returns L and dL/d(ln d).
    """
    for _ in range(steps):
        L, slope = logarithms(d)
        d = as_floats(d * np.exp(-np.log(np.pi * d / (L * phi)) / (1 - slope / L)))
    return d


_STEPS = """
d = 1 if penetration <= 0 else penetration / dR
ratio = A / d
first = log(B / d)
second = c + log1p(ratio * first)
third = c + log1p(ratio * second)
second_slope = -(ratio * (first + 1)) / (1 + ratio * first)
third_slope = ratio * (second_slope - second) / (1 + ratio * second)
f = pi * E_star * penetration / third
k = 0 if penetration <= 0 else pi * E_star * (1 - third_slope / third) / third
"""


def _numbers(law: Explicit, pair: CylinderPair) -> tuple[float, ...]:
    """Return E*, ΔR and the constants."""
    chosen = law.coefficients_for(pair.contact)
    return float(pair.E_star), float(np.asarray(pair.dR)), chosen.c, chosen.A, chosen.B


def _formula(law: Explicit, contact: Contact | None) -> Formula:
    """Return the formula for export, with the constants calibrated for the contact by default."""
    own = law.coefficients
    chosen = (
        own
        if isinstance(own, ExplicitCoefficients)
        else CALIBRATED[required_contact(contact, law.name)]
    )
    numbers = {name: float(value) for name, value in asdict(chosen).items()}
    return Formula(
        name=function_name(law.name, contact),
        law=law,
        contact=contact,
        equation=(
            "f = pi*E_star*penetration/L with d = penetration/dR and "
            "L = c + ln(1 + A/d*(c + ln(1 + A/d*ln(B/d))))"
        ),
        text=_STEPS,
        coefficients=numbers,
        constants=numbers,
        remark="Dimensionless in penetration/dR and f/(E_star*dR); no largest penetration.",
        origin="calibrated for the contact" if own is None else "",
    )


def _fitted(values: Coefficients) -> ContactLaw:
    """Return the law with these constants."""
    return Explicit(coefficients=values)


def _model(contact: Contact) -> LawModel:
    """Return the model of the law, with the calibrated constants as nominal values."""
    nominal = CALIBRATED[contact]
    parameters = (
        Parameter("c", 0.5, 3.0, nominal.c, shift=True, meaning="constant in L"),
        Parameter("A", 0.05, 5.0, nominal.A, meaning="factor of 1/d in the logarithms"),
        Parameter("B", 0.5, 20.0, nominal.B, meaning="numerator of the innermost logarithm"),
    )
    return LawModel(
        "explicit",
        contact,
        parameters,
        _fitted,
        on_grid=True,
        dimensionless=True,
        nominal_is_published=False,
    )


DEFINITION = Definition(
    law=Explicit,
    formula=_formula,
    kernel=KernelSteps(("E_star", "dR", "c", "A", "B"), _numbers, _STEPS),
    models=tuple(_model(contact) for contact in CONTACTS),
)
