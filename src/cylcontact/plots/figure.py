"""What a recipe returns, new figures, and axes with plain numbers."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any, Literal

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedFormatter, FixedLocator, LogLocator, NullFormatter

from cylcontact.plots.style import (
    JOURNAL,
    MM_PER_INCH,
    Width,
    figure_style,
    small_text,
    width_mm,
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
    """A matplotlib figure that a notebook shows without pyplot."""

    def _repr_png_(self) -> bytes:
        stream = io.BytesIO()
        with figure_style():
            self.savefig(stream, format="png", dpi=SCREEN_DPI)
        return stream.getvalue()


def new_figure(width: Width, height_mm: float) -> StyledFigure:
    """Return an empty figure of a width of the style in force, without pyplot.

    Parameters
    ----------
    width : {"column", "middle", "full"}
        In the journal's style 84, 129 and 174 mm.
    height_mm : float
        In the journal's style, in mm; another style's is in proportion to its width.

    Returns
    -------
    StyledFigure

    Examples
    --------
    >>> figure = new_figure("column", 60.0)
    >>> print((figure.get_size_inches() * 25.4).round(3))
    [84. 60.]
    """
    wide = width_mm(width)
    larger = wide / width_mm(width, JOURNAL)
    size = (wide / MM_PER_INCH, larger * height_mm / MM_PER_INCH)
    return StyledFigure(figsize=size, layout="constrained")


def figure_of_lines(width: Width, lines: float) -> StyledFigure:
    """Return an empty figure with the height of so many lines of small text.

    Parameters
    ----------
    width : {"column", "middle", "full"}
        As for `new_figure`.
    lines : float
        With those of titles, axes and legends.

    Returns
    -------
    StyledFigure

    Examples
    --------
    >>> with figure_style():
    ...     figure = figure_of_lines("column", 12)
    >>> print((figure.get_size_inches() * 25.4).round(3))
    [84.    41.487]
    """
    figure = new_figure(width, 1.0)
    figure.set_figheight(lines * LINE * small_text() / POINTS_PER_INCH)
    return figure


def panel_title(axes: Axes, number: int, text: str) -> None:
    """Put "(a) text" above a panel, the letter from the panel's number."""
    axes.set_title(f"({'abcdefgh'[number]}) {text}")


def legend_below(axes: Axes, ncols: int = 3, **more: Any) -> None:
    """Name what is drawn in a panel below its figure, where it hides nothing."""
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        axes.figure.legend(handles, labels, loc="outside lower center", ncols=ncols, **more)


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
