"""The power law f = K·δⁿ, Eqs 3–4, and what all laws of this form share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy import inf, isfinite
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, inside_or_nan
from cylcontact.errors import InputError
from cylcontact.laws.definition import LawModel, Parameter
from cylcontact.laws.formula import Formula
from cylcontact.laws.law import Law
from cylcontact.pair import CONTACTS, Contact, CylinderPair

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
        f = as_floats(load)
        touching = np.asarray(f >= 0)
        return inside_or_nan((np.where(touching, f, 0.0) / factor) ** (1 / n), touching)

    def factor(self, pair: CylinderPair) -> FloatArray:
        """Return K in N/mm per mmⁿ for `pair`."""
        return self.factor_and_exponent(pair)[0]

    def exponent(self, pair: CylinderPair) -> FloatArray:
        """Return n for `pair`."""
        return self.factor_and_exponent(pair)[1]


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
            raise InputError(
                "PowerLaw",
                "K, K_star, C",
                factors,
                "exactly one of them must be given, positive and finite",
                "use K for one pair, K_star or C for a law that scales to others",
            )
        if not (self.n > 0 and isfinite(self.n)):
            raise InputError(
                "PowerLaw",
                "n",
                self.n,
                "must be positive and finite",
                "give the exponent of the penetration",
            )

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
        free: Any = {"power_form": _with_dR, "on_grid": True, "dimensionless": True}
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
