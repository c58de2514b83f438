"""Specs: TOML files checked against a model, with one-line errors."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Container
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from cylcontact.files.reading import read_spec
from cylcontact.support.choices import TABLE_SUFFIXES
from cylcontact.support.errors import InputError


class Spec(BaseModel):
    """A table of a spec file: unknown keys are refused, and values are not converted.

    Every field has a `description`, which errors show as the remedy.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


_SpecType = TypeVar("_SpecType", bound=Spec)

# Key sets that identify each kind of file, tested in order.
_KINDS = (
    ("a fit result", {"settings"}),
    ("a mechanism", {"crank", "rod"}),
    ("a mechanism", {"bodies"}),
    ("a joint", {"bearing", "pin"}),
    ("a finite-element set-up", {"hole_radius", "load_on"}),
    ("a campaign", {"dataset", "law"}),
    ("a campaign", {"data", "law"}),
    ("a grid spec", {"contact", "reference"}),
)

# Pydantic's type rules in the terms of TOML and JSON.
_PLAIN_RULES = {
    "model_type": "must be a table",
    "dict_type": "must be a table",
    "tuple_type": "must be a list",
    "list_type": "must be a list",
    "int_type": "must be an integer",
    "float_type": "must be a number",
    "finite_number": "must be a finite number",
    "bool_type": "must be true or false",
    "string_type": "must be a string",
}


def broken(key: str, value: object, rule: str, remedy: str) -> PydanticCustomError:
    """Return the error for a validator to raise, with four parts of an `InputError`."""
    parts = {"key": key, "value": value, "rule": rule, "remedy": remedy}
    return PydanticCustomError("broken_rule", "{rule}", parts)


def read_toml(path: Path | str) -> dict[str, Any]:
    """Read a TOML file."""
    text = read_spec(path, "give a TOML file in UTF-8")
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        require_other_kind(path, text, "a TOML spec")
        rule, remedy = f"is not valid TOML ({error})", "correct the line it names"
        raise InputError(str(path), "", None, rule, remedy) from error


def _kind_of(keys: Container[str]) -> str:
    """Return the kind of a file from its top-level keys; empty if unknown."""
    return next((kind for kind, marks in _KINDS if all(key in keys for key in marks)), "")


def require_other_kind(path: Path | str, text: str, wanted: str) -> None:
    """Raise `InputError` for a text of a known kind that is not `wanted`; ignore other texts."""
    if Path(path).suffix.lower() in TABLE_SUFFIXES:
        raise _other_kind(str(path), "a table", wanted)
    for parse in (tomllib.loads, json.loads):
        try:
            data = parse(text)
        except (ValueError, RecursionError):
            continue
        if isinstance(data, dict) and (kind := _kind_of(data)):
            raise _other_kind(str(path), kind, wanted)


def _other_kind(source: str, kind: str, wanted: str) -> InputError:
    """Return the error for a file of another kind."""
    return InputError(source, "", None, f"is {kind}, not {wanted}", f"name {wanted}")


def parse_spec(model: type[_SpecType], data: dict[str, Any], source: str) -> _SpecType:
    """Return `data` as a `model`; raise `InputError` with the first mistake in it.

    `source` is its name in the error, usually the file. Unknown keys come first, because a
    misspelt key is often the reason why another is missing.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        kind = _kind_of(data) if isinstance(data, dict) else ""
        wanted = _kind_of(model.model_fields)
        if kind and wanted and kind != wanted:
            raise _other_kind(source, kind, wanted) from None
        mistakes = error.errors(include_url=False)
    first = min(mistakes, key=lambda mistake: mistake["type"] != "extra_forbidden")
    location = _location(first, data)
    # A value that may be of several types has a mistake for each.
    further = len({tuple(_location(mistake, data)) for mistake in mistakes}) - 1
    more = f" ({further} more {'mistakes' if further > 1 else 'mistake'})" if further else ""
    if first["type"] == "broken_rule":
        parts = first["ctx"]
        location += [parts["key"]] if parts["key"] else []
        value, rule, remedy = parts["value"], parts["rule"], parts["remedy"]
    else:
        value = None if first["type"] == "missing" else first["input"]
        rule, remedy = _explain(first["type"], first["msg"], model, location)
    raise InputError(source, ".".join(location), value, rule, remedy + more)


def _location(mistake: ErrorDetails, data: Any) -> list[str]:
    """Return the keys of a mistake in the data, without pydantic's names of the types tried there.

    Examples
    --------
    >>> mistake = {"type": "float_type", "loc": ("constants", "nu", "float")}
    >>> _location(mistake, {"constants": {"nu": [1]}})
    ['constants', 'nu']
    """
    keys = []
    for part in mistake["loc"]:
        if isinstance(part, int) and isinstance(data, list | tuple):
            data = data[part] if part < len(data) else None
        elif isinstance(data, dict) and part in data:
            data = data[part]
        elif mistake["type"] != "missing" or part != mistake["loc"][-1]:
            continue
        keys.append(str(part))
    return keys


def _explain(kind: str, message: str, model: type[Spec], location: list[str]) -> tuple[str, str]:
    """Return the rule and the remedy for one of pydantic's own mistakes."""
    table, description = model, "a value that fits"
    for part in location:
        if part in table.model_fields:  # else a key of a mapping, or an index of a list
            field = table.model_fields[part]
            description = field.description or description
            table = _inner_spec(field.annotation) or Spec  # a plain mapping has keys of its own
    if kind == "missing":
        return "is required", f"add {description}"
    if kind == "extra_forbidden":
        return "is not a known key", f"known keys here: {', '.join(table.model_fields)}"
    rule = message[0].lower() + message[1:].replace("greater than or equal to", "at least")
    return _PLAIN_RULES.get(kind, rule.replace("input should", "must")), f"give {description}"


def _inner_spec(annotation: Any) -> type[Spec] | None:
    """Return the Spec inside an annotation such as `Axis`, `Axis | None` or `dict[str, Axis]`."""
    if isinstance(annotation, type) and issubclass(annotation, Spec):
        return annotation
    inner = (_inner_spec(part) for part in getattr(annotation, "__args__", ()))
    return next((spec for spec in inner if spec is not None), None)
