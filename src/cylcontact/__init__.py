"""Calibrate explicit contact laws for parallel cylinders, and see where each can be trusted."""

from importlib import import_module
from types import ModuleType

from cylcontact import dissipation, friction, laws, limits
from cylcontact.errors import InputError
from cylcontact.laws import ContactLaw
from cylcontact.materials import Material
from cylcontact.pair import CylinderPair

__all__ = [
    "ContactLaw",
    "CylinderPair",
    "InputError",
    "Material",
    "datasets",
    "dissipation",
    "export",
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


def __getattr__(name: str) -> ModuleType:
    if name in _LAZY:
        return import_module(f"cylcontact.{name}")
    raise AttributeError(f"module 'cylcontact' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
