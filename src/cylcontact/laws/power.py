"""The laws f = K·δⁿ: the power law (Eqs 3–4), one by the clearance, and a point contact."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy import exp, inf, isfinite, log, nan, sqrt, where
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import CONTACTS, Contact, CylinderPair
from cylcontact.laws.adapters import ScaledLaw
from cylcontact.laws.formula import Formula
from cylcontact.laws.law import ContactLaw, Law, LawModel, Parameter, numbers_for
from cylcontact.support.arrays import FloatArray, as_floats, inside_or_nan, require
from cylcontact.support.errors import InputError

IN_MM = "Holds in mm, N and MPa only: its coefficients are not dimensionless."


def load(penetration, pair, factor, n):
    """Return f = K·δⁿ."""
    return factor * penetration**n


def end(pair, factor, n):
    """Return inf where K is defined."""
    return np.where(factor > 0, inf, np.nan)


def energy(penetration, pair, factor, n):
    """Return ∫ f dδ = f·δ/(n + 1)."""
    return factor * penetration**n * penetration / (n + 1)


class PowerShaped(Law):
    """The common form f = K·δⁿ at each pair; a law supplies K and n."""

    def factor_and_exponent(self, pair: CylinderPair) -> tuple[FloatArray, FloatArray]:
        """Return K in N/mm per mmⁿ and n, both NaN where the law is undefined."""
        numbers = self.numbers_at(pair)
        shape = np.broadcast_shapes(np.shape(pair.E_star), np.shape(pair.dR))
        factor, n = np.broadcast_to(numbers["factor"], shape), numbers["n"]
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


def one_pair(pair, K, n):
    """Return K and n."""
    return K, n


def scaled(pair, K_star, n):
    """Return K = K*·E*/ΔR and n."""
    return K_star * (pair.E_star / pair.dR), n


def dimensionless(pair, C, n):
    """Return K = C·E*·ΔR^(1 − n) and n."""
    return C * pair.E_star * pair.dR ** (1 - n), n


_ONE_PAIR = f"{IN_MM} For the one pair that it was fitted to."
_NO_UNITS = "Dimensionless in penetration/dR and f/(E_star*dR)."
# By the name of the factor.
_FORMULAS = {
    "C": Formula(load, dimensionless, end, energy, "f = C*E_star*dR*(penetration/dR)^n", _NO_UNITS),
    "K_star": Formula(load, scaled, end, energy, "f = K_star*E_star/dR*penetration^n", IN_MM),
    "K": Formula(load, one_pair, end, energy, "f = K*penetration^n", _ONE_PAIR),
}


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

    n: float
    K: float | None = None
    K_star: float | None = None
    C: float | None = None
    units: ClassVar[Mapping[str, str]] = {"K": "N/mm/mm^n", "K_star": "mm^(2-n)"}

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

    formula = _FORMULAS["K"]

    @property
    def _given(self) -> str:
        """The name of the factor."""
        return next(name for name in _FORMULAS if getattr(self, name) is not None)

    def formula_for(self, contact: Contact) -> Formula:
        """Return the formula with the factor that is given."""
        return _FORMULAS[self._given]

    def constants_for(self, contact: Contact) -> dict[str, float]:
        """Return the factor and n."""
        return {self._given: float(getattr(self, self._given)), "n": float(self.n)}

    @classmethod
    def models(cls) -> tuple[LawModel, ...]:
        """Return the three ways to fit a power law, for each contact."""
        n = Parameter("n", 0.8, 2.0, meaning="exponent of the penetration")
        K = Parameter("K", 1.0, 1e9, unit="N/mm/mm^n", meaning="factor, of this pair only")
        K_star = Parameter("K_star", 1e-3, 1e3, unit="mm^(2-n)", meaning="factor of E*/ΔR")
        C = Parameter("C", 1e-3, 1e3, meaning="factor of E*·ΔR")
        free: Any = {"power_form": _with_dR, "on_grid": True}
        return tuple(
            model
            for contact in CONTACTS
            for model in (
                LawModel("power-one-pair", contact, (K, n), cls.fitted),
                LawModel("power", contact, (K_star, n), cls.fitted, _constant, on_grid=True),
                LawModel("power-dimensionless", contact, (C, n), cls.fitted, **free),
            )
        )


def _constant(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the same K* and n at every ΔR (Eqs 3-4)."""
    K_star, n = candidates.T[:, :, None] + np.zeros_like(dR)
    return K_star, n


def _with_dR(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return K* = C·ΔR^(2 − n), and n."""
    C, n = candidates.T[:, :, None] + np.zeros_like(dR)
    return as_floats(C * dR ** (2 - n)), n


# --- factor and exponent by the clearance --------------------------------------------------------


def of_clearance(dR, A, p, n0, n1, q, n2):
    """Return K* and n, polynomials of ln ΔR in ln K* and n."""
    x = log(dR)
    return A * exp((p + q * x) * x), n0 + (n1 + n2 * x) * x


def by_clearance(pair, A, p, n0, n1, q, n2):
    """Return K = K*·E*/ΔR and n."""
    K_star, n = of_clearance(pair.dR, A, p, n0, n1, q, n2)
    return where(n > 0, K_star * pair.E_star / pair.dR, nan), n


_BY_CLEARANCE = (
    "f = A*dR^(p + q*ln(dR))*E_star/dR*penetration^n with n = n0 + n1*ln(dR) + n2*ln(dR)^2"
)


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

    A: float
    p: float
    n0: float
    n1: float
    q: float = 0.0
    n2: float = 0.0
    name: ClassVar[str] = "power-clearance"
    units: ClassVar[Mapping[str, str]] = {"A": "mm^(2-n)"}
    parameters = (
        Parameter("A", 1e-2, 1e2, unit="mm^(2-n)", meaning="K* at ΔR = 1 mm"),
        Parameter("p", 0.0, 2.0, shift=True, meaning="slope of ln K* over ln ΔR"),
        Parameter("n0", 0.8, 2.0, meaning="n at ΔR = 1 mm"),
        Parameter("n1", -0.2, 0.2, shift=True, meaning="slope of n over ln ΔR"),
        Parameter("q", -1.0, 1.0, value=0.0, shift=True, meaning="coefficient of ln² ΔR in ln K*"),
        Parameter("n2", -0.1, 0.1, value=0.0, shift=True, meaning="coefficient of ln² ΔR in n"),
    )
    formula = Formula(load, by_clearance, end, energy, _BY_CLEARANCE, IN_MM)
    on_grid = True

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            rule, remedy = "must be finite, and A positive", "give the values of a fit"
            valid = isfinite(value) and (name != "A" or value > 0)
            require(valid, "PowerClearance", name, value, rule, remedy)

    @classmethod
    def model(cls, contact: Contact, **_: object) -> LawModel:
        """Return how the law is fitted for a contact."""
        return super().model(contact, power_form=_of_clearance)


def _of_clearance(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return K* and n of candidates at clearances."""
    K_star, n = of_clearance(dR, *candidates.T[:, :, None])
    return as_floats(K_star), as_floats(n)


# --- a point contact used for cylinders ---------------------------------------------------------


def sphere(pair, n):
    """Return K = (4/3)·E*·√R/L and n."""
    return 4 / 3 * pair.E_star * sqrt(pair.R) / pair.length, n


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

    n: float = 1.5
    name: ClassVar[str] = "lankarani-nikravesh"
    formula = Formula(
        load, sphere, end, energy,
        equation="f = 4/3*E_star*sqrt(R_i*R_j/dR)/length*penetration^n",
        remark="The law gives the total force f*length of a point contact, independent of the "
        "length; f is that force per unit length.",
    )  # fmt: skip
    any_plane = False
    needs = ("R_i", "R_j", "length")
    parameters = (
        Parameter("factor", 1e-2, 1e2, 1.0, stiffness=True, meaning="factor of the law's load"),
        Parameter("n", 0.8, 2.0, nominal=1.5, meaning="exponent of the penetration"),
    )

    def __post_init__(self) -> None:
        _require_exponent(self, "metals have n = 1.5")

    @classmethod
    def fitted(cls, values: Mapping[str, float]) -> ContactLaw:
        """Return the law with a factor and an exponent."""
        return ScaledLaw(cls(n=values["n"]), load_factor=values["factor"])
