"""One page of an answer, to sign and file: sketch, inputs, answer, picture, assumptions."""

from __future__ import annotations

import io
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matplotlib.lines import Line2D

from cylcontact.bodies.material import Material, shipped_materials
from cylcontact.files.provenance import spec_hash
from cylcontact.files.writing import replacing, require_suffix
from cylcontact.plots.figure import StyledFigure, new_figure
from cylcontact.plots.style import figure_style
from cylcontact.support.text_tables import TextTable

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SUFFIXES = (".html", ".pdf", ".png")
# A sheet of A4 with its margins, in mm, and the dots per inch of a picture of it.
_WIDTH, _HEIGHT, _DPI = 190.0, 272.0, 200
# In mm: a line of text for each point of its size, the gap below lines, a letter of 7 points, the
# place of what is signed, and the least height of a picture.
_LINE, _GAP, _LETTER, _FOOT, _LEAST = 0.445, 1.9, 1.36, 22.0, 42.0
# By how much texts are made smaller, one after the other, until all has room.
_SMALLER = (1.0, 1.1, 1.2, 1.35, 1.5)
# Columns of an answer beside which the sections stand.
_FEW = 3
# A blank at which no line breaks.
_FIXED = "\u00a0"
_STYLE = """
body { font: 14px/1.45 system-ui, sans-serif; max-width: 60rem; margin: 1.5rem auto;
  padding: 0 1rem; }
h1 { font-size: 1.4rem; margin-bottom: .2rem; } h2 { font-size: 1rem; margin: 1.2rem 0 .3rem; }
.side { display: flex; flex-wrap: wrap; gap: 1.5rem; } .side > * { flex: 1 1 20rem; }
svg { max-width: 100%; height: auto; } table { border-collapse: collapse; }
td, th { padding: .12rem .7rem .12rem 0; text-align: right; vertical-align: top; }
td:first-child, th:first-child, .inputs td { text-align: left; font-weight: normal; }
tr { border-bottom: 1px solid #8884; }
.warning { border-left: 4px solid #D55E00; padding-left: .6rem; }
footer { margin-top: 2rem; color: #666; font-size: 12px; }
@media print { body { margin: 0; font-size: 11px; } }
"""


# What is left to be written by hand.
_TO_FILL = ("joint, drawing no.", "checked by", "approved by", "date")

Draw = Callable[["Axes"], Any]
Source = tuple[str, str, str]


@dataclass(frozen=True)
class Page:
    """What a page shows.

    Attributes
    ----------
    kind, title : str
        What was checked, in general and here.
    sketch, picture : callable
        Draw into axes; a page may have no picture.
    inputs : sequence of (str, str, str)
        What the answer is computed from: its name, its value, and where that is from.
    headings, rows : sequence
        The numbers of the answer, with a name for each column unless there is only one.
    words, warnings : sequence of str
        What the numbers do not say.
    sections : dict
        Headings and their lines: what is assumed, what is not included.
    """

    kind: str
    title: str
    sketch: Draw
    picture: Draw | None
    inputs: Sequence[Source]
    headings: Sequence[str]
    rows: Sequence[Sequence[str]]
    words: Sequence[str]
    warnings: Sequence[str]
    sections: Mapping[str, Sequence[str]]

    @property
    def fingerprint(self) -> str:
        """The version of the program, and a hash of the inputs."""
        data = {"rows": [list(row) for row in self.inputs]}
        return f"cylcontact {version('cylcontact')}, inputs {spec_hash(data)}"


def numbers_of_material(body: Material) -> tuple[str, str]:
    """Return the numbers of a material, and where they are from."""
    parts = [f"E = {float(body.E) / 1e3:.4g} GPa", f"ν = {float(body.nu):.3g}"]
    if body.yield_stress is not None:
        parts.append(f"σ_Y = {body.yield_stress:g} MPa")
    if body.thermal_expansion is not None:
        parts.append(f"α = {1e6 * body.thermal_expansion:g}e-6/K")
    row = shipped_materials().get(body.name)
    source = "given"
    if row is not None and row.material == body:
        source = f"table ({', '.join(dict.fromkeys(row.provenance.values()))})"
    numbers = [part.replace(" ", _FIXED) for part in parts]
    return ", ".join([*([body.name] if body.name else []), *numbers]), source


def write_page(page: Page, path: Path | str) -> Path:
    """Write a page as .html, .pdf or .png, by the suffix of the path."""
    suffix = require_suffix(path, *SUFFIXES)
    with replacing(path) as temporary, figure_style():
        if suffix == ".html":
            temporary.write_text(_html(page), encoding="utf-8")
        else:
            sheet = _sheet(page)
            details: dict[str, Any] = {"metadata": {"CreationDate": None}}
            if suffix == ".png":
                details = {"dpi": _DPI}
            sheet.savefig(temporary, format=suffix[1:], **details)
    return Path(path)


# --- a sheet of paper ---------------------------------------------------------------------------


class _Sheet:
    """A sheet of A4, written at x mm from its left and y mm from its lower edge.

    Texts and lengths along y are smaller by a factor, so that more has room.
    """

    def __init__(self, smaller: float) -> None:
        self.smaller, self.height = smaller, _HEIGHT * smaller
        self.figure = new_figure("page", _HEIGHT)
        self.figure.set_size_inches(_WIDTH / 25.4, _HEIGHT / 25.4)
        self.figure.set_layout_engine("none")

    def write(self, x: float, y: float, text: str, size: float = 7.0, **more: Any) -> None:
        place: dict[str, Any] = {"va": "top", "ha": "left", "fontsize": size / self.smaller}
        place |= more
        self.figure.text(x / _WIDTH, y / self.height, text, **place)

    def lines(
        self, x: float, y: float, rows: Sequence[str], size: float = 7.0, **more: Any
    ) -> float:
        """Write lines, and return where the next ones begin."""
        self.write(x, y, "\n".join(rows), size, linespacing=1.35, **more)
        return y - _LINE * size * len(rows) - _GAP * bool(rows)

    def wrapped(self, text: str, width: float) -> list[str]:
        """Return a text in lines of a width in mm."""
        return textwrap.wrap(text, int(self.smaller * width / _LETTER)) or [""]

    def heading(self, x: float, y: float, text: str) -> float:
        self.write(x, y, text, 9.0)
        return y - 5.5

    def axes(self, x: float, y: float, width: float, height: float) -> Axes:
        box = (x / _WIDTH, y / self.height, width / _WIDTH, height / self.height)
        return self.figure.add_axes(box)

    def inputs(self, page: Page, y: float) -> float:
        """Write the inputs; return where the next part begins."""
        y = self.heading(96, y, "Inputs")
        for name, value, source in page.inputs:
            of = f" [{source}]".replace(" ", _FIXED).replace(_FIXED, " ", 1)
            text = value + (of if source != "given" else "")
            self.write(96, y, name)
            y = self.lines(120, y, self.wrapped(text, 68))
        return y

    def answer(self, page: Page, y: float, width: float) -> float:
        """Write the numbers and the words; return where the next part begins."""
        y, step = self.heading(8, y, "Answer"), min(17.5, 115 / len(page.headings))
        for row in [page.headings, *page.rows] if len(page.headings) > 2 else page.rows:
            self.write(8, y, row[0])
            for k, cell in enumerate(row[1:]):
                self.write(84 + step * k, y, cell, ha="right")
            y -= 4.1
        said = [part for line in page.words if line for part in self.wrapped(line, width)]
        return self.lines(8, y - 1, said)

    def sections(self, page: Page, x: float, y: float) -> float:
        """Write the sections, as wide as the sheet is there; return where the next part begins."""
        for name, rows in page.sections.items():
            y = self.heading(x, y, name)
            for line in rows:
                y = self.lines(x, y, self.wrapped(line, 184 - x))
            y -= 1
        return y

    def foot(self, page: Page) -> None:
        """Write what is to be signed, and where the page is from."""
        for x, name in zip((8, 54, 100, 146), _TO_FILL, strict=True):
            line = [x / _WIDTH, (x + 36) / _WIDTH], [16 / self.height] * 2
            self.figure.add_artist(
                Line2D(*line, transform=self.figure.transFigure, color="black", linewidth=0.6,
                       linestyle="-", marker="")
            )  # fmt: skip
            self.write(x, 15, name, 6.5)
        self.write(8, 7, page.fingerprint, 6.5, color="0.4")


def _sheet(page: Page) -> StyledFigure:
    """Return a sheet of A4, with texts as small as they must be for all to have room."""
    for smaller in _SMALLER:
        sheet = _Sheet(smaller)
        if _written(page, sheet):
            break
    return sheet.figure


def _written(page: Page, sheet: _Sheet) -> bool:
    """Write a page on a sheet, and return whether it has room for all."""
    top = sheet.height
    sheet.write(8, top - 8, page.kind, 14.0)
    sheet.write(8, top - 16, page.title, 9.5)
    page.sketch(sheet.axes(4, top - 94, 88, 72))
    y = min(sheet.inputs(page, top - 24) - 4, top - 100)
    # Beside an answer of few columns there is room for the sections; below one column they leave
    # the sheet to warnings and picture.
    columns = len(page.headings) - 1
    beside, alone = page.picture is not None and columns <= _FEW, columns == 1
    side = 8.0 if page.picture is None else 112.0 if alone or not beside else 130.0
    below = sheet.answer(page, y, 96.0 if beside else 176.0)
    end = sheet.sections(page, side, y) if beside else below
    y = min(below, end) if alone else below
    wide = 112.0 if beside and not alone else 176.0
    for warning in page.warnings:
        rows = sheet.wrapped(f"Warning: {warning}", wide / 1.07)
        y = sheet.lines(8, y, rows, 7.5, color="#B00000")
    high = y - _FOOT - 18.0
    if page.picture is not None:
        wide = 150.0 if beside and alone else 92.0 if beside else 82.0
        box = max(min(70.0, high), 1.0)
        page.picture(plot := sheet.axes(20, y - box - 6, wide, box))
        plot.set_title("")
    if not beside:
        end = sheet.sections(page, side, y)
    sheet.foot(page)
    return end > _FOOT and (page.picture is None or high > _LEAST)


# --- a page of HTML -----------------------------------------------------------------------------


def _html(page: Page) -> str:
    """Return a page of HTML with its pictures."""
    inputs = "".join(
        f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in page.inputs
    )
    warnings = "".join(f'<p class="warning">Warning: {escape(w)}</p>' for w in page.warnings)
    sections = "".join(
        f"<h2>{escape(name)}</h2>" + "".join(f"<p>{escape(line)}</p>" for line in lines)
        for name, lines in page.sections.items()
    )
    picture = f"<figure>{_svg(page.picture)}</figure>" if page.picture else ""
    to_fill = " ".join(f"{name} {'_' * 18}" for name in _TO_FILL)
    return "\n".join(
        [
            '<!doctype html><html lang="en"><meta charset="utf-8">'
            f"<title>{escape(page.title)}</title>"
            f'<meta name="viewport" content="width=device-width"><style>{_STYLE}</style>',
            f"<h1>{escape(page.kind)}</h1><p><b>{escape(page.title)}</b></p>",
            warnings,
            f'<div class="side"><figure>{_svg(page.sketch)}</figure><div><h2>Inputs</h2>'
            '<table class="inputs"><tr><td></td><td>value</td><td>source</td></tr>'
            f"{inputs}</table></div></div>",
            f"<h2>Answer</h2>{TextTable([*page.headings], [*map(list, page.rows)])._repr_html_()}",
            *(f"<p>{escape(line)}</p>" for line in page.words if line),
            f'<div class="side">{picture}<div>{sections}</div></div>',
            f"<p>{to_fill}</p>",
            f"<footer>{escape(page.fingerprint)}</footer></html>",
        ]
    )


def _svg(draw: Draw) -> str:
    """Return a picture as SVG, to stand inside a page."""
    figure, text = new_figure("column", 75.0), io.StringIO()
    draw(figure.subplots())
    figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()[text.getvalue().index("<svg") :]
