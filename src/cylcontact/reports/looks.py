"""What figures are drawn for: a journal's columns or slides, and a reader's own choices."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, cast

from pydantic import Field

from cylcontact.errors import InputError
from cylcontact.specs import Spec, parse_spec, read_toml

Format = Literal["png", "pdf", "svg", "pgf"]
FORMATS: tuple[Format, ...] = ("png", "pdf", "svg", "pgf")
SMALLEST_FONT, LARGEST_FONT = 4.0, 40.0  # points
NARROWEST, WIDEST = 60.0, 500.0  # mm

# Below this width panels stand below one another instead of side by side.
SIDE_BY_SIDE = 120.0  # mm


@dataclass(frozen=True)
class Look:
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
JOURNAL = Look("journal")
LOOKS: dict[str, Look] = {
    look.name: look
    for look in (
        JOURNAL,
        Look("single-column", width_mm=90.0, font_size=7.0, highest_mm=240.0),
        Look("double-column", width_mm=190.0, highest_mm=240.0),
        Look("slides", width_mm=254.0, font_size=13.0, lines=2.0, highest_mm=142.9),
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
class Choice:
    """A look and the formats to write."""

    look: Look
    formats: tuple[Format, ...] = ("png", "pdf")


def choose(
    style_file: Path | None = None,
    style: str | None = None,
    formats: tuple[str, ...] = (),
    font_size: float | None = None,
) -> Choice:
    """Return the look and formats asked for; a command line's go before a file's.

    Parameters
    ----------
    style_file : path, optional
        A TOML file with the keys of `StyleFile`; it need not exist.
    style : str, optional
        A key of `LOOKS`.
    formats : tuple of str, optional
        Of `FORMATS`.
    font_size : float, optional
        In points.

    Returns
    -------
    Choice

    Raises
    ------
    InputError
        If the file is wrong, a style or format is unknown, a size is out of range, or the font
        is not installed.

    Examples
    --------
    >>> choose(style="single-column", formats=("pdf",), font_size=9.0)
    Choice(look=Look(name='single-column', width_mm=90.0, font_size=9.0, lines=1.0,
    highest_mm=240.0, font=None), formats=('pdf',))
    """
    own = StyleFile()
    if style_file is not None and style_file.is_file():
        own = parse_spec(StyleFile, read_toml(style_file), str(style_file))
    look = LOOKS[_one_of("--style", style or own.style, tuple(LOOKS))]
    if font_size is not None and not SMALLEST_FONT <= font_size <= LARGEST_FONT:
        rule = f"must be from {SMALLEST_FONT:g} to {LARGEST_FONT:g}"
        raise InputError("report", "--font-size", font_size, rule, "give it in points")
    if own.font is not None:
        _require_font(str(style_file), own.font)
    look = replace(
        look,
        width_mm=own.width_mm or look.width_mm,
        font_size=font_size or own.font_size or look.font_size,
        lines=look.lines * (own.lines or 1.0),
        font=own.font,
    )
    wanted = formats or tuple(own.formats or ("png", "pdf"))
    return Choice(look, tuple(_as_format(form) for form in dict.fromkeys(wanted)))


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
