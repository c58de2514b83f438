"""Fits of a law: to another law on a grid, or to readings, and what the coefficients are worth."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cylcontact.fitting.calibration import calibrate
    from cylcontact.fitting.campaign import Campaign
    from cylcontact.fitting.choice import Choice, choose
    from cylcontact.fitting.comparison import compare
    from cylcontact.fitting.data_fit import DataFit
    from cylcontact.fitting.results import FitResult, LawFit
    from cylcontact.fitting.tables import (
        TableCampaign,
        campaign_of_table,
        fit,
        fit_table,
        read_campaign,
    )

__all__ = [
    "Campaign",
    "Choice",
    "DataFit",
    "FitResult",
    "LawFit",
    "TableCampaign",
    "calibrate",
    "campaign_of_table",
    "choose",
    "compare",
    "fit",
    "fit_table",
    "read_campaign",
]

# Loaded on first use: the command line starts without them.
_NAMES = {
    "calibration": ("calibrate",),
    "campaign": ("Campaign",),
    "choice": ("Choice", "choose"),
    "comparison": ("compare",),
    "data_fit": ("DataFit",),
    "results": ("FitResult", "LawFit"),
    "tables": ("TableCampaign", "campaign_of_table", "fit", "fit_table", "read_campaign"),
}
_MODULES = {name: module for module, names in _NAMES.items() for name in names}


def __getattr__(name: str) -> object:
    if name in _MODULES:
        return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
