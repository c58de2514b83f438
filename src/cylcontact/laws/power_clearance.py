"""A power law of the penetration whose factor and exponent follow the clearance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy import exp, isfinite, log, nan, where

from cylcontact.arrays import FloatArray, as_floats, require
from cylcontact.laws.formula import Formula
from cylcontact.laws.law import LawModel, Parameter
from cylcontact.laws.power import IN_MM, PowerShaped, end, energy, load
from cylcontact.pair import Contact


def by_clearance(pair, A, p, n0, n1, q, n2):
    """Return K = K*·E*/ΔR and n, polynomials of ln ΔR in ln K* and n."""
    x = log(pair.dR)
    n = n0 + (n1 + n2 * x) * x
    return where(n > 0, A * exp((p + q * x) * x) * pair.E_star / pair.dR, nan), n


_EQUATION = "f = A*dR^(p + q*ln(dR))*E_star/dR*penetration^n with n = n0 + n1*ln(dR) + n2*ln(dR)^2"


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
    formula = Formula(load, by_clearance, end, energy, _EQUATION, IN_MM)
    on_grid = True

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            rule, remedy = "must be finite, and A positive", "give the values of a fit"
            valid = isfinite(value) and (name != "A" or value > 0)
            require(valid, "PowerClearance", name, value, rule, remedy)

    @classmethod
    def model(cls, contact: Contact, **_: object) -> LawModel:
        """Return how the law is fitted for a contact."""
        return super().model(contact, power_form=_power_form)


def _power_form(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return K* and n of candidates at clearances."""
    A, p, n0, n1, q, n2 = candidates.T[:, :, None]
    x = np.log(dR)
    return as_floats(A * np.exp((p + q * x) * x)), as_floats(n0 + (n1 + n2 * x) * x)
