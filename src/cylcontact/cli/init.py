"""The command `init`."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from fnmatch import fnmatch
from pathlib import Path

from cylcontact.cli.options import QUIET, argument
from cylcontact.cli.terminal import note
from cylcontact.files.writing import replacing_all, require_writable, shipped_bench
from cylcontact.support.choices import first_of
from cylcontact.support.errors import InputError

FOLDERS = ("datasets", "fitting", "notebooks", "reports")
# Files that commands and users add to a checkout; a wheel has none of them.
_NOT_SHIPPED = (
    *("__pycache__", ".*", "figures", "generated", "html", "typeset"),
    *("mine*", "materials.csv", "*.lock", "*.partial"),
)
# A link of Markdown to the pages, which lie beside these folders in a checkout only.
_NOT_THERE = re.compile(rb"\[([^]]*)\]\((?:\.\./)+docs/[^)]*\)")


def init(
    folder: Path = argument(
        "The folder; the current one by default.", metavar="FOLDER", default=Path()
    ),
    quiet: bool = QUIET,
) -> None:
    """Write datasets, campaigns, figures and notebooks into a folder."""
    source = shipped_bench()
    names = shipped_files(source)
    missing = _missing(source, folder, names)
    with replacing_all(folder / name for name in missing) as temporaries:
        for temporary, name in zip(temporaries, missing, strict=True):
            temporary.write_bytes(_content(source / name))
    note(f"{len(names)} files in {folder.resolve()}: {', '.join(FOLDERS)}", quiet)
    note("in that folder, try: cylcontact figure fig12", quiet)


def shipped_files(source: Path) -> list[Path]:
    """Return the files of the shipped bench, relative to its folder."""
    names = [
        path.relative_to(source)
        for top in FOLDERS
        for path in (source / top).rglob("*")
        if path.is_file()
    ]
    return sorted(
        name
        for name in names
        if not any(fnmatch(part, pattern) for part in name.parts for pattern in _NOT_SHIPPED)
    )


def _content(file: Path) -> bytes:
    """Return what is written of a file: of a link to a page that is not shipped its text."""
    content = file.read_bytes()
    return _NOT_THERE.sub(rb"\1", content) if file.suffix == ".md" else content


def _missing(source: Path, folder: Path, names: Iterable[Path]) -> list[Path]:
    """Return the files missing in a folder; refuse a folder with other files of these names."""
    require_writable(folder / "any")
    missing, taken = [], []
    for name in names:
        file = folder / name
        if not os.path.lexists(file):
            missing.append(name)
        elif not (file.is_file() and file.read_bytes() == _content(source / name)):
            taken.append(str(name))
    if taken:
        rule = f"has other files named {first_of(taken, 3)}, and nothing is overwritten"
        raise InputError(str(folder), "", None, rule, "choose an empty folder, or move these away")
    require_writable(*(folder / name for name in missing))
    return missing
