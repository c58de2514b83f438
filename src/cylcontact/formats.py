"""Versions of the files that are read again, and what makes older files like those of today.

A file says its version under `format`. A file without it is of version 0, from before there were
versions. To change what a kind of file holds, raise its number here, add to `_UPGRADES` what makes
an older file like a new one, and keep the older file that tests/formats stores.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cylcontact.errors import InputError

__all__ = ["FORMATS", "marked", "upgraded"]

_Contents = dict[str, Any]

# The version of each kind of file that is written today. The first five are read again, the others
# are for other programs.
FORMATS = {
    "fit result": 1,
    "trajectory": 1,
    "table of finite elements": 1,
    "journal": 1,
    "benchmarks": 1,
    "uncertainty": 1,
    "law": 1,
    "claims": 1,
}


def marked(kind: str, contents: _Contents) -> _Contents:
    """Return the contents of a file of today with its version, which comes first.

    Parameters
    ----------
    kind : str
        One of `FORMATS`.
    contents : dict
        What the file holds.

    Returns
    -------
    dict

    Examples
    --------
    >>> marked("law", {"function": "liu_internal"})
    {'format': 1, 'function': 'liu_internal'}
    """
    return {"format": FORMATS[kind], **contents}


def upgraded(kind: str, contents: _Contents, source: str) -> _Contents:
    """Return the contents of a file of any version as a file of today holds them.

    Parameters
    ----------
    kind : str
        One of `FORMATS`.
    contents : dict
        As read; unchanged.
    source : str
        The file.

    Returns
    -------
    dict
        Without the version.

    Raises
    ------
    InputError
        If the version is newer than that of today, or no version.

    Examples
    --------
    >>> upgraded("law", {"function": "liu_internal"}, "law.json")
    {'function': 'liu_internal'}
    >>> upgraded("law", {"format": 2}, "law.json")
    Traceback (most recent call last):
    ...
    cylcontact.errors.InputError: law.json: format = 2: is newer than this version of cylcontact ...
    """
    today = FORMATS[kind]
    version = contents.get("format", 0)
    if type(version) is not int or version < 0:
        remedy = "restore the file, or make it anew"
        raise InputError(source, "format", version, "must be a whole number", remedy)
    if version > today:
        rule = f"is newer than this version of cylcontact reads ({today})"
        remedy = "upgrade cylcontact: pip install -U cylcontact"
        raise InputError(source, "format", version, rule, remedy)
    contents = {key: value for key, value in contents.items() if key != "format"}
    for older in range(version, today):
        upgrade = _UPGRADES.get((kind, older))
        contents = upgrade(contents) if upgrade else contents
    return contents


def _with_searched_coefficients(result: _Contents) -> _Contents:
    """Return a fit result whose runs say that the search's own coefficients are not known.

    Those of version 0 have them from 22 November 2026 on.
    """
    runs, unknown = result.get("runs"), {"coefficients_before_polish": None}
    if not (isinstance(runs, list) and all(isinstance(run, dict) for run in runs)):
        return result  # whoever reads it says what is wrong
    return {**result, "runs": [{**unknown, **run} for run in runs]}


# What makes a file of a kind and version one of the next, where what it holds has changed.
_UPGRADES: dict[tuple[str, int], Callable[[_Contents], _Contents]] = {
    ("fit result", 0): _with_searched_coefficients,
}
