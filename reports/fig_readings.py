"""How firmly the coefficients come back: each recovered again on some fifty other samplings.

The paper states ranges, but no points, spacing or objective. Each reading changes one of these, or
two, and the search is repeated with the same coefficients held and tied.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, NullFormatter, NullLocator

from cylcontact.arrays import FloatArray
from cylcontact.fitting.calibrate import problem_of
from cylcontact.fitting.campaign import campaign_from_settings
from cylcontact.fitting.objectives import ON_ROWS
from cylcontact.fitting.parameters import Parameter
from cylcontact.fitting.polish import polish, polish_across_kinks
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.result import FitResult
from cylcontact.pair import CONTACTS, Contact
from cylcontact.plots.figure import Drawing, StyledFigure, new_figure, panel_title
from cylcontact.plots.style import COLOURS, MARKERS, QUIET
from cylcontact.progress import silent
from cylcontact.reports.bench import Bench

CAPTION = (
    "Recovered coefficients against the published ones under {count} readings of how they were "
    "fitted; the readings are ours. Left: the points on every axis, the rest as in the campaigns "
    "recovered-internal and recovered-external. Right: one change each. Internal: x1 = a = 10b, "
    "x2 = Y_log_scale. External: a and b with n held; n from a search of all three."
)
POINTS = (8, 10, 12, 15, 18, 20, 21, 22, 25, 30, 40, 50, 60, 80, 100)
NOTHING, POINTS_CHANGED, OTHER_AXES = "nothing", "points per axis", "the other contact's axes"
SPACED, SPACINGS = ("E", "dR", "load"), ("linear", "log")
E_ENDS, LOWER_E_ENDS = (1000.0, 10000.0), (200.0, 600.0)  # GPa
DR_ENDS: Mapping[Contact, tuple[float, ...]] = {
    "internal": (1.0, 2.0, 5.0),
    "external": (100.0, 200.0, 300.0),
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
N_SEARCHED = Parameter("n", low=1.0, high=1.5)
# Points of the lattice from whose best one the search descends, along each free coefficient.
LATTICE = {2: 41, 3: 17}
# What is drawn: the coefficient and its label.
DRAWN: Mapping[Contact, Mapping[str, str]] = {
    "internal": {"a": "$x_1$", "Y_log_scale": "$x_2$"},
    "external": {"a": "$a$", "b": "$b$", "n": "$n$"},
}
# Ends of the axes of differences, in percent.
REFINED, LARGEST = (-8.0, 55.0), 150.0
APART = 0.25


@dataclass(frozen=True)
class Reading:
    """One way to read how the paper fitted its law.

    Attributes
    ----------
    changed : str
        What differs from the recovered campaign.
    label : str
        The value it has.
    settings : dict
        The settings of the campaign.
    """

    changed: str
    label: str
    settings: dict[str, Any]


def draw(bench: Bench) -> Drawing:
    table = readings(bench)
    count = len(table.drop_duplicates(["contact", "changed", "reading"]))
    headline = {"readings": float(count)}
    of_points = np.where(
        table["changed"].isin([NOTHING, POINTS_CHANGED]), "points", "other changes"
    )
    groups = table.groupby(["contact", "coefficient", of_points], sort=False)["difference_percent"]
    for (contact, name, what), differences in groups:
        headline |= {
            f"{contact} {name}, {what}: {end} difference, %": float(value)
            for end, value in (("lowest", differences.min()), ("highest", differences.max()))
        }
    return Drawing(_draw_panels(table), table, headline, CAPTION.format(count=count))


def readings(bench: Bench) -> pd.DataFrame:
    """Recover the coefficients under every reading.

    Parameters
    ----------
    bench : Bench
        With the results recovered-internal and recovered-external.

    Returns
    -------
    pandas.DataFrame
        A row for each reading and coefficient: its value, the difference from the published one in
        percent, and the objective of both.
    """
    results = {contact: bench.result(f"recovered-{contact}") for contact in CONTACTS}
    sampled = {contact: _sampled(result.settings) for contact, result in results.items()}
    rows = []
    for contact, result in results.items():
        (others,) = (sampled[other] for other in CONTACTS if other != contact)
        for reading in _readings(contact, result.settings):
            as_other = _sampled(reading.settings) == others and reading.changed != NOTHING
            changed = OTHER_AXES if as_other else reading.changed
            rows += _rows(contact, replace(reading, changed=changed), result)
    return pd.DataFrame(rows)


def _sampled(settings: dict[str, Any]) -> tuple[Any, ...]:
    """Return the end of E and the spacings, in which the two recovered campaigns differ."""
    axes = settings["dataset"]["axes"]
    points = {axes[axis]["points"] for axis in SPACED}
    return axes["E"]["max"], points, *(axes[axis]["spacing"] for axis in SPACED)


def _readings(contact: Contact, base: dict[str, Any]) -> Iterator[Reading]:
    """Yield the reading of the recovered campaign and those beside it."""
    yield Reading(NOTHING, "the recovered campaign", base)
    for count in POINTS:
        every = {axis: {"points": count} for axis in SPACED}
        yield _changed(base, POINTS_CHANGED, f"{count}", **every)
    yield from _spacings(base)
    for end in LOWER_E_ENDS:
        yield _changed(base, "end of E", f"{end:g} GPa", E={"max": end})
    for end in DR_ENDS[contact]:
        yield _changed(base, "end of ΔR", f"{end:g} mm", dR={"max": end})
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
        what = "spacing" if end == as_is else f"spacing, E to {end:g} GPa"
        reading = _changed(base, what, label, **spaced)
        reading.settings["dataset"]["axes"]["E"]["max"] = end
        if reading.settings != base:
            yield reading


def _changed(base: dict[str, Any], what: str, label: str, **axes: dict[str, Any]) -> Reading:
    """Return a reading with keys of some axes changed."""
    settings = deepcopy(base)
    for axis, keys in axes.items():
        settings["dataset"]["axes"][axis] |= keys
    return Reading(what, label, settings)


def _rows(contact: Contact, reading: Reading, result: FitResult) -> list[dict[str, Any]]:
    """Return the coefficients recovered under one reading, a row for each."""
    published = dict(result.published.coefficients) if result.published else {}
    campaign = campaign_from_settings("reading", reading.settings, "reading")
    problem, _ = problem_of(campaign, 1, silent)
    point, objective = best(problem)
    coefficients = problem.coefficients(point)
    if contact == "external":
        # With n searched as well; a and b stay those with n held.
        with_n = replace(problem, parameters=(*problem.parameters[:2], N_SEARCHED))
        coefficients["n"] = with_n.coefficients(best(with_n)[0])["n"]
    of_reading = {"contact": contact, "changed": reading.changed, "reading": reading.label}
    objectives = {"objective": objective, "objective_published": problem.value_of(published)}
    return [
        of_reading
        | {"coefficient": name, "value": coefficients[name]}
        | {"difference_percent": 100 * (coefficients[name] / published[name] - 1)}
        | objectives
        for name in DRAWN[contact]
    ]


def best(problem: Problem) -> tuple[FloatArray, float]:
    """Return the best point of a problem of few parameters, and its objective.

    Descends from the best point of a lattice over the bounds, so that no search by chance is
    needed: a second way to the coefficients beside the campaigns' genetic search.
    """
    points = len(problem.free)
    unit = np.linspace(0, 1, LATTICE[points])
    lattice = np.stack(np.meshgrid(*[unit] * points), axis=-1).reshape(-1, points)
    lattice = problem.low + lattice * (problem.high - problem.low)
    start = lattice[np.argmin(problem.values(lattice))]
    # Only the internal law has kinks, where the branches of Y meet.
    descend = polish_across_kinks if problem.family.contact == "internal" else polish
    return descend(problem, start)


def _draw_panels(table: pd.DataFrame) -> StyledFigure:
    """Draw refinement to the left, every other change to the right, a row for each contact."""
    figure = new_figure("full", 118.0)
    panels = figure.subplots(2, 2, by_rows=True, gridspec_kw={"width_ratios": [1, 1.35]})
    for row, contact in enumerate(CONTACTS):
        rows = table[table["contact"] == contact]
        refined, others = panels[row]
        _draw_refinement(refined, contact, rows)
        _draw_changes(others, contact, rows)
        panel_title(refined, 2 * row, f"{contact}: points per axis")
        panel_title(others, 2 * row + 1, f"{contact}: other changes")
    return figure


def _draw_refinement(axes: Axes, contact: Contact, rows: pd.DataFrame) -> None:
    """Draw the differences over the number of points per axis."""
    lines = rows[rows["changed"] == POINTS_CHANGED]
    lines = lines.assign(points=lines["reading"].astype(int))
    axes.axhline(0, color=QUIET, linewidth=0.5, marker="")
    for number, (name, label) in enumerate(DRAWN[contact].items()):
        line = lines[lines["coefficient"] == name]
        axes.plot(
            line["points"],
            line["difference_percent"],
            color=COLOURS[number],
            marker=MARKERS[number],
            label=label,
        )
    axes.set(xscale="log", ylim=REFINED)
    axes.xaxis.set_major_locator(FixedLocator([8, 10, 20, 50, 100]))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter("{x:g}")
    axes.set(xlabel="points on each axis", ylabel="difference from the published (%)")
    axes.legend(loc="upper left")


def _draw_changes(axes: Axes, contact: Contact, rows: pd.DataFrame) -> None:
    """Draw the differences of all readings but the refined ones, by what is changed."""
    rows = rows[~rows["changed"].isin([NOTHING, POINTS_CHANGED])]
    changes = [*dict.fromkeys(rows["changed"])]
    changes.append(changes.pop(changes.index(OTHER_AXES)))
    axes.axvline(0, color=QUIET, linewidth=0.5, marker="")
    for number, name in enumerate(DRAWN[contact]):
        offset = APART * (number - (len(DRAWN[contact]) - 1) / 2)
        dots = rows[rows["coefficient"] == name]
        axes.plot(
            dots["difference_percent"],
            [changes.index(change) + offset for change in dots["changed"]],
            color=COLOURS[number],
            marker=MARKERS[number],
            linestyle="none",
        )
    axes.set_xscale("symlog", linthresh=1.0)
    axes.set(xlim=(-LARGEST, LARGEST), ylim=(len(changes) - 0.5, -0.5))
    ticks = [-100, -10, -1, 0, 1, 10, 100]
    labels = [f"{tick:+d}".replace("-", "\N{MINUS SIGN}") if tick else "0" for tick in ticks]
    axes.set_xticks(ticks, labels)
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_yticks(range(len(changes)), changes)
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("difference from the published (%)")
