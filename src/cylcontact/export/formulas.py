"""The formula of a law, as its definition states it."""

from __future__ import annotations

import re
from dataclasses import replace

from cylcontact.errors import InputError
from cylcontact.laws import DEFINITIONS
from cylcontact.laws.adapters import ScaledLaw
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.laws.formula import Formula
from cylcontact.laws.logarithmic import LogarithmicLaw, logarithmic_formula
from cylcontact.pair import Contact

__all__ = ["formula_of"]

# The name of a factor of the load in exported functions.
_FACTOR = "stiffness_factor"

_DEFINITIONS = {definition.law: definition for definition in DEFINITIONS}


def formula_of(law: ContactLaw, contact: Contact | None) -> Formula:
    """Return the formula of a law.

    Parameters
    ----------
    law : ContactLaw
        One of the package's laws that has a closed form for the load.
    contact : {"internal", "external"} or None
        The contact; may be None for laws that are the same for both.

    Returns
    -------
    Formula

    Raises
    ------
    InputError
        If the law has no closed form or is for the other contact.

    Examples
    --------
    >>> from cylcontact.laws.liu import Liu
    >>> formula_of(Liu(), "internal").equation
    'f = pi/2*E_star*d*sqrt(d/(2*(dR + d))) with the penetration d'
    """
    if isinstance(law, ScaledLaw):
        return _scaled(law, contact)
    definition = _DEFINITIONS.get(type(law))
    if definition is None or definition.formula is None:
        raise InputError(
            "export",
            "law",
            getattr(law, "name", law),
            "has no closed form to write in another language",
            "export explicit, which follows conformal contact",
        )
    if contact is not None and contact not in definition.contacts:
        raise InputError(
            "export",
            "--contact",
            contact,
            f"the law '{law.name}' is for a pin in a hole",
            "give --contact internal, or export johnson",
        )
    return definition.formula(law, contact)


def _scaled(law: ScaledLaw, contact: Contact | None) -> Formula:
    """Return a scaled logarithmic law, or another with a factor of its load."""
    if isinstance(law.base, LogarithmicLaw):
        return logarithmic_formula(law.base, contact, law)
    base = formula_of(law.base, contact)
    if law.penetration_factor != 1:
        raise InputError(
            "export",
            "law",
            law.name,
            "has a scaled penetration, which only logarithmic laws are written with",
            "hold clearance_factor at 1, or fit power, explicit or a logarithmic law",
        )
    if law.load_factor == 1:
        return replace(base, law=law)
    own = {_FACTOR: float(law.load_factor)}
    return replace(
        base,
        law=law,
        equation=f"{_FACTOR} times: {base.equation}",
        text=f"{_with_other_results(base.text)}\nf = {_FACTOR} * f1\nk = {_FACTOR} * k1",
        coefficients={**base.coefficients, **own},
        constants={**base.constants, **own},
    )


def _with_other_results(text: str) -> str:
    r"""Return steps that assign f1 and k1 instead of f and k.

    Examples
    --------
    >>> _with_other_results("f = 2 * dR\nk = f / dR")
    'f1 = 2 * dR\nk1 = f1 / dR'
    """
    return re.sub(r"\b([fk])\b", r"\g<1>1", text)
