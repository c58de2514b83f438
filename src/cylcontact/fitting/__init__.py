"""Calibration: from a campaign to the coefficients, and what they are worth."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cylcontact.fitting.assessment import verdicts
    from cylcontact.fitting.calibration import calibrate
    from cylcontact.fitting.campaign import Campaign, campaign_of_table, read_campaign
    from cylcontact.fitting.choice import Choice
    from cylcontact.fitting.own_data import choose, fit
    from cylcontact.fitting.power_fit import PowerFit, fit_power, fit_power_to_law
    from cylcontact.fitting.report import compare
    from cylcontact.fitting.result import FitResult

__all__ = [
    "Campaign",
    "Choice",
    "FitResult",
    "PowerFit",
    "calibrate",
    "campaign_of_table",
    "choose",
    "compare",
    "fit",
    "fit_power",
    "fit_power_to_law",
    "read_campaign",
    "verdicts",
]

# Loaded on first use, so that the command line can read the names of the optimisers at once.
_MODULES = {
    "Campaign": "campaign",
    "Choice": "choice",
    "choose": "own_data",
    "FitResult": "result",
    "PowerFit": "power_fit",
    "calibrate": "calibration",
    "campaign_of_table": "campaign",
    "compare": "report",
    "fit": "own_data",
    "fit_power": "power_fit",
    "fit_power_to_law": "power_fit",
    "read_campaign": "campaign",
    "verdicts": "assessment",
}


def __getattr__(name: str) -> object:
    if name in _MODULES:
        return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
