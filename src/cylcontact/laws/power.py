"""The power law f = K·δⁿ, Eqs 3–4."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, inside_or_nan
from cylcontact.errors import InputError
from cylcontact.html_repr import law_html
from cylcontact.laws.contact_law import ContactLaw, OverLength, depth_of
from cylcontact.laws.definition import Coefficients, Definition, KernelSteps, LawModel, Parameter
from cylcontact.laws.formula import IN_MM, Formula, function_name
from cylcontact.pair import CONTACTS, Contact, CylinderPair

__all__ = ["DEFINITION", "KERNEL", "PowerLaw", "PowerShaped"]


class PowerShaped(OverLength, ABC):
    """The common form f = K·δⁿ at each pair; a law supplies K and n."""

    _repr_html_ = law_html

    @abstractmethod
    def factor_and_exponent(self, pair: CylinderPair) -> tuple[FloatArray, FloatArray]:
        """Return K in N/mm per mmⁿ and n, both NaN where the law is undefined."""

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm, δ = (f/K)^(1/n)."""
        factor, n = self.factor_and_exponent(pair)
        f = as_floats(load)
        touching = f >= 0
        return inside_or_nan((np.where(touching, f, 0.0) / factor) ** (1 / n), touching)

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm, f = K·δⁿ."""
        factor, n = self.factor_and_exponent(pair)
        return _if_touching(penetration, lambda delta: factor * delta**n)

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return df/dδ = n·K·δⁿ⁻¹ in N/mm²; infinite at δ = 0 if n < 1."""
        factor, n = self.factor_and_exponent(pair)
        with np.errstate(divide="ignore"):
            return _if_touching(penetration, lambda delta: n * (factor * delta ** (n - 1)))

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return inf, as a power law has no largest load; NaN where it is undefined."""
        factor, _ = self.factor_and_exponent(pair)
        return inside_or_nan(np.full_like(factor, np.inf), np.isfinite(factor))

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return inf where the law is defined, NaN elsewhere."""
        return self.max_load(pair)

    def factor(self, pair: CylinderPair) -> FloatArray:
        """Return K in N/mm per mmⁿ for `pair`."""
        return self.factor_and_exponent(pair)[0]

    def exponent(self, pair: CylinderPair) -> FloatArray:
        """Return n for `pair`."""
        return self.factor_and_exponent(pair)[1]


def _if_touching(
    penetration: ArrayLike, function: Callable[[FloatArray], FloatArray]
) -> FloatArray:
    """Return a function of the penetration, 0 where that is negative, also of a law of NaN."""
    delta = as_floats(penetration)
    depth = depth_of(delta)
    # A NaN is neither: a NaN to the power of zero would be 1.
    return as_floats(np.where(delta >= 0, function(depth), 0 * depth))


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
        if len(given) != 1 or not (given[0] > 0 and np.isfinite(given[0])):
            raise InputError(
                "PowerLaw",
                "K, K_star, C",
                factors,
                "exactly one of them must be given, positive and finite",
                "use K for one pair, K_star or C for a law that scales to others",
            )
        if not (self.n > 0 and np.isfinite(self.n)):
            raise InputError(
                "PowerLaw",
                "n",
                self.n,
                "must be positive and finite",
                "give the exponent of the penetration",
            )

    @property
    def name(self) -> str:
        """The law's name, that of its fits."""
        return "power" if self.C is None else "power-dimensionless"

    def factor_and_exponent(self, pair: CylinderPair) -> tuple[FloatArray, FloatArray]:
        """Return K in N/mm per mmⁿ and n."""
        E_star, dR, n = pair.E_star, as_floats(pair.dR), as_floats(self.n)
        if self.C is not None:
            return as_floats(self.C * E_star * dR ** (1 - n)), n
        scale = E_star / dR
        if self.K_star is not None:
            return as_floats(self.K_star * scale), n
        return as_floats(np.full_like(scale, self.K)), n


def _numbers(law: PowerShaped, pair: CylinderPair) -> tuple[float, float]:
    """Return K and n."""
    factor, n = law.factor_and_exponent(pair)
    return float(factor), float(n)


_STEPS = """
f = factor * penetration ** n
k = n * (factor * penetration ** (n - 1))
energy = f * penetration / (n + 1)
"""
KERNEL = KernelSteps(("factor", "n"), _numbers, _STEPS)

# K in terms of a law's factor, the law on one line and a remark, by the name of the factor.
_FORMS = {
    "C": (
        "C_factor * E_star * dR ** (1 - n)",
        "f = C_factor*E_star*dR*(penetration/dR)^n",
        "Dimensionless in penetration/dR and f/(E_star*dR).",
    ),
    "K_star": ("K_star * (E_star / dR)", "f = K_star*E_star/dR*penetration^n", IN_MM),
    "K": (
        "K_factor",
        "f = K_factor*penetration^n",
        f"{IN_MM} For the one pair that it was fitted to.",
    ),
}


def _formula(law: PowerLaw, contact: Contact | None) -> Formula:
    """Return the formula for export."""
    name, value = next((name, v) for name in _FORMS if (v := getattr(law, name)) is not None)
    factor, equation, remark = _FORMS[name]
    # C and K alone would differ from other names in case only, which Fortran ignores.
    constant = name if "_" in name else f"{name}_factor"
    numbers = {constant: float(value), "n": float(law.n)}
    return Formula(
        name=function_name(law.name, contact),
        law=law,
        contact=contact,
        equation=equation,
        text=f"factor = {factor}{_STEPS}",
        coefficients=numbers,
        constants=numbers,
        remark=remark,
    )


def _power_law(values: Coefficients) -> ContactLaw:
    """Return the law of n and one of K, K_star and C."""
    return PowerLaw(**values)


def _constant(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the same K* and n at every ΔR (Eqs 3-4)."""
    K_star, n = candidates.T[:, :, None] + np.zeros_like(dR)
    return K_star, n


def _dimensionless(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return K* = C·ΔR^(2 − n), and n."""
    C, n = candidates.T[:, :, None] + np.zeros_like(dR)
    return as_floats(C * dR ** (2 - n)), n


def _models(contact: Contact) -> tuple[LawModel, ...]:
    """Return the three ways to fit a power law."""
    n = Parameter("n", 0.8, 2.0, meaning="exponent of the penetration")
    K = Parameter("K", 1.0, 1e9, unit="N/mm/mm^n", meaning="factor, of this pair only")
    K_star = Parameter("K_star", 1e-3, 1e3, unit="mm^(2-n)", meaning="factor of E*/ΔR")
    C = Parameter("C", 1e-3, 1e3, meaning="factor of E*·ΔR")
    return (
        LawModel("power-one-pair", contact, (K, n), _power_law),
        LawModel("power", contact, (K_star, n), _power_law, _constant, on_grid=True),
        LawModel(
            "power-dimensionless",
            contact,
            (C, n),
            _power_law,
            _dimensionless,
            on_grid=True,
            dimensionless=True,
        ),
    )


DEFINITION = Definition(
    law=PowerLaw,
    formula=_formula,
    kernel=KERNEL,
    models=tuple(model for contact in CONTACTS for model in _models(contact)),
    has_defaults=False,
)
