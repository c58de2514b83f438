"""Fits of a law: to another law on a grid, or to readings, and what the coefficients are worth."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cylcontact.fitting.calibration import calibrate
    from cylcontact.fitting.campaign import Campaign
    from cylcontact.fitting.choice import Choice, choose
    from cylcontact.fitting.comparison import compare
    from cylcontact.fitting.power_fit import PowerFit, fit_power, fit_power_to_law
    from cylcontact.fitting.results import DataFit, FitResult, LawFit
    from cylcontact.fitting.table_campaign import TableCampaign, campaign_of_table, read_campaign
    from cylcontact.fitting.table_fit import fit, fit_table

__all__ = [
    "Campaign",
    "Choice",
    "DataFit",
    "FitResult",
    "LawFit",
    "PowerFit",
    "TableCampaign",
    "calibrate",
    "campaign_of_table",
    "choose",
    "compare",
    "fit",
    "fit_power",
    "fit_power_to_law",
    "fit_table",
    "read_campaign",
]

# Loaded on first use: the command line starts without them.
_NAMES = {
    "calibration": ("calibrate",),
    "campaign": ("Campaign",),
    "choice": ("Choice", "choose"),
    "comparison": ("compare",),
    "power_fit": ("PowerFit", "fit_power", "fit_power_to_law"),
    "results": ("DataFit", "FitResult", "LawFit"),
    "table_campaign": ("TableCampaign", "campaign_of_table", "read_campaign"),
    "table_fit": ("fit", "fit_table"),
}
_MODULES = {name: module for module, names in _NAMES.items() for name in names}


def __getattr__(name: str) -> object:
    if name in _MODULES:
        return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
