"""What the bench reports: figures with their numbers, and the ledger of the paper's claims."""

from importlib import import_module
from types import ModuleType

__all__ = [
    "bench",
    "build",
    "claims",
    "explore",
    "laws_bounds",
    "laws_table",
    "notebook",
    "profiles",
    "runs",
]


def __getattr__(name: str) -> ModuleType:
    if name in __all__:
        return import_module(f"cylcontact.reports.{name}")
    raise AttributeError(f"module 'cylcontact.reports' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
