"""Faults of the file system: the n-th operation on a file in a folder fails, as on a bad disk.

`failing` counts what Python does to files: open one for writing, write to it for the first time,
truncate, flush to disk, close, rename, remove, change permissions, make and remove folders. What
compiled libraries do by themselves it does not see; `no_file_above` stops them too.
"""

import builtins
import errno
import io
import os
from contextlib import contextmanager
from pathlib import Path

ERRORS = ("ENOSPC", "EROFS", "EACCES", "EIO", "ENOENT", "EPIPE")
ON_PATHS = ("replace", "rename", "unlink", "remove", "mkdir", "rmdir", "chmod", "truncate")
ON_HANDLES = ("write", "fsync", "ftruncate", "close")
REMOVING = {"unlink", "remove", "rmdir"}
WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT


class Faults:
    """Counts operations on the files in a folder; the one of this number fails with an error."""

    def __init__(self, folder, number, error):
        self._folder, self._number, self._error = str(folder), number, getattr(errno, error)
        self.count, self.failed = 0, None
        self.handles = set()

    def inside(self, path):
        """Whether a path, or an open file, belongs to the folder."""
        if isinstance(path, int):
            return path in self.handles
        return str(Path.cwd() / os.fsdecode(path)).startswith(self._folder)

    def count_one(self, operation, *path):
        """Count an operation, and fail if its turn has come."""
        self.count += 1
        if self.count == self._number:
            self.failed = operation
            raise OSError(self._error, os.strerror(self._error), *path)


class FaultyFile(io.FileIO):
    """A file opened for writing, whose operations count."""

    def __init__(self, faults, path, mode, opener):
        self._faults = faults
        faults.count_one("open", path)
        super().__init__(path, mode, opener=opener)
        self._begun = False
        faults.handles.add(self.fileno())

    def write(self, data):
        if not self._begun:  # how many there are depends on the sizes of buffers
            self._begun = True
            self._faults.count_one("write")
        return super().write(data)

    def truncate(self, size=None):
        self._faults.count_one("truncate")
        return super().truncate(size)

    def close(self):
        if not self.closed:
            self._faults.handles.discard(self.fileno())
            super().close()
            self._faults.count_one("close")


@contextmanager
def failing(monkeypatch, folder, number, error):
    """Let the operation of this number on the files in a folder fail; 0 for none.

    Yields the `Faults`, which tell afterwards what has failed, if the command came so far.
    """
    faults = Faults(folder, number, error)
    with monkeypatch.context() as patch:
        for name in (*ON_PATHS, *ON_HANDLES):
            patch.setattr(os, name, counted(faults, name))
        patch.setattr(os, "open", opening_handles(faults))
        opening = opening_files(faults)
        patch.setattr(io, "open", opening)
        patch.setattr(builtins, "open", opening)
        yield faults


def counted(faults, name):
    """A function of `os` whose calls count."""
    do = getattr(os, name)

    def operation(where, *others, **options):
        if options.get("dir_fd") is not None or not faults.inside(where):
            return do(where, *others, **options)
        if name == "close":  # the system closes it even if it fails
            faults.handles.discard(where)
            do(where)
            return faults.count_one(name)
        faults.count_one(name, *([] if isinstance(where, int) else [where]))
        return do(where, *others, **options)

    return operation


def opening_handles(faults):
    """The function `os.open`, counting what is opened for writing."""
    opened = os.open

    def open_handle(path, flags, *others, **options):
        if not flags & WRITING or not faults.inside(path):
            return opened(path, flags, *others, **options)
        faults.count_one("open", path)
        handle = opened(path, flags, *others, **options)
        faults.handles.add(handle)
        return handle

    return open_handle


def opening_files(faults):
    """The function `open`, counting what is opened for writing and done to it."""
    opened = io.open

    def open_file(
        file, mode="r", buffering=-1, encoding=None, errors=None, newline=None, closefd=True,
        opener=None,
    ):  # fmt: skip
        if not set(mode) & set("wax+") or isinstance(file, int) or not faults.inside(file):
            return opened(file, mode, buffering, encoding, errors, newline, closefd, opener)
        raw = FaultyFile(faults, os.fspath(file), mode.replace("b", "").replace("t", ""), opener)
        if buffering == 0:
            return raw
        buffered = io.BufferedRandom(raw) if "+" in mode else io.BufferedWriter(raw)
        return buffered if "b" in mode else io.TextIOWrapper(buffered, encoding, errors, newline)

    return open_file


@contextmanager
def no_file_above(size):
    """Let no file grow above some bytes, whoever writes it."""
    import resource

    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def changed(before, after):
    """The paths that are not as they were before, hidden ones too."""
    return {
        name for name in before.keys() | after.keys() if before.get(name, 0) != after.get(name, 0)
    }
