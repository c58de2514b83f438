"""Provenance: versions, the git commit, and hashes of what a result or a figure is made from."""

from __future__ import annotations

import ast
import hashlib
import json
import os
import platform
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

# Every file of the repository except results, so that a second result made at a commit is as
# clean as the first.
_SOURCES = ("--", ":/", ":(top,exclude,glob)**/results/**")


def made_with(
    folder: Path, specs: Mapping[str, dict[str, Any]], libraries: Iterable[str]
) -> dict[str, Any]:
    """Return the versions of the package and of libraries, the git commit, hashes of the specs.

    The commit is that of the repository of `folder`, where the specs are.
    """
    return {
        "cylcontact": version("cylcontact"),
        "git_commit": _git_commit(folder),
        "spec_hashes": {name: spec_hash(spec) for name, spec in specs.items()},
        "python": platform.python_version(),
        "libraries": {name: version(name) for name in libraries},
    }


def spec_hash(data: dict[str, Any]) -> str:
    """Return a short hash of a spec's contents, independent of its layout and comments."""
    text = json.dumps(data, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _git_commit(folder: Path) -> str | None:
    """Return the commit of `folder`, with "-dirty" if a file differs from it; None outside git."""

    def git(*arguments: str) -> str:
        where = folder if folder.is_dir() else None
        done = subprocess.run(
            ["git", *arguments], cwd=where, capture_output=True, text=True, timeout=10, check=True
        )
        return done.stdout.strip()

    try:
        commit = git("rev-parse", "HEAD")
        changed = git("status", "--porcelain", "--untracked-files=no", *_SOURCES)
    except (OSError, subprocess.SubprocessError):
        return None
    return f"{commit}-dirty" if changed else commit


# --- what is written from other files -------------------------------------------------------------

# What a figure, a claim or a report may read.
_DATA = (".csv", ".json", ".jsonl", ".mplstyle", ".parquet", ".toml")
_PACKAGE = Path(__file__).resolve().parents[1]
# The files that are opened, for every block that asks for them.
_opened: list[list[Path]] = []


@dataclass(frozen=True)
class Origin:
    """Where a written file is from.

    Attributes
    ----------
    inputs : mapping of str to str
        The files that it was made from, relative to their folder, and hashes of their contents.
    seeds : tuple of int
        Of the random numbers behind fits among the inputs; empty if there are none.
    commit : str, optional
        Of the folder's repository, for what is written to its `build`. What may be committed names
        no commit: it would be that of the state before.

    Examples
    --------
    >>> str(Origin({"reports/fits.py": "0123456789ab"}, (), None)).split("; ", 1)[1]
    'inputs: reports/fits.py 0123456789ab; seed: none'
    """

    inputs: Mapping[str, str]
    seeds: tuple[int, ...] = ()
    commit: str | None = None

    def __str__(self) -> str:
        parts = [
            f"cylcontact {version('cylcontact')}",
            "inputs: " + (", ".join(map(" ".join, self.inputs.items())) or "none"),
            f"seed: {', '.join(map(str, self.seeds)) or 'none'}",
        ]
        return "; ".join([*parts, f"commit: {self.commit}"] if self.commit else parts)


def origin_of(root: Path, files: Iterable[Path], target: Path) -> Origin:
    """Return where a file is from that was made from others of a folder."""
    root = root.resolve()
    inputs, seeds = {}, set()
    for file in sorted({file.resolve() for file in files}):
        inside = file.is_relative_to(root)
        contents = file.read_bytes().replace(b"\r\n", b"\n")
        name = file.relative_to(root).as_posix() if inside else file.name
        inputs[name] = hashlib.sha256(contents).hexdigest()[:12]
        if file.suffix == ".json":
            seeds |= _seed_of(contents)
    in_build = target.resolve().is_relative_to(root / "build")
    return Origin(inputs, tuple(sorted(seeds)), _git_commit(root) if in_build else None)


def _seed_of(contents: bytes) -> set[int]:
    """Return the seed in a fit's result, if it is one."""
    try:
        return {int(json.loads(contents)["settings"]["campaign"]["seed"])}
    except (KeyError, TypeError, ValueError):
        return set()


@contextmanager
def data_read(root: Path) -> Iterator[list[Path]]:
    """Yield a list, which then holds the data files of a folder that the block has read."""
    _watch()
    root = root.resolve()
    opened: list[Path] = []
    known: list[Path] = []
    _opened.append(opened)
    try:
        yield known
    finally:
        _opened.remove(opened)
        found = {file for file in map(Path.resolve, opened) if file.is_relative_to(root)}
        known += sorted(f for f in found if not f.is_relative_to(_PACKAGE) and f.is_file())


@cache
def _watch() -> None:
    """Take note of opened files, from the first time on: an audit hook cannot be taken away."""
    sys.addaudithook(_note_opened)


def _note_opened(event: str, arguments: tuple[Any, ...]) -> None:
    if event == "open" and _opened and isinstance(arguments[0], str | os.PathLike):
        path, mode, *_ = arguments
        if str(path).endswith(_DATA) and not set(mode or "r") & set("wax+"):
            for opened in _opened:
                opened.append(Path(path))


def modules_of(module: Path) -> list[Path]:
    """Return a Python file and those beside it that it imports, directly or not."""
    found, left = set(), [module]
    while left:
        file = left.pop()
        found.add(file)
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level == 1:
                names = [node.module] if node.module else [each.name for each in node.names]
                beside = (file.with_name(f"{name}.py") for name in names)
                left += [each for each in beside if each.is_file() and each not in found]
    return sorted(found)
