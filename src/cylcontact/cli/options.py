"""Options that several commands share."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from itertools import chain
from pathlib import Path
from typing import Any

import typer
from typer.core import TyperArgument, TyperCommand, TyperGroup

from cylcontact.files.reading import plain_number
from cylcontact.files.units import length_in_mm
from cylcontact.files.writing import require_apart, require_suffix, require_writable
from cylcontact.support.choices import listed
from cylcontact.support.errors import InputError

RESULTS = Path("fitting/results")
# Where outputs go that nothing else names, so that an example changes no committed file.
BUILD = Path("build")
# Where the shipped tables are.
EXAMPLES = Path("datasets/examples")
# Keys of tables of functions, which are slow to import; tests/cli/test_commands.py compares them.
NOISES = ("constant", "proportional", "both")
WIDTHS = ("column", "page")

Read = Callable[[str], Any]


def argument(help: str, default: Any = ..., metavar: str | None = None) -> Any:
    """Return an argument, required by default."""
    return typer.Argument(default, help=help, metavar=metavar)


def option(help: str, *names: str, default: Any = None, **details: Any) -> Any:
    """Return an option; without names it is called like its parameter."""
    return typer.Option(default, *names, help=help, **details)


def flag(help: str, *names: str, default: bool | None = False, **details: Any) -> Any:
    """Return an option without a value."""
    return option(help, *names, default=default, metavar="", **details)


def output(help: str, default: Any = None, metavar: str = "FILE") -> Any:
    """Return the option of what a command writes."""
    return option(help, "-o", "--out", default=default, metavar=metavar)


def reader(read: Read, rule: str) -> Read:
    """Return what reads the text of an option, or its default; `rule` tells of any other text."""

    def parse(given: Any) -> Any:
        try:
            return read(str(given))
        except InputError as error:
            raise typer.BadParameter(f"{given!r}: {error.rule}; {error.remedy}") from None
        except ValueError:
            raise typer.BadParameter(f"{given!r} {rule}") from None

    return parse


NUMBER = reader(plain_number, "is not a number")  # typer's own reader takes 1_700 and nan
LENGTH = reader(length_in_mm, "is not a length; give mm, or e.g. '40 um'")


def number(help: str, *names: str, metavar: str = "NUMBER", **details: Any) -> Any:
    """Return an option of one number."""
    return option(help, *names, parser=NUMBER, metavar=metavar, **details)


def length(help: str, *names: str, **details: Any) -> Any:
    """Return an option of a length in mm, or with its unit."""
    return option(help, *names, parser=LENGTH, metavar="MM", **details)


def count(
    least: int, help: str, *names: str, default: int | None = None, callback: Any = None
) -> Any:
    """Return an option of an integer of at least `least`."""

    def read(text: str) -> int:
        if int(text) < least:
            raise ValueError
        return int(text)

    parse = reader(read, f"must be an integer of at least {least}")
    return option(help, *names, default=default, parser=parse, metavar="N", callback=callback)


def interval(help: str, *names: str, default: Any = None, **details: Any) -> Any:
    """Return an option of two positive numbers."""

    def read(text: str) -> tuple[float, float]:
        low, high = map(plain_number, text.split(":"))
        if not 0 < low < high:
            raise ValueError
        return low, high

    parse = reader(read, "must be two positive numbers, the lower first, e.g. 5:400")
    return option(help, *names, default=default, parser=parse, metavar="LOW:HIGH", **details)


def several(
    help: str, *names: str, of: Read = NUMBER, metavar: str = "NUMBER", **details: Any
) -> Any:
    """Return an option that may be repeated, or hold several values between commas."""

    def parse(text: str) -> list[Any]:
        return [of(part.strip()) for part in text.split(",")]

    return option(
        help, *names, parser=parse, callback=_joined, metavar=f"{metavar}[,...]", **details
    )


def one_of(known: Sequence[str]) -> Read:
    """Return a reader that refuses all but some words."""

    def read(text: str) -> str:
        if text not in known:
            raise typer.BadParameter(f"{text!r} is unknown; choose {listed(known)}")
        return text

    return read


def _joined(values: list[Any] | None) -> list[Any]:
    return [*chain.from_iterable(values or ())]


class _PlainHelp:
    """A command whose help shows no types of Python beside arguments and --help."""

    def get_params(self, ctx: Any) -> Any:
        params = super().get_params(ctx)  # type: ignore[misc]
        for each in params:
            if isinstance(each, TyperArgument):
                vars(each)["display_type_rich"] = lambda **_: ""
            elif each.name in ("help", "install_completion", "show_completion"):
                each.metavar = ""
        return params


class Command(_PlainHelp, TyperCommand):
    """A command of the program."""


class Group(_PlainHelp, TyperGroup):
    """The program, or a command with commands of its own."""


# Options by the names under which a command finds their values, with the type of these.
Options = Mapping[str, tuple[Any, Any]]


def takes(name: str, options: Options) -> Callable[..., Callable[..., None]]:
    """Give a command a set of options, as a dictionary of those that are used.

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
    parameters = [
        inspect.Parameter(key, keyword, default=details, annotation=kind)
        for key, (kind, details) in options.items()
    ]

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


def _existing_folder(folder: Path) -> Path:
    """Refuse a folder of results that does not exist; only the default one may be missing."""
    if folder != RESULTS and not folder.is_dir():
        rule, remedy = "is not a folder", "name one that holds fit results"
        raise InputError("--results", "", str(folder), rule, remedy)
    return folder


def _or_all(jobs: int | None) -> int:
    """Return a number of processes, by default that of the cores this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return jobs or (len(affinity(0)) if affinity else os.cpu_count() or 1)


def _cluster(address: str) -> Any:
    from cylcontact.support.parallel import Cluster

    return Cluster(address)


RESULTS_FOLDER = option(
    "The folder of fit results.", callback=_existing_folder, default=RESULTS, metavar="FOLDER"
)
JOBS = count(1, "Worker processes; all cores by default.", "--jobs", "-j", callback=_or_all)
SCHEDULER = option("A Dask cluster, e.g. tcp://host:8786.", metavar="ADDRESS", parser=_cluster)
MATERIALS = option("Your own materials; datasets/materials.csv by default.", metavar="TABLE")
FORCE = flag("Replace a default output that came from other inputs.", "--force")
RESUME = flag("Continue after an interruption.", "--resume")
JSON = flag("Print JSON.", "--json")
QUIET = flag("No progress and no notes.", "--quiet", "-q")
