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
from cylcontact.datasets.measured_columns import Constants, MeasuredData, read_measured
from cylcontact.datasets.measurements import Measurements, measurements_of
from cylcontact.errors import InputError
from cylcontact.fitting.campaign import completed, parameters_of, require_complete
from cylcontact.fitting.law_models import (
    RIG_NAMES,
    LawModel,
    is_user_law,
    model_of,
    with_rig,
)
from cylcontact.fitting.measured_objective import MeasuredObjective, objective_name
from cylcontact.fitting.measured_spec import MeasuredSpec
from cylcontact.fitting.parameters import Parameter
from cylcontact.fitting.problem import Problem
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
        values = [p.nominal for p in self.parameters if p.is_free]
        return None if None in values else np.array(values, dtype=np.float64)

    def problem(self) -> Problem:
        """Return the problem, with plain least squares."""
        objective = MeasuredObjective(self.measurements, self.objective)
        return Problem(self.model, self.parameters, objective)


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
        named = tuple(Parameter(key, -math.inf, math.inf) for key in own)
        model = named_user_model(UserFunction(spec.law, None), named, spec.contact)
    else:
        model = model_of(spec.law, spec.contact, source)
    campaign = _make(name, spec, measured, model, source)
    require_complete(spec.parameters, campaign.parameters, source)
    return campaign


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
    objective = objective_name(spec.objective, measured, is_user_law(spec.law), source)
    complete = completed(spec, parameters).model_copy(update={"objective": objective})
    return MeasuredCampaign(name, complete, measured, model, parameters, objective, source)


def _beside_or_above(campaign: Path, name: str) -> Path | None:
    """Return a file beside a campaign, in the two folders above, or here; None if there is none."""
    folder = campaign.parent
    with suppress(OSError):  # the name is too long, or the folder unreadable
        for place in (folder, folder / "..", folder / ".." / "..", Path()):
            if (place / name).is_file():
                return Path(place / name)
    return None
