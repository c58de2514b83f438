"""The provenance of each number in a spec: paper, derived, assumed or chosen."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from cylcontact.spec import broken

__all__ = ["PROVENANCES", "assumptions", "check_provenance"]

# "chosen" marks a value that a command or a caller has set.
PROVENANCES = ("paper", "derived", "assumed", "chosen")


def _leaves(data: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the dotted key and value of every entry in nested tables.

    Examples
    --------
    >>> list(_leaves({"rod": {"mass": 0.2, "name": "a", "centre": [1.0, 2.0]}}))
    [('rod.mass', 0.2), ('rod.name', 'a'), ('rod.centre', [1.0, 2.0])]
    """
    for key, value in data.items():
        if isinstance(value, Mapping):
            yield from _leaves(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def _numbers(data: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield the dotted key and value of every number, or list of numbers, in nested tables.

    Examples
    --------
    >>> list(_numbers({"rod": {"mass": 0.2, "name": "a", "centre": [1.0, 2.0]}}))
    [('rod.mass', 0.2), ('rod.centre', [1.0, 2.0])]
    """
    for key, value in _leaves(data):
        several = isinstance(value, list | tuple) and len(value) > 0
        # Young's modulus may be a text with its unit.
        one = _is_number(value) or key == "clearance.E"
        if one or (several and all(map(_is_number, value))):
            yield key, value


def assumptions(data: Mapping[str, Any]) -> tuple[str, ...]:
    """Return "key = value" for every assumed value of a spec.

    Numbers inherit the provenance of their table; other values must be listed themselves.

    Examples
    --------
    >>> assumptions({"rod": {"mass": 0.2}, "provenance": {"assumed": ["rod"]}})
    ('rod.mass = 0.2',)
    """
    table = data["provenance"]
    entries = dict(_numbers(data))
    entries |= {k: v for k, v in _leaves(data) if k in table.get("assumed", ())}
    return tuple(
        f"{key} = {value}"
        for key, value in entries.items()
        if _provenance_of(key, table) == "assumed"
    )


def _provenance_of(key: str, table: Mapping[str, Any]) -> str | None:
    """Return the provenance of a key: that of the longest key in `table` that is a prefix of it.

    Examples
    --------
    >>> table = {"paper": ["clearance"], "derived": [], "assumed": ["clearance.v0"]}
    >>> _provenance_of("clearance.v0", table), _provenance_of("clearance.E", table)
    ('assumed', 'paper')
    """
    fitting = [
        (len(covering), kind)
        for kind in PROVENANCES
        for covering in table.get(kind, ())
        if key == covering or key.startswith(f"{covering}.")
    ]
    return max(fitting)[1] if fitting else None


def check_provenance(data: Mapping[str, Any]) -> None:
    """Raise an error for a number without provenance, or a provenance without a value."""
    table = data["provenance"]
    keys = [key for key, _ in _numbers(data)]
    texts = dict(_leaves(data))
    listed = [str(key) for kind in PROVENANCES for key in table.get(kind, ())]
    for key in keys:
        if _provenance_of(key, table) is None:
            raise broken(
                "provenance", key, "has no provenance", "list it under paper, derived or assumed"
            )
    for key in listed:
        if listed.count(key) > 1:
            raise broken("provenance", key, "is listed twice", "keep one of them")
        covered = any(number == key or number.startswith(f"{key}.") for number in keys)
        if not covered and key not in texts:
            raise broken("provenance", key, "covers nothing in the file", "correct or remove it")


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
