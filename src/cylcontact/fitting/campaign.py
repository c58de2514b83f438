"""Campaigns: a law, the parameters to search, and a grid of a reference law to fit it to."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cylcontact.datasets.grid import Grid, grid_from
from cylcontact.files.provenance import made_with, spec_hash
from cylcontact.files.reading import beside_or_above
from cylcontact.files.spec import parse_spec, read_toml
from cylcontact.fitting.law_models import grid_model_of, units_of
from cylcontact.fitting.parameters import LawModel, Parameter
from cylcontact.fitting.specs import (
    CampaignSpec,
    MeasuredSpec,
    completed,
    parameters_of,
    with_parameters,
)
from cylcontact.support.arrays import FloatArray
from cylcontact.support.errors import InputError
from cylcontact.support.html_repr import table_html

_LIBRARIES = ("numpy", "scipy", "pandas", "pygad", "joblib")


@dataclass(frozen=True, eq=False)
class CampaignBase(ABC):
    """A law and its parameters, ready to be fitted: to a law by a `Campaign`, or to a table."""

    name: str
    spec: CampaignSpec | MeasuredSpec
    model: LawModel
    parameters: tuple[Parameter, ...]
    objective: str
    source: str

    def __repr__(self) -> str:
        free = sum(p.is_free for p in self.parameters)
        return (
            f"{type(self).__name__}({self.name!r}, {self.model.law} law, {self.model.contact} "
            f"contact, {free} of {len(self.parameters)} parameters free, {self.objective})"
        )

    def _repr_html_(self) -> str:
        rows: dict[str, object] = {
            "law": self.model.law,
            "contact": self.model.contact,
            "fitted to": self.reference,
            "objective": self.objective,
        }
        units = units_of(self.model.law, self.model.contact)
        for p in self.parameters:
            unit = units.get(p.name, "")
            rows[f"{p.name} ({unit})" if unit else p.name] = (
                f"{p.value:.6g}, fixed" if p.fixed else p.tie or f"{p.low:.6g} to {p.high:.6g}"
            )
        return table_html(f"Campaign {self.name}", rows)

    @property
    @abstractmethod
    def reference(self) -> str:
        """What the law is fitted to: a law's name, or "measurements"."""

    @property
    @abstractmethod
    def data_settings(self) -> dict[str, Any]:
        """The grid's file, or the whole table, as plain data."""

    @property
    def settings(self) -> dict[str, Any]:
        """Everything that the result depends on, as plain data."""
        campaign = self.spec.model_dump(mode="json", exclude_none=True)
        return {"campaign": campaign, **self.data_settings}

    @property
    def key(self) -> str:
        """A hash of `settings` and of the file of a user's own law, for the journal of the runs."""
        own = {"law": self.model.digest} if self.model.digest else {}
        return spec_hash(self.settings | own)

    @property
    def nominal(self) -> FloatArray | None:
        """The nominal values of the free parameters, shape (k,); None unless all have one."""
        values = [p.nominal for p in self.parameters if p.is_free]
        return None if None in values else np.array(values, dtype=np.float64)

    @property
    def provenance(self) -> dict[str, Any]:
        """Package version, git commit, hashes of the specs and library versions."""
        return made_with(Path(self.source).parent, self.settings, _LIBRARIES)


@dataclass(frozen=True, eq=False, repr=False)
class Campaign(CampaignBase):
    """A law that is fitted to samples of another one.

    Attributes
    ----------
    grid : Grid
        The grid.
    grid_data : dict
        The contents of its file.
    """

    spec: CampaignSpec
    grid: Grid
    grid_data: dict[str, Any]

    @property
    def reference(self) -> str:
        """The reference law."""
        return self.grid.reference

    @property
    def data_settings(self) -> dict[str, Any]:
        """The grid's file."""
        return {"dataset": self.grid_data}

    @classmethod
    def read(
        cls,
        path: Path | str,
        *,
        runs: int | None = None,
        seed: int | None = None,
        bounds: Mapping[str, tuple[float, float]] | None = None,
        fixed: Mapping[str, float] | None = None,
        ties: Mapping[str, str] | None = None,
    ) -> Campaign:
        """Read a campaign file, and the grid that it names.

        Parameters
        ----------
        path : path
            A TOML file. Its `dataset` is searched for beside it and in the folder above.
        runs, seed : int, optional
            In place of the file's.
        bounds, fixed, ties : mapping, optional
            Parameters to search between two values, to hold at a value, or to set by an expression
            such as "a/10", in place of what the file says of them.

        Raises
        ------
        InputError
            If a file is invalid, or names a table of measurements.

        Examples
        --------
        >>> campaign = Campaign.read("fitting/external.toml", runs=4, fixed={"n": 1.094})
        >>> campaign.spec.genetic.runs, campaign.reference, campaign.spec.fixed
        (4, 'johnson', {'n': 1.094})
        """
        contents, path = with_parameters(read_toml(path), bounds, fixed, ties), Path(path)
        if seed is not None:
            contents["seed"] = seed
        if runs is not None and isinstance(contents.get("genetic", {}), dict):
            contents["genetic"] = {**contents.get("genetic", {}), "runs": runs}
        spec = parse_spec(CampaignSpec, contents, str(path))
        dataset = beside_or_above(path.parent, spec.dataset)
        if dataset is None:
            rule = "no such file beside the campaign or above it"
            remedy = "name a grid spec, e.g. datasets/internal.toml"
            raise InputError(str(path), "dataset", spec.dataset, rule, remedy)
        return cls._of(path.stem, spec, read_toml(dataset), str(path), str(dataset))

    @classmethod
    def on(cls, grid: Grid, law: str, name: str = "campaign", **settings: Any) -> Campaign:
        """Return the campaign that fits a law on a grid, without a file.

        Parameters
        ----------
        grid : Grid
            Where its reference law is sampled.
        law : str
            The law to fit.
        name : str, optional
            Of the campaign.
        **settings
            Keys of a campaign file: bounds, fixed, ties, objective, seed, genetic and profiles.

        Raises
        ------
        InputError
            If a setting is invalid.
        """
        axes = {key: {"values": getattr(grid, key).tolist()} for key in ("E", "nu", "dR", "load")}
        data = {"contact": grid.contact, "reference": grid.reference, "axes": axes}
        spec = parse_spec(CampaignSpec, {"dataset": grid.source, "law": law, **settings}, name)
        return cls._of(name, spec, data, name, grid.source)

    @classmethod
    def of_settings(cls, name: str, settings: dict[str, Any], source: str) -> Campaign:
        """Return the campaign from the settings in a result."""
        where = f"{source}, settings.campaign", f"{source}, settings.dataset"
        spec = parse_spec(CampaignSpec, settings["campaign"], where[0])
        return cls._of(name, spec, settings["dataset"], source, where[1])

    @classmethod
    def _of(
        cls, name: str, spec: CampaignSpec, grid_data: dict[str, Any], source: str, grid_source: str
    ) -> Campaign:
        grid = grid_from(grid_data, grid_source)
        model = grid_model_of(spec.law, grid.contact, source)
        _require_range(grid, model, source)
        parameters = parameters_of(model, spec, source)
        spec = completed(spec, parameters)
        return cls(name, spec, model, parameters, spec.objective, source, grid, grid_data)


def _require_range(grid: Grid, model: LawModel, source: str) -> None:
    """Refuse clearances outside the range of the law."""
    low, high = float(grid.dR.min()), float(grid.dR.max())
    if low < model.dR_min or high > model.dR_max:
        span = f"{model.dR_min:g} to {model.dR_max:g} mm"
        rule = f"its ΔR (mm) leave the range of the {model.law} law for {model.contact} contact, "
        remedy = "narrow the dR axis of the grid"
        raise InputError(source, "dataset", [low, high], rule + span, remedy)
