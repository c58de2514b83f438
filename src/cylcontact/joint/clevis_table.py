"""Tables of clevises: one row a clevis, its columns named as the tables of a clevis' file."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.files.numbers import quantity
from cylcontact.files.sheet import Sheet
from cylcontact.files.units import FORCES, LENGTHS, load_in_N_per_mm, unit_after
from cylcontact.joint.bush_words import size_words
from cylcontact.joint.clevis import check_clevis, flat
from cylcontact.joint.clevis_beam import Clevis, Plate
from cylcontact.joint.words import LABELS, housing_from_words, material_from_words
from cylcontact.support.errors import InputError, require
from cylcontact.support.parallel import call, run_calls
from cylcontact.support.progress import Progress

if TYPE_CHECKING:
    import pandas as pd

_PLATES = ("eye", "cheek")
_LENGTHS = ("gap", "beyond", *(f"{plate}_{key}" for plate in _PLATES for key in
                               ("thickness", "R_o")))  # fmt: skip
_NUMBERS: Mapping[str, Mapping[str, float]] = {
    "load": FORCES,
    **dict.fromkeys(_LENGTHS, LENGTHS),
}
_SIZES = ("pin_diameter", "eye_hole", "cheek_hole")
_WORDS = ("pin", *_PLATES, *(f"{p}_{key}" for p in _PLATES for key in ("clamp", "layer")))
KNOWN = (*_NUMBERS, *_SIZES, *_WORDS)
_NEEDED = ("load", "gap", "pin", *_SIZES, *_PLATES, "eye_thickness", "cheek_thickness")
# From so many rows on they are answered in processes.
_MANY = 8


def are_clevises(names: Sequence[object]) -> bool:
    """Return whether columns are those of clevises."""
    return any(str(name).strip().lower().startswith(_PLATES) for name in names)


def answers(
    sheet: Sheet, same: Mapping[str, Any], own: Path | None, progress: Progress
) -> pd.DataFrame:
    """Return a table of clevises with its answers: those of the middle, and the worst of the pin.

    The answers are those of `ClevisNumbers`, `needed_moment_Nmm` and `lowest_pin_factor` of the
    band, and `error`, why a row has no answer.
    """
    import pandas as pd

    rows = _rows(sheet, same)
    calls = [call(_answered, row, own) for row in rows]
    workers = (os.cpu_count() or 1) if len(rows) >= _MANY else 1
    found: list[dict[str, Any]] = []
    with closing(run_calls(calls, workers)) as results:
        for answer in results:
            found.append(answer)
            progress("clevises", len(found), len(rows))
    names = dict.fromkeys(key for answer in found for key in answer if key != "error")
    frame = pd.DataFrame(dict(zip(sheet.names, sheet.columns, strict=True))).infer_objects()
    for name, cells in frame.items():
        numbers = pd.to_numeric(cells, errors="coerce")
        if _which(str(name)) in _NUMBERS and (numbers.notna() == cells.notna()).all():
            frame[name] = numbers
    for name in names:
        frame[name] = [answer.get(name, np.nan) for answer in found]
    frame["error"] = [answer.get("error", "") for answer in found]
    return frame


def _which(name: str) -> str | None:
    """Return what a column is, None if it is not known."""
    plain = name.strip().replace(" ", "_")
    for known in (*_WORDS, *_SIZES):
        if plain.lower() in (known.lower(), f"{known}_mm".lower() if known in _SIZES else ""):
            return known
    for known, units in _NUMBERS.items():
        if unit_after(name, known, units) is not None:
            return known
    return None


def _rows(sheet: Sheet, same: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the values of each row by their names, or its error."""
    columns = {_which(name): k for k, name in enumerate(sheet.names)}
    unknown = [n for n in sheet.names if _which(n) is None and n.lower() not in LABELS]
    rule = f"{', '.join(unknown)} is not known in a table of clevises"
    remedy = f"name columns {', '.join(KNOWN)}, with a unit as in load_kN, gap_mm"
    require(not unknown, sheet.source, "columns", None, rule, remedy)
    for name in same:
        rule = "is a column of the table" if name in columns else "is not of a clevis"
        known = name in KNOWN and name not in columns
        require(known, sheet.source, name, None, rule, "leave the option out")
    missing = [name for name in _NEEDED if name not in columns and name not in same]
    rule = f"lacks {', '.join(missing)}"
    require(not missing, sheet.source, "columns", None, rule, "add it, as in datasets/clevis.toml")
    wrong: dict[int, InputError] = {}
    numbers = {}
    for name, units in _NUMBERS.items():
        if (values := quantity(sheet, name, units, wrong=wrong)) is not None:
            numbers[name] = values
    rows: list[dict[str, Any]] = []
    for row in range(len(sheet.lines)):
        if row in wrong:
            error = wrong[row]
            rows.append({"error": f"{error.key} = {error.value!r}: {error.rule}; {error.remedy}"})
            continue
        given = dict(same)
        given |= {name: float(v[row]) for name, v in numbers.items() if not np.isnan(v[row])}
        for name in (*_SIZES, *_WORDS):
            text = str(sheet.columns[columns[name]][row] or "").strip() if name in columns else ""
            if text and text != "nan":
                given[name] = text
        rows.append(given)
    return rows


def _answered(row: Mapping[str, Any], own: Path | None) -> dict[str, Any]:
    """Return the answer of one row, or why it has none."""
    if "error" in row:
        return dict(row)
    try:
        check = check_clevis(*clevis_from_words(row, own))
    except InputError as error:
        return {"error": str(error)}
    numbers = flat(check.band.get("middle") or check.band["joint"])
    return numbers | {"needed_moment_Nmm": check.needed_moment, "lowest_pin_factor": check.factor}


def clevis_from_words(given: Mapping[str, Any], own: Path | None) -> tuple[Clevis, float]:
    """Return the clevis that values by their names give, and its force in N."""
    for name in _NEEDED:
        require(name in given, "", name, None, "is missing", "give it in this row")
    plates = {}
    for name in _PLATES:
        parts = {key: given[f"{name}_{key}"] for key in ("R_o", "clamp", "layer")
                 if f"{name}_{key}" in given}  # fmt: skip
        if ";" in str(parts.get("layer", "")):
            parts["layer"] = [part.strip() for part in parts["layer"].split(";")]
        housing = housing_from_words(parts, "", partial("{}_{}".format, name), own)
        material = material_from_words(given[name], "", name, own)
        hole = _size(given, f"{name}_hole")
        plates[name] = Plate(given[f"{name}_thickness"], material, hole, housing)
    pin, load = material_from_words(given["pin"], "", "pin", own), given["load"]
    force = load_in_N_per_mm(load, 1.0) if isinstance(load, str) else load
    clevis = Clevis(pin, _size(given, "pin_diameter"), **plates, gap=given["gap"],
                    beyond=given.get("beyond", 0.0))  # fmt: skip
    return clevis, force


def _size(given: Mapping[str, Any], name: str) -> Any:
    """Return a size of a row: mm, limits or a class."""
    try:
        return size_words(str(given[name]))
    except ValueError:
        rule, remedy = "is no size", "give mm, limits as 20.02:20.05, or a class such as 20H8"
        raise InputError("", name, given[name], rule, remedy) from None
