"""The logarithmic laws: Johnson's, and those that differ from it in κ, c and Λ.

Every logarithmic law of cylindrical contact has the form

    δ = A·f·[ln(Λ·E*/f) + c],    A = κ/(π·E*),

with a length Λ that depends on the radii, its reach. The largest load is f_max = Λ·E*·exp(c − 1);
beyond it the penetration would decrease with the load. In q = f/f_max and p = δ/δ_max, with
δ_max = A·f_max, all of them are the single curve p = q(1 − ln q), with the inverse q = p/(1 + w)
and w from Lambert's function.

The literature disagrees on several of them; `RELATIVES` says of each which reading it takes. All
except Johnson's are derived for bodies of equal elastic constants; for other pairs they use the E*
of the pair.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy import exp, inf, log, pi
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws.formula import Formula
from cylcontact.laws.lambert import branch_distance, branch_share
from cylcontact.laws.law import Law, constant, numbers_for
from cylcontact.support.arrays import FloatArray, as_floats, inside_or_nan, require

_EQUATION = (
    "penetration = kappa/(pi*E_star)*f*(ln(Lambda*E_star/f) + c) solved for f; the largest load is "
    "f_max = Lambda*E_star*exp(c - 1)"
)
_REMARK = (
    "For bodies of equal elastic constants{}. f = f_max*p/(1 + w) with p the penetration in "
    "units of the largest and w = -1 - W(-p/e), W the lower branch of Lambert's function: "
    "w = r*P(r)/Q(r) with r = sqrt(-ln p), right to 8.4e-17 before rounding, no iteration."
)
_OF_OTHERS = (
    "; for others c has (w_i - w_j)*ln(R_i/R_j) more, w_k = E_star*(1 - nu_k^2)/E_k, which an "
    "exported joint has"
)


class Ends(NamedTuple):
    """The largest load in N/mm and penetration in mm."""

    f_max: float
    deepest: float


def load(penetration, f_max, deepest):
    """Return f = f_max·p/(1 + w)."""
    return f_max * branch_share(penetration / deepest)


def stiffness(penetration, f_max, deepest):
    """Return df/dδ = f_max/(δ_max·w)."""
    return f_max / (deepest * branch_distance(penetration / deepest))


def energy(penetration, f_max, deepest):
    """Return ∫ f dδ."""
    f = load(penetration, f_max, deepest)
    return f * (penetration / 2 - deepest / 4 * (f / f_max))


def deepest_at(deepest):
    """Return the penetration at f_max."""
    return deepest


def ends(reach, E_star, kappa, c) -> Ends:
    """Return the largest load and penetration of a law with this Λ."""
    f_max = reach * E_star * exp(c - 1)
    return Ends(f_max, kappa / (pi * E_star) * f_max)


def of_clearance(E_star, dR, kappa, c) -> Ends:
    """Return both ends for Λ = 4π·ΔR."""
    return ends(4 * pi * dR, E_star, kappa, c)


def of_unlike(E_star, dR, R_i, R_j, alpha, kappa, c) -> Ends:
    """Return both ends for Λ = 4π·ΔR·(R_j/R_i)^α."""
    return ends(4 * pi * dR, E_star, kappa, c - alpha * log(R_i / R_j))


def of_quarter_clearance(E_star, dR, kappa, c) -> Ends:
    """Return both ends for Λ = π·ΔR."""
    return ends(pi * dR, E_star, kappa, c)


def of_radii(E_star, dR, R_i, R_j, kappa, c) -> Ends:
    """Return both ends for Λ = π·R with R = R_i·R_j/ΔR."""
    return ends(pi * (R_i * R_j / dR), E_star, kappa, c)


def of_length(E_star, dR, R_i, R_j, length, kappa, c) -> Ends:
    """Return both ends for Λ = π·L²/R with R = R_i·R_j/ΔR."""
    return ends(pi * (length * length) / (R_i * R_j / dR), E_star, kappa, c)


def _formula(numbers: Any, of_others: str = "") -> Formula:
    remark = _REMARK.format(of_others)
    return Formula(load, stiffness, numbers, energy, deepest_at, _EQUATION, remark)


@dataclass(frozen=True, kw_only=True)
class LogarithmicLaw(Law):
    """A law δ = κ/(π·E*)·f·[ln(Λ·E*/f) + c], as `laws.LAWS` has seven besides Johnson's.

    Attributes
    ----------
    name : str
        Its name in specs and commands.
    kappa, c : float
        κ and c.
    formula : Formula
        The load, with Λ.
    about : str
        Its source on one line.
    """

    name: str = field(kw_only=False)  # type: ignore[misc]
    kappa: float = constant(0.2, 5.0, "factor of δ", 1.0)
    c: float = constant(-5.0, 5.0, "term beside the logarithm", -1.0)
    formula: Formula = field(default=_formula(of_clearance), repr=False)  # type: ignore[misc]
    about: str = field(default="", repr=False)
    any_plane: ClassVar[bool] = False

    @property
    def title(self) -> str:
        """What errors call the law."""
        return f"the {self.name} law"

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm; NaN outside [0, max_load]."""
        f_max, deepest = self.numbers_at(pair)
        f = numbers_for(pair, load=load)
        with np.errstate(over="ignore"):
            q = f / f_max
        inside = np.asarray((q >= 0) & (q <= 1))
        p = q * (1 - log(np.where(inside & (q > 0), q, 1.0)))
        return inside_or_nan(deepest * p, inside)


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

    name: str = field(default="johnson", init=False)  # type: ignore[misc]
    formula: Formula = field(  # type: ignore[misc]
        default=_formula(of_clearance, _OF_OTHERS), init=False, repr=False
    )
    about: str = field(default="", init=False, repr=False)
    datum: float | None = None
    any_plane: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if self.datum is not None:
            depth, remedy = self.datum, "give a length in mm"
            positive = isinstance(depth, (int, float, np.number)) and 0 < depth < inf
            require(positive, "Johnson", "datum", depth, "must be positive and finite", remedy)

    def __repr__(self) -> str:
        values = {each.name: getattr(self, each.name) for each in fields(self) if each.init}
        given = (f"{k}={v!r}" for k, v in values.items() if v != getattr(type(self), k))
        return f"Johnson({', '.join(given)})"

    def numbers_at(self, pair: CylinderPair) -> tuple[Any, ...]:
        """Return the largest load and penetration, which are others on a plane."""
        on_plane = np.all(np.isinf(pair.dR))
        if not on_plane and self.datum is None:
            return super().numbers_at(pair)
        rule = "is missing: the pair is a cylinder on a plane, which has no ΔR"
        remedy = "give the depth in mm at which the plane is held"
        if not on_plane:
            rule, remedy = "is for a cylinder on a plane, R_j = inf", "leave it out for this pair"
        require(on_plane and self.datum is not None, "Johnson", "datum", self.datum, rule, remedy)
        (w_i, w_j), (_, kappa_j) = pair.shares, pair.kolosov
        below = as_floats(-(3 - kappa_j) / (1 + kappa_j))
        # Each body's logarithm as 2·ln(length/a), with a² = 4f·R/(π·E*).
        ln_4R, ln_2H = log(4 * as_floats(pair.R_i)), log(2 * float(self.datum or 0))
        c = 2 * w_i * ln_4R + 2 * w_j * ln_2H - w_i + w_j * below - ln_4R
        return tuple(ends(as_floats(pi), pair.E_star, self.kappa, c + self.c + 1))

    def formula_at(self, pair: CylinderPair) -> Formula:
        """Return the formula for a pair; materials that differ need the radii."""
        modulus_i, modulus_j = pair.moduli
        if np.all(modulus_i == modulus_j):
            return self.formula
        pair.radii("Johnson's law for different materials")
        return _UNLIKE


_UNLIKE = _formula(of_unlike)

# The others by name, each with the reading of its source that it takes; κ = 1 unless it says so.
RELATIVES: dict[str, LogarithmicLaw] = {
    name: LogarithmicLaw(name, kappa=kappa, c=c, formula=_formula(numbers), about=about)
    for name, kappa, c, numbers, about in (
        # δ = f/(π·E*)·[2/3 + ln(4R_i/b) + ln(4R_j/b)] with b = 4·√(f·R/(π·E*)). (The tables'
        # factor 1.60 belongs with diameters: 1.60·√2 = 2.26 = 4/√π with radii.)
        ("roark-young", 1.0, 2 / 3 - 2 * float(log(2)), of_clearance,
         "Radzimovsky's formula with b the full contact width, as in Roark and Young's tables."),
        ("radzimovsky", 1.0, 2 / 3, of_clearance,
         "Radzimovsky's formula (1953) with b Hertz's half-width, 2·√(f·R/(π·E*))."),
        # With radii this b is neither width of Hertz's. Comparisons in the literature use it.
        ("radzimovsky-radii", 1.0, 2 / 3 + float(log(16 / 1.6**2 / (4 * pi))), of_clearance,
         "Radzimovsky's formula with b = 1.60·√(f·R/E*), as multibody papers print it."),
        # With the compliance of each body as (1 − ν²)/(π·E), without a further factor π; the
        # original was not available, so that is unverified.
        ("esdu-78035", 1.0, 1.0, of_clearance,
         "ESDU item 78035, δ = f/(π·E*)·[ln(4π·ΔR·E*/f) + 1]."),
        # Their L^m with m = 3 and the total force F = f·L.
        ("dubowsky-freudenstein", 1.0, 1.0, of_length,
         "Dubowsky and Freudenstein (1971), δ = f/(π·E*)·[ln(π·E*·L²·ΔR/(f·R_i·R_j)) + 1]."),
        # Their L^m with m = 1 is of wrong dimension unless the length drops out; π·R remains.
        ("goldsmith", 1.0, 1.0, of_radii,
         "Goldsmith (1960) as multibody papers print it, δ = f/(π·E*)·[ln(π·E*·R/f) + 1]."),
        # Hertz's theory of line contact gives no approach. Twice as compliant as Johnson's law.
        ("hertz-cylinder", 2.0, -1.0, of_quarter_clearance,
         "Called Hertz's for cylinders in multibody papers, δ = 2f/(π·E*)·[ln(π·ΔR·E*/f) − 1]."),
    )
}  # fmt: skip
