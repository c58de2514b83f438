"""Provenance of results: versions, the git commit and hashes of the specs."""

from __future__ import annotations

import hashlib
import json
import platform
import subprocess
from collections.abc import Iterable, Mapping
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
