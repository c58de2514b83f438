"""The law that a command line names: one of the package's, or a fit result's."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cylcontact.errors import InputError
from cylcontact.laws import LAWS
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.laws.enhanced import Enhanced
from cylcontact.laws.explicit import Explicit
from cylcontact.laws.power import PowerLaw
from cylcontact.pair import Contact

if TYPE_CHECKING:
    from cylcontact.fitting.result import FitResult

# Persson's law has no closed form; it is known by name all the same, to be told so.
EXPORTABLE = tuple(name for name in LAWS if name != "persson")


# The laws that campaigns on grids fit, from their coefficients.
FITTED: Mapping[str, Callable[[Mapping[str, float]], ContactLaw]] = {
    "enhanced": lambda found: Enhanced(coefficients=found),
    "explicit": lambda found: Explicit(coefficients=found),
    "power": lambda found: PowerLaw(**found),
}


@dataclass(frozen=True)
class FoundLaw:
    """A law, the contact it is for if that is known, and where its coefficients come from."""

    law: ContactLaw
    contact: Contact | None
    origin: str = ""


def find_law(what: str, contact: Contact | None) -> FoundLaw:
    """Return the law that `what` names, or that the fit result in this file found.

    Raises
    ------
    InputError
        If it is neither, or the result is for another contact.

    Examples
    --------
    >>> find_law("liu", None).law
    Liu()
    """
    if what in LAWS:
        return FoundLaw(LAWS[what](), contact)
    if what == PowerLaw.name:
        raise InputError(
            "export", "law", what, "has no coefficients of its own", "name a fit result of it"
        )
    if Path(what).suffix == ".json" or _exists(what):
        return _from_result(what, contact)
    raise InputError(
        "export",
        "law",
        what,
        "is neither a law that can be exported nor a fit result",
        f"choose {', '.join(EXPORTABLE)}, or the path of a result",
    )


def _exists(path: str) -> bool:
    """Tell whether there is such a file; a name that is too long is none."""
    with suppress(OSError):
        return Path(path).exists()
    return False


def _from_result(path: str, contact: Contact | None) -> FoundLaw:
    """Return the law of a fit result."""
    from cylcontact.fitting.result import FitResult

    result = FitResult.load(path)
    if contact not in (None, result.contact):
        raise InputError(
            path,
            "contact",
            result.contact,
            f"contradicts --contact {contact}",
            "leave --contact out, or name a result for that contact",
        )
    return FoundLaw(_law_of(result, path), result.contact, _origin(result))


def _law_of(result: FitResult, path: str) -> ContactLaw:
    """Return the law that a fit found, of the contact alone: the rig stays in the laboratory."""
    from cylcontact.fitting.law_models import model_of, without_rig
    from cylcontact.fitting.user_law import is_user_law

    if result.law in FITTED:
        return FITTED[result.law](without_rig(result.coefficients))
    if is_user_law(result.law):
        raise InputError(
            path,
            "law",
            result.law,
            "is a Python function of your own, which cannot be written in another language",
            "fit a law of the package, e.g. explicit",
        )
    return model_of(result.law, result.contact, path).build(without_rig(result.coefficients))


def _origin(result: FitResult) -> str:
    """Say what a result was fitted to, with what, and how well."""
    made_with = result.provenance.get("cylcontact", "an unknown version")
    return (
        f"fit result '{result.name}', fitted to {result.reference} by cylcontact {made_with}, "
        f"{result.objective.name} = {result.objective.value:.6g}"
    )
