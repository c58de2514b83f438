"""What a recipe returns, new figures, and axes with plain numbers."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedFormatter, FixedLocator, LogLocator, NullFormatter

from cylcontact.plots.style import MM_PER_INCH, figure_style, width_mm
from cylcontact.support.choices import Format

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "Drawing",
    "StyledFigure",
    "legend_below",
    "new_figure",
    "panel_title",
    "panels",
    "plain_log",
    "plain_number",
    "round_ticks",
    "save",
]

SCREEN_DPI, PRINT_DPI = 120, 300
# The same numbers give the same bytes.
_UNDATED: dict[Format, dict[str, None]] = {
    "png": {"Software": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    "svg": {"Date": None, "Creator": None},
}
# Where a format says what a picture is from.
_ORIGIN: dict[Format, str] = {"png": "Comment", "pdf": "Subject", "svg": "Source"}
# How the numbers of a figure are written as CSV. Seven significant digits are more than a figure
# can show, and fewer than round-off affects.
NUMBERS: Any = {"index": False, "float_format": "%.7g", "lineterminator": "\n"}
# Widths in mm of a legend's sample and of a letter of its text.
_SAMPLE, _LETTER = 13.0, 1.25
# In mm, with room for a caption below it on a journal's page.
_TALLEST = 205.0
# More labels than this crowd a logarithmic axis.
MOST_TICKS = 9


@dataclass(frozen=True)
class Drawing:
    """A figure, the numbers drawn in it, and its caption.

    Attributes
    ----------
    figure : matplotlib.figure.Figure
        Made without pyplot.
    table : pandas.DataFrame
        The numbers drawn, one row each, units in the columns' names.
    caption : str
        What the figure shows, for the line below it: 60 words at most.
    """

    figure: Figure
    table: pd.DataFrame
    caption: str

    def _repr_html_(self) -> str:
        """Show the figure with its caption in a notebook."""
        stream = io.BytesIO()
        with figure_style():
            self.figure.savefig(stream, format="png", dpi=SCREEN_DPI)
        picture = base64.b64encode(stream.getvalue()).decode("ascii")
        caption = escape(self.caption)
        image = f'<img alt="{caption}" src="data:image/png;base64,{picture}">'
        return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"


class StyledFigure(Figure):
    """A matplotlib figure that a notebook shows without pyplot."""

    def _repr_png_(self) -> bytes:
        stream = io.BytesIO()
        with figure_style():
            self.savefig(stream, format="png", dpi=SCREEN_DPI)
        return stream.getvalue()


def new_figure(width: str, height_mm: float) -> StyledFigure:
    """Return an empty figure, made without pyplot.

    Parameters
    ----------
    width : {"column", "page"}
        Its usual width, 90 or 190 mm; the `width` of `figure_style` takes its place.
    height_mm : float
        Its height in mm.

    Returns
    -------
    StyledFigure

    Examples
    --------
    >>> figure = new_figure("column", 60.0)
    >>> print((figure.get_size_inches() * 25.4).round(3))
    [90. 60.]
    """
    size = (width_mm(width) / MM_PER_INCH, height_mm / MM_PER_INCH)
    return StyledFigure(figsize=size, layout="constrained")


def panels(
    count: int,
    height_mm: float,
    heights: Sequence[float] = (1.0,),
    least_mm: float = 58.0,
    below_mm: float = 0.0,
    **shared: Any,
) -> tuple[StyledFigure, list[list[Axes]]]:
    """Return a figure over a page with panels side by side, as many in a row as fit.

    Parameters
    ----------
    count : int
        Number of panels.
    height_mm : float
        Height of a row of panels.
    heights : sequence of float
        The parts of a panel, one below the other with one horizontal axis, in relative heights.
    least_mm : float
        The least width of a panel: in a narrow figure the panels stand in several rows, each as
        much lower as a journal's page asks for.
    below_mm : float
        Height of a legend below all panels.
    **shared
        `sharex` and `sharey` of `Figure.subplots`.

    Returns
    -------
    figure : StyledFigure
    panels : list of list of Axes
        The parts of each panel.

    Examples
    --------
    >>> figure, parts = panels(5, 50.0, heights=(2, 1))
    >>> len(parts), len(parts[0]), len(figure.axes)
    (5, 2, 10)
    """
    in_a_row = min(count, max(1, int(width_mm("page") // least_mm)))
    rows, parts = -(-count // in_a_row), len(heights)
    figure = new_figure("page", min(rows * height_mm + below_mm, _TALLEST))
    ratios = list(heights) * rows
    grid = figure.subplots(len(ratios), in_a_row, squeeze=False, height_ratios=ratios, **shared)
    by_panel = grid.reshape(rows, parts, in_a_row).swapaxes(1, 2).reshape(-1, parts).tolist()
    for axes in chain.from_iterable(by_panel[count:]):
        axes.remove()
    for *upper, lowest in by_panel[:count]:
        for axes in upper:
            axes.sharex(lowest)
            axes.tick_params(labelbottom=False)
    return figure, by_panel[:count]


def save(figure: Figure, path: Path, form: Format, origin: str = "") -> None:
    """Write a figure at the resolution of print, undated, with what it is from in its metadata.

    It is drawn in memory first: on a full disk matplotlib's PDF fails with an error of its own.
    """
    stream = io.BytesIO()
    metadata = {**_UNDATED[form], **({_ORIGIN[form]: origin} if origin else {})}
    figure.savefig(stream, format=form, dpi=PRINT_DPI, metadata=metadata)
    path.write_bytes(stream.getvalue())


def panel_title(axes: Axes, number: int, text: str) -> None:
    """Put "(a) text" above a panel, the letter from the panel's number."""
    axes.set_title(f"({'abcdefgh'[number]}) {text}")


def legend_below(axes: Axes, ncols: int = 3, **more: Any) -> None:
    """Name what is drawn in a panel below its figure, where it hides nothing."""
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        width = axes.figure.bbox.width / axes.figure.dpi * MM_PER_INCH
        entry = _SAMPLE + _LETTER * max(map(len, labels))
        ncols = max(1, min(ncols, int(width // entry)))
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
