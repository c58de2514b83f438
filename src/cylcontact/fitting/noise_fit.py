"""Fit a law together with the deviations of its noise model.

The two take turns: the parameters by least squares of the residuals in standard deviations, which
the deviations weigh, and the deviations by restricted maximum likelihood of these residuals, until
neither moves. Multiple starts and profiles then go with the deviations as they are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.datasets.measurements import Measurements
from cylcontact.errors import InputError
from cylcontact.fitting.least_squares import descend, jacobian
from cylcontact.fitting.measured_objective import STANDARDISED, laws_of, measured
from cylcontact.fitting.noise_model import FittedNoise, NoiseModel
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.restricted_likelihood import Likelihood, estimate
from cylcontact.fitting.specs import MeasuredSpec
from cylcontact.laws.law import Parameter

__all__ = ["at_best", "fit_noise", "likelihood_at", "noise_of", "with_noise"]

_ROUNDS = 60
# The turns end when the parameters move by less than this share of the residuals.
_SETTLED = 1e-9


def noise_of(
    spec: MeasuredSpec, data: Measurements, parameters: tuple[Parameter, ...], source: str
) -> NoiseModel | None:
    """Return the noise model that a campaign chooses; None for one of the plain objectives.

    Raises
    ------
    InputError
        If its keys contradict each other or the data.
    """
    given = [name for name in ("load", "penetration") if f"{name}_std" in data.columns]
    keys = {"group": spec.group, "drift": spec.drift or None, "load_error": spec.load_error}
    chosen = [key for key, value in keys.items() if value is not None]
    has_offset = any(p.name == "offset" and p.is_free for p in parameters)
    # Scatter in proportion to the penetration is not in proportion to a reading with an offset.
    if spec.noise == "both" or (spec.noise == "proportional" and has_offset):
        chosen.append("noise")
    if not chosen and len(given) < 2:
        return None
    key = chosen[0] if chosen else "load_std"
    if spec.objective not in (None, STANDARDISED):
        rule, remedy = f"conflicts with {key}, which has a likelihood of its own", "keep one"
        raise InputError(source, "objective", spec.objective, rule, remedy)
    if spec.loss != "linear":
        rule, remedy = f"conflicts with {key}, whose noise is Gaussian", "keep one of them"
        raise InputError(source, "loss", spec.loss, rule, remedy)
    if spec.noise is not None and "penetration" in given:
        rule = "conflicts with the column penetration_std, which gives the noise"
        raise InputError(source, "noise", spec.noise, rule, "keep one of them")
    return NoiseModel(
        noise=None if "penetration" in given else spec.noise or "both",
        over="group" if spec.group is not None else None,
        drift=bool(spec.drift),
        load_error=spec.load_error or 0.0,
        has_offset=has_offset,
    )


def with_noise(
    problem: Problem, model: NoiseModel, best: Mapping[str, float], deviations: Mapping[str, float]
) -> Problem:
    """Return a problem with a noise model of these deviations, for a law close to the best."""
    objective = measured(problem)
    law = laws_of(problem.form(problem.point(best)[None, :]))[0]
    if law is None:
        raise TypeError("the law is undefined at the best parameters")
    covariance = model.covariance(objective.data, law, best.get("offset", 0.0))
    noise = FittedNoise(covariance, dict(deviations))
    return replace(problem, objective=replace(objective, noise=noise))


def at_best(problem: Problem, best: Mapping[str, float]) -> Problem:
    """Return a problem on measurements with its noise model, if it has one, for the best law."""
    noise = measured(problem).noise
    if noise is None:
        return problem
    return with_noise(problem, noise.covariance.model, best, noise.deviations)


def likelihood_at(problem: Problem, point: FloatArray) -> Likelihood:
    """Return the likelihood of deviations at a point of a problem with a noise model."""
    objective = measured(problem)
    if objective.noise is None:
        raise TypeError("the problem has no noise model")

    def differences(points: FloatArray) -> FloatArray:
        return objective.differences(problem.form(points))

    return Likelihood(
        objective.noise.covariance,
        differences(point[None, :])[0],
        jacobian(problem, point, differences),
    )


def fit_noise(problem: Problem, model: NoiseModel, start: FloatArray) -> Problem:
    """Return the problem with the deviations of its noise model.

    Parameters
    ----------
    problem : Problem
        Of the objective `STANDARDISED`.
    model : NoiseModel
        Its noise model.
    start : array of float, shape (k,)
        The best parameters by plain least squares.
    """
    point = start
    for _ in range(_ROUNDS):
        at_point = with_noise(problem, model, problem.coefficients(point), {})
        likelihood = likelihood_at(at_point, point)
        _require_rows(likelihood, problem)
        deviations = estimate(likelihood)
        weighed = with_noise(problem, model, problem.coefficients(point), deviations)
        moved = descend(weighed, point)[0]
        step = likelihood.slopes @ (moved - point)
        point = moved
        size = float(np.abs(likelihood.residuals).max())
        if float(np.abs(step).max(initial=0.0)) <= _SETTLED * size:
            break
    return weighed


def _require_rows(likelihood: Likelihood, problem: Problem) -> None:
    """Refuse data with no more rows than parameters and fixed effects."""
    rows, free = likelihood.slopes.shape
    effects = likelihood.covariance.fixed.shape[1]
    if rows <= free + effects:
        raise InputError(
            measured(problem).data.data.source,
            "group",
            f"{rows} rows",
            f"are not more than {free} parameters and {effects} effects of the series",
            "measure more points, or leave group and drift out",
        )
