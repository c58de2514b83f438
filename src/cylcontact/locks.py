"""One process at a time on one output."""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from cylcontact.errors import InputError
from cylcontact.files import folder_of, remove_leftovers, require_writable, unwritable

# Windows locks bytes, and nobody can read them meanwhile: one far behind the text.
_LOCKED_BYTE = 1 << 20


@contextmanager
def owning(path: Path | str) -> Iterator[Path]:
    """Hold an output for this process, from before the work until it is written.

    The lock is the operating system's, on a file NAME.lock beside the output that says who holds
    it. It ends with the process, however that ends: a file that a killed one left behind locks
    nothing and is used again.

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
        If another process holds it, or it could not be written.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "result.json"
    >>> with owning(path):
    ...     with owning(path):
    ...         pass
    Traceback (most recent call last):
    ...
    cylcontact.errors.InputError: ...result.json: is being written by process ...
    """
    target = Path(path)
    require_writable(target)
    lock = target.with_name(target.name + ".lock")
    with folder_of(target):
        try:
            handle = _acquire(lock)
        except OSError as error:
            raise unwritable(lock, error) from error
        if handle is None:
            raise InputError(
                str(target),
                "",
                None,
                f"is being written by {_holder(lock)}",
                "wait for it to end, or choose another output with -o",
            )
        try:
            remove_leftovers(target)
            yield target
        finally:
            _release(lock, handle)


def _acquire(lock: Path) -> int | None:
    """Return the open, locked file; None where another process holds it."""
    while True:
        handle = os.open(lock, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            if not _lock(handle):
                os.close(handle)
                return None
            # The one before may have removed the file between our two steps.
            if _is_at(handle, lock):
                os.truncate(handle, 0)
                os.write(handle, f"process {os.getpid()} on {socket.gethostname()}\n".encode())
                return handle
        except BaseException:
            _release(lock, handle)
            raise
        os.close(handle)


def _release(lock: Path, handle: int) -> None:
    """Remove the file and let go of it; Windows removes closed files only."""
    with suppress(OSError):
        if sys.platform == "win32":
            os.close(handle)
            lock.unlink()
            return
        if _is_at(handle, lock):
            lock.unlink()
        os.close(handle)


def _is_at(handle: int, path: Path) -> bool:
    """Tell whether an open file is the one at a path."""
    try:
        return os.path.samestat(os.fstat(handle), path.stat())
    except FileNotFoundError:
        return False


def _lock(handle: int) -> bool:
    """Lock an open file without waiting; False where another process has."""
    try:
        if sys.platform == "win32":
            import msvcrt

            os.lseek(handle, _LOCKED_BYTE, os.SEEK_SET)
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
            os.lseek(handle, 0, os.SEEK_SET)
        else:
            import fcntl

            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    return True


def _holder(lock: Path) -> str:
    """Return who holds a lock, as its file says."""
    with suppress(OSError):
        said = lock.read_text(encoding="utf-8", errors="replace").strip()
        if said:
            return said
    return "another process"
