"""A small grid and campaign, changed in one place and written as TOML, for tests of bad input."""

import copy
import json
from datetime import date
from pathlib import Path
from typing import Any

import pytest

from cylcontact import InputError


class Drop:
    """Says that a key is left out; its text is the same in every process that names tests."""

    def __repr__(self) -> str:
        return "left out"


DROP = Drop()

GRID = {
    "contact": "internal",
    "reference": "johnson",
    "axes": {
        "E": {"min": 69, "max": 600.0, "points": 3, "spacing": "log"},
        "nu": {"values": [0.25, 0.3]},
        "dR": {"min": 0.05, "max": 5, "points": 4, "spacing": "log"},
        "load": {"min": 10, "max": 1000, "points": 4, "spacing": "linear"},
    },
}
CAMPAIGN = {
    "dataset": "datasets/small.toml",
    "law": "power",
    "objective": "rms-log-penetration",
    "seed": 7,
    "bounds": {"K_star": [0.5, 10], "n": [1, 1.5]},
    "genetic": {"runs": 3, "population": 8, "generations": 5},
}

ELEMENTS = {
    "hole_radius": 2.245,
    "outer_ratio": 3.3,
    "E": 207.0,
    "nu": 0.3,
    "cells": 6,
    "dR": [0.05, 0.5],
    "load": [20.0, 40.0],
    "origin": dict.fromkeys(("outer_ratio", "cells", "dR", "load"), "assumed")
    | dict.fromkeys(("hole_radius", "E", "nu"), "paper"),
}


def labels(cases: list[tuple[Any, ...]]) -> list[str]:
    """Return a name for each case, from the changes to a spec that it begins with."""
    return [
        ", ".join(f"{key}={value if value is not DROP else ''}" for key, value in case[0].items())
        for case in cases
    ]


def golden(name: str) -> Any:
    """Return the numbers that a file in tests/golden holds."""
    return json.loads(
        (Path(__file__).parents[1] / f"golden/{name}.json").read_text(encoding="utf-8")
    )


def changed(spec: dict[str, Any], changes: dict[str, Any]) -> dict[str, Any]:
    """Return a copy of a spec with values set by dotted key, or dropped.

    An entry of a list goes by its name.
    """
    result = copy.deepcopy(spec)
    for key, value in changes.items():
        *tables, last = key.split(".")
        table = result
        for name in tables:
            table = _entry(table, name) if isinstance(table, list) else table.setdefault(name, {})
        if isinstance(table, list):
            last = table.index(_entry(table, last))
        if value is DROP:
            del table[last]
        else:
            table[last] = copy.deepcopy(value)
    return result


def _entry(table: list[dict[str, Any]], name: str) -> dict[str, Any]:
    return next(entry for entry in table if entry["name"] == name)


def toml(value: Any) -> str:
    """Return a value as TOML, tables inline."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(k)} = {toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, bool | str):
        return json.dumps(value)
    return value.isoformat() if isinstance(value, date) else repr(value)


def write_toml(path: Path, spec: dict[str, Any]) -> Path:
    """Write a spec, making its folder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = [f"{key} = {toml(value)}" for key, value in spec.items()]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def write_bench(root: Path, campaign: dict[str, Any] | None = None) -> Path:
    """Write datasets/small.toml and fitting/small.toml; return the campaign's path."""
    write_toml(root / "datasets/small.toml", GRID)
    return write_toml(root / "fitting/small.toml", changed(CAMPAIGN, campaign or {}))


def tree(root: Path) -> dict[str, bytes | None]:
    """Return every file below a folder with its contents, and every folder, hidden ones too."""
    return {
        str(path.relative_to(root)): path.read_bytes() if path.is_file() else None
        for path in root.rglob("*")
    }


def assert_told(
    caught: pytest.ExceptionInfo[InputError],
    source: object,
    key: str,
    value: Any,
    rule: str,
    remedy: str,
) -> None:
    """Check an error's five parts, rule and remedy by a fragment, and that it is one line."""
    error = caught.value
    assert error.source == str(source)
    assert error.key == key
    if value is not DROP:
        assert repr(error.value) == repr(value)
    assert rule in error.rule
    assert remedy in error.remedy
    message = str(error)
    assert len(message.splitlines()) == 1
    for part in (error.source, error.key, error.rule, error.remedy):
        assert "".join(c if c.isprintable() else repr(c)[1:-1] for c in part) in message
