"""Contact laws: load per unit length against penetration, all with the same five methods."""

from collections.abc import Callable, Mapping
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


# What 1.0.0rc1 had and this release has not, with what to use instead; kept for one release.
GONE: Mapping[str, str] = {
    "parametric": "use conformal, which is exact and faster",
    "explicit-pair": "use conformal, which is exact and faster",
    "winkler": "use conformal, or a law of your own: def load(penetration, E_star, dR): ...",
    "palmgren": "write it as a law of your own: def load(penetration, E_star, dR): ...",
    "iso-16281": "write it as a law of your own: def load(penetration, E_star, dR): ...",
}
_GONE_FROM_PYTHON: Mapping[str, str] = {
    **dict.fromkeys(("Parametric", "ParametricCoefficients"), "use laws.Conformal"),
    **dict.fromkeys(("ExplicitPair", "ExplicitPairCoefficients"), "use laws.Conformal"),
    **dict.fromkeys(("Winkler", "Palmgren", "Iso16281"), "write it as a law of your own"),
    "explicit_penetration": "use laws.Explicit().penetration or laws.Conformal().penetration",
    "LAW_TYPES": "use laws.LAWS, and laws.FITTED for those without default constants",
    **{
        "".join(part.capitalize() for part in name.split("-")): f'use laws.LAWS["{name}"]()'
        for name in RELATIVES
    },
    "Block": "give the depth in mm at which the plane is held, laws.Johnson(datum=depth)",
}


def __dir__() -> list[str]:
    return __all__


def __getattr__(name: str) -> Any:
    if name in _GONE_FROM_PYTHON:
        raise AttributeError(f"laws.{name} is gone: {_GONE_FROM_PYTHON[name]}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def refuse_gone(name: str, source: str, key: str) -> None:
    """Raise `InputError` for the name of a law that is gone."""
    if name in GONE:
        raise InputError(source, key, name, "is gone", GONE[name])


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
    refuse_gone(name, "reference law", "name")
    if name not in REFERENCES:
        rule = "is not a law that a grid can sample"
        remedy = f"choose among {', '.join(REFERENCES)}"
        raise InputError("reference law", "name", name, rule, remedy)
    return LAWS[name]()
