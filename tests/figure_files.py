"""Pinned numbers of figures, and what tests read from the files that were written."""

import csv
import json
import re
from pathlib import Path

# Pinned numbers of figures to six digits, by the figure.
GOLDEN = json.loads((Path(__file__).parent / "golden" / "figures.json").read_text("utf-8"))


def page_mm(pdf: Path) -> tuple[float, float]:
    """Return the size of a PDF's page in mm."""
    box = re.search(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+)", pdf.read_bytes())
    assert box is not None
    return (float(box[1]) / 72 * 25.4, float(box[2]) / 72 * 25.4)


def significant_digits(cell: str) -> int:
    """Return how many significant digits a number is written with."""
    return len(cell.split("e", maxsplit=1)[0].replace(".", "").lstrip("-0"))


def read_columns(path: Path) -> dict[str, list[str]]:
    """Return the columns of a CSV file as they are written."""
    with path.open(newline="") as file:
        header, *rows = csv.reader(file)
    return {name: list(cells) for name, cells in zip(header, zip(*rows, strict=True), strict=True)}
