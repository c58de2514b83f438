"""Files as lines of cells: the encoding and separator of a text, the sheets of a workbook."""

from __future__ import annotations

import csv
import io
import re
import warnings
from collections.abc import Iterable
from datetime import datetime, time
from functools import lru_cache
from itertools import groupby
from typing import TYPE_CHECKING, Any, NamedTuple

from cylcontact.files.units import is_unit
from cylcontact.files.writing import require_parquet
from cylcontact.support.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

SEPARATORS = {";": "semicolons", "\t": "tabs", "|": "bars", ",": "commas", " ": "spaces"}
# As options name them.
SEPARATOR_NAMES = {name.removesuffix("s"): mark for mark, name in SEPARATORS.items()}
THOUSANDS = re.compile(r"[+\-−]?\d{1,3}(?:[\u00a0\u202f '’.,]\d{3})+(?:[.,]\d+)?")
_NUMBER = re.compile(
    r"[+\-−]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?|\d+:\d\d(?::\d\d)?(?:[.,]\d+)?"
)
# A number with a power of ten that the usual notation does not have; ×106 may have lost its ^.
SCIENTIFIC = re.compile(
    r"(?P<number>[+\-−]?(?:\d+[.,]?\d*|[.,]\d+))\s?(?:"
    r"[×xX·*]\s?10\s?(?:(?:\^|\*\*)\s?(?P<power>[+\-−]?\d+)"
    r"|(?P<raised>[+\-−]\d+|[⁺⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+))"
    r"|(?:[eE]|[dD](?=[+-]))(?P<exponent>[+\-−]?\d+))"
)
# What machines and spreadsheets write for a number that is missing.
_MISSING = {"nan", "na", "n/a", "#n/a", "inf", "-inf", "null", "#div/0!", "#value!"}
# A date, or a date and a time: no cell that a wrong separator leaves.
_DATE = re.compile(
    r"\d{1,4}[-./]\d{1,2}[-./]\d{1,4}(?:[ T]\d+:\d\d(?::\d\d(?:[.,]\d+)?)?(?: ?[AaPp][Mm])?)?"
)
_BETWEEN = re.compile(r"[;,|\s]+")
# A number with its unit, as 200 N.
_WITH_UNIT = re.compile(
    r"(?P<number>[+\-−]?\d[\d.,'’\u00a0\u202f ]*?(?:[eE][+-]?\d+)?)\s?(?P<unit>[^\W\d_][^\d\s]*|\")"
)
# Beyond letters, what the Windows-1252 text of a table may have that is not ASCII.
_EXTRA = "µ°±²³·×–—€\u00a0’‘“”„…½¼™®©§"
# Words of letters beyond ASCII alone: a text in another encoding, read as Windows-1252.
_FOREIGN = re.compile(r"(?<![^\W\d_])[^\W\d_a-zA-Zµªº]{2,}(?![^\W\d_])|[^\W\d_a-zA-Zµªº]{4,}")
_SAMPLE = 60  # lines at the end of a text, which show the separator


class Line(NamedTuple):
    """A line of a text or a row of a sheet; an empty cell is None."""

    number: int
    cells: list[Any]


class RawSheet(NamedTuple):
    """The lines of a sheet that are not empty, and the separator of the cells in a text."""

    title: str
    lines: list[Line]
    separator: str = ""


Pattern = tuple[bool, ...]


def is_number(cell: object) -> bool:
    """Return whether a cell is a number in any notation, a time, or stands for a number."""
    if isinstance(cell, str):
        is_any = _NUMBER.fullmatch(cell) or THOUSANDS.fullmatch(cell) or cell.lower() in _MISSING
        return bool(is_any or SCIENTIFIC.fullmatch(cell) or number_and_unit(cell))
    return isinstance(cell, int | float | time | datetime)


def number_and_unit(cell: str) -> tuple[str, str] | None:
    """Return the number and the unit in a cell.

    >>> number_and_unit("200 N"), number_and_unit("0,207µm"), number_and_unit("12 pins")
    (('200', 'N'), ('0,207', 'µm'), None)
    """
    found = _WITH_UNIT.fullmatch(cell) if cell[:1] in "+-−0123456789" else None
    if found is None or not _is_unit(found["unit"]):
        return None
    return found["number"], found["unit"]


_is_unit = lru_cache(maxsize=1024)(is_unit)


def row_pattern(lines: Iterable[Line]) -> tuple[int, Pattern]:
    """Return the pattern of a row, which of its cells are numbers, and how many numbers follow it.

    It is that of the run of equal lines with most numbers; lines of words do not end a run.
    """
    patterns = (tuple(map(is_number, line.cells)) for line in lines)
    runs = groupby(filter(any, patterns))
    sizes = [(pattern, sum(pattern), sum(1 for _ in run)) for pattern, run in runs]
    # Settings above the table have one number a line, and readings two.
    best = max(sizes, key=lambda run: (min(run[1], 2), run[1] * run[2]), default=((), 0, 0))
    return best[1] * best[2], best[0]


# --- text ---------------------------------------------------------------------------------------


def sheet_of_text(
    source: str, content: bytes, notes: list[str], separator: str | None, encoding: str | None
) -> RawSheet:
    """Return a text as a sheet; note its encoding and separator unless they are the usual ones."""
    mark, raw = separator or "", [""]
    try:
        raw = re.split(r"\r\n|\r|\n", _decoded(source, content, notes, encoding))
        mark = mark or _separator(raw)
        lines = _lines(raw, mark)
    except (UnicodeError, csv.Error) as error:
        rule = f"is not a CSV table ({error})"
        remedy = f"save it as CSV in UTF-8{other_separator(raw[-1] or raw[0], mark)}"
        raise InputError(source, "", None, rule, remedy) from error
    notes += [] if mark == "," else [f"cells separated by {SEPARATORS[mark]}"]
    return RawSheet("", lines, mark)


def other_separator(text: str, separator: str) -> str:
    """Return the end of a remedy that names another separator in a text; empty if it has none."""
    counts = {name: text.count(m) for name, m in SEPARATOR_NAMES.items() if m != separator}
    name = max(counts, key=counts.__getitem__)
    return f", or try --separator {name}" if separator and counts[name] else ""


def _decoded(source: str, content: bytes, notes: list[str], encoding: str | None) -> str:
    """Return the text of UTF-8, of UTF-16 with a byte order mark, or of Windows-1252."""
    if encoding is not None:
        try:
            text = content.decode(encoding)
        except LookupError as error:
            rule, remedy = "is not a known encoding", "give e.g. utf-8, cp1252, cp1251 or gbk"
            raise InputError(source, "encoding", encoding, rule, remedy) from error
        except UnicodeDecodeError as error:
            rule, remedy = f"is not that of the text ({error})", "give another one"
            raise InputError(source, "encoding", encoding, rule, remedy) from error
        notes.append(f"text in {encoding}")
    elif content.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = content.decode("utf-16")
        notes.append("text in UTF-16")
    else:
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = _western(source, content)
            notes.append("text in Windows-1252")
    if "\0" in text:
        raise UnicodeError("it holds zero bytes")
    return text.removeprefix("\ufeff")


def _western(source: str, content: bytes) -> str:
    """Return a text in Windows-1252; refuse one that is of another alphabet by its words."""
    try:
        text = content.decode("cp1252")
    except UnicodeDecodeError:
        text = "\0"
    is_usual = all(c.isascii() or c.isalpha() or c in _EXTRA for c in set(text))
    if "\0" in text or not is_usual or _FOREIGN.search(text):
        rule = "is a text in an encoding that is not known"
        remedy = (
            "name it, e.g. --encoding cp1251 (Cyrillic), gbk (Chinese), shift_jis (Japanese) or "
            "cp1252 (Western), or save it in UTF-8"
        )
        raise InputError(source, "", None, rule, remedy)
    return text


def _separator(raw: list[str]) -> str:
    """Return the separator of most equal rows that leaves no broken cells.

    Rows of two numbers come before those of one, which settings above the table have.
    """
    sample = [line for line in raw if line.strip() and not line.startswith("sep=")][-_SAMPLE:]
    scores: dict[str, tuple[int, int, int]] = {}
    for separator in SEPARATORS:
        lines = _lines(sample, separator, strict=False)
        by_pattern: dict[Pattern, list[list[Any]]] = {}
        for line in lines:
            by_pattern.setdefault(tuple(map(is_number, line.cells)), []).append(line.cells)
        ranked = {
            (min(sum(pattern), 2), len(rows), sum(pattern)): rows
            for pattern, rows in by_pattern.items()
            if len(pattern) > 1 and any(pattern)
        }
        if not ranked:
            continue
        score = max(ranked)
        words = {cell for cells in ranked[score] for cell in cells if cell and not is_number(cell)}
        if not any(map(_is_fragment, words)):
            scores[separator] = score
    if scores:
        return max(scores, key=scores.__getitem__)
    # Without rows the last line, of names or units, shows it.
    return max(";\t|,", key=(sample or [","])[-1].count)


def _is_fragment(cell: str) -> bool:
    """Return whether a cell is what a wrong separator leaves: numbers with marks between them."""
    parts = [part for part in _BETWEEN.split(cell) if part]
    if _DATE.fullmatch(cell) or parts == [cell] or not any(map(is_number, parts)):
        return False
    return not any(c.isalpha() for part in parts if not is_number(part) for c in part)


def _lines(raw: list[str], separator: str, *, strict: bool = True) -> list[Line]:
    """Return the lines that are not empty. One that begins with # is split behind it."""
    by_spaces = separator == " "
    options: Any = {"delimiter": separator, "skipinitialspace": by_spaces}
    marked = {
        n: x.lstrip(" \t#")
        for n, x in enumerate(raw, 1)
        if "#" in x and x.lstrip(" ").startswith("#")
    }
    texts = (
        "\n" if n in marked or x.startswith("sep=") else f"{x.strip() if by_spaces else x}\n"
        for n, x in enumerate(raw, 1)
    )
    reader = csv.reader(texts, strict=strict, **options)
    lines = [Line(reader.line_num, tidy(row)) for row in reader]
    for line in lines if any('"' in text for text in raw) else ():
        if any(cell and "\n" in cell and _holds_rows(cell, separator) for cell in line.cells):
            raise csv.Error(f"a quote is open before line {line.number}")
    for number, text in marked.items():
        first, *others = next(csv.reader([text], **options), []) or [""]
        lines.append(Line(number, tidy([f"#{first}", *others])))
    if by_spaces:  # names may hold single spaces: "Force [N]   Travel [mm]"
        width = len(row_pattern(lines)[1])
        for k, (number, cells) in enumerate(lines):
            names = re.split(r"\s{2,}|(?<=[\])])\s+", raw[number - 1].strip())
            lines[k] = Line(number, tidy(names) if len(cells) != width == len(names) else cells)
    return sorted((x for x in lines if any(c is not None for c in x.cells)), key=lambda x: x.number)


def _holds_rows(cell: str, separator: str) -> bool:
    """Return whether a quoted cell of several lines has numbers side by side."""
    lines = ([part.strip(' "') for part in x.split(separator)] for x in cell.split("\n"))
    return any(sum(map(is_number, parts)) > 1 for parts in lines)


def tidy(cells: Iterable[Any]) -> list[Any]:
    """Return cells without spaces around their text; None for empty ones."""
    return [cell.strip() or None if isinstance(cell, str) else cell for cell in cells]


# --- workbooks, Parquet and frames --------------------------------------------------------------


def sheets_of_workbook(source: str, content: bytes) -> list[RawSheet]:
    """Return the sheets of a workbook that hold cells, without their empty columns."""
    import pandas as pd

    options: Any = {"header": None, "keep_default_na": False, "na_values": [""]}
    try:
        with warnings.catch_warnings():  # of styles and extensions, which do not matter here
            warnings.simplefilter("ignore")
            file = io.BytesIO(content)
            frames = pd.read_excel(file, None, engine="openpyxl", dtype=object, **options)
    except Exception as error:  # openpyxl raises whatever a damaged file makes it stumble over
        reason = (str(error) or type(error).__name__)[:80]  # they may quote the file
        rule = f"is not an Excel workbook ({reason})"
        raise InputError(source, "", None, rule, "save it as .xlsx or .csv") from error
    filled = {str(title): frame.dropna(axis=1, how="all") for title, frame in frames.items()}
    sheets = [RawSheet(title, lines_of(frame)) for title, frame in filled.items()]
    return [sheet for sheet in sheets if sheet.lines]


def frame_of_parquet(source: str, content: bytes) -> pd.DataFrame:
    """Return the frame in a Parquet file."""
    require_parquet(source)
    import pandas as pd

    try:
        return pd.read_parquet(io.BytesIO(content))
    except (OSError, ValueError) as error:  # of damaged contents
        rule = f"is not a Parquet table ({error})"
        raise InputError(source, "", None, rule, "write it anew, or use CSV") from error


def lines_of(frame: pd.DataFrame) -> list[Line]:
    """Return the rows of a frame, counted from 1, without empty ones."""
    columns = [frame.iloc[:, k].astype(object) for k in range(frame.shape[1])]
    cells = [column.where(column.notna(), None).tolist() for column in columns]
    lines = [Line(n, tidy(row)) for n, row in enumerate(zip(*cells, strict=True), start=1)]
    return [line for line in lines if any(cell is not None for cell in line.cells)]
