"""Campaigns: a law, the parameters to search, and what it is fitted to: a grid or measurements.

A campaign file names a grid spec (`dataset`), whose reference law is sampled, or a table of
measurements (`data`). `Campaign.read` reads either; `Campaign.on` has a grid and no file;
`read_table` reads a table and no file, and its `campaign` fits a law to it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from cylcontact.bodies.material import own_table
from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.datasets.grid import Grid, grid_from
from cylcontact.datasets.measurements import (
    Constants,
    MeasuredData,
    Measurements,
    measurements_of,
    pair_notes,
    read_measured,
)
from cylcontact.files.provenance import made_with, spec_hash
from cylcontact.files.reading import beside_or_above
from cylcontact.files.spec import parse_spec, read_toml
from cylcontact.fitting.inputs import with_inputs
from cylcontact.fitting.law_models import (
    RIG_NAMES,
    for_measurements,
    grid_model_of,
    housed_model,
    is_user_law,
    model_of,
    named_user_model,
    user_model,
    with_rig,
)
from cylcontact.fitting.noise import OBJECTIVE, NoiseModel
from cylcontact.fitting.parameters import LawModel, Parameter
from cylcontact.fitting.specs import (
    CampaignSpec,
    MeasuredSpec,
    completed,
    parameters_of,
    with_parameters,
)
from cylcontact.laws.user import UserFunction
from cylcontact.support.arrays import FloatArray
from cylcontact.support.errors import InputError
from cylcontact.support.html_repr import table_html

_LIBRARIES = ("numpy", "scipy", "pandas", "pygad", "joblib")


@dataclass(frozen=True, eq=False)
class Campaign:
    """A law and its parameters, and the grid or the measurements that it is fitted to.

    Attributes
    ----------
    name : str
    spec : CampaignSpec or MeasuredSpec
        The settings, with the bounds or the value of every parameter.
    model : LawModel
        The law.
    parameters : tuple of Parameter
        Its parameters, in its order.
    source : str
        Where it is from, for errors.
    data : Grid or Measurements
        What the law is fitted to.
    data_settings : dict
        The contents of the grid file, or the whole table, as plain data.
    noise : NoiseModel, optional
        What a fit to measurements assumes of their scatter.
    """

    name: str
    spec: CampaignSpec | MeasuredSpec
    model: LawModel
    parameters: tuple[Parameter, ...]
    source: str
    data: Grid | Measurements
    data_settings: dict[str, Any]
    noise: NoiseModel | None = None

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
        for p in self.parameters:
            rows[f"{p.name} ({p.unit})" if p.unit else p.name] = (
                f"{p.value:.6g}, fixed" if p.fixed else p.tie or f"{p.low:.6g} to {p.high:.6g}"
            )
        return table_html(f"Campaign {self.name}", rows)

    @property
    def reference(self) -> str:
        """What the law is fitted to: a law's name, or "measurements"."""
        return self.data.reference if isinstance(self.data, Grid) else "measurements"

    @property
    def objective(self) -> str:
        """The name of what is minimised."""
        return self.spec.objective if isinstance(self.spec, CampaignSpec) else OBJECTIVE

    @property
    def settings(self) -> dict[str, Any]:
        """Everything that the result depends on, as plain data."""
        campaign = self.spec.model_dump(mode="json", exclude_none=True)
        return {"campaign": campaign, **self.data_settings}

    @property
    def key(self) -> str:
        """A hash of `settings` and of the file of the user's law, for the journal of the runs."""
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
        """Read a campaign file, and the grid or the table that it names.

        Parameters
        ----------
        path : path
            A TOML file: one with `dataset` is on a grid, one with `data` on measurements. Either
            is searched for beside it and in the folders above.
        runs, seed : int, optional
            In place of the file's. On measurements runs are starts.
        bounds, fixed, ties : mapping, optional
            Parameters to search between two values, to hold at a value, or to set by an expression
            such as "a/10", in place of what the file says of them.

        Raises
        ------
        InputError
            If a file is invalid.

        Examples
        --------
        >>> campaign = Campaign.read("fitting/external.toml", runs=4, fixed={"n": 1.094})
        >>> campaign.spec.genetic.runs, campaign.reference, campaign.spec.fixed
        (4, 'johnson', {'n': 1.094})
        """
        contents, source = with_parameters(read_toml(path), bounds, fixed, ties), str(path)
        contents |= {"seed": seed} if seed is not None else {}
        if "data" not in contents:
            return _on_grid_file(contents, runs, Path(path))
        if "dataset" in contents:
            remedy = "keep data for measurements, or dataset for a grid"
            raise InputError(source, "data", contents["data"], "conflicts with dataset", remedy)
        contents |= {"starts": runs} if runs is not None else {}
        return _on_table_file(parse_spec(MeasuredSpec, contents, source), Path(path))

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
        return _on_grid(name, spec, data, name, grid.source)

    @classmethod
    def of_settings(cls, name: str, settings: dict[str, Any], source: str) -> Campaign:
        """Return the campaign from the settings in a result, without importing a user's law."""
        key = "measurements" if isinstance(settings.get("measurements"), dict) else "dataset"
        if not all(isinstance(settings.get(part), dict) for part in ("campaign", key)):
            rule = "lacks the campaign or the dataset"
            raise InputError(source, "settings", None, rule, "redo the fit")
        where = f"{source}, settings.campaign", f"{source}, settings.{key}"
        if key == "dataset":
            on_grid = parse_spec(CampaignSpec, settings["campaign"], where[0])
            return _on_grid(name, on_grid, settings[key], source, where[1])
        spec = parse_spec(MeasuredSpec, settings["campaign"], where[0])
        data = parse_spec(MeasuredData, settings[key], where[1])
        if is_user_law(spec.law):
            constants = [name for name in spec.named if name not in RIG_NAMES]
            named = tuple(Parameter(name, -math.inf, math.inf) for name in constants)
            model = named_user_model(UserFunction(spec.law, None), named, spec.contact)
        else:
            model = _law_model(spec, Path(), source)
        return _on_measurements(name, spec, measurements_of(data, where[1]), model, source)


# --- on a grid ----------------------------------------------------------------------------------


def _on_grid_file(contents: dict[str, Any], runs: int | None, path: Path) -> Campaign:
    """Return the campaign of a file that names a grid."""
    if runs is not None and isinstance(contents.get("genetic", {}), dict):
        contents["genetic"] = {**contents.get("genetic", {}), "runs": runs}
    spec = parse_spec(CampaignSpec, contents, str(path))
    dataset = beside_or_above(path.parent, spec.dataset)
    if dataset is None:
        rule = "no such file beside the campaign or above it"
        remedy = "name a grid spec, e.g. datasets/internal.toml"
        raise InputError(str(path), "dataset", spec.dataset, rule, remedy)
    return _on_grid(path.stem, spec, read_toml(dataset), str(path), str(dataset))


def _on_grid(
    name: str, spec: CampaignSpec, grid_data: dict[str, Any], source: str, grid_source: str
) -> Campaign:
    grid = grid_from(grid_data, grid_source)
    model = grid_model_of(spec.law, grid.contact, source)
    _require_range(grid, model, source)
    parameters = parameters_of(model, spec, source)
    spec = completed(spec, parameters)
    return Campaign(name, spec, model, parameters, source, grid, {"dataset": grid_data})


def _require_range(grid: Grid, model: LawModel, source: str) -> None:
    """Refuse clearances outside the range of the law."""
    low, high = float(grid.dR.min()), float(grid.dR.max())
    if low < model.dR_min or high > model.dR_max:
        span = f"{model.dR_min:g} to {model.dR_max:g} mm"
        rule = f"its ΔR (mm) leave the range of the {model.law} law for {model.contact} contact, "
        remedy = "narrow the dR axis of the grid"
        raise InputError(source, "dataset", [low, high], rule + span, remedy)


# --- on measurements ----------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class MeasuredTable:
    """Measurements as they were read, and the settings of fits to them."""

    name: str
    spec: MeasuredSpec
    measurements: Measurements
    folder: Path
    source: str

    def campaign(self, law: str, free: Sequence[str] = ()) -> Campaign:
        """Return the campaign that fits a law, with further parameters free."""
        wanted = tuple(dict.fromkeys((*(self.spec.free or ()), *free))) or None
        spec = self.spec.model_copy(update={"law": law, "free": wanted})
        model = _freed(_law_model(spec, self.folder, self.source), spec, self)
        return _on_measurements(self.name, spec, self.measurements, model, self.source)


def name_of_tables(paths: Sequence[Path]) -> str:
    """Return a name for a fit to tables, as that of its folder: those of the files.

    >>> name_of_tables([Path("a.csv.gz"), Path("b.csv")])
    'a+b'
    """
    stems = [path.name.removesuffix(".gz").rpartition(".")[0] or path.name for path in paths]
    more = [f"{len(stems) - 3} more"] if len(stems) > 4 else []
    return "+".join(stems[: 3 if more else 4] + more)


def read_table(
    table: object,
    law: str,
    pair: CylinderPair | None = None,
    contact: Contact | None = None,
    constants: Constants | None = None,
    name: str = "",
    **settings: Any,
) -> MeasuredTable:
    """Read a table, with the keys of a campaign file as settings.

    `table` is a path or a DataFrame, or a list of them, which are fitted together.
    """
    tables = [*table] if isinstance(table, list | tuple) else [table]
    files = [Path(str(each)) for each in tables if isinstance(each, str | Path)]
    for each in tables:
        if not isinstance(each, str | Path) and not hasattr(each, "iloc"):
            remedy = "give a DataFrame, the path of a table, or a list of them"
            raise InputError("fit", "data", None, f"is a {type(each).__name__}", remedy)
    source = ", ".join(map(str, files)) or "DataFrame"
    path = files[0] if files else Path("data")
    if not tables:
        raise InputError("fit", "data", None, "is an empty list", "give at least one table")
    if pair is not None and contact not in (None, pair.contact):
        rule = f"contradicts the pair, which is for {pair.contact} contact"
        raise InputError("fit", "contact", contact, rule, "leave it out")
    contact = contact if pair is None else pair.contact
    if contact is None:
        raise InputError("fit", "contact", None, "is required without a pair", "give a pair")
    given = {key: value for key, value in settings.items() if value is not None}
    of_pair = {} if pair is None else constants_of(pair)
    data = tuple(each.name for each in files) if len(files) > 1 else path.name
    given |= {"data": data, "law": law, "contact": contact}
    spec = parse_spec(MeasuredSpec, given | {"constants": of_pair | {**(constants or {})}}, source)
    name = name or name_of_tables(files or [path])
    return _table(name, spec, tables if len(tables) > 1 else tables[0], path.parent, source)


def _on_table_file(spec: MeasuredSpec, path: Path) -> Campaign:
    """Return the campaign of a file that names a table."""
    source, names = str(path), [spec.data] if isinstance(spec.data, str) else [*spec.data]
    tables = []
    for name in names:
        table = beside_or_above(path.parent, name)
        if table is None:
            rule = "no such file beside the campaign or above it"
            raise InputError(source, "data", name, rule, "name a .csv, .xlsx or .parquet table")
        tables.append(table)
    _law_model(spec, path.parent, source)  # refuses an unknown one before any data
    readings = tables if len(tables) > 1 else tables[0]
    return _table(path.stem, spec, readings, path.parent, source).campaign(spec.law)


def _table(
    name: str, spec: MeasuredSpec, readings: Any, folder: Path, source: str
) -> MeasuredTable:
    materials = own_table(spec.materials, folder, source)
    data = read_measured(readings, spec.contact, spec.constants, materials, spec)
    where = str(readings) if isinstance(readings, Path) else source
    measured, housing = measurements_of(data, where), None
    if spec.housing is not None:
        numbers = spec.housing.with_numbers(materials, source)
        spec, housing = spec.model_copy(update={"housing": numbers}), numbers.housing
    data.notes.extend(pair_notes(measured, materials, housing))
    return MeasuredTable(name, spec, measured, folder, source)


def constants_of(pair: CylinderPair) -> dict[str, float]:
    """Return a pair as constants of a table of measurements."""
    pair.require_plane_strain("A fit to measurements")
    i, j = pair.material_i, pair.material_j
    values = {"E_i_MPa": i.E, "nu_i": i.nu, "E_j_MPa": j.E, "nu_j": j.nu, "length_mm": pair.length}
    values |= {"R_i_mm": pair.R_i, "R_j_mm": pair.R_j}
    if pair.R_i is None or pair.R_j is None:
        values["dR_mm"] = pair.dR
    given = {name: value for name, value in values.items() if value is not None}
    for name, value in given.items():
        if np.ndim(value):
            rule, remedy = "is an array", "give it as a column of the data"
            raise InputError("fit", name, "of the pair", rule, remedy)
    return {name: float(value) for name, value in given.items()}


def _law_model(spec: MeasuredSpec, folder: Path, source: str) -> LawModel:
    if spec.housing is not None:
        return housed_model(spec.law, spec.contact, spec.housing.housing, source)
    if is_user_law(spec.law):
        return user_model(spec.law, spec.contact, source, folder, Path.cwd())
    return model_of(spec.law, spec.contact, source)


def _freed(model: LawModel, spec: MeasuredSpec, table: MeasuredTable) -> LawModel:
    """Return the model with what is free in a fit to measurements."""
    free = spec.free or ()
    for name in free:
        if name not in (*model.names, *RIG_NAMES):
            rule = f"is not a parameter of {model.law} for {model.contact} contact"
            remedy = f"its parameters: {', '.join(dict.fromkeys((*model.names, *RIG_NAMES)))}"
            raise InputError(table.source, "free", name, rule, remedy)
        if name in spec.named:
            rule, remedy = "is bounded, fixed or tied as well", "keep one of them"
            raise InputError(table.source, "free", name, rule, remedy)
    if is_user_law(spec.law):
        model = with_rig(_with_free_constants(model, free, table.source), {*free, *spec.named})
    else:
        model = for_measurements(model, free, spec.named)
    # Bounds of the offset are ± twice the largest reading, of the compliance the same over the
    # largest load. Readings of nothing, or at a load beyond all measure, leave them as they are.
    measured = table.measurements
    largest = 2 * np.abs(measured.penetration).max()
    reach, most = (float(f"{value:.1g}") for value in (largest, largest / measured.load.max()))
    bounds = {name: end for name, end in (("offset", reach), ("compliance", most)) if end > 0}
    parameters = (
        replace(p, low=-bounds[p.name], high=bounds[p.name]) if p.name in bounds else p
        for p in model.parameters
    )
    return replace(model, parameters=tuple(parameters))


def _with_free_constants(model: LawModel, free: Sequence[str], source: str) -> LawModel:
    """Return a model of a user's function with constants free that have bounds of its own."""
    for p in model.parameters:
        if p.name in free and not math.isfinite(p.high - p.low):
            rule = f"{p.name} is a constant of your own law, which has no bounds for it"
            remedy = (
                f"give them: --bound {p.name}=LOW:HIGH in place of --free, or write "
                f"{p.name}: (LOW, HIGH) in the function"
            )
            raise InputError(source, "free", p.name, rule, remedy)
    freed = (replace(p, value=None) if p.name in free else p for p in model.parameters)
    return replace(model, parameters=tuple(freed))


def _on_measurements(
    name: str, spec: MeasuredSpec, measured: Measurements, model: LawModel, source: str
) -> Campaign:
    of_rig = [name for name in spec.uncertain if name in RIG_NAMES]
    model = with_rig(model, {*spec.named, *of_rig})
    parameters = parameters_of(model, spec, source, f"; the rig's: {', '.join(RIG_NAMES)}")
    if spec.uncertain:
        known = replace(model, parameters=parameters)
        model = with_inputs(known, spec.uncertain, measured.columns, source)
        parameters = model.parameters
    free = [p.name for p in parameters if p.is_free and p.known is None]
    if len(measured) <= len(free):
        rule = f"are not more than the {len(free)} free parameters"
        remedy = "measure more points, or fix parameters: [fixed] in a file, --fix NAME=VALUE"
        raise InputError(source, "data", f"{len(measured)} rows", rule, remedy)
    noise = _noise_of(spec, measured, "offset" in free, source)
    settings = {"measurements": measured.data.model_dump(mode="json")}
    spec = completed(spec, parameters)
    return Campaign(name, spec, model, parameters, source, measured, settings, noise)


def _noise_of(spec: MeasuredSpec, data: Measurements, has_offset: bool, source: str) -> NoiseModel:
    """Return the noise that a campaign states, or the usual one: both kinds of scatter."""
    sigma = data.columns.get("penetration_std")
    if spec.noise is not None and sigma is not None:
        rule = "conflicts with the column penetration_std, which gives the noise"
        raise InputError(source, "noise", spec.noise, rule, "keep one of them")
    others = spec.group is not None or bool(spec.drift) or spec.load_error is not None
    # With deviations of the loads alone, single readings have no other scatter.
    is_given = sigma is not None or ("load_std" in data.columns and not others)
    return NoiseModel(
        noise=spec.noise or (None if is_given else "both"),
        over="group" if spec.group is not None else None,
        drift=bool(spec.drift),
        load_error=spec.load_error or 0.0,
        has_offset=has_offset,
    )
