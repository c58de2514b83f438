"""Files that appear complete or not at all, each written by one process at a time."""

from __future__ import annotations

import os
import re
import socket
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING

from cylcontact.choices import OUTPUT_SUFFIXES
from cylcontact.errors import InputError
from cylcontact.plain_text import csv_text

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "folder_of",
    "owning",
    "remove_leftovers",
    "replacing",
    "require_suffix",
    "require_writable",
    "shipped_bench",
    "unwritable",
    "write_table",
]


@contextmanager
def replacing(path: Path | str) -> Iterator[Path]:
    """Yield a temporary path next to `path` and rename it to `path` when the block succeeds.

    Missing folders are created. If the block fails or is interrupted, `path` is unchanged, and
    the temporary file and the new folders are removed.

    Parameters
    ----------
    path : path
        The file to write.

    Yields
    ------
    Path
        Where to write, with the suffix of `path`.

    Raises
    ------
    InputError
        If the file cannot be written.

    Examples
    --------
    >>> folder = Path(tempfile.mkdtemp())
    >>> with replacing(folder / "new" / "numbers.txt") as temporary:
    ...     _ = temporary.write_text("1 2 3")
    >>> (folder / "new" / "numbers.txt").read_text()
    '1 2 3'
    """
    target = Path(path)
    require_writable(target)
    temporary = None
    with folder_of(target):
        try:
            handle, name = tempfile.mkstemp(
                prefix=f".{target.stem}-", suffix=target.suffix, dir=target.parent
            )
            os.close(handle)
            temporary = Path(name)
            yield temporary
            _to_disk(temporary)
            temporary.chmod(0o666 & ~_umask())
            temporary.replace(target)
            temporary = None
        except OSError as error:
            raise unwritable(target, error) from error
        finally:
            if temporary is not None:
                with suppress(OSError):  # report the first error, not this one
                    temporary.unlink(missing_ok=True)


@contextmanager
def owning(path: Path | str) -> Iterator[Path]:
    """Lock an output for this process, from before the work until it is written.

    The operating system locks the file NAME.lock beside the output, which names its holder. The
    lock ends with the process: a lock file that a killed process left is used again.

    Parameters
    ----------
    path : path
        The file that will be written.

    Yields
    ------
    Path
        The same.

    Raises
    ------
    InputError
        If another process holds the lock, or the file could not be written.

    Examples
    --------
    >>> path = Path(tempfile.mkdtemp()) / "result.json"
    >>> with owning(path):
    ...     with owning(path):
    ...         pass
    Traceback (most recent call last):
    ...
    cylcontact.errors.InputError: ...result.json: is being written by process ...
    """
    from filelock import FileLock, Timeout

    target = Path(path)
    require_writable(target)
    file = target.with_name(target.name + ".lock")
    lock = FileLock(file, blocking=False, on_acquired=partial(_write_holder, file))
    with folder_of(target):
        try:
            lock.acquire()
        except Timeout:
            raise InputError(
                str(target),
                "",
                None,
                f"is being written by {_holder(file)}",
                "wait for it to end, or choose another output with -o",
            ) from None
        except OSError as error:
            raise unwritable(file, error) from error
        try:
            remove_leftovers(target)
            yield target
        finally:
            with suppress(OSError):  # Windows lets filelock alone remove it
                file.unlink()
            lock.release()


def _write_holder(lock: Path, handle: int) -> None:
    """Write into an open lock file who holds the lock; remove it if the disk is full."""
    try:
        os.truncate(handle, 0)
        os.write(handle, f"process {os.getpid()} on {socket.gethostname()}\n".encode())
    except OSError:
        lock.unlink(missing_ok=True)
        raise


def _holder(lock: Path) -> str:
    """Return who holds a lock, from its file, which Windows lets nobody else read."""
    holder = ""
    with suppress(OSError):
        holder = lock.read_text(encoding="utf-8", errors="replace").strip()
    return holder or "another process"


@contextmanager
def folder_of(target: Path) -> Iterator[None]:
    """Create the folder of a file, and remove the folders created if they stay empty.

    Raises
    ------
    InputError
        If the folder cannot be created.
    """
    parents = (target.parent, *target.parent.parents)
    made = list(takewhile(lambda folder: not folder.exists(), parents))
    try:
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise unwritable(target, error) from error
        yield
    finally:
        for folder in made:
            with suppress(OSError):  # not empty
                folder.rmdir()


def remove_leftovers(target: Path) -> None:
    """Remove the temporary files that a killed process left of the same output."""
    name = re.compile(rf"\.{re.escape(target.stem)}-[a-z0-9_]{{8}}{re.escape(target.suffix)}")
    with suppress(OSError):
        for file in target.parent.iterdir():
            if name.fullmatch(file.name):
                file.unlink()


def unwritable(path: Path, error: OSError) -> InputError:
    """Return the error for a file that could not be written."""
    return InputError(
        str(path),
        "",
        None,
        f"cannot be written ({error.strerror or error})",
        "choose a file in a folder you may write to, with room left",
    )


def _to_disk(path: Path) -> None:
    """Flush a file to disk, so that a crash cannot leave an empty file under the final name."""
    with path.open("rb+") as file:
        os.fsync(file.fileno())


def require_suffix(path: Path | str, *suffixes: str) -> str:
    """Return the suffix of an output path, one or two of which are allowed.

    Raises
    ------
    InputError
        If the path has another suffix.

    Examples
    --------
    >>> require_suffix("build/table.csv", ".csv", ".parquet")
    '.csv'
    """
    suffix = Path(path).suffix
    if suffix not in suffixes:
        known = (
            f"not a {suffixes[0]}" if len(suffixes) == 1 else f"neither {' nor '.join(suffixes)}"
        )
        raise InputError(str(path), "", None, f"is {known}", "name the output so that it is one")
    return suffix


def write_table(table: pd.DataFrame, path: Path | str) -> None:
    """Write a table as .csv or .parquet; it appears complete or not at all."""
    suffix = require_suffix(path, *OUTPUT_SUFFIXES)
    with replacing(path) as temporary:
        if suffix == ".csv":
            temporary.write_text(csv_text(table), encoding="utf-8")
        else:
            table.to_parquet(temporary, index=False)


def require_writable(path: Path | str) -> None:
    """Raise `InputError` if `path` cannot be written; create nothing.

    Call it before long computations, so that they do not fail when they write their result.
    """
    target = Path(path)
    try:
        problem = _obstacle(target)
    except OSError as error:
        problem = error.strerror or str(error)
    if problem:
        raise InputError(
            str(target),
            "",
            None,
            f"cannot be written ({problem})",
            "choose a file in a folder you may write to",
        )


def _obstacle(target: Path) -> str:
    """Return why a file cannot be written, in a few words; empty if it can be."""
    if any("\ud800" <= character <= "\udfff" for character in str(target)):
        return "its name is not text"
    if target.is_dir():
        return "it is a folder"
    existing = next((folder for folder in target.parents if folder.exists()), Path())
    if not existing.is_dir():
        return f"{existing} is not a folder"
    if not os.access(existing, os.W_OK | os.X_OK):
        return f"no permission to write in {existing}"
    return ""


def _umask() -> int:
    """Return the umask of the process, which can only be read by setting it."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


def shipped_bench() -> Path:
    """Return the folder of the shipped bench: in the package, or the checkout around it."""
    package = Path(__file__).parent
    return package / "bench" if (package / "bench").is_dir() else package.parents[1]
