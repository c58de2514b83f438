"""The fast law for a pin in a hole of any two materials: `Conformal` with eight constants.

In the solution of `laws.conformal` the functions 2Â, H and M of the arc have closed forms
at β = 0. For other β this law adds β times a polynomial in u = sin(ε/2) = √S to each:

    2Â = [(1 − S)² + βu(A0 + A1·u + A2·u² + A3·u³)]/S,
    H  = 2S − (1 − S)²·ln(1 − S)/S + H3·βu³,
    M  = −ln S + S²/2 + H(β = 0) + βu(M0 + M1·u + M2·u²),

and with K = 2Â − w_i·H and L = M − w_j·H + C, as there, δ/ΔR = d is the root of d·K = L, and
φ = π·d/L. A0 = −16/(3π) and M0 = 80/(9π) are the limits for small arcs, where the pressure is
Hertz's. The other six are calibrated (`fitting/parametric.toml`) and rounded to the digits that
the accuracy needs.

**No iteration to watch.** A start from two formulas, for small arcs and for the largest, is within
a factor of two of tan²(ε/2) for all pairs; four steps of Newton's method then reach the last
digits, for every penetration. The kernel and the exported function take the same steps.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, inside_or_nan, require
from cylcontact.errors import InputError
from cylcontact.html_repr import law_html
from cylcontact.laws.conformal import Conformal, in_units_of
from cylcontact.laws.contact_law import ContactLaw, depth_of
from cylcontact.laws.definition import Coefficients, Definition, KernelSteps, LawModel, Parameter
from cylcontact.laws.formula import Formula, function_name
from cylcontact.laws.glauert import estimated_c
from cylcontact.laws.housing import Housing as ClampedPlate
from cylcontact.pair import Contact, CylinderPair

__all__ = [
    "CALIBRATED",
    "CONDITIONS",
    "DEFINITION",
    "LAST_STEPS",
    "NAMED",
    "Curve",
    "Parametric",
    "ParametricCoefficients",
]

# Steps of Newton's method to the arc of a load or penetration, and to the largest arc.
_NEWTON_STEPS, _LARGEST_STEPS = 4, 3
# Numbers at a time: what the steps hold of them stays in the cache of a core.
_BLOCK = 8192
# Used instead of zero and infinity for d, and for φ.
_SMALL, _HUGE = 1e-300, 1e300
# About L − C + C_J for the largest arc, C_J being Johnson's datum, and the least start for L.
_LAST_L, _LEAST_L = 1.43, 0.1
# The largest arc is not sought beyond this 1 − S.
_LEAST_C = 1e-6


@dataclass(frozen=True)
class ParametricCoefficients:
    """The constants of the polynomials of `Parametric`, of which A0 and M0 are exact.

    Raises
    ------
    InputError
        If one is not finite.
    """

    A1: float
    A2: float
    A3: float
    H3: float
    M1: float
    M2: float
    A0: float = -16 / (3 * np.pi)
    M0: float = 80 / (9 * np.pi)

    def __post_init__(self) -> None:
        for key, value in asdict(self).items():
            remedy = "leave the coefficients out to use the calibrated ones"
            require(bool(np.isfinite(value)), "Parametric", key, value, "must be finite", remedy)


CALIBRATED = ParametricCoefficients(
    A1=1.6238, A2=0.3116, A3=-2.1986, H3=0.0053, M1=-1.1141, M2=0.6367
)


class _Terms(NamedTuple):
    """Functions of an arc: S, c = 1 − S, k = S·K and L, and the slopes of the last two by ln b²."""

    S: FloatArray
    c: FloatArray
    k: FloatArray
    k_slope: FloatArray
    L: FloatArray
    L_slope: FloatArray


class _Solved(NamedTuple):
    """An arc one step of Newton's method before the root, and L at the root."""

    at: _Terms
    L: FloatArray


# From an arc to what K has to equal there, and its slope by ln b².
_Target = Callable[[_Terms], tuple[FloatArray, FloatArray | float]]


@dataclass(frozen=True)
class Curve:
    """The curve of one pair, or of an array of pairs."""

    w_i: FloatArray
    w_j: FloatArray
    beta: FloatArray
    C: FloatArray
    constants: ParametricCoefficients

    def terms(self, x: FloatArray) -> _Terms:
        """Return the arc with tan²(ε/2) = b² = eˣ."""
        by = self.constants
        b2 = np.exp(x)
        c = 1 / (1 + b2)
        S, fall, half = b2 * c, np.log1p(b2), c / 2  # fall = −ln(1 − S); half is u'/u
        u, cc = np.sqrt(S), c * c
        v = self.beta * u
        h = 2 * S + cc * fall / S
        h_slope = c * (2 * S + c - c * fall * (2 + c / S))
        added = by.H3 * v * S
        H, H_slope = h + added, h_slope + 3 * half * added
        k = cc + v * (by.A0 + u * (by.A1 + u * (by.A2 + u * by.A3))) - self.w_i * S * H
        bent = v * half * (by.A0 + u * (2 * by.A1 + u * (3 * by.A2 + u * (4 * by.A3))))
        k_slope = bent - 2 * S * cc - self.w_i * S * (c * H + H_slope)
        L = fall - x + S * S / 2 + h + v * (by.M0 + u * (by.M1 + u * by.M2)) - self.w_j * H + self.C
        bent = v * half * (by.M0 + u * (2 * by.M1 + u * (3 * by.M2)))
        L_slope = c * (S * S - 1) + h_slope + bent - self.w_j * H_slope
        return _Terms(S, c, k, k_slope, L, L_slope)

    def arc_of_load(self, phi: FloatArray) -> _Solved:
        """Return the arc under the load φ ≥ 0."""
        K = np.pi / np.clip(phi, _SMALL, _HUGE)
        return self._solved(K, lambda _: (K, 0.0), _NEWTON_STEPS)

    def arc_of_penetration(self, d: FloatArray, steps: int = _NEWTON_STEPS) -> _Solved:
        """Return the arc at the penetration d ≥ 0."""
        each = 1 / np.clip(d, _SMALL, _HUGE)
        L = self.C - (2 * np.log(2) - 2 + self.w_j) + np.log(np.exp(_LAST_L) + 4 * each)
        start = np.maximum(L, _LEAST_L) * each
        return self._solved(start, lambda at: (at.L * each, at.L_slope * each), steps)

    def largest(self) -> _Terms:
        """Return the arc that no load exceeds, where K = 0."""
        c = np.maximum(self._last_c(), _LEAST_C)
        x = as_floats(np.log((1 - c) / c))
        for _ in range(_LARGEST_STEPS):
            at = self.terms(x)
            x = x - at.k / at.k_slope
        return self.terms(x)

    def compliance(self, d: FloatArray) -> FloatArray:
        """Return π·E*·dδ/df at the penetration d ≥ 0."""
        at = self.arc_of_penetration(d, _NEWTON_STEPS + 1).at
        slope = at.k_slope - at.c * at.k  # that of K, times S
        return as_floats(at.L - at.L_slope * at.k / slope)

    def _solved(self, K: FloatArray, target: _Target, steps: int) -> _Solved:
        """Return the arc at which K equals its target, from about its value there."""
        c = self._last_c()
        q = K + c * c / (1 - c)  # K as if it differed from (1 − S)²/S by a constant
        x = as_floats(-np.log(q * (1 + np.sqrt(1 + 4 / q)) / 2))  # the root of q·b²·(1 + b²) = 1
        with np.errstate(over="ignore", invalid="ignore"):  # own constants may have no root
            for _ in range(steps):
                at = self.terms(x)
                value, slope = target(at)
                step = (at.S * value - at.k) / (at.k_slope - at.S * (at.c * value + slope))
                x = x + step
            L = at.L + at.L_slope * step
            return _Solved(at, as_floats(np.where(L > 0, L, np.nan)))

    def _last_c(self) -> FloatArray:
        """Return about 1 − S of the largest arc."""
        return estimated_c(np.maximum(self.w_i + self.beta, 0))  # rounding may go below


def _in_blocks(
    answer: Callable[[FloatArray, Curve], FloatArray], numbers: FloatArray, curve: Curve
) -> FloatArray:
    """Return `answer` of loads or penetrations, of many on one curve block by block."""
    if np.size(curve.beta) > 1 or np.size(curve.C) > 1 or numbers.size <= _BLOCK:
        return answer(numbers, curve)
    flat = numbers.ravel()
    blocks = (flat[first : first + _BLOCK] for first in range(0, flat.size, _BLOCK))
    return np.concatenate([answer(block, curve) for block in blocks]).reshape(numbers.shape)


@dataclass(frozen=True)
class Parametric(Conformal):
    """A pin in a hole of any two materials, by eight constants: fast, and within 0.06 %.

    The law of `Conformal` with polynomials in place of its series: penetration, load and stiffness
    are elementary functions. Exact for β = 0, as for two bodies of one material. The contact angle
    and the largest pressure are those of `Conformal`.

    Parameters
    ----------
    datum : "johnson" or float
        Where the penetration is counted from, as for `Conformal`.
    coefficients : ParametricCoefficients or mapping, optional
        By default the calibrated ones.

    Raises
    ------
    InputError
        As for `Conformal`.

    Notes
    -----
    For every α and β that two materials can have and 1e-6 ≤ φ ≤ 60, with Johnson's datum, the error
    against `Conformal` is below 0.06 % in penetration and load; `cylcontact figure fig_any_pair`
    maps it. Load and penetration invert each other to a few units in the last place, to fewer
    digits with a C next to the least that the pair allows.

    Examples
    --------
    A steel pin in an aluminium plate, counted from C = 1.744896:

    >>> from cylcontact import CylinderPair, Material, laws
    >>> steel, aluminium = Material("steel", 207e3, 0.3), Material("aluminium", 70e3, 0.33)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.99, material=aluminium, material_j=steel)
    >>> fast, reference = Parametric(1.744896), Conformal(1.744896)
    >>> print(f"{fast.load(0.01, pair):.2f} N/mm, {reference.load(0.01, pair):.2f} N/mm")
    422.12 N/mm, 422.12 N/mm
    """

    coefficients: ParametricCoefficients | Mapping[str, float] | None = None
    name: ClassVar[str] = "parametric"
    _repr_html_ = law_html

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.coefficients, Mapping):
            object.__setattr__(self, "coefficients", ParametricCoefficients(**self.coefficients))

    @property
    def constants(self) -> ParametricCoefficients:
        """The coefficients, by default the calibrated ones."""
        given = self.coefficients
        return given if isinstance(given, ParametricCoefficients) else CALIBRATED

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm."""
        f = as_floats(load)
        touching, phi = in_units_of(self.load_unit(pair), f)
        L = _in_blocks(lambda part, curve: curve.arc_of_load(part).L, phi, self._curve(pair))
        return inside_or_nan(f / (np.pi * pair.E_star) * L, touching)

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm."""
        delta = depth_of(penetration)
        touching, d = in_units_of(self.load_unit(pair) / pair.E_star, delta)
        L = _in_blocks(lambda part, curve: curve.arc_of_penetration(part).L, d, self._curve(pair))
        return inside_or_nan(np.pi * pair.E_star * (delta / L), touching)

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm² at `penetration` in mm; 0 at first touch."""
        delta = depth_of(penetration)
        touching, d = in_units_of(self.load_unit(pair) / pair.E_star, delta)
        compliance = _in_blocks(lambda part, curve: curve.compliance(part), d, self._curve(pair))
        stiffness = np.pi * pair.E_star / compliance
        return inside_or_nan(np.where(delta == 0, 0.0, stiffness), touching)

    def _curve(self, pair: CylinderPair) -> Curve:
        """Return the curve of a pair, if the datum suits it."""
        self.require_datum(pair)
        w_i, w_j = pair.shares
        return Curve(w_i, w_j, pair.beta, self.constant(pair), self.constants)


# Newton's method needs names of its own for each step: its number replaces @, the next one %.
_SHARES = """
w_i = (1 - alpha) / 2
w_j = (1 + alpha) / 2
root = sqrt(max(w_i + beta, 0))
c0 = sqrt(2)*root / (1 + 1.17*root)
"""
_START = f"""
d = 1 if penetration <= 0 else penetration / dR
L0 = max(datum - 2*log(2) + 2 - w_j + log(exp({_LAST_L}) + 4/d), {_LEAST_L})
q = L0/d + c0*c0/(1 - c0)
x1 = -log(q*(1 + sqrt(1 + 4/q))/2)
"""
_ARC = """
b@ = exp(x@)
c@ = 1 / (1 + b@)
S@ = b@*c@
fall@ = log1p(b@)
u@ = sqrt(S@)
v@ = beta*u@
closed@ = 2*S@ + c@*c@*fall@/S@
rise@ = c@*(2*S@ + c@ - c@*fall@*(2 + c@/S@))
H@ = closed@ + H_3*v@*S@
H_slope@ = rise@ + 1.5*c@*H_3*v@*S@
K@ = c@*c@ + v@*(A_0 + u@*(A_1 + u@*(A_2 + u@*A_3))) - w_i*S@*H@
A_slope@ = v@*c@/2*(A_0 + u@*(2*A_1 + u@*(3*A_2 + u@*4*A_3)))
K_slope@ = A_slope@ - 2*S@*c@*c@ - w_i*S@*(c@*H@ + H_slope@)
M@ = fall@ - x@ + S@*S@/2 + closed@ + v@*(M_0 + u@*(M_1 + u@*M_2))
L@ = M@ - w_j*H@ + datum
M_slope@ = c@*(S@*S@ - 1) + rise@ + v@*c@/2*(M_0 + u@*(2*M_1 + u@*3*M_2))
L_slope@ = M_slope@ - w_j*H_slope@
"""
_STEP = """
part@ = S@/d
step@ = (part@*L@ - K@) / (K_slope@ - part@*(c@*L@ + L_slope@))
x% = x@ + step@
"""
_N, _NEXT = _NEWTON_STEPS, _NEWTON_STEPS + 1
_END = f"""
f = pi * E_star * penetration / (L{_N} + L_slope{_N}*step{_N})
fell = K_slope{_NEXT} - c{_NEXT}*K{_NEXT}
k = 0 if penetration <= 0 else pi * E_star * fell / (L{_NEXT}*fell - L_slope{_NEXT}*K{_NEXT})
"""


def _numbered(text: str, n: int) -> str:
    """Return steps with their numbers."""
    return text.replace("@", str(n)).replace("%", str(n + 1))


_STEPS = "".join(
    [
        _SHARES,
        _START,
        *(_numbered(_ARC + _STEP, n) for n in range(1, _NEXT)),
        _numbered(_ARC, _NEXT),
        _END,
    ]
)
_JOHNSON = "datum = 2*log(2) - 2 + (1 + alpha)/2\n"
# The largest arc with Johnson's datum, at which L has the name `last`.
LAST_STEPS = "".join(
    [
        _JOHNSON,
        _SHARES,
        f"least = max(c0, {_LEAST_C})\nx1 = log((1 - least) / least)\n",
        *(_numbered(_ARC + "x% = x@ - K@/K_slope@\n", n) for n in range(1, _LARGEST_STEPS + 1)),
        _numbered(_ARC, _LARGEST_STEPS + 1),
        f"last = L{_LARGEST_STEPS + 1}\n",
    ]
)


def _named(constants: ParametricCoefficients) -> dict[str, float]:
    """Return the constants by their names in the steps."""
    return {f"{key[0]}_{key[1]}": float(value) for key, value in asdict(constants).items()}


NAMED = _named(CALIBRATED)
# Every α is inside ]−1, 1[ and |β| ≤ 1/2, but for rounding.
CONDITIONS = ("alpha*alpha < 1", "beta*beta < 0.251")


def _numbers(law: Parametric, pair: CylinderPair) -> tuple[float, ...]:
    """Return E*, ΔR, α, β, the datum's constant and those of the polynomials."""
    law.require_datum(pair)
    own = (pair.E_star, pair.dR, pair.alpha, pair.beta, law.constant(pair))
    return (*(float(number) for number in own), *_named(law.constants).values())


def _formula(law: Parametric, _: Contact | None) -> Formula:
    """Return the formula for export, which needs a datum that does not depend on the pair."""
    if isinstance(law.datum, ClampedPlate):
        raise InputError(
            "export",
            "datum",
            law.datum,
            "depends on the radii and the materials",
            "give its number: datum=float(law.constant(pair))",
        )
    constants = _named(law.constants)
    is_johnson = isinstance(law.datum, str)
    datum = "Johnson's, to whose law it tends at small loads" if is_johnson else f"C = {law.datum}"
    return Formula(
        name=function_name(law.name, "internal"),
        law=law,
        contact="internal",
        equation="f = pi*E_star*penetration/L with penetration/dR*K(S) = L(S), see the steps",
        text=(_JOHNSON if is_johnson else "") + _STEPS,
        coefficients=asdict(law.constants),
        constants=constants if is_johnson else constants | {"datum": float(law.datum)},
        extra=("alpha", "beta"),
        conditions=CONDITIONS,
        remark=f"The datum of the penetration is {datum}.",
        origin="calibrated by this package" if law.coefficients is None else "",
    )


_MEANINGS = {
    "A0": (-3.0, 0.0, "coefficient of β·u in 2Â·S; exactly −16/(3π)"),
    "A1": (1.0, 2.0, "coefficient of β·u² in 2Â·S"),
    "A2": (-0.5, 1.5, "coefficient of β·u³ in 2Â·S"),
    "A3": (-3.0, -1.5, "coefficient of β·u⁴ in 2Â·S"),
    "H3": (-0.05, 0.05, "coefficient of β·u³ in H"),
    "M0": (0.0, 5.0, "coefficient of β·u in M; exactly 80/(9π)"),
    "M1": (-1.6, -0.8, "coefficient of β·u² in M"),
    "M2": (0.3, 1.2, "coefficient of β·u³ in M"),
}
_EXACT = ("A0", "M0")


def _fitted(values: Coefficients) -> ContactLaw:
    """Return the law with these constants."""
    return Parametric(coefficients=values)


def _model() -> LawModel:
    """Return the model of the law: six constants to search, two exact."""
    nominal = asdict(CALIBRATED)
    parameters = tuple(
        Parameter(
            name,
            low,
            high,
            nominal[name],
            value=nominal[name] if name in _EXACT else None,
            meaning=meaning,
        )
        for name, (low, high, meaning) in _MEANINGS.items()
    )
    return LawModel(
        Parametric.name,
        "internal",
        parameters,
        _fitted,
        on_grid=True,
        dimensionless=True,
        nominal_is_published=False,
    )


DEFINITION = Definition(
    law=Parametric,
    formula=_formula,
    kernel=KernelSteps(("E_star", "dR", "alpha", "beta", "datum", *NAMED), _numbers, _STEPS),
    models=(_model(),),
    contacts=("internal",),
)
