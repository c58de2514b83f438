"""The folder of a table of measurements: its fit with residuals and picture, and ranked laws."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from cylcontact.files.writing import replacing_all
from cylcontact.plots.figure import NUMBERS, save
from cylcontact.plots.style import figure_style
from cylcontact.support.choices import CHOICE_FILES, FIT_FILES, FIT_PDF, PLAN_FILES

if TYPE_CHECKING:
    from cylcontact.fitting.choice import Choice
    from cylcontact.fitting.data_fit import DataFit
    from cylcontact.fitting.plan import Plan


def write_choice(choice: Choice, folder: Path) -> None:
    """Write ranked laws into a folder, as `choices.CHOICE_FILES`, all of them or none."""
    with figure_style():
        drawing = choice.drawing()
    _write(drawing.figure, drawing.table.to_csv(**NUMBERS), folder, CHOICE_FILES)


def write_plan(plan: Plan, folder: Path) -> None:
    """Write the picture of a plan and its table into a folder, as `choices.PLAN_FILES`."""
    with figure_style():
        drawing = plan.drawing()
    _write(drawing.figure, drawing.table.to_csv(**NUMBERS), folder, PLAN_FILES)


def write_fit(result: DataFit, folder: Path, *, pdf: bool = False) -> None:
    """Write a fit to measurements into a folder, its picture also as a PDF if so asked.

    On an error, write none of its files.
    """
    with figure_style():
        figure = result.figure()
    read = "".join(f"# {line}\n" for line in result.data.read)
    table = read + _as_csv(result.residual_columns())
    names = (*FIT_FILES, FIT_PDF) if pdf else FIT_FILES
    _write(figure, table, folder, names, lambda paths: result.write(paths[".json"]))


def _as_csv(columns: Mapping[str, Iterable[Any]]) -> str:
    """Return columns as pandas, which takes long to import, would write them with `NUMBERS`."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    for row in zip(*columns.values(), strict=True):
        writer.writerow(f"{cell:.7g}" if isinstance(cell, float) else cell for cell in row)
    return stream.getvalue()


def _write(
    figure: Figure,
    table: str,
    folder: Path,
    names: Sequence[str],
    rest: Callable[[Mapping[str, Path]], None] = lambda _: None,
) -> None:
    """Write a figure, a table, and by suffix whatever else there is."""
    with replacing_all(folder / name for name in names) as files:
        paths = {file.suffix: file for file in files}
        with figure_style():
            if layout := figure.get_layout_engine():
                layout.execute(figure)  # once for all formats
                figure.set_layout_engine("none")
            for kind in ("png", "pdf"):
                if path := paths.get(f".{kind}"):
                    save(figure, path, kind)
        paths[".csv"].write_text(table, encoding="utf-8", newline="")
        rest(paths)
