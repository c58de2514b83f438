"""Styles of figures: matplotlib style files, the widths that go with them, colours and fonts."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal, cast

import matplotlib as mpl
from cycler import Cycler, cycler
from matplotlib import rcParams
from matplotlib import style as mpl_style
from matplotlib.font_manager import FontProperties, fontManager

from cylcontact.support.choices import FORMATS, Format
from cylcontact.support.errors import InputError

__all__ = [
    "ACCENT",
    "COLOURS",
    "DEFAULT_OPTIONS",
    "FORMATS",
    "JOURNAL",
    "LINE_STYLES",
    "MARKERS",
    "MM_PER_INCH",
    "QUIET",
    "STYLES",
    "FigureOptions",
    "FigureStyle",
    "Format",
    "Width",
    "choose",
    "figure_style",
    "small_text",
    "staggered",
    "width_mm",
]

MM_PER_INCH = 25.4
Width = Literal["column", "middle", "full"]
FOLDER = Path(__file__).parent / "styles"


@dataclass(frozen=True)
class FigureStyle:
    """The look of figures, whatever their content.

    Attributes
    ----------
    name : str
        Its name for `--style`.
    widths_mm : tuple of float
        The width of figures that ask for a column, for more, and for the whole page.
    own : path, optional
        A matplotlib style file of one's own, read over the named one.
    """

    name: str
    widths_mm: tuple[float, float, float] = (84.0, 129.0, 174.0)
    own: Path | None = None

    @property
    def settings(self) -> list[Any]:
        """What `matplotlib.style.context` takes, from matplotlib's own defaults on."""
        names = dict.fromkeys(("journal", self.name))
        files = [FOLDER / f"{name}.mplstyle" for name in names]
        return ["default", {"axes.prop_cycle": _unique_lines()}, *files, *filter(None, [self.own])]


# The journal's widths are Springer's, the columns' are Elsevier's.
JOURNAL = FigureStyle("journal")
STYLES: dict[str, FigureStyle] = {
    style.name: style
    for style in (
        JOURNAL,
        FigureStyle("single-column", (90.0, 140.0, 190.0)),
        FigureStyle("double-column", (190.0, 190.0, 190.0)),
        FigureStyle("slides", (254.0, 254.0, 254.0)),
    )
}


@dataclass(frozen=True)
class FigureOptions:
    """A style and the formats to write."""

    style: FigureStyle
    formats: tuple[Format, ...] = ("png", "pdf")


DEFAULT_OPTIONS = FigureOptions(JOURNAL)


def choose(
    own: Path | None = None, style: str | None = None, formats: tuple[str, ...] = ()
) -> FigureOptions:
    """Return the chosen style and formats.

    Parameters
    ----------
    own : path, optional
        A matplotlib style file that is read over the named style; it need not exist.
    style : str, optional
        A key of `STYLES`; by default the journal's.
    formats : tuple of str, optional
        Of `FORMATS`; by default png and pdf.

    Returns
    -------
    FigureOptions

    Raises
    ------
    InputError
        If the file is wrong, or a style or format is unknown.

    Examples
    --------
    >>> choose(style="single-column", formats=("pdf",)).style.widths_mm
    (90.0, 140.0, 190.0)
    """
    chosen = STYLES[_one_of("--style", style or JOURNAL.name, tuple(STYLES))]
    if own is not None and own.is_file():
        _require_style(own)
        chosen = replace(chosen, own=own)
    names = dict.fromkeys(_one_of("--format", form, FORMATS) for form in formats)
    return FigureOptions(chosen, tuple(cast(Format, form) for form in names or ("png", "pdf")))


def _one_of(option: str, value: str, known: tuple[str, ...]) -> str:
    """Return `value`, or raise `InputError` with the known values."""
    if value not in known:
        raise InputError("figure", option, value, "is unknown", f"choose {', '.join(known)}")
    return value


def _require_style(file: Path) -> None:
    """Raise `InputError` for a file that matplotlib does not read as a style."""
    remedy = "write it as matplotlib describes style sheets"
    try:
        with warnings.catch_warnings(action="error"):
            mpl.rc_params_from_file(file, fail_on_error=True, use_default_template=False)
    except (ValueError, UnicodeError, Warning) as error:
        rule = f"is not a matplotlib style ({error})"
        raise InputError(str(file), "", None, rule, remedy) from error


# Okabe and Ito's colours without the yellow. Each has its own line style and marker, so that lines
# are distinct for colour-blind readers and in grey.
COLOURS = ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7")
LINE_STYLES: tuple[Any, ...] = ("-", "--", "-.", (0, (1, 1)), (0, (6, 1.5, 1, 1.5, 1, 1.5)))
MARKERS = ("o", "s", "^", "D", "v")
ACCENT = COLOURS[2]
QUIET = "0.45"


def _unique_lines() -> Cycler[str, Any]:
    """Return 25 combinations of colour, line style and marker, the first five of unlike colours."""
    colours = [number % len(COLOURS) for number in range(len(COLOURS) ** 2)]
    others = [(colour + n // len(COLOURS)) % len(COLOURS) for n, colour in enumerate(colours)]
    return cycler(
        color=[COLOURS[colour] for colour in colours],
        linestyle=[LINE_STYLES[other] for other in others],
        marker=[MARKERS[other] for other in others],
    )


_CURRENT: ContextVar[FigureStyle] = ContextVar("style", default=JOURNAL)


def width_mm(width: Width, style: FigureStyle | None = None) -> float:
    """Return a width in a style, by default the one in force."""
    return (style or _CURRENT.get()).widths_mm[("column", "middle", "full").index(width)]


@contextmanager
def figure_style(style: FigureStyle | None = None) -> Iterator[None]:
    """Apply a style to a `with` block.

    It starts from matplotlib's defaults, so a user's matplotlibrc changes no figure.

    Parameters
    ----------
    style : FigureStyle, optional
        By default the style in force, which is initially the journal's.

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
    token = _CURRENT.set(style or _CURRENT.get())
    _add_font()
    try:
        with mpl_style.context(_CURRENT.get().settings):
            yield
    finally:
        _CURRENT.reset(token)


@lru_cache(maxsize=1)
def _add_font() -> None:
    """Make the font that comes with the package known to matplotlib, once.

    Arimo has the letters' widths of Arial and Helvetica, which journals ask for, and is free. The
    few characters that it lacks come from matplotlib's own font.
    """
    for file in sorted((Path(__file__).parent / "fonts").glob("*.ttf")):
        fontManager.addfont(file)


def small_text() -> float:
    """Return the size of tick labels and legends in points."""
    return float(FontProperties(size=rcParams["legend.fontsize"]).get_size_in_points())


def staggered(number: int, points: int) -> tuple[int, int]:
    """Return `markevery` of the line with this number, so that no marker hides another line's.

    Examples
    --------
    >>> staggered(0, 100), staggered(1, 100)
    ((2, 25), (6, 25))
    """
    every = points // 4
    return 2 + 4 * number % every, every
