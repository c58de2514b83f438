"""Fit results: coefficients, their quality, and everything needed to redo the fit."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from pydantic import Field

from cylcontact.errors import InputError, short
from cylcontact.files import replacing
from cylcontact.fitting import report
from cylcontact.fitting.campaign import Campaign, campaign_from_settings
from cylcontact.fitting.law_models import law_of
from cylcontact.fitting.predictions import prediction_table, residual_table
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.records import (
    MaxDifference,
    ObjectiveValue,
    Published,
    RunRecord,
    SampleCounts,
)
from cylcontact.fitting.specs import ParameterSpec
from cylcontact.fitting.uncertainty.estimates import Uncertainty
from cylcontact.fitting.uncertainty.law_profiles import Profile
from cylcontact.fitting.uncertainty.study import problem_of_result
from cylcontact.formats import marked, upgraded
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.pair import Contact, CylinderPair
from cylcontact.reading import RESULT_BYTES, read_text
from cylcontact.spec import Spec, parse_spec, parser_reason, require_other_kind

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["FitResult", "require_same_inputs"]


class FitResult(Spec):
    """The result of a campaign.

    `print(result)` gives the report, and a notebook shows it with its picture. `to_law` returns the
    fitted law. `cylcontact.fit` has an example.
    """

    name: str = Field(description="the campaign's name")
    law: str = Field(description="the law fitted")
    contact: Contact = Field(description="the contact it is for")
    reference: str = Field(description="the law it was fitted to, or measurements")
    coefficients: dict[str, float] = Field(description="the fitted coefficients")
    objective: ObjectiveValue = Field(description="the objective reached")
    bound: float | None = Field(
        description="the per-clearance lower bound of the objective, for power laws"
    )
    published: Published | None = Field(description="the published coefficients' objective")
    max_abs_diff_percent: MaxDifference = Field(description="largest |Eq 9| over the data")
    profiles: dict[str, Profile] = Field(
        description="a profile for each free coefficient, for a law"
    )
    runs: list[RunRecord] = Field(description="every run")
    counts: SampleCounts = Field(description="samples used and masked")
    settings: dict[str, Any] = Field(description="the campaign and the grid, or the data, as run")
    provenance: dict[str, Any] = Field(description="versions and hashes")
    kind: Literal["discrepancy", "noise"] = Field(
        "discrepancy",
        description="whether the residuals are discrepancy of laws, or noise of data",
    )
    uncertainty: Uncertainty | None = Field(
        None, description="the uncertainty of the coefficients, for measured data"
    )

    @classmethod
    def read(cls, path: Path | str) -> FitResult:
        """Read a result file, of this version of the program or an older one.

        Raises
        ------
        InputError
            If the file cannot be read, is not a result, is of a newer format, or is inconsistent.
        """
        source = str(path)
        text = read_text(path, RESULT_BYTES, "name a result, a JSON file")
        try:
            data = json.loads(text)
        except (ValueError, RecursionError) as error:
            require_other_kind(path, text, "a fit result")
            rule = f"is not JSON ({parser_reason(error)})"
            raise InputError(source, "", None, rule, "name a result, or redo the fit") from error
        if not isinstance(data, dict):
            raise InputError(source, "", None, "is not a result", "name one that a fit has written")
        result = parse_spec(cls, upgraded("fit result", data, source), source)
        _require_consistent(result, source)
        return result

    def save(self, path: Path | str) -> None:
        """Write the result as JSON, complete or not at all."""
        with replacing(path) as temporary:
            self.write(temporary)

    def write(self, path: Path) -> None:
        """Write the result as JSON to a file that is not yet in its place."""
        contents = marked("fit result", self._plain())
        text = json.dumps(contents, indent=1, ensure_ascii=False, allow_nan=False)
        try:
            path.write_text(text + "\n", encoding="utf-8")
        except UnicodeEncodeError as error:
            source = f"fit result {self.name!r}"
            raise InputError(source, "", None, "is not text in UTF-8", "rename it") from error

    def _plain(self) -> dict[str, Any]:
        """Return the contents of the file; only fits to measurements have the last two keys."""
        exclude = {"kind", "uncertainty"} if self.kind == "discrepancy" else None
        return self.model_dump(exclude=exclude)

    @cached_property
    def problem(self) -> Problem:
        """The problem of a fit to measurements.

        Raises
        ------
        InputError
            If it is a fit to a law, or was read from a file and has a law of your own.
        """
        return problem_of_result(self)

    def with_problem(self, problem: Problem) -> FitResult:
        """Return the result, which remembers the problem it solves, with a law of your own too."""
        self.__dict__["problem"] = problem
        return self

    def __getstate__(self) -> dict[Any, Any]:
        # The problem holds functions, and is made again where it is needed.
        state = super().__getstate__()
        fields = {k: v for k, v in state["__dict__"].items() if k != "problem"}
        return {**state, "__dict__": fields}

    def to_law(self) -> ContactLaw:
        """Return the fitted law of the contact, without the offset and compliance of the rig.

        Raises
        ------
        InputError
            If the law is a Python function of your own.
        """
        return law_of(self)

    def to_frame(self) -> pd.DataFrame:
        """Return the coefficients as a table.

        Returns
        -------
        pandas.DataFrame
            A row for each coefficient: value, unit, standard_error, low, high (the ends of the
            interval; NaN for one that was not searched), and verdict.
        """
        return report.coefficient_table(self)

    def summary(self) -> str:
        """Return the report as text, as `print` shows it."""
        return str(self)

    @property
    def residuals(self) -> pd.DataFrame:
        """The data beside the fit, a row for each measurement.

        Columns line, the labels of the table, load_N_per_mm, penetration_mm, fitted_mm (or
        fitted_N_per_mm if loads were compared), residual_mm (measured less fitted), standardised
        (in standard deviations), and with series series_mm, what the series adds to the law.
        """
        return residual_table(self.problem, self.coefficients)

    def predict(
        self, load: ArrayLike, band: float = 0.95, pair: CylinderPair | None = None
    ) -> pd.DataFrame:
        """Return what the fitted law predicts for readings, with bands.

        Parameters
        ----------
        load : array_like
            Loads in N/mm.
        band : float
            Level of the bands.
        pair : CylinderPair, optional
            Any pair of the same contact; by default that of the data.

        Returns
        -------
        pandas.DataFrame
            Columns load_N_per_mm, penetration_mm, low_mm and high_mm (band of a new reading),
            curve_low_mm and curve_high_mm (band of the curve).

        Raises
        ------
        InputError
            If the data have several pairs and none is given, the coefficients have no covariance,
            or the law is undefined at a load.
        """
        return prediction_table(self.problem, self.coefficients, load, band, pair)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the data, the fitted law and the band of a new reading; return the axes.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a figure of its own.
        """
        from cylcontact.fitting import drawings

        return drawings.plot(self, ax)

    def plot_residuals(self, ax: Axes | None = None) -> Axes:
        """Draw the residuals over the load; `ax` as for `plot`."""
        from cylcontact.fitting import drawings

        return drawings.plot_residuals(self, ax)

    def plot_profile(self, name: str, ax: Axes | None = None) -> Axes:
        """Draw how much worse the fit gets when a coefficient moves and all others follow.

        Parameters
        ----------
        name : str
            A coefficient that was searched.
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a figure of its own.
        """
        from cylcontact.fitting import drawings

        return drawings.plot_profile(self, name, ax)

    @property
    def correlation(self) -> pd.DataFrame:
        """Correlations of the free coefficients of a fit to measurements."""
        return pd.DataFrame(self._uncertainty("correlation"))

    @property
    def aic(self) -> float:
        """Akaike's information criterion, 2k − 2·ln L, k with the deviations of the noise."""
        return float(2 * self._uncertainty("estimated") - 2 * self._uncertainty("log_likelihood"))

    @property
    def bic(self) -> float:
        """The Bayesian information criterion, k·ln N − 2·ln L."""
        k, N = self._uncertainty("estimated"), self._uncertainty("rows")
        return float(k * np.log(N) - 2 * self._uncertainty("log_likelihood"))

    @property
    def r_squared(self) -> float:
        """Share of the variance of the readings that the law describes."""
        return float(self._uncertainty("r_squared"))

    @property
    def level(self) -> float:
        """The level of the intervals."""
        return float(self._uncertainty("level"))

    def _uncertainty(self, name: str) -> Any:
        """Return an attribute of the uncertainty.

        Raises
        ------
        InputError
            If the result has none.
        """
        value = getattr(self.uncertainty, name, None)
        if value is None:
            rule = "is for fits to measurements, by least squares, of this version"
            raise InputError(f"fit result {self.name!r}", name, None, rule, "fit the data again")
        return value

    def repeatable(self) -> dict[str, Any]:
        """Return what the same seed reproduces: everything but times and provenance."""
        data = self.model_dump(exclude={"provenance"})
        for run in data["runs"]:
            del run["seconds"]
        return data

    def __str__(self) -> str:
        return report.as_text(self)

    def __repr__(self) -> str:
        return (
            f"FitResult({self.name!r}, {self.objective.name} = {self.objective.value:.6g}, "
            f"coefficients={self.coefficients})"
        )

    def _repr_html_(self) -> str:
        return report.as_html(self) + self._picture()

    def _picture(self) -> str:
        """Return the picture of a fit to measurements as HTML; none if it cannot be drawn."""
        if self.uncertainty is None:
            return ""
        from cylcontact.fitting import drawings
        from cylcontact.plots.style import figure_style

        try:
            with figure_style():
                return drawings.fit_drawing(self)._repr_html_()
        except InputError:  # the result was read from a file, and the law is a user's own
            return ""


def require_same_inputs(path: Path, campaign: Campaign) -> None:
    """Refuse to replace a result of other inputs than those of a campaign.

    Parameters
    ----------
    path : Path
        Where the result will be written.
    campaign : Campaign
        The campaign.

    Raises
    ------
    InputError
        If the file exists and is another campaign's result, or not a result.
    """
    remedy = "write elsewhere with -o, or add --force to replace it"
    if not path.exists():
        return
    try:
        before = FitResult.read(path).settings
    except InputError as error:
        rule = "is in the place of the result and cannot be read as one"
        raise InputError(str(path), "", None, rule, remedy) from error
    now = json.loads(json.dumps(campaign.settings))
    changed = _differences(before, now)
    if changed:
        more = f", and {len(changed) - 2} more" if len(changed) > 2 else ""
        named = ", ".join(changed[:2]) + more
        rule = f"holds a result that came from other inputs ({named})"
        raise InputError(str(path), "", None, rule, remedy)


def _differences(before: Any, now: Any, key: str = "") -> list[str]:
    """Return the differences between two settings, one text for each key.

    Examples
    --------
    >>> _differences({"law": "power", "seed": 1}, {"law": "hertz", "seed": 1})
    ["law: 'power' there, 'hertz' now"]
    """
    if before == now:
        return []
    if isinstance(before, dict) and isinstance(now, dict):
        names = [*before, *(name for name in now if name not in before)]
        pairs = ((f"{key}.{n}" if key else n, before.get(n), now.get(n)) for n in names)
        return [text for name, old, new in pairs for text in _differences(old, new, name)]
    old, new = (short(value, 40) or "nothing" for value in (before, now))
    return [f"{key} differs" if old == new else f"{key}: {old} there, {new} now"]


def _require_consistent(result: FitResult, source: str) -> None:
    """Refuse a result with invalid settings or inconsistent parts."""
    campaign = campaign_from_settings(result.name, result.settings, source)
    names = campaign.model.names
    _require_of_campaign(result, campaign, source)
    sets = {"coefficients": result.coefficients}
    if result.published is not None:
        sets["published.coefficients"] = result.published.coefficients
    sets |= {f"runs.{run.index}.coefficients": run.coefficients for run in result.runs}
    for key, coefficients in sets.items():
        if set(coefficients) != set(names):
            rule = f"must be the coefficients of its campaign: {', '.join(names)}"
            raise InputError(source, key, sorted(coefficients), rule, "redo the fit")
    _require_within(result.coefficients, campaign.spec.parameters, source)
    if result.uncertainty is not None and not {*result.uncertainty.estimates} <= {*names}:
        rule = f"must be those of coefficients of its campaign: {', '.join(names)}"
        raise InputError(source, "uncertainty.estimates", None, rule, "redo the fit")
    for name, curve in result.profiles.items():
        if name not in names or len(curve.values) != len(curve.objective):
            rule = "must be that of a coefficient, with as many values as objectives"
            raise InputError(source, f"profiles.{name}", None, rule, "redo the fit")
    if not result.runs:
        raise InputError(source, "runs", [], "must hold at least one run", "redo the fit")


def _require_within(
    coefficients: Mapping[str, float], tables: Mapping[str, ParameterSpec], source: str
) -> None:
    """Refuse coefficients that the campaign could not have reached."""
    for name, table in tables.items():
        value = coefficients[name]
        rule = f"lies outside the bounds of its campaign, {table.low} to {table.high}"
        if table.fixed:
            rule = f"must be the value that its campaign fixes, {table.value}"
        if not table.allows(value) or (table.fixed and value != table.value):
            raise InputError(source, f"coefficients.{name}", value, rule, "redo the fit")


def _require_of_campaign(result: FitResult, campaign: Campaign, source: str) -> None:
    """Refuse a result whose law, contact, reference or kind is not that of its campaign."""
    model, data = campaign.model, campaign.data
    expected = {"law": model.law, "contact": model.contact, "kind": data.kind}
    for key, value in (expected | {"reference": data.reference}).items():
        if getattr(result, key) != value:
            rule = f"must be that of its campaign, {value}"
            raise InputError(source, key, getattr(result, key), rule, "redo the fit")
    if (data.kind == "noise") != (result.uncertainty is not None):
        rule = "is for fits to measurements, and required for them"
        raise InputError(source, "uncertainty", None, rule, "redo the fit")
