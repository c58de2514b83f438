"""What figures look like: journal columns or slides, colours, fonts, a user's own choices."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, cast

from cycler import cycler
from matplotlib import style as mpl_style
from pydantic import Field

from cylcontact.choices import FORMATS, Format
from cylcontact.errors import InputError
from cylcontact.spec import Spec, parse_spec, read_toml

SMALLEST_FONT, LARGEST_FONT = 4.0, 40.0  # points
NARROWEST, WIDEST = 60.0, 500.0  # mm

# Below this width panels stand below one another instead of side by side.
SIDE_BY_SIDE = 120.0  # mm


@dataclass(frozen=True)
class FigureStyle:
    """How figures are laid out, whatever they show.

    Attributes
    ----------
    name : str
        What `--style` calls it.
    width_mm : float or None
        The width of every figure; None for the width that its recipe asks for.
    font_size : float
        Of labels and titles, in points; numbers on axes and legends are an eighth smaller.
    lines : float
        Lines and markers are that many times as thick as in the journal's.
    highest_mm : float or None
        What no figure exceeds.
    font : str or None
        A font family that is installed; None for the one that comes with matplotlib.
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
    """A reader's own choices, `reports/style.toml`; all of them optional."""

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
    """Return the style and formats asked for; a command line's go before a file's.

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
    chosen = STYLES[_one_of("--style", style or own.style, tuple(STYLES))]
    if font_size is not None and not SMALLEST_FONT <= font_size <= LARGEST_FONT:
        rule = f"must be from {SMALLEST_FONT:g} to {LARGEST_FONT:g}"
        raise InputError("report", "--font-size", font_size, rule, "give it in points")
    if own.font is not None:
        _require_font(str(style_file), own.font)
    chosen = replace(
        chosen,
        width_mm=own.width_mm or chosen.width_mm,
        font_size=font_size or own.font_size or chosen.font_size,
        lines=chosen.lines * (own.lines or 1.0),
        font=own.font,
    )
    wanted = formats or tuple(own.formats or ("png", "pdf"))
    return FigureOptions(chosen, tuple(_as_format(form) for form in dict.fromkeys(wanted)))


def _as_format(form: str) -> Format:
    """Return a known format, or say which there are."""
    return cast(Format, _one_of("--format", form, FORMATS))


def _one_of(option: str, value: str, known: tuple[str, ...]) -> str:
    """Return `value`, or say what there is."""
    if value not in known:
        raise InputError("report", option, value, "is unknown", f"choose {', '.join(known)}")
    return value


def _require_font(source: str, font: str) -> None:
    """Refuse a font that matplotlib does not find."""
    from matplotlib.font_manager import findfont

    try:
        findfont(font, fallback_to_default=False)
    except ValueError:
        raise InputError(
            source, "font", font, "is not an installed font", "install it, or leave the key out"
        ) from None


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

# What depends on the style: sizes in points for text of 8 points, and lines as in the journal.
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
_CURRENT: ContextVar[FigureStyle] = ContextVar("style", default=JOURNAL)


def current_style() -> FigureStyle:
    """Return the style in force."""
    return _CURRENT.get()


@contextmanager
def figure_style(style: FigureStyle | None = None) -> Iterator[None]:
    """Apply a style's rcParams, over matplotlib's defaults, for a while.

    The defaults come first, so a reader's own matplotlibrc changes no figure.

    Parameters
    ----------
    style : FigureStyle, optional
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
    token = _CURRENT.set(style or _CURRENT.get())
    try:
        with mpl_style.context(["default", _rc(_CURRENT.get())]):
            yield
    finally:
        _CURRENT.reset(token)


def _rc(style: FigureStyle) -> dict[str, Any]:
    """Return the rcParams of a style."""
    larger = style.font_size / TEXT["font.size"]
    own = {name: size * larger for name, size in TEXT.items()}
    own |= {name: width * style.lines for name, width in LINES.items()}
    if style.font is not None:
        family = {"rm": style.font, "it": f"{style.font}:italic", "bf": f"{style.font}:bold"}
        own_font = {f"mathtext.{shape}": font for shape, font in family.items()}
        return RC | own | own_font | {"font.family": [style.font], "mathtext.fontset": "custom"}
    return RC | own


def small_text() -> float:
    """Return the size of the smaller of the two texts in a figure, in points."""
    return TEXT["legend.fontsize"] * _CURRENT.get().font_size / TEXT["font.size"]
