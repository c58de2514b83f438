"""Families of laws with named parameters, and candidates of them.

Most laws are a power law at each clearance, f = K*(ΔR)·E*/ΔR·δ^n(ΔR). A population of them is a
`PowerForm`, evaluated at once. A `LawForm` holds candidates of any other kind.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, fields
from typing import Protocol

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.errors import InputError
from cylcontact.fitting.samples import Samples
from cylcontact.laws import PUBLISHED, ContactLaw
from cylcontact.laws.enhanced import (
    INTERNAL_DR_MAX,
    INTERNAL_DR_MIN,
    internal_exponent,
    stiffness_factor,
)
from cylcontact.laws.explicit import Explicit, ExplicitCoefficients, is_defined
from cylcontact.pair import CONTACTS, Contact

__all__ = ["FAMILIES", "Family", "Form", "LawForm", "Parameter", "PowerForm", "family_of"]

_EXPLICIT_NAMES = tuple(field.name for field in fields(ExplicitCoefficients))


@dataclass(frozen=True)
class Parameter:
    """A parameter of a campaign: searched between two bounds, fixed, or tied to others.

    Parameters
    ----------
    name : str
        The parameter's name in its family.
    low, high : float
        Bounds of the search; NaN if it is not searched.
    value : float, optional
        Its value if it is fixed.
    fixed : bool
        Whether it is fixed.
    tie : str, optional
        The expression that sets it, e.g. "a/10" (`fitting.ties`).
    """

    name: str
    low: float = math.nan
    high: float = math.nan
    value: float | None = None
    fixed: bool = False
    tie: str | None = None

    @property
    def is_free(self) -> bool:
        """Whether it is searched."""
        return not self.fixed and self.tie is None


class Form(Protocol):
    """P candidates that can be compared with samples."""

    def __len__(self) -> int:
        """Return P."""
        ...

    def log_penetration_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return ln(δ_law/δ_reference) of each sample at equal load, shape (N,)."""
        ...

    def log_load_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return ln(f_law/f_reference) of each sample at equal penetration, shape (N,)."""
        ...


@dataclass(frozen=True)
class PowerForm:
    """P power laws at m clearances.

    Attributes
    ----------
    c : array of float, shape (P, m)
        ln ΔR − ln K*; NaN where K* is not positive.
    n : array of float, shape (P, m)
        Exponent; NaN where it is not positive.
    """

    c: FloatArray
    n: FloatArray

    def __len__(self) -> int:
        return len(self.n)

    def log_penetration_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return r = (s + c)/n − j of each sample."""
        c, n = self.c[candidate][rows.index], self.n[candidate][rows.index]
        return as_floats((rows.s + c) / n - rows.j)

    def log_load_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return n·j − c − s = −n·r of each sample."""
        c, n = self.c[candidate][rows.index], self.n[candidate][rows.index]
        return as_floats(n * rows.j - c - rows.s)


@dataclass(frozen=True)
class LawForm:
    """P laws of any kind; None for parameters that define none."""

    laws: tuple[ContactLaw | None, ...]

    def __len__(self) -> int:
        return len(self.laws)

    def log_penetration_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return ln(δ_law/δ_reference) of each sample at equal load."""
        law = self.laws[candidate]
        if law is None:
            return np.full_like(rows.s, np.nan)
        return as_floats(np.log(law.penetration(rows.load, rows.pair)) - rows.j)

    def log_load_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return ln(f_law/f_reference) of each sample at equal penetration."""
        law = self.laws[candidate]
        if law is None:
            return np.full_like(rows.s, np.nan)
        return as_floats(np.log(law.load(rows.penetration, rows.pair)) - rows.s)


@dataclass(frozen=True)
class Family:
    """A law and a contact, with the names of the parameters to find.

    Attributes
    ----------
    law : str
        The law's name in campaigns.
    contact : {"internal", "external"}
        The contact.
    names : tuple of str
        The parameters, in the order of the columns of candidates.
    form : callable
        From candidates, shape (P, k), and clearances ΔR in mm, shape (m,), to a `Form`.
    is_power_law : bool
        Whether that is a `PowerForm`, which can be evaluated from moments and has a lower bound.
    published : mapping or None
        The values in the paper, if there are any.
    dR_min, dR_max : float
        The range of ΔR in mm, both ends included: calibration may use the open end of [0.005, 10[,
        which the law itself excludes.
    shifts : tuple of str
        The parameters whose zero is arbitrary.
    """

    law: str
    contact: Contact
    names: tuple[str, ...]
    form: Callable[[FloatArray, FloatArray], Form]
    is_power_law: bool = True
    published: Mapping[str, float] | None = None
    dR_min: float = 0.0
    dR_max: float = np.inf
    shifts: tuple[str, ...] = ()


def _power_form(K_star: FloatArray, n: FloatArray, dR: FloatArray) -> PowerForm:
    """Return the candidates with these K* and n, (P, m) each, at ΔR in mm, (m,)."""
    K_star = np.where(K_star > 0, K_star, np.nan)
    return PowerForm(
        c=as_floats(np.log(dR) - np.log(K_star)), n=as_floats(np.where(n > 0, n, np.nan))
    )


def _enhanced_internal(candidates: FloatArray, dR: FloatArray) -> PowerForm:
    """Eqs 5–6 for internal contact."""
    a, b, *rest = candidates.T[:, :, None]
    return _power_form(stiffness_factor(dR, a, b), internal_exponent(dR, *rest), dR)


def _enhanced_external(candidates: FloatArray, dR: FloatArray) -> PowerForm:
    """Eqs 5–6 for external contact."""
    a, b, n = candidates.T[:, :, None]
    return _power_form(stiffness_factor(dR, a, b), n + np.zeros_like(dR), dR)


def _power(candidates: FloatArray, dR: FloatArray) -> PowerForm:
    """Eqs 3–4: the same K* and n at every ΔR."""
    K_star, n = candidates.T[:, :, None] + np.zeros_like(dR)
    return _power_form(K_star, n, dR)


def _power_dimensionless(candidates: FloatArray, dR: FloatArray) -> PowerForm:
    """f = C·E*·ΔR·(δ/ΔR)^n, that is K* = C·ΔR^(2 − n)."""
    C, n = candidates.T[:, :, None] + np.zeros_like(dR)
    return _power_form(C * dR ** (2 - n), n, dR)


def _explicit(candidates: FloatArray, _: FloatArray) -> LawForm:
    """Return explicit laws with these c, A and B; None if they define none."""
    names = _EXPLICIT_NAMES
    return LawForm(
        tuple(
            Explicit(dict(zip(names, map(float, row), strict=True))) if is_defined(*row) else None
            for row in candidates
        )
    )


def _families() -> dict[tuple[str, Contact], Family]:
    """Return the families for campaigns on a grid."""
    internal, external = asdict(PUBLISHED["internal"]), asdict(PUBLISHED["external"])
    families: tuple[Family, ...] = (
        Family(
            law="enhanced",
            contact="internal",
            names=tuple(internal),
            form=_enhanced_internal,
            published=internal,
            dR_min=INTERNAL_DR_MIN,
            dR_max=INTERNAL_DR_MAX,
        ),
        Family("enhanced", "external", tuple(external), _enhanced_external, published=external),
    )
    for contact in CONTACTS:
        families += (
            Family("power", contact, ("K_star", "n"), _power),
            Family("power-dimensionless", contact, ("C", "n"), _power_dimensionless),
            Family("explicit", contact, _EXPLICIT_NAMES, _explicit, is_power_law=False),
        )
    return {(family.law, family.contact): family for family in families}


FAMILIES = _families()


def family_of(law: str, contact: Contact, source: str) -> Family:
    """Return the family of a law and a contact.

    Raises
    ------
    InputError
        If the law cannot be fitted.
    """
    if (law, contact) not in FAMILIES:
        known = " or ".join(sorted({name for name, _ in FAMILIES}))
        raise InputError(source, "law", law, "is not a law that can be fitted", f"choose {known}")
    return FAMILIES[law, contact]
