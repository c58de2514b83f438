"""What a result was made with."""

from __future__ import annotations

import platform
import subprocess
from importlib.metadata import version
from pathlib import Path
from typing import Any

from cylcontact.datasets.grid import spec_hash
from cylcontact.fitting.campaign import Campaign

LIBRARIES = ("numpy", "scipy", "pandas", "pygad", "joblib")


def provenance(campaign: Campaign) -> dict[str, Any]:
    """Return package version, git commit, hashes of the specs and library versions."""
    settings = campaign.settings
    return {
        "cylcontact": version("cylcontact"),
        "git_commit": _git_commit(Path(campaign.source).parent),
        "spec_hashes": {key: spec_hash(settings[key]) for key in ("campaign", "dataset")},
        "python": platform.python_version(),
        "libraries": {name: version(name) for name in LIBRARIES},
    }


def _git_commit(folder: Path) -> str | None:
    """Return the commit that `folder` is at, marked if it has changes; None outside git."""
    try:
        found = subprocess.run(
            ["git", "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"],
            cwd=folder if folder.is_dir() else None,
            capture_output=True,
            text=True,
            timeout=10,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return found.stdout.strip()
