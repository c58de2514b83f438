"""Tables of a fit to measurements: its residuals, and predictions with bands."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.measurements import Measurements
from cylcontact.errors import InputError
from cylcontact.fitting.measured_objective import measured
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.uncertainty.bands import Band, predict
from cylcontact.fitting.uncertainty.estimates import series_effects
from cylcontact.fitting.uncertainty.residual_model import residual_model_at
from cylcontact.pair import CylinderPair

__all__ = ["band_table", "pair_of", "prediction_table", "residual_table"]


def residual_table(problem: Problem, best: Mapping[str, float]) -> pd.DataFrame:
    """Return the data beside the fit, a row for each measurement.

    Parameters
    ----------
    problem : Problem
        On measurements.
    best : mapping
        The coefficients at its optimum.

    Returns
    -------
    pandas.DataFrame
        Columns line, the labels of the table, load_N_per_mm, penetration_mm, fitted_mm (or
        fitted_N_per_mm if loads were compared), residual_mm (measured less fitted), standardised
        (in standard deviations), and series_mm (what the series adds to the law, with series).
    """
    objective, point = measured(problem), problem.point(best)
    data, form = objective.data, problem.form(point[None, :])
    noise = residual_model_at(problem, point)
    difference = objective.differences(form)[0]
    unit = "N_per_mm" if objective.of_load else "mm"
    size = 1.0 if noise.known or objective.noise is not None else noise.sigma
    columns: dict[str, object] = {"line": [data.line(k) for k in range(len(data))]}
    for name, words in data.data.labels.items():
        columns[name] = [words[int(row) % len(words)] for row in data.rows]
    columns |= {
        "load_N_per_mm": data.load,
        "penetration_mm": data.penetration,
        f"fitted_{unit}": objective.observed + difference,
        f"residual_{unit}": -difference,
        "standardised": -objective.raw(form)[0] / size if size > 0 else np.zeros(len(data)),
    }
    effects = series_effects(problem, point)
    if effects is not None:
        columns["series_mm"] = effects
    return pd.DataFrame(columns)


def prediction_table(
    problem: Problem,
    best: Mapping[str, float],
    load: ArrayLike,
    level: float,
    pair: CylinderPair | None = None,
) -> pd.DataFrame:
    """Return predicted readings with bands; `FitResult.predict` describes the columns."""
    loads = np.atleast_1d(as_floats(load))
    if not 0 < level < 1:
        rule, remedy = "must lie between 0 and 1", "0.95 is common"
        raise InputError("prediction", "band", level, rule, remedy)
    if pair is None:
        pair = pair_of(measured(problem).data)
    return band_table(problem, best, loads, level, pair)


def band_table(
    problem: Problem, best: Mapping[str, float], load: FloatArray, level: float, pair: CylinderPair
) -> pd.DataFrame:
    """Return predicted readings of a pair with bands."""
    noise = residual_model_at(problem, problem.point(best))
    band: Band = predict(problem, noise, best, pair, level, load=load)
    columns = {
        "load_N_per_mm": load,
        "penetration_mm": band.value,
        "low_mm": band.new_low,
        "high_mm": band.new_high,
        "curve_low_mm": band.low,
        "curve_high_mm": band.high,
    }
    return pd.DataFrame(columns)


def pair_of(data: Measurements) -> CylinderPair:
    """Return the pair of measurements that have only one.

    Raises
    ------
    InputError
        If they have several.
    """
    names, _ = data.groups("pair")
    if len(names) > 1:
        rule = f"is required: the data have {len(names)} pairs"
        raise InputError("prediction", "pair", None, rule, "give a CylinderPair")
    return data.take(np.zeros(1, dtype=np.intp)).pair
