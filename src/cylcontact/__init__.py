"""Calibrate explicit contact laws for parallel cylinders, and see where each can be trusted."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from cylcontact import impact as dissipation
from cylcontact import impact as friction
from cylcontact import laws, limits
from cylcontact.errors import InputError
from cylcontact.laws import ContactLaw
from cylcontact.materials import Material
from cylcontact.pair import CylinderPair

if TYPE_CHECKING:
    from cylcontact.fitting.choice import choose
    from cylcontact.fitting.table_fit import fit

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
    "fitting",
    "friction",
    "laws",
    "limits",
    "mechanism",
    "plots",
    "reports",
]
__version__ = "0.1.0"

# These import pandas, numba or matplotlib, so they are loaded on first use.
_LAZY = ("datasets", "export", "fitting", "mechanism", "plots", "reports")


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        return import_module(f"cylcontact.{name}")
    if name in ("choose", "fit"):
        return getattr(import_module("cylcontact.fitting"), name)
    raise AttributeError(f"module 'cylcontact' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
