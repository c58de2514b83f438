"""Sections 4.2 to 5: the constraints of the slider-crank, and the three laws in its joint."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import pandas as pd

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import LAWS
from cylcontact.mechanism import Case, Trajectory, mechanism_from, simulate
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, Reading, claim, with_unit

from ..long_runs import SETS, SHORT, SPEC_SET, LongRun
from ..paper import JOINT_CLEARANCES, JOINT_LAWS, LOADS, TABLE_2, WINDOW
from ..slider_crank import SPEC, force_ratio, mechanism
from ..trends import FLOOR

SPHERE, JOHNSON, ENHANCED = JOINT_LAWS
CYLINDERS = JOHNSON, ENHANCED


# The laws' stiffness at equal penetration, Fig 17.


def first_impact(bench: Bench, design: str, law: str, clearance: float) -> Trajectory:
    """Return one revolution at c_e = 0.9 without friction."""
    run = LongRun(design, Case(law, clearance, 0.9, 0.0), 1)
    model = run.mechanism(mechanism(bench).data)
    return _simulated(json.dumps(model.data))


@lru_cache(maxsize=32)
def _simulated(data: str) -> Trajectory:
    return simulate(mechanism_from(json.loads(data), SPEC), revolutions=1, beyond="tangent")


def deepest(bench: Bench, design: str, law: str, clearance: float) -> float:
    """Return the deepest penetration of the first impact in mm."""
    run = first_impact(bench, design, law, clearance)
    return 1e-3 * float(run.contacts["max_penetration_m"].iloc[0] * 1e6)


def joint_pair(bench: Bench, clearance: float) -> CylinderPair:
    """Return the journal and the bearing."""
    return mechanism(bench, Case(JOHNSON, clearance, 0.9, 0.0)).clearance.contact.pair


@dataclass(frozen=True)
class Range:
    """A range of penetrations: what is chosen, its end in mm for two laws, what is missing."""

    choice: str
    end: Callable[[str, str, float], float]
    missing: str


def ranges(bench: Bench) -> list[Range]:
    """Return the ranges of penetrations that Fig 17 may show; the first is our own."""

    def impact(design: str) -> Callable[[str, str, float], float]:
        return lambda one, other, clearance: min(
            deepest(bench, design, law, clearance) for law in (one, other)
        )

    def loaded(one: str, other: str, clearance: float) -> float:
        pair = joint_pair(bench, clearance)
        return min(float(LAWS[law]().penetration(LOADS[1], pair)) for law in (one, other))

    first = "the first impact at c_e = 0.9"
    return [
        Range(f"up to the deepest of {first}, our masses and lengths", impact(SPEC_SET),
              f"{TABLE_2} and {WINDOW}"),
        *(Range(f"{first}, {SHORT[design]}", impact(design), TABLE_2) for design in SETS[1:]),
        Range(f"up to {LOADS[1]:g} N/mm, the range of the fits", loaded, WINDOW),
    ]  # fmt: skip


Judge = Callable[[Callable[[str, str, float], pd.DataFrame]], Finding]


def over_ranges(bench: Bench, judge: Judge) -> Finding:
    """Return the finding of a judgement of force ratios, over every range of penetrations.

    `judge` takes a function that returns the ratios of two laws' forces at a clearance.
    """

    def judged(over: Range) -> Finding:
        def table(one: str, other: str, clearance: float) -> pd.DataFrame:
            pair = joint_pair(bench, clearance)
            end = over.end(one, other, clearance)
            ends = (float(LAWS[law]().max_penetration(pair)) for law in (one, other))
            return force_ratio(one, other, pair, min(end, *ends))

        return judge(table)

    (over, own), *others = [(over, judged(over)) for over in ranges(bench)]
    alternatives = [Reading(o.choice, g.ours, g.holds, o.missing, g.miss) for o, g in others]
    return replace(own, choice=over.choice, missing=over.missing, alternatives=alternatives)


@claim(
    "4.3-sphere-softest",
    "Lankarani and Nikravesh's law is always the softest of the three",
    paper="always softer",
    rule="a lower force at every equal penetration, over two decades of it",
    figures=("fig17",),
)
def sphere_softest(bench: Bench) -> Finding:
    """Return the largest ratio of Lankarani and Nikravesh's force to the cylindrical laws'."""

    def judge(table: Callable[[str, str, float], pd.DataFrame]) -> Finding:
        ratios = {
            f"{JOINT_LAWS[law]} at {clearance:g} mm": float(
                table(SPHERE, law, clearance)["ratio"].max()
            )
            for clearance in JOINT_CLEARANCES
            for law in CYLINDERS
        }
        holds = max(ratios.values()) < 1
        return Finding(
            f"its force is at most {max(ratios.values()):.2f} of a cylindrical law's",
            holds,
            miss="" if holds else f"{100 * max(ratios.values()) - 100:.0f} % higher",
            values=with_unit(ratios, "-"),
        )

    return over_ranges(bench, judge)


# Section 5.


def largest_forces(bench: Bench, design: str) -> Finding:
    """Judge the largest forces in N of one and the same impact by each law."""
    forces = {
        clearance: {
            law: float(first_impact(bench, design, law, clearance).contacts["max_force_N"].iloc[0])
            for law in JOINT_LAWS
        }
        for clearance in JOINT_CLEARANCES
    }
    over = {
        f"{JOINT_LAWS[law]} at {clearance:g} mm": row[SPHERE] / row[law] - 1
        for clearance, row in forces.items()
        for law in CYLINDERS
    }
    holds = max(over.values()) <= FLOOR and min(over.values()) < -FLOOR
    values = {
        f"{JOINT_LAWS[law]} at {clearance:g} mm, N": force
        for clearance, row in forces.items()
        for law, force in row.items()
    }
    return Finding(
        "in one and the same impact its largest force is "
        f"{-100 * max(over.values()):.2g} % to {-100 * min(over.values()):.2g} % lower",
        holds,
        miss="" if holds else f"up to {100 * max(over.values()):+.1f} %",
        values=values,
    )
