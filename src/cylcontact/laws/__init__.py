"""Contact laws: load per unit length against penetration, all with the same five methods."""

from collections.abc import Callable
from typing import Any

from cylcontact.laws.arcs import ParametricCoefficients
from cylcontact.laws.conformal import Conformal, Persson
from cylcontact.laws.enhanced import (
    PUBLISHED,
    Enhanced,
    ExternalCoefficients,
    InternalCoefficients,
)
from cylcontact.laws.explicit import Explicit, ExplicitCoefficients, explicit_penetration
from cylcontact.laws.explicit_pair import ExplicitPair, ExplicitPairCoefficients
from cylcontact.laws.foundation import Liu, Winkler
from cylcontact.laws.housing import Housing, Sector
from cylcontact.laws.law import ContactLaw, difference_percent
from cylcontact.laws.logarithmic import (
    Block,
    DubowskyFreudenstein,
    Esdu78035,
    Goldsmith,
    HertzCylinder,
    Johnson,
    LogarithmicLaw,
    Radzimovsky,
    RadzimovskyRadii,
    RoarkYoung,
)
from cylcontact.laws.parametric import Parametric
from cylcontact.laws.power import (
    Iso16281,
    LankaraniNikravesh,
    Palmgren,
    PowerClearance,
    PowerLaw,
)
from cylcontact.support.errors import InputError

__all__ = [
    "LAWS",
    "LAW_TYPES",
    "PUBLISHED",
    "REFERENCES",
    "Block",
    "Conformal",
    "ContactLaw",
    "DubowskyFreudenstein",
    "Enhanced",
    "Esdu78035",
    "Explicit",
    "ExplicitCoefficients",
    "ExplicitPair",
    "ExplicitPairCoefficients",
    "ExternalCoefficients",
    "Goldsmith",
    "HertzCylinder",
    "Housing",
    "InternalCoefficients",
    "Iso16281",
    "Johnson",
    "LankaraniNikravesh",
    "Liu",
    "LogarithmicLaw",
    "Palmgren",
    "Parametric",
    "ParametricCoefficients",
    "Persson",
    "PowerClearance",
    "PowerLaw",
    "Radzimovsky",
    "RadzimovskyRadii",
    "RoarkYoung",
    "Sector",
    "Winkler",
    "difference_percent",
    "explicit_penetration",
    "reference_law",
]


def __dir__() -> list[str]:
    return __all__


# Every law of the package; a new one is one more entry.
LAW_TYPES: tuple[type[Any], ...] = (
    Johnson,
    RoarkYoung,
    Radzimovsky,
    RadzimovskyRadii,
    Esdu78035,
    DubowskyFreudenstein,
    Goldsmith,
    HertzCylinder,
    Liu,
    Winkler,
    Persson,
    Conformal,
    Parametric,
    Enhanced,
    Explicit,
    ExplicitPair,
    LankaraniNikravesh,
    Palmgren,
    Iso16281,
    PowerLaw,
    PowerClearance,
)

# The laws with default coefficients, by the names that specs and commands use.
LAWS: dict[str, Callable[[], ContactLaw]] = {
    law.name: law for law in LAW_TYPES if law not in (PowerLaw, PowerClearance)
}

# Those that need ΔR only, no radii or length, which a grid can sample.
REFERENCES = tuple(name for name, law in LAWS.items() if not getattr(law, "needs", ()))


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
