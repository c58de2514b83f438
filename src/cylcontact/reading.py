"""Input files, read whole once they are known to be files and not too large; plain numbers."""

from __future__ import annotations

import errno
import math
import os
import re
import stat
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from cylcontact.errors import InputError
from cylcontact.memory import as_size

__all__ = [
    "JOURNAL_BYTES",
    "RESULT_BYTES",
    "SPEC_BYTES",
    "TABLE_BYTES",
    "beside_or_above",
    "first_file",
    "plain_integer",
    "plain_number",
    "read_bytes",
    "read_text",
    "require_file",
]

# Written by hand; the longest that ships has 4 kB.
SPEC_BYTES = 1_000_000
# A fit to the 200,000 rows that a table may have writes some 10 MB.
RESULT_BYTES = 100_000_000
# 200,000 rows of 500 characters.
TABLE_BYTES = 100_000_000
# 100,000 runs, the most of a campaign, of 2 kB each.
JOURNAL_BYTES = 200_000_000
# `float` and `int` also take 1_700, other scripts' digits, nan and infinity.
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_INTEGER = re.compile(r"[+-]?[0-9]+")


def require_file(path: Path | str, most: int, remedy: str = "check the path") -> None:
    """Raise `InputError` unless a path is of a file of at most `most` bytes.

    A folder, a device or a pipe is not opened: reading it might never end.

    Raises
    ------
    InputError
        If it is not, or does not exist.
    """
    try:
        status = Path(path).stat()
        if stat.S_ISDIR(status.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    except (OSError, ValueError) as error:  # ValueError of a path that holds a zero byte
        raise _unreadable(path, error, remedy) from error
    if not stat.S_ISREG(status.st_mode):
        rule = "is a device, a pipe or a socket"
        raise InputError(str(path), "", None, rule, "name a file")
    if status.st_size > most:
        rule = f"is {as_size(status.st_size)} (at most {as_size(most)})"
        raise InputError(str(path), "", None, rule, "make it smaller, or name another file")


def read_bytes(path: Path | str, most: int, remedy: str = "check the path") -> bytes:
    """Return the contents of a file.

    Parameters
    ----------
    path : path
        The file.
    most : int
        The bytes that it may have.
    remedy : str, optional
        For the error if it cannot be read.

    Raises
    ------
    InputError
        If it cannot be read, is not a file, or is larger.
    """
    require_file(path, most, remedy)
    try:
        with Path(path).open("rb") as file:
            return file.read(most)
    except OSError as error:
        raise _unreadable(path, error, remedy) from error


def read_text(path: Path | str, most: int, wanted: str, remedy: str = "check the path") -> str:
    """Return the text of a file in UTF-8, without a byte order mark.

    Parameters
    ----------
    path, most, remedy
        As for `read_bytes`.
    wanted : str
        What to give in place of a file that is not text.

    Raises
    ------
    InputError
        As `read_bytes`, and if it is not in UTF-8.
    """
    try:
        return read_bytes(path, most, remedy).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(str(path), "", None, "is not a text file", wanted) from error


def beside_or_above(folder: Path, name: str) -> Path | None:
    """Return a file in a folder, in the two above, or here; None if there is none."""
    places = (folder, folder / "..", folder / ".." / "..", Path())
    return first_file(place / name for place in places)


def first_file(places: Iterable[Path]) -> Path | None:
    """Return the first of several paths that is a file; None if none is."""
    with suppress(OSError):  # the name is too long, or the folder unreadable
        return next((place for place in places if place.is_file()), None)
    return None


def plain_number(text: str) -> float:
    """Return a decimal number as a spreadsheet writes it, in ASCII and finite.

    Raises
    ------
    ValueError
        If the text is anything else.

    Examples
    --------
    >>> plain_number("1.7e3"), plain_number(" +.5 ")
    (1700.0, 0.5)
    >>> plain_number("1_700")
    Traceback (most recent call last):
    ValueError: '1_700' is not a number
    """
    plain = text.strip()
    number = float(plain) if _NUMBER.fullmatch(plain) else math.nan
    if not math.isfinite(number):
        raise ValueError(f"{text!r} is not a number")
    return number


def plain_integer(text: str) -> int:
    """Return a whole number in ASCII digits.

    Raises
    ------
    ValueError
        If the text is anything else.
    """
    if not _INTEGER.fullmatch(text.strip()):
        raise ValueError(f"{text!r} is not an integer")
    return int(text)


def _unreadable(path: Path | str, error: Exception, remedy: str) -> InputError:
    """Return the error for a file that the system does not let us read."""
    reason = getattr(error, "strerror", None) or error
    return InputError(str(path), "", None, f"cannot be read ({reason})", remedy)
