"""Calibration: from a campaign to the coefficients, and what they are worth."""

from cylcontact.fitting.calibrate import calibrate
from cylcontact.fitting.campaign import Campaign, campaign_of_table, read_campaign
from cylcontact.fitting.power_fit import PowerFit, fit_power, fit_power_to_law
from cylcontact.fitting.report import compare
from cylcontact.fitting.result import FitResult
from cylcontact.fitting.verdicts import verdicts

__all__ = [
    "Campaign",
    "FitResult",
    "PowerFit",
    "calibrate",
    "campaign_of_table",
    "compare",
    "fit_power",
    "fit_power_to_law",
    "read_campaign",
    "verdicts",
]


def __dir__() -> list[str]:
    return __all__
