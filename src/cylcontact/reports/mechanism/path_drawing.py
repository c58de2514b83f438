"""Figs 18 and 19 as drawings: the runs of one clearance, their paths, what they come to."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from cylcontact.mechanism import Case, Trajectory
from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.mechanism.disclosure import assumed, horizons, law_ends
from cylcontact.reports.mechanism.paths import path_panels, path_table
from cylcontact.reports.mechanism.runs import CASES, mechanism, simulated

# The first revolution that is drawn, from 0, when those runs that settle have done so.
FIRST = 3
NUMBERS = {
    "contact_fraction": "share of time in contact, -",
    "impacts": "impacts per revolution, -",
    "max_penetration_um": "largest penetration, um",
}
CAPTION = (
    "Journal centre relative to the bearing's, over {drawn} of the crank, at a radial clearance of "
    "{clearance:g} mm, in µm and to scale; by rows the contact law, by columns the coefficient of "
    "restitution c_e (in Lankarani and Nikravesh's factor) and of friction c_f. Grey: flight; "
    "orange: contact; dashed: the clearance circle, which the centre leaves by the penetration. "
    "{share}. {whirls}{horizons} Beyond that a path is one of many, and only its statistics are of "
    "use. Which revolutions the paper draws is not said. {ends} {assumed}"
)


def path_drawing(bench: Bench, clearance: float, revolutions: int) -> Drawing:
    """Draw the journal's paths at one clearance, for all laws, restitutions and frictions.

    Parameters
    ----------
    bench : Bench
        Where the mechanism's spec lies.
    clearance : float
        In mm, one of `runs.CLEARANCES`.
    revolutions : int
        How many are drawn, from `FIRST` on.
    """
    chosen = [case for case in CASES if case.clearance == clearance]
    runs = {case: simulated(bench, case, FIRST + revolutions) for case in chosen}
    paths = {case: path_table(case, run, FIRST) for case, run in runs.items()}
    found = {case: run.statistics(FIRST).mean for case, run in runs.items()}
    headline = {
        f"{case.law}, c_e = {case.restitution:g}, c_f = {case.friction:g}: {text}": mean[column]
        for case, mean in found.items()
        for column, text in NUMBERS.items()
    }
    always = sum(mean["contact_fraction"] == 1.0 for mean in found.values())
    last = FIRST + revolutions
    caption = CAPTION.format(
        drawn=f"revolutions {FIRST + 1} to {last}" if revolutions > 1 else f"revolution {last}",
        clearance=clearance,
        whirls=_whirls(runs, clearance),
        share=f"In {always} of the {len(chosen)} the journal never leaves the bearing",
        horizons=horizons(bench, clearance),
        ends=law_ends(list(runs.values())),
        assumed=assumed(mechanism(bench)),
    )
    table = pd.concat(paths.values(), ignore_index=True)
    return Drawing(path_panels(paths), table, headline, caption)


def _whirls(runs: Mapping[Case, Trajectory], clearance: float) -> str:
    """Return a sentence on the runs that go in deeper than the clearance, or nothing.

    What drives them is read off the runs: how often the journal's centre goes around the bearing's
    per revolution of the crank.
    """
    deep = {
        case: run
        for case, run in runs.items()
        if run.statistics(FIRST).mean["max_penetration_um"] > 1e3 * clearance
    }
    if not deep:
        return ""
    turns = [_turns(run) for run in deep.values()]
    held = sorted({(case.restitution, case.friction) for case in deep})
    named = " and ".join(f"c_e = {c_e:g}, c_f = {c_f:g}" for c_e, c_f in held)
    return (
        f"At {named} the penetration exceeds the clearance in {len(deep)} runs: the journal's "
        f"centre whirls about the bearing's, {min(turns):.2g} to {max(turns):.2g} turns per "
        "revolution of the crank, both senses counted, and its inertia presses it outwards. "
    )


def _turns(run: Trajectory) -> float:
    """Return the turns of the journal's centre about the bearing's per revolution, without sign."""
    rows = run.revolution >= FIRST
    angle = np.unwrap(np.arctan2(*run.eccentricity[rows].T[::-1]))
    return float(np.abs(np.diff(angle)).sum() / (2 * np.pi) / np.ptp(run.revolution[rows]))
