"""The formula of a law, as its definition states it."""

from __future__ import annotations

from dataclasses import replace

from cylcontact.errors import InputError
from cylcontact.laws import DEFINITIONS
from cylcontact.laws.adapters import ScaledLaw
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.laws.formula import Formula
from cylcontact.laws.logarithmic import LogarithmicLaw, logarithmic_formula
from cylcontact.pair import Contact

__all__ = ["formula_of"]

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
    """Return a scaled logarithmic law, or the base law if both factors are 1."""
    if isinstance(law.base, LogarithmicLaw):
        return logarithmic_formula(law.base, contact, law)
    if law.load_factor == law.penetration_factor == 1:
        return replace(formula_of(law.base, contact), law=law)
    raise InputError(
        "export",
        "law",
        law.name,
        "has factors of its own, which only logarithmic laws are written with",
        "hold its factors at 1, or fit power, explicit or a logarithmic law",
    )
