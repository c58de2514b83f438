"""Tables of cells, for a terminal and for a notebook."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from cylcontact.support.plain_text import brief

# The width of tables, of those with many columns this much for each.
_WIDTH, _COLUMN_WIDTH = 100, 24


class TextTable:
    """Cells under headings, as aligned text for a terminal and as HTML for a notebook."""

    def __init__(
        self, columns: Sequence[str], rows: Sequence[Sequence[str]], title: str = ""
    ) -> None:
        self.columns = [brief(column) for column in columns]
        self.rows = [[brief(cell) for cell in row] for row in rows]
        self.title = title

    def __str__(self) -> str:
        from rich.console import Console
        from rich.table import Table
        from rich.text import Text

        table = Table(box=None, pad_edge=False, header_style="")
        for index, column in enumerate(self.columns):
            table.add_column(Text(column), justify="right" if index else "left", no_wrap=True)
        for row in self.rows:
            table.add_row(*map(Text, row))
        width = max(_WIDTH, _COLUMN_WIDTH * len(self.columns))
        console = Console(width=width, color_system=None)
        with console.capture() as captured:
            console.print(table)
        return "\n".join(line.rstrip() for line in captured.get().splitlines())

    def _repr_html_(self) -> str:
        style = "text-align:left;white-space:nowrap"
        caption = f'<caption style="{style}"><b>{escape(self.title)}</b></caption>'
        head = "".join(f"<th>{escape(column)}</th>" for column in self.columns)
        body = "\n".join(
            f'<tr><th style="text-align:left">{escape(first)}</th>'
            + "".join(f"<td>{escape(cell)}</td>" for cell in cells)
            + "</tr>"
            for first, *cells in self.rows
        )
        return (
            f"<table>{caption if self.title else ''}"
            f"{f'<thead><tr>{head}</tr></thead>' if any(self.columns) else ''}"
            f"<tbody>\n{body}\n</tbody></table>"
        )
