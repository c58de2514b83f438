"""The likelihood of a fit to measurements, for information criteria."""

from __future__ import annotations

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.fitting.measured_objective import MeasuredObjective, measured
from cylcontact.fitting.noise_fit import likelihood_at
from cylcontact.fitting.problem import Problem

__all__ = ["log_likelihood", "number_estimated"]


def log_likelihood(problem: Problem, point: FloatArray) -> float | None:
    """Return ln L of the readings at the optimum; None with a robust loss.

    The readings are penetrations in mm, or loads in N/mm, whatever the residuals, so that fits with
    different noise can be compared. A standard deviation that is estimated has its value of
    largest likelihood, √(Σr²/N).

    Parameters
    ----------
    problem : Problem
        On measurements.
    point : array of float, shape (k,)
        Its optimum.
    """
    objective = measured(problem)
    if not objective.loss.is_linear:
        return None
    if objective.noise is not None:
        return likelihood_at(problem, point).log_likelihood(objective.noise.deviations)
    return _plain(objective, objective.raw(problem.form(point[None, :]))[0])


def number_estimated(problem: Problem) -> int:
    """Return the number of free parameters, deviations of the noise and fixed effects."""
    objective = measured(problem)
    if objective.noise is not None:
        covariance = objective.noise.covariance
        return len(problem.free) + len(covariance.names) + int(covariance.fixed.shape[1])
    return len(problem.free) + (0 if objective.has_sigma else 1)


def _plain(objective: MeasuredObjective, r: FloatArray) -> float | None:
    """Return ln L of residuals with weights and given deviations."""
    # From the residual to the reading: |dr/dy| = √w/y for logarithms, else √w/σ.
    size = np.abs(objective.observed) if objective.is_log else objective.sigma
    scale = float((0.5 * np.log(objective.data.weight) - np.log(size)).sum())
    variance = 1.0 if objective.has_sigma else float((r**2).mean())
    if variance == 0:
        return None
    fit = -0.5 * (r.size * np.log(2 * np.pi * variance) + float((r**2).sum()) / variance)
    return float(fit + scale)
