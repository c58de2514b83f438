"""The folder of a table of measurements: its fit with residuals and picture, and ranked laws."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from cylcontact.files.writing import replacing_all
from cylcontact.fitting.choice import Choice
from cylcontact.fitting.design import Design
from cylcontact.fitting.results import DataFit
from cylcontact.plots.figure import Drawing, save
from cylcontact.plots.style import figure_style
from cylcontact.reports.figures import NUMBERS
from cylcontact.support.choices import CHOICE_FILES, DESIGN_FILES, FIT_FILES


def write_choice(choice: Choice, folder: Path) -> None:
    """Write ranked laws into a folder, as `choices.CHOICE_FILES`, all of them or none."""
    with figure_style():
        drawing = choice.drawing()
    _write(drawing, folder, CHOICE_FILES, lambda _: None)


def write_fit(result: DataFit, folder: Path) -> None:
    """Write a fit to measurements into a folder; on an error, write none of its files."""
    with figure_style():
        drawing = result.drawing()
    read = "".join(f"# {line}\n" for line in result.data.read)
    _write(drawing, folder, FIT_FILES, lambda paths: result.write(paths[".json"]), read)


def write_design(design: Design, folder: Path) -> None:
    """Write the picture of a design and its table into a folder, as `choices.DESIGN_FILES`."""
    with figure_style():
        drawing = design.drawing()
    _write(drawing, folder, DESIGN_FILES, lambda _: None)


def _write(
    drawing: Drawing,
    folder: Path,
    names: Sequence[str],
    rest: Callable[[Mapping[str, Path]], None],
    head: str = "",
) -> None:
    """Write a drawing's pictures and table below a head, and by suffix whatever else there is."""
    with replacing_all(folder / name for name in names) as files:
        paths = {file.suffix: file for file in files}
        with figure_style():
            save(drawing.figure, paths[".png"], "png")
            save(drawing.figure, paths[".pdf"], "pdf")
        table = drawing.table.to_csv(**NUMBERS)
        paths[".csv"].write_text(head + table, encoding="utf-8", newline="")
        rest(paths)
