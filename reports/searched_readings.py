"""The coefficients searched under other assumptions about the paper's fit.

The paper states ranges, but no points, spacing or objective. Each reading changes one of these, or
two. For external contact it is searched twice, with n fixed and with n free.

    make readings

searches all of them, in some fifteen seconds, and writes datasets/readings.csv, which
fig_readings draws.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import asdict, dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from cylcontact.bodies.pair import CONTACTS, Contact
from cylcontact.fitting.calibration import problem_of
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.objectives import ON_ROWS, Problem
from cylcontact.fitting.polish import minimise, polish
from cylcontact.laws import PUBLISHED
from cylcontact.laws.law import Parameter
from cylcontact.reports.bench import Bench
from cylcontact.support.arrays import FloatArray

FILE = "datasets/readings.csv"
COLUMNS = (
    *("contact", "search", "changed", "reading", "coefficient", "value"),
    *("difference_percent", "objective", "objective_published"),
)
BORROWED = "the samples of the other contact"
IF_MISPRINT = "20.7 to 1000 GPa, if 10000 is a misprint"
# The spacing of ΔR and the end of E in GPa of the samples that give the coefficients back.
RECOVERING: Mapping[Contact, tuple[str, int]] = {
    "internal": ("log", 1000),
    "external": ("linear", 10000),
}
POINTS = (8, 10, 12, 15, 18, 20, 21, 22, 25, 30, 40, 50, 60, 80, 100)
POINTS_CHANGED, OTHER_SAMPLES = "points per axis", "samples of the other contact"
SPACED, SPACINGS = ("E", "dR", "load"), ("linear", "log")
E_ENDS, LOWER_E_ENDS = (1000.0, 10000.0), (100.0, 200.0, 400.0, 600.0)  # GPa
DR_ENDS: Mapping[Contact, tuple[float, ...]] = {
    "internal": (1.0, 2.0, 5.0, 7.5),
    "external": (100.0, 200.0, 300.0, 400.0),
}  # mm
LOADS: Mapping[str, dict[str, Any]] = {
    "10 to 1000 N/mm in steps of 10": {"points": 100},
    "1 to 1000 N/mm": {"min": 1.0},
    "10 to 500 N/mm": {"max": 500.0},
}
RATIOS: Mapping[str, list[float]] = {
    "nu = 0.2": [0.2],
    "nu = 0.5": [0.5],
    "nu from 0.1 to 0.5": [0.1, 0.2, 0.3, 0.4, 0.5],
}
# The searches of the coefficients, each with its contact and the numbers it varies.
SEARCHES: Mapping[str, tuple[Contact, tuple[str, ...]]] = {
    "internal": ("internal", ("a", "Y_log_scale")),
    "external, n fixed": ("external", ("a", "b")),
    "external, n free": ("external", ("a", "b", "n")),
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


@dataclass(frozen=True)
class Reading:
    """One way to read how the paper fitted its law."""

    changed: str
    label: str
    settings: dict[str, Any]


def searched_readings(bench: Bench) -> pd.DataFrame:
    """Recover the coefficients under every reading."""
    settings = {c: bench.result(f"recovered-{c}").settings for c in CONTACTS}
    sampled = {contact: _sampled(base) for contact, base in settings.items()}
    rows = []
    for contact, base in settings.items():
        (others,) = (sampled[other] for other in CONTACTS if other != contact)
        for reading in _readings(contact, base):
            as_other = _sampled(reading.settings) == others
            changed = OTHER_SAMPLES if as_other else reading.changed
            rows += _rows(contact, replace(reading, changed=changed))
    return pd.DataFrame(rows)


def _sampled(settings: dict[str, Any]) -> tuple[Any, ...]:
    """Return the end of E and the points and spacings of all axes."""
    axes = [settings["dataset"]["axes"][axis] for axis in SPACED]
    return axes[0]["max"], *((axis["points"], axis["spacing"]) for axis in axes)


def _readings(contact: Contact, base: dict[str, Any]) -> Iterator[Reading]:
    """Yield the readings, among them that of the recovered campaign, with 20 points."""
    for count in POINTS:
        every = {axis: {"points": count} for axis in SPACED}
        yield _changed(base, POINTS_CHANGED, f"{count}", **every)
    yield from _spacings(base)
    for end in LOWER_E_ENDS:
        yield _changed(base, "upper end of E", f"{end:g} GPa", E={"max": end})
    for end in DR_ENDS[contact]:
        yield _changed(base, "upper end of ΔR", f"{end:g} mm", dR={"max": end})
    for label, keys in LOADS.items():
        yield _changed(base, "loads", label, load=keys)
    for label, values in RATIOS.items():
        yield _changed(base, "Poisson's ratio", label, nu={"values": values})
    for objective in ON_ROWS:
        reading = _changed(base, "objective", objective)
        reading.settings["campaign"]["objective"] = objective
        yield reading


def _spacings(base: dict[str, Any]) -> Iterator[Reading]:
    """Yield the readings with every other spacing of the axes and either end of E."""
    as_is = base["dataset"]["axes"]["E"]["max"]
    ends = sorted(E_ENDS, key=lambda end: end != as_is)
    for end, spacings in product(ends, product(SPACINGS, repeat=3)):
        spaced = dict(zip(SPACED, ({"spacing": spacing} for spacing in spacings), strict=True))
        label = ", ".join(f"{axis} {spacings[k]}" for k, axis in enumerate(SPACED))
        label = f"{label}, E to {end:g} GPa"
        what = "spacing" if end == as_is else "spacing, other end of E"
        reading = _changed(base, what, label, **spaced)
        reading.settings["dataset"]["axes"]["E"]["max"] = end
        if reading.settings != base:
            yield reading


def _changed(base: dict[str, Any], what: str, label: str, **axes: dict[str, Any]) -> Reading:
    """Return a reading with keys of some axes changed."""
    return Reading(what, label, with_axes(base, **axes))


def _rows(contact: Contact, reading: Reading) -> list[dict[str, Any]]:
    """Return what each search of a contact gives under one reading, a row for each coefficient."""
    fixed = problem_from(reading.settings)
    free = tuple(N_FREE if p.name == N_FREE.name else p for p in fixed.parameters)
    published = asdict(PUBLISHED[contact])
    objective_published = fixed.value_of(published)
    rows = []
    for search, (of_contact, names) in SEARCHES.items():
        if of_contact == contact:
            problem = replace(fixed, parameters=free) if "n" in names else fixed
            point, objective = best(problem)
            coefficients = problem.coefficients(point)
            rows += [
                {
                    "contact": contact,
                    "search": search,
                    "changed": reading.changed,
                    "reading": reading.label,
                    "coefficient": name,
                    "value": coefficients[name],
                    "difference_percent": 100 * (coefficients[name] / value - 1),
                    "objective": objective,
                    "objective_published": objective_published,
                }
                for name, value in published.items()
                if name in names
            ]
    return rows


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


def readings(bench: Bench) -> pd.DataFrame:
    """Return the table of `searched_readings` as it is committed."""
    return bench.table(FILE, COLUMNS, "make readings writes it")


def on_samples(bench: Bench, search: str) -> dict[str, pd.DataFrame]:
    """Return a search on the samples that give the coefficients back, the first, and on others.

    By what is changed, a row for each coefficient.
    """
    contact, _ = SEARCHES[search]
    dR, end = RECOVERING[contact]
    other_dR, other_end = next(ends for each, ends in RECOVERING.items() if each != contact)
    moduli = IF_MISPRINT if contact == "external" else "20.7 to 10000 GPa"
    labels = {
        "20 points an axis": "20",
        "10 points an axis": "10",
        "30 points an axis": "30",
        "100 points an axis": "100",
        "all axes logarithmic": f"E log, dR log, load log, E to {end} GPa",
        f"E over {moduli}": f"E linear, dR {dR}, load linear, E to {other_end} GPa",
        BORROWED: f"E linear, dR {other_dR}, load linear, E to {other_end} GPa",
    }
    rows = readings(bench)
    rows = rows[rows["search"] == search].set_index("coefficient")
    return {name: rows[rows["reading"] == label] for name, label in labels.items()}


if __name__ == "__main__":
    bench = Bench(Path())
    searched_readings(bench).to_csv(bench.input(FILE), index=False, float_format="%.12g")
