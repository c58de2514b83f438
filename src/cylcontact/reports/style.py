"""How figures look: journal widths, rcParams of the chosen look, axes helpers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from cycler import cycler
from matplotlib import style as mpl_style
from matplotlib.axes import Axes
from matplotlib.ticker import FixedFormatter, FixedLocator, LogLocator, NullFormatter

from cylcontact.reports.looks import JOURNAL, LOOKS, Look
from cylcontact.reports.styled_figure import StyledFigure

Width = Literal["column", "middle", "full"]

# The widths that Springer's journals print figures at, in mm.
WIDTHS_MM: dict[Width, float] = {"column": 84.0, "middle": 129.0, "full": 174.0}
MM_PER_INCH = 25.4

# Okabe and Ito's colours without the yellow, each with a line style and a marker of its own, so
# that lines stay apart for colour-blind readers and in grey.
COLOURS = ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7")
LINE_STYLES: tuple[Any, ...] = ("-", "--", "-.", (0, (1, 1)), (0, (6, 1.5, 1, 1.5, 1, 1.5)))
MARKERS = ("o", "s", "^", "D", "v")
ACCENT = COLOURS[2]
QUIET = "0.45"

# What depends on the look: sizes in points for text of 8 points, and lines as in the journal.
TEXT: dict[str, float] = {
    "font.size": 8.0,
    "axes.titlesize": 8.0,
    "axes.labelsize": 8.0,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": 7.0,
    "legend.title_fontsize": 8.0,
}
LINES: dict[str, float] = {
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "lines.linewidth": 1.1,
    "lines.markersize": 3.5,
    "lines.markeredgewidth": 0.8,
    "hatch.linewidth": 0.4,
}
RC: dict[str, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "mathtext.fontset": "dejavusans",
    "axes.titlelocation": "left",
    "legend.frameon": False,
    "legend.handlelength": 3.2,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "lines.markerfacecolor": "white",
    "axes.prop_cycle": cycler(color=COLOURS, linestyle=LINE_STYLES, marker=MARKERS),
    "pdf.fonttype": 42,
    "pdf.compression": 6,
    "svg.hashsalt": "cylcontact",
    # A document that inputs the figure sets its text in its own fonts.
    "pgf.rcfonts": False,
}
_LOOK: ContextVar[Look] = ContextVar("look", default=JOURNAL)


@contextmanager
def figure_style(look: Look | None = None) -> Iterator[None]:
    """Apply a look's rcParams, over matplotlib's defaults, for a while.

    The defaults come first, so a reader's own matplotlibrc changes no figure.

    Parameters
    ----------
    look : Look, optional
        Left out, the one in force, which is the journal's at first.

    Examples
    --------
    >>> import matplotlib as mpl
    >>> before = mpl.rcParams["pdf.fonttype"]
    >>> with figure_style():
    ...     mpl.rcParams["pdf.fonttype"]
    42
    >>> mpl.rcParams["pdf.fonttype"] == before
    True
    """
    token = _LOOK.set(look or _LOOK.get())
    try:
        with mpl_style.context(["default", _rc(_LOOK.get())]):
            yield
    finally:
        _LOOK.reset(token)


def _rc(look: Look) -> dict[str, Any]:
    """Return the rcParams of a look."""
    larger = look.font_size / TEXT["font.size"]
    own = {name: size * larger for name, size in TEXT.items()}
    own |= {name: width * look.lines for name, width in LINES.items()}
    if look.font is not None:
        family = {"rm": look.font, "it": f"{look.font}:italic", "bf": f"{look.font}:bold"}
        own_font = {f"mathtext.{style}": font for style, font in family.items()}
        return RC | own | own_font | {"font.family": [look.font], "mathtext.fontset": "custom"}
    return RC | own


def new_figure(width: Width, height_mm: float, wide: bool = False) -> StyledFigure:
    """Return an empty figure of a journal's width, apart from pyplot.

    A look with a width of its own takes it instead, and the height in proportion.

    Parameters
    ----------
    width : {"column", "middle", "full"}
        A key of `WIDTHS_MM`.
    height_mm : float
        In mm.
    wide : bool, optional
        Whether the content needs that width whatever the look: it then spans both columns.

    Returns
    -------
    StyledFigure

    Examples
    --------
    >>> figure = new_figure("column", 60.0)
    >>> print((figure.get_size_inches() * 25.4).round(3))
    [84. 60.]
    """
    look = _LOOK.get()
    if wide and look.narrow:
        look = replace(look, width_mm=LOOKS["double-column"].width_mm)
    chosen = look.width_mm or WIDTHS_MM[width]
    height = min(height_mm * chosen / WIDTHS_MM[width], look.highest_mm or np.inf)
    size = (chosen / MM_PER_INCH, height / MM_PER_INCH)
    return StyledFigure(look, figsize=size, layout="constrained")


def small_text() -> float:
    """Return the size of the smaller of the two texts in a figure, in points."""
    return TEXT["legend.fontsize"] * _LOOK.get().font_size / TEXT["font.size"]


def panel_title(axes: Axes, number: int, text: str) -> None:
    """Put "(a) text" above a panel, the letter from the panel's number."""
    axes.set_title(f"({'abcdefgh'[number]}) {text}")


def plain_log(axes: Axes, which: Literal["x", "y"], ticks: Sequence[float]) -> None:
    """Make an axis logarithmic, with ticks at the given values, written out plainly."""
    axes.set(**{f"{which}scale": "log"})
    axis = axes.xaxis if which == "x" else axes.yaxis
    axis.set_major_locator(FixedLocator(list(ticks)))
    axis.set_major_formatter(FixedFormatter([plain_number(tick) for tick in ticks]))
    axis.set_minor_locator(LogLocator(subs=range(2, 10), numticks=20))
    axis.set_minor_formatter(NullFormatter())


def plain_number(value: float) -> str:
    """Write a number without an exponent, thousands set apart from 10 000 upwards.

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
