"""Names to choose from in specs and options, in a module that imports nothing slow."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Literal, get_args

Contact = Literal["internal", "external"]
Branch = Literal["loading", "unloading"]
Beyond = Literal["stop", "tangent"]
Format = Literal["png", "pdf", "svg"]

CONTACTS: tuple[Contact, ...] = get_args(Contact)
BRANCHES: tuple[Branch, ...] = get_args(Branch)
BEYOND: tuple[Beyond, ...] = get_args(Beyond)
FORMATS: tuple[Format, ...] = get_args(Format)
# Languages of laws and of joints, with the suffix of the file.
TARGETS = {"c": ".c", "fortran": ".f90", "matlab": ".m"}
JOINT_TARGETS = {**TARGETS, "fmu": ".fmu"}
# Multibody codes with a contact of their own, whose parameters `contact_parameters` fits.
CODES = ("adams", "chrono", "drake", "mujoco", "exudyn", "simscape")
# What the folder of a fit to a table holds, and with --pdf besides.
FIT_FILES, FIT_PDF = ("result.json", "residuals.csv", "fit.png"), "fit.pdf"
# A fit in one file: all of it, or its coefficients as a table.
RESULT_SUFFIXES = (".json", ".csv", ".tex")
# What `choose` adds to it.
CHOICE_FILES = ("choice.csv", "choice.png", "choice.pdf")
PLAN_FILES = ("plan.csv", "plan.png", "plan.pdf")
# Of tables that are read, those in text first, and of those that are written.
TABLE_SUFFIXES = (".csv", ".txt", ".tsv", ".dat", ".asc", ".xlsx", ".parquet")
OUTPUT_SUFFIXES = (".csv", ".parquet")


def is_table(path: Path) -> bool:
    """Return whether a path is that of a table: whatever is no spec and no result."""
    return path.suffix.lower() not in (".toml", ".json")


def listed(names: Iterable[str], before_last: str = "or") -> str:
    """Return names as a sentence lists them."""
    *others, last = names
    return f"{', '.join(others)} {before_last} {last}" if others else last


def first_of(names: Iterable[str], most: int) -> str:
    """Return names for a message, the first ones if they are many."""
    every = list(names)
    more = f" and {len(every) - most} more" if len(every) > most else ""
    return ", ".join(every[:most]) + more
