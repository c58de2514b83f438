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

__all__ = ["made_with", "spec_hash"]

# Every file of the repository except results.
_SOURCES = ("--", ":/", ":(top,exclude,glob)**/results/**")


def made_with(
    folder: Path, specs: Mapping[str, dict[str, Any]], libraries: Iterable[str]
) -> dict[str, Any]:
    """Return the package version, git commit, hashes of the specs and library versions.

    Parameters
    ----------
    folder : Path
        Folder of the specs; the commit is that of its repository.
    specs : mapping of str to dict
        Contents of the specs by name.
    libraries : iterable of str
        Distributions whose versions are recorded.

    Returns
    -------
    dict
        Plain data, ready for JSON.

    Examples
    --------
    >>> sorted(made_with(Path(), {"grid": {"points": 3}}, ["numpy"]))
    ['cylcontact', 'git_commit', 'libraries', 'python', 'spec_hashes']
    """
    return {
        "cylcontact": version("cylcontact"),
        "git_commit": _git_commit(folder),
        "spec_hashes": {name: spec_hash(spec) for name, spec in specs.items()},
        "python": platform.python_version(),
        "libraries": {name: version(name) for name in libraries},
    }


def spec_hash(data: dict[str, Any]) -> str:
    """Return a short hash of a spec's contents, independent of its layout and comments.

    Examples
    --------
    >>> spec_hash({"a": 1, "b": 2}) == spec_hash({"b": 2, "a": 1})
    True
    """
    text = json.dumps(data, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _git_commit(folder: Path) -> str | None:
    """Return the commit of `folder`, with "-dirty" if a file differs from it; None outside git.

    Changed results are ignored, so that a second result made at a commit is as clean as the first.
    """
    try:
        commit = _git(folder, "rev-parse", "HEAD")
        changed = _git(folder, "status", "--porcelain", "--untracked-files=no", *_SOURCES)
    except (OSError, subprocess.SubprocessError):
        return None
    return f"{commit}-dirty" if changed else commit


def _git(folder: Path, *arguments: str) -> str:
    """Return the output of a git command."""
    done = subprocess.run(
        ["git", *arguments],
        cwd=folder if folder.is_dir() else None,
        capture_output=True,
        text=True,
        timeout=10,
        check=True,
    )
    return done.stdout.strip()
