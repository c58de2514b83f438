"""Options that several commands share."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from copy import copy
from dataclasses import fields, is_dataclass
from functools import wraps
from itertools import chain
from pathlib import Path
from typing import Annotated, Any, get_args

import typer

from cylcontact.cli.terminal import say
from cylcontact.errors import InputError
from cylcontact.files import require_apart
from cylcontact.reading import plain_number

RESULTS = Path("fitting/results")
# Keys of tables of functions, which are slow to import; tests/cli/test_choices.py compares them.
LOSSES = ("linear", "soft_l1", "huber", "cauchy")
NOISES = ("constant", "proportional", "both")
OPTIMIZERS = ("genetic", "differential-evolution", "least-squares", "descents", "cma")
STYLES = ("journal", "single-column", "double-column", "slides")
TABLES = ("latex", "csv", "html")


def split(values: list[str] | None) -> list[str]:
    """Return the parts of an option that may be repeated, and hold several between commas."""
    return [part.strip() for value in values or () for part in value.split(",")]


def integer_from(least: int) -> Callable[[str], int]:
    """Return a parser of integers of at least `least`."""

    def parse(text: str) -> int:
        try:
            number = int(text)
        except ValueError:
            number = least - 1
        if number < least:
            raise typer.BadParameter(f"{text!r} must be an integer of at least {least}")
        return number

    return parse


def _number(given: str | float) -> float:
    """Return the text of an option as a number, or its default."""
    try:
        return plain_number(str(given))
    except ValueError:
        raise typer.BadParameter(f"{given!r} is not a number") from None


# What an option of one number gives to typer, whose own reader takes 1_700 and nan.
NUMBER: dict[str, Any] = {"parser": _number, "metavar": "FLOAT"}


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


def expand_options(command: Callable[..., None], hide: Collection[str] = ()) -> Callable[..., None]:
    """Declare every field of a command's dataclass parameters as an option of its own.

    The help does not list those to `hide`.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass
    ... class Size:
    ...     width: int = 1
    >>> @expand_options
    ... def draw(name: str, *, size: Size) -> None:
    ...     print(name, size)
    >>> inspect.signature(draw)
    <Signature (*, name: str, width: int = 1)>
    >>> draw(name="box", width=2)
    box Size(width=2)
    """
    parameters = inspect.signature(command, eval_str=True).parameters
    groups: dict[str, Any] = {
        name: parameter.annotation
        for name, parameter in parameters.items()
        if is_dataclass(parameter.annotation)
    }
    options = []
    for name, parameter in parameters.items():
        group = groups.get(name)
        own = inspect.signature(group, eval_str=True).parameters.values() if group else [parameter]
        options += [option.replace(kind=inspect.Parameter.KEYWORD_ONLY) for option in own]
    options = [_hidden(option) if option.name in hide else option for option in options]

    @wraps(command)
    def expanded(**given: Any) -> None:
        for name, group in groups.items():
            given[name] = group(**{field.name: given.pop(field.name) for field in fields(group)})
        command(**given)

    expanded.__signature__ = inspect.Signature(options)  # type: ignore[attr-defined]
    return expanded


def _hidden(option: inspect.Parameter) -> inspect.Parameter:
    """Return an option that the help does not list."""
    kind, details = get_args(option.annotation)
    details = copy(details)
    details.hidden = True
    return option.replace(annotation=Annotated[kind, details])


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
        raise InputError(
            "--results", "", str(folder), "is not a folder", "name one that holds fit results"
        )
    return folder


Results = Annotated[
    Path,
    typer.Option("--results", callback=_existing_folder, help="The folder of fit results."),
]
Jobs = Annotated[
    int | None,
    typer.Option(
        "--jobs",
        "-j",
        parser=integer_from(1),
        metavar="INTEGER",
        help="Worker processes; all cores by default.",
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option(metavar="ADDRESS", help="A Dask cluster instead, e.g. tcp://host:8786."),
]
Materials = Annotated[
    str | None,
    typer.Option(
        "--materials", help="A table of your own materials; datasets/materials.csv by default."
    ),
]
Force = Annotated[
    bool, typer.Option("--force", help="Replace an output that came from other inputs.")
]
Resume = Annotated[
    bool, typer.Option("--resume", help="Go on from what an interrupted command left.")
]
