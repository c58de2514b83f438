"""The folder of a fit to measurements: the result, its residuals, and its picture."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

from cylcontact.choices import FIT_FILES
from cylcontact.files import replacing
from cylcontact.fitting.drawings import fit_drawing
from cylcontact.fitting.result import FitResult
from cylcontact.plots.style import JOURNAL, figure_style
from cylcontact.reports.build import NUMBER_FORMAT, save_picture

__all__ = ["write_fit"]


def write_fit(result: FitResult, folder: Path) -> None:
    """Write a fit to measurements into a folder; on an error, write none of its files.

    Parameters
    ----------
    result : FitResult
        Of measurements.
    folder : path
        Where to write `choices.FIT_FILES`; made if it does not exist.

    Raises
    ------
    InputError
        If the folder cannot be written to.
    """
    with figure_style():
        drawing = fit_drawing(result)
    with ExitStack() as stack:
        json, csv, png, pdf = (stack.enter_context(replacing(folder / name)) for name in FIT_FILES)
        save_picture(drawing, png, "png", JOURNAL)
        save_picture(drawing, pdf, "pdf", JOURNAL)
        drawing.table.to_csv(csv, index=False, float_format=NUMBER_FORMAT, lineterminator="\n")
        result.write(json)
