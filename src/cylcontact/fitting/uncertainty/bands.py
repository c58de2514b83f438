"""Confidence bands of a fitted curve and prediction bands of a new measurement.

The delta method is used in ln f, and in ln δ if the noise is proportional, since contact laws are
nearly linear there; in δ otherwise, where readings may be negative. The variance of the curve is
gᵀCg with g the derivatives by the free parameters and C their covariance. A new measurement adds
the noise, with random effects that of a series not yet measured. Noise of a penetration becomes
noise of the load, and vice versa, through the local exponent n = d ln f/d ln δ.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.errors import InputError
from cylcontact.fitting.least_squares import jacobian
from cylcontact.fitting.measured_objective import MeasuredObjective, laws_of, measured
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.uncertainty.residual_model import ResidualModel
from cylcontact.laws.law import ContactLaw
from cylcontact.pair import CylinderPair
from cylcontact.spec import Spec

__all__ = ["Band", "bands_of_data", "predict"]

# Points of each band, and the largest number of pairs.
_POINTS = 25
_PAIRS = 8
# In place of a predicted reading of 0 mm, to which an error is relative.
_NO_DEPTH = 1e-12


class Band(Spec):
    """A predicted curve with its bands."""

    name: str = Field(description="the pair it is for")
    quantity: str = Field(description='"penetration_mm" or "load_N_per_mm"')
    at: list[float] = Field(description="loads in N/mm, or penetrations in mm")
    value: list[float] = Field(description="the prediction")
    low: list[float] = Field(description="lower end for the curve")
    high: list[float] = Field(description="upper end for the curve")
    new_low: list[float] = Field(description="lower end for a new measurement")
    new_high: list[float] = Field(description="upper end for a new measurement")


def predict(
    problem: Problem,
    noise: ResidualModel,
    best: Mapping[str, float],
    pair: CylinderPair,
    level: float,
    *,
    load: ArrayLike | None = None,
    penetration: ArrayLike | None = None,
    name: str = "",
) -> Band:
    """Return the prediction for a pair, with bands.

    Parameters
    ----------
    problem : Problem
        On measurements.
    noise : ResidualModel
        At its optimum.
    best : mapping
        The coefficients there.
    pair : CylinderPair
        Any pair of the contact fitted.
    level : float
        E.g. 0.95.
    load : array_like, optional
        Loads in N/mm at which to predict the penetration.
    penetration : array_like, optional
        Penetrations in mm at which to predict the load; exactly one of the two is given.
    name : str, optional
        The pair's name.

    Returns
    -------
    Band

    Raises
    ------
    InputError
        If the parameters have no covariance, or the law is undefined at one of the points.
    """
    if noise.covariance is None:
        raise InputError(
            "prediction",
            "parameters",
            noise.blind or list(best),
            "are not identifiable one by one, so that there is no band",
            "fix one of them with fixed = true, or choose a wider loss, and fit again",
        )
    of_load, objective = penetration is not None, measured(problem)
    at = np.atleast_1d(as_floats(penetration if of_load else load))
    is_log = of_load or objective.is_log

    def predictions(points: FloatArray) -> FloatArray:
        laws = laws_of(problem.form(points))
        return np.array([_prediction(law, at, pair, of_load, is_log) for law in laws])

    point = problem.point(best)
    centre = predictions(point[None, :])[0]
    slopes = jacobian(problem, point, predictions)
    (law,) = laws_of(problem.form(point[None, :]))
    if law is None or not np.isfinite(centre).all():
        raise InputError(
            "prediction",
            "penetration" if of_load else "load",
            at,
            "leaves the domain of the fitted law, or is not positive",
            "stay within it",
        )
    variance = ((slopes @ noise.covariance) * slopes).sum(axis=1)
    depth = at if of_load else law.penetration(at, pair)
    depth = as_floats(np.where(depth == 0, _NO_DEPTH, depth))
    force = law.load(at, pair) if of_load else at
    added = _noise_variance(objective, noise, law, best, (depth, force, pair), of_load)
    if not is_log:
        added = as_floats(added * depth**2)
    reach = noise.half_width(level, noise.degrees_of(slopes))
    spread, wider = reach * np.sqrt(variance), reach * np.sqrt(variance + added)
    ends = (centre, centre - spread, centre + spread, centre - wider, centre + wider)
    curves = (np.exp(end) if is_log else end for end in ends)
    value, low, high, new_low, new_high = ([float(v) for v in curve] for curve in curves)
    return Band(
        name=name,
        quantity="load_N_per_mm" if of_load else "penetration_mm",
        at=[float(v) for v in at],
        value=value,
        low=low,
        high=high,
        new_low=new_low,
        new_high=new_high,
    )


def bands_of_data(
    problem: Problem, noise: ResidualModel, best: Mapping[str, float], level: float
) -> list[Band]:
    """Return bands of both quantities for the pairs in the data, over the range of each.

    At most 8 pairs, in the order of the table. There are none if the parameters have no
    covariance, and none where the fitted law is undefined.
    """
    if noise.covariance is None:
        return []
    data = measured(problem).data
    names, group = data.groups("pair")
    bands = []
    for number, name in enumerate(names[:_PAIRS]):
        rows = np.flatnonzero(group == number)
        part = data.take(rows)
        pair = data.take(np.full(_POINTS, rows[0])).pair
        loads = np.geomspace(part.load.min(), part.load.max(), _POINTS)
        # Of readings about zero only those beyond the first touch have a load.
        touching = part.penetration[part.penetration > max(best.get("offset", 0.0), 0.0)]
        every = [{"load": loads}]
        if touching.size:
            every.append({"penetration": np.geomspace(touching.min(), touching.max(), _POINTS)})
        for points in every:
            with suppress(InputError):  # a fitted law may end before the data do
                bands.append(predict(problem, noise, best, pair, level, name=name, **points))
    return bands


def _prediction(
    law: ContactLaw | None, at: FloatArray, pair: CylinderPair, of_load: bool, is_log: bool
) -> FloatArray:
    """Return f or δ of a law, or its logarithm; NaN outside its domain."""
    if law is None:
        return np.full_like(at, np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        value = law.load(at, pair) if of_load else law.penetration(at, pair)
        return as_floats(np.log(value)) if is_log else value


def _noise_variance(
    objective: MeasuredObjective,
    noise: ResidualModel,
    law: ContactLaw,
    best: Mapping[str, float],
    at: tuple[FloatArray, FloatArray, CylinderPair],
    of_load: bool,
) -> FloatArray:
    """Return the variance of a new measurement relative to f or δ.

    With given standard deviations, a new measurement has their median, or with a noise model that
    of the loads measured.
    """
    depth, force, pair = at
    sigma = 1.0 if noise.known else noise.sigma
    size = np.full_like(force, sigma)
    if objective.noise is not None:
        of_contact = as_floats(depth - best.get("offset", 0.0))
        size = np.sqrt(objective.noise.new_variance(of_contact, force)) / depth
    elif not objective.is_log:
        size = sigma * float(np.median(objective.sigma)) / (force if objective.of_load else depth)
    if objective.of_load != of_load:
        exponent = law.stiffness(depth, pair) * depth / force
        size = size * exponent if of_load else size / exponent
    return as_floats(size**2)
