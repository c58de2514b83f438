"""The laws f = K·δⁿ: the power law (Eqs 3–4), one by the clearance, and a point contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy import exp, inf, isfinite, log, nan, sqrt
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws.formula import Formula, choose
from cylcontact.laws.law import Law, constant, numbers_for
from cylcontact.support.arrays import FloatArray, as_floats, inside_or_nan, require
from cylcontact.support.errors import InputError

IN_MM = "Holds in mm, N and MPa only: its coefficients are not dimensionless."


class Numbers(NamedTuple):
    """K in N/mm per mmⁿ, and n."""

    factor: float
    n: float


def load(penetration, factor, n):
    """Return f = K·δⁿ."""
    return factor * penetration**n


def stiffness(penetration, factor, n):
    """Return df/dδ = n·f/δ."""
    return factor * (n * penetration ** (n - 1))


def energy(penetration, factor, n):
    """Return ∫ f dδ = f·δ/(n + 1)."""
    return factor * penetration**n * penetration / (n + 1)


def deepest_at(factor):
    """Return inf where K is defined."""
    return choose(factor > 0, inf, nan)


def power_formula(numbers: Any, equation: str, remark: str) -> Formula:
    """Return a power law whose K and n are a function of the pair and of constants."""
    return Formula(load, stiffness, numbers, energy, deepest_at, equation, remark)


def require_coefficients(what: str, source: str) -> None:
    """Refuse the name of a power law, which has coefficients only after a fit."""
    rule, remedy = "has no fixed coefficients", "name a fit result of it"
    require(not what.startswith("power"), source, "law", what, rule, remedy)


class PowerShaped(Law):
    """The common form f = K·δⁿ at each pair; a law supplies K and n."""

    def factor_and_exponent(self, pair: CylinderPair) -> tuple[FloatArray, FloatArray]:
        """Return K in N/mm per mmⁿ and n, both NaN where the law is undefined."""
        shape = np.broadcast_shapes(np.shape(pair.E_star), np.shape(pair.dR))
        factor, n = self.numbers_at(pair)
        factor = np.broadcast_to(factor, shape)
        return as_floats(factor), as_floats(np.where(np.isnan(factor), np.nan, n))

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm, δ = (f/K)^(1/n)."""
        factor, n = self.factor_and_exponent(pair)
        f = numbers_for(pair, load=load)
        touching = np.asarray(f >= 0)
        return inside_or_nan((np.where(touching, f, 0.0) / factor) ** (1 / n), touching)

    def factor(self, pair: CylinderPair) -> FloatArray:
        """Return K in N/mm per mmⁿ for `pair`."""
        return self.factor_and_exponent(pair)[0]

    def exponent(self, pair: CylinderPair) -> FloatArray:
        """Return n for `pair`."""
        return self.factor_and_exponent(pair)[1]


def _require_exponent(law: Any, remedy: str) -> None:
    rule = "must be positive and finite"
    require(law.n > 0 and isfinite(law.n), type(law).__name__, "n", law.n, rule, remedy)


def of_one_pair(K, n) -> Numbers:
    """Return K and n as they are."""
    return Numbers(K, n)


def scaled(E_star, dR, K_star, n) -> Numbers:
    """Return K = K*·E*/ΔR and n."""
    return Numbers(K_star * (E_star / dR), n)


def dimensionless(E_star, dR, C, n) -> Numbers:
    """Return K = C·E*·ΔR^(1 − n) and n."""
    return Numbers(C * E_star * dR ** (1 - n), n)


# By the name of the factor.
_FORMULAS = {
    "C": power_formula(
        dimensionless, "f = C*E_star*dR*(penetration/dR)^n",
        "Dimensionless in penetration/dR and f/(E_star*dR).",
    ),
    "K_star": power_formula(scaled, "f = K_star*E_star/dR*penetration^n", IN_MM),
    "K": power_formula(
        of_one_pair, "f = K*penetration^n", f"{IN_MM} For the one pair that it was fitted to."
    ),
}  # fmt: skip


@dataclass(frozen=True)
class PowerLaw(PowerShaped):
    """The power law f = K·δⁿ (Eq 3), with K given as such or scaled to other pairs.

    Parameters
    ----------
    n : float
        Exponent, positive.
    K : float, optional
        Factor in N/mm per mmⁿ, for the pair it was fitted to.
    K_star : float, optional
        Factor K* in K = K*·E*/ΔR (Eq 4, per unit length).
    C : float, optional
        Dimensionless factor in f = C·E*·ΔR·(δ/ΔR)ⁿ, which scales as Johnson's law does.

    Raises
    ------
    InputError
        Unless exactly one positive factor and a positive exponent are given.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> pair = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    >>> print(f"{PowerLaw(n=1.237, K=312148).load(1e-3, pair):.2f} N/mm")
    60.72 N/mm
    >>> law = PowerLaw(n=1.0848, C=0.580)
    >>> print(f"{law.load(1e-3, pair) / law.load(2e-3, pair):.4f}")
    0.4715
    """

    n: float = constant(0.8, 2.0, "exponent of the penetration")
    K: float | None = constant(1.0, 1e9, "factor, of this pair only", None, unit="N/mm/mm^n")
    K_star: float | None = constant(1e-3, 1e3, "factor of E*/ΔR", None, unit="mm^(2-n)")
    C: float | None = constant(1e-3, 1e3, "factor of E*·ΔR", None)

    def __post_init__(self) -> None:
        factors = (self.K, self.K_star, self.C)
        given = [value for value in factors if value is not None]
        if len(given) != 1 or not (given[0] > 0 and isfinite(given[0])):
            rule = "exactly one of them must be given, positive and finite"
            remedy = "use K for one pair, K_star or C for a law that scales to others"
            raise InputError("PowerLaw", "K, K_star, C", factors, rule, remedy)
        _require_exponent(self, "give the exponent of the penetration")

    @property
    def name(self) -> str:  # type: ignore[override]
        """The law's name, that of its fits."""
        return "power" if self.C is None else "power-dimensionless"

    @property
    def formula(self) -> Formula:  # type: ignore[override]
        """The formula with the factor that is given."""
        return next(_FORMULAS[name] for name in _FORMULAS if getattr(self, name) is not None)


# --- factor and exponent by the clearance --------------------------------------------------------


def of_clearance(dR, A, p, n0, n1, q, n2) -> Numbers:
    """Return K* and n, polynomials of ln ΔR in ln K* and n."""
    x = log(dR)
    return Numbers(A * exp((p + q * x) * x), n0 + (n1 + n2 * x) * x)


def by_clearance(E_star, dR, A, p, n0, n1, q, n2) -> Numbers:
    """Return K = K*·E*/ΔR and n."""
    at = of_clearance(dR, A, p, n0, n1, q, n2)
    return Numbers(choose(at.n > 0, at.factor * E_star / dR, nan), at.n)


@dataclass(frozen=True)
class PowerClearance(PowerShaped):
    """The power law f = K*·E*/ΔR·δⁿ with K* = A·ΔR^p and n = n₀ + n₁·ln ΔR.

    Four constants come as close to Johnson's law as the seven of `Enhanced`. Two more, q and n₂,
    bend both lines: ln K* = ln A + p·x + q·x² and n = n₀ + n₁·x + n₂·x² with x = ln ΔR. That is
    within 1 % of what any K*(ΔR) and n(ΔR) can reach.

    Parameters
    ----------
    A : float
        K* at ΔR = 1 mm, positive.
    p, n0, n1 : float
        The slope of ln K* over ln ΔR, n at ΔR = 1 mm, and its slope.
    q, n2 : float
        Coefficients of ln² ΔR in ln K* and n; 0 for a law of four constants.

    Raises
    ------
    InputError
        If A is not positive, or a constant is not finite.

    Notes
    -----
    The law holds in mm, N and MPa only. It is NaN where n is not positive, far outside the
    clearances of a fit: `fitting/power-clearance.toml` has the paper's ranges and
    `fitting/power-clearance-practical.toml` materials of machines with ΔR from 0.0075 to 2 mm.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> pair = CylinderPair.from_dR("internal", 0.5, Material("steel", E=207e3, nu=0.3))
    >>> law = PowerClearance(A=0.88, p=0.723, n0=1.1336, n1=-0.02)
    >>> print(f"{law.exponent(pair):.4f}, {law.penetration(100.0, pair) * 1e3:.3f} µm")
    1.1475, 2.054 µm
    """

    A: float = constant(1e-2, 1e2, "K* at ΔR = 1 mm", unit="mm^(2-n)")
    p: float = constant(0.0, 2.0, "slope of ln K* over ln ΔR")
    n0: float = constant(0.8, 2.0, "n at ΔR = 1 mm")
    n1: float = constant(-0.2, 0.2, "slope of n over ln ΔR")
    q: float = constant(-1.0, 1.0, "coefficient of ln² ΔR in ln K*", 0.0)
    n2: float = constant(-0.1, 0.1, "coefficient of ln² ΔR in n", 0.0)
    name: ClassVar[str] = "power-clearance"
    formula: ClassVar[Formula] = power_formula(
        by_clearance,
        "f = A*dR^(p + q*ln(dR))*E_star/dR*penetration^n with n = n0 + n1*ln(dR) + n2*ln(dR)^2",
        IN_MM,
    )

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            rule, remedy = "must be finite, and A positive", "give the values of a fit"
            valid = isfinite(value) and (name != "A" or value > 0)
            require(valid, "PowerClearance", name, value, rule, remedy)


# --- a point contact used for cylinders ---------------------------------------------------------


def sphere(E_star, dR, R_i, R_j, length, n) -> Numbers:
    """Return K = (4/3)·E*·√R/L and n."""
    return Numbers(4 / 3 * E_star * sqrt(R_i * R_j / dR) / length, n)


@dataclass(frozen=True)
class LankaraniNikravesh(PowerShaped):
    """Lankarani and Nikravesh (1990), elastic part of Eq 2: F = (4/3)·E*·√R·δⁿ, R = R_i·R_j/ΔR.

    Parameters
    ----------
    n : float
        Exponent, positive; 1.5 for metals.

    Raises
    ------
    InputError
        If the exponent is not positive; when the law is evaluated, if the radii or the length of
        the pair are not known.

    Notes
    -----
    F is the *total* force of a point contact, in N; it does not depend on the axial length. The
    load per unit length is F/L, so the pair needs a length. The paper prints R_i·R_i where
    R_i·R_j is meant.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.5, material=steel, length=10.0)
    >>> print(f"{LankaraniNikravesh().load(1e-3, pair):.3f} N/mm")
    6.610 N/mm
    """

    n: float = constant(0.8, 2.0, "exponent of the penetration", 1.5)
    name: ClassVar[str] = "lankarani-nikravesh"
    formula: ClassVar[Formula] = power_formula(
        sphere,
        "f = 4/3*E_star*sqrt(R_i*R_j/dR)/length*penetration^n",
        "The law gives the total force f*length of a point contact, independent of the length; f "
        "is that force per unit length.",
    )
    any_plane: ClassVar[bool] = False

    def __post_init__(self) -> None:
        _require_exponent(self, "metals have n = 1.5")
