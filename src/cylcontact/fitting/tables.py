"""Fit a law to a table of readings: read it, make its space, descend, check, and report.

table, pair, law, options
→ `read_table`      Table: checked readings and the settings of a fit
→ `Table.campaign`  TableCampaign: the law, its parameters and the noise
→ `.fit`            Fit: free parameters and residuals, with the noise estimated
→ `fit_table`       descends from several starts, and finds intervals and tests
→ `DataFit`         the result
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

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
from cylcontact.files.journal import Journal
from cylcontact.files.reading import beside_or_above
from cylcontact.files.spec import parse_spec, read_toml
from cylcontact.fitting.campaign import Campaign, CampaignBase
from cylcontact.fitting import findings
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
from cylcontact.fitting.noise import ABSOLUTE, STANDARDISED, NoiseModel, Plain, noise_of
from cylcontact.fitting.parameters import LawModel, Parameter
from cylcontact.fitting.readings import Fit, Optimum, singular
from cylcontact.fitting.records import Estimate, MaxDifference, ObjectiveValue, SampleCounts
from cylcontact.fitting.runs import best_of, descend_from, published_on, run_all
from cylcontact.fitting.specs import MeasuredSpec, completed, parameters_of, with_parameters
from cylcontact.laws.adapters import RigCompliance, ScaledLaw
from cylcontact.laws.law import ContactLaw
from cylcontact.laws.user import UserFunction, UserLaw
from cylcontact.support.arrays import FloatArray
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import Workers, call
from cylcontact.support.progress import Progress, silent

if TYPE_CHECKING:
    import pandas as pd

    from cylcontact.fitting.data_fit import DataFit

_ZERO_REMEDY = (
    "correct the row, or remove it; readings that are not zeroed need a free offset "
    "(--free offset, or offset in [bounds]) and --noise constant"
)
# Points evaluated before data are refused as outside a law's domain.
_TRIALS = 256
# Penetrations at which a function of the user's own is looked at.
_LOOKS = 101
# Descents to so few measurements take less time than starting worker processes.
_FEW_ROWS = 2_000


# --- the table ----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Table:
    """A table of measurements, and how laws are fitted to it."""

    name: str
    spec: MeasuredSpec
    measurements: Measurements
    folder: Path
    source: str

    def campaign(self, law: str, free: Sequence[str] = ()) -> TableCampaign:
        """Return the campaign that fits a law, with further parameters free."""
        wanted = tuple(dict.fromkeys((*(self.spec.free or ()), *free))) or None
        spec = self.spec.model_copy(update={"law": law, "free": wanted})
        model = _freed(_law_model(spec, self.folder, self.source), spec, self)
        return _campaign(self.name, spec, self.measurements, model, self.source)


def read_table(
    table: object,
    law: str,
    pair: CylinderPair | None = None,
    contact: Contact | None = None,
    constants: Constants | None = None,
    name: str = "",
    **settings: Any,
) -> Table:
    """Read a table, a path or a DataFrame, with the keys of a campaign file as settings."""
    is_file = isinstance(table, str | Path)
    path, source = (Path(str(table)), str(table)) if is_file else (Path("data"), "DataFrame")
    if not is_file and not hasattr(table, "iloc"):
        rule, remedy = f"is a {type(table).__name__}", "give a DataFrame, or the path of a table"
        raise InputError("fit", "data", None, rule, remedy)
    if pair is not None and contact not in (None, pair.contact):
        rule = f"contradicts the pair, which is for {pair.contact} contact"
        raise InputError("fit", "contact", contact, rule, "leave it out")
    contact = contact if pair is None else pair.contact
    if contact is None:
        raise InputError("fit", "contact", None, "is required without a pair", "give a pair")
    given = {key: value for key, value in settings.items() if value is not None}
    of_pair = {} if pair is None else constants_of(pair)
    given |= {"data": path.name, "law": law, "contact": contact}
    spec = parse_spec(MeasuredSpec, given | {"constants": of_pair | {**(constants or {})}}, source)
    return _table(name or path.stem, spec, path if is_file else table, path.parent, source)


def _table(name: str, spec: MeasuredSpec, readings: Any, folder: Path, source: str) -> Table:
    materials = own_table(spec.materials, folder, source)
    data = read_measured(readings, spec.contact, spec.constants, materials, spec)
    where = str(readings) if isinstance(readings, Path) else source
    measured, housing = measurements_of(data, where), None
    if spec.housing is not None:
        numbers = spec.housing.with_numbers(materials, source)
        spec, housing = spec.model_copy(update={"housing": numbers}), numbers.housing
    data.notes.extend(pair_notes(measured, materials, housing))
    return Table(name, spec, measured, folder, source)


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


# --- a law, its parameters and the noise ----------------------------------------------------------


@dataclass(frozen=True, eq=False, repr=False)
class TableCampaign(CampaignBase):
    """A law that is fitted to a table of measurements.

    Attributes
    ----------
    measurements : Measurements
        The readings.
    noise : Plain or NoiseModel
        What the fit assumes of their scatter.
    """

    spec: MeasuredSpec
    measurements: Measurements
    noise: Plain | NoiseModel

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
            constants = [key for key in spec.named if key not in RIG_NAMES]
            named = tuple(Parameter(key, -math.inf, math.inf) for key in constants)
            model = named_user_model(UserFunction(spec.law, None), named, spec.contact)
        else:
            model = _law_model(spec, Path(), source)
        return _campaign(name, spec, measurements_of(data, where[1]), model, source)

    @property
    def plain(self) -> Fit:
        """The fit by plain least squares."""
        noise = self.noise
        if isinstance(noise, NoiseModel):
            noise = Plain(is_log=False, given=self.measurements.columns.get("penetration_std"))
        return Fit(self.model, self.parameters, self.measurements, noise)

    def fit(self) -> Fit:
        """Return the fit with its noise.

        Raises
        ------
        InputError
            If the law is undefined for some row at all coefficients tried.
        """
        plain = self.plain
        self._require_defined(plain)
        if isinstance(self.noise, Plain):
            return plain
        starts = plain.starts(self.nominal, self.spec.starts, self.spec.seed)
        point, _ = min(map(plain.minimise, starts), key=lambda end: end[1])
        return plain.estimating(self.noise, point)

    def _require_defined(self, fit: Fit) -> None:
        """Refuse data that no coefficients within the bounds can describe, and name the row."""
        data = self.measurements
        points = fit.scatter(np.random.default_rng(0), _TRIALS)
        if self.nominal is not None:
            points = np.vstack([self.nominal, points])
        defined = np.zeros(len(data), dtype=int)
        for point in points:
            inside = np.isfinite(fit.raw(point[None, :])[0])
            if inside.all():
                return
            defined += inside
        require_increasing(fit, points[0])  # says more of a law of one's own
        row = int(np.argmin(defined))
        tried = f"{len(points) - defined[row]} of {len(points)} sets of" if defined[row] else "all"
        where = f"{self.source}, {data.data.row_word} {data.line(row)}"
        names = ("load", "penetration", "dR")
        values = [float(data.columns[name][row]) for name in names]
        law = self.model.law
        rule = f"lies outside the domain of {law} at {tried} coefficients tried within the bounds"
        remedy = "move the bounds, remove the row, or choose a law that reaches that far"
        raise InputError(where, ", ".join(names), values, rule, remedy)


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

    Raises
    ------
    InputError
        If the table or a setting is invalid.
    """
    read = read_table(table, law, None, contact, constants, name, **settings)
    return read.campaign(law)


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
    _law_model(spec, path.parent, source)  # refuses an unknown one before any data
    return _table(path.stem, spec, table, path.parent, source).campaign(spec.law)


def campaign_of(name: str, settings: dict[str, Any], source: str) -> Campaign | TableCampaign:
    """Return the campaign from the settings in a result, without importing a user's law."""
    key = "measurements" if isinstance(settings.get("measurements"), dict) else "dataset"
    if not all(isinstance(settings.get(part), dict) for part in ("campaign", key)):
        rule = "lacks the campaign or the dataset"
        raise InputError(source, "settings", None, rule, "redo the fit")
    kind = Campaign if key == "dataset" else TableCampaign
    return kind.of_settings(name, settings, source)


def _law_model(spec: MeasuredSpec, folder: Path, source: str) -> LawModel:
    if spec.housing is not None:
        return housed_model(spec.law, spec.contact, spec.housing.housing, source)
    if is_user_law(spec.law):
        return user_model(spec.law, spec.contact, source, folder, Path.cwd())
    return model_of(spec.law, spec.contact, source)


def _freed(model: LawModel, spec: MeasuredSpec, table: Table) -> LawModel:
    """Return the model with what is free in a fit to measurements."""
    free = spec.free or ()
    for name in free:
        if name not in (*model.names, *RIG_NAMES):
            rule = f"is not a parameter of {model.law} for {model.contact} contact"
            remedy = f"its parameters: {', '.join((*model.names, *RIG_NAMES))}"
            raise InputError(table.source, "free", name, rule, remedy)
        if name in spec.named:
            rule, remedy = "is bounded, fixed or tied as well", "keep one of them"
            raise InputError(table.source, "free", name, rule, remedy)
    if is_user_law(spec.law):
        model = with_rig(model, {*free, *spec.named})
    else:
        model = for_measurements(model, free, spec.named)
    # A reading is not further from zero than the largest of them by much, and neither a rig nor
    # another datum is worth much more than the readings over the loads.
    measured = table.measurements
    largest = 2 * np.abs(measured.penetration).max()
    reach, most = (float(f"{value:.1g}") for value in (largest, largest / measured.load.max()))
    # Readings of nothing, or at a load beyond all measure, leave the bounds as they are.
    bounds = {name: end for name, end in (("offset", reach), ("compliance", most)) if end > 0}
    parameters = (
        replace(p, low=-bounds[p.name], high=bounds[p.name]) if p.name in bounds else p
        for p in model.parameters
    )
    return replace(model, parameters=tuple(parameters))


def _campaign(
    name: str, spec: MeasuredSpec, measured: Measurements, model: LawModel, source: str
) -> TableCampaign:
    model = with_rig(model, spec.named)
    parameters = parameters_of(model, spec, source, f"; the rig's: {', '.join(RIG_NAMES)}")
    free = [p.name for p in parameters if p.is_free]
    if len(measured) <= len(free):
        rule = f"are not more than the {len(free)} free parameters"
        remedy = "measure more points, or fix parameters: [fixed] in a file, --fix NAME=VALUE"
        raise InputError(source, "data", f"{len(measured)} rows", rule, remedy)
    noise = noise_of(spec, measured, "offset" in free, source)
    is_plain = isinstance(noise, Plain)
    if (isinstance(noise, Plain) and noise.is_log) or "offset" not in free:
        named = Path(source).name == measured.data.source
        where = source if named else f"{source}, {measured.data.source}"
        require_positive_penetration(measured, where, _ZERO_REMEDY)
    chosen = {"objective": noise.objective, "noise": None if is_plain else spec.noise}
    spec = completed(spec, parameters).model_copy(update=chosen)
    return TableCampaign(name, spec, model, parameters, noise.objective, source, measured, noise)


def require_increasing(fit: Fit, point: FloatArray) -> None:
    """Refuse a function of the user's own that is no contact law at some free parameters."""
    law, data = fit.model.build(fit.coefficients(point)), fit.data
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


# --- the fit --------------------------------------------------------------------------------------


def fit_table(
    campaign: TableCampaign,
    jobs: Workers = 1,
    progress: Progress = silent,
    checkpoint: Path | None = None,
    resume: bool = False,
) -> DataFit:
    """Fit a law to a table of measurements.

    Parameters
    ----------
    campaign : TableCampaign
        From `read_campaign` or `campaign_of_table`.
    jobs, progress, checkpoint, resume
        As for `calibrate`.

    Returns
    -------
    DataFit

    Raises
    ------
    InputError
        If the law is undefined for some of the data, or `checkpoint` belongs to another campaign.
    """
    try:
        return _fitted(campaign, jobs, progress, checkpoint, resume)
    except np.linalg.LinAlgError as error:
        raise singular(campaign.source) from error


def _fitted(
    campaign: TableCampaign,
    jobs: Workers,
    progress: Progress,
    checkpoint: Path | None,
    resume: bool,
) -> DataFit:
    from cylcontact.fitting import results  # it imports this module, as data_fit does
    from cylcontact.fitting.data_fit import DataFit

    spec, data, model = campaign.spec, campaign.measurements, campaign.model
    if isinstance(jobs, int) and len(data) <= _FEW_ROWS:
        jobs = 1
    provenance = campaign.provenance  # of what is run, not of what is there when it ends
    fit = campaign.fit()
    journal = Journal(checkpoint, "campaign", campaign.key) if checkpoint else None
    starts = fit.starts(campaign.nominal, spec.starts, spec.seed)
    calls = [call(descend_from, fit, start, k, spec.seed) for k, start in enumerate(starts)]
    records = run_all(calls, jobs, progress, journal, resume)
    best, published = best_of(records), published_on(fit)
    point = fit.point(best.coefficients)
    optimum = Optimum(fit.at_best(point), point)
    require_increasing(fit, point)
    progress("profiling", 0, 1)
    level = spec.level or findings.LEVEL
    searched, better = findings.estimates_of(optimum, level, jobs)
    progress("profiling", 1, 1)
    estimates = {}
    for p in campaign.parameters:
        said = f"= {p.tie}" if p.tie else "fixed"
        known = Estimate(value=best.coefficients[p.name], unit=p.unit, verdict=said)
        estimates[p.name] = searched.get(p.name, known)
    undetermined = findings.on_lack_of_determination(optimum, searched)
    disagreement, on_runs = results.on_runs(records, DataFit.round_off, (), "--fix NAME=VALUE")
    notes = [*findings.notes_of(optimum, level, undetermined), *better, *data.data.notes]
    if published is not None:
        notes.append(
            f"on these data the law has an objective of {published.objective:.4g} with its "
            f"published constants, and {best.objective:.4g} fitted"
        )
    of_published = model.build(published.coefficients) if published else None
    worst = optimum.law, of_published
    is_given, noise = fit.noise.is_given, optimum.covariance_of_readings
    unit = {ABSOLUTE: "mm", STANDARDISED: "std. dev."}.get(campaign.objective, "")
    return DataFit(
        name=campaign.name,
        law=model.law,
        contact=model.contact,
        reference=campaign.reference,
        estimates=estimates,
        objective=ObjectiveValue(
            name=campaign.objective, value=best.objective, unit="std. dev." if is_given else unit
        ),
        published=published,
        # Of readings about zero a relative difference says nothing.
        max_abs_diff_percent=MaxDifference(
            **{
                key: _largest_percent(data, law) if law and data.penetration.min() > 0 else None
                for key, law in zip(("fitted", "published"), worst, strict=True)
            }
        ),
        runs=records,
        counts=SampleCounts(samples=len(data), masked=0),
        warnings=[*findings.warnings_of(optimum, searched), *undetermined, *disagreement],
        notes=[*notes, *on_runs],
        settings=campaign.settings,
        provenance=provenance,
        level=level,
        sigma=optimum.sigma,
        degrees_of_freedom=optimum.degrees,
        chi_square_p=optimum.chi_square_p,
        correlation=findings.correlation_of(optimum).tolist(),
        outliers=[data.line(row) for row in findings.outliers(optimum)],
        noise=None if noise is None else findings.deviations_of(optimum, noise),
        log_likelihood=optimum.log_likelihood,
        estimated=optimum.estimated,
        r_squared=findings.r_squared(optimum),
    ).with_optimum(optimum)


def _largest_percent(data: Measurements, law: ContactLaw) -> float | None:
    """Return the largest difference from the measurements in percent; None if undefined."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.abs(law.penetration(data.load, data.pair) / data.penetration - 1)
    finite = ratio[np.isfinite(ratio)]  # a reading may be 0
    return float(100 * finite.max()) if finite.size else None


def fit(
    data: pd.DataFrame | Path | str,
    law: str,
    pair: CylinderPair | None = None,
    *,
    contact: Contact | None = None,
    constants: Constants | None = None,
    free: Sequence[str] | str = (),
    fixed: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    ties: Mapping[str, str] | None = None,
    level: float = findings.LEVEL,
    jobs: Workers = 1,
    **settings: Any,
) -> DataFit:
    """Fit a law to measurements.

    Parameters
    ----------
    data : DataFrame or path
        Columns of loads and penetrations with their units, such as load_N and penetration_um, and
        of whatever differs from row to row: dR_um, E_GPa, material, ….
    law : str
        Its name, or module:function for one of your own.
    pair : CylinderPair, optional
        The two cylinders, if they are the same in all rows.
    contact : {"internal", "external"}, optional
        Without a pair, a pin in a hole or two rollers.
    constants : mapping, optional
        Values for all rows by column name, in place of a pair or beside it.
    free : str or sequence of str, optional
        Parameters to search beside the usual ones, with their default bounds: the constants of a
        law's shape, or the compliance of the rig.
    fixed : mapping of str to float, optional
        Parameters to hold at a value.
    bounds : mapping of str to (low, high), optional
        Parameters to search between two values.
    ties : mapping of str to str, optional
        Parameters to set by an expression of others, such as "a/10".
    level : float, optional
        The level of the intervals, between 0 and 1.
    jobs : int or Cluster, optional
        Worker processes; the result does not depend on them.
    **settings
        Other keys of a campaign file: noise, group, drift, load_error, columns, branch,
        ignore, sheet, header, decimal, loads, sign, objective, materials, starts, seed, name.

    Returns
    -------
    DataFit

    Raises
    ------
    InputError
        If the data or a setting is invalid, or the law is undefined for some of the data.

    Examples
    --------
    >>> import pandas as pd
    >>> import cylcontact as cc
    >>> steel = cc.Material("steel", E="207 GPa", nu=0.3)
    >>> pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.97, material=steel, length=20.0)
    >>> load, noise = np.geomspace(10.0, 1000.0, 9), 1 + 0.01 * np.cos(np.arange(9))
    >>> depth = cc.laws.Explicit().penetration(load, pair) * noise
    >>> data = pd.DataFrame({"load_N": load * 20.0, "penetration_um": 1e3 * depth})
    >>> result = cc.fit(data, "explicit", pair)
    >>> print(result.to_frame().loc["stiffness_factor", ["value", "standard_error"]].to_dict())
    {'value': 1.0008..., 'standard_error': 0.0043...}
    """
    tables = {"fixed": fixed, "bounds": bounds, "ties": ties}
    settings |= {key: dict(table) for key, table in tables.items() if table}
    settings |= {"free": ((free,) if isinstance(free, str) else tuple(free)) or None}
    table = read_table(data, law, pair, contact, constants, level=level, **settings)
    return fit_table(table.campaign(law), jobs)
