"""Every choice that the paper leaves open in its fit, combined, and what comes of it.

`datasets/choices.toml` has the choices, with the sentences of the paper that leave them open.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from cylcontact.datasets.grid import AxisSpec
from cylcontact.files.spec import parse_spec, read_toml
from cylcontact.fitting.cases import FACTORS, LINES, routes
from cylcontact.fitting.nodes import DEVIATIONS, Axes, fit_many
from cylcontact.laws import PUBLISHED
from cylcontact.plots.figure import legend_below, panel_title, panels
from cylcontact.support.arrays import FloatArray
from cylcontact.support.parallel import Workers, call, collect
from cylcontact.support.progress import Progress, silent

CHOICES = Path("datasets/choices.toml")
AXES = ("E", "nu", "dR", "range", "load", "points")
DIGITS = {  # after the point, as printed
    "internal": dict(zip(vars(PUBLISHED["internal"]), (3, 4, 2, 3, 4, 3, 3), strict=False)),
    "external": dict(zip(vars(PUBLISHED["external"]), (2, 2, 3), strict=True)),
}
# The grids of a call: enough to share the work of Python, few enough to share among cores.
_AT_ONCE = 27


def levels(table: Mapping[str, Any], contact: str, drawn: bool) -> dict[str, Any]:
    """Return the levels of a choice by name, or those of the figure."""
    of_contact = table.get("levels", table.get(contact))
    named = of_contact if isinstance(of_contact, dict) else {each: each for each in of_contact}
    wanted = table.get("drawn", named) if drawn else named
    return {name: level for name, level in named.items() if name in wanted}


def axis(level: Mapping[str, Any], points: int, ends: tuple[float, float] = (0, 0)) -> FloatArray:
    """Return the values of an axis, with the number of points and the ends that it may lack."""
    if "decades" in level:
        values = np.outer(10.0 ** np.arange(-4, 4), level["decades"]).ravel()
        return values[(values > ends[0] * 0.999) & (values < ends[1] * 1.001)]
    given = dict(level)
    if "values" not in level:
        given = {"points": points, "min": ends[0], "max": ends[1], **level}
    return parse_spec(AxisSpec, given, str(CHOICES)).numbers()


def grids(
    choices: Mapping[str, Any], contact: str, drawn: bool = False
) -> Iterator[tuple[dict[str, Any], Axes]]:
    """Yield the different grids with their choices."""
    seen = set()
    crossed = [levels(choices[name], contact, drawn) for name in AXES]
    for combination in product(*(each.items() for each in crossed)):
        names, (E, nu, dR, ends, load, points) = zip(*combination, strict=True)
        moduli = 1e3 * axis(E, points)[:, None]
        E_star = (moduli / (2 * (1 - axis(nu, points) ** 2))).ravel()
        grid = Axes(E_star, axis(dR, points, tuple(ends)), axis(load, points))
        key = tuple(each.tobytes() for each in grid)
        if key not in seen:  # some do not depend on the number of points
            seen.add(key)
            yield dict(zip(AXES, names, strict=True)), grid


def study(drawn: bool = False, workers: Workers = 1, progress: Progress = silent) -> pd.DataFrame:
    """Fit the law under every combination of choices, or those of the figure.

    Parameters
    ----------
    drawn : bool, optional
        Whether to take the levels of the figure only.
    workers : int or Cluster, optional
        Processes, or a Dask cluster; the result does not depend on it.
    progress : callable, optional
        Called with how many parts are done.

    Returns
    -------
    pandas.DataFrame
        A row for each fit: contact, way, choices and coefficients.
    """
    choices = read_toml(CHOICES)
    calls, about = [], []
    for contact in ("external", "internal"):
        both = list(grids(choices, contact, drawn))
        both.sort(key=lambda each: each[1].dR.size)  # alike in a call
        below = [sum(grid.dR < PUBLISHED["internal"].Y_switch) for _, grid in both]
        searched = levels(choices["searched"], contact, drawn)
        all_free = {name: each for name, each in searched.items() if not each}
        objectives = list(levels(choices["objective"], contact, drawn))
        given = levels(choices["given"], contact, drawn)
        ends = list(levels(choices["end"], contact, drawn))
        for first in range(0, len(both), _AT_ONCE):
            chosen, part = zip(*both[first : first + _AT_ONCE], strict=True)
            tied = {name: each for name, each in searched.items() if each}
            # Fewer than two clearances below the switch do not determine its branch.
            enough = [k for k in range(len(part)) if contact == "external" or below[first + k] >= 2]
            some = [part[k] for k in enough]
            calls += [
                call(fit_many, contact, part, tied, objectives),
                call(routes, contact, part, given, ends),
            ]
            about += [(contact, chosen), (contact, chosen)]
            if some:
                calls.append(call(fit_many, contact, some, all_free, objectives))
                about.append((contact, [chosen[k] for k in enough]))
    rows = []
    for (contact, chosen), found in zip(
        about, collect(calls, workers, progress, "fitting"), strict=True
    ):
        if isinstance(found, list):
            rows += [{"contact": contact, **chosen[each.pop("grid")], **each} for each in found]
            continue
        names = list(vars(PUBLISHED[contact]))
        for (way, objective), (coefficients, _) in found.items():
            rows += [
                {"contact": contact, **one, "way": way, "objective": objective}
                | dict(zip(names, each, strict=True))
                for one, each in zip(chosen, coefficients.tolist(), strict=True)
            ]
    table = pd.DataFrame(rows).drop(columns="Y_switch")
    first = ["contact", "way", *AXES, "objective", "given", "factor", "line", "end"]
    return table[[*first, *(name for name in table if name not in first)]]
