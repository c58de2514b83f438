"""Tables: the names, units and rows in a file, whatever stands above them.

The rows are the longest run of lines in which the same cells are numbers. The names stand above
them, with a row of units above or below; of several lines of words, those that name a load and a
penetration. All other lines are listed as left out.
"""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import groupby, takewhile, zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from cylcontact.files import cells as files
from cylcontact.files.cells import (
    SEPARATOR_NAMES,
    SEPARATORS,
    Line,
    Pattern,
    RawSheet,
    is_number,
    number_and_unit,
)
from cylcontact.files.kinds import is_workbook, require_table, unpacked
from cylcontact.files.reading import read_bytes
from cylcontact.files.units import LETTER, is_unit, meaning_of, power_between
from cylcontact.support.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

# All rows are held in memory and stored in the result.
MAX_ROWS = 2_000_000
# The lines that show which cells of a row are numbers.
_SHOWN = 20_000
# The column of the block in a table of several blocks of rows.
BLOCK = "block"


@dataclass
class Sheet:
    """The cells of a file: N rows, names and units of columns, and what was decided on them.

    `read_sheet` reads one, of measurements, materials or joints. `numbers.quantity` returns a
    column by its name as numbers in the wanted unit, and `numbers.words` a column of text.
    """

    source: str
    row_word: str
    sha256: str
    separator: str = ""  # of a text; a comma also for frames, in which points mark decimals
    names: list[str] = field(default_factory=list)  # empty where the file has none
    units: list[str] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    columns: list[list[Any]] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def name(self, k: int) -> str:
        """Return the name of a column, or its position in a table without names."""
        return self.names[k] if self.names else f"column {k + 1}"

    def error(self, rule: str, remedy: str, row: int | None = None, k: int = -1) -> InputError:
        """Return the error for the table or for a cell."""
        if row is None:
            return InputError(self.source, "", None, rule, remedy)
        where = f"{self.source}, {self.row_word} {self.lines[row]}"
        return InputError(where, self.name(k), self.columns[k][row], rule, remedy)

    def numbered(self, numbers: Sequence[int]) -> str:
        """Return positions in words, as in "lines 2 to 4, 7"."""
        return listed(numbers, self.row_word)


class _Layout(NamedTuple):
    """The indices of the names and the units, -1 for none, and of the first row."""

    names: int
    units: int
    first: int
    pattern: Pattern
    known: int = 0  # how many names are given by the user, or are of load and penetration


def read_sheet(
    data: Path | str | pd.DataFrame,
    given: Collection[str] = (),
    title: str | None = None,
    header: int | None = None,
    separator: str | None = None,
    encoding: str | None = None,
) -> Sheet:
    """Read a DataFrame, a workbook, a Parquet file or, under any other name, a text.

    Parameters
    ----------
    data : path or DataFrame
        The table; a file may be compressed by gzip.
    given : collection of str
        Names of columns that the table should have.
    title : str, optional
        The sheet of a workbook; by default the first with a load and a penetration.
    header : int, optional
        The line of the names, 0 for none.
    separator, encoding : str, optional
        Those of a text; by default as its lines and bytes show.

    Raises
    ------
    InputError
        If the file is no table, or its rows have different numbers of cells.
    """
    if not isinstance(data, Path | str):
        content = data.to_csv(index=False, lineterminator="\n").encode()
        return _sheet_of_frame("DataFrame", data, hashlib.sha256(content).hexdigest())
    source, suffix = str(data), Path(data).suffix.lower()
    if suffix in (".toml", ".json"):
        raise InputError(source, "", None, "is not a table", "name a table")
    content = read_bytes(data)
    sha256, content = hashlib.sha256(content).hexdigest(), unpacked(source, content)
    if suffix == ".parquet":
        return _sheet_of_frame(source, files.frame_of_parquet(source, content), sha256)
    is_book = suffix in (".xlsx", ".xlsm") or is_workbook(content)
    sheet = Sheet(source, "row" if is_book else "line", sha256)
    if is_book:
        sheets = files.sheets_of_workbook(source, content)
    else:
        require_table(source, content)
        mark = None if separator is None else SEPARATOR_NAMES[separator]
        sheets = [files.sheet_of_text(source, content, sheet.notes, mark, encoding)]
    titles = [part.title for part in sheets if is_book]
    if title is not None and title not in titles:
        remedy = f"it has {', '.join(map(repr, titles))}" if titles else "leave it out"
        raise InputError(source, "sheet", title, "is not a sheet with cells", remedy)
    if not any(part.lines for part in sheets):
        raise sheet.error("is empty", "give it a line of column names, then rows")
    wanted = [part for part in sheets if title in (None, part.title)]
    chosen, layout = _best_sheet(sheet, wanted, len(sheets), set(given), header)
    if header and layout.names < 0:
        remedy = "give that of the names, 0 for none"
        raise InputError(source, "header", header, f"is no {sheet.row_word} with cells", remedy)
    sheet.separator = chosen.separator
    return _filled(sheet, chosen.lines, layout)


def _best_sheet(
    sheet: Sheet, sheets: list[RawSheet], count: int, given: set[str], header: int | None
) -> tuple[RawSheet, _Layout]:
    """Return the sheet with a load and a penetration, the first of several."""
    tried = [(one, _layout(one.lines, given, header)) for one in sheets]
    chosen, layout = max(tried, key=lambda pair: pair[1].known)
    if count > 1:
        alike = sum(other.known == layout.known > 1 for _, other in tried)
        also = f", the first of {alike} with such columns (--sheet)" if alike > 1 else ""
        sheet.notes.append(f"sheet {chosen.title!r} of {count}{also}")
    return chosen, layout


def _sheet_of_frame(source: str, frame: pd.DataFrame, sha256: str) -> Sheet:
    lines = [Line(0, [str(name).strip() for name in frame.columns]), *files.lines_of(frame)]
    sheet = Sheet(source, "row", sha256, ",")
    return _filled(sheet, lines, _layout(lines, set(), 0))


# --- names, units and rows ----------------------------------------------------------------------


def _layout(lines: list[Line], given: set[str], header: int | None) -> _Layout:
    """Return where the names, the units and the rows are."""
    _, pattern = files.row_pattern(lines[:_SHOWN])
    first = next((k for k, line in enumerate(lines) if _is_row(line.cells, pattern)), len(lines))

    def is_named(k: int) -> bool:
        return 0 <= k < len(lines) and _may_be_names(lines[k].cells, pattern)

    if header is None:
        # Rows between the names and the first row have an empty or a wrong cell.
        start = last = next(filter(is_named, range(first - 1, -1, -1)), -1)
        while is_named(start - 1):
            start -= 1
    else:
        start = last = next((k for k, line in enumerate(lines) if line.number == header), -1)
        while start >= 0 and is_named(last + 1):
            last += 1
    if start < 0:
        while first > 0 and _is_row(lines[first - 1].cells, pattern, may_lack=True):
            first -= 1
        return _Layout(-1, -1, first, pattern)
    run = range(start, last + 1)
    known = {k: _known_names(lines[k].cells, given) for k in run}
    names = start if header is not None else max(run, key=lambda k: (sum(known[k]), k))
    if not any(known[names]) and header is None:
        names = next((k for k in reversed(run) if not _has_units(lines[k].cells)), start)
    below = (k for k in range(names + 1, last + 1) if _has_units(lines[k].cells))
    above = (k for k in range(start, names) if all(map(is_unit, filter(None, lines[k].cells))))
    units = next(below, next(above, -1))
    return _Layout(names, units, last + 1, pattern, known[names][0] * any(pattern))


def _is_row(cells: list[Any], pattern: Pattern, may_lack: bool = False) -> bool:
    numbers = [cell for cell, is_one in zip(cells, pattern, strict=False) if is_one]
    if may_lack:
        numbers = [cell for cell in numbers if cell is not None]
    return bool(numbers) and len(cells) == len(pattern) and all(map(is_number, numbers))


def _may_be_names(cells: list[Any], pattern: Pattern) -> bool:
    words = [cell for cell in cells if cell is not None]
    is_long = len(words) >= min(len(pattern) or 1, 2) or _has_units(cells)
    return is_long and not any(map(is_number, words))


def _known_names(cells: list[Any], given: set[str]) -> tuple[int, int]:
    """Return how many names are given or of load or penetration, and how many of any quantity."""
    names = {*map(_plain, cells)}
    meanings = [x for x in map(meaning_of, names) if x is not None and x.rank < LETTER]
    measured = {"load", "penetration"} & {meaning.quantity for meaning in meanings}
    return len(given & names) + len(measured), len(meanings)


def _has_units(cells: list[Any]) -> bool:
    return any(map(is_unit, map(_plain, cells)))


def _plain(cell: Any) -> str:
    """Return a name or unit in one line, without a # or % before it unless that is all."""
    text = "" if cell is None else " ".join(str(cell).split())
    return text.lstrip("#% ") or text


def _filled(sheet: Sheet, lines: list[Line], layout: _Layout) -> Sheet:
    """Return the table with its names, units and rows."""
    below = lines[layout.first :]
    footer = [x.number for x in takewhile(partial(_is_footer, layout.pattern), below[::-1])]
    below, between, starts = _one_block(lines, layout, below[: len(below) - len(footer)])
    words = {line.cells[0] for line in below}
    rows = [line for line in below if not _is_comment(line.cells, layout.pattern, words)]
    if not rows:
        raise sheet.error("holds no rows", "give it at least one below the names")
    if len(rows) > MAX_ROWS:
        rule, remedy = f"has {len(rows)} rows (at most {MAX_ROWS})", "thin or average them"
        raise sheet.error(rule, remedy)
    names = [_plain(cell) for cell in lines[layout.names].cells] if layout.names >= 0 else []
    sizes = [len(line.cells) for line in rows]
    usual = max({*sizes}, key=sizes.count)
    while len(names) > usual and not names[-1]:
        names.pop()
    width = len(names) or usual
    _require_rectangular(sheet, rows, names, usual, layout)
    sheet.names, sheet.lines = names, [line.number for line in rows]
    columns = [list(column) for column in zip_longest(*(line.cells for line in rows))]
    sheet.columns = columns[:width] + [[None] * len(rows)] * (width - len(columns))
    sheet.units = [""] * width
    if layout.units >= 0:
        units = [_plain(cell) for cell in lines[layout.units].cells[:width]]
        sheet.units[: len(units)] = units
        sheet.notes.append(f"units from {sheet.row_word} {lines[layout.units].number}")
    _take_units_of_cells(sheet)
    heads = {layout.names, layout.units}
    above = [line.number for k, line in enumerate(lines[: layout.first]) if k not in heads]
    comments = sorted({line.number for line in below} - {*sheet.lines})
    sheet.left_out += [f"{sheet.numbered(above)} before the rows"] if above else []
    sheet.left_out += [f"{sheet.numbered(comments)} with # in front"] if comments else []
    sheet.left_out += [f"{sheet.numbered(between)} between blocks of rows"] if between else []
    sheet.left_out += [f"{sheet.numbered(footer[::-1])} below the rows"] if footer else []
    if starts and BLOCK not in sheet.names:
        sheet.names.append(BLOCK)
        sheet.units.append("")
        sheet.columns.append([1 + sum(line > start for start in starts) for line in sheet.lines])
        sheet.notes.append(f"{len(starts) + 1} blocks of rows (--group {BLOCK} takes each apart)")
    return sheet


def _one_block(
    lines: list[Line], layout: _Layout, below: list[Line]
) -> tuple[list[Line], list[int], list[int]]:
    """Return the rows of all blocks below the same names, the lines between, and those of names.

    What a machine writes above the names is repeated as well. It is no row: it has other cells.
    """
    if layout.names < 0:
        return below, [], []
    heads = [lines[k].cells for k in (layout.names, layout.units) if k >= 0]
    starts = [k for k, line in enumerate(below) if line.cells == heads[0]]
    out: set[int] = set()
    for start in starts:
        first = last = start
        while first > 0 and not _has_row(below[first - 1].cells, layout.pattern):
            first -= 1
        while last + 1 < len(below) and below[last + 1].cells in heads:
            last += 1
        out |= {*range(first, last + 1)}
    kept = [line for k, line in enumerate(below) if k not in out]
    return kept, [below[k].number for k in sorted(out)], [below[k].number for k in starts]


def _has_row(cells: list[Any], pattern: Pattern) -> bool:
    """Return whether a line may be a row, possibly with wrong cells."""
    return len(cells) == len(pattern) and any(map(is_number, cells))


def _take_units_of_cells(sheet: Sheet) -> None:
    """Take apart numbers and units where all cells of a column have both."""
    taken = []
    for k, column in enumerate(sheet.columns):
        texts = [cell for cell in column if cell is not None]
        if not (texts and isinstance(texts[0], str) and number_and_unit(texts[0])):
            continue
        pairs = [number_and_unit(cell) if isinstance(cell, str) else None for cell in texts]
        both = [pair for pair in pairs if pair is not None]
        if len(both) != len(texts):
            continue
        powers = {unit: power_between(unit, both[0][1]) for _, unit in both}
        # Of 1.500 kN among 200 N it is not clear what the point marks.
        is_clear = len(powers) == 1 or not any(files.THOUSANDS.fullmatch(n) for n, _ in both)
        if None in powers.values() or not is_clear:
            continue
        numbers = iter(_shifted(number, powers[unit] or 0) for number, unit in both)
        sheet.columns[k] = [None if cell is None else next(numbers) for cell in column]
        unit = both[0][1]
        sheet.units[k] = (
            f"{sheet.units[k]} and {unit}" if sheet.units[k] not in ("", unit) else unit
        )
        taken.append(repr(sheet.name(k)))
    sheet.notes += [f"units from the cells of {' and '.join(taken)}"] if taken else []


def _shifted(number: str, power: int) -> str:
    """Return a number times a power of ten."""
    if not power:
        return number
    digits, _, exponent = number.lower().partition("e")
    return f"{digits}e{int(exponent or 0) + power}"


def _is_footer(pattern: Pattern, line: Line) -> bool:
    """Return whether a line has words in its first cell only, and is no row of empty cells."""
    first, *others = line.cells
    is_word = isinstance(first, str) and not first.startswith("#") and not is_number(first)
    is_empty = not any(cell is not None for cell in others)
    return is_word and is_empty and (pattern[:1] == (True,) or len(line.cells) < len(pattern))


def _is_comment(cells: list[Any], pattern: Pattern, words: set[Any]) -> bool:
    """Return whether a line with # in front is no row.

    A line with the cells of a row is a row, whose first cell is a specimen #2 or Excel's #N/A;
    unless what follows the # is like the other cells of the first column: a row commented out.
    """
    first = cells[0]
    if not (isinstance(first, str) and first.startswith("#")) or is_number(first):
        return False
    others = [cell for cell, is_one in zip(cells[1:], pattern[1:], strict=False) if is_one]
    if len(cells) != len(pattern) or not any(map(is_number, others)):
        return True
    plain = first.lstrip("# ")
    return is_number(plain) if pattern[0] else plain in words


def _require_rectangular(
    sheet: Sheet, rows: list[Line], names: list[str], usual: int, layout: _Layout
) -> None:
    """Raise `InputError` for the first row with more or fewer cells than there are names."""
    width = len(names) or usual
    # LabVIEW leaves out an empty comment at the end of a row.
    least = max(usual, width) - (names[-1:] == ["Comment"])
    for number, cells in rows:
        if least <= len(cells) and not any(cell is not None for cell in cells[width:]):
            continue
        rule = f"has {counted(cells, 'cell')} for {least if len(cells) < least else width} columns"
        by = f", separated by {SEPARATORS[sheet.separator]}" if sheet.separator else ""
        by += " and points in numbers" if sheet.separator == "," else ""
        remedy = f"give every row a cell for each column{by}, begin others with #"
        later = (line.number for line in rows if _may_be_names(line.cells, layout.pattern))
        if after := next((k for k in later if k > number), 0):
            remedy += f", or read the table below with --header {after}"
        else:
            text = " ".join(str(cell) for cell in cells if cell is not None)
            remedy += files.other_separator(text, sheet.separator)
        raise InputError(f"{sheet.source}, {sheet.row_word} {number}", "", None, rule, remedy)


# --- in words -----------------------------------------------------------------------------------


def counted(items: Sequence[object], word: str) -> str:
    """Return how many there are, in words."""
    return f"{len(items)} {word}{'s' if len(items) != 1 else ''}"


def listed(numbers: Sequence[int], word: str) -> str:
    """Return positions in words.

    >>> listed([3], "line"), listed([2, 3, 4], "line"), listed([2, 5], "row")
    ('line 3', 'lines 2 to 4', 'rows 2, 5')
    """
    runs = groupby(enumerate(numbers), key=lambda pair: pair[1] - pair[0])
    ends = [[number for _, number in run] for _, run in runs]
    parts = [f"{run[0]} to {run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in ends]
    more = f", … ({len(numbers)} in all)" if len(parts) > 6 else ""
    return f"{word}{'s' if len(numbers) > 1 else ''} {', '.join(parts[:6])}{more}"
