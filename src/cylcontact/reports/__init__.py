"""Reports: figures with their numbers, claims, an HTML page, and the check of a joint."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from cylcontact.support.errors import refuse_gone_name

if TYPE_CHECKING:
    from cylcontact.reports.claims import Claim, claim, claims_of
    from cylcontact.reports.figures import draw, write_figures
    from cylcontact.reports.joint_check import JointCheck, check_joint
    from cylcontact.reports.notebook import live_progress
    from cylcontact.reports.page import write_page

# Loaded on first use: a command that checks a joint needs neither pandas nor figures.
_IN = {
    "Claim": "claims",
    "JointCheck": "joint_check",
    "check_joint": "joint_check",
    "claim": "claims",
    "claims_of": "claims",
    "draw": "figures",
    "live_progress": "notebook",
    "write_figures": "figures",
    "write_page": "page",
}
__all__ = [
    "Claim",
    "JointCheck",
    "check_joint",
    "claim",
    "claims_of",
    "draw",
    "live_progress",
    "write_figures",
    "write_page",
]
# Names of 1.0.0rc1 that are gone, with what to use instead. Kept for one release.
_GONE = {
    "Bench": "draw a figure with draw, and read files with pandas or fitting.LawFit.read",
    "bench": "write a figure or a claim as a plain function, as in reports/paper.py",
    "build": "use write_figures",
    "explore": "open the notebook 3_explore",
    "laws_table": "use check_joint, or cylcontact laws --all --json",
    "manuscript": "draw figures with write_figures and include their PDF in a text of yours",
}


def __getattr__(name: str) -> Any:
    refuse_gone_name(__name__, name, _GONE)
    if name in _IN:
        return getattr(import_module(f"cylcontact.reports.{_IN[name]}"), name)
    raise AttributeError(f"module 'cylcontact.reports' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
