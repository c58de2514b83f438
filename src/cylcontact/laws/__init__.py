"""Contact laws: load per unit length against penetration, all with the same five methods."""

from collections.abc import Callable

from cylcontact.errors import InputError
from cylcontact.laws.conformal import Persson
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.laws.difference import difference_percent
from cylcontact.laws.enhanced import (
    PUBLISHED,
    Enhanced,
    ExternalCoefficients,
    InternalCoefficients,
)
from cylcontact.laws.explicit import Explicit, ExplicitCoefficients, explicit_penetration
from cylcontact.laws.liu import Liu
from cylcontact.laws.logarithmic import Johnson, LogarithmicLaw
from cylcontact.laws.logarithmic_variants import (
    DubowskyFreudenstein,
    Esdu78035,
    Goldsmith,
    HertzCylinder,
    Radzimovsky,
    RadzimovskyRadii,
    RoarkYoung,
)
from cylcontact.laws.power import PowerLaw
from cylcontact.laws.sphere import LankaraniNikravesh
from cylcontact.laws.winkler import Winkler

__all__ = [
    "LAWS",
    "PUBLISHED",
    "REFERENCES",
    "ContactLaw",
    "DubowskyFreudenstein",
    "Enhanced",
    "Esdu78035",
    "Explicit",
    "ExplicitCoefficients",
    "ExternalCoefficients",
    "Goldsmith",
    "HertzCylinder",
    "InternalCoefficients",
    "Johnson",
    "LankaraniNikravesh",
    "Liu",
    "LogarithmicLaw",
    "Persson",
    "PowerLaw",
    "Radzimovsky",
    "RadzimovskyRadii",
    "RoarkYoung",
    "Winkler",
    "difference_percent",
    "explicit_penetration",
    "reference_law",
]


def __dir__() -> list[str]:
    return __all__


# The laws with default coefficients, by the names that specs and commands use.
LAWS: dict[str, Callable[[], ContactLaw]] = {
    "johnson": Johnson,
    "roark-young": RoarkYoung,
    "radzimovsky": Radzimovsky,
    "radzimovsky-radii": RadzimovskyRadii,
    "esdu-78035": Esdu78035,
    "dubowsky-freudenstein": DubowskyFreudenstein,
    "goldsmith": Goldsmith,
    "hertz-cylinder": HertzCylinder,
    "liu": Liu,
    "winkler": Winkler,
    "persson": Persson,
    "enhanced": Enhanced,
    "explicit": Explicit,
    "lankarani-nikravesh": LankaraniNikravesh,
}

# The laws that need ΔR only, no radii or length: those that a grid can sample.
REFERENCES = tuple(
    name
    for name in LAWS
    if name not in ("dubowsky-freudenstein", "goldsmith", "lankarani-nikravesh", "winkler")
)


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
        If there is no such law, or it needs more than ΔR.

    Examples
    --------
    >>> reference_law("johnson")
    Johnson()
    """
    if name not in REFERENCES:
        raise InputError(
            "reference law",
            "name",
            name,
            "is not a law that a grid can sample",
            f"choose among {', '.join(REFERENCES)}",
        )
    return LAWS[name]()
