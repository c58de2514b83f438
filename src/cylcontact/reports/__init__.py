"""Reports: figures with their numbers, the claims of the paper, and an HTML page."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cylcontact.reports.claims import Claim, claim, claims_of
    from cylcontact.reports.figures import draw, write_figures
    from cylcontact.reports.notebook import live_progress
    from cylcontact.reports.page import write_page

# Loaded on first use: a command that checks a joint needs neither pandas nor figures.
_IN = {
    "Claim": "claims",
    "claim": "claims",
    "claims_of": "claims",
    "draw": "figures",
    "live_progress": "notebook",
    "write_figures": "figures",
    "write_page": "page",
}
__all__ = [
    "Claim",
    "claim",
    "claims_of",
    "draw",
    "live_progress",
    "write_figures",
    "write_page",
]


def __getattr__(name: str) -> Any:
    if name in _IN:
        return getattr(import_module(f"cylcontact.reports.{_IN[name]}"), name)
    raise AttributeError(f"module 'cylcontact.reports' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
