"""Many figures at once: each drawn in a process of its own, or missing with the reason."""

from __future__ import annotations

import gc
import hashlib
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path

from cylcontact.errors import InputError
from cylcontact.files import remove_leftovers
from cylcontact.parallel import Workers, call, run_calls
from cylcontact.plots.style import Choice
from cylcontact.reports.bench import Bench
from cylcontact.reports.build import draw, require_programs, write

# The stage, what is done of it, and how much there is.
Progress = Callable[[str, int, int], None]

PACKAGE = Path(__file__).parents[1]


@dataclass(frozen=True)
class Outcome:
    """What became of one recipe.

    Attributes
    ----------
    name : str
        The recipe's name.
    paths : tuple of path
        The pictures, in the order of the formats, and the CSV; none where it failed.
    caption : str
        The figure's caption.
    headline : mapping of str to float
        The numbers that sum it up.
    inputs : mapping of str to str
        The files that it was drawn from → the first twelve digits of their SHA-256.
    size_mm : tuple of float
        Width and height.
    problem : InputError or None
        Why there is no figure.
    """

    name: str
    paths: tuple[Path, ...] = ()
    caption: str = ""
    headline: Mapping[str, float] = field(default_factory=dict)
    inputs: Mapping[str, str] = field(default_factory=dict)
    size_mm: tuple[float, float] = (0.0, 0.0)
    problem: InputError | None = None


@dataclass(frozen=True)
class WatchedBench(Bench):
    """A bench that notes which files a recipe reads from it."""

    read: list[Path] = field(default_factory=list)

    def noted(self, path: Path) -> Path:
        """Return a file that is about to be read, and note it."""
        self.read.append(path)
        return path


def draw_all(
    bench: Bench,
    names: Sequence[str],
    folder: Path,
    choice: Choice,
    jobs: Workers = 1,
    progress: Progress = lambda *_: None,
) -> list[Outcome]:
    """Draw figures over processes, and write the files of each that succeeds.

    Parameters
    ----------
    bench : Bench
        Where the recipes and their inputs lie.
    names : sequence of str
        Recipes that exist.
    folder : path
        Where to write.
    choice : Choice
        The style and the formats.
    jobs : int
        Worker processes; the files do not depend on it.
    progress : callable, optional
        Called with the stage, the number of figures done and their total.

    Returns
    -------
    list of Outcome
        In the order of the names; a recipe that failed has the reason and no files.

    Raises
    ------
    InputError
        If a format needs a program that is absent, or a worker was ended by the system.
    """
    require_programs(choice.formats)
    work = [call(attempt, bench, name, folder, choice) for name in names]
    outcomes: list[Outcome] = []
    progress("drawing", 0, len(names))
    try:
        with closing(run_calls(work, jobs)) as found:
            for outcome in found:
                outcomes.append(outcome)
                progress("drawing", len(outcomes), len(names))
    except BaseException:  # the workers have been killed, some of them while they were writing
        for name in names:
            for ending in (*choice.formats, "csv"):
                remove_leftovers(folder / f"{name}.{ending}")
        raise
    return outcomes


def attempt(bench: Bench, name: str, folder: Path, choice: Choice) -> Outcome:
    """Draw and write one figure, or say why not; a recipe's own mistake is no exception.

    Parameters
    ----------
    bench : Bench
        Where the recipe and its inputs lie.
    name : str
        The recipe's name.
    folder : path
        Where to write.
    choice : Choice
        The style and the formats.

    Returns
    -------
    Outcome
    """
    watched = WatchedBench(bench.root, bench.results)
    try:
        drawing = draw(name, watched, choice.style)
        paths = write(drawing, name, folder, choice)
    except InputError as error:
        return Outcome(name, inputs=_inputs(watched, name), problem=error)
    except Exception as error:
        return Outcome(name, inputs=_inputs(watched, name), problem=_mistake(watched, name, error))
    width, height = (float(inches) * 25.4 for inches in drawing.figure.get_size_inches())
    # A figure is a web of references; left to itself it would stay until a worker looks leaky.
    drawing.figure.clear()
    gc.collect()
    return Outcome(
        name,
        paths,
        drawing.caption,
        dict(drawing.headline),
        _inputs(watched, name),
        (width, height),
    )


def _mistake(bench: Bench, name: str, error: Exception) -> InputError:
    """Return a recipe's mistake in one line."""
    return InputError(
        str(bench.recipes_folder / f"{name}.py"),
        "draw",
        None,
        f"failed with {type(error).__name__} ({error})",
        "correct the recipe",
    )


def _inputs(bench: WatchedBench, name: str) -> dict[str, str]:
    """Return the recipe and the files that it read, each with the start of its hash."""
    files = dict.fromkeys([bench.recipes_folder / f"{name}.py", *bench.read])
    return {
        _name_of(file, bench.root): hashlib.sha256(file.read_bytes()).hexdigest()[:12]
        for file in files
        if file.is_file()
    }


def _name_of(file: Path, root: Path) -> str:
    """Return a file's path in the package or below the bench's root, or else the whole of it."""
    for folder in (PACKAGE.parent, root):
        if file.is_relative_to(folder):
            return file.relative_to(folder).as_posix()
    return str(file)
