"""Searches for the coefficients of Eq 6 on other samples, without a population."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.fitting.calibration import problem_of
from cylcontact.fitting.campaign import campaign_from_settings
from cylcontact.fitting.polish import polish, polish_across_kinks
from cylcontact.fitting.problem import Problem
from cylcontact.laws.definition import Parameter
from cylcontact.progress import silent

N_FREE = Parameter("n", low=1.0, high=1.5)
# Points of the lattice from whose best one the search descends, along each free coefficient.
LATTICE = {2: 41, 3: 17}


def with_axes(settings: dict[str, Any], **axes: dict[str, Any]) -> dict[str, Any]:
    """Return a campaign's settings with keys of some axes changed."""
    changed = deepcopy(settings)
    for axis, keys in axes.items():
        changed["dataset"]["axes"][axis] |= keys
    return changed


def problem_from(settings: dict[str, Any]) -> Problem:
    """Return the problem of a campaign's settings."""
    return problem_of(campaign_from_settings("reading", settings, "reading"), 1, silent)[0]


def best(problem: Problem) -> tuple[FloatArray, float]:
    """Return the best point of a problem of few parameters, and its objective.

    Descends from the best point of a lattice over the bounds: for two or three coefficients a
    second way to the optimum beside the campaigns' genetic search.
    """
    points = len(problem.free)
    unit = np.linspace(0, 1, LATTICE[points])
    lattice = np.stack(np.meshgrid(*[unit] * points), axis=-1).reshape(-1, points)
    lattice = problem.low + lattice * (problem.high - problem.low)
    start = lattice[np.argmin(problem.values(lattice))]
    # Only the internal law has kinks, where the branches of Y meet.
    descend = polish_across_kinks if problem.model.contact == "internal" else polish
    return descend(problem, start)
