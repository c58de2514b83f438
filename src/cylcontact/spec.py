"""Specs: TOML files checked against a model, with one-line errors."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Container
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from cylcontact.choices import TABLE_SUFFIXES
from cylcontact.errors import InputError
from cylcontact.reading import SPEC_BYTES, read_text

__all__ = ["Spec", "broken", "parse_spec", "parser_reason", "read_toml", "require_other_kind"]


class Spec(BaseModel):
    """A table of a spec file: unknown keys are refused, and values are not converted.

    Every field has a `description`, which errors show as the remedy.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


_SpecType = TypeVar("_SpecType", bound=Spec)

# tomllib takes minutes for a key of 200,000 parts; ours have four at most. This finds 33.
_LONG_KEY = re.compile(r"""(?<![\w-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){32}""")

# Key sets that identify each kind of file, tested in order.
_KINDS = (
    ("a fit result", {"coefficients"}),
    ("a fit result", {"settings"}),
    ("a mechanism", {"bodies", "joint"}),
    ("a mechanism", {"bodies", "joints"}),
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
# Python reads hexadecimal numbers of any length, and cannot print them.
_LONG_NUMBER = re.compile(r"(?<!\w)[0-9]\w{1000}")
_TOO_MANY_DIGITS = "a number has too many digits"


def broken(key: str, value: object, rule: str, remedy: str) -> PydanticCustomError:
    """Return the error for a validator to raise, with four parts of an `InputError`."""
    return PydanticCustomError(
        "broken_rule",
        "{rule}",
        {"key": key, "value": value, "rule": rule, "remedy": remedy},
    )


def read_toml(path: Path | str) -> dict[str, Any]:
    """Read a TOML file.

    Raises
    ------
    InputError
        If the file cannot be read, is too large or is not TOML.
    """
    text = read_text(path, SPEC_BYTES, "give a TOML file in UTF-8")
    if _LONG_KEY.search(text):
        rule = "has a key of more than 32 parts"
        raise InputError(str(path), "", None, rule, "no spec needs more than four")
    try:
        if _LONG_NUMBER.search(text):
            raise ValueError(_TOO_MANY_DIGITS)
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        require_other_kind(path, text, "a TOML spec")
        reason = parser_reason(error)
        raise InputError(
            str(path), "", None, f"is not valid TOML ({reason})", "correct the line it names"
        ) from error


def parser_reason(error: Exception) -> str:
    """Return why a parser refuses a text, without advice on Python.

    Examples
    --------
    >>> parser_reason(RecursionError("maximum recursion depth exceeded"))
    'it is nested too deeply'
    """
    if isinstance(error, RecursionError):
        return "it is nested too deeply"
    return _TOO_MANY_DIGITS if "set_int_max_str" in str(error) else str(error)


def _kind_of(keys: Container[str]) -> str:
    """Return the kind of a file from its top-level keys; empty if unknown.

    Examples
    --------
    >>> _kind_of({"contact": "internal", "reference": "johnson", "axes": {}})
    'a grid spec'
    """
    return next((kind for kind, marks in _KINDS if all(key in keys for key in marks)), "")


def require_other_kind(path: Path | str, text: str, wanted: str) -> None:
    """Raise `InputError` for a text of a known kind that is not `wanted`; ignore other texts.

    Raises
    ------
    InputError
        If the file is a table, or TOML or JSON of a known kind.
    """
    if Path(path).suffix.lower() in TABLE_SUFFIXES:
        raise _other_kind(str(path), "a table", wanted)
    for parse in (tomllib.loads, json.loads):
        try:
            data = parse(text)
        except (ValueError, RecursionError):
            continue
        kind = _kind_of(data) if isinstance(data, dict) else ""
        if kind:
            raise _other_kind(str(path), kind, wanted)


def _other_kind(source: str, kind: str, wanted: str) -> InputError:
    """Return the error for a file of another kind."""
    return InputError(source, "", None, f"is {kind}, not {wanted}", f"name {wanted}")


def parse_spec(model: type[_SpecType], data: dict[str, Any], source: str) -> _SpecType:
    """Check `data` against `model`.

    Parameters
    ----------
    model : type of Spec
        The model of the data.
    data : dict
        As read from TOML or JSON.
    source : str
        Its name in errors, usually the file.

    Returns
    -------
    Spec

    Raises
    ------
    InputError
        With the first mistake and the number of further ones. Unknown keys come first, because
        a misspelt key is often the reason why another is missing.
    """
    try:
        return _validated(model, data, source)
    except UnicodeEncodeError as error:  # pydantic cannot take it, nor tell of it
        rule = f"holds a character that is not text ({error.object[error.start]!a})"
        raise InputError(source, "", None, rule, "remove it") from None


def _validated(model: type[_SpecType], data: dict[str, Any], source: str) -> _SpecType:
    """Return the spec that data hold; raise `InputError` with the first mistake."""
    try:
        return model.model_validate(data)
    except ValidationError as error:
        kind = _kind_of(data) if isinstance(data, dict) else ""
        wanted = _kind_of(model.model_fields)
        if kind and wanted and kind != wanted:
            raise _other_kind(source, kind, wanted) from None
        raise _as_input_error(error, model, data, source) from None


def _as_input_error(
    error: ValidationError, model: type[Spec], data: Any, source: str
) -> InputError:
    """Return pydantic's list of mistakes as one line about the first."""
    mistakes = error.errors(include_url=False)
    first = min(mistakes, key=lambda mistake: mistake["type"] != "extra_forbidden")
    location = _place(first, data)
    # A value that may be of several types has a mistake for each.
    further = len({tuple(_place(mistake, data)) for mistake in mistakes}) - 1
    more = f" ({further} more {'mistakes' if further > 1 else 'mistake'})" if further else ""
    context = first.get("ctx", {})
    if first["type"] == "broken_rule":
        key = ".".join(part for part in (*location, context["key"]) if part)
        value, rule, remedy = context["value"], context["rule"], context["remedy"]
    else:
        key, value = ".".join(location), first["input"]
        rule, remedy = _explain(first["type"], first["msg"], model, location)
        value = None if first["type"] == "missing" else value
    return InputError(source, key, value, rule, remedy + more)


def _place(mistake: ErrorDetails, data: Any) -> list[str]:
    """Return where a mistake is in the data, without pydantic's names of the types tried there.

    Examples
    --------
    >>> mistake = {"type": "float_type", "loc": ("constants", "nu", "float")}
    >>> _place(mistake, {"constants": {"nu": [1]}})
    ['constants', 'nu']
    """
    place = []
    for part in mistake["loc"]:
        if isinstance(part, int) and isinstance(data, list | tuple):
            data = data[part] if part < len(data) else None
        elif isinstance(data, dict) and part in data:
            data = data[part]
        elif mistake["type"] != "missing" or part != mistake["loc"][-1]:
            continue
        place.append(str(part))
    return place


def _explain(kind: str, message: str, model: type[Spec], location: list[str]) -> tuple[str, str]:
    """Return the rule and the remedy for one of pydantic's own mistakes."""
    table, description = _innermost(model, location)
    if kind == "missing":
        return "is required", f"add {description}"
    if kind == "extra_forbidden":
        return "is not a known key", f"known keys here: {', '.join(table.model_fields)}"
    rule = message[0].lower() + message[1:].replace("greater than or equal to", "at least")
    return _PLAIN_RULES.get(kind, rule.replace("input should", "must")), f"give {description}"


def _innermost(model: type[Spec], location: list[str]) -> tuple[type[Spec], str]:
    """Return the innermost table at `location`, and the description of the key."""
    table, description = model, "a value that fits"
    for part in location:
        if part in table.model_fields:  # else a key of a mapping, or an index of a list
            field = table.model_fields[part]
            description = field.description or description
            table = _inner_spec(field.annotation) or Spec  # a plain mapping has keys of its own
    return table, description


def _inner_spec(annotation: Any) -> type[Spec] | None:
    """Return the Spec inside an annotation such as `Axis`, `Axis | None` or `dict[str, Axis]`."""
    if isinstance(annotation, type) and issubclass(annotation, Spec):
        return annotation
    inner = (_inner_spec(part) for part in getattr(annotation, "__args__", ()))
    return next((spec for spec in inner if spec is not None), None)
