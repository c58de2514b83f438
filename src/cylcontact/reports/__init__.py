"""What a bench reports: figures with their numbers, a ledger of claims, tables, pages."""

from importlib import import_module
from types import ModuleType

from cylcontact.reports.bench import Bench

__all__ = [
    "Bench",
    "bench",
    "build",
    "claims",
    "claims_text",
    "explore",
    "fit_figures",
    "laws_bounds",
    "laws_table",
    "manuscript",
    "notebook",
    "paper",
]


def __getattr__(name: str) -> ModuleType:
    if name in __all__:
        return import_module(f"cylcontact.reports.{name}")
    raise AttributeError(f"module 'cylcontact.reports' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
