"""Find the recipes of a bench, draw them, and write each figure with its numbers.

A recipe is a function `draw(bench) -> Drawing` in a file of the bench's `reports` folder; the
figure is named after the file. A file that draws several figures lists them instead, in
`FIGURES`, name → function. A function with keyword arguments draws variants on demand.
"""

from __future__ import annotations

import gc
import inspect
import io
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from matplotlib import rc_context

from cylcontact.files.writing import replacing_all, require_apart, require_writable
from cylcontact.plots.figure import Drawing
from cylcontact.plots.style import (
    DEFAULT_OPTIONS,
    JOURNAL,
    FigureOptions,
    FigureStyle,
    figure_style,
)
from cylcontact.reports.bench import Bench
from cylcontact.support.choices import Format
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import call, run_calls
from cylcontact.support.progress import Progress, silent

__all__ = [
    "FigureResult",
    "build",
    "chosen_recipes",
    "draw",
    "find_recipes",
    "save_picture",
    "write",
]

DPI = 300
# A figure without a layout engine would take the style's.
_ARRANGED: Any = {"figure.constrained_layout.use": False}
# Seven significant digits: more than a figure can show, fewer than round-off affects.
NUMBER_FORMAT = "%.7g"

# A line of a recipe that defines its function or its table of them, or imports one.
DEFINES = re.compile(r"^(?:def |from .* import (?:.*, )?)?(draw|FIGURES)\b(?! as)", re.MULTILINE)

Arguments = Mapping[str, str]


@dataclass(frozen=True)
class FigureResult:
    """The outcome of one recipe.

    Attributes
    ----------
    name : str
        The recipe's name.
    paths : tuple of path
        The pictures, in the order of the formats, the CSV and the note, if there is one; empty on
        failure.
    caption : str
        The figure's caption.
    method : str
        The text of the note: how the figure was made.
    headline : mapping of str to float
        The figure's main results.
    size_mm : tuple of float
        Width and height.
    problem : InputError or None
        The reason of a failure.
    """

    name: str
    paths: tuple[Path, ...] = ()
    caption: str = ""
    method: str = ""
    headline: Mapping[str, float] = field(default_factory=dict)
    size_mm: tuple[float, float] = (0.0, 0.0)
    problem: InputError | None = None


def find_recipes(bench: Bench) -> dict[str, Path]:
    """Return the figures that the bench can draw, in alphabetical order, name → file.

    Files without a figure, such as constants and helpers, do not appear.

    Examples
    --------
    >>> import tempfile
    >>> bench = Bench(Path(tempfile.mkdtemp()))
    >>> bench.recipes_folder.mkdir()
    >>> _ = (bench.recipes_folder / "paper.py").write_text("LOADS = (10.0, 1000.0)")
    >>> _ = (bench.recipes_folder / "fig99.py").write_text("def draw(bench): ...")
    >>> _ = (bench.recipes_folder / "maps.py").write_text("FIGURES = {'fig97': 1, 'fig98': 2}")
    >>> list(find_recipes(bench))
    ['fig97', 'fig98', 'fig99']
    """
    recipes: dict[str, Path] = {}
    for file in sorted(bench.recipes_folder.glob("*.py")):
        defined = _defined(file)
        if "draw" in defined:
            recipes[file.stem] = file
        if "FIGURES" in defined:
            recipes |= dict.fromkeys(_figures_of(file.stem, bench), file)
    for name, file in recipes.items():
        if name != Path(name).name:
            rule, remedy = "cannot name a file", "take letters, digits and hyphens"
            raise InputError(str(file), "FIGURES", name, rule, remedy)
    if not recipes:
        raise InputError(
            str(bench.recipes_folder),
            "",
            None,
            "holds no recipe",
            "run this in a bench; cylcontact init FOLDER lays one out",
        )
    return dict(sorted(recipes.items()))


def draw(
    name: str, bench: Bench, style: FigureStyle = JOURNAL, arguments: Arguments | None = None
) -> Drawing:
    """Draw one figure, without writing files.

    Parameters
    ----------
    name : str
        The recipe's name, such as "fig02".
    bench : Bench
        Where the recipe and its inputs are.
    style : FigureStyle, optional
        The style; by default the journal's.
    arguments : mapping of str to str, optional
        The recipe's keyword arguments, such as `{"material": "titanium alloy"}`.

    Returns
    -------
    Drawing

    Raises
    ------
    InputError
        If there is no such recipe, the file is not one, it does not take these arguments, or an
        input of it is missing.
    """
    function, given = _function_of(name, bench), dict(arguments or {})
    _require_arguments(name, function, given)
    with figure_style(style):
        drawing: Drawing = function(bench, **given)
        # Arranged once, so that each format shows the same and none does it again.
        drawing.figure.draw_without_rendering()
        with rc_context(_ARRANGED):
            drawing.figure.set_layout_engine(None)
        return drawing


def build(
    bench: Bench,
    names: Sequence[str] = (),
    folder: Path | None = None,
    options: FigureOptions = DEFAULT_OPTIONS,
    progress: Progress = silent,
    arguments: Arguments | None = None,
) -> list[FigureResult]:
    """Draw figures in `bench.jobs` processes, and write the pictures, the CSV and the note of each.

    A figure's files are complete or absent. The same input gives the same bytes for every number
    of processes.

    Parameters
    ----------
    bench : Bench
        Where the recipes and their inputs are.
    names : sequence of str, optional
        The recipes to draw; by default all of them.
    folder : path, optional
        Where to write; by default the bench's `reports/figures`.
    options : FigureOptions, optional
        The style and the formats; by default the journal's, as PNG and PDF.
    progress : callable, optional
        Called with the stage, the number of figures done and their total.
    arguments : mapping of str to str, optional
        The recipe's keyword arguments, which become part of the files' names.

    Returns
    -------
    list of FigureResult
        In the order of the names; a failed recipe has a `problem` and no files.

    Raises
    ------
    InputError
        If a name is unknown, a file cannot be written, or the system ended a worker.

    Examples
    --------
    >>> import tempfile
    >>> bench = Bench(Path(tempfile.mkdtemp()))
    >>> bench.recipes_folder.mkdir()
    >>> recipe = '''
    ... import pandas as pd
    ... from cylcontact.plots import Drawing, new_figure
    ...
    ... def draw(bench):
    ...     table = pd.DataFrame({"load_N_per_mm": [10.0]})
    ...     return Drawing(new_figure("column", 60), table, {"load, N/mm": 10.0}, "A load.")
    ... '''
    >>> _ = (bench.recipes_folder / "fig99.py").write_text(recipe)
    >>> (figure,) = build(bench)
    >>> [path.name for path in figure.paths], figure.headline
    (['fig99.png', 'fig99.pdf', 'fig99.csv', 'fig99.txt'], {'load, N/mm': 10.0})
    """
    target, chosen, given = folder or bench.figures_folder, chosen_recipes(bench, names), arguments
    outputs = [
        target / f"{_stem(name, given)}.{ending}"
        for name in chosen
        for ending in (*options.formats, "csv", "txt")
    ]
    require_writable(*outputs)
    require_apart(outputs, bench.inputs)
    work = [call(_attempt, bench, name, target, options, given) for name in chosen]
    results: list[FigureResult] = []
    progress("drawing", 0, len(chosen))
    with closing(run_calls(work, bench.jobs)) as drawn:
        for result in drawn:
            results.append(result)
            progress("drawing", len(results), len(chosen))
    return results


def chosen_recipes(bench: Bench, names: Iterable[str] = ()) -> list[str]:
    """Return the recipes to draw: the ones named, or all that need no arguments."""
    recipes = find_recipes(bench)
    chosen = list(dict.fromkeys(names))
    for name in chosen:
        if name not in recipes:
            _refuse_unknown(name, bench, recipes)
    return chosen or [name for name in recipes if not _needs_arguments(name, bench)]


def write(
    drawing: Drawing, name: str, folder: Path, options: FigureOptions = DEFAULT_OPTIONS
) -> tuple[Path, ...]:
    """Write a drawing's pictures, the CSV of its numbers and its note, all of them or none."""
    paths = tuple(folder / f"{name}.{ending}" for ending in (*options.formats, "csv", "txt"))
    with replacing_all(paths) as (*pictures, table, note):
        for form, picture in zip(options.formats, pictures, strict=True):
            save_picture(drawing, picture, form, options.style)
        drawing.table.to_csv(table, index=False, float_format=NUMBER_FORMAT, lineterminator="\n")
        text = "\n\n".join(filter(None, (drawing.caption, drawing.method)))
        note.write_text(f"{text}\n", encoding="utf-8")
    return paths


def save_picture(drawing: Drawing, picture: Path, form: Format, style: FigureStyle) -> None:
    """Write one picture, with the caption as metadata where the format allows it."""
    caption = drawing.caption
    # No dates and versions: they would change the bytes.
    metadata: dict[Format, dict[str, str | None]] = {
        "png": {"Software": None, "Description": caption},
        "pdf": {
            "CreationDate": None,
            "Creator": None,
            "Producer": None,
            "Subject": caption,
        },
        "svg": {"Date": None, "Creator": None, "Description": caption},
    }
    # Drawn in memory first: where the disk is full, matplotlib's PDF fails with another error.
    target = io.BytesIO()
    with figure_style(style), rc_context(_ARRANGED):
        drawing.figure.savefig(target, format=form, dpi=DPI, metadata=metadata[form])
    picture.write_bytes(target.getvalue())


def _attempt(
    bench: Bench, name: str, folder: Path, options: FigureOptions, arguments: Arguments | None
) -> FigureResult:
    """Draw and write one figure, and free its memory."""
    # A figure has reference cycles, so it would stay in the worker's memory for long. To search
    # all that was there before for them would take a tenth of a second each time.
    gc.freeze()
    try:
        return _drawn(bench, name, folder, options, arguments)
    finally:
        gc.collect()
        gc.unfreeze()


def _drawn(
    bench: Bench, name: str, folder: Path, options: FigureOptions, arguments: Arguments | None
) -> FigureResult:
    """Draw and write one figure; return any error of the recipe, raise those of the disk."""
    try:
        drawing = draw(name, replace(bench, jobs=1), options.style, arguments)
    except InputError as error:
        return FigureResult(name, problem=error)
    except Exception as error:
        file = find_recipes(bench).get(name, bench.recipes_folder / f"{name}.py")
        problem = InputError(
            str(file),
            "draw",
            None,
            f"failed with {type(error).__name__} ({error})",
            "correct the recipe",
        )
        return FigureResult(name, problem=problem)
    paths = write(drawing, _stem(name, arguments), folder, options)
    width, height = (float(inches) * 25.4 for inches in drawing.figure.get_size_inches())
    return FigureResult(
        name,
        paths,
        drawing.caption,
        drawing.method,
        dict(drawing.headline),
        (width, height),
    )


def _stem(name: str, arguments: Arguments | None) -> str:
    """Return the name of a figure's files: the recipe's, then the values of its arguments."""
    values = (re.sub(r"[^\w.+-]+", "-", value) for value in (arguments or {}).values())
    return "-".join([name, *values])


def _defined(file: Path) -> set[str]:
    """Return which of `draw` and `FIGURES` a file defines or imports, without running it."""
    return set(DEFINES.findall(file.read_text(encoding="utf-8", errors="replace")))


def _figures_of(name: str, bench: Bench) -> Iterable[str]:
    """Return the figures that a file lists; only its own name where it cannot be imported."""
    try:
        figures: Mapping[str, Any] = bench.module(name).FIGURES
    except InputError:  # drawing it reports what is wrong
        return (name,)
    return figures


def _needs_arguments(name: str, bench: Bench) -> bool:
    """Return whether a recipe cannot be drawn without an argument."""
    try:
        parameters = inspect.signature(_function_of(name, bench)).parameters.values()
    except InputError:  # drawing it reports what is wrong
        return False
    return any(p.kind is p.KEYWORD_ONLY and p.default is p.empty for p in parameters)


def _function_of(name: str, bench: Bench) -> Callable[..., Drawing]:
    """Import a recipe's file and return the function that draws it."""
    recipes = find_recipes(bench)
    if name not in recipes:
        _refuse_unknown(name, bench, recipes)
    module: Any = bench.module(recipes[name].stem)
    listed = getattr(module, "FIGURES", {}).get(name)
    if listed is None:
        own: Callable[..., Drawing] = module.draw
        return own

    # Functions of FIGURES may have keywords too, already bound; only a file's `draw` takes any.
    def draw_listed(bench: Bench) -> Drawing:
        drawing: Drawing = listed(bench)
        return drawing

    return draw_listed


def _require_arguments(name: str, function: Callable[..., Any], given: Arguments) -> None:
    """Raise `InputError` for an argument that is unknown or missing."""
    parameters = inspect.signature(function).parameters
    keywords = [p for p in parameters.values() if p.kind is inspect.Parameter.KEYWORD_ONLY]
    known = [parameter.name for parameter in keywords]
    needed = [p.name for p in keywords if p.default is inspect.Parameter.empty]
    example = " ".join(f"{key}=…" for key in needed or known[:1])
    for key, value in given.items():
        if key not in known:
            rule = f"takes {', '.join(known)}" if known else "takes no arguments"
            remedy = f"write: cylcontact figure {name} {example}".rstrip()
            raise InputError(name, key, value, rule, remedy)
    for key in needed:
        if key not in given:
            remedy = f"write: cylcontact figure {name} {example}"
            raise InputError(name, key, None, "is needed", remedy)


def _refuse_unknown(name: str, bench: Bench, recipes: Mapping[str, Path]) -> None:
    """Raise `InputError` for a name that is no recipe."""
    file = bench.recipes_folder / f"{name}.py"
    if file.is_file():
        raise InputError(
            str(file),
            "draw",
            None,
            "a recipe must define this function",
            "give it draw(bench: Bench) -> Drawing",
        )
    rule, remedy = "there is no such recipe", f"choose among {', '.join(recipes)}"
    try:
        for file in sorted(bench.recipes_folder.glob("*.py")):
            if "FIGURES" in _defined(file):
                bench.module(file.stem)
    except InputError as error:
        rule = f"there is no such recipe, unless in a file that {error.rule}"
        remedy = f"correct {error.source}, or {remedy}"
    raise InputError(str(bench.recipes_folder), "recipe", name, rule, remedy)
