"""Files that appear complete or not at all."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import takewhile
from pathlib import Path

from cylcontact.errors import InputError

__all__ = [
    "folder_of",
    "remove_leftovers",
    "replacing",
    "require_suffix",
    "require_writable",
    "unwritable",
]


@contextmanager
def replacing(path: Path | str) -> Iterator[Path]:
    """Give a temporary path beside `path` and rename it to `path` when the block succeeds.

    Missing folders are made. If the block fails or is interrupted, `path` is as it was before
    and nothing else is left, no folder either.

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
                with suppress(OSError):  # the error that is told of is the first
                    temporary.unlink(missing_ok=True)


@contextmanager
def folder_of(target: Path) -> Iterator[None]:
    """Make the folder of a file, and remove what was made if nothing has come into it.

    Raises
    ------
    InputError
        If the folder cannot be made.
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
            with suppress(OSError):  # it holds something
                folder.rmdir()


def remove_leftovers(target: Path) -> None:
    """Remove what a killed process had half-written of the same output."""
    name = re.compile(rf"\.{re.escape(target.stem)}-[a-z0-9_]{{8}}{re.escape(target.suffix)}")
    with suppress(OSError):
        for file in target.parent.iterdir():
            if name.fullmatch(file.name):
                file.unlink()


def unwritable(path: Path, error: OSError) -> InputError:
    """Return the error that tells of a file that could not be written."""
    return InputError(
        str(path),
        "",
        None,
        f"cannot be written ({error.strerror or error})",
        "choose a file in a folder you may write to, with room left",
    )


def _to_disk(path: Path) -> None:
    """Wait until a file is on the disk, so that no crash leaves an empty one under its name."""
    with path.open("rb+") as file:
        os.fsync(file.fileno())


def require_suffix(path: Path | str, *suffixes: str) -> str:
    """Return the suffix of an output, one or two of which are possible; refuse another one.

    Raises
    ------
    InputError
        If the name ends otherwise.

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


def require_writable(path: Path | str) -> None:
    """Raise `InputError` now if `path` could not be written later, and leave no trace.

    Long work calls this first, so that it does not fail at its end.
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
    """Say what stands in the way of writing a file, in a few words; nothing where nothing does."""
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
    """Return the process's umask, which can only be read by setting it."""
    mask = os.umask(0)
    os.umask(mask)
    return mask
