"""Figures that arrange themselves for the style they are drawn in, and what a recipe returns."""

from __future__ import annotations

import base64
import io
import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any, Literal

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.text import Text
from matplotlib.ticker import FixedFormatter, FixedLocator, LogLocator, NullFormatter

from cylcontact.plots.style import (
    JOURNAL,
    MM_PER_INCH,
    WIDTHS_MM,
    FigureStyle,
    Width,
    current_style,
    figure_style,
    small_text,
)

__all__ = [
    "Drawing",
    "StyledFigure",
    "figure_of_lines",
    "new_figure",
    "panel_title",
    "plain_log",
    "plain_number",
    "round_ticks",
]

SCREEN_DPI = 120
# Largest height of a stacked panel, relative to its width.
PANEL_HEIGHT = 0.68
# Text that does not fit shrinks by this factor, the smallest to no less than these points.
SMALLEST, SHRINKING = 6.0, 0.97
# A legend with this many lines leaves no room in a narrow panel.
LONG = 5
# Height of a line of a table, relative to the size of its text.
LINE, POINTS_PER_INCH = 1.4, 72.0
# More labels than this crowd a logarithmic axis.
MOST_TICKS = 9


@dataclass(frozen=True)
class Drawing:
    """A figure, the numbers drawn in it, the ones that sum it up, and its caption.

    Attributes
    ----------
    figure : matplotlib.figure.Figure
        Made without pyplot.
    table : pandas.DataFrame
        The numbers drawn, one row each, units in the columns' names.
    headline : mapping of str to float
        The main results, which tests check.
    caption : str
        What the figure shows, for the line below it: 60 words at most.
    method : str
        How it was made: choices, assumptions, coefficients and sources, for a note beside it.
    """

    figure: Figure
    table: pd.DataFrame
    headline: Mapping[str, float]
    caption: str
    method: str = ""

    def _repr_html_(self) -> str:
        """Show the figure with its caption in a notebook."""
        stream = io.BytesIO()
        with figure_style():
            self.figure.savefig(stream, format="png", dpi=SCREEN_DPI)
        picture = base64.b64encode(stream.getvalue()).decode("ascii")
        caption = escape(self.caption)
        image = f'<img alt="{caption}" src="data:image/png;base64,{picture}">'
        note = f"<p><small>{escape(self.method)}</small></p>" if self.method else ""
        return f"<figure>{image}<figcaption>{caption}{note}</figcaption></figure>"


class StyledFigure(Figure):
    """A matplotlib figure whose panels, titles and legends fit the style's width.

    In a narrow style, panels side by side are stacked, legends have fewer columns and titles more
    lines. The recipe stays the same.

    Parameters
    ----------
    style : FigureStyle
        The style of the figure.
    **settings
        Those of `matplotlib.figure.Figure`.

    Examples
    --------
    >>> narrow = FigureStyle("narrow", width_mm=90.0, highest_mm=240.0)
    >>> figure = StyledFigure(narrow, figsize=(90 / 25.4, 40 / 25.4), layout="constrained")
    >>> panels = figure.subplots(1, 3, sharey=True)
    >>> panels.shape, [axes.get_subplotspec().rowspan.start for axes in panels]
    ((3,), [0, 1, 2])
    """

    def __init__(self, style: FigureStyle, **settings: Any) -> None:
        super().__init__(**settings)
        self.style = style

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook, which knows only figures of pyplot by itself."""
        stream = io.BytesIO()
        with figure_style():
            self.savefig(stream, format="png", dpi=SCREEN_DPI)
        return stream.getvalue()

    def subplots(self, nrows: int = 1, ncols: int = 1, **settings: Any) -> Any:
        """Add panels as `Figure.subplots` does, in one column where the style is narrow.

        They are then ordered column by column; with `by_rows=True`, row by row.
        """
        by_rows = settings.pop("by_rows", False)
        if not self.style.narrow or ncols == 1:
            return super().subplots(nrows, ncols, **settings)
        squeeze = settings.pop("squeeze", True)
        self._grow(nrows, ncols)
        panels = self._stack(nrows, ncols, settings, by_rows)
        if not squeeze:
            return panels
        return panels.item() if panels.size == 1 else panels.squeeze()

    def legend(self, *args: Any, **settings: Any) -> Legend:
        """Add a legend as `Figure.legend` does, with as many columns as fit on the page."""
        legend = super().legend(*args, **settings)
        columns = settings.get("ncols", 1)
        while columns > 1 and legend.get_window_extent().width > self.bbox.width:
            legend.remove()
            columns -= 1
            legend = super().legend(*args, **settings | {"ncols": columns})
        return legend

    def draw_without_rendering(self) -> None:
        """Settle the layout, once; in styles other than the journal's, first make texts fit."""
        if self.get_layout_engine() is None:
            super().draw_without_rendering()
            return
        if self.style == JOURNAL:
            super().draw_without_rendering()
        else:
            self._fit_texts()
        self.set_layout_engine(None)

    def _fit_texts(self) -> None:
        """Settle the layout with texts broken, and if need be smaller, to fit the page."""
        self._settles()
        self._move_legend()
        for axes in self.axes:
            _repeat_label(axes)
            _break_texts(axes, self.bbox.x1)
        size = small_text() * SHRINKING
        while not self._settles() and size >= SMALLEST:
            size *= SHRINKING
            for text in self.findobj(Text):
                text.set_fontsize(SHRINKING * float(text.get_fontsize()))

    def _move_legend(self) -> None:
        """Put the long legend of a single narrow panel below it."""
        legend = self.axes[0].get_legend() if len(self.axes) == 1 and self.style.narrow else None
        if legend is None or len(legend.get_texts()) < LONG:
            return
        handles = [handle for handle in legend.legend_handles if handle is not None]
        labels = [text.get_text() for text in legend.get_texts()]
        title = legend.get_title().get_text()
        legend.remove()
        self.legend(handles, labels, title=title, loc="outside lower center", ncols=2)

    def _settles(self) -> bool:
        """Settle the layout and return whether everything is inside the page."""
        with warnings.catch_warnings(record=True) as collapsed:
            warnings.simplefilter("always")
            super().draw_without_rendering()
        drawn, page = self.get_tightbbox(), self.bbox_inches
        inside = min(drawn.x0, drawn.y0) >= 0 and drawn.x1 <= page.x1 and drawn.y1 <= page.y1
        return bool(inside and not collapsed)

    def _grow(self, rows: int, columns: int) -> None:
        """Make room for the stacked panels of all columns."""
        width, height = self.get_size_inches()
        panel = min(height * columns, PANEL_HEIGHT * width * max(1.0, 0.75 * rows))
        highest = (self.style.highest_mm or np.inf) / MM_PER_INCH
        self.set_size_inches(width, min(panel * columns, highest))

    def _stack(self, rows: int, columns: int, settings: dict[str, Any], by_rows: bool) -> Any:
        """Return axes of shape (rows, columns), stacked in one column in the given order."""
        sharex, sharey = settings.get("sharex", False), settings.get("sharey", False)
        places = np.arange(rows * columns).reshape((rows, columns) if by_rows else (columns, rows))
        places = places if by_rows else places.T
        heights = np.empty(rows * columns)
        heights[places] = np.reshape(settings.get("height_ratios") or [1] * rows, (rows, 1))
        grid = self.add_gridspec(rows * columns, 1, height_ratios=list(heights))
        panels = np.empty((rows, columns), dtype=object)
        for column in range(columns):
            for row in range(rows):
                shared = {
                    "sharex": _leader(panels, row, column, sharex),
                    "sharey": _leader(panels, row, column, sharey),
                }
                axes = self.add_subplot(grid[int(places[row, column])], **shared)
                # The panel below shows the numbers for those above it in its column.
                axes.tick_params(labelbottom=row == rows - 1 or not sharex)
                panels[row, column] = axes
        return panels


def _leader(panels: Any, row: int, column: int, share: bool | str) -> Axes | None:
    """Return the panel whose axis this one shares; `share` is as in `Figure.subplots`."""
    first = {
        "col": panels[0, column],
        "row": panels[row, 0],
        "all": panels[0, 0],
        True: panels[0, 0],
    }
    leader: Axes | None = first.get(share)
    return leader


def _repeat_label(axes: Axes) -> None:
    """Repeat the label of a shared vertical axis on a panel that is stacked below it."""
    leader: Axes | None = axes._sharey  # type: ignore[attr-defined]
    if leader is not None and axes.yaxis.get_tick_params().get("labelleft", True):
        axes.set_ylabel(axes.get_ylabel() or leader.get_ylabel())


def _break_texts(axes: Axes, right: float) -> None:
    """Break a panel's title at the page's right edge, and its labels at the ends of its axes."""
    for title in (axes._left_title, axes.title):  # type: ignore[attr-defined]
        _break(title, right - title.get_window_extent().x0)
    _break(axes.xaxis.label, 1.3 * axes.bbox.width)
    _break(axes.yaxis.label, 1.1 * axes.bbox.height)


def _break(text: Text, room: float) -> None:
    """Break a text that is longer than `room` pixels."""
    box = text.get_window_extent()
    if max(box.width, box.height) > room > 0:
        text.set_text(_broken(text, room))


def _broken(title: Text, room: float) -> str:
    """Return a text with line breaks so that no line is wider than `room` pixels.

    Formulas between dollar signs stay whole.
    """
    words = re.findall(r"(?:\$[^$]*\$|\S)+", title.get_text())
    trial = Text(0, 0, "", fontproperties=title.get_fontproperties(), figure=title.figure)
    lines = [words[0]]
    for word in words[1:]:
        trial.set_text(f"{lines[-1]} {word}")
        if trial.get_window_extent().width <= room:
            lines[-1] = trial.get_text()
        else:
            lines.append(word)
    return "\n".join(lines)


def new_figure(width: Width, height_mm: float) -> StyledFigure:
    """Return an empty figure of a journal's width, without pyplot.

    A style with its own width replaces that width, and scales the height in proportion.

    Parameters
    ----------
    width : {"column", "middle", "full"}
        A key of `WIDTHS_MM`.
    height_mm : float
        In mm.

    Returns
    -------
    StyledFigure

    Examples
    --------
    >>> figure = new_figure("column", 60.0)
    >>> print((figure.get_size_inches() * 25.4).round(3))
    [84. 60.]
    """
    style = current_style()
    width_mm = style.width_mm or WIDTHS_MM[width]
    height = min(height_mm * width_mm / WIDTHS_MM[width], style.highest_mm or np.inf)
    size = (width_mm / MM_PER_INCH, height / MM_PER_INCH)
    return StyledFigure(style, figsize=size, layout="constrained")


def figure_of_lines(width: Width, lines: float) -> StyledFigure:
    """Return an empty figure with the height of so many lines of small text.

    Parameters
    ----------
    width : {"column", "middle", "full"}
        A key of `WIDTHS_MM`.
    lines : float
        With those of titles, axes and legends.

    Returns
    -------
    StyledFigure

    Examples
    --------
    >>> figure = figure_of_lines("column", 12)
    >>> print((figure.get_size_inches() * 25.4).round(3))
    [84.    41.487]
    """
    figure = new_figure(width, 1.0)
    height = lines * LINE * small_text() / POINTS_PER_INCH
    highest = (figure.style.highest_mm or np.inf) / MM_PER_INCH
    figure.set_figheight(min(height, highest))
    return figure


def panel_title(axes: Axes, number: int, text: str) -> None:
    """Put "(a) text" above a panel, the letter from the panel's number."""
    axes.set_title(f"({'abcdefgh'[number]}) {text}")


def plain_log(axes: Axes, which: Literal["x", "y"], ticks: Sequence[float]) -> None:
    """Make an axis logarithmic, with ticks at the given values and plain labels."""
    axes.set(**{f"{which}scale": "log"})
    axis = axes.xaxis if which == "x" else axes.yaxis
    axis.set_major_locator(FixedLocator(list(ticks)))
    axis.set_major_formatter(FixedFormatter([plain_number(tick) for tick in ticks]))
    axis.set_minor_locator(LogLocator(subs=range(2, 10), numticks=20))
    axis.set_minor_formatter(NullFormatter())


def round_ticks(low: float, high: float) -> tuple[float, ...]:
    """Return 1, 2, 5, 10, ... between two bounds; powers of ten alone if those are too many.

    Examples
    --------
    >>> round_ticks(0.0075, 0.2), round_ticks(3.0, 2e4)
    ((0.01, 0.02, 0.05, 0.1, 0.2), (10.0, 100.0, 1000.0, 10000.0))
    """
    decades = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    ticks = [float(f"{digit}e{decade}") for decade in decades for digit in (1, 2, 5)]
    inside = tuple(tick for tick in ticks if low <= tick <= high)
    return inside if len(inside) <= MOST_TICKS else tuple(t for t in inside if f"{t:e}"[0] == "1")


def plain_number(value: float) -> str:
    """Write a number without an exponent, with a thin space between thousands from 10 000.

    Examples
    --------
    >>> plain_number(0.0075), plain_number(1000)
    ('0.0075', '1000')
    >>> len(plain_number(10000))
    6
    """
    if abs(value) < 1e4:
        return np.format_float_positional(value, precision=6, trim="-")
    return f"{value:,.0f}".replace(",", "\u2009")
