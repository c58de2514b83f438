"""Campaigns on a grid or on measurements, from files and from results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cylcontact.errors import InputError
from cylcontact.fitting.campaign import Campaign, campaign_from_settings, read_campaign
from cylcontact.fitting.measured_campaign import (
    MeasuredCampaign,
    measured_from_settings,
    read_measured_campaign,
)
from cylcontact.provenance import made_with
from cylcontact.spec import read_toml

__all__ = ["AnyCampaign", "plan_from_settings", "provenance", "read_plan"]

_LIBRARIES = ("numpy", "scipy", "pandas", "pygad", "joblib")

AnyCampaign = Campaign | MeasuredCampaign


def read_plan(
    path: Path | str,
    runs: int | None = None,
    seed: int | None = None,
    optimizer: str | None = None,
) -> AnyCampaign:
    """Read a campaign file: one with `data` is on measurements, one with `dataset` on a grid.

    Parameters
    ----------
    path : path
        A TOML file.
    runs, seed, optimizer : optional
        Replace the file's.

    Returns
    -------
    Campaign or MeasuredCampaign

    Raises
    ------
    InputError
        If a file is invalid.
    """
    data = read_toml(path)
    if "data" not in data:
        return read_campaign(path, runs, seed, optimizer)
    if "dataset" in data:
        raise InputError(
            str(path),
            "data",
            data["data"],
            "conflicts with dataset",
            "keep data for measurements, or dataset for a grid",
        )
    return read_measured_campaign(Path(path), data, runs, seed, optimizer)


def plan_from_settings(name: str, settings: dict[str, Any], source: str) -> AnyCampaign:
    """Return the campaign from the settings in a result."""
    if isinstance(settings.get("measurements"), dict) and isinstance(
        settings.get("campaign"), dict
    ):
        return measured_from_settings(name, settings, source)
    return campaign_from_settings(name, settings, source)


def provenance(campaign: AnyCampaign) -> dict[str, Any]:
    """Return package version, git commit, hashes of the specs and library versions."""
    return made_with(Path(campaign.source).parent, campaign.settings, _LIBRARIES)
