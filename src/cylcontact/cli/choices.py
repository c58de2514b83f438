"""What options choose from, in their help.

Importing the package's own lists would make every `--help` slow, so they stand here once more; a
test holds each against the package. The value itself is checked where it is used, with an error
that names what there is: `unchecked` only passes it on.
"""

from __future__ import annotations

from typing import Literal, get_args

Method = Literal["minimal", "multiplier"]
Beyond = Literal["stop", "tangent"]


METHODS: tuple[Method, ...] = get_args(Method)
BEYOND: tuple[Beyond, ...] = get_args(Beyond)
ENGINES = ("embedded", "calculix")
CONTACTS = ("internal", "external")
OPTIMIZERS = ("genetic", "differential-evolution", "least-squares", "cma")
LOSSES = ("linear", "soft_l1", "huber", "cauchy")
STYLES = ("journal", "single-column", "double-column", "slides")
FORMATS = ("png", "pdf", "svg", "pgf")
TABLES = ("latex", "csv", "html")
TARGETS = ("c", "fortran", "matlab", "json")


def listed(names: tuple[str, ...]) -> str:
    """Return choices as a sentence names them.

    Examples
    --------
    >>> listed(CONTACTS), listed(TARGETS)
    ('internal or external', 'c, fortran, matlab or json')
    """
    return f"{', '.join(names[:-1])} or {names[-1]}"


def unchecked(text: str) -> str:
    """Return a choice as it was typed."""
    return text
