"""Campaigns: a law, the parameters to search, and the data to fit to."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import pandas as pd

from cylcontact.arrays import FloatArray
from cylcontact.datasets.grid import AnyGrid, DimensionlessGrid, grid_from, read_grid_data
from cylcontact.datasets.measurements import (
    Constants,
    MeasuredData,
    Measurements,
    measurements_of,
    pair_notes,
    read_frame,
    read_measured,
    require_positive_penetration,
)
from cylcontact.errors import InputError
from cylcontact.fitting.law_models import (
    RIG_NAMES,
    for_measurements,
    grid_model_of,
    housed_model,
    is_user_law,
    model_of,
    named_user_model,
    units_of,
    user_model,
    with_rig,
)
from cylcontact.fitting.measured_objective import STANDARDISED, objective_name
from cylcontact.fitting.noise_fit import noise_of
from cylcontact.fitting.noise_model import NoiseModel
from cylcontact.fitting.specs import (
    CampaignSpec,
    MeasuredSpec,
    completed,
    parameters_of,
    require_complete,
)
from cylcontact.housing_spec import takes_housing
from cylcontact.html_repr import table_html
from cylcontact.laws.law import LawModel, Parameter
from cylcontact.laws.user import UserFunction
from cylcontact.materials import own_table
from cylcontact.pair import Contact
from cylcontact.provenance import made_with, spec_hash
from cylcontact.reading import beside_or_above, first_file
from cylcontact.spec import parse_spec, read_toml

__all__ = [
    "Campaign",
    "GridData",
    "MeasuredTable",
    "TableData",
    "campaign_from_settings",
    "campaign_of_table",
    "grid_of",
    "measured_of",
    "read_campaign",
    "read_table",
    "with_grid",
]

_ZERO_REMEDY = (
    "correct the row, or remove it; readings that are not zeroed need a free offset "
    "(--free offset, or a table [parameters.offset]) and --noise constant"
)
_LIBRARIES = ("numpy", "scipy", "pandas", "pygad", "joblib")


@dataclass(frozen=True)
class GridData:
    """Samples of a reference law on a grid.

    Attributes
    ----------
    grid : Grid
        The grid.
    spec : dict
        The contents of its file.
    """

    grid: AnyGrid
    spec: dict[str, Any]
    kind: ClassVar[Literal["discrepancy"]] = "discrepancy"

    @property
    def reference(self) -> str:
        """The reference law."""
        return self.grid.reference

    @property
    def settings(self) -> dict[str, Any]:
        """The grid's file."""
        return {"dataset": self.spec}


@dataclass(frozen=True, eq=False)
class TableData:
    """A table of measurements, and the noise model of its fit, if it has one."""

    measurements: Measurements
    noise: NoiseModel | None = None
    kind: ClassVar[Literal["noise"]] = "noise"
    reference: ClassVar[str] = "measurements"

    @property
    def settings(self) -> dict[str, Any]:
        """The whole table; without steps as results have it that were saved before these."""
        data = self.measurements.data
        without = None if data.steps else {"steps"}
        return {"measurements": data.model_dump(mode="json", exclude=without)}


@dataclass(frozen=True, eq=False)
class Campaign:
    """A campaign ready to run.

    Attributes
    ----------
    name : str
        The file's name without suffix.
    spec : CampaignSpec or MeasuredSpec
        Its settings, with a table for every parameter of the law.
    data : GridData or TableData
        What the law is fitted to.
    model : LawModel
        The law and contact.
    parameters : tuple of Parameter
        In the order of the model's names.
    objective : str
        The name of the objective.
    source : str
        The path of its file or table, its name in errors.
    """

    name: str
    spec: CampaignSpec | MeasuredSpec
    data: GridData | TableData
    model: LawModel
    parameters: tuple[Parameter, ...]
    objective: str
    source: str

    def __repr__(self) -> str:
        free = sum(p.is_free for p in self.parameters)
        return (
            f"Campaign({self.name!r}, {self.model.law} law, {self.model.contact} contact, "
            f"{free} of {len(self.parameters)} parameters free, {self.objective})"
        )

    def _repr_html_(self) -> str:
        rows: dict[str, object] = {
            "law": self.model.law,
            "contact": self.model.contact,
            "fitted to": self.data.reference,
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
    def settings(self) -> dict[str, Any]:
        """Everything that the result depends on, as plain data."""
        campaign = self.spec.model_dump(mode="json", exclude_none=True)
        return {"campaign": campaign, **self.data.settings}

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


@dataclass(frozen=True, eq=False)
class MeasuredTable:
    """A table of measurements, and how laws are fitted to it.

    Attributes
    ----------
    name : str
        Of the campaigns.
    spec : MeasuredSpec
        Their settings as given.
    measurements : Measurements
        The data.
    folder : path
        Where a module with a law of one's own is looked for.
    source : str
        Its name in errors.
    """

    name: str
    spec: MeasuredSpec
    measurements: Measurements
    folder: Path
    source: str

    def campaign(self, law: str, free: Sequence[str] = ()) -> Campaign:
        """Return the campaign that fits a law, with further parameters free.

        Raises
        ------
        InputError
            If the law is unknown, or the settings are not for it.
        """
        model = _law_model(law, self.spec, self.folder, self.source)
        wanted = tuple(dict.fromkeys((*(self.spec.free or ()), *free))) or None
        spec = self.spec.model_copy(update={"law": law, "free": wanted})
        model = _freed(model, spec, self.measurements, self.source)
        return _on_table(self.name, spec, self.measurements, model, self.source)


def read_campaign(
    path: Path | str,
    runs: int | None = None,
    seed: int | None = None,
    optimizer: str | None = None,
) -> Campaign:
    """Read a campaign file, and the grid or the table that it names.

    Parameters
    ----------
    path : path
        A TOML file: one with `dataset` is on a grid, one with `data` on measurements. Either is
        searched for beside it and in the folder above, a table also in the current folder.
    runs, seed, optimizer : optional
        Replace the file's. On measurements runs are starts if no optimiser is named.

    Returns
    -------
    Campaign

    Raises
    ------
    InputError
        If a file is invalid.
    """
    contents = read_toml(path)
    is_measured = "data" in contents
    if is_measured and "dataset" in contents:
        raise InputError(
            str(path),
            "data",
            contents["data"],
            "conflicts with dataset",
            "keep data for measurements, or dataset for a grid",
        )
    contents |= {"seed": seed} if seed is not None else {}
    contents |= {"optimizer": optimizer} if optimizer is not None else {}
    if runs is not None and is_measured and "optimizer" not in contents:
        contents["starts"] = runs
    elif runs is not None and isinstance(contents.get("genetic", {}), dict):
        contents["genetic"] = {**contents.get("genetic", {}), "runs": runs}
    read = _read_on_table if is_measured else _read_on_grid
    return read(Path(path), contents, str(path))


def campaign_of_table(
    table: Path | pd.DataFrame,
    law: str,
    contact: Contact,
    constants: Constants,
    name: str = "",
    **settings: Any,
) -> Campaign:
    """Return a campaign on a table, without a file of its own.

    Parameters
    ----------
    table : path or DataFrame
        The measurements.
    law, contact, constants
        As in a campaign file.
    name : str, optional
        Of the campaign; by default that of the file.
    **settings
        Any other key of a campaign file.

    Returns
    -------
    Campaign

    Raises
    ------
    InputError
        If the table or a setting is invalid.
    """
    return read_table(table, law, contact, constants, name, **settings).campaign(law)


def read_table(
    table: Path | pd.DataFrame,
    law: str,
    contact: Contact,
    constants: Constants,
    name: str = "",
    **settings: Any,
) -> MeasuredTable:
    """Read a table to which several laws may be fitted, as for `campaign_of_table`."""
    others = {key: value for key, value in settings.items() if value is not None}
    path = table if isinstance(table, Path) else Path("data")
    source = str(table) if isinstance(table, Path) else "DataFrame"
    required = {"data": path.name, "law": law, "contact": contact, "constants": dict(constants)}
    spec = parse_spec(MeasuredSpec, required | others, source)
    return _read_table(name or path.stem, spec, table, path.parent, source)


def campaign_from_settings(name: str, settings: dict[str, Any], source: str) -> Campaign:
    """Return the campaign from the settings in a result, without importing a user's law."""
    is_measured = isinstance(settings.get("measurements"), dict)
    key = "measurements" if is_measured else "dataset"
    if not all(isinstance(settings.get(part), dict) for part in ("campaign", key)):
        raise InputError(
            source, "settings", None, "lacks the campaign or the dataset", "redo the fit"
        )
    where = f"{source}, settings.campaign", f"{source}, settings.{key}"
    if is_measured:
        spec = parse_spec(MeasuredSpec, settings["campaign"], where[0])
        data = parse_spec(MeasuredData, settings["measurements"], where[1])
        model = _stored_model(spec, source)
        campaign = _on_table(name, spec, measurements_of(data, where[1]), model, source)
    else:
        on_grid = parse_spec(CampaignSpec, settings["campaign"], where[0])
        campaign = _on_grid(name, on_grid, settings["dataset"], source, where[1])
    require_complete(settings["campaign"].get("parameters", {}), campaign.parameters, source)
    return campaign


# --- on a grid ---------------------------------------------------------------------------------


def _read_on_grid(path: Path, contents: dict[str, Any], source: str) -> Campaign:
    """Return the campaign of a file that names a grid."""
    spec = parse_spec(CampaignSpec, contents, source)
    dataset = _find_dataset(path, spec.dataset)
    return _on_grid(path.stem, spec, read_grid_data(dataset), source, str(dataset))


def _on_grid(
    name: str, spec: CampaignSpec, grid_data: dict[str, Any], source: str, grid_source: str
) -> Campaign:
    """Return the campaign of a spec and a grid, checked against the law."""
    grid = grid_from(grid_data, grid_source)
    model = grid_model_of(spec.law, grid.contact, source)
    _require_range(grid, model, source)
    parameters = parameters_of(model, spec.parameters, spec.ties, source)
    data = GridData(grid, grid_data)
    complete = completed(spec, parameters)
    return Campaign(name, complete, data, model, parameters, spec.objective, source)


def grid_of(campaign: Campaign) -> AnyGrid:
    """Return the grid of a campaign, which has to be on one."""
    return _grid_data(campaign).grid


def with_grid(campaign: Campaign, grid: AnyGrid) -> Campaign:
    """Return a campaign on another grid; its settings remain those of its file."""
    return replace(campaign, data=replace(_grid_data(campaign), grid=grid))


def _grid_data(campaign: Campaign) -> GridData:
    """Return the data of a campaign on a grid."""
    if not isinstance(campaign.data, GridData):
        raise TypeError(f"{campaign.name} is not on a grid")
    return campaign.data


def _find_dataset(campaign: Path, dataset: str) -> Path:
    """Return the grid spec that a campaign names."""
    above = Path(os.path.normpath(campaign.parent / ".."))
    places = [campaign.parent / dataset, above / dataset]
    dataset_file = first_file(places)
    if dataset_file is not None:
        return dataset_file
    raise InputError(
        str(campaign),
        "dataset",
        dataset,
        f"no such file beside the campaign or above it ({', '.join(map(str, places))})",
        "name a grid spec, e.g. datasets/internal.toml",
    )


def _require_range(grid: AnyGrid, model: LawModel, source: str) -> None:
    """Refuse clearances outside the range of the law, or a grid without lengths if it has units."""
    if isinstance(grid, DimensionlessGrid) and not model.dimensionless:
        raise InputError(
            source,
            "law",
            model.law,
            "has coefficients with units, and its grid is of alpha, beta and phi",
            "name a grid of E, nu, dR and load",
        )
    low, high = float(grid.dR.min()), float(grid.dR.max())
    if low < model.dR_min or high > model.dR_max:
        raise InputError(
            source,
            "dataset",
            [low, high],
            f"its ΔR (mm) leave the range of the {model.law} law for {model.contact} contact, "
            f"{model.dR_min:g} to {model.dR_max:g} mm",
            "narrow the dR axis of the grid",
        )


# --- on measurements ---------------------------------------------------------------------------


def measured_of(campaign: Campaign) -> tuple[Measurements, MeasuredSpec]:
    """Return the table and the settings of a campaign, which has to be on measurements."""
    if isinstance(campaign.data, TableData) and isinstance(campaign.spec, MeasuredSpec):
        return campaign.data.measurements, campaign.spec
    raise TypeError(f"{campaign.name} is not on measurements")


def _read_on_table(path: Path, contents: dict[str, Any], source: str) -> Campaign:
    """Return the campaign of a file that names a table of measurements."""
    spec = parse_spec(MeasuredSpec, contents, source)
    table = beside_or_above(path.parent, spec.data)
    if table is None:
        raise InputError(
            source,
            "data",
            spec.data,
            "no such file beside the campaign or above it",
            "name a .csv, .xlsx or .parquet table",
        )
    return _of_table(path.stem, spec, table, path.parent, source)


def _of_table(
    name: str, spec: MeasuredSpec, table: Path | pd.DataFrame, folder: Path, source: str
) -> Campaign:
    """Read the law and the data of a campaign."""
    _law_model(spec.law, spec, folder, source)  # refuses an unknown one before any data
    return _read_table(name, spec, table, folder, source).campaign(spec.law)


def _law_model(law: str, spec: MeasuredSpec, folder: Path, source: str) -> LawModel:
    """Return the model of a law of the package, or of a function of the user's own."""
    if is_user_law(law):
        return user_model(law, spec.contact, source, folder, Path.cwd())
    return _package_model(law, spec, source)


def _package_model(law: str, spec: MeasuredSpec, source: str) -> LawModel:
    """Return the model of a law of the package, in a known housing if it takes one."""
    if spec.housing is not None and (takes_housing(law) or law == spec.law):
        return housed_model(law, spec.contact, spec.housing.housing, source)
    return model_of(law, spec.contact, source)


def _read_table(
    name: str, spec: MeasuredSpec, table: Path | pd.DataFrame, folder: Path, source: str
) -> MeasuredTable:
    """Read the data of a campaign."""
    materials = own_table(spec.materials, folder, source)
    read: Callable[..., MeasuredData] = read_measured if isinstance(table, Path) else read_frame
    data = read(
        *(table, spec.contact, spec.constants, materials),
        *(spec.ignore, spec.columns, spec.group, spec.branch),
    )
    measured = measurements_of(data, str(table) if isinstance(table, Path) else source)
    data.notes.extend(pair_notes(measured, materials))
    return MeasuredTable(name, spec, measured, folder, source)


def _freed(model: LawModel, spec: MeasuredSpec, measured: Measurements, source: str) -> LawModel:
    """Return the model with what is free in a fit to measurements."""
    free = spec.free or ()
    for name in free:
        if name not in (*model.names, *RIG_NAMES):
            rule = f"is not a parameter of {model.law} for {model.contact} contact"
            remedy = f"its parameters: {', '.join((*model.names, *RIG_NAMES))}"
            raise InputError(source, "free", name, rule, remedy)
        if name in spec.named:
            rule, remedy = "is bounded, fixed or tied as well", "keep one of them"
            raise InputError(source, "free", name, rule, remedy)
    if is_user_law(spec.law):
        model = with_rig(model, {*free, *spec.named})
    else:
        model = for_measurements(model, free, spec.named)
    # A reading is not further from zero than the largest of them by much, and neither a rig nor
    # another datum is worth much more than the readings over the loads.
    largest = 2 * np.abs(measured.penetration).max()
    reach, most = (float(f"{value:.1g}") for value in (largest, largest / measured.load.max()))
    # Readings of nothing, or at a load beyond all measure, leave the bounds as they are.
    bounds = {name: end for name, end in (("offset", reach), ("compliance", most)) if end > 0}
    parameters = (
        replace(p, low=-bounds[p.name], high=bounds[p.name]) if p.name in bounds else p
        for p in model.parameters
    )
    return replace(model, parameters=tuple(parameters))


def _on_table(
    name: str, spec: MeasuredSpec, measured: Measurements, model: LawModel, source: str
) -> Campaign:
    """Return the checked campaign, with defaults for what the spec leaves out."""
    model = with_rig(model, spec.named)
    rig = f"; the rig's: {', '.join(RIG_NAMES)}"
    parameters = parameters_of(model, spec.parameters, spec.ties, source, rig)
    free = sum(p.is_free for p in parameters)
    if len(measured) <= free:
        raise InputError(
            source,
            "data",
            f"{len(measured)} rows",
            f"are not more than the {free} free parameters",
            "measure more points, or fix parameters with fixed = true",
        )
    noise = noise_of(spec, measured, parameters, source)
    if noise is not None:
        objective = STANDARDISED
    else:
        prefers_load = is_user_law(spec.law)
        objective = objective_name(spec.objective, spec.noise, measured, prefers_load, source)
    if "log" in objective or not any(p.is_free for p in parameters if p.name == "offset"):
        named = Path(source).name == measured.data.source
        where = source if named else f"{source}, {measured.data.source}"
        require_positive_penetration(measured, where, _ZERO_REMEDY)
    chosen = {"objective": objective, "noise": spec.noise if noise else None}
    complete = completed(spec, parameters).model_copy(update=chosen)
    data = TableData(measured, noise)
    return Campaign(name, complete, data, model, parameters, objective, source)


def _stored_model(spec: MeasuredSpec, source: str) -> LawModel:
    """Return the model of a result's law; a user's function is not imported."""
    if not is_user_law(spec.law):
        return _package_model(spec.law, spec, source)
    own = [key for key in spec.named if key not in RIG_NAMES]
    named = tuple(Parameter(key, -math.inf, math.inf) for key in own)
    return named_user_model(UserFunction(spec.law, None), named, spec.contact)
