"""Styles of figures: widths, colours and fonts, and the choices in a style file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal, cast

from cycler import Cycler, cycler
from matplotlib import style as mpl_style
from matplotlib.font_manager import fontManager
from pydantic import Field

from cylcontact.choices import FORMATS, Format
from cylcontact.errors import InputError
from cylcontact.spec import Spec, parse_spec, read_toml

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
    "WIDTHS_MM",
    "FigureOptions",
    "FigureStyle",
    "Format",
    "StyleFile",
    "Width",
    "choose",
    "current_style",
    "figure_style",
    "small_text",
    "staggered",
]

SMALLEST_FONT, LARGEST_FONT = 4.0, 40.0  # points
NARROWEST, WIDEST = 60.0, 500.0  # mm

# Below this width panels are stacked instead of side by side.
SIDE_BY_SIDE = 120.0  # mm


@dataclass(frozen=True)
class FigureStyle:
    """The layout of figures, whatever their content.

    Attributes
    ----------
    name : str
        Its name for `--style`.
    width_mm : float or None
        The width of every figure; None for the recipe's own width.
    font_size : float
        Size of labels and titles in points; tick labels and legends are an eighth smaller.
    lines : float
        Thickness of lines and markers relative to the journal's.
    highest_mm : float or None
        The greatest height of a figure.
    font : str or None
        An installed font family; None for Arimo, which has the widths of Arial and Helvetica.
    """

    name: str
    width_mm: float | None = None
    font_size: float = 8.0
    lines: float = 1.0
    highest_mm: float | None = None
    font: str | None = None

    @property
    def narrow(self) -> bool:
        """Whether there is no room for panels side by side."""
        return self.width_mm is not None and self.width_mm < SIDE_BY_SIDE


# `journal` keeps each recipe's own width of Springer's three; the others are Elsevier's columns
# and a widescreen slide of 254 mm by 143 mm.
JOURNAL = FigureStyle("journal")
STYLES: dict[str, FigureStyle] = {
    style.name: style
    for style in (
        JOURNAL,
        FigureStyle("single-column", width_mm=90.0, font_size=7.0, highest_mm=240.0),
        FigureStyle("double-column", width_mm=190.0, highest_mm=240.0),
        FigureStyle("slides", width_mm=254.0, font_size=13.0, lines=2.0, highest_mm=142.9),
    )
}


class StyleFile(Spec):
    """A user's choices in `reports/style.toml`, all optional."""

    style: Literal["journal", "single-column", "double-column", "slides"] = Field(
        "journal", description="the style to start from"
    )
    width_mm: float | None = Field(
        None, ge=NARROWEST, le=WIDEST, description="the width of every figure in mm"
    )
    font_size: float | None = Field(
        None, ge=SMALLEST_FONT, le=LARGEST_FONT, description="the size of labels in points"
    )
    lines: float | None = Field(
        None, ge=0.2, le=10.0, description="the thickness of lines, times the style's"
    )
    font: str | None = Field(None, description="a font family that is installed")
    formats: list[Format] | None = Field(None, min_length=1, description="what to write")


@dataclass(frozen=True)
class FigureOptions:
    """A style and the formats to write."""

    style: FigureStyle
    formats: tuple[Format, ...] = ("png", "pdf")


DEFAULT_OPTIONS = FigureOptions(JOURNAL)


def choose(
    style_file: Path | None = None,
    style: str | None = None,
    formats: tuple[str, ...] = (),
    font_size: float | None = None,
) -> FigureOptions:
    """Return the chosen style and formats; the command line overrides the file.

    Parameters
    ----------
    style_file : path, optional
        A TOML file with the keys of `StyleFile`; it need not exist.
    style : str, optional
        A key of `STYLES`.
    formats : tuple of str, optional
        Of `FORMATS`.
    font_size : float, optional
        In points.

    Returns
    -------
    FigureOptions

    Raises
    ------
    InputError
        If the file is wrong, a style or format is unknown, a size is out of range, or the font
        is not installed.

    Examples
    --------
    >>> choose(style="single-column", formats=("pdf",), font_size=9.0)
    FigureOptions(style=FigureStyle(name='single-column', width_mm=90.0, font_size=9.0, lines=1.0,
    highest_mm=240.0, font=None), formats=('pdf',))
    """
    own = StyleFile()
    if style_file is not None and style_file.is_file():
        own = parse_spec(StyleFile, read_toml(style_file), str(style_file))
    base = STYLES[_one_of("--style", style or own.style, tuple(STYLES))]
    if font_size is not None and not SMALLEST_FONT <= font_size <= LARGEST_FONT:
        rule = f"must be from {SMALLEST_FONT:g} to {LARGEST_FONT:g}"
        raise InputError("figure", "--font-size", font_size, rule, "give it in points")
    if own.font is not None:
        _require_font(str(style_file), own.font)
    figure_style = replace(
        base,
        width_mm=own.width_mm or base.width_mm,
        font_size=font_size or own.font_size or base.font_size,
        lines=base.lines * (own.lines or 1.0),
        font=own.font,
    )
    names = formats or tuple(own.formats or ("png", "pdf"))
    return FigureOptions(figure_style, tuple(_as_format(form) for form in dict.fromkeys(names)))


def _as_format(form: str) -> Format:
    """Return a format, or raise `InputError` with the known ones."""
    return cast(Format, _one_of("--format", form, FORMATS))


def _one_of(option: str, value: str, known: tuple[str, ...]) -> str:
    """Return `value`, or raise `InputError` with the known values."""
    if value not in known:
        raise InputError("figure", option, value, "is unknown", f"choose {', '.join(known)}")
    return value


def _require_font(source: str, font: str) -> None:
    """Raise `InputError` for a font that matplotlib does not find."""
    from matplotlib.font_manager import findfont

    try:
        findfont(font, fallback_to_default=False)
    except ValueError:
        raise InputError(
            source, "font", font, "is not an installed font", "install it, or leave the key out"
        ) from None


Width = Literal["column", "middle", "full"]

# The widths of figures in Springer's journals, in mm.
WIDTHS_MM: dict[Width, float] = {"column": 84.0, "middle": 129.0, "full": 174.0}
MM_PER_INCH = 25.4

# Okabe and Ito's colours without the yellow. Each has its own line style and marker, so that lines
# are distinct for colour-blind readers and in grey.
COLOURS = ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7")
LINE_STYLES: tuple[Any, ...] = ("-", "--", "-.", (0, (1, 1)), (0, (6, 1.5, 1, 1.5, 1, 1.5)))
MARKERS = ("o", "s", "^", "D", "v")


def _unique_lines() -> Cycler[str, Any]:
    """Return 25 combinations of colour, line style and marker, the first five of unlike colours."""
    colours = [number % len(COLOURS) for number in range(len(COLOURS) ** 2)]
    others = [(colour + n // len(COLOURS)) % len(COLOURS) for n, colour in enumerate(colours)]
    return cycler(
        color=[COLOURS[colour] for colour in colours],
        linestyle=[LINE_STYLES[other] for other in others],
        marker=[MARKERS[other] for other in others],
    )


ACCENT = COLOURS[2]
QUIET = "0.45"

# Sizes in points that scale with the font size from 8 points, and widths that scale with `lines`.
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
# Arimo has the letters' widths of Arial and Helvetica, which journals ask for, and is free. The few
# characters that it lacks come from matplotlib's own font.
FONTS = Path(__file__).parent / "fonts"
FONT = "Arimo"
RC: dict[str, Any] = {
    "mathtext.fontset": "custom",
    "mathtext.fallback": "stixsans",
    "axes.titlelocation": "left",
    "legend.frameon": False,
    "legend.handlelength": 3.2,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "lines.markerfacecolor": "white",
    "axes.prop_cycle": _unique_lines(),
    "pdf.fonttype": 42,
    "pdf.compression": 6,
    "svg.hashsalt": "cylcontact",
    # A document that inputs the figure sets its text in its own fonts.
    "pgf.rcfonts": False,
}
_CURRENT: ContextVar[FigureStyle] = ContextVar("style", default=JOURNAL)


def current_style() -> FigureStyle:
    """Return the style in force."""
    return _CURRENT.get()


@contextmanager
def figure_style(style: FigureStyle | None = None) -> Iterator[None]:
    """Apply a style's rcParams to a `with` block.

    They start from matplotlib's defaults, so a user's matplotlibrc changes no figure.

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
    try:
        with mpl_style.context(["default", _rc(_CURRENT.get())]):
            yield
    finally:
        _CURRENT.reset(token)


def _rc(style: FigureStyle) -> dict[str, Any]:
    """Return the rcParams of a style."""
    larger = style.font_size / TEXT["font.size"]
    own: dict[str, Any] = {name: size * larger for name, size in TEXT.items()}
    own |= {name: width * style.lines for name, width in LINES.items()}
    _add_font()
    font = style.font or FONT
    formulas = {"rm": font, "it": f"{font}:italic", "sf": font, "cal": f"{font}:italic"}
    own |= {f"mathtext.{shape}": name for shape, name in formulas.items()}
    return RC | own | {"font.family": [font, "DejaVu Sans"]}


@lru_cache(maxsize=1)
def _add_font() -> None:
    """Make the font that comes with the package known to matplotlib, once."""
    for file in sorted(FONTS.glob("*.ttf")):
        fontManager.addfont(file)


def small_text() -> float:
    """Return the size of tick labels and legends in points."""
    return TEXT["legend.fontsize"] * _CURRENT.get().font_size / TEXT["font.size"]


def staggered(number: int, points: int) -> tuple[int, int]:
    """Return `markevery` of the line with this number, so that no marker hides another line's.

    Examples
    --------
    >>> staggered(0, 100), staggered(1, 100)
    ((2, 25), (6, 25))
    """
    every = points // 4
    return 2 + 4 * number % every, every
