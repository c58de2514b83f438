"""Campaigns on measurements: a table, a law, and the search for its parameters."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.datasets.measurements import (
    Constants,
    MeasuredData,
    Measurements,
    measurements_of,
    read_measured,
)
from cylcontact.errors import InputError
from cylcontact.fitting.campaign import ParameterSpec, require_free
from cylcontact.fitting.law_models import (
    RIG_NAMES,
    LawModel,
    LawParameter,
    is_user_law,
    model_of,
    with_rig,
)
from cylcontact.fitting.measured_objective import MeasuredObjective, objective_name
from cylcontact.fitting.measured_spec import MeasuredSpec
from cylcontact.fitting.parameters import Family, Parameter
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.ties import require_valid
from cylcontact.fitting.user_law import UserFunction, named_user_model, user_model
from cylcontact.pair import Contact
from cylcontact.provenance import spec_hash
from cylcontact.spec import parse_spec

__all__ = [
    "MeasuredCampaign",
    "campaign_of_table",
    "measured_from_settings",
    "read_measured_campaign",
]

_MATERIALS = "datasets/materials.csv"


@dataclass(frozen=True, eq=False)
class MeasuredCampaign:
    """A campaign on measurements, ready to run.

    Attributes
    ----------
    name : str
        The file's name without suffix.
    spec : MeasuredSpec
        Its settings, with a table for every parameter of the law.
    measurements : Measurements
        The data.
    model : LawModel
        The law.
    parameters : tuple of Parameter
        In the order of the law's names.
    objective : str
        The name of the objective.
    source : str
        Its name in errors.
    """

    name: str
    spec: MeasuredSpec
    measurements: Measurements
    model: LawModel
    parameters: tuple[Parameter, ...]
    objective: str
    source: str

    @property
    def family(self) -> Family:
        """The law and contact."""
        return self.model.family

    @property
    def settings(self) -> dict[str, Any]:
        """Everything that the result depends on, including the data, as plain data."""
        return {
            "campaign": self.spec.model_dump(mode="json", exclude_none=True),
            "measurements": self.measurements.data.model_dump(mode="json"),
        }

    @property
    def key(self) -> str:
        """A hash of `settings`."""
        return spec_hash(self.settings)

    @property
    def nominal(self) -> FloatArray | None:
        """The nominal values of the free parameters, shape (k,); None if one has none."""
        nominal = {p.name: p.nominal for p in self.model.parameters}
        values = [nominal[p.name] for p in self.parameters if p.is_free]
        return None if None in values else np.array(values, dtype=np.float64)

    def problem(self) -> Problem:
        """Return the problem, with plain least squares."""
        objective = MeasuredObjective(self.measurements, self.objective)
        return Problem(self.family, self.parameters, objective)


def read_measured_campaign(
    path: Path,
    data: Mapping[str, Any],
    runs: int | None = None,
    seed: int | None = None,
    optimizer: str | None = None,
) -> MeasuredCampaign:
    """Return the campaign of a file's contents; `planning.read_plan` calls it.

    Parameters
    ----------
    path : Path
        The file.
    data : mapping
        Its contents.
    runs, seed, optimizer : optional
        Replace the file's; runs are starts if no optimiser is named.

    Returns
    -------
    MeasuredCampaign
    """
    changed = dict(data)
    changed |= {"seed": seed} if seed is not None else {}
    changed |= {"optimizer": optimizer} if optimizer is not None else {}
    if runs is not None and "optimizer" not in changed:
        changed["starts"] = runs
    elif runs is not None and isinstance(changed.get("genetic", {}), dict):
        changed["genetic"] = {**changed.get("genetic", {}), "runs": runs}
    spec = parse_spec(MeasuredSpec, changed, str(path))
    table = _beside_or_above(path, spec.data)
    if table is None:
        raise InputError(
            str(path),
            "data",
            spec.data,
            "no such file beside the campaign or above it",
            "name a .csv or .parquet table",
        )
    return _planned(path.stem, spec, table, path.parent, str(path))


def campaign_of_table(
    table: Path,
    law: str,
    contact: Contact,
    constants: Constants,
    **settings: Any,
) -> MeasuredCampaign:
    """Return a campaign on a table, without a file of its own.

    Parameters
    ----------
    table : path
        The measurements.
    law, contact, constants
        As in a campaign file.
    **settings
        Any other key of a campaign file.

    Returns
    -------
    MeasuredCampaign

    Raises
    ------
    InputError
        If the table or a setting is invalid.
    """
    others = {key: value for key, value in settings.items() if value is not None}
    required = {"data": table.name, "law": law, "contact": contact, "constants": dict(constants)}
    spec = parse_spec(MeasuredSpec, required | others, str(table))
    return _planned(table.stem, spec, table, table.parent, str(table))


def measured_from_settings(name: str, settings: dict[str, Any], source: str) -> MeasuredCampaign:
    """Return the campaign from the settings in a result, without importing a user's law."""
    spec = parse_spec(MeasuredSpec, settings["campaign"], f"{source}, settings.campaign")
    where = f"{source}, settings.measurements"
    measured = measurements_of(parse_spec(MeasuredData, settings["measurements"], where), where)
    if is_user_law(spec.law):
        own = [key for key in (*spec.parameters, *(spec.ties or {})) if key not in RIG_NAMES]
        named = tuple(LawParameter(key, -math.inf, math.inf) for key in own)
        model = named_user_model(UserFunction(spec.law, None), named, spec.contact)
    else:
        model = model_of(spec.law, spec.contact, source)
    return _make(name, spec, measured, model, source)


def _planned(
    name: str, spec: MeasuredSpec, table: Path, folder: Path, source: str
) -> MeasuredCampaign:
    """Read the data and the law of a campaign."""
    materials = _beside_or_above(folder / name, spec.materials or _MATERIALS)
    if spec.materials is not None and materials is None:
        raise InputError(
            source, "materials", spec.materials, "no such file", "name a table of materials"
        )
    if is_user_law(spec.law):
        model = user_model(spec.law, folder.resolve(), spec.contact, source)
    else:
        model = model_of(spec.law, spec.contact, source)
    data = read_measured(table, spec.contact, spec.constants, materials, spec.ignore)
    return _make(name, spec, measurements_of(data, str(table)), model, source)


def _make(
    name: str, spec: MeasuredSpec, measured: Measurements, model: LawModel, source: str
) -> MeasuredCampaign:
    """Return the checked campaign, with defaults for what the spec leaves out."""
    model = with_rig(model, [*spec.parameters, *(spec.ties or {})])
    parameters = _parameters(spec, model, source)
    free = sum(p.is_free for p in parameters)
    if len(measured) <= free:
        raise InputError(
            source,
            "data",
            f"{len(measured)} rows",
            f"are not more than the {free} free parameters",
            "measure more points, or fix parameters with fixed = true",
        )
    objective = objective_name(spec.objective, measured, is_user_law(spec.law), source)
    tables = {p.name: _table_of(p) for p in parameters if p.tie is None}
    complete = spec.model_copy(update={"parameters": tables, "objective": objective})
    return MeasuredCampaign(name, complete, measured, model, parameters, objective, source)


def _parameters(spec: MeasuredSpec, model: LawModel, source: str) -> tuple[Parameter, ...]:
    """Return the law's parameters, with defaults for those that the spec leaves out."""
    for name in spec.parameters:
        if name not in model.names:
            raise InputError(
                source,
                f"parameters.{name}",
                None,
                f"is not a parameter of {model.law} for {model.contact} contact",
                f"its parameters: {', '.join(model.names)}; the rig's: {', '.join(RIG_NAMES)}",
            )
    ties = spec.ties or {}
    require_valid(ties, spec.parameters, model.names, source)
    parameters = tuple(
        Parameter(default.name, tie=ties[default.name])
        if default.name in ties
        else _parameter(default, spec.parameters.get(default.name), source)
        for default in model.parameters
    )
    require_free(parameters, source)
    return parameters


def _parameter(default: LawParameter, table: ParameterSpec | None, source: str) -> Parameter:
    """Return one parameter from its table in the campaign, or the default."""
    if table is not None:
        return table.parameter(default.name)
    if not default.free:
        return Parameter(default.name, value=default.nominal, fixed=True)
    if not math.isfinite(default.high - default.low):
        raise InputError(
            source,
            f"parameters.{default.name}",
            None,
            "is required: a law of your own has no default bounds",
            "give low and high, or value with fixed = true",
        )
    return Parameter(default.name, default.low, default.high)


def _table_of(parameter: Parameter) -> ParameterSpec:
    """Return a parameter as a table of a campaign file."""
    if parameter.fixed:
        return ParameterSpec(value=parameter.value, fixed=True)
    return ParameterSpec(low=parameter.low, high=parameter.high)


def _beside_or_above(campaign: Path, name: str) -> Path | None:
    """Return a file beside a campaign, in the two folders above, or here; None if there is none."""
    folder = campaign.parent
    with suppress(OSError):  # the name is too long, or the folder unreadable
        for place in (folder, folder / "..", folder / ".." / "..", Path()):
            if (place / name).is_file():
                return Path(place / name)
    return None
