"""What a folder reports: figures with their numbers, claims, and a page of both."""

from cylcontact.reports.claims import Claim, claim, claims_of
from cylcontact.reports.figures import draw, write_figures
from cylcontact.reports.notebook import live_progress
from cylcontact.reports.page import write_page

__all__ = [
    "Claim",
    "claim",
    "claims_of",
    "draw",
    "live_progress",
    "write_figures",
    "write_page",
]


def __dir__() -> list[str]:
    return __all__
