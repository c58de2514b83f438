"""Tables of joints: one row a joint, its columns named as the options of `cylcontact check`.

Rows without housing, fit or temperature are answered at once as arrays. Every other row is a joint
of its own; many of them are answered in processes, those of one housing after each other, since
joints in housings of one shape share what takes time. A row that cannot be answered says why.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from cylcontact.bodies.material import Material, changed, material_in_MPa
from cylcontact.bodies.pair import CylinderPair
from cylcontact.files.numbers import quantity
from cylcontact.files.reading import require_file
from cylcontact.files.sheet import Sheet, read_sheet
from cylcontact.files.units import FORCES, LENGTHS, QUANTITIES, load_in_N_per_mm, unit_after
from cylcontact.joint.answer import NUMBERS, Numbers, has_yield_stresses
from cylcontact.joint.check import checked
from cylcontact.joint.clevis_table import KNOWN as KNOWN_OF_CLEVISES
from cylcontact.joint.clevis_table import answers as answers_of_clevises
from cylcontact.joint.clevis_table import are_clevises
from cylcontact.joint.words import (
    LABELS,
    SIZES,
    joint_from_words,
    material_from_words,
)
from cylcontact.laws import Conformal, Johnson
from cylcontact.limits import first_yield, hertz_half_width, hertz_stress
from cylcontact.limits.sizing import half_width
from cylcontact.support.arrays import BoolArray, FloatArray, IndexArray, as_floats, require
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import call, run_calls
from cylcontact.support.progress import Progress, silent

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["TableCheck", "check_table"]

# Columns of numbers, with the units that they may have.
_DEGREES = {"": 1.0, "C": 1.0}
_NUMBERS: dict[str, Mapping[str, float]] = {
    "load": QUANTITIES["load"],
    **dict.fromkeys((*SIZES, "length", "R_o", "depth"), LENGTHS),
    **dict.fromkeys(("temperature", "pin_temperature", "hole_temperature"), _DEGREES),
}
_WORDS = ("contact", "plane", "material", "pin", "hole", "iso", "clamp", "layer", "rim")
# Two rollers have two materials and a housing several layers, with ; between them.
_SEVERAL = ("material", "layer")
KNOWN = (*_NUMBERS, *_WORDS)
# What makes a row a joint of its own.
_ALONE = ("iso", "R_o", "clamp", "layer", "temperature", "pin_temperature", "hole_temperature",
          "rim", "depth")  # fmt: skip
# What rows in one shape of housing mostly have in common, rows at a time, and from how many rows on
# they are answered in processes.
_SHAPE = ("R_o", "clamp", "layer", "hole", "material", "pin", "plane")
_PART, _MANY = 16, 200
# The answers of a row, after those of `Numbers`.
_MORE = ("worst", "worst_factor_to_yield", "worst_peak_pressure_MPa", "error")
# Rows of a text beyond this number are read by pandas, after the layout of the first ones.
_HEAD = 2000


@dataclass(frozen=True, eq=False)
class TableCheck:
    """The answers for a table of joints; `check_table` makes it.

    Attributes
    ----------
    table : pandas.DataFrame
        The columns that were given, then the answers, as in `Numbers`. For an ISO fit they are
        those of the middle, and `worst` names the pair that yields first. `error` says why a row
        has no answer.
    rows : sequence of str
        Where each row is, as "line 2" of a text and "row 1" of a frame.
    """

    table: pd.DataFrame
    rows: Sequence[str]

    @property
    def answered(self) -> int:
        """How many rows have an answer."""
        return int((self.table["error"] == "").sum())

    @property
    def refused(self) -> int:
        """How many rows have none."""
        return len(self.table) - self.answered

    @property
    def first_refusal(self) -> str:
        """The first row without an answer, and why; empty if there is none."""
        wrong = np.flatnonzero(self.table["error"] != "")
        return f"{self.rows[wrong[0]]}: {self.table['error'].iloc[wrong[0]]}" if wrong.size else ""

    def __str__(self) -> str:
        text = f"{self.answered:,} of {len(self.table):,} joints answered"
        if self.refused:
            text += f"; {self.refused:,} refused, first: {self.first_refusal}"
        return text

    def _repr_html_(self) -> str:
        return str(self.table._repr_html_())  # type: ignore[operator]

    def save(self, path: Path | str) -> Path:
        """Write the table as .csv, .xlsx or .parquet."""
        from cylcontact.files.writing import replacing, require_suffix, write_table

        suffix = require_suffix(path, *SUFFIXES)
        if suffix == ".csv" and _write_fast(self.table, path):
            return Path(path)
        if suffix != ".xlsx":
            write_table(self.table, path)
            return Path(path)
        with replacing(path) as temporary, temporary.open("wb") as file:
            self.table.to_excel(file, index=False)
        return Path(path)

    def plot(self, x: str, y: str, answer: str, **settings: Any) -> Any:
        """Draw an answer against two columns of the table, coloured where each joint lies.

        Parameters
        ----------
        x, y : str
            Names of columns with numbers.
        answer : str
            The name of an answer, e.g. "factor_to_yield".
        **settings
            `ax`: the axes to draw into.
        """
        from cylcontact.joint.picture import draw_map

        return draw_map(self.table, x, y, answer, **settings)


SUFFIXES = (".csv", ".xlsx", ".parquet")


def _write_fast(table: pd.DataFrame, path: Path | str) -> bool:
    """Write a table as .csv by pyarrow, which is ten times faster; False without it."""
    import pandas as pd

    try:
        import pyarrow as pa
        import pyarrow.csv
    except ImportError:
        return False
    from cylcontact.files.writing import replacing

    columns = {}
    for name in table:
        column = table[name]
        if column.dtype.kind not in "fiub":  # texts, of which few differ
            which, texts = pd.factorize(column)
            column = pa.DictionaryArray.from_arrays(
                pa.array(which, mask=which < 0), pa.array([str(text) for text in texts])
            ).cast(pa.string())
        columns[str(name)] = pa.array(column, from_pandas=True)
    with replacing(path) as temporary:
        pa.csv.write_csv(pa.table(columns), temporary)
    return True


def check_table(
    data: pd.DataFrame | Path | str,
    *,
    materials: Path | str | None = None,
    same: Mapping[str, Any] | None = None,
    progress: Progress = silent,
) -> TableCheck:
    """Check every joint of a table.

    Parameters
    ----------
    data : pandas.DataFrame, path or str
        A table of joints, or its file: .csv and other texts, .xlsx or .parquet. Columns are named
        as the options of `cylcontact check`, with their units: load_kN, pin_diameter_mm, R_i_mm,
        iso, pin, hole, R_o_mm, clamp, temperature_C. Two materials of rollers and several layers
        have ; between them. A table of clevises has other columns: load_kN, gap_mm, beyond_mm,
        pin, pin_diameter, and of eye and of cheek, as eye, eye_thickness_mm, eye_hole, eye_R_o_mm,
        eye_clamp.
    materials : path or str, optional
        Your own table of materials.
    same : mapping, optional
        What all rows have in common, by the same names in mm, N/mm and °C.
    progress : callable, optional
        Is called with the number of rows that are done.

    Returns
    -------
    TableCheck

    Raises
    ------
    InputError
        If a column is not known, or the file is no table. What is wrong with a row is in its
        column `error`.

    Examples
    --------
    >>> import pandas as pd
    >>> frame = pd.DataFrame({"R_i_mm": [10.0, 10.0], "R_j_mm": [9.98, 10.1],
    ...                       "load_kN": [6.0, 6.0], "length_mm": [12.0, 12.0],
    ...                       "material": ["bronze", "bronze"]})
    >>> check = check_table(frame)
    >>> print(check.answered, check.refused, check.table["peak_pressure_MPa"].round(2).tolist())
    1 1 [52.91, nan]
    """
    table, source = _opened(data)
    own = None if materials is None else Path(materials)
    if are_clevises(table.names if isinstance(table, Sheet) else list(table.columns)):
        sheet = table if isinstance(table, Sheet) else read_sheet(table)
        return TableCheck(answers_of_clevises(sheet, same or {}, own, progress), _places(sheet))
    rows = _of_sheet(table) if isinstance(table, Sheet) else _of_frame(table, source)
    return TableCheck(_Rows(rows, dict(same or {}), own, progress).answers(), _places(table))


def require_joints(path: Path) -> None:
    """Refuse a file that is no table of joints, without answering any."""
    table, source = _opened(path)
    if not are_clevises(table.names if isinstance(table, Sheet) else list(table.columns)):
        _of_sheet(table) if isinstance(table, Sheet) else _of_frame(table, source)


def _places(table: Sheet | pd.DataFrame) -> list[str]:
    """Return where each row is."""
    if isinstance(table, Sheet):
        return [f"{table.row_word} {line}" for line in table.lines]
    return [f"row {k}" for k in range(1, len(table) + 1)]


# --- reading ------------------------------------------------------------------------------------


@dataclass(eq=False)
class _Columns:
    """The columns of a table by their names here, and what is wrong with single cells."""

    source: str
    frame: pd.DataFrame
    numbers: dict[str, FloatArray]
    words: dict[str, Any]
    is_total: bool
    wrong: dict[int, str] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.frame)


def _opened(data: pd.DataFrame | Path | str) -> tuple[Sheet | pd.DataFrame, str]:
    """Return a table as a sheet, a large one or a frame as a frame, and its source."""
    if not isinstance(data, Path | str):
        return data, "DataFrame"
    require_file(Path(data))
    frame = _frame_of_large(Path(data))
    if frame is not None:
        return frame, str(data)
    return read_sheet(data, (*KNOWN, *KNOWN_OF_CLEVISES)), str(data)


def _frame_of_large(path: Path) -> pd.DataFrame | None:
    """Return a Parquet file, or a plain long text, read by pandas; None for all else."""
    import pandas as pd

    if path.suffix.lower() == ".parquet":
        return pd.read_parquet(path)
    with path.open("rb") as file:
        head = [file.readline() for _ in range(_HEAD)]
        if not file.readline() or path.suffix.lower() in (".xlsx", ".xlsm"):
            return None
    names = head[0].decode("utf-8-sig", "replace").strip().split(",")
    plain = len(names) > 1 and all(name.strip() for name in names)
    return pd.read_csv(path, encoding="utf-8-sig", skipinitialspace=True) if plain else None


def _of_frame(frame: pd.DataFrame, source: str) -> _Columns:
    """Return the columns of a frame, whose numbers are those of its cells."""
    import pandas as pd

    # Names, units and factors are read as those of any table, from a row of ones.
    first = {
        str(name): [1.0 if _which(str(name)) in _NUMBERS else "text"] for name in frame.columns
    }
    probe = read_sheet(pd.DataFrame(first), KNOWN)
    probe.source = source
    found = _of_sheet(probe)
    numbers, wrong = {}, {}
    for name, factor in found.numbers.items():
        column = frame[_column(frame.columns, name)]
        values = pd.to_numeric(column, errors="coerce").to_numpy(float)
        if name == "R_j":
            values = np.where(column.astype(str).str.strip() == "inf", np.inf, values)
        for row in np.flatnonzero(np.isnan(values) & column.notna().to_numpy()):
            wrong[int(row)] = f"{name} = {column.iloc[row]!r}: is not a number; correct it"
        numbers[name] = as_floats(values * float(factor[0]))
    words = {
        name: frame[_column(frame.columns, name)].astype(object).to_numpy() for name in found.words
    }
    return _Columns(source, frame, numbers, words, found.is_total, wrong)


def _of_sheet(sheet: Sheet) -> _Columns:
    """Return the columns of a sheet."""
    import pandas as pd

    unknown = [n for n in sheet.names if _which(n) is None and n.lower() not in LABELS]
    if unknown or not sheet.names:
        rule = f"{', '.join(unknown) or 'a name'} is not known" if sheet.names else "has no names"
        remedy = (
            f"name columns {', '.join(KNOWN)}, with a unit as in load_kN, R_i_mm, or one of "
            f"{', '.join(LABELS)} for your own text"
        )
        raise InputError(sheet.source, "columns", None, rule, remedy)
    frame = pd.DataFrame(dict(zip(sheet.names, sheet.columns, strict=True))).infer_objects()
    wrong: dict[int, InputError] = {}
    numbers: dict[str, FloatArray] = {}
    for name, units in _NUMBERS.items():
        if name == "R_j":
            _planes(sheet)
        values = quantity(sheet, name, units, wrong=wrong)
        if values is not None:
            numbers[name] = np.where(values >= _PLANE, np.inf, values)
    words = {
        name: np.array(sheet.columns[_column(sheet.names, name)], dtype=object)
        for name in _WORDS
        if any(_which(each) == name for each in sheet.names)
    }
    for name, values in numbers.items():
        column = _column(frame.columns, name)
        if not pd.api.types.is_numeric_dtype(frame[column]) and np.isfinite(values).all():
            plain = pd.to_numeric(frame[column], errors="coerce")
            frame[column] = plain if plain.notna().all() else frame[column]
    told = {row: f"{error.key} = {error.value!r}: {error.rule}; {error.remedy}"
            for row, error in wrong.items()}  # fmt: skip
    return _Columns(sheet.source, frame, numbers, words, _is_total(sheet.names), told)


_DIGITS = "0123456789.+-eE "
# Stands for an infinite radius while a column is read as numbers.
_PLANE = 1e290


def _planes(sheet: Sheet) -> None:
    """Let `inf` be the radius of a plane."""
    for k, name in enumerate(sheet.names):
        if _which(name) == "R_j":
            sheet.columns[k] = ["1e299" if str(c).strip() == "inf" else c for c in sheet.columns[k]]


def _which(name: str) -> str | None:
    """Return what a column is, None if it is not known."""
    plain = name.strip().lower().replace(" ", "_")
    for known in _WORDS:
        if plain == known:
            return known
    for known, units in _NUMBERS.items():
        if unit_after(name, known, units) is not None:
            return known
    return None


def _column(names: Any, wanted: str) -> Any:
    """Return the position in a list, or the name in a frame, of a column."""
    at = [k for k, name in enumerate(names) if _which(str(name)) == wanted]
    return at[0] if isinstance(names, list) else names[at[0]]


def _is_total(names: list[str]) -> bool:
    """Return whether the loads are total forces."""
    found = [unit_after(name, "load", QUANTITIES["load"]) for name in names]
    return any(unit is not None and unit.name in FORCES for unit in found)


def is_total_force(text: str) -> bool:
    """Return whether a load with its unit is a total force."""
    return unit_after(f"load {text.lstrip(_DIGITS)}", "load", FORCES) is not None


# --- answering ----------------------------------------------------------------------------------


class _Part(NamedTuple):
    """Rows of one pair of materials."""

    rows: IndexArray
    i: Material
    j: Material


@dataclass(eq=False)
class _Rows:
    """The rows of a table and what all have in common."""

    columns: _Columns
    same: dict[str, Any]
    own: Path | None
    progress: Progress

    def __post_init__(self) -> None:
        columns = self.columns
        for name in self.same:
            if name in columns.numbers or name in columns.words:
                rule, remedy = f"is a column of {columns.source}", "give one of the two"
                raise InputError(columns.source, name, self.same[name], rule, remedy)
        size = len(columns)
        self._plain_words()
        self.values = {name: np.full(size, np.nan) for name in NUMBERS}
        for name in ("worst_factor_to_yield", "worst_peak_pressure_MPa"):
            self.values[name] = np.full(size, np.nan)
        self.worst = np.full(size, "", dtype=object)
        self.error = np.full(size, "", dtype=object)
        for row, text in columns.wrong.items():
            self.error[row] = text

    def _plain_words(self) -> None:
        """Write what all rows have in common as the columns of a table would."""
        same, columns = self.same, self.columns
        if isinstance(load := same.pop("load", None), str):
            text = load if load[-1:].isalpha() else f"{load} N/mm"
            load = load_in_N_per_mm(text, 1.0)
            columns.is_total = is_total_force(text)
        if load is not None:
            columns.numbers["load"] = np.full(len(columns), float(load))
        for name in ("material", "pin", "hole"):
            value = same.get(name)
            if isinstance(value, list) and len(value) == 1:
                (value,) = value
            if isinstance(value, tuple):
                E, *others = (repr(each) for each in value)
                value = ", ".join([f"{E} MPa", *others])
            if value is not None:
                same[name] = value

    def answers(self) -> pd.DataFrame:
        """Return the table with its answers."""
        import pandas as pd

        done = self._at_once()
        self._alone(np.flatnonzero(~done & (self.error == "")))
        frame = self.columns.frame.copy(deep=False)
        for name, values in self.values.items():
            frame[name] = values
        frame["worst"], frame["error"] = self.worst, self.error
        order = [*NUMBERS, *_MORE]
        return pd.concat([frame[[c for c in frame if c not in order]], frame[order]], axis=1)

    def given(self, row: int) -> dict[str, Any]:
        """Return the values of a row, by the names of options."""
        import pandas as pd

        columns = self.columns
        given = dict(self.same)
        for name, numbers in columns.numbers.items():
            if not np.isnan(numbers[row]):
                given[name] = float(numbers[row])
        for name, words in columns.words.items():
            text = "" if pd.isna(words[row]) else str(words[row]).strip()
            if text:
                several = name in _SEVERAL and ";" in text
                given[name] = [part.strip() for part in text.split(";")] if several else text
        rule, remedy = "is missing", "give every row a load, as load_N_per_mm or load_kN"
        require("load" in given, "", "load", None, rule, remedy)
        if columns.is_total:
            given["load"] = f"{given['load']!r} N"
        pin, hole = (given.pop(f"{body}_temperature", None) for body in ("pin", "hole"))
        if "temperature" in given:
            both = given["temperature"]
            given["temperature"] = both if isinstance(both, tuple) else (both, both)
            if pin is not None or hole is not None:
                rule, remedy = "is given beside pin_temperature or hole_temperature", "keep one"
                raise InputError("", "temperature", both, rule, remedy)
        elif pin is not None or hole is not None:
            given["temperature"] = (20.0 if pin is None else pin, 20.0 if hole is None else hole)
        return given

    def _alone(self, rows: IndexArray) -> None:
        """Answer rows as joints of their own."""
        given: dict[int, dict[str, Any]] = {}
        for row in rows.tolist():
            try:
                given[row] = self.given(row)
            except InputError as error:
                self.error[row] = str(error)
        order = sorted(given, key=lambda row: [str(given[row].get(name)) for name in _SHAPE])
        parts = [order[k : k + _PART] for k in range(0, len(order), _PART)]
        calls = [call(_answered, [given[row] for row in part], self.own) for part in parts]
        workers = (os.cpu_count() or 1) if len(order) >= _MANY else 1
        done = len(self.columns) - len(order)
        with closing(run_calls(calls, workers)) as results:
            for part, answers in zip(parts, results, strict=True):
                for row, answer in zip(part, answers, strict=True):
                    self._write(row, answer)
                done += len(part)
                self.progress("joints", done, len(self.columns))

    def _write(self, row: int, answer: _Answer | str) -> None:
        """Write the answer of a row, or why it has none."""
        if isinstance(answer, str):
            self.error[row] = answer
            return
        numbers, self.worst[row], factor, peak = answer
        for name in NUMBERS:
            self.values[name][row] = getattr(numbers, name)
        self.values["worst_factor_to_yield"][row] = factor
        self.values["worst_peak_pressure_MPa"][row] = peak

    # --- many rows at once ---

    def _at_once(self) -> BoolArray:
        """Answer rows of plain pins in holes and of rollers; return which."""
        import pandas as pd

        columns, size = self.columns, len(self.columns)
        plain = self.error == ""
        for name in _ALONE:
            if name in self.same:
                return np.zeros(size, dtype=bool)
            if name in columns.numbers:
                plain &= np.isnan(columns.numbers[name])
            if name in columns.words:
                plain &= pd.isna(columns.words[name])
        done = np.zeros(size, dtype=bool)
        names = ("contact", "plane", "material", "pin", "hole")
        keys = {name: self._texts(name) for name in names}
        codes = pd.MultiIndex.from_arrays(list(keys.values())).factorize()[0]
        order = np.argsort(codes, kind="stable")
        starts = np.flatnonzero(np.diff(codes[order], prepend=-1))
        batches: dict[tuple[str, Any, bool], list[_Part]] = {}
        for start, end in zip(starts, [*starts[1:], size], strict=True):
            rows = order[start:end]
            rows = rows[plain[rows]]
            if rows.size:
                self._sort({name: keys[name][rows[0]] for name in names}, rows, batches)
        for (contact, plane, _), parts in batches.items():
            done[self._batch(contact, plane, parts)] = True
            self.progress("joints", int(done.sum()), size)
        return done

    def _sort(
        self,
        words: Mapping[str, str],
        rows: IndexArray,
        batches: dict[tuple[str, Any, bool], list[_Part]],
    ) -> None:
        """Put rows of one pair of materials to those that are answered with them."""
        given = {name: text for name, text in words.items() if text}
        contact, plane = given.get("contact", "internal"), given.get("plane", "strain")
        pin, hole, both = (given.get(name) for name in ("pin", "hole", "material"))
        usual = (pin and hole and not both) or (both and not pin and not hole)
        if contact not in ("internal", "external") or plane not in ("strain", "stress"):
            return
        if not usual or (contact == "external" and not both):
            return
        if both and contact == "external":
            hole, _, pin = str(both).partition(";")
        with suppress(InputError):  # the rows are refused one by one
            i = material_from_words(str(hole or both), "", "material", self.own)
            j = material_from_words(str(pin or hole or both), "", "material", self.own)
            known = i.yield_stress is not None and j.yield_stress is not None
            batches.setdefault((contact, plane, known), []).append(_Part(rows, i, j))

    def _texts(self, name: str) -> Any:
        """Return a column of words, empty where it has none."""
        import pandas as pd

        words = self.columns.words.get(name)
        if words is None:
            return np.full(len(self.columns), str(self.same.get(name, "")), dtype=object)
        return np.where(pd.isna(words), "", words)

    def _numbers(self, name: str, rows: IndexArray) -> FloatArray:
        """Return a column of numbers, NaN where it has none."""
        values = self.columns.numbers.get(name)
        if values is None:
            return np.full(rows.size, float(self.same.get(name, np.nan)))
        return as_floats(values[rows])

    def _batch(self, contact: str, plane: Any, parts: Sequence[_Part]) -> IndexArray:
        """Answer the sound rows of some pairs of materials; return which."""
        rows = np.concatenate([part.rows for part in parts])
        which = np.repeat(np.arange(len(parts)), [part.rows.size for part in parts])
        R_i, R_j = self._radii(rows, contact)
        length, load = self._numbers("length", rows), self._numbers("load", rows)
        if self.columns.is_total:
            load = load / length
        sound = (R_i > 0) & (R_j > 0) & (load > 0) & np.isfinite(R_i + load)
        sound &= (R_i > R_j) if contact == "internal" else np.isfinite(R_j)
        sound &= ~(length <= 0)
        rows, which = rows[sound], which[sound]
        if rows.size > 1:
            i = _of_many([part.i for part in parts], which)
            j = _of_many([part.j for part in parts], which)
            pair = _pair(contact, R_i[sound], R_j[sound], i, j, plane)
            self._fill(rows, pair, as_floats(load[sound]), as_floats(length[sound]))
            return rows
        return rows[:0]

    def _radii(self, rows: IndexArray, contact: str) -> tuple[FloatArray, FloatArray]:
        """Return the radii of rows, NaN where they are not just two sizes."""
        get = {name: self._numbers(name, rows) for name in SIZES}
        clashes = sum(~np.isnan(get[a]) & ~np.isnan(get[b]) for a, b in
                      (("R_i", "hole_diameter"), ("R_j", "pin_diameter")))  # fmt: skip
        if contact == "external":
            clashes = clashes + ~np.isnan(get["hole_diameter"]) + ~np.isnan(get["pin_diameter"])
        first = np.where(np.isnan(get["R_i"]), get["hole_diameter"] / 2, get["R_i"])
        second = np.where(np.isnan(get["R_j"]), get["pin_diameter"] / 2, get["R_j"])
        gap, sign = get["radial_clearance"], 1 if contact == "internal" else -1
        known = (~np.isnan(first)).astype(int) + ~np.isnan(second) + ~np.isnan(gap)
        R_i = np.where(np.isnan(first), sign * second + gap, first)
        R_j = np.where(np.isnan(second), sign * (first - gap), second)
        bad = (known != 2) | (clashes > 0)
        return as_floats(np.where(bad, np.nan, R_i)), as_floats(np.where(bad, np.nan, R_j))

    def _fill(
        self, rows: IndexArray, pair: CylinderPair, load: FloatArray, length: FloatArray
    ) -> None:
        """Write the answers of rows with one pair of materials."""

        def put(name: str, values: Any) -> None:
            self.values[name][rows] = values

        if pair.contact == "internal":
            dR, state = as_floats(pair.dR), Conformal().state(load, pair)
            peak, depth, stiffness = state.peak_pressure, state.penetration, state.stiffness
            put("clearance_um", 1e3 * dR)
            put("diametral_clearance_um", 2e3 * dR)
            put("contact_angle_deg", state.contact_angle)
            put("width_mm", 2 * half_width(state.contact_angle, pair))
            put("peak_at_deg", 0.0)
            put("projected_pressure_MPa", load / (2 * as_floats(pair.R_j)))
        else:
            johnson = Johnson()
            put("width_mm", 2 * hertz_half_width(load, pair))
            peak, depth = hertz_stress(load, pair), johnson.penetration(load, pair)
            stiffness = johnson.stiffness(depth, pair)
        put("peak_pressure_MPa", peak)
        put("worst_peak_pressure_MPa", peak)
        put("penetration_um", 1e3 * depth)
        put("stiffness_N_per_mm2", stiffness)
        put("total_stiffness_N_per_mm", stiffness * length)
        if has_yield_stresses(pair, None):
            at = as_floats(first_yield(pair).load)
            put("first_yield_N_per_mm", at)
            put("factor_to_yield", at / load)
            put("worst_factor_to_yield", at / load)
        self.worst[rows] = "joint"


class _Answer(NamedTuple):
    """The answer of one row: its numbers, and the worst of the band of a fit."""

    numbers: Numbers
    worst: str
    worst_factor: float
    worst_peak: float


def _answered(rows: Sequence[Mapping[str, Any]], own: Path | None) -> list[_Answer | str]:
    """Return the answer of each row, or why it has none."""
    answers: list[_Answer | str] = []
    for given in rows:
        try:
            check = checked(joint_from_words(given, "", str, own))
        except InputError as error:
            answers.append(str(error))
            continue
        name, worst = check.worst
        band = [each for key, each in check.band.items() if key != "mean"] or [check.numbers]
        peak = float(np.nanmax([each.peak_pressure_MPa for each in band]))
        answers.append(_Answer(check.numbers, name, worst.factor_to_yield, peak))
    return answers


def _of_many(bodies: Sequence[Material], which: IndexArray) -> Material:
    """Return the material of each row, as arrays unless all rows have one."""
    if len(bodies) == 1:
        return bodies[0]
    E, nu = (np.array([float(getattr(x, key)) for x in bodies])[which] for key in ("E", "nu"))
    material = material_in_MPa("", as_floats(E), as_floats(nu))
    stresses = [body.yield_stress for body in bodies if body.yield_stress is not None]
    if len(stresses) < len(bodies):
        return material
    return changed(material, yield_stress=as_floats(np.array(stresses)[which]))


def _pair(
    contact: str, R_i: FloatArray, R_j: FloatArray, i: Material, j: Material, plane: Any
) -> CylinderPair:
    """Return many pairs of two materials."""
    if contact == "internal":
        return CylinderPair.internal(R_i, R_j, pin=j, hole=i, plane=plane)
    return CylinderPair.external(R_i, R_j, i, None, j, plane=plane)
