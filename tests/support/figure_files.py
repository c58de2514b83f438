"""Pinned numbers of figures, and what tests read from the files that were written."""

import json
import re
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.text import Text

from cylcontact.plots.style import figure_style

# Pinned numbers of figures to six digits, by the figure.
GOLDEN = json.loads((Path(__file__).parents[1] / "golden" / "figures.json").read_text("utf-8"))


def page_mm(pdf: Path) -> tuple[float, float]:
    """Return the size of a PDF's page in mm."""
    box = re.search(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+)", pdf.read_bytes())
    assert box is not None
    return (float(box[1]) / 72 * 25.4, float(box[2]) / 72 * 25.4)


def embedded_fonts(pdf: Path) -> set[str]:
    """Return the fonts that a PDF embeds, all of them as Type 42."""
    data = pdf.read_bytes()
    assert b"/FontFile2" in data
    assert b"/Type3" not in data
    assert set(re.findall(rb"/Subtype /(\w*Type\w+)", data)) <= {b"Type0", b"CIDFontType2"}
    return {name.decode() for name in re.findall(rb"/BaseFont /[A-Z]{6}\+([\w-]+)", data)}


def font_sizes_inside(figure: Figure) -> set[float]:
    """Return the sizes of a figure's texts, of which all are inside the page."""
    with figure_style():  # the fonts of formulas
        figure.draw_without_rendering()
        drawn, page = figure.get_tightbbox(), figure.bbox_inches
    assert min(drawn.x0, drawn.y0) >= 0
    assert drawn.x1 <= page.x1
    assert drawn.y1 <= page.y1
    return {text.get_fontsize() for text in figure.findobj(Text) if text.get_text()}
