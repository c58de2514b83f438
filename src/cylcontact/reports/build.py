"""Find the recipes of a bench, draw them, and write each figure with its numbers."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from shutil import which
from typing import Any

from cylcontact.errors import InputError
from cylcontact.files import replacing
from cylcontact.plots.figure import Drawing
from cylcontact.plots.style import JOURNAL, Choice, FigureStyle, Format, figure_style
from cylcontact.reports.bench import Bench

DPI = 300
# Seven significant digits: finer than any figure is read, coarser than rounding noise.
NUMBER_FORMAT = "%.7g"


@dataclass(frozen=True)
class Written:
    """One figure on disk.

    Attributes
    ----------
    name : str
        The recipe's name.
    paths : tuple of path
        The pictures, by default PNG and PDF, and the CSV.
    drawing : Drawing
        What was drawn.
    """

    name: str
    paths: tuple[Path, ...]
    drawing: Drawing


def find_recipes(bench: Bench) -> dict[str, Path]:
    """Return the bench's recipes in alphabetical order, name → file.

    Parameters
    ----------
    bench : Bench
        Its `reports/*.py` are the recipes.

    Returns
    -------
    dict

    Raises
    ------
    InputError
        If there is none.

    Examples
    --------
    >>> import tempfile
    >>> bench = Bench(Path(tempfile.mkdtemp()))
    >>> bench.recipes_folder.mkdir()
    >>> (bench.recipes_folder / "fig99.py").touch()
    >>> list(find_recipes(bench))
    ['fig99']
    """
    files = sorted(bench.recipes_folder.glob("*.py"))
    if not files:
        raise InputError(
            str(bench.recipes_folder),
            "",
            None,
            "holds no recipe",
            "run this in a bench; cylcontact init FOLDER lays one out",
        )
    return {file.stem: file for file in files}


def draw(name: str, bench: Bench, style: FigureStyle = JOURNAL) -> Drawing:
    """Draw one figure, writing nothing.

    Parameters
    ----------
    name : str
        The recipe's name, such as "fig02".
    bench : Bench
        Where the recipe and its inputs lie.
    style : FigureStyle, optional
        What it is drawn for; left out, the journal.

    Returns
    -------
    Drawing

    Raises
    ------
    InputError
        If there is no such recipe, the file is not one, or an input of it is missing.
    """
    recipe = _load_recipe(_find_recipe(name, bench))
    with figure_style(style):
        drawing = recipe(bench)
        if style != JOURNAL:
            # Titles and legends make do with the style's width.
            drawing.figure.draw_without_rendering()
        return drawing


def build(
    bench: Bench,
    names: Iterable[str] = (),
    folder: Path | None = None,
    progress: Callable[[Written], None] = lambda _: None,
    choice: Choice = Choice(JOURNAL),  # noqa: B008 - frozen
) -> list[Written]:
    """Draw figures and write NAME.png, NAME.pdf and NAME.csv of each.

    A figure's files appear complete or not at all, and the same input gives the same bytes.

    Parameters
    ----------
    bench : Bench
        Where the recipes and their inputs lie.
    names : iterable of str, optional
        The recipes to draw; left out, all of them.
    folder : path, optional
        Where to write; left out, the bench's `reports/figures`.
    progress : callable, optional
        Called with each figure once it is on disk.
    choice : Choice, optional
        The style and the formats; left out, the journal's, as PNG and PDF.

    Returns
    -------
    list of Written

    Raises
    ------
    InputError
        If a recipe or an input of it is missing, or the folder cannot be written to.

    Examples
    --------
    >>> import tempfile
    >>> bench = Bench(Path(tempfile.mkdtemp()))
    >>> bench.recipes_folder.mkdir()
    >>> recipe = '''
    ... import pandas as pd
    ... from cylcontact.plots.figure import Drawing
    ... from cylcontact.plots.figure import new_figure
    ...
    ... def draw(bench):
    ...     table = pd.DataFrame({"load_N_per_mm": [10.0]})
    ...     return Drawing(new_figure("column", 60), table, {"load, N/mm": 10.0}, "A load.")
    ... '''
    >>> _ = (bench.recipes_folder / "fig99.py").write_text(recipe)
    >>> (figure,) = build(bench)
    >>> [path.name for path in figure.paths], figure.drawing.headline
    (['fig99.png', 'fig99.pdf', 'fig99.csv'], {'load, N/mm': 10.0})
    """
    target = folder or bench.figures_folder
    written = []
    for name in chosen_recipes(bench, names):
        drawing = draw(name, bench, choice.style)
        written.append(Written(name, write(drawing, name, target, choice), drawing))
        progress(written[-1])
    return written


def chosen_recipes(bench: Bench, names: Iterable[str] = ()) -> list[str]:
    """Return the recipes to draw, all where none is named.

    Raises
    ------
    InputError
        If there is no such recipe; a mistyped name is told before the first figure is drawn.
    """
    chosen = list(dict.fromkeys(names)) or list(find_recipes(bench))
    for name in chosen:
        _find_recipe(name, bench)
    return chosen


def write(
    drawing: Drawing,
    name: str,
    folder: Path,
    choice: Choice = Choice(JOURNAL),  # noqa: B008 - frozen
) -> tuple[Path, ...]:
    """Write a drawing's pictures and the CSV of its numbers, complete or not at all.

    Parameters
    ----------
    drawing : Drawing
        What to write.
    name : str
        The files' name without its ending.
    folder : path
        Where to write; made if it does not exist.
    choice : Choice, optional
        The style it was drawn in, and the formats; left out, PNG and PDF.

    Returns
    -------
    tuple of path
        A picture in each format, in their order, and the CSV.

    Raises
    ------
    InputError
        If the folder cannot be written to, or a format needs a program that is absent.
    """
    require_programs(choice.formats)
    endings = (*choice.formats, "csv")
    with ExitStack() as stack:
        *pictures, csv = (
            stack.enter_context(replacing(folder / f"{name}.{ending}")) for ending in endings
        )
        for form, picture in zip(choice.formats, pictures, strict=True):
            _save(drawing, picture, form, choice.style)
        drawing.table.to_csv(csv, index=False, float_format=NUMBER_FORMAT, lineterminator="\n")
    return tuple(folder / f"{name}.{ending}" for ending in endings)


def require_programs(formats: Iterable[Format]) -> None:
    """Raise `InputError` where a format needs a program that is not installed."""
    if "pgf" in formats and which("xelatex") is None:
        raise InputError(
            "report",
            "--format",
            "pgf",
            "needs xelatex, which measures the text of the figure and is not installed",
            "install TeX (Debian: apt install texlive-xetex), or choose pdf",
        )


def _save(drawing: Drawing, picture: Path, form: Format, style: FigureStyle) -> None:
    """Write one picture, the caption inside where the format has room for it."""
    # Dates and versions off: they would change the bytes and tell the reader nothing.
    metadata: dict[Format, dict[str, str | None]] = {
        "png": {"Software": None, "Description": drawing.caption},
        "pdf": {
            "CreationDate": None,
            "Creator": None,
            "Producer": None,
            "Subject": drawing.caption,
        },
        "svg": {"Date": None, "Creator": None, "Description": drawing.caption},
    }
    known: dict[str, Any] = {"metadata": metadata[form]} if form in metadata else {}
    with figure_style(style):
        drawing.figure.savefig(picture, format=form, dpi=DPI, **known)


def _find_recipe(name: str, bench: Bench) -> Path:
    """Return a recipe's file, or say which recipes there are."""
    recipes = find_recipes(bench)
    if name not in recipes:
        raise InputError(
            str(bench.recipes_folder),
            "recipe",
            name,
            "there is no such recipe",
            f"choose among {', '.join(recipes)}",
        )
    return recipes[name]


def _load_recipe(file: Path) -> Callable[[Bench], Drawing]:
    """Import a recipe by its path and return its `draw`."""
    spec = importlib.util.spec_from_file_location(f"cylcontact_recipe_{file.stem}", file)
    # A path ending in .py always has a loader.
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    recipe: Callable[[Bench], Drawing] | None = getattr(module, "draw", None)
    if recipe is None:
        raise InputError(
            str(file),
            "draw",
            None,
            "a recipe must define this function",
            "give it draw(bench: Bench) -> Drawing",
        )
    return recipe
