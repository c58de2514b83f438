"""Contact laws: load per unit length against penetration, all with the same five answers."""

from cylcontact.errors import InputError
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.laws.difference import difference_percent
from cylcontact.laws.enhanced import (
    PUBLISHED,
    Enhanced,
    ExternalCoefficients,
    InternalCoefficients,
)
from cylcontact.laws.logarithmic import Johnson, LogarithmicLaw
from cylcontact.laws.power import PowerLaw
from cylcontact.laws.sphere import LankaraniNikravesh

__all__ = [
    "PUBLISHED",
    "REFERENCES",
    "ContactLaw",
    "Enhanced",
    "ExternalCoefficients",
    "InternalCoefficients",
    "Johnson",
    "LankaraniNikravesh",
    "LogarithmicLaw",
    "PowerLaw",
    "difference_percent",
    "reference_law",
]

# The laws that a grid spec may sample by name.
REFERENCES: dict[str, type[Johnson]] = {Johnson.name: Johnson}


def reference_law(name: str) -> ContactLaw:
    """Return the law that grid specs call `name`.

    Parameters
    ----------
    name : str
        One of `REFERENCES`.

    Returns
    -------
    ContactLaw

    Raises
    ------
    InputError
        If there is no such law.

    Examples
    --------
    >>> reference_law("johnson")
    Johnson()
    """
    if name not in REFERENCES:
        raise InputError(
            "reference law", "name", name, "is not known", f"choose {' or '.join(REFERENCES)}"
        )
    return REFERENCES[name]()
