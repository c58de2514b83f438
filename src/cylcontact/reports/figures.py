"""Figures of a folder's `reports`: find them, draw them, write picture, numbers and caption.

A file of `reports` ends in a table FIGURES, name → function. Such a function takes texts, all with
defaults, and returns a matplotlib figure and the table of its numbers. Its docstring is the
caption, in which {name} stands for the value of an argument.
"""

from __future__ import annotations

import importlib
import inspect
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from functools import partial
from itertools import chain
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from cylcontact.files.provenance import data_read, modules_of, origin_of
from cylcontact.files.writing import replacing_all, require_apart, require_writable
from cylcontact.plots.figure import NUMBERS, save
from cylcontact.plots.style import figure_style
from cylcontact.support.choices import Format
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import Workers, call, run_calls
from cylcontact.support.progress import Progress, silent

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["caption", "draw", "recipes", "report_module", "write_figures"]

Recipe = Callable[..., "tuple[Figure, pd.DataFrame]"]
# What a folder's `reports` is called when it is imported: it hides no other package `reports`.
_PACKAGE = "_cylcontact_reports"


def report_module(root: Path, name: str) -> ModuleType:
    """Import a file of a folder's `reports`, such as "paper", in its present state.

    Raises
    ------
    InputError
        If the file, or one that it imports, fails.
    """
    folder = (root / "reports").resolve()
    stamp = {file: file.stat().st_mtime_ns for file in folder.glob("*.py")}
    package: Any = sys.modules.get(_PACKAGE)
    if package is None or package.stamp != stamp:
        for known in [each for each in sys.modules if each.partition(".")[0] == _PACKAGE]:
            del sys.modules[known]
        package = sys.modules[_PACKAGE] = ModuleType(_PACKAGE)
        package.__path__, package.stamp = [str(folder)], stamp
        importlib.invalidate_caches()
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, True  # it is the user's folder
    try:
        return importlib.import_module(f"{_PACKAGE}.{name}")
    except InputError:
        raise
    except Exception as error:
        raise _broken(str(folder / f"{name}.py"), error) from error
    finally:
        sys.dont_write_bytecode = before


def recipes(root: Path) -> dict[str, Recipe]:
    """Return the figures that a folder can draw, by name."""
    files = sorted((root / "reports").glob("*.py"))
    if not files:
        rule, remedy = "holds no figure", "cylcontact init FOLDER lays out a folder that does"
        raise InputError(str(root / "reports"), "", None, rule, remedy)
    known: dict[str, Recipe] = {}
    for file in files:
        if re.search(r"^FIGURES\b", file.read_text(encoding="utf-8"), re.MULTILINE):
            known |= report_module(root, file.stem).FIGURES
    return dict(sorted(known.items()))


def draw(
    root: Path, name: str, arguments: Mapping[str, str] | None = None
) -> tuple[Figure, pd.DataFrame]:
    """Draw a figure in the style in force, without writing files.

    Parameters
    ----------
    root : path
        The folder that holds `reports`, `datasets` and `fitting`.
    name : str
        The figure.
    arguments : mapping of str to str, optional
        Its arguments.

    Returns
    -------
    figure : matplotlib.figure.Figure
    table : pandas.DataFrame
        The numbers that are drawn.

    Raises
    ------
    InputError
        If there is no such figure, it takes no such argument, or its function fails.
    """
    recipe, given = _recipe(root, name, arguments or {}), dict(arguments or {})
    try:
        figure, table = recipe(**given)
        figure.draw_without_rendering()  # arranged once for all formats
        figure.set_layout_engine("none")
    except InputError:
        raise
    except Exception as error:
        raise _broken(name, error) from error
    return figure, table


def caption(root: Path, name: str, arguments: Mapping[str, str] | None = None) -> str:
    """Return the caption of a figure, in one paragraph."""
    recipe = _recipe(root, name, arguments or {})
    takes = inspect.signature(recipe).parameters
    values = {key: each.default for key, each in takes.items()} | dict(arguments or {})
    function = _function(recipe)
    if isinstance(recipe, partial):
        values |= dict(zip(inspect.signature(function).parameters, recipe.args, strict=False))
    words = inspect.cleandoc(function.__doc__ or "").format(**values)
    return " ".join(words.split())


def write_figures(
    root: Path,
    names: Sequence[str] = (),
    arguments: Mapping[str, str] | None = None,
    folder: Path | None = None,
    *,
    formats: Sequence[Format] = ("png", "pdf"),
    style: str | None = None,
    width: float | None = None,
    workers: Workers = 1,
    progress: Progress = silent,
) -> list[Path]:
    """Draw figures, all by default, and write the pictures, the numbers and the caption of each.

    The files of a figure are complete or absent. Pictures and numbers say in their metadata and
    in a first line that begins with # what they are from: the version, the files that the figure
    has read and their hashes, the seed of fits among them and, in `build`, the commit. The same
    inputs give the same bytes, for every number of workers.

    Parameters
    ----------
    root, names, arguments
        As for `draw`; the values of arguments become part of the files' names.
    folder : path, optional
        Where to write; by default `build/figures`.
    formats : sequence of str, optional
        Of png, pdf and svg.
    style, width : optional
        As for `cylcontact.plots.figure_style`.
    workers : int, optional
        Processes that draw.
    progress : callable, optional
        Called with the stage, the number of figures done and their total.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InputError
        As for `draw`, or if a file cannot be written.
    """
    chosen, given = list(dict.fromkeys(names)) or list(recipes(root)), dict(arguments or {})
    for name in chosen:
        _recipe(root, name, given)
    target = folder or root / "build" / "figures"
    stems = ["-".join([name, *map(_part, given.values())]) for name in chosen]
    ends = (*formats, "csv", "txt")
    files = {stem: [target / f"{stem}.{end}" for end in ends] for stem in stems}
    written = list(chain.from_iterable(files.values()))
    require_writable(*written)
    require_apart(written, (root / "datasets").rglob("*.csv"))
    calls = [
        call(_write, root, name, given, files[stem], formats, style, width)
        for name, stem in zip(chosen, stems, strict=True)
    ]
    with closing(run_calls(calls, workers)) as done:
        for number, _ in enumerate(done, 1):
            progress("drawing", number, len(calls))
    return written


def files_with_captions(written: Sequence[Path]) -> list[dict[str, Any]]:
    """Return the files of each figure with its caption."""
    by_figure: dict[str, list[Path]] = {}
    for path in written:
        by_figure.setdefault(path.stem, []).append(path)
    return [
        {
            "figure": name,
            "caption": paths[-1].read_text(encoding="utf-8").strip(),
            "files": [str(path) for path in paths],
        }
        for name, paths in by_figure.items()
    ]


def _write(
    root: Path,
    name: str,
    arguments: Mapping[str, str],
    paths: Sequence[Path],
    formats: Sequence[Format],
    style: str | None,
    width: float | None,
) -> None:
    """Draw one figure and write its files, all of them or none."""
    with figure_style(style, width), replacing_all(paths) as (*pictures, csv, txt):
        with data_read(root) as data:
            figure, table = draw(root, name, arguments)
        module = Path(inspect.getfile(_function(_recipe(root, name, arguments))))
        origin = str(origin_of(root, [*modules_of(module), *data], paths[0]))
        for form, picture in zip(formats, pictures, strict=True):
            save(figure, picture, form, origin)
        with csv.open("w", encoding="utf-8", newline="") as file:
            file.write(f"# {origin}\n")
            table.to_csv(file, **NUMBERS)
        txt.write_text(f"{caption(root, name, arguments)}\n", encoding="utf-8")


def _recipe(root: Path, name: str, arguments: Mapping[str, str]) -> Recipe:
    """Return the function of a figure, which takes these arguments."""
    known = recipes(root)
    if name not in known:
        remedy = f"choose {', '.join(known)}"
        raise InputError("figure", "", name, "there is no such figure", remedy)
    takes = list(inspect.signature(known[name]).parameters)
    for key, value in arguments.items():
        if key not in takes:
            what = f"it takes {', '.join(takes)}" if takes else "it takes none"
            rule = f"is not an argument of this figure; {what}"
            raise InputError(name, key, value, rule, "leave it out")
    return known[name]


def _function(recipe: Recipe) -> Recipe:
    """Return the function of a recipe, which may have some of its arguments already."""
    return recipe.func if isinstance(recipe, partial) else recipe


def _part(value: str) -> str:
    """Return the part of a file's name that an argument's value becomes."""
    short = Path(value).stem if value.endswith(".json") else value
    return re.sub(r"[^\w.+-]+", "-", short)


def _broken(source: str, error: Exception) -> InputError:
    rule = f"failed with {type(error).__name__} ({error})"
    return InputError(source, "", None, rule, "correct the file")
