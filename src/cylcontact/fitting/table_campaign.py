"""A law and a table of measurements to fit it to: columns, free parameters, noise, and starts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from cylcontact.bodies.material import own_table
from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.datasets.measurements import (
    Constants,
    MeasuredData,
    Measurements,
    measurements_of,
    pair_notes,
    read_measured,
    require_positive_penetration,
)
from cylcontact.files.reading import beside_or_above
from cylcontact.files.spec import parse_spec, read_toml
from cylcontact.fitting.campaign import Campaign, CampaignBase
from cylcontact.fitting.law_models import (
    RIG_NAMES,
    for_measurements,
    housed_model,
    is_user_law,
    model_of,
    named_user_model,
    user_model,
    with_rig,
)
from cylcontact.fitting.measured import OBJECTIVES, STANDARDISED, Fit
from cylcontact.fitting.noise import NoiseModel
from cylcontact.fitting.parameters import LawModel, Parameter
from cylcontact.fitting.specs import MeasuredSpec, completed, parameters_of, with_parameters
from cylcontact.laws.adapters import RigCompliance, ScaledLaw
from cylcontact.laws.law import Coefficients
from cylcontact.laws.user import UserFunction, UserLaw
from cylcontact.support.arrays import FloatArray
from cylcontact.support.errors import InputError

_ZERO_REMEDY = (
    "correct the row, or remove it; readings that are not zeroed need a free offset "
    "(--free offset, or offset in [bounds]) and --noise constant"
)
# Objectives of 1.0.0rc1, with what to use instead. Kept for one release.
_GONE = dict.fromkeys(
    ("rms-load", "rms-log-load"),
    "leave it out: penetrations are compared; a column load_std, or --load-error, gives the errors "
    "of loads",
)
# Points evaluated before data are refused as outside a law's domain.
_TRIALS = 256
# Penetrations at which a function of the user's own is looked at.
_LOOKS = 101


@dataclass(frozen=True, eq=False, repr=False)
class TableCampaign(CampaignBase):
    """A law that is fitted to a table of measurements.

    Attributes
    ----------
    measurements : Measurements
        The readings.
    noise : NoiseModel or None
        The noise model of the fit, if it has one.
    """

    spec: MeasuredSpec
    measurements: Measurements
    noise: NoiseModel | None = None

    @property
    def reference(self) -> str:
        """What the law is fitted to."""
        return "measurements"

    @property
    def data_settings(self) -> dict[str, Any]:
        """The whole table; without what results lack that were saved before it was there."""
        data = self.measurements.data
        without = {name for name in ("read", "units") if not getattr(data, name)}
        return {"measurements": data.model_dump(mode="json", exclude=without)}

    @classmethod
    def of_settings(cls, name: str, settings: dict[str, Any], source: str) -> TableCampaign:
        """Return the campaign from the settings in a result, without importing a user's law."""
        where = f"{source}, settings.campaign", f"{source}, settings.measurements"
        spec = parse_spec(MeasuredSpec, settings["campaign"], where[0])
        data = parse_spec(MeasuredData, settings["measurements"], where[1])
        if is_user_law(spec.law):
            own = [key for key in spec.named if key not in RIG_NAMES]
            named = tuple(Parameter(key, -math.inf, math.inf) for key in own)
            model = named_user_model(UserFunction(spec.law, None), named, spec.contact)
        else:
            model = _package_model(spec.law, spec, source)
        return _on_table(name, spec, measurements_of(data, where[1]), model, source)

    @property
    def plain(self) -> Fit:
        """The fit by plain least squares."""
        return Fit(self.model, self.parameters, self.objective, self.measurements)

    @cached_property
    def starts(self) -> FloatArray:
        """The points from which plain least squares descend, shape (number, k)."""
        return self.plain.starts(self.nominal, self.spec.starts, self.spec.seed)

    def fit(self) -> Fit:
        """Return the fit with its noise.

        Raises
        ------
        InputError
            If the law is undefined for some row at all coefficients tried.
        """
        self._require_defined()
        if self.noise is None:
            return self.plain
        ends = map(self.plain.minimise, self.starts)
        return self.plain.estimating(self.noise, min(ends, key=lambda end: end.value).point)

    def _require_defined(self) -> None:
        """Refuse data that no coefficients within the bounds can describe, and name the row."""
        fit, data = self.plain, self.measurements
        unit = np.random.default_rng(0).uniform(size=(_TRIALS, len(fit.free)))
        points = fit.low + unit * (fit.high - fit.low)
        if self.nominal is not None:
            points = np.vstack([self.nominal, points])
        defined = np.zeros(len(data), dtype=int)
        for point in points:
            inside = np.isfinite(fit.raw(point[None, :])[0])
            if inside.all():
                return
            defined += inside
        require_increasing(fit, fit.coefficients(points[0]))  # says more of a law of one's own
        row = int(np.argmin(defined))
        tried = f"{len(points) - defined[row]} of {len(points)} sets of" if defined[row] else "all"
        where = f"{self.source}, {data.data.row_word} {data.line(row)}"
        names = ("load", "penetration", "dR")
        values = [float(data.columns[name][row]) for name in names]
        law = self.model.law
        rule = f"lies outside the domain of {law} at {tried} coefficients tried within the bounds"
        remedy = "move the bounds, remove the row, or choose a law that reaches that far"
        raise InputError(where, ", ".join(names), values, rule, remedy)


def require_increasing(fit: Fit, coefficients: Coefficients) -> None:
    """Refuse a function of the user's own that is no contact law at some coefficients."""
    law, data = fit.model.build(coefficients), fit.data
    if isinstance(law, RigCompliance):
        law = law.base
    function = law.base if isinstance(law, ScaledLaw) else law
    if not isinstance(function, UserLaw):
        return
    at = ", ".join(f"{name} = {value:.6g}" for name, value in function.values.items())
    with np.errstate(all="ignore"):
        deepest = np.fmax(data.penetration, law.penetration(data.load, data.pair))
    deepest = np.where(deepest > 0, deepest, np.abs(data.penetration).max())
    before = np.full(len(data), -np.inf)
    for share in np.linspace(0.0, 1.0, _LOOKS):
        loads = function.load(share * deepest, data.pair)
        wrong = np.flatnonzero((loads <= before) | ((loads < 0) & (share > 0)))
        if wrong.size:
            row = int(wrong[0])
            what = "decreases with" if loads[row] < before[row] else "does not grow with"
            if loads[row] < 0:
                what = f"is negative, {loads[row]:.6g} N/mm, at"
            rule = f"{what} the penetration at {share * deepest[row]:.6g} mm, with {at}"
            remedy = "the load of a contact grows from 0; correct the function, or move the bounds"
            raise InputError(function.name, "load", None, rule, remedy)
        before = np.where(np.isfinite(loads), loads, before)


@dataclass(frozen=True, eq=False)
class MeasuredTable:
    """A table of measurements, and how laws are fitted to it."""

    name: str
    spec: MeasuredSpec
    measurements: Measurements
    folder: Path
    source: str

    def campaign(self, law: str, free: Sequence[str] = ()) -> TableCampaign:
        """Return the campaign that fits a law, with further parameters free."""
        model = _law_model(law, self.spec, self.folder, self.source)
        wanted = tuple(dict.fromkeys((*(self.spec.free or ()), *free))) or None
        spec = self.spec.model_copy(update={"law": law, "free": wanted})
        model = _freed(model, spec, self.measurements, self.source)
        return _on_table(self.name, spec, self.measurements, model, self.source)


def campaign_of_table(
    table: Path | pd.DataFrame,
    law: str,
    contact: Contact,
    constants: Constants,
    name: str = "",
    **settings: Any,
) -> TableCampaign:
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
    TableCampaign

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


def read_campaign(
    path: Path | str,
    runs: int | None = None,
    seed: int | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    fixed: Mapping[str, float] | None = None,
    ties: Mapping[str, str] | None = None,
) -> Campaign | TableCampaign:
    """Read a campaign file, and the grid or the table that it names.

    Parameters
    ----------
    path : path
        A TOML file: one with `dataset` is on a grid, one with `data` on measurements. Either is
        searched for beside it and in the folder above, a table also in the current folder.
    runs, seed, bounds, fixed, ties : optional
        As for `Campaign.read`. On measurements runs are starts.

    Raises
    ------
    InputError
        If a file is invalid.
    """
    contents, path = read_toml(path), Path(path)
    if "data" not in contents:
        return Campaign.read(path, runs=runs, seed=seed, bounds=bounds, fixed=fixed, ties=ties)
    source = str(path)
    if "dataset" in contents:
        rule, remedy = "conflicts with dataset", "keep data for measurements, or dataset for a grid"
        raise InputError(source, "data", contents["data"], rule, remedy)
    contents = with_parameters(contents, bounds, fixed, ties)
    contents |= {"seed": seed} if seed is not None else {}
    contents |= {"starts": runs} if runs is not None else {}
    spec = parse_spec(MeasuredSpec, contents, source)
    table = beside_or_above(path.parent, spec.data)
    if table is None:
        rule = "no such file beside the campaign or above it"
        raise InputError(source, "data", spec.data, rule, "name a .csv, .xlsx or .parquet table")
    _law_model(spec.law, spec, path.parent, source)  # refuses an unknown one before any data
    return _read_table(path.stem, spec, table, path.parent, source).campaign(spec.law)


def campaign_of(name: str, settings: dict[str, Any], source: str) -> Campaign | TableCampaign:
    """Return the campaign from the settings in a result, without importing a user's law."""
    key = "measurements" if isinstance(settings.get("measurements"), dict) else "dataset"
    if not all(isinstance(settings.get(part), dict) for part in ("campaign", key)):
        rule = "lacks the campaign or the dataset"
        raise InputError(source, "settings", None, rule, "redo the fit")
    of_settings = Campaign.of_settings if key == "dataset" else TableCampaign.of_settings
    return of_settings(name, settings, source)


def _law_model(law: str, spec: MeasuredSpec, folder: Path, source: str) -> LawModel:
    if is_user_law(law) and spec.housing is None:
        return user_model(law, spec.contact, source, folder, Path.cwd())
    return _package_model(law, spec, source)


def _package_model(law: str, spec: MeasuredSpec, source: str) -> LawModel:
    if spec.housing is not None:
        return housed_model(law, spec.contact, spec.housing.housing, source)
    return model_of(law, spec.contact, source)


def _read_table(
    name: str, spec: MeasuredSpec, table: Path | pd.DataFrame, folder: Path, source: str
) -> MeasuredTable:
    materials = own_table(spec.materials, folder, source)
    data = read_measured(table, spec.contact, spec.constants, materials, spec)
    measured = measurements_of(data, str(table) if isinstance(table, Path) else source)
    housing = None
    if spec.housing is not None:
        numbers = spec.housing.with_numbers(materials, source)
        spec, housing = spec.model_copy(update={"housing": numbers}), numbers.housing
    data.notes.extend(pair_notes(measured, materials, housing))
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
    name: str,
    spec: MeasuredSpec,
    measured: Measurements,
    model: LawModel,
    source: str,
) -> TableCampaign:
    model = with_rig(model, spec.named)
    rig = f"; the rig's: {', '.join(RIG_NAMES)}"
    parameters = parameters_of(model, spec, source, rig)
    free = sum(p.is_free for p in parameters)
    if len(measured) <= free:
        rule = f"are not more than the {free} free parameters"
        remedy = "measure more points, or fix parameters: [fixed] in a file, --fix NAME=VALUE"
        raise InputError(source, "data", f"{len(measured)} rows", rule, remedy)
    noise = _noise_of(spec, measured, parameters, source)
    objective = STANDARDISED if noise else _objective_of(spec, measured, source)
    if "log" in objective or not any(p.is_free for p in parameters if p.name == "offset"):
        named = Path(source).name == measured.data.source
        where = source if named else f"{source}, {measured.data.source}"
        require_positive_penetration(measured, where, _ZERO_REMEDY)
    chosen = {"objective": objective, "noise": spec.noise if noise else None}
    complete = completed(spec, parameters).model_copy(update=chosen)
    return TableCampaign(name, complete, model, parameters, objective, source, measured, noise)


def _noise_of(
    spec: MeasuredSpec, data: Measurements, parameters: tuple[Parameter, ...], source: str
) -> NoiseModel | None:
    """Return the noise model that a campaign chooses; None for one of the plain objectives."""
    given = [name for name in ("load", "penetration") if f"{name}_std" in data.columns]
    keys = {"group": spec.group, "drift": spec.drift or None, "load_error": spec.load_error}
    chosen = [key for key, value in keys.items() if value is not None]
    has_offset = any(p.name == "offset" and p.is_free for p in parameters)
    # Scatter in proportion to the penetration is not in proportion to a reading with an offset.
    if spec.noise == "both" or (spec.noise == "proportional" and has_offset):
        chosen.append("noise")
    if not chosen and "load" not in given:
        return None
    key = chosen[0] if chosen else "load_std"
    if spec.objective not in (None, STANDARDISED):
        rule, remedy = f"conflicts with {key}, which has a likelihood of its own", "keep one"
        raise InputError(source, "objective", spec.objective, rule, remedy)
    if spec.noise is not None and "penetration" in given:
        rule = "conflicts with the column penetration_std, which gives the noise"
        raise InputError(source, "noise", spec.noise, rule, "keep one of them")
    return NoiseModel(
        noise=spec.noise or ("both" if chosen and "penetration" not in given else None),
        over="group" if spec.group is not None else None,
        drift=bool(spec.drift),
        load_error=spec.load_error or 0.0,
        has_offset=has_offset,
    )


def _objective_of(spec: MeasuredSpec, data: Measurements, source: str) -> str:
    """Return the objective of a campaign without a noise model, or the default for its data."""

    def refused(key: str, value: object, rule: str, remedy: str = "keep one of them") -> InputError:
        return InputError(source, key, value, rule, remedy)

    given, noise = spec.objective, spec.noise
    has_sigma = "penetration_std" in data.columns
    if noise is not None:
        said = [*(["objective"] if given else []), *(["penetration_std"] if has_sigma else [])]
        if said:
            raise refused("noise", noise, f"conflicts with {said[0]}, which says the same")
        return "rms-penetration" if noise == "constant" else "rms-log-penetration"
    if given is None:
        is_absolute = has_sigma or (data.penetration <= 0).any()
        return "rms-penetration" if is_absolute else "rms-log-penetration"
    if given in _GONE:
        raise refused("objective", given, "is gone", _GONE[given])
    if given not in OBJECTIVES:
        rule = "is not an objective for measurements"
        raise refused("objective", given, rule, f"choose {', '.join(OBJECTIVES)}")
    if has_sigma and given != "rms-penetration":
        remedy = "choose rms-penetration, or list the column under ignore"
        raise refused("objective", given, "leaves the column penetration_std unused", remedy)
    return given


def table_of(
    data: object,
    law: str,
    pair: CylinderPair | None,
    contact: Contact | None,
    constants: Constants | None,
    fixed: Mapping[str, float] | None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    **settings: Any,
) -> MeasuredTable:
    """Return the measurements of a pair, as `cylcontact.fit` and `choose` take them."""
    if not isinstance(data, pd.DataFrame | Path | str):
        rule, remedy = f"is a {type(data).__name__}", "give a DataFrame, or the path of a table"
        raise InputError("fit", "data", None, rule, remedy)
    if pair is not None and contact not in (None, pair.contact):
        rule = f"contradicts the pair, which is for {pair.contact} contact"
        raise InputError("fit", "contact", contact, rule, "leave it out")
    kind = pair.contact if pair is not None else contact
    if kind is None:
        raise InputError("fit", "contact", None, "is required without a pair", "give a pair")
    given = {"fixed": fixed, "bounds": bounds}
    settings |= {key: dict(table) for key, table in given.items() if table}
    return read_table(
        data if isinstance(data, pd.DataFrame) else Path(data),
        law,
        kind,
        {**(constants_of(pair) if pair is not None else {}), **(constants or {})},
        **settings,
    )


def constants_of(pair: CylinderPair) -> dict[str, float]:
    """Return a pair as constants of a table of measurements."""
    pair.require_plane_strain("A fit to measurements")
    i, j = pair.material_i, pair.material_j
    values = {"E_i_MPa": i.E, "nu_i": i.nu, "E_j_MPa": j.E, "nu_j": j.nu, "length_mm": pair.length}
    if pair.R_i is None or pair.R_j is None:
        values |= {"dR_mm": pair.dR, "R_i_mm": pair.R_i, "R_j_mm": pair.R_j}
    else:
        values |= {"R_i_mm": pair.R_i, "R_j_mm": pair.R_j}
    given = {name: value for name, value in values.items() if value is not None}
    for name, value in given.items():
        if np.ndim(value):
            rule, remedy = "is an array", "give it as a column of the data"
            raise InputError("fit", name, "of the pair", rule, remedy)
    return {name: float(value) for name, value in given.items()}
