"""The provenance of a result."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cylcontact.fitting.planning import AnyCampaign
from cylcontact.provenance import made_with

__all__ = ["provenance"]

_LIBRARIES = ("numpy", "scipy", "pandas", "pygad", "joblib")


def provenance(campaign: AnyCampaign) -> dict[str, Any]:
    """Return package version, git commit, hashes of the specs and library versions."""
    return made_with(Path(campaign.source).parent, campaign.settings, _LIBRARIES)
