"""Options that several commands share."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from copy import copy
from functools import wraps
from itertools import chain
from pathlib import Path
from typing import Any

import typer

from cylcontact.cli.terminal import say
from cylcontact.errors import InputError
from cylcontact.files import require_apart, require_suffix, require_writable
from cylcontact.reading import plain_number
from cylcontact.units import length_in_mm

RESULTS = Path("fitting/results")
# Keys of tables of functions, which are slow to import; tests/cli/test_commands.py compares them.
LOSSES = ("linear", "soft_l1", "huber", "cauchy")
NOISES = ("constant", "proportional", "both")
OPTIMIZERS = ("genetic", "differential-evolution", "least-squares", "descents", "cma")
STYLES = ("journal", "single-column", "double-column", "slides")


def split(values: list[str] | None) -> list[str]:
    """Return the parts of an option that may be repeated, and hold several between commas."""
    return [part.strip() for value in values or () for part in value.split(",")]


def argument(help: str, default: Any = ..., metavar: str | None = None) -> Any:
    """Return an argument, required by default."""
    return typer.Argument(default, help=help, metavar=metavar)


def option(help: str, *names: str, default: Any = None, **details: Any) -> Any:
    """Return an option; without names it is called like its parameter."""
    return typer.Option(default, *names, help=help, **details)


def output(help: str, default: Any = None) -> Any:
    """Return the option of what a command writes."""
    return option(help, "-o", "--out", default=default, metavar="PATH")


def several(help: str, *names: str, metavar: str = "FLOAT[,...]", **details: Any) -> Any:
    """Return an option that may be repeated, or hold several values between commas."""
    return option(help, *names, callback=split, metavar=metavar, **details)


def number(help: str, *names: str, **details: Any) -> Any:
    """Return an option of one number; typer's own reader takes 1_700 and nan."""
    return option(help, *names, parser=_number, metavar="FLOAT", **details)


def _number(given: str | float) -> float:
    """Return the text of an option as a number, or its default."""
    try:
        return plain_number(str(given))
    except ValueError:
        raise typer.BadParameter(f"{given!r} is not a number") from None


def length(help: str, *names: str, **details: Any) -> Any:
    """Return an option of a length in mm, or with its unit."""
    return option(help, *names, parser=_length, metavar="MM", **details)


def _length(given: str | float) -> float:
    """Return the text of an option as a length in mm, or its default."""
    try:
        return length_in_mm(str(given))
    except ValueError:
        rule = f"{given!r} is not a length; give mm, or e.g. '40 um'"
        raise typer.BadParameter(rule) from None


def count(least: int, help: str, *names: str, default: int | None = None) -> Any:
    """Return an option of an integer of at least `least`."""

    def parse(text: str) -> int:
        try:
            integer = int(text)
        except ValueError:
            integer = least - 1
        if integer < least:
            raise typer.BadParameter(f"{text!r} must be an integer of at least {least}")
        return integer

    return option(help, *names, default=default, parser=parse, metavar="N")


def plain_numbers(texts: Sequence[str]) -> list[float] | None:
    """Return texts as numbers; None if one is not a number."""
    try:
        return [plain_number(text) for text in texts]
    except ValueError:
        return None


def numbers(option: str, texts: Sequence[str] | None) -> list[float]:
    """Return texts as numbers; none if the option is not given."""
    values = plain_numbers(texts or ())
    if values is None:
        given, rule = ",".join(texts or ()), "must be numbers separated by commas"
        raise InputError(option, "", given, rule, "e.g. 0.5,0.02")
    return values


# Options by the names under which a command finds their values, with the type of these.
Options = Mapping[str, tuple[Any, Any]]


def takes(name: str, options: Options, listed: bool = True) -> Callable[..., Callable[..., None]]:
    """Give a command a set of options, as a dictionary of those that are used.

    Without `listed` its help leaves them out.

    Examples
    --------
    >>> @takes("size", {"width": (int | None, option("Its width."))})
    ... def draw(name: str, *, size: dict[str, int]) -> None:
    ...     print(name, size)
    >>> list(inspect.signature(draw).parameters)
    ['name', 'width']
    >>> draw(name="box", width=2), draw(name="dot", width=None)
    box {'width': 2}
    dot {}
    (None, None)
    """
    keyword = inspect.Parameter.KEYWORD_ONLY
    parameters = []
    for key, (kind, shown) in options.items():
        details = copy(shown)
        details.hidden = not listed
        parameters.append(inspect.Parameter(key, keyword, default=details, annotation=kind))

    def expand(command: Callable[..., None]) -> Callable[..., None]:
        own = inspect.signature(command, eval_str=True).parameters

        @wraps(command)
        def expanded(**given: Any) -> None:
            used = {key: given.pop(key) for key in options}
            values = {key: value for key, value in used.items() if value not in (None, [])}
            command(**given, **{name: values})

        others = [each.replace(kind=keyword) for each in own.values() if each.name != name]
        expanded.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
            [*others, *parameters]
        )
        return expanded

    return expand


def require_output(path: Path | None, *suffixes: str) -> None:
    """Refuse an output that cannot be written or has none of some suffixes, before any work."""
    if path is not None:
        require_writable(path)
        if suffixes:
            require_suffix(path, *suffixes)


def keep_inputs(command: Callable[..., None]) -> Callable[..., None]:
    """Let a command refuse an output that would replace a file it is given to read."""

    @wraps(command)
    def checked(**given: Any) -> None:
        outputs = [given[name] for name in ("out", "table") if isinstance(given.get(name), Path)]
        values = [value for name, value in given.items() if name not in ("out", "table")]
        named = chain.from_iterable(value if type(value) is list else [value] for value in values)
        require_apart(outputs, [each for each in named if isinstance(each, Path)])
        command(**given)

    return checked


@contextmanager
def resumable(out: Path, part: str) -> Iterator[Path]:
    """Give the path of the journal beside an output, and remove the journal in the end.

    If the block fails, the journal stays. An interruption says how many parts it holds, each
    called "run" or "case". A journal that cannot be removed is no failure: the output is complete.
    """
    journal = out.with_name(out.name + ".partial")
    try:
        yield journal
    except KeyboardInterrupt:
        # The first line is the header.
        count = journal.read_bytes().count(b"\n") - 1 if journal.is_file() else 0
        text = f"interrupted before a {part} was complete; nothing is kept"
        if count > 0:
            parts = f"{part} is" if count == 1 else f"{part}s are"
            text = (
                f"interrupted; {count} complete {parts} kept in {journal}; "
                "the same command with --resume goes on from there"
            )
        raise KeyboardInterrupt(text) from None
    try:
        journal.unlink(missing_ok=True)
    except OSError as error:
        text = f"{journal}: cannot be removed ({error.strerror}), and is no longer needed"
        say(f"cylcontact: {text}", err=True)


def _existing_folder(folder: Path) -> Path:
    """Refuse a folder of results that does not exist; only the default one may be missing."""
    if folder != RESULTS and not folder.is_dir():
        rule, remedy = "is not a folder", "name one that holds fit results"
        raise InputError("--results", "", str(folder), rule, remedy)
    return folder


RESULTS_FOLDER = option("The folder of fit results.", callback=_existing_folder, default=RESULTS)
JOBS = count(1, "Worker processes; all cores by default.", "--jobs", "-j")
SCHEDULER = option("A Dask cluster instead, e.g. tcp://host:8786.", metavar="ADDRESS")
MATERIALS = option("Your own materials; datasets/materials.csv by default.", metavar="TABLE")
FORCE = option("Replace an output that came from other inputs.", "--force", default=False)
RESUME = option("Go on from what an interrupted command left.", "--resume", default=False)
