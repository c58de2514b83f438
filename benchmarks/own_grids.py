"""How many runs reach the best on grids that a user might make, by way of ending the search.

`python -m benchmarks.own_grids` prints the table of docs/calibration.md (some minutes). All
settings of the search are the defaults; the seconds are those of the processor, for all runs.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial

from cylcontact.fitting.calibration import problem_of
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.genetic import search
from cylcontact.fitting.law_models import MODELS
from cylcontact.fitting.objectives import Problem
from cylcontact.fitting.polish import polish
from cylcontact.fitting.records import SAME_BASIN
from cylcontact.fitting.runs import RunPlan, execute, plan_runs
from cylcontact.fitting.specs import ParameterSpec
from cylcontact.progress import silent

# E in GPa, ν, ΔR in mm, and the load in N/mm: first, last, number of points and spacing.
GRIDS = {
    "light alloys and steel": (
        ("internal", (60, 210, 4), (0.25, 0.35, 3), (0.02, 2, 21, "log"), (5, 500, 15, "log"))
    ),
    "the same, few points": (
        ("internal", (60, 210, 2), (0.25, 0.35, 2), (0.05, 1, 6, "log"), (10, 200, 4, "log"))
    ),
    "polymers": (
        ("internal", (1, 10, 4), (0.3, 0.45, 3), (0.05, 5, 31, "linear"), (1, 50, 10, "log"))
    ),
    "stiff, all clearances": (
        ("internal", (100, 400, 5), (0.2, 0.3, 2), (0.1, 9, 41, "log"), (10, 1000, 12, "log"))
    ),
    "close fits": (
        ("internal", (60, 210, 4), (0.25, 0.35, 3), (0.01, 0.2, 15, "linear"), (5, 100, 10))
    ),
    "external": (
        ("external", (60, 210, 4), (0.25, 0.35, 3), (5, 200, 21, "log"), (5, 500, 15, "log"))
    ),
}


def main() -> None:
    """Print the table."""
    print("| grid | one descent | s | as it is | s | descents alone | s |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for name in GRIDS:
        best, columns = _columns(campaign_of(name))
        cells = [f"{_at(best, values)} of {len(values)} | {cpu:.1f}" for values, cpu in columns]
        print(f"| {name} | {' | '.join(cells)} |", flush=True)


def campaign_of(name: str, **genetic: object) -> Campaign:
    """Return the campaign of the enhanced law, all coefficients free, on one of the grids."""
    contact, *axes = GRIDS[name]
    tables = {
        p.name: ParameterSpec.of(p).model_dump(exclude_none=True)
        for p in MODELS["enhanced", contact].parameters
    }
    settings = {
        "campaign": {
            "dataset": "inline",
            "law": "enhanced",
            "parameters": tables,
            "genetic": genetic,
        },
        "dataset": {
            "contact": contact,
            "reference": "johnson",
            "axes": dict(zip(("E", "nu", "dR", "load"), map(_axis, axes), strict=True)),
        },
    }
    return Campaign.of_settings(name, settings, name)


def _axis(axis: tuple[float, float, int]) -> dict[str, object]:
    """Return an axis as a grid spec has it; its spacing is linear unless given."""
    low, high, points, spacing = (*axis, "linear")[:4]
    return {"min": float(low), "max": float(high), "points": points, "spacing": spacing}


def _columns(campaign: Campaign) -> tuple[float, list[tuple[list[float], float]]]:
    """Return the best objective; by way of polishing the runs' objectives and the seconds."""
    problem, _ = problem_of(campaign, 1, silent)
    genetic = campaign.spec.genetic
    settings = (genetic.runs, genetic.populations, genetic.crossovers, genetic.generations)
    plans, alone = (
        plan_runs(*settings, campaign.spec.seed, optimizer) for optimizer in ("genetic", "descents")
    )

    def one_descent(plan):
        best = search(problem, plan.population, plan.generations, plan.crossover, plan.seed)
        return polish(problem, best.point)[1]

    columns = [
        _timed(lambda: [one_descent(plan) for plan in plans]),
        *(_timed(partial(_ends, problem, each)) for each in (plans, alone)),
    ]
    return min(min(values) for values, _ in columns), columns


def _ends(problem: Problem, plans: list[RunPlan]) -> list[float]:
    """Return the objectives of runs."""
    return [execute(problem, plan).objective for plan in plans]


def _timed(ends: Callable[[], list[float]]) -> tuple[list[float], float]:
    """Return objectives, and the seconds of the processor that they took."""
    started = time.process_time()
    return ends(), time.process_time() - started


def _at(best: float, values: list[float]) -> int:
    """Return how many objectives are the best, within 0.1 %."""
    return sum(value <= best * (1 + SAME_BASIN) for value in values)


if __name__ == "__main__":
    main()
