"""Calibrate explicit contact laws for parallel cylinders, and see where each can be trusted."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cylcontact import fits, laws, limits, sizing
    from cylcontact import impact as dissipation
    from cylcontact import impact as friction
    from cylcontact.errors import InputError
    from cylcontact.fitting import choose, fit
    from cylcontact.laws import ContactLaw
    from cylcontact.materials import Material
    from cylcontact.pair import CylinderPair

__all__ = [
    "ContactLaw",
    "CylinderPair",
    "InputError",
    "Material",
    "choose",
    "datasets",
    "dissipation",
    "export",
    "fit",
    "fits",
    "fitting",
    "friction",
    "laws",
    "limits",
    "mechanism",
    "plots",
    "reports",
    "sizing",
]
__version__ = "1.0.0rc1"

# Where the names are that are no modules. All are loaded on first use, so that a command which
# needs no numbers begins at once.
_IN = {
    "ContactLaw": "laws",
    "CylinderPair": "pair",
    "InputError": "errors",
    "Material": "materials",
    "choose": "fitting",
    "fit": "fitting",
}


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'cylcontact' has no attribute {name!r}")
    if name in _IN:
        value = getattr(import_module(f"cylcontact.{_IN[name]}"), name)
    else:
        module = "impact" if name in ("dissipation", "friction") else name
        value = import_module(f"cylcontact.{module}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
