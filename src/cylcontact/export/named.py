"""Laws to export, given by the name of a law or the path of a fit result."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cylcontact.errors import InputError
from cylcontact.laws import LAWS
from cylcontact.laws.law import ContactLaw, formula_of
from cylcontact.laws.user import user_law
from cylcontact.pair import Contact

if TYPE_CHECKING:
    from cylcontact.fitting.results import FitResult

# `find_law` accepts the name of a law without a closed form too, and `exported` reports that.
EXPORTABLE = tuple(name for name, law in LAWS.items() if formula_of(law(), "internal") is not None)


@dataclass(frozen=True)
class FoundLaw:
    """A law, its contact if known, and the origin of its coefficients."""

    law: ContactLaw
    contact: Contact | None
    origin: str = ""


def find_law(what: str, contact: Contact | None) -> FoundLaw:
    """Return the law with the name `what`, or that of the fit result at this path.

    Raises `InputError` if it is neither, or the result is for the other contact.
    """
    if what in LAWS:
        return FoundLaw(LAWS[what](), contact)
    if what.startswith("power"):
        raise InputError(
            "export", "law", what, "has no coefficients of its own", "name a fit result of it"
        )
    if Path(what).suffix == ".json" or _exists(what):
        return _from_result(what, contact)
    if ":" in what:
        return FoundLaw(user_law(what, Path.cwd()), contact, "a function of the user's own")
    raise InputError(
        "export",
        "law",
        what,
        "is neither a law that can be exported nor a fit result",
        f"choose {', '.join(EXPORTABLE)}, module:function of your own, or the path of a result",
    )


def _exists(path: str) -> bool:
    """Return whether the file exists; False for a name that is too long."""
    with suppress(OSError):
        return Path(path).exists()
    return False


def _from_result(path: str, contact: Contact | None) -> FoundLaw:
    """Return the law of a fit result."""
    from cylcontact.fitting.results import FitResult

    result = FitResult.read(path)
    if contact not in (None, result.contact):
        raise InputError(
            path,
            "contact",
            result.contact,
            f"contradicts --contact {contact}",
            "leave --contact out, or name a result for that contact",
        )
    return FoundLaw(result.to_law(path), result.contact, _origin(result))


def _origin(result: FitResult) -> str:
    """Return the reference, version and objective of a fit result in words."""
    made_with = result.provenance.get("cylcontact", "an unknown version")
    return (
        f"fit result '{result.name}', fitted to {result.reference} by cylcontact {made_with}, "
        f"{result.objective.name} = {result.objective.value:.6g}"
    )
