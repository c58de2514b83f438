"""Tables as files hold them: the names of columns, and cells of text or numbers."""

from __future__ import annotations

import csv
import hashlib
import io
import math
import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import compress, islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cylcontact.files.reading import plain_number, read_bytes
from cylcontact.files.writing import require_parquet
from cylcontact.support.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

# All rows are held in memory and stored in the result.
MAX_ROWS = 200_000
# Of each row its position in the file and its cells.
_Rows = list[tuple[int, list[Any]]]
_SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs", " ": "spaces"}
# Beyond letters, what the Windows-1252 text of a table may have that is not ASCII.
_EXTRA = "µ°±²³·×–€"
_GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}")
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(?:[\u00a0\u202f '’.,]\d{3})+(?:[.,]\d+)?")

_NO_THOUSANDS = "has separators of thousands", "write it without them"


@dataclass(frozen=True)
class Table:
    """The cells of a table with N rows."""

    source: str
    row_word: str
    sha256: str
    names: list[str]
    lines: list[int]
    columns: list[list[Any]]
    separator: str = ""
    steps: list[str] = field(default_factory=list)

    @property
    def header_rule(self) -> str:
        """The rule on where a workbook's column names stand, for errors; empty for other tables."""
        if Path(self.source).suffix.lower() != ".xlsx":
            return ""
        return " (the first sheet with cells is read, and its first row must hold the names)"


def read_table(path: Path | str) -> Table:
    """Read an Excel workbook, a Parquet file or, under any other name, a table in text.

    The separator of a text, its encoding and its decimal mark are recognised. Of a workbook the
    first sheet that holds cells is read.
    """
    source, suffix = str(path), Path(path).suffix.lower()
    if suffix == ".xls":
        rule = "is a workbook of Excel before 2007, which is not read"
        raise InputError(source, "", None, rule, "save it as .xlsx")
    if suffix in (".toml", ".json"):
        raise InputError(source, "", None, "is not a table", "name a table")
    content = read_bytes(path)
    steps: list[str] = []
    separator = ""
    binary = {".xlsx": _read_workbook, ".parquet": _read_parquet}.get(suffix)
    if binary is None:
        separator, rows = _read_csv(source, content, steps)
    else:
        rows = binary(source, content, steps)
    if not rows:
        raise InputError(source, "", None, "is empty", "give it a line of column names, then rows")
    row_word = "line" if binary is None else "row"
    _require_rectangular(source, row_word, rows, separator)
    names = ["" if name is None else str(name) for name in rows.pop(0)[1]]
    lines = [line for line, _ in rows]
    columns = [list(cells) for cells in zip(*(cells for _, cells in rows), strict=True)]
    sha256 = hashlib.sha256(content).hexdigest()
    table = Table(source, row_word, sha256, names, lines, columns, separator, steps)
    require_rows(table)
    return table


def table_of_frame(frame: pd.DataFrame) -> Table:
    """Return a DataFrame as a table, rows counted from 1; missing values are empty cells."""
    content = frame.to_csv(index=False, lineterminator="\n").encode()
    names, *rows = _rows_of(frame)
    columns = [list(cells) for cells in zip(*(cells for _, cells in rows), strict=True)]
    lines = [line for line, _ in rows]
    table = Table("DataFrame", "row", hashlib.sha256(content).hexdigest(), names[1], lines, columns)
    require_rows(table)
    return table


def _rows_of(frame: pd.DataFrame) -> _Rows:
    """Return the names of the columns as row 0, then the rows; None for a missing value."""
    columns = [frame.iloc[:, k] for k in range(frame.shape[1])]
    cells = [column.astype(object).where(column.notna(), None).tolist() for column in columns]
    rows = (list(map(_plain, row)) for row in zip(*cells, strict=True))
    return [(0, list(map(str, frame.columns))), *enumerate(rows, start=1)]


def require_rows(table: Table) -> None:
    """Raise `InputError` for a table without rows, or with too many."""
    if not table.lines:
        rule, remedy = "holds no rows", "give it at least one below the names"
        raise InputError(table.source, "", None, rule, remedy)
    if len(table.lines) > MAX_ROWS:
        rule, remedy = f"has {len(table.lines)} rows (at most {MAX_ROWS})", "thin or average them"
        raise InputError(table.source, "", None, rule, remedy)


def _require_rectangular(source: str, row_word: str, rows: _Rows, separator: str) -> None:
    """Raise `InputError` for the first row with more or fewer cells than there are names."""
    width = len(rows[0][1])
    for line, row in rows[1:]:
        if len(row) != width:
            rule = f"has {len(row)} cells for {width} columns"
            by = _SEPARATORS[separator] + (" and points in numbers" if separator == "," else "")
            remedy = (
                f"give every row a cell for each column, separated by {by}, and begin others with #"
            )
            raise InputError(f"{source}, {row_word} {line}", "", None, rule, remedy)


# --- CSV ----------------------------------------------------------------------------------------


def _read_csv(source: str, content: bytes, steps: list[str]) -> tuple[str, _Rows]:
    """Return the separator, and the rows of text without empty ones, that of names first."""
    try:
        text = _decoded(content, steps)
        separator = _separator(text)
        rows = [(line, cells) for line, cells in _rows(text, separator, strict=True) if any(cells)]
    except (UnicodeError, csv.Error) as error:
        rule = f"is not a CSV table ({error})"
        raise InputError(source, "", None, rule, "save it as CSV in UTF-8") from error
    if separator != ",":
        steps.append(f"cells are separated by {_SEPARATORS[separator]}")
    return separator, rows


def _decoded(content: bytes, steps: list[str]) -> str:
    """Return the text of UTF-8, of UTF-16 with a byte order mark, or of Windows-1252."""
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = content.decode("utf-16")
        steps.append("text is in UTF-16")
    else:
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = content.decode("cp1252")
            if not all(c.isascii() or c.isalpha() or c in _EXTRA for c in set(text)):
                raise
            steps.append("text is in Windows-1252")
    if "\0" in text:
        raise UnicodeError("it holds zero bytes")
    return text


def _separator(text: str) -> str:
    """Return the separator that the row of names shows."""
    if any(len(row) > 1 for row in _first_rows(text, ";")[:1]):
        return ";"
    # Commas may be followed by a tab for alignment, and names between tabs may hold commas.
    names = _first_rows(text, ",")[:1]
    if any("\t" in (name or "") for row in names for name in row):
        return "\t"
    # A name may hold spaces: they separate if there are as many in the row below.
    of_one = names and len(names[0]) == 1
    counts = [len(row) for row in _first_rows(text, " ")] if of_one else []
    return " " if len(counts) == 2 and counts[0] == counts[1] > 1 else ","


def _first_rows(text: str, separator: str) -> list[list[str | None]]:
    """Return the names of columns for a separator, and the row below; None for an empty cell."""
    rows = (cells for _, cells in _rows(text, separator, strict=False) if any(cells))
    return list(islice(rows, 2))


def _rows(text: str, separator: str, strict: bool) -> Iterator[tuple[int, list[Any]]]:
    """Yield the rows that are not empty, each with the number of its line."""
    # A comment, or Excel's line "sep=;", becomes an empty line: those below keep their numbers.
    lines = ("\n" if x.startswith(("#", "sep=")) else x for x in io.StringIO(text, newline=""))
    by_spaces = separator == " "
    if by_spaces:
        lines = (f"{x.strip()}\n" for x in lines)
    reader = csv.reader(lines, delimiter=separator, strict=strict, skipinitialspace=by_spaces)
    for row in reader:
        yield reader.line_num, [cell.strip() or None for cell in row]


# --- workbooks and Parquet ----------------------------------------------------------------------


def _read_workbook(source: str, content: bytes, steps: list[str]) -> _Rows:
    """Return the rows of the first sheet with cells, that of names first."""
    import pandas as pd

    try:
        with warnings.catch_warnings():  # of styles and extensions, which do not matter here
            warnings.simplefilter("ignore")
            cells: Any = {"header": None, "na_filter": False, "dtype": object}
            sheets = pd.read_excel(io.BytesIO(content), None, engine="openpyxl", **cells)
    except Exception as error:  # openpyxl raises whatever a damaged file makes it stumble over
        reason = (str(error) or type(error).__name__)[:80]  # they may quote the file
        rule = f"is not an Excel workbook ({reason})"
        raise InputError(source, "", None, rule, "save it as .xlsx or .csv") from error
    filled = {}
    for title, frame in sheets.items():
        rows = [(line, cells) for line, cells in _rows_of(frame)[1:] if any(map(_is_there, cells))]
        if rows:
            filled[title] = [each for each in rows if not str(each[1][0]).startswith("#")]
    if not filled:
        return []
    title, rows = next(iter(filled.items()))
    if len(sheets) > 1:
        steps.append(f"sheet {title!r} is read, the first of {len(sheets)} with cells")
    used = [any(map(_is_there, column)) for column in zip(*(c for _, c in rows), strict=True)]
    return [(line, list(compress(cells, used))) for line, cells in rows]


def _is_there(cell: Any) -> bool:
    return cell is not None


def _read_parquet(source: str, content: bytes, _steps: list[str]) -> _Rows:
    """Return the rows, whose cells may be of any type, that of names first as row 0."""
    require_parquet(source)
    import pandas as pd

    try:
        return _rows_of(pd.read_parquet(io.BytesIO(content)))
    except (OSError, ValueError) as error:  # of damaged contents
        rule = f"is not a Parquet table ({error})"
        raise InputError(source, "", None, rule, "write it anew, or use CSV") from error


def _plain(cell: Any) -> Any:
    """Return a cell without spaces around its text; None if it is empty."""
    return cell.strip() or None if isinstance(cell, str) else cell


# --- from cells to words and numbers ------------------------------------------------------------


def texts(table: Table, k: int) -> list[str]:
    """Return a column as words."""
    _require_filled(table, k)
    return list(map(_text, table.columns[k]))


def _text(cell: Any) -> str:
    """Return a cell as text: a number without a fraction as an integer, a day without a time."""
    whole = int(cell) if isinstance(cell, float) and cell.is_integer() else cell
    return str(whole).removesuffix(" 00:00:00")


def finite_numbers(table: Table, wanted: Sequence[int]) -> list[list[float]]:
    """Return columns as finite numbers; what marks their decimals becomes a step of the table.

    Commas mark decimals if no number has a point, and one of them can mark nothing else: "1,234"
    alone may be a thousand.
    """
    has_commas = _require_decimals(table, wanted)
    if has_commas:
        table.steps.append("decimals are marked by commas")
    return [_numbers(table, k, has_commas) for k in wanted]


def _require_decimals(table: Table, wanted: Sequence[int]) -> bool:
    """Return whether commas mark decimals; refuse marks that may be of thousands."""
    commas = _with_mark(table, wanted, ",")
    # Between commas a point is a decimal mark; a file without them may write either.
    in_doubt = bool(commas) or table.separator not in ("", ",")
    points = _with_mark(table, wanted, ".") if in_doubt else []
    for row, k, cell in [*commas, *points]:
        if cell.count(",") + cell.count(".") > 1 and _THOUSANDS.fullmatch(cell):
            raise _cell_error(table, row, k, *_NO_THOUSANDS)
    if commas and points:
        row, k, _ = commas[0]
        rule = "has a comma, and other numbers a point"
        raise _cell_error(table, row, k, rule, "write all numbers with a decimal point")
    places = commas or points
    if places and all(_GROUPED.fullmatch(cell) for _, _, cell in places):
        row, k, cell = places[0]
        rule = "may be of thousands or have decimals, as all numbers with such a mark"
        remedy = f"write it as {cell}0 if these are decimals, else leave the mark out of all"
        raise _cell_error(table, row, k, rule, remedy)
    return bool(commas)


def _with_mark(table: Table, wanted: Sequence[int], mark: str) -> list[tuple[int, int, str]]:
    """Return the row, column and text of cells with a mark."""
    return [
        (row, k, cell)
        for k in wanted
        for row, cell in enumerate(table.columns[k])
        if isinstance(cell, str) and mark in cell
    ]


def _numbers(table: Table, k: int, has_commas: bool) -> list[float]:
    cells = table.columns[k]
    if has_commas:
        cells = [c.replace(",", ".") if isinstance(c, str) else c for c in cells]
    try:
        numbers = [_number(cell) for cell in cells]
        if all(map(math.isfinite, numbers)) and bool not in set(map(type, cells)):
            return numbers
    except (TypeError, ValueError):
        pass
    _require_filled(table, k)
    row = next(row for row, cell in enumerate(cells) if not _is_number(cell))
    cell = table.columns[k][row]
    rule, remedy = "must be a finite number", "write it with a decimal point, without its unit"
    if isinstance(cell, str) and _THOUSANDS.fullmatch(cell):
        rule, remedy = _NO_THOUSANDS
    raise _cell_error(table, row, k, rule, remedy)


def _number(cell: Any) -> float:
    """Return a cell as a number, which may be NaN in Parquet."""
    return plain_number(cell) if isinstance(cell, str) else float(cell)


def _is_number(cell: Any) -> bool:
    try:
        return not isinstance(cell, bool) and math.isfinite(_number(cell))
    except (TypeError, ValueError):
        return False


def _require_filled(table: Table, k: int) -> None:
    """Raise `InputError` for the first empty cell of a column."""
    row = next((row for row, cell in enumerate(table.columns[k]) if cell is None), None)
    if row is not None:
        rule, remedy = "is empty", "fill it in, or remove the row"
        if Path(table.source).suffix.lower() == ".xlsx":
            rule = "is empty, or a formula without a stored value"
            remedy += ", or save the workbook in a spreadsheet program"
        raise _cell_error(table, row, k, rule, remedy)


def _cell_error(table: Table, row: int, k: int, rule: str, remedy: str) -> InputError:
    where = f"{table.source}, {table.row_word} {table.lines[row]}"
    return InputError(where, table.names[k], table.columns[k][row], rule, remedy)
