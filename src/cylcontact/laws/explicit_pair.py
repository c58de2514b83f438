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
from dataclasses import asdict, dataclass
from functools import partial
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, inside_or_nan, require
from cylcontact.html_repr import completed_law_html
from cylcontact.laws.conformal import in_units_of
from cylcontact.laws.contact_law import ContactLaw, Unlimited, depth_of, require_hole
from cylcontact.laws.definition import Coefficients, Definition, KernelSteps, LawModel, Parameter
from cylcontact.laws.explicit import depth_under
from cylcontact.laws.formula import Formula, function_name, needed
from cylcontact.laws.parametric import CALIBRATED as PARAMETRIC
from cylcontact.laws.parametric import CONDITIONS, LAST_STEPS, NAMED, Curve
from cylcontact.pair import Contact, CylinderPair

__all__ = ["CALIBRATED", "DEFINITION", "ExplicitPair", "ExplicitPairCoefficients", "PairNumbers"]

# From a start that is right to a third to machine precision.
_NEWTON_STEPS = 6
_MIDDLE = 1.4


@dataclass(frozen=True)
class ExplicitPairCoefficients:
    """The eighteen constants of `ExplicitPair`.

    Raises
    ------
    InputError
        If one is not finite.
    """

    A0: float
    A1: float
    A2: float
    B0: float
    B1: float
    B2: float
    B3: float
    B4: float
    B5: float
    D0: float
    D1: float
    D2: float
    D3: float
    D4: float
    D5: float
    G0: float
    G1: float
    G2: float

    def __post_init__(self) -> None:
        for key, value in asdict(self).items():
            remedy = "leave the coefficients out to use the calibrated ones"
            require(bool(np.isfinite(value)), "ExplicitPair", key, value, "must be finite", remedy)


CALIBRATED = ExplicitPairCoefficients(
    A0=0.108,
    A1=0.2164,
    A2=1.4281,
    B0=-0.9086,
    B1=-1.4268,
    B2=0.0388,
    B3=-0.1754,
    B4=0.4352,
    B5=-0.1459,
    D0=1.5739,
    D1=1.4329,
    D2=1.4019,
    D3=0.8681,
    D4=-1.5185,
    D5=2.5993,
    G0=-0.9641,
    G1=-0.6562,
    G2=0.0517,
)


class PairNumbers(NamedTuple):
    """The five numbers of a pair in the formula of `ExplicitPair`."""

    c: FloatArray
    B: FloatArray
    A: FloatArray
    G: FloatArray
    D: FloatArray


@dataclass(frozen=True)
class ExplicitPair(Unlimited):
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

    def __post_init__(self) -> None:
        if isinstance(self.coefficients, Mapping):
            chosen = ExplicitPairCoefficients(**self.coefficients)
            object.__setattr__(self, "coefficients", chosen)

    def _repr_html_(self) -> str:
        return completed_law_html(self, {"internal": CALIBRATED})

    @property
    def constants(self) -> ExplicitPairCoefficients:
        """The coefficients, by default the calibrated ones."""
        given = self.coefficients
        return given if isinstance(given, ExplicitPairCoefficients) else CALIBRATED

    def require_pair(self, pair: CylinderPair) -> None:
        """Raise `InputError` for external contact."""
        require_hole("ExplicitPair", pair)

    def numbers(self, pair: CylinderPair) -> PairNumbers:
        """Return the five numbers of a pair, in the shape of its materials."""
        self.require_pair(pair)
        w_i, w_j = pair.shares
        b = pair.beta
        c = Curve(w_i, w_j, b, as_floats(2 * np.log(2) - 2 + w_j), PARAMETRIC).largest().L
        g, by = c - _MIDDLE, self.constants
        log_B = by.B0 + by.B1 * g + by.B2 * b + by.B3 * g * g + by.B4 * g * b + by.B5 * b * b
        D = by.D0 + by.D1 * g + by.D2 * b + by.D3 * g * g + by.D4 * g * b + by.D5 * b * b
        A = np.exp(by.A0 + by.A1 * g + by.A2 * b)
        G = by.G0 + by.G1 * g + by.G2 * b
        return PairNumbers(*map(as_floats, (c, np.exp(log_B), A, G, D)))

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm.

        A fixed number of Newton steps on ln φ over ln d.
        """
        f, dR = as_floats(load), as_floats(pair.dR)
        touching, phi = in_units_of(pair.E_star * dR, f)
        some = phi > 0
        phi = np.where(some, phi, 1.0)
        numbers = self.numbers(pair)
        start = as_floats(phi / np.pi * (numbers.c + np.log1p(1.1 / phi)))
        d = depth_under(phi, start, partial(_logarithms, numbers=numbers), _NEWTON_STEPS)
        return inside_or_nan(np.where(some, d * dR, 0.0), touching)

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        delta = depth_of(penetration)
        L, _ = self._at(delta, pair)
        return as_floats(np.pi * pair.E_star * delta / L)

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm² at `penetration` in mm; zero at first touch."""
        delta = depth_of(penetration)
        L, slope = self._at(delta, pair)
        k = np.pi * pair.E_star * (1 - slope / L) / L
        return as_floats(np.where(delta == 0, 0.0, k))

    def _at(self, delta: FloatArray, pair: CylinderPair) -> tuple[FloatArray, FloatArray]:
        """Return L and dL/d(ln d), with δ replaced by 1 mm at first touch."""
        d = np.where(delta == 0, 1.0, delta) / as_floats(pair.dR)
        return _logarithms(as_floats(d), self.numbers(pair))


def _logarithms(d: FloatArray, numbers: PairNumbers) -> tuple[FloatArray, FloatArray]:
    """Return L and dL/d(ln d)."""
    c, B, A, G, D = numbers
    near, far = A / d, G / np.sqrt(d)
    inner = 1 + near + far
    with np.errstate(invalid="ignore"):  # constants of one's own may leave L undefined
        bracket = np.log(inner) + D
        outer = B / d * bracket
        slope = B / d * (-(near + far / 2) / inner - bracket)
        L = c + np.log1p(outer)
        return as_floats(np.where(L > 0, L, np.nan)), as_floats(slope / (1 + outer))


_STEPS = """
depth = 1 if penetration <= 0 else penetration / dR
near = A/depth
far = G/sqrt(depth)
inner = 1 + near + far
bracket = log(inner) + D
outer = B/depth*bracket
L = c + log1p(outer)
L_slope = B/depth*(-(near + far/2)/inner - bracket)/(1 + outer)
f = pi * E_star * penetration / L
k = 0 if penetration <= 0 else pi * E_star * (1 - L_slope/L) / L
"""
# How an exported function finds the five numbers; `less` is g.
_FIVE = f"""
c = last
less = c - {_MIDDLE}
A = exp(lnA_0 + lnA_1*less + lnA_2*beta)
B = exp(lnB_0 + less*(lnB_1 + lnB_3*less + lnB_4*beta) + beta*(lnB_2 + lnB_5*beta))
D = D_0 + less*(D_1 + D_3*less + D_4*beta) + beta*(D_2 + D_5*beta)
G = G_0 + G_1*less + G_2*beta
"""


def _numbers(law: ExplicitPair, pair: CylinderPair) -> tuple[float, ...]:
    """Return E*, ΔR and the five numbers."""
    return tuple(float(number) for number in (pair.E_star, pair.dR, *law.numbers(pair)))


def _formula(law: ExplicitPair, _: Contact | None) -> Formula:
    """Return the formula for export, with the steps that it needs of the largest arc."""
    own = {
        f"{'ln' if key[0] in 'AB' else ''}{key[0]}_{key[1]}": float(value)
        for key, value in asdict(law.constants).items()
    }
    return Formula(
        name=function_name(law.name, "internal"),
        law=law,
        contact="internal",
        equation=(
            "f = pi*E_star*penetration/L with depth = penetration/dR and "
            "L = c + ln(1 + B/depth*(ln(1 + A/depth + G/sqrt(depth)) + D))"
        ),
        text="\n".join(step.text for step in needed(LAST_STEPS + _FIVE + _STEPS, "f", "k")),
        coefficients=asdict(law.constants),
        constants=NAMED | own,
        extra=("alpha", "beta"),
        conditions=CONDITIONS,
        remark="The datum of the penetration is Johnson's, to whose law it tends at small loads.",
        origin="calibrated by this package" if law.coefficients is None else "",
    )


def _fitted(values: Coefficients) -> ContactLaw:
    """Return the law with these constants."""
    return ExplicitPair(coefficients=values)


_OF = {"A": "ln A", "B": "ln B", "D": "D", "G": "G"}
_TERMS = ("1", "g", "β", "g²", "gβ", "β²")
# Where the constants are searched, in the order of the terms.
_BOUNDS = {
    "A": ((-1, 1), (-1, 1), (0, 3)),
    "B": ((-2, 0), (-2.5, -0.5), (-1, 1), (-3, 3), (-3, 3), (-3, 3)),
    "D": ((0.5, 2.5), (0.5, 2.5), (0.5, 2.5), (-2, 4), (-5, 1), (0, 5)),
    "G": ((-2, 0), (-1.5, 0.5), (-1, 1)),
}


def _model() -> LawModel:
    """Return the model of the law."""
    parameters = tuple(
        Parameter(
            f"{letter}{number}",
            float(low),
            float(high),
            getattr(CALIBRATED, f"{letter}{number}"),
            meaning=f"coefficient of {_TERMS[number]} in {_OF[letter]}",
        )
        for letter, bounds in _BOUNDS.items()
        for number, (low, high) in enumerate(bounds)
    )
    return LawModel(
        ExplicitPair.name,
        "internal",
        parameters,
        _fitted,
        on_grid=True,
        dimensionless=True,
        nominal_is_published=False,
    )


DEFINITION = Definition(
    law=ExplicitPair,
    formula=_formula,
    kernel=KernelSteps(("E_star", "dR", "c", "B", "A", "G", "D"), _numbers, _STEPS),
    models=(_model(),),
    contacts=("internal",),
)
