"""Campaigns on a grid: the file, and the checked campaign that is run."""

from __future__ import annotations

import math
import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import Field, model_validator

from cylcontact.datasets.grid import Grid, grid_from, read_grid_data
from cylcontact.errors import InputError
from cylcontact.fitting.genetic import CROSSOVERS
from cylcontact.fitting.objectives import OBJECTIVES
from cylcontact.fitting.optimizers import OPTIMIZERS
from cylcontact.fitting.parameters import Family, Parameter, family_of
from cylcontact.fitting.ties import require_valid
from cylcontact.provenance import spec_hash
from cylcontact.spec import Spec, broken, parse_spec, read_toml

__all__ = [
    "TIES",
    "Campaign",
    "CampaignSpec",
    "GeneticSpec",
    "ParameterSpec",
    "campaign_from_settings",
    "read_campaign",
    "require_free",
]

# Limit on the runs of a campaign and on a population, for memory.
_MOST = 100_000
TIES = 'a table [ties] of expressions that set parameters, e.g. b = "a/10"'
_PARAMETER_REMEDY = "give low and high, or value with fixed = true"


class ParameterSpec(Spec):
    """A table [parameters.NAME]."""

    low: float | None = Field(None, description="the lower bound, a number")
    high: float | None = Field(None, description="the upper bound, a number")
    value: float | None = Field(None, description="the value of a fixed parameter, a number")
    fixed: bool = Field(False, description="true or false")

    @model_validator(mode="after")
    def _check(self) -> ParameterSpec:
        if self.fixed:
            if self.value is None:
                raise broken("value", None, "is required when fixed = true", _PARAMETER_REMEDY)
            return self
        if self.value is not None:
            raise broken("value", self.value, "is used only with fixed = true", _PARAMETER_REMEDY)
        for key in ("low", "high"):
            if getattr(self, key) is None:
                raise broken(key, None, "is required", _PARAMETER_REMEDY)
        if (self.low or 0.0) >= (self.high or 0.0):
            raise broken(
                "low",
                self.low,
                f"must be below high = {self.high}",
                "exchange them, or give value with fixed = true",
            )
        return self

    def parameter(self, name: str) -> Parameter:
        """Return the parameter that the table describes."""
        low = math.nan if self.low is None else self.low
        high = math.nan if self.high is None else self.high
        return Parameter(name, low, high, self.value, self.fixed)


class GeneticSpec(Spec):
    """The table [genetic]."""

    runs: int = Field(
        16, ge=1, le=_MOST, description=f"the number of runs, an integer from 1 to {_MOST}"
    )
    populations: tuple[int, ...] = Field(
        (60, 120), strict=False, description="a list of population sizes, integers of at least 4"
    )
    generations: int = Field(300, ge=1, description="the generations, an integer of at least 1")
    crossovers: tuple[str, ...] = Field(
        ("single_point", "uniform", "blend"),
        strict=False,
        description=f"a list from {', '.join(CROSSOVERS)}",
    )

    @model_validator(mode="after")
    def _check(self) -> GeneticSpec:
        if not self.populations or not 4 <= min(self.populations) <= max(self.populations) <= _MOST:
            raise broken(
                "populations",
                list(self.populations),
                f"must be a list of sizes from 4 to {_MOST}",
                "e.g. [60, 120]",
            )
        unknown = [name for name in self.crossovers if name not in CROSSOVERS]
        if unknown or not self.crossovers:
            raise broken(
                "crossovers",
                list(self.crossovers),
                "must be a list of known crossovers",
                f"choose from {', '.join(CROSSOVERS)}",
            )
        return self


class CampaignSpec(Spec):
    """A campaign file."""

    dataset: str = Field(description="the path of a grid spec, beside or above the campaign")
    law: str = Field(description="the law to fit, a string")
    objective: str = Field(OBJECTIVES[0], description=f"one of {', '.join(OBJECTIVES)}")
    seed: int = Field(20150101, ge=0, description="the seed, an integer of at least 0")
    parameters: dict[str, ParameterSpec] = Field(
        description="a table [parameters.NAME] for each parameter of the law"
    )
    ties: dict[str, str] | None = Field(None, description=TIES)
    optimizer: str = Field("genetic", description=f"one of {', '.join(OPTIMIZERS)}")
    genetic: GeneticSpec = Field(GeneticSpec(), description="a table [genetic]")

    @model_validator(mode="after")
    def _check(self) -> CampaignSpec:
        if self.objective not in OBJECTIVES:
            raise broken(
                "objective",
                self.objective,
                "is not a known objective",
                f"choose {', '.join(OBJECTIVES)}",
            )
        if self.optimizer not in OPTIMIZERS:
            raise broken(
                "optimizer",
                self.optimizer,
                "is not a known optimiser",
                f"choose {', '.join(OPTIMIZERS)}",
            )
        return self


@dataclass(frozen=True)
class Campaign:
    """A campaign ready to run.

    Attributes
    ----------
    name : str
        The file's name without suffix.
    spec : CampaignSpec
        Its settings, defaults filled in.
    grid_data : dict
        The contents of the grid spec.
    grid : Grid
        The grid that they describe.
    family : Family
        The law and contact.
    parameters : tuple of Parameter
        In the order of the family's names.
    source : str
        Its name in errors.
    """

    name: str
    spec: CampaignSpec
    grid_data: dict[str, Any]
    grid: Grid
    family: Family
    parameters: tuple[Parameter, ...]
    source: str

    @property
    def settings(self) -> dict[str, Any]:
        """Everything that the result depends on, as plain data."""
        return {
            "campaign": self.spec.model_dump(mode="json", exclude_none=True),
            "dataset": self.grid_data,
        }

    @property
    def key(self) -> str:
        """A hash of `settings`."""
        return spec_hash(self.settings)


def read_campaign(
    path: Path | str,
    runs: int | None = None,
    seed: int | None = None,
    optimizer: str | None = None,
) -> Campaign:
    """Read a campaign file and the grid spec that it names.

    Parameters
    ----------
    path : path
        A TOML file. Its dataset is searched for beside it and in the folder above.
    runs, seed : int, optional
        Replaces the file's.
    optimizer : str, optional
        Replaces the file's.

    Returns
    -------
    Campaign

    Raises
    ------
    InputError
        If either file is invalid.
    """
    data = read_toml(path)
    if runs is not None and isinstance(data.get("genetic", {}), dict):
        data["genetic"] = {**data.get("genetic", {}), "runs": runs}
    if seed is not None:
        data["seed"] = seed
    if optimizer is not None:
        data["optimizer"] = optimizer
    spec = parse_spec(CampaignSpec, data, str(path))
    dataset = _find_dataset(Path(path), spec.dataset)
    return _campaign_of(Path(path).stem, spec, read_grid_data(dataset), str(path), str(dataset))


def campaign_from_settings(name: str, settings: dict[str, Any], source: str) -> Campaign:
    """Return the campaign from the settings in a result."""
    if not all(isinstance(settings.get(key), dict) for key in ("campaign", "dataset")):
        raise InputError(
            source, "settings", None, "lacks the campaign or the dataset", "redo the fit"
        )
    spec = parse_spec(CampaignSpec, settings["campaign"], f"{source}, settings.campaign")
    return _campaign_of(name, spec, settings["dataset"], source, f"{source}, settings.dataset")


def _campaign_of(
    name: str, spec: CampaignSpec, grid_data: dict[str, Any], source: str, grid_source: str
) -> Campaign:
    """Return the campaign of a spec and a grid, checked against the law."""
    grid = grid_from(grid_data, grid_source)
    family = family_of(spec.law, grid.contact, source)
    _require_range(grid, family, source)
    parameters = _parameters(spec, family, source)
    return Campaign(name, spec, grid_data, grid, family, parameters, source)


def _find_dataset(campaign: Path, dataset: str) -> Path:
    """Return the grid spec that a campaign names."""
    above = Path(os.path.normpath(campaign.parent / ".."))
    places = [campaign.parent / dataset, above / dataset]
    with suppress(OSError):  # the name is too long, or the folder unreadable
        for place in places:
            if place.is_file():
                return place
    raise InputError(
        str(campaign),
        "dataset",
        dataset,
        f"no such file beside the campaign or above it ({', '.join(map(str, places))})",
        "name a grid spec, e.g. datasets/internal.toml",
    )


def _parameters(spec: CampaignSpec, family: Family, source: str) -> tuple[Parameter, ...]:
    """Return the parameters of the law, in the order of the family."""
    known = ", ".join(family.names)
    ties = spec.ties or {}
    for name in spec.parameters:
        if name not in family.names:
            raise InputError(
                source,
                f"parameters.{name}",
                None,
                f"is not a parameter of {family.law} for {family.contact} contact",
                f"its parameters: {known}",
            )
    for name in family.names:
        if name not in spec.parameters and name not in ties:
            raise InputError(
                source, f"parameters.{name}", None, "is required", f"the law has {known}"
            )
    require_valid(ties, spec.parameters, family.names, source)
    parameters = tuple(
        Parameter(name, tie=ties[name]) if name in ties else spec.parameters[name].parameter(name)
        for name in family.names
    )
    require_free(parameters, source)
    return parameters


def require_free(parameters: tuple[Parameter, ...], source: str) -> None:
    """Refuse parameters of which none is searched."""
    if not any(p.is_free for p in parameters):
        raise InputError(
            source,
            "parameters",
            None,
            "all are fixed or tied",
            "free at least one: give it low and high",
        )


def _require_range(grid: Grid, family: Family, source: str) -> None:
    """Refuse clearances outside the range of the law."""
    low, high = float(grid.dR.min()), float(grid.dR.max())
    if low < family.dR_min or high > family.dR_max:
        raise InputError(
            source,
            "dataset",
            [low, high],
            f"its ΔR (mm) leave the range of the {family.law} law for {family.contact} contact, "
            f"{family.dR_min:g} to {family.dR_max:g} mm",
            "narrow the dR axis of the grid",
        )
