"""Contact laws: load per unit length against penetration, all with the same five methods."""

from collections.abc import Callable
from typing import Any

from cylcontact.bodies.pair import Contact
from cylcontact.laws.conformal import Conformal, Housing, Persson, Sector
from cylcontact.laws.enhanced import (
    PUBLISHED,
    Enhanced,
    ExternalCoefficients,
    InternalCoefficients,
)
from cylcontact.laws.explicit import Explicit, ExplicitCoefficients
from cylcontact.laws.law import ContactLaw, difference_percent
from cylcontact.laws.liu import Liu
from cylcontact.laws.logarithmic import RELATIVES, Johnson, LogarithmicLaw
from cylcontact.laws.power import (
    LankaraniNikravesh,
    PowerClearance,
    PowerLaw,
)
from cylcontact.support.errors import InputError

__all__ = [
    "FITTED",
    "LAWS",
    "PUBLISHED",
    "REFERENCES",
    "Conformal",
    "ContactLaw",
    "Enhanced",
    "Explicit",
    "ExplicitCoefficients",
    "ExternalCoefficients",
    "Housing",
    "InternalCoefficients",
    "Johnson",
    "LankaraniNikravesh",
    "Liu",
    "LogarithmicLaw",
    "Persson",
    "PowerClearance",
    "PowerLaw",
    "Sector",
    "difference_percent",
    "reference_law",
]


def __dir__() -> list[str]:
    return __all__


def _always(law: ContactLaw) -> Callable[[], ContactLaw]:
    return lambda: law


# The laws with default constants, by the names that specs and commands use; a new law is one more
# entry.
LAWS: dict[str, Callable[[], ContactLaw]] = {
    Johnson().name: Johnson,
    **{name: _always(law) for name, law in RELATIVES.items()},
    **{law.name: law for law in (Liu, Persson, Conformal, Enhanced, Explicit, LankaraniNikravesh)},
}
# Those without, which a fit gives.
FITTED: dict[str, type[ContactLaw]] = {"power": PowerLaw, "power-clearance": PowerClearance}


def contacts_of(name: str) -> tuple[Contact, ...]:
    """Return the contacts that a law of `LAWS` is for."""
    law: Any = LAWS[name]()
    contacts: tuple[Contact, ...] = law.contacts
    return contacts


# Those that need ΔR only, no radii or length, which a grid can sample.
REFERENCES = tuple(name for name, law in LAWS.items() if not getattr(law(), "needs", ()))


def reference_law(name: str) -> ContactLaw:
    """Return the law that grid specs call `name`.

    Raises
    ------
    InputError
        If there is no such law, or it needs more than ΔR.

    Examples
    --------
    >>> reference_law("johnson")
    Johnson()
    """
    if name not in REFERENCES:
        rule = "is not a law that a grid can sample"
        remedy = f"choose among {', '.join(REFERENCES)}"
        raise InputError("reference law", "name", name, rule, remedy)
    return LAWS[name]()
