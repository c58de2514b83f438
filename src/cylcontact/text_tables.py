"""Reports as plain text whose tables a terminal can draw."""

from __future__ import annotations

import io
import math
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from cylcontact.plain_text import brief, visible

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Report", "TextTable", "frame_table", "joined", "pieces_of", "text_table"]

# The width of plain tables, of those with many columns this much for each.
_WIDTH, _COLUMN_WIDTH = 100, 24


class TextTable(str):
    """A table as text, with its headings and cells.

    Parameters
    ----------
    text : str
        The table as plain text.
    columns : sequence of str
        The headings.
    rows : sequence of sequence of str
        The cells, row by row.
    """

    __slots__ = ("columns", "rows")

    columns: Sequence[str]
    rows: Sequence[Sequence[str]]

    def __new__(cls, text: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> TextTable:
        """Return the text with the headings and the cells beside it."""
        table = super().__new__(cls, text)
        table.columns, table.rows = columns, rows
        return table


class Report(str):
    """Text that holds its pieces, of which some are tables; made by `joined`."""

    __slots__ = ("pieces",)

    pieces: tuple[str, ...]


def joined(parts: Iterable[str], separator: str = "\n") -> Report:
    """Return texts, tables and reports as one report; characters that are not seen are escaped.

    Examples
    --------
    >>> report = joined(["a title", text_table(["", "mm"], [("dR", "0.5")])])
    >>> print(report)
    a title
         mm
    dR  0.5
    >>> [type(piece).__name__ for piece in pieces_of(report)]
    ['str', 'str', 'TextTable']
    """
    pieces: list[str] = []
    for part in parts:
        cleaned = (p if isinstance(p, TextTable) else visible(p, "\n") for p in pieces_of(part))
        pieces += [*([separator] if pieces else []), *cleaned]
    report = Report("".join(pieces))
    report.pieces = tuple(pieces)
    return report


def pieces_of(text: str) -> Iterator[str]:
    """Yield the pieces of a report in order; any other text is one piece."""
    yield from text.pieces if isinstance(text, Report) else (text,)


def text_table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> TextTable:
    """Return an aligned table, with numbers to the right.

    Parameters
    ----------
    columns : sequence of str
        The headings.
    rows : sequence of sequence of str
        The cells, row by row.

    Returns
    -------
    TextTable
    """
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    columns, rows = list(map(brief, columns)), [list(map(brief, row)) for row in rows]
    table = Table(box=None, pad_edge=False, header_style="")
    for index, column in enumerate(columns):
        table.add_column(Text(column), justify="left" if index == 0 else "right", no_wrap=True)
    for row in rows:
        table.add_row(*map(Text, row))
    stream = io.StringIO()
    width = max(_WIDTH, _COLUMN_WIDTH * len(columns))
    Console(file=stream, width=width, color_system=None, markup=False, highlight=False).print(table)
    lines = (line.rstrip() for line in stream.getvalue().splitlines())
    return TextTable("\n".join(lines), columns, rows)


def _briefly(cell: Any) -> Any:
    """Return a text as `brief` does, and anything else as it is."""
    return brief(cell) if isinstance(cell, str) else cell


def frame_table(frame: pd.DataFrame, form: str = ".5g", index: bool = True) -> TextTable:
    """Return a DataFrame as a table, its numbers in one format and "-" for NaN.

    Parameters
    ----------
    frame : DataFrame
        The table.
    form : str, optional
        The format of floating-point numbers.
    index : bool, optional
        Whether the index is the first column.

    Returns
    -------
    TextTable
    """

    def formatted(cell: object) -> str:
        if isinstance(cell, float):
            return "-" if math.isnan(cell) else format(cell, form)
        return str(cell)

    frame = frame.rename(columns=_briefly, index=_briefly).map(_briefly)
    text = frame.to_string(
        float_format=lambda number: format(number, form), na_rep="-", index=index
    )
    cells = frame.reset_index(names="") if index else frame
    rows = [[formatted(cell) for cell in row] for row in cells.itertuples(index=False)]
    return TextTable(text, list(map(str, cells.columns)), rows)
