"""Calibration: from a campaign to the coefficients, and what they are worth."""

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


def __dir__() -> list[str]:
    return __all__
