"""The result of a fit to readings: coefficients with intervals, predictions, tables, pictures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import CylinderPair
from cylcontact.datasets.measurements import MeasuredData, Measurements, measurements_of
from cylcontact.files.spec import parse_spec
from cylcontact.files.units import column_named, load_in_N_per_mm
from cylcontact.fitting.adapters import without_rig
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.findings import stated_in
from cylcontact.fitting.law_models import user_model, with_rig
from cylcontact.fitting.readings import Optimum, plain_fit
from cylcontact.fitting.records import Estimate, FittedDeviations, RunRecord
from cylcontact.fitting.results import FitResult, basins
from cylcontact.laws.law import ContactLaw
from cylcontact.support.arrays import FloatArray, as_floats
from cylcontact.support.errors import InputError
from cylcontact.support.plain_text import brief
from cylcontact.support.text_tables import TextTable

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from cylcontact.fitting.plan import Plan
    from cylcontact.plots.figure import Drawing

# Columns of a table, by name.
Columns = dict[str, Any]
# The headings of the effects of series, with their factor from mm or a share.
_EFFECTS = {"offset": ("offset, µm", 1e3), "gain": ("gain, %", 100.0), "drift": ("drift, µm", 1e3)}


class DataFit(FitResult):
    """A law fitted to readings, with the uncertainty of its coefficients; from `cylcontact.fit`.

    `print(result)` gives the report, and a notebook shows it with its picture.
    """

    kind: Literal["readings"] = "readings"
    runs: list[RunRecord]
    level: float
    # Readings less parameters and fixed effects.
    degrees_of_freedom: int
    # Whether the data follow the law to round-off.
    is_rounding: bool
    # The probability of residuals this large where their size is known.
    chi_square_p: float | None
    # Of the searched coefficients; empty if they have no covariance.
    correlation: list[list[float]]
    # The lines of outliers.
    outliers: list[int | str]
    noise: FittedDeviations
    log_likelihood: float | None
    # The number of free parameters, deviations of the noise and fixed effects.
    estimated: int
    # Share of the variance of the readings that the law describes; with series, within them.
    r_squared: float | None

    round_off: ClassVar[float] = 1e-12

    # --- the fit itself -----------------------------------------------------------------------

    @cached_property
    def optimum(self) -> Optimum:
        """The fit at its best parameters, with its residuals and their derivatives.

        Raises
        ------
        InputError
            If it was read from a file and its law is your own function: call `with_law` first.
        """
        return self._optimum(None)

    def with_law(self, law: str) -> Self:
        """Attach your own function again after loading a result.

        The current folder is searched first.

        Raises
        ------
        InputError
            If that is not its law.
        """
        if law != self.law:
            rule = f"is not the law of this fit, {self.law}"
            remedy = "leave --law out, or name that one"
            raise InputError(f"fit result {self.name!r}", "law", law, rule, remedy)
        return self.with_optimum(self._optimum(law))

    def with_optimum(self, optimum: Optimum) -> Self:
        """Return the result with the fit that it came from attached."""
        self.__dict__["optimum"] = optimum
        return self

    def __getstate__(self) -> dict[Any, Any]:
        # The fit holds functions, and is made again where it is needed.
        state = super().__getstate__()
        fields = {k: v for k, v in state["__dict__"].items() if k != "optimum"}
        return {**state, "__dict__": fields}

    def _optimum(self, law: str | None) -> Optimum:
        source = f"fit result {self.name!r}"
        campaign = Campaign.of_settings(self.name, self.settings, source)
        if law is not None:
            model = user_model(law, self.contact, source, Path.cwd())
            campaign = replace(campaign, model=with_rig(model, campaign.spec.named))
        fit = plain_fit(campaign)
        point = fit.point(self.coefficients)
        if self.is_rounding:
            fit = replace(fit, noise=fit.noise.at(self.noise.deviations))
        elif campaign.noise is not None and fit.law(point) is not None:
            fit = fit.with_noise(campaign.noise, point, self.noise.deviations)
        if not np.isfinite(fit.value_of(self.coefficients)):
            rule = "leave the law undefined for some of the data"
            raise InputError(source, "coefficients", self.coefficients, rule, "redo the fit")
        return Optimum(fit, point)

    @cached_property
    def data(self) -> Measurements:
        """The measurements; `data.read` says what was read of the table."""
        where = f"fit result {self.name!r}, settings.measurements"
        settings = self.settings["measurements"]
        return measurements_of(parse_spec(MeasuredData, settings, where), where)

    def _level(self, level: float | None) -> float:
        """Return a level that was asked for, or that of the fit."""
        level = self.level if level is None else level
        if not 0 < level < 1:
            rule, remedy = "must lie between 0 and 1", "0.95 is common"
            raise InputError(f"fit result {self.name!r}", "level", level, rule, remedy)
        return level

    @property
    def correlations(self) -> pd.DataFrame:
        """Correlations of the searched coefficients."""
        import pandas as pd

        return pd.DataFrame(self.correlation, [*self.free], [*self.free], float)

    @property
    def aic(self) -> float:
        """Akaike's information criterion, 2k − 2·ln L, k with the deviations of the noise."""
        return 2 * self.estimated - 2 * self._log_likelihood

    @property
    def bic(self) -> float:
        """The Bayesian information criterion, k·ln N − 2·ln L."""
        return float(self.estimated * np.log(self.counts.samples) - 2 * self._log_likelihood)

    @property
    def _log_likelihood(self) -> float:
        if self.log_likelihood is None:
            rule = "is missing: the data follow the law exactly"
            source = f"fit result {self.name!r}"
            raise InputError(source, "log_likelihood", None, rule, "fit data with noise")
        return self.log_likelihood

    def log_posterior(self, values: Mapping[str, float]) -> float:
        """Return ln L of the readings plus what is known of the parameters, for a sampler.

        The noise has the deviations that the fit found. Bounds are flat priors.

        Parameters
        ----------
        values : mapping of str to float
            The searched coefficients by name; those not given have their fitted values.

        Returns
        -------
        float
            -inf outside the bounds or the law's domain.

        Examples
        --------
        It is largest at the fit, except for coefficients at a bound:

        >>> import pandas as pd
        >>> import cylcontact as cc
        >>> steel = cc.Material("steel", E="207 GPa", nu=0.3)
        >>> pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.97, material=steel, length=20.0)
        >>> load, noise = np.geomspace(10.0, 1000.0, 12), 1 + 0.01 * np.cos(np.arange(12))
        >>> depth = cc.laws.Explicit().penetration(load, pair) * noise
        >>> data = pd.DataFrame({"load_N": load * 20.0, "penetration_um": 1e3 * depth})
        >>> result = cc.fit(data, "explicit", pair)
        >>> result.log_posterior({}) > result.log_posterior({"stiffness_factor": 1.02})
        True
        """
        fit = self.optimum.fit
        unknown = [name for name in values if name not in fit.names]
        if unknown:
            rule, remedy = "was not searched", f"give {', '.join(fit.names)}"
            raise InputError(f"fit result {self.name!r}", "values", unknown[0], rule, remedy)
        point = np.array([float(values.get(name, self.optimum.best[name])) for name in fit.names])
        if (point < fit.low).any() or (point > fit.high).any():
            return -np.inf
        squares = len(fit.data) * fit.value(point) ** 2
        size = len(fit.data) * np.log(2 * np.pi) + fit.noise.log_det
        return float(-0.5 * (squares + size)) if np.isfinite(squares) else -np.inf

    # --- tables -------------------------------------------------------------------------------

    @property
    def residuals(self) -> pd.DataFrame:
        """The data beside the fit, a row for each measurement.

        Columns line, the labels of the table, load_N_per_mm, penetration_mm, fitted_mm, residual_mm
        (measured less fitted), standardised (in standard deviations), and with series series_mm,
        what the series adds to the law.
        """
        import pandas as pd

        return pd.DataFrame(self.residual_columns())

    def residual_columns(self) -> Columns:
        """Return the columns of `residuals`, for a command that starts without pandas."""
        optimum = self.optimum
        fit, data = optimum.fit, optimum.fit.data
        labels = {
            name: [words[int(row) % len(words)] for row in data.rows]
            for name, words in data.data.labels.items()
        }
        series = optimum.series_in_mm
        return {
            "line": [data.line(k) for k in range(len(data))],
            **labels,
            "load_N_per_mm": data.load,
            "penetration_mm": data.penetration,
            "fitted_mm": fit.observed + optimum.differences,
            "residual_mm": -optimum.differences,
            "standardised": -optimum.r,
            **({} if series is None else {"series_mm": series}),
        }

    def predict(
        self,
        load: ArrayLike | str | Sequence[str],
        level: float | None = None,
        pair: CylinderPair | None = None,
    ) -> pd.DataFrame:
        """Return what the fitted law predicts for readings, with bands.

        Parameters
        ----------
        load : array_like, str or sequence of str
            Loads in N/mm, or with their unit, such as "4500 N".
        level : float, optional
            Of the bands, between 0 and 1; by default that of the fit.
        pair : CylinderPair, optional
            Any pair of the same contact; by default those of the data.

        Returns
        -------
        pandas.DataFrame
            Columns load_N_per_mm, penetration_mm, low_mm and high_mm (band of a new reading),
            curve_low_mm and curve_high_mm (band of the curve), and beyond (whether the load is
            beyond the readings). Where the table has other units, the load, the penetration and
            the band of a new reading in these as well. Where the data have several pairs and none
            is given, rows for each, named in the column pair.

        Raises
        ------
        InputError
            If the coefficients have no covariance, or the law is undefined at a load.
        """
        import pandas as pd

        return pd.DataFrame(self.predicted_columns(load, level, pair))

    def predicted_columns(
        self,
        load: ArrayLike | str | Sequence[str],
        level: float | None = None,
        pair: CylinderPair | None = None,
    ) -> Columns:
        """Return the columns of `predict`, for a command that starts without pandas."""
        level, data = self._level(level), self.optimum.fit.data
        if pair is not None and pair.contact != self.contact:
            rule, remedy = f"is not {self.contact}, as the fit is", "give a pair of its contact"
            raise InputError("prediction", "pair.contact", pair.contact, rule, remedy)
        if pair is not None:
            return self._predicted(load, level, pair)
        names, groups = data.groups("pair")
        pairs = [_pair_of(data.take(np.flatnonzero(groups == k))) for k in range(len(names))]
        tables = [self._predicted(load, level, each) for each in pairs]
        if len(names) == 1:
            return tables[0]
        columns = {key: np.concatenate([table[key] for table in tables]) for key in tables[0]}
        return {**columns, "pair": np.repeat(names, len(columns["beyond"]) // len(names)).tolist()}

    def _predicted(self, load: Any, level: float, pair: CylinderPair) -> Columns:
        loads, data = self._loads(load, pair.length, "load"), self.optimum.fit.data
        if not (loads > 0).all():
            rule, remedy = "must be above zero", "give a load at which the surfaces touch"
            raise InputError("prediction", "load in N/mm", float(loads.min()), rule, remedy)
        ends = self.optimum.band(pair, level, load=loads)
        columns: Columns = {
            "load_N_per_mm": loads,
            "penetration_mm": ends.value,
            "low_mm": ends.new_low,
            "high_mm": ends.new_high,
            "curve_low_mm": ends.low,
            "curve_high_mm": ends.high,
            "beyond": (loads < data.load.min()) | (loads > data.load.max()),
        }
        units = data.data.units
        unit = column_named(f"load_{units.get('load', '')}")
        if unit is not None and unit.unit != "N_per_mm" and not (unit.is_total and not pair.length):
            length = pair.length if unit.is_total and pair.length is not None else 1.0
            columns[unit.name] = loads * length / unit.factor
        depth = column_named(f"penetration_{units.get('penetration', '')}")
        if depth is not None and depth.unit != "mm":
            for name in ("penetration", "low", "high"):
                columns[f"{name}_{depth.unit}"] = columns[f"{name}_mm"] / depth.factor
        return columns

    @staticmethod
    def _loads(loads: Any, length: Any, key: str) -> FloatArray:
        """Return loads in N/mm from numbers, or from texts with a unit."""
        given = [loads] if isinstance(loads, str) else loads
        if isinstance(given, Sequence) and any(isinstance(each, str) for each in given):
            of_pair = None if length is None else float(np.ravel(length)[0])
            given = [
                load_in_N_per_mm(each, of_pair) if isinstance(each, str) else each for each in given
            ]
        try:
            return np.atleast_1d(as_floats(given))
        except (TypeError, ValueError, InputError) as error:
            rule, remedy = "must be loads", 'give numbers in N/mm, or texts such as "4500 N"'
            raise InputError("fit result", key, loads, rule, remedy) from error

    def interval(
        self, function: Callable[[ContactLaw], ArrayLike], level: float | None = None
    ) -> pd.DataFrame:
        """Return the interval of any number that follows from the fitted law.

        Parameters
        ----------
        function : callable
            From the law of the contact, without the rig, to a number or to m of them, such as a
            stiffness at a load or the penetration at the peak of a joint.
        level : float, optional
            Of the interval, between 0 and 1; by default that of the fit.

        Returns
        -------
        pandas.DataFrame
            A row for each number: value, standard_error, low and high, by the delta method.

        Raises
        ------
        InputError
            If the coefficients have no covariance.

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
        >>> print(result.interval(lambda law: 1e3 * law.penetration(500.0, pair)).round(3))
           value  standard_error    low   high
        0  4.993           0.016  4.954  5.045
        """
        import pandas as pd

        def of_contact(law: ContactLaw) -> ArrayLike:
            return _numbers_of(function(without_rig(law)))

        value, variance, reach = self.optimum.propagated(of_contact, self._level(level))
        ends = {"low": value - reach[:, 0], "high": value + reach[:, 1]}
        return pd.DataFrame({"value": value, "standard_error": np.sqrt(variance), **ends})

    def plan(
        self,
        candidates: ArrayLike,
        add: int = 5,
        *,
        dR: ArrayLike | None = None,
        parameter: str | None = None,
        level: float | None = None,
    ) -> Plan:
        """Return which further readings would narrow the intervals most.

        Parameters
        ----------
        candidates : array_like, str or sequence of str
            Loads at which readings can be taken, in N/mm, or with their unit, such as "4500 N".
        add : int
            How many readings are to be added, as one new series.
        dR : array_like, optional
            Clearances in mm at which they can be taken; by default that of the first reading.
        parameter : str, optional
            The parameter whose interval counts; by default all together.
        level : float, optional
            Of the intervals, between 0 and 1; by default that of the fit.

        Raises
        ------
        InputError
            If the coefficients have no covariance, or the law is undefined at a candidate.

        Examples
        --------
        A modulus is known best from readings at large loads:

        >>> import pandas as pd
        >>> import cylcontact as cc
        >>> steel = cc.Material("steel", E="207 GPa", nu=0.3)
        >>> pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.97, material=steel, length=20.0)
        >>> load, noise = np.geomspace(10.0, 200.0, 9), 0.01 * np.cos(np.arange(9))
        >>> depth = 1e3 * cc.laws.Explicit().penetration(load, pair) + noise
        >>> data = pd.DataFrame({"load_N": load * 20.0, "penetration_um": depth})
        >>> result = cc.fit(data, "explicit", pair, noise="constant")
        >>> result.plan([10.0, 50.0, 200.0], add=2, parameter="stiffness_factor").readings
           load_N_per_mm  dR_mm  number
        0          200.0   0.03       2
        """
        from cylcontact.fitting.plan import plan

        loads = self._loads(candidates, self.optimum.fit.data.pair.length, "candidates")
        clearances = None if dR is None else np.atleast_1d(as_floats(dR))
        return plan(self.optimum, loads, clearances, add, parameter, self._level(level))

    # --- pictures -----------------------------------------------------------------------------

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the data, the fitted law and the band of a new reading; return the axes.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw into; by default a new figure.
        """
        from cylcontact.fitting import pictures

        return pictures.plot(self.optimum, self.law, self.level, ax)

    def plot_residuals(self, ax: Axes | None = None) -> Axes:
        """Draw the residuals against the load; `ax` as for `plot`."""
        from cylcontact.fitting import pictures

        standardised = self.residual_columns()["standardised"]
        return pictures.plot_residuals(self.optimum.fit.data, standardised, self.outliers, ax)

    def _profile(self, name: str) -> tuple[Sequence[float], Sequence[float], float, str]:
        e = self.estimates[name]
        assert e.low is not None
        assert e.high is not None
        values, root, limit = self.optimum.profile(name, e.low, e.high, self.level)
        return values.tolist(), root.tolist(), limit, "rise of the objective (std. dev.)"

    def drawing(self) -> Drawing:
        """Return a figure of the data with the law and its band, the residuals beneath.

        Its table is that of the residuals.
        """
        from cylcontact.plots.figure import Drawing

        values = ", ".join(f"{name} = {value:.4g}" for name, value in self.free.items())
        caption = (
            f"{brief(self.name)}: {self.counts.samples} measurements, the {brief(self.law)} law "
            f"fitted to them ({values}), and the band of {100 * self.level:g} % of new readings; "
            "below, measured less fitted in standard deviations."
        )
        return Drawing(self.figure(), self.residuals, caption)

    def figure(self) -> Figure:
        """Return the figure of `drawing` alone."""
        from cylcontact.fitting import pictures

        return pictures.two_panels(96.0, 2.4, self.plot, self.plot_residuals)

    def _repr_html_(self) -> str:
        from cylcontact.plots.style import figure_style

        try:
            with figure_style():
                return super()._repr_html_() + self.drawing()._repr_html_()
        except InputError:  # the result was read from a file, and the law is a user's own
            return super()._repr_html_()

    # --- in words -----------------------------------------------------------------------------

    @property
    def _interval_heading(self) -> str:  # type: ignore[override]
        return f"{100 * self.level:g} % profile interval"

    def _in_its_unit(self, estimate: Estimate) -> Estimate:
        """Return a coefficient; one in mm is stated in the unit of the readings."""
        size, unit = stated_in(self.data, estimate.unit)
        if unit == estimate.unit:
            return estimate
        numbers = ("value", "low", "high", "standard_error")
        scaled = {key: getattr(estimate, key) for key in numbers}
        scaled = {k: None if v is None else v / size for k, v in scaled.items()}
        return estimate.model_copy(update={**scaled, "unit": unit})

    @property
    def read_lines(self) -> list[str]:
        """Lines that say what was read of the table."""
        return self.data.read

    @property
    def status(self) -> str:
        """One line: starts that agree, coefficients at a bound or ill determined."""
        verdicts = Counter(estimate.verdict for estimate in self.estimates.values())
        parts = [
            f"{basins(self.runs, self.round_off)[0][1]} of {len(self.runs)} starts agree",
            f"{verdicts['at a bound'] or 'none'} at a bound",
            f"{verdicts['poorly'] + verdicts['not'] or 'none'} ill determined",
        ]
        parts += [] if self.r_squared is None else [f"R² = {self.r_squared:.5f}"]
        if self.log_likelihood is not None:
            parts.append(f"AIC = {self.aic:.1f}, BIC = {self.bic:.1f}")
        return " · ".join(parts)

    def __str__(self) -> str:
        series = self.noise.series
        if len(series) < 2:
            return super().__str__()
        names = list(series[0].effects)
        rows = []
        for each in series:
            effects = (f"{_EFFECTS[name][1] * each.effects[name]:.3g}" for name in names)
            rows.append((each.name, str(each.rows), *effects))
        table = TextTable(("series", "readings", *(_EFFECTS[name][0] for name in names)), rows)
        return f"{super().__str__()}\n\n{table}"


def _numbers_of(answer: object) -> FloatArray:
    """Return what a user's function gives, a number or m of them."""
    try:
        numbers = np.atleast_1d(np.asarray(answer, dtype=np.float64))
    except (TypeError, ValueError):
        numbers = np.empty((0, 0))
    if numbers.ndim != 1 or not numbers.size:
        kind = f"an array of shape {np.shape(answer)}" if isinstance(answer, np.ndarray) else answer
        rule, remedy = (
            "is not a number or a row of numbers",
            "return one number, or several in a row",
        )
        raise InputError("interval", "function", kind, rule, remedy)
    return numbers


def _pair_of(data: Measurements) -> CylinderPair:
    """Return the pair of rows of one pair, without a length if they have several."""
    pair, lengths = data.take(np.array([0])).pair, data.columns.get("length")
    return pair if lengths is None or np.ptp(lengths) == 0 else replace(pair, length=None)
