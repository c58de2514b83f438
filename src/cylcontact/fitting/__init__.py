"""Fits of a law to another law on a grid or to measurements, with uncertainties."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cylcontact.fitting.calibration import calibrate
    from cylcontact.fitting.campaign import Campaign
    from cylcontact.fitting.choice import Choice, choose
    from cylcontact.fitting.comparison import compare
    from cylcontact.fitting.data_fit import DataFit
    from cylcontact.fitting.measure import fit, fit_table
    from cylcontact.fitting.results import FitResult, LawFit
    from cylcontact.fitting.stored import read_result

__all__ = [
    "Campaign",
    "Choice",
    "DataFit",
    "FitResult",
    "LawFit",
    "calibrate",
    "choose",
    "compare",
    "fit",
    "fit_table",
    "read_result",
]

# Loaded on first use: the command line starts without them.
_NAMES = {
    "calibration": ("calibrate",),
    "campaign": ("Campaign",),
    "choice": ("Choice", "choose"),
    "comparison": ("compare",),
    "data_fit": ("DataFit",),
    "measure": ("fit", "fit_table"),
    "results": ("FitResult", "LawFit"),
    "stored": ("read_result",),
}
_MODULES = {name: module for module, names in _NAMES.items() for name in names}


def __getattr__(name: str) -> object:
    if name in _MODULES:
        return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
