"""Searches for the coefficients of Eq 6 on other samples, without a population."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.fitting.calibration import problem_of
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.objectives import Problem
from cylcontact.fitting.polish import minimise, polish
from cylcontact.laws import PUBLISHED
from cylcontact.laws.law import Parameter
from cylcontact.pair import CONTACTS, Contact
from cylcontact.reports.bench import Bench

Problems = dict[str, Problem]
BORROWED = "the samples of the other contact"
IF_MISPRINT = "20.7 to 1000 GPa, if 10000 is a misprint"
OTHER_MODULI: Mapping[Contact, str] = {
    "internal": "E over 20.7 to 10000 GPa",
    "external": f"E over {IF_MISPRINT}",
}
N_FREE = Parameter("n", low=1.0, high=1.5)
# Free in a search of all internal coefficients; the campaigns of that kind have narrower bounds.
WIDE = (
    Parameter("a", low=0.1, high=1.5),
    Parameter("b", low=0.0, high=0.5),
    Parameter("Y_log_scale", low=0.1, high=50.0),
    Parameter("Y_log_exponent", low=-3.0, high=1.0),
    Parameter("Y_slope", low=-0.1, high=0.1),
    Parameter("Y_offset", low=0.8, high=1.6),
    Parameter("n_exponent", low=-1.0, high=1.0),
)
# Points of the lattice from which the search descends, along each free coefficient.
LATTICE = {2: 41, 3: 17}


def with_axes(settings: dict[str, Any], **axes: dict[str, Any]) -> dict[str, Any]:
    """Return a campaign's settings with keys of some axes changed."""
    changed = deepcopy(settings)
    for axis, keys in axes.items():
        changed["dataset"]["axes"][axis] |= keys
    return changed


def problem_from(settings: dict[str, Any]) -> Problem:
    """Return the problem of a campaign's settings."""
    return problem_of(Campaign.of_settings("reading", settings, "reading"))[0]


def best(problem: Problem) -> tuple[FloatArray, float]:
    """Return the best point of a problem of few parameters, and its objective.

    Takes the best of a lattice over the bounds at each value of the first parameter, and descends
    from those that are lower than beside them, since there can be several minima: for two or three
    coefficients a second way to the optimum beside the campaigns' genetic search.
    """
    count = len(problem.free)
    unit = np.linspace(0, 1, LATTICE[count])
    lattice = np.stack(np.meshgrid(*[unit] * count, indexing="ij"), axis=-1)
    rows = problem.low + lattice.reshape(unit.size, -1, count) * (problem.high - problem.low)
    values = np.array([problem.values(row) for row in rows])
    beside = np.pad(values.min(axis=1), 1, constant_values=np.inf)
    low = np.flatnonzero(beside[1:-1] <= np.minimum(beside[:-2], beside[2:]))
    # Only the internal law has kinks, where the branches of Y meet.
    descend = minimise if problem.model.contact == "internal" else polish
    ends = [descend(problem, rows[row, values[row].argmin()]) for row in low]
    return min(ends, key=lambda end: end[1])


def other_samples(settings: Mapping[Contact, dict[str, Any]], contact: Contact) -> Problems:
    """Return the search that gives the coefficients back on other samples, by what is changed.

    `settings` are those of the campaigns of both contacts.
    """
    base, axes = settings[contact], ("E", "dR", "load")
    (other,) = (settings[each]["dataset"]["axes"] for each in CONTACTS if each != contact)
    borrowed = {
        axis: {
            key: other[axis][key] for key in (("spacing", "max") if axis == "E" else ("spacing",))
        }
        for axis in axes
    }
    changed: dict[str, dict[str, dict[str, Any]]] = {
        "10 points an axis": {axis: {"points": 10} for axis in axes},
        "30 points an axis": {axis: {"points": 30} for axis in axes},
        "100 points an axis": {axis: {"points": 100} for axis in axes},
        "all axes logarithmic": {axis: {"spacing": "log"} for axis in axes},
        OTHER_MODULI[contact]: {"E": {"max": other["E"]["max"]}},
        BORROWED: borrowed,
    }
    return {name: problem_from(with_axes(base, **keys)) for name, keys in changed.items()}


def all_free(problem: Problem, contact: Contact) -> Problem:
    """Return a problem with every coefficient searched."""
    if contact == "external":
        return replace(problem, parameters=(*problem.parameters[:2], N_FREE))
    return replace(problem, parameters=WIDE)


def searched(problem: Problem, contact: Contact) -> dict[str, float]:
    """Return the coefficients at the best point, found without a genetic search."""
    if len(problem.free) < len(WIDE):
        return problem.coefficients(best(problem)[0])
    start = problem.point(asdict(PUBLISHED[contact]))
    return problem.coefficients(minimise(problem, start)[0])


def searched_exponents(bench: Bench) -> dict[str, float]:
    """Return the n at which a search of a, b and n for external contact ends, by its samples.

    From the campaigns' files, so that no fit has to have been made.
    """
    settings: dict[Contact, dict[str, Any]] = {}
    for each in CONTACTS:
        rule, remedy = "this campaign does not exist", "cylcontact init lays out a bench with it"
        file = bench.required(f"fitting/recovered-{each}.toml", rule, remedy)
        settings[each] = Campaign.read(file).settings
    samples = {"20 points an axis": problem_from(settings["external"])}
    samples |= other_samples(settings, "external")
    return {
        name: searched(all_free(problem, "external"), "external")["n"]
        for name, problem in samples.items()
    }
