"""The command line: `cylcontact sample | fit | simulate | figure | report | …`.

Exit codes: 0 done, 1 a check does not hold, 2 bad input (one line on standard error),
130 interrupted (Ctrl-C, SIGTERM, a closed terminal), 141 the reader of the output has closed.
"""

from __future__ import annotations

import atexit
import gc
import io
import os
import sys
import warnings
from collections.abc import Sequence
from contextlib import suppress

import typer

from cylcontact.cli.app import app
from cylcontact.cli.signals import stopped_by_signals
from cylcontact.cli.terminal import say
from cylcontact.support.errors import InputError
from cylcontact.support.plain_text import in_shell

__all__ = ["main"]


# Libraries make many objects that live as long as the process. Looking through all of them for
# garbage again and again, and once more at the end, takes an eighth of a short command's time.
_OBJECTS_BETWEEN_COLLECTIONS = 50_000
# How numpy's warnings of numbers beyond all others begin. The commands tell what is not finite.
_NOT_FINITE = "(overflow|underflow|invalid value|divide by zero) encountered"
# What the script of `--install-completion` sets.
_COMPLETING = "_CYLCONTACT_COMPLETE"
atexit.register(gc.freeze)


def main() -> None:
    """Run the command line; expected failures become one line and an exit code."""
    if _COMPLETING in os.environ:  # the shell asks how a word may go on
        app(prog_name="cylcontact")
    gc.set_threshold(_OBJECTS_BETWEEN_COLLECTIONS)
    warnings.filterwarnings("ignore", _NOT_FINITE, RuntimeWarning)
    try:
        with stopped_by_signals(), in_shell():
            status = _run(sys.argv[1:])
    except InputError as error:
        status = _fail(str(error))
    except KeyboardInterrupt as stop:
        status = _fail(str(stop) or "interrupted; nothing is left half-written", 130)
    except MemoryError:
        status = _fail("out of memory; use a coarser grid, smaller populations or fewer --jobs")
    except SystemExit as stop:  # rich's way with a reader that has closed
        if not isinstance(stop.__context__, BrokenPipeError):
            raise
        status = 141
    except OSError as error:
        status = _unwritten(error)
    except Exception as error:
        if not hasattr(error, "format_message"):
            raise
        # A mistake on the command line, as typer tells it, and the remedy.
        rule = " ".join(error.format_message().split()).rstrip(".")
        command = getattr(getattr(error, "ctx", None), "command_path", "cylcontact")
        status = _fail(f"{rule}; see {command} --help")
    sys.exit(status)


def _unwritten(error: OSError) -> int:
    """Say what is wrong with a path or with standard output, and return the exit code."""
    if error.filename is not None:  # such as a name that is too long for any file
        return _fail(f"{error.filename}: {error.strerror}; check the path")
    # Errors of other files are InputErrors: this is standard output. Python flushes the rest.
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    if isinstance(error, BrokenPipeError):
        return 141
    return _fail(f"standard output: cannot be written ({error.strerror}); make room")


def _run(arguments: Sequence[str]) -> int:
    """Run one command and return its exit code; errors propagate."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    if "" in arguments:  # typer takes an empty path for the current folder
        rule, remedy = "an argument is empty", "fill it in; a variable of the shell may be unset"
        raise InputError("command line", "", None, rule, remedy)
    command = typer.main.get_command(app)
    try:
        with command.make_context("cylcontact", list(arguments) or ["--help"]) as context:
            command.invoke(context)
    except typer.Exit as stop:
        return stop.exit_code
    return 0


def _fail(message: str, status: int = 2) -> int:
    """Print one line on standard error; return the exit code."""
    with suppress(OSError):  # nobody reads it, and the exit code remains
        say(f"cylcontact: {message}", err=True)
    return status
