"""Calibration: from a campaign to the coefficients, and what they are worth."""

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cylcontact.fitting.calibrate import calibrate
    from cylcontact.fitting.campaign import Campaign, read_campaign
    from cylcontact.fitting.measured_campaign import MeasuredCampaign, campaign_of_table
    from cylcontact.fitting.planning import read_plan
    from cylcontact.fitting.power_fit import PowerFit, fit_power, fit_power_to_law
    from cylcontact.fitting.report import compare
    from cylcontact.fitting.result import FitResult
    from cylcontact.fitting.verdicts import verdicts

__all__ = [
    "Campaign",
    "FitResult",
    "MeasuredCampaign",
    "PowerFit",
    "calibrate",
    "campaign_of_table",
    "compare",
    "fit_power",
    "fit_power_to_law",
    "read_campaign",
    "read_plan",
    "verdicts",
]

# Loaded on first use, so that the command line can read the names of the optimisers at once.
_MODULES = {
    "Campaign": "campaign",
    "FitResult": "result",
    "MeasuredCampaign": "measured_campaign",
    "PowerFit": "power_fit",
    "calibrate": "calibrate",
    "campaign_of_table": "measured_campaign",
    "compare": "report",
    "fit_power": "power_fit",
    "fit_power_to_law": "power_fit",
    "read_campaign": "campaign",
    "read_plan": "planning",
    "verdicts": "verdicts",
}


class _Face(ModuleType):
    """The package, in which the functions `calibrate` and `verdicts` hide their modules."""

    def __setattr__(self, name: str, value: object) -> None:
        # Python sets each submodule as an attribute when it is first imported.
        if name in _MODULES and isinstance(value, ModuleType):
            value = getattr(value, name)
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Face


def __getattr__(name: str) -> object:
    if name in _MODULES:
        return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
