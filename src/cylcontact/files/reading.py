"""Input files, the version that those of the program say under `format`, numbers in text."""

from __future__ import annotations

import math
import os
import re
from contextlib import suppress
from pathlib import Path
from typing import Any

from cylcontact.support.errors import InputError

# A spec is written by hand; the longest that ships has 4 kB.
SPEC_BYTES = 64_000
FORMAT = 1
# `float` also takes 1_700, other scripts' digits, nan and infinity.
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


def require_file(path: Path | str, remedy: str = "check the path") -> int:
    """Return the size of a file; refuse a device or a pipe, whose reading might never end."""
    file = Path(path)
    try:
        size = file.stat().st_size
    except (OSError, ValueError) as error:  # ValueError of a path that holds a zero byte
        raise _unreadable(path, error, remedy) from error
    if file.is_dir():
        raise _unreadable(path, OSError("Is a directory"), remedy)
    if not file.is_file():
        raise InputError(str(path), "", None, "is a device, a pipe or a socket", "name a file")
    return size


def read_bytes(path: Path | str, remedy: str = "check the path") -> bytes:
    """Return the contents of a file."""
    require_file(path, remedy)
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise _unreadable(path, error, remedy) from error


def read_text(path: Path | str, wanted: str, remedy: str = "check the path") -> str:
    """Return the text of a file in UTF-8; `wanted` is what to give in place of other files."""
    try:
        return read_bytes(path, remedy).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(str(path), "", None, "is not a text file", wanted) from error


def read_spec(path: Path | str, wanted: str) -> str:
    """Return the text of a file that is written by hand; refuse one that is too large for it."""
    if (size := require_file(path)) > SPEC_BYTES:
        rule = f"has {size / 1000:,.0f} kB (at most {SPEC_BYTES / 1000:.0f})"
        raise InputError(str(path), "", None, rule, wanted)
    return read_text(path, wanted)


def _unreadable(path: Path | str, error: Exception, remedy: str) -> InputError:
    """Return the error for a file that the system does not let us read."""
    reason = getattr(error, "strerror", None) or error
    return InputError(str(path), "", None, f"cannot be read ({reason})", remedy)


def beside_or_above(folder: Path, name: Path | str) -> Path | None:
    """Return a file in a folder, in the two above, or here; None if there is none."""
    nearby = (folder, folder / "..", folder / ".." / "..", Path())
    paths = (Path(os.path.normpath(near / name)) for near in nearby)
    with suppress(OSError):  # a name may be too long
        return next((path for path in paths if path.is_file()), None)
    return None


def marked(contents: dict[str, Any]) -> dict[str, Any]:
    """Return the contents of a file with the version, which comes first."""
    return {"format": FORMAT, **contents}


def unmarked(contents: dict[str, Any], source: str) -> dict[str, Any]:
    """Return the contents of a file without the version; refuse another version."""
    version = contents.get("format", FORMAT)
    if version != FORMAT:
        rule = f"is not the version {FORMAT} that this cylcontact reads"
        remedy = "read it with the cylcontact that wrote it, or make it again"
        raise InputError(source, "format", version, rule, remedy)
    return {key: value for key, value in contents.items() if key != "format"}


def plain_number(text: str) -> float:
    """Return a decimal number as a spreadsheet writes it; raise ValueError for any other text."""
    plain = text.strip()
    number = float(plain) if _NUMBER.fullmatch(plain) else math.nan
    if not math.isfinite(number):
        raise ValueError(f"{text!r} is not a number")
    return number
