"""The logarithmic laws: Johnson's, and those that differ from it in κ, c and Λ.

Every logarithmic law of cylindrical contact has the form

    δ = A·f·[ln(Λ·E*/f) + c],    A = κ/(π·E*),

with a length Λ that depends on the radii, its reach. The largest load is f_max = Λ·E*·exp(c − 1);
beyond it the penetration would decrease with the load. In q = f/f_max and p = δ/δ_max, with
δ_max = A·f_max, all of them are the single curve p = q(1 − ln q), with the inverse q = p/(1 + w)
and w from Lambert's function.

The literature disagrees on several of them, so each class states which reading it takes. All but
Johnson's are derived for bodies of equal elastic constants; for other pairs they use the E* of the
pair.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy import exp, inf, log, pi
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.laws.adapters import ScaledLaw
from cylcontact.laws.formula import Formula
from cylcontact.laws.lambert import branch_distance, branch_share
from cylcontact.laws.law import ContactLaw, Law, LawModel, Parameter, numbers_for
from cylcontact.support.arrays import FloatArray, as_floats, inside_or_nan, require

_EQUATION = (
    "penetration = kappa/(pi*E_star)*f*(ln(Lambda*E_star/f) + c) solved for f, with Lambda in the "
    "steps: f_max = Lambda*E_star*exp(c - 1)"
)
_REMARK = (
    "For bodies of equal elastic constants{}. f = f_max*p/(1 + w) with p the penetration in "
    "units of the largest and w = -1 - W(-p/e), W the lower branch of Lambert's function: "
    "a start in closed form and one step of fourth order, no iteration."
)


def load(penetration, pair, f_max, deepest):
    """Return f and df/dδ, f = f_max·p/(1 + w)."""
    p = penetration / deepest
    w = branch_distance(p)
    return f_max * (p / (1 + w)), f_max / (deepest * w)


def load_in_arrays(penetration, f_max, deepest, **_):
    """Return f alone."""
    f = branch_share(penetration / deepest)
    f *= f_max
    return f


def end(pair, f_max, deepest):
    """Return the penetration at f_max."""
    return deepest


def energy(penetration, pair, f_max, deepest):
    """Return ∫ f dδ."""
    f, k = load(penetration, pair, f_max, deepest)
    return f * (penetration / 2 - deepest / 4 * (f / f_max))


@dataclass(frozen=True)
class LogarithmicLaw(Law):
    """The common form δ = κ/(π·E*)·f·[ln(Λ·E*/f) + c]; a law supplies κ, c and Λ.

    κ, c = `shift`, and the reach Λ in mm of a pair, 4π·ΔR unless the law has another.
    """

    kappa: ClassVar[float] = 1.0
    shift: ClassVar[float]
    _of_others: ClassVar[str] = ""
    any_plane = False

    @staticmethod
    def reach(pair: Any) -> Any:
        """Return Λ."""
        return 4 * pi * pair.dR

    def __init_subclass__(cls) -> None:
        reach = cls.reach

        def ends(pair, kappa, c):
            f_max = reach(pair) * pair.E_star * exp(c - 1)
            return f_max, kappa / (pi * pair.E_star) * f_max

        remark = _REMARK.format(cls._of_others)
        cls.formula = Formula(load, ends, end, energy, _EQUATION, remark, load_in_arrays)

    def constants_for(self, contact: Contact) -> dict[str, float]:
        """Return κ and c."""
        return {"kappa": float(self.kappa), "c": float(self.shift)}

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm; NaN outside [0, max_load]."""
        f = numbers_for(pair, load=load)
        with np.errstate(over="ignore"):
            q = f / self.max_load(pair)
        inside = np.asarray((q >= 0) & (q <= 1))
        p = q * (1 - log(np.where(inside & (q > 0), q, 1.0)))
        return inside_or_nan(self.max_penetration(pair) * p, inside)

    @classmethod
    def models(cls) -> tuple[LawModel, ...]:
        """Return how the law is fitted: by κ, c and a factor of Λ, redundant with c, held at 1."""
        kappa = Parameter("kappa", 0.2, 5.0, cls.kappa, stiffness=True, meaning="factor of δ")
        c = Parameter("c", -5.0, 5.0, cls.shift, shift=True, meaning="term beside the logarithm")
        factor = Parameter("Lambda_factor", 1e-3, 1e3, 1.0, value=1.0, meaning="factor of Λ")

        def build(values: Mapping[str, float]) -> ContactLaw:
            return adjusted_logarithmic(cls(), **values)

        return tuple(LawModel(cls.name, each, (kappa, c, factor), build) for each in cls.contacts)


@dataclass(frozen=True)
class Johnson(LogarithmicLaw):
    """Johnson's law, Eq 1: f = π·E*·δ/[ln(4π·E*·ΔR/f) − 1] per unit length.

    The paper solves it for the load by iteration. `load` evaluates the exact inverse,
    f = π·E*·δ/(−W₋₁(−e·δ/(4ΔR))). The domain ends at f = 4π·E*·ΔR/e² (Eq 8), δ = 4ΔR/e².

    For bodies of different materials the reach is
    Λ = 4π·R_i^(2w_i)·R_j^(2w_j)/R with w_k = E*(1 − ν_k²)/E_k (each body's own half-plane
    compression, Johnson's Contact Mechanics, Sect. 5.6). As w_i + w_j = 1 and R = R_i·R_j/ΔR,
    that is Λ = 4π·ΔR·(R_i/R_j)^(w_i − w_j), and equal materials give Λ = 4π·ΔR. In plane stress
    E takes the place of E/(1 − ν²); the derivation is the same.

    Parameters
    ----------
    datum : float, optional
        For a cylinder on a plane (`CylinderPair.external` with R_j = inf) and no other pair: the
        depth in mm below the surface at which the half-plane is held. The penetration is that of
        the cylinder's centre against it, the sum of
        w_i·[2·ln(4R_i/a) − 1] and w_j·[2·ln(2·depth/a) − ν_j/(1 − ν_j)] times f/(π·E*), with
        a = √(4f·R_i/(π·E*)) (Johnson, Sect. 5.6); the depth is large beside a.

    Raises
    ------
    InputError
        When the law is evaluated, if a plane has no datum or another pair has one, or radii that
        bodies of different materials need are not known.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.from_dR("internal", dR=0.05, material=steel)
    >>> law = Johnson()
    >>> delta = law.penetration(100.0, pair)
    >>> print(f"{delta * 1e3:.5f} µm, {law.load(delta, pair):.10f} N/mm")
    1.55935 µm, 100.0000000000 N/mm
    """

    datum: float | None = None
    name = "johnson"
    shift = -1.0
    _of_others = (
        "; for others c has (w_i - w_j)*ln(R_i/R_j) more, w_k = E_star*(1 - nu_k^2)/E_k, which an "
        "exported joint has"
    )
    any_plane = True

    def __post_init__(self) -> None:
        if self.datum is not None:
            depth, remedy = self.datum, "give a length in mm"
            positive = isinstance(depth, (int, float, np.number)) and 0 < depth < inf
            require(positive, "Johnson", "datum", depth, "must be positive and finite", remedy)

    def __repr__(self) -> str:
        return "Johnson()" if self.datum is None else f"Johnson(datum={self.datum!r})"

    def numbers_at(self, pair: CylinderPair) -> dict[str, FloatArray]:
        """Return the largest load and penetration, which are others on a plane."""
        on_plane = np.all(np.isinf(pair.dR))
        if not on_plane and self.datum is None:
            return super().numbers_at(pair)
        rule = "is missing: the pair is a cylinder on a plane, which has no ΔR"
        remedy = "give the depth in mm at which the plane is held"
        if not on_plane:
            rule, remedy = "is for a cylinder on a plane, R_j = inf", "leave it out for this pair"
        require(on_plane and self.datum is not None, "Johnson", "datum", self.datum, rule, remedy)
        (w_i, w_j), (_, kappa) = pair.shares, pair.kolosov
        below = as_floats(-(3 - kappa) / (1 + kappa))
        # Each body's logarithm as 2·ln(length/a), with a² = 4f·R/(π·E*).
        ln_4R, ln_2H = log(4 * as_floats(pair.R_i)), log(2 * float(self.datum or 0))
        c = 2 * w_i * ln_4R + 2 * w_j * ln_2H - w_i + w_j * below - ln_4R
        f_max = as_floats(pi * pair.E_star * exp(c - 1))
        deepest = as_floats(f_max / (pi * pair.E_star))
        return {"f_max": f_max, "deepest": deepest, "last": deepest}

    def constants_at(self, pair: CylinderPair) -> Mapping[str, Any]:
        """Return κ and c, with ln(Λ/(4π·ΔR)) in c, which is 0 for equal materials."""
        modulus_i, modulus_j = pair.moduli
        if np.all(modulus_i == modulus_j):
            return super().constants_at(pair)
        R_i, R_j = pair.radii("Johnson's law for different materials")
        shares = pair.E_star / modulus_i - pair.E_star / modulus_j
        return {"kappa": self.kappa, "c": self.shift + shares * log(R_i / R_j)}


class RoarkYoung(LogarithmicLaw):
    """Radzimovsky's formula with b the full contact width, as in Roark and Young's tables.

    δ = f/(π·E*)·[2/3 + ln(4R_i/b) + ln(4R_j/b)] with b = 4·√(f·R/(π·E*)). (The tables' factor
    1.60 belongs with diameters: 1.60·√2 = 2.26 = 4/√π with radii.)
    """

    name = "roark-young"
    shift = 2 / 3 - 2 * float(log(2))


class Radzimovsky(LogarithmicLaw):
    """Radzimovsky's formula (1953) with b Hertz's half-width.

    δ = f/(π·E*)·[2/3 + ln(4R_i/b) + ln(4R_j/b)] with b = 2·√(f·R/(π·E*)).
    """

    name = "radzimovsky"
    shift = 2 / 3


class RadzimovskyRadii(LogarithmicLaw):
    """Radzimovsky's formula with b = 1.60·√(f·R/E*), as multibody papers print it.

    The 1.60 of the tables is for diameters. With radii, b is neither the half-width nor the full
    width of Hertz. The law is included because comparisons in the literature use it.
    """

    name = "radzimovsky-radii"
    shift = 2 / 3 + float(log(16 / 1.6**2 / (4 * pi)))


class Esdu78035(LogarithmicLaw):
    """ESDU item 78035, δ = f/(π·E*)·[ln(4π·ΔR·E*/f) + 1].

    The compliance of each body is taken as (1 − ν²)/(π·E), without a further factor π. The
    original was not available, so the convention is unverified.
    """

    name = "esdu-78035"
    shift = 1.0


class DubowskyFreudenstein(LogarithmicLaw):
    """Dubowsky and Freudenstein (1971), δ = f/(π·E*)·[ln(π·E*·L²·ΔR/(f·R_i·R_j)) + 1].

    This is their L^m with m = 3 (total force F = f·L). It needs the radii and the axial length.
    """

    name = "dubowsky-freudenstein"
    shift = 1.0
    needs = ("R_i", "R_j", "length")

    @staticmethod
    def reach(pair: Any) -> Any:
        """Return Λ."""
        return pi * (pair.length * pair.length) / pair.R


class Goldsmith(LogarithmicLaw):
    """Goldsmith (1960) as printed in multibody papers, δ = f/(π·E*)·[ln(π·E*·R/f) + 1].

    The L^m of Dubowsky and Freudenstein with m = 1 is dimensionally inconsistent unless the length
    drops out. What remains is π times the effective radius R = R_i·R_j/ΔR as reach. With m = 3 the
    law is that of Dubowsky and Freudenstein. It needs the radii.
    """

    name = "goldsmith"
    shift = 1.0
    needs = ("R_i", "R_j")

    @staticmethod
    def reach(pair: Any) -> Any:
        """Return Λ."""
        return pi * pair.R


class HertzCylinder(LogarithmicLaw):
    """The law called Hertz's for cylinders in multibody papers, δ = 2f/(π·E*)·[ln(π·ΔR·E*/f) − 1].

    Hertz's theory of line contact gives no approach. This is a separate logarithmic law, about
    twice as compliant as Johnson's.
    """

    name = "hertz-cylinder"
    kappa = 2.0
    shift = -1.0

    @staticmethod
    def reach(pair: Any) -> Any:
        """Return Λ."""
        return pi * pair.dR


def adjusted_logarithmic(
    base: LogarithmicLaw, kappa: float, c: float, Lambda_factor: float = 1.0
) -> ScaledLaw:
    """Return δ = κ/(π·E*)·f·[ln(F·Λ·E*/f) + c] with the Λ of a logarithmic law.

    With B = F·exp(c − c₀) it is (κ·B/κ₀)·δ₀(f/B), a scaled form of the law δ₀ with κ₀, c₀ and Λ.
    F and c act only through ln F + c.
    """
    load_factor = Lambda_factor * float(exp(c - base.shift))
    return ScaledLaw(base, load_factor, kappa * load_factor / base.kappa)
