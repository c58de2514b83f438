"""The style of figures: their width, lines, colours and font."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
from pathlib import Path
from typing import Any

from cycler import Cycler, cycler
from matplotlib import style as mpl_style
from matplotlib.font_manager import fontManager

from cylcontact.files.reading import plain_number
from cylcontact.support.errors import InputError

__all__ = [
    "ACCENT",
    "COLOURS",
    "LINE_STYLES",
    "MARKERS",
    "MM_PER_INCH",
    "QUIET",
    "WIDTHS",
    "figure_style",
    "read_width",
    "staggered",
    "width_mm",
]

MM_PER_INCH = 25.4
# Elsevier's widths of one column and of a page, in mm. Those of other journals differ little.
WIDTHS = {"column": 90.0, "page": 190.0}
_NARROWEST, _WIDEST = 60.0, 500.0  # mm
_HERE = Path(__file__).parent

# Okabe and Ito's colours without the yellow. Each has its own line style and marker, so that lines
# are distinct for colour-blind readers and in grey.
COLOURS = ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7")
LINE_STYLES: tuple[Any, ...] = ("-", "--", "-.", (0, (1, 1)), (0, (6, 1.5, 1, 1.5, 1, 1.5)))
MARKERS = ("o", "s", "^", "D", "v")
ACCENT = COLOURS[2]
QUIET = "0.45"

# The width in mm that the user asked for, and a matplotlib style of his own.
_WIDTH: ContextVar[float | None] = ContextVar("width", default=None)
_OWN: ContextVar[str | None] = ContextVar("own", default=None)


@contextmanager
def figure_style(own: str | None = None, width: float | None = None) -> Iterator[None]:
    """Apply the style of the package's figures to a `with` block.

    It starts from matplotlib's defaults, so your matplotlibrc has no effect.

    Parameters
    ----------
    own : str, optional
        A matplotlib style that is applied on top: its name, or the path of a style file.
    width : float, optional
        The width of all figures in mm; by default each figure has its own.

    Raises
    ------
    InputError
        If there is no such style.

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
    tokens = (_OWN, _OWN.set(own or _OWN.get())), (_WIDTH, _WIDTH.set(width or _WIDTH.get()))
    _add_font()
    ours: list[Any] = ["default", {"axes.prop_cycle": _unique_lines()}, _HERE / "journal.mplstyle"]
    try:
        try:
            style = mpl_style.context([*ours, *filter(None, [_OWN.get()])])
            style.__enter__()
        except (OSError, ValueError) as error:
            remedy = "give the name of a matplotlib style, or the path of a .mplstyle file"
            rule = "is not a style that matplotlib can read"
            raise InputError("figure", "--style", _OWN.get(), rule, remedy) from error
        try:
            yield
        finally:
            style.__exit__(None, None, None)
    finally:
        for variable, token in tokens:
            variable.reset(token)  # type: ignore[arg-type]


def width_mm(usual: str) -> float:
    """Return the width in mm that is asked for, else the usual one, "column" or "page"."""
    return _WIDTH.get() or WIDTHS[usual]


def read_width(text: str) -> float:
    """Return a width in mm from a name of `WIDTHS` or a number.

    Examples
    --------
    >>> read_width("column"), read_width("120")
    (90.0, 120.0)
    """
    remedy = f"give {', '.join(WIDTHS)}, or a number of mm from {_NARROWEST:g} to {_WIDEST:g}"
    try:
        width = WIDTHS[text] if text in WIDTHS else plain_number(text)
    except ValueError:
        raise InputError("figure", "--width", text, "is not a width", remedy) from None
    if not _NARROWEST <= width <= _WIDEST:
        raise InputError("figure", "--width", text, "is out of range", remedy)
    return width


def _unique_lines() -> Cycler[str, Any]:
    """Return 25 combinations of colour, line style and marker, the first five of unlike colours."""
    colours = [number % len(COLOURS) for number in range(len(COLOURS) ** 2)]
    others = [(colour + n // len(COLOURS)) % len(COLOURS) for n, colour in enumerate(colours)]
    return cycler(
        color=[COLOURS[colour] for colour in colours],
        linestyle=[LINE_STYLES[other] for other in others],
        marker=[MARKERS[other] for other in others],
    )


@lru_cache(maxsize=1)
def _add_font() -> None:
    """Make the font that comes with the package known to matplotlib, once.

    Arimo has the letters' widths of Arial and Helvetica, which journals ask for, and is free. The
    few characters that it lacks come from matplotlib's own font.
    """
    for file in sorted((_HERE / "fonts").glob("*.ttf")):
        fontManager.addfont(file)


def staggered(number: int, points: int) -> tuple[int, int]:
    """Return `markevery` of the line with this number, so that no marker hides another line's.

    Examples
    --------
    >>> staggered(0, 100), staggered(1, 100)
    ((2, 25), (6, 25))
    """
    every = points // 4
    return 2 + 4 * number % every, every
