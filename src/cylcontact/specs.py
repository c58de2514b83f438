"""Specs: TOML files checked against a model, every mistake told in one line."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import PydanticCustomError

from cylcontact.errors import InputError


class Spec(BaseModel):
    """A table of a spec file: unknown keys are refused and nothing is converted silently.

    Every field has a `description`, which is what an error offers as the remedy.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


SpecType = TypeVar("SpecType", bound=Spec)


def broken(key: str, value: object, rule: str, remedy: str) -> PydanticCustomError:
    """Return the error a validator raises, with the four parts that an InputError shows."""
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
        If the file cannot be read or is not TOML.
    """
    try:
        return tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(
            str(path), "", None, f"cannot be read ({error.strerror})", "check the path"
        ) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(
            str(path), "", None, f"is not valid TOML ({error})", "correct the line it names"
        ) from error


def parse_spec(model: type[SpecType], data: dict[str, Any], source: str) -> SpecType:
    """Check `data` against `model`.

    Parameters
    ----------
    model : type of Spec
        What the data must look like.
    data : dict
        As read from TOML or JSON.
    source : str
        What to call it in errors, usually the file.

    Returns
    -------
    Spec

    Raises
    ------
    InputError
        With the first mistake, and the number of further ones.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise _as_input_error(error, model, source) from None


def _as_input_error(error: ValidationError, model: type[Spec], source: str) -> InputError:
    """Turn pydantic's list of mistakes into one line about the first."""
    mistakes = error.errors(include_url=False)
    first = mistakes[0]
    location = [str(part) for part in first["loc"]]
    field_table = _table_at(model, location[:-1])
    more = f" ({len(mistakes) - 1} more mistakes follow)" if len(mistakes) > 1 else ""
    context = first.get("ctx", {})
    if first["type"] == "broken_rule":
        key = ".".join(part for part in (*location, context["key"]) if part)
        value, rule, remedy = context["value"], context["rule"], context["remedy"]
    else:
        key, value = ".".join(location), first["input"]
        rule, remedy = _explain(first["type"], first["msg"], field_table, location)
        value = None if first["type"] == "missing" else value
    return InputError(source, key, value, rule, remedy + more)


def _explain(
    kind: str, message: str, table: type[Spec] | None, location: list[str]
) -> tuple[str, str]:
    """Return the rule and the remedy for one of pydantic's own mistakes."""
    fields = table.model_fields if table else {}
    description = _description(table, location)
    if kind == "missing":
        return "is required", f"add {description}"
    if kind == "extra_forbidden":
        return "is not a known key", f"known keys here: {', '.join(fields)}"
    rule = message[0].lower() + message[1:]
    for python, plain in (("input should", "must"), ("a valid ", "a ")):
        rule = rule.replace(python, plain)
    return rule, f"give {description}"


def _description(table: type[Spec] | None, location: list[str]) -> str:
    """Return what a spec says of the innermost of its own fields in `location`."""
    if table is not None and location and location[-1] in table.model_fields:
        return table.model_fields[location[-1]].description or "a value that fits"
    return "a value that fits"


def _table_at(model: type[Spec], location: list[str]) -> type[Spec] | None:
    """Return the table of the spec that `location` leads to, if it is one."""
    current: type[Spec] | None = model
    for part in location:
        if current is None or part not in current.model_fields:
            continue  # a key of a mapping, or an index of a list, of tables
        current = _inner_spec(current.model_fields[part].annotation)
    return current


def _inner_spec(annotation: Any) -> type[Spec] | None:
    """Return the Spec inside an annotation such as `Axis`, `Axis | None` or `dict[str, Axis]`."""
    if isinstance(annotation, type) and issubclass(annotation, Spec):
        return annotation
    found = (_inner_spec(part) for part in getattr(annotation, "__args__", ()))
    return next((spec for spec in found if spec is not None), None)
