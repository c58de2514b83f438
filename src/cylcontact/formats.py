"""The version of the files that are read again, under `format` in each."""

from __future__ import annotations

from typing import Any

from cylcontact.errors import InputError

FORMAT = 1


def marked(contents: dict[str, Any]) -> dict[str, Any]:
    """Return the contents of a file with the version, which comes first."""
    return {"format": FORMAT, **contents}


def unmarked(contents: dict[str, Any], source: str) -> dict[str, Any]:
    """Return the contents of a file without the version; refuse another version.

    Examples
    --------
    >>> unmarked({"format": 2}, "result.json")
    Traceback (most recent call last):
    ...
    cylcontact.errors.InputError: result.json: format = 2: is not the version 1 that this ...
    """
    version = contents.get("format", FORMAT)
    if version != FORMAT:
        rule = f"is not the version {FORMAT} that this cylcontact reads"
        remedy = "read it with the cylcontact that wrote it, or make it anew"
        raise InputError(source, "format", version, rule, remedy)
    return {key: value for key, value in contents.items() if key != "format"}
