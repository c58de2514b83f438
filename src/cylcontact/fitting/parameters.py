"""What is fitted: the parameters of a law that is a power law at each clearance.

Every such law is f = K*(ΔR)·E*/ΔR·δ^n(ΔR), and a `Family` says how its parameters make K*
and n. Candidates come as rows of a matrix, so that a whole population is evaluated at once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.errors import InputError
from cylcontact.laws import PUBLISHED
from cylcontact.laws.enhanced import (
    INTERNAL_DR_MAX,
    INTERNAL_DR_MIN,
    internal_exponent,
    stiffness_factor,
)
from cylcontact.pair import Contact


@dataclass(frozen=True)
class Parameter:
    """A parameter of a campaign: searched between two bounds, or held at a value.

    Parameters
    ----------
    name : str
        The parameter's name in its family.
    low, high : float
        Bounds of the search.
    value : float, optional
        Where it is held when it is fixed.
    fixed : bool
        Whether it is.
    """

    name: str
    low: float
    high: float
    value: float | None = None
    fixed: bool = False


@dataclass(frozen=True)
class PowerForm:
    """P candidates at m clearances.

    Attributes
    ----------
    c : array of float, shape (P, m)
        ln ΔR − ln K*; NaN where K* is not positive.
    n : array of float, shape (P, m)
        Exponent; NaN where it is not positive.
    """

    c: FloatArray
    n: FloatArray


@dataclass(frozen=True)
class Family:
    """A law and a contact, with the names of the parameters to find.

    Attributes
    ----------
    law : str
        The law's name in campaigns.
    contact : {"internal", "external"}
        The contact the parameters are for.
    names : tuple of str
        The parameters, in the order of the columns that `evaluate` takes.
    published : mapping or None
        The values in the paper, where it gives any.
    dR_min, dR_max : float
        The range of ΔR in mm that the law is stated for, both ends included: calibration may
        use the limit at the open end of [0.005, 10[ that the law itself excludes.
    evaluate : callable
        From candidates, shape (P, k), and ΔR in mm, shape (m,), to K* and n, each (P, m).
    """

    law: str
    contact: Contact
    names: tuple[str, ...]
    published: Mapping[str, float] | None
    dR_min: float
    dR_max: float
    evaluate: Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]

    def power_form(self, candidates: FloatArray, dR: FloatArray) -> PowerForm:
        """Return c and n of the candidates, shape (P, k), at ΔR in mm, shape (m,)."""
        K_star, n = self.evaluate(candidates, dR)
        K_star = np.where(K_star > 0, K_star, np.nan)
        return PowerForm(
            c=as_floats(np.log(dR) - np.log(K_star)),
            n=as_floats(np.where(n > 0, n, np.nan)),
        )


def _enhanced_internal(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, FloatArray]:
    """K* and n of Eqs 5–6 for internal contact."""
    a, b, *rest = candidates.T[:, :, None]
    return stiffness_factor(dR, a, b), internal_exponent(dR, *rest)


def _enhanced_external(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, FloatArray]:
    """K* and n of Eqs 5–6 for external contact."""
    a, b, n = candidates.T[:, :, None]
    return stiffness_factor(dR, a, b), as_floats(np.broadcast_to(n, (n.shape[0], dR.size)))


def _power(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, FloatArray]:
    """K* and n of Eqs 3–4, the same at every ΔR."""
    K_star, n = (
        np.broadcast_to(column[:, None], (len(column), dR.size)) for column in candidates.T
    )
    return as_floats(K_star), as_floats(n)


def _families() -> dict[tuple[str, Contact], Family]:
    """Return the families that campaigns can name."""
    internal, external = asdict(PUBLISHED["internal"]), asdict(PUBLISHED["external"])
    names = ("K_star", "n")
    return {
        (family.law, family.contact): family
        for family in (
            Family(
                "enhanced",
                "internal",
                tuple(internal),
                internal,
                INTERNAL_DR_MIN,
                INTERNAL_DR_MAX,
                _enhanced_internal,
            ),
            Family(
                "enhanced", "external", tuple(external), external, 0.0, np.inf, _enhanced_external
            ),
            Family("power", "internal", names, None, 0.0, np.inf, _power),
            Family("power", "external", names, None, 0.0, np.inf, _power),
        )
    }


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
