"""Files that appear complete or not at all, each written by one process at a time."""

from __future__ import annotations

import os
import re
import secrets
import socket
import stat
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from contextvars import ContextVar
from functools import partial
from itertools import takewhile
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir
from typing import TYPE_CHECKING, Any

from cylcontact.choices import OUTPUT_SUFFIXES
from cylcontact.errors import InputError
from cylcontact.plain_text import csv_text

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "folder_of",
    "keeping",
    "owning",
    "remove_leftovers",
    "replacing",
    "replacing_all",
    "require_parquet",
    "require_suffix",
    "require_writable",
    "scratch_folder",
    "shipped_bench",
    "unwritable",
    "what_else",
    "write_table",
]


@contextmanager
def replacing(path: Path | str) -> Iterator[Path]:
    """Yield a temporary path next to `path` and rename it to `path` when the block succeeds.

    Missing folders are created. If the block fails or is interrupted, `path` is unchanged, and
    the temporary file and the new folders are removed. A file that is replaced keeps its
    permissions and, where the user may give it away, its owner.

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
    >>> from tempfile import mkdtemp
    >>> folder = Path(mkdtemp())
    >>> with replacing(folder / "new" / "numbers.txt") as temporary:
    ...     _ = temporary.write_text("1 2 3")
    >>> (folder / "new" / "numbers.txt").read_text()
    '1 2 3'
    """
    with replacing_all([path]) as (temporary,):
        yield temporary


@contextmanager
def replacing_all(paths: Iterable[Path | str]) -> Iterator[list[Path]]:
    """Do what `replacing` does for files that belong together: none appears before all are written.

    Raises
    ------
    InputError
        If one of them cannot be written.

    Examples
    --------
    >>> from tempfile import mkdtemp
    >>> folder = Path(mkdtemp())
    >>> with replacing_all([folder / "law.h", folder / "law.c"]) as temporaries:
    ...     for temporary in temporaries:
    ...         _ = temporary.write_text("...")
    >>> sorted(path.name for path in folder.iterdir())
    ['law.c', 'law.h']
    """
    targets = [Path(path) for path in paths]
    require_writable(*targets)
    # They have their names before they are there, so that no interruption leaves one.
    temporaries = [_temporary(target) for target in targets]
    with ExitStack() as folders:
        for target in targets:
            folders.enter_context(folder_of(target))
        place = targets[0] if len(targets) == 1 else targets[0].parent
        try:
            for temporary, target in zip(temporaries, targets, strict=True):
                _create(temporary, target)
            yield temporaries
            for temporary, target in zip(temporaries, targets, strict=True):
                _to_disk(temporary, target)
            for temporary, target in zip(temporaries, targets, strict=True):
                temporary.replace(target)
        except OSError as error:
            raise unwritable(place, error) from error
        finally:
            for temporary in temporaries:
                with suppress(OSError):  # report the first error, not this one
                    temporary.unlink(missing_ok=True)


def _temporary(target: Path) -> Path:
    """Return a new name beside a file, which `remove_leftovers` knows."""
    return target.with_name(f".{target.stem}-{secrets.token_hex(8)}{target.suffix}")


def _create(temporary: Path, target: Path) -> None:
    """Create an empty file that no more people can read than the one it will replace."""
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL
    os.close(os.open(temporary, flags, 0o200 | (_mode(target) or 0o666)))


def _mode(target: Path) -> int | None:
    """Return the permissions of a file, None if there is none."""
    with suppress(FileNotFoundError):
        return stat.S_IMODE(target.lstat().st_mode)
    return None


def _to_disk(temporary: Path, target: Path) -> None:
    """Give a file the owner and permissions of the one it replaces, and flush it to disk.

    Otherwise a crash could leave an empty file under the final name.
    """
    with temporary.open("rb+") as file:
        with suppress(FileNotFoundError):
            before = target.lstat()
            if hasattr(os, "chown"):
                with suppress(OSError):  # only root may give files away
                    os.chown(temporary, before.st_uid, before.st_gid)
            temporary.chmod(stat.S_IMODE(before.st_mode))
        os.fsync(file.fileno())


@contextmanager
def scratch_folder(within: Path | None = None) -> Iterator[Path]:
    """Make a folder for temporary files, which is removed in the end.

    Parameters
    ----------
    within : path, optional
        Where to make it; by default where the system keeps temporary files.

    Raises
    ------
    InputError
        If a file in it cannot be written.
    """
    try:
        # Workers that were killed may have left files in it that are still open.
        with TemporaryDirectory(
            prefix="cylcontact-", dir=within, ignore_cleanup_errors=True
        ) as name:
            yield Path(name)
    except OSError as error:
        raise InputError(
            str(error.filename or within or gettempdir()),
            "",
            None,
            f"cannot be used for temporary files ({error.strerror or error})",
            "make room, or set TMPDIR to another folder",
        ) from error


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
    >>> from tempfile import mkdtemp
    >>> path = Path(mkdtemp()) / "result.json"
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
    require_writable(file)
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
    name = re.compile(rf"\.{re.escape(target.stem)}-[0-9a-f]{{16}}{re.escape(target.suffix)}")
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


def require_suffix(path: Path | str, *suffixes: str) -> str:
    """Return the suffix of an output path, one or two of which are allowed.

    Raises
    ------
    InputError
        If the path has another suffix, or Parquet's library is not installed.

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
    if suffix == ".parquet":
        require_parquet(path)
    return suffix


def require_parquet(path: Path | str) -> Any:
    """Return pyarrow, which the Parquet file `path` needs and nothing else does."""
    try:
        import pyarrow.parquet
    except ImportError:
        remedy = "pip install 'cylcontact[parquet]', or make extras"
        raise InputError(str(path), "", None, "needs the extra 'parquet'", remedy) from None
    return pyarrow


def write_table(table: pd.DataFrame, path: Path | str) -> None:
    """Write a table as .csv or .parquet; it appears complete or not at all."""
    suffix = require_suffix(path, *OUTPUT_SUFFIXES)
    with replacing(path) as temporary:
        if suffix == ".csv":
            temporary.write_text(csv_text(table), encoding="utf-8")
        else:
            table.to_parquet(temporary, index=False)


@contextmanager
def keeping(inputs: Iterable[Path]) -> Iterator[None]:
    """Let no output of the block replace one of its inputs.

    Examples
    --------
    >>> from tempfile import mkdtemp
    >>> path = Path(mkdtemp()) / "result.json"
    >>> path.touch()
    >>> with keeping([path]):
    ...     require_writable(path)
    Traceback (most recent call last):
    ...
    cylcontact.errors.InputError: ...: cannot be written (it is an input); choose another file
    """
    before = _inputs.set((*_inputs.get(), *inputs))
    try:
        yield
    finally:
        _inputs.reset(before)


_inputs: ContextVar[tuple[Path, ...]] = ContextVar("inputs", default=())


def require_writable(*paths: Path | str) -> None:
    """Raise `InputError` if one of some files cannot be written; create nothing.

    Call it before long computations, so that they do not fail when they write their result.
    """
    for target in map(Path, paths):
        remedy = "choose a file in a folder you may write to"
        try:
            problem = _obstacle(target)
        except OSError as error:
            problem = error.strerror or str(error)
        if not problem and _is_input(target):
            problem, remedy = "it is an input", "choose another file"
        if problem:
            remedy = _instead_of_link(target) or remedy
            raise InputError(str(target), "", None, f"cannot be written ({problem})", remedy)


def _obstacle(target: Path) -> str:
    """Return why a file cannot be written, in a few words; empty if it can be."""
    if any("\ud800" <= character <= "\udfff" for character in str(target)):
        return "its name is not text"
    existing = next((folder for folder in target.parents if os.path.lexists(folder)), Path())
    if not existing.is_dir():
        return f"{existing} is not a folder"
    if ".." in target.parts[len(existing.parts) :]:
        return "it leads through a folder that does not exist"
    if problem := what_else(target):
        return problem
    if not os.access(existing, os.W_OK | os.X_OK):
        return f"no permission to write in {existing}"
    with suppress(FileNotFoundError):
        _temporary(target).lstat()  # its name may be too long
    return ""


def what_else(path: Path) -> str:
    """Return what is at a path if it is neither a file nor nothing; otherwise nothing.

    Examples
    --------
    >>> what_else(Path("no such file")), what_else(Path("/"))
    ('', 'it is a folder')
    """
    # Whoever may not look into the folder is told that he may not write there either.
    with suppress(FileNotFoundError, NotADirectoryError, PermissionError):
        kind = stat.S_IFMT(path.lstat().st_mode)
        return "" if kind == stat.S_IFREG else _KINDS.get(kind, "it is no regular file")
    return ""


_KINDS = {
    stat.S_IFLNK: "it is a link",
    stat.S_IFDIR: "it is a folder",
    stat.S_IFIFO: "it is a named pipe",
    stat.S_IFSOCK: "it is a socket",
    stat.S_IFCHR: "it is a device",
    stat.S_IFBLK: "it is a device",
}


def _instead_of_link(output: Path) -> str:
    """Return what to name instead of a link to a file; nothing if it is no such link."""
    with suppress(OSError, RuntimeError):  # of a link to itself
        pointed = output.resolve()
        if output.is_symlink() and not what_else(pointed):
            return f"name the file it points to, {pointed}"
    return ""


def _is_input(target: Path) -> bool:
    """Return whether a file is one of the inputs, by this or another name."""
    for file in _inputs.get():
        with suppress(OSError, ValueError):  # one of them is no file
            if file.samefile(target):
                return True
    return False


def shipped_bench() -> Path:
    """Return the folder of the shipped bench: in the package, or the checkout around it."""
    package = Path(__file__).parent
    return package / "bench" if (package / "bench").is_dir() else package.parents[1]
