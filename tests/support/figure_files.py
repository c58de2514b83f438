"""Pinned numbers of figures, and what tests read from the files that were written."""

import json
import re
from pathlib import Path

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
