"""One page of an answer in words, with pictures if it has some: for bushes and clevises."""

from __future__ import annotations

import io
import json
import textwrap
from collections.abc import Callable, Sequence
from html import escape
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from cylcontact.files.provenance import spec_hash
from cylcontact.files.writing import replacing, require_suffix
from cylcontact.plots.figure import new_figure
from cylcontact.plots.style import figure_style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SUFFIXES = (".html", ".pdf", ".png")
# A sheet of A4 with its margins in mm, dots per inch, and the height of a picture.
_WIDTH, _HEIGHT, _DPI, _PICTURE = 190.0, 272.0, 200, 60.0
_STYLE = "body { font: 14px/1.45 system-ui, sans-serif; max-width: 62rem; margin: 1.5rem auto; } \
pre { font-size: 12px; } svg { max-width: 48%; height: auto; } .warning { border-left: 4px solid \
#D55E00; padding-left: .6rem; } footer { margin-top: 2rem; color: #666; font-size: 12px; }"

Draw = Callable[["Axes"], Any]


class Answer(Protocol):
    """What a page shows: a text, warnings, and the numbers for its hash."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences."""

    def to_dict(self) -> dict[str, Any]:
        """Return inputs and numbers."""


def write_text_page(
    answer: Answer, title: str, path: Path | str, pictures: Sequence[Draw] = ()
) -> Path:
    """Write the page of an answer as .html, .pdf or .png, by the suffix of the path."""
    suffix = require_suffix(path, *SUFFIXES)
    print_of = spec_hash(json.loads(json.dumps(answer.to_dict())))
    foot = f"cylcontact {version('cylcontact')}, inputs and numbers {print_of}"
    with replacing(path) as temporary, figure_style():
        if suffix == ".html":
            temporary.write_text(_html(answer, title, foot, pictures), encoding="utf-8")
            return Path(path)
        sheet = new_figure("page", _HEIGHT)
        sheet.set_size_inches(_WIDTH / 25.4, _HEIGHT / 25.4)
        sheet.set_layout_engine("none")
        sheet.text(0.04, 0.975, title, fontsize=13, va="top")
        lines = [part for line in str(answer).splitlines() for part in _wrapped(line)]
        for warning in answer.warnings:
            lines += _wrapped(f"Warning: {warning}")
        sheet.text(0.04, 0.945, "\n".join(lines), family="monospace", fontsize=6.2, va="top",
                   linespacing=1.3)  # fmt: skip
        for k, draw in enumerate(pictures):
            draw(sheet.add_axes((0.1 + 0.5 * k, 0.09, 0.36, _PICTURE / _HEIGHT)))
        for x, name in ((0.04, "checked by"), (0.4, "approved by"), (0.76, "date")):
            sheet.text(x, 0.04, f"{name} {'_' * 22}", fontsize=6.5)
        sheet.text(0.04, 0.015, foot, fontsize=6.5, color="0.4")
        details: dict[str, Any] = {"metadata": {"CreationDate": None}}
        sheet.savefig(
            temporary, format=suffix[1:], **({"dpi": _DPI} if suffix == ".png" else details)
        )
    return Path(path)


def _wrapped(line: str) -> list[str]:
    """Return a line of text in lines of the sheet, as it is if it fits."""
    return [line] if len(line) <= 128 else textwrap.wrap(line, 128, subsequent_indent="    ")


def _html(answer: Answer, title: str, foot: str, pictures: Sequence[Draw]) -> str:
    """Return a page of HTML."""
    drawn = []
    for draw in pictures:
        figure, text = new_figure("column", 75.0), io.StringIO()
        draw(figure.subplots())
        figure.savefig(text, format="svg", metadata={"Date": None})
        drawn.append(text.getvalue()[text.getvalue().index("<svg") :])
    warnings = "".join(f'<p class="warning">Warning: {escape(w)}</p>' for w in answer.warnings)
    return "\n".join(
        [
            '<!doctype html><html lang="en"><meta charset="utf-8">'
            f"<title>{escape(title)}</title><style>{_STYLE}</style><h1>{escape(title)}</h1>",
            warnings,
            *drawn,
            f"<pre>{escape(str(answer))}</pre>",
            f"<p>checked by {'_' * 22} approved by {'_' * 22} date {'_' * 12}</p>",
            f"<footer>{escape(foot)}</footer></html>",
        ]
    )
