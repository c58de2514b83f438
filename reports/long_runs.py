"""Statistics of the slider-crank's cases over many revolutions, for several sets of inertias.

The runs take minutes, so that their numbers are kept in datasets/mechanism/long_runs.jsonl, one
line for each run under a hash of all that it depends on. What is missing there is run when it is
needed; deleting the file computes everything anew. Runs with impacts are sensitive to rounding:
another machine gets other numbers within the intervals.
"""

from __future__ import annotations

import copy
import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import astuple, dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from cylcontact.files.journal import Journal, call_for, run_recorded
from cylcontact.laws import LAWS
from cylcontact.mechanism import Case, Mechanism, Statistics, long_run, mechanism_from
from cylcontact.mechanism.batch_means import BatchMeans
from cylcontact.reports.bench import Bench, MissingInputError, call_in_bench
from cylcontact.support.arrays import FloatArray
from cylcontact.support.parallel import Call, call
from cylcontact.support.progress import Progress, silent

from .paper import JOINT_CLEARANCES
from .slider_crank import CASES, PAPER_CASES, SPEC, limit_reached, mechanism

LONG_RUNS = "datasets/mechanism/long_runs.jsonl"
LEVEL = 0.95  # of the intervals

# Revolutions that are left out, and those that count: many where there are losses. An elastic
# journal with friction whirls along the wall of a small clearance, leaves it and comes back; such
# episodes last for some twenty revolutions, so that an interval takes a thousand of them.
# Without losses there is no steady state, and a mean is one over a window; the batches of a window
# say how it scatters there. Eight revolutions are too few for batches.
FIRST = 10
FEW, MANY = 240, 1000
WINDOWS = (8, 60)
BATCHED = ("60",)  # the windows that are long enough for batches
STEP_CONTROLLED = 60
# The penetration at onset in m that the paper's step control allows; assumed, it gives none.
ALLOWED_PENETRATION = 1e-7
# Where the law's loads are taken for the hash, in µm.
PROBES = (0.1, 1.0, 5.0)

Change = Callable[[dict[str, Any]], None]


def _lighter(data: dict[str, Any]) -> None:
    for body in data["bodies"].values():
        body["mass"] *= 0.5
        body["inertia"] *= 0.5


def _looser(data: dict[str, Any]) -> None:
    data["integration"]["tolerance"] = 1e-6


def _longer(data: dict[str, Any]) -> None:
    bodies = data["bodies"]
    for name in ("rod", "slider"):
        if name not in bodies:
            rule, remedy = "is missing, which another design replaces", "restore the shipped spec"
            raise MissingInputError(SPEC, f"bodies.{name}", None, rule, remedy)
    bodies["rod"] |= {
        "mass": 0.28,
        "inertia": 6.0e-4,
        "points": {"pin": [-0.08, 0.0], "eye": [0.08, 0.0]},
        "guess": [0.13, 0.0, 0.0],
    }
    bodies["slider"] |= {"mass": 0.21, "guess": [0.21, 0.0, 0.0]}


# In place of Table 2, all assumed: the bench's spec, and two changes of it.
SPEC_SET, LIGHT_SET, LONG_SET = (
    "the spec's inertias",
    "all parts half as heavy",
    "a rod of 160 mm and 0.28 kg with a slider of 0.21 kg",
)
CHANGES: Mapping[str, Change] = {
    SPEC_SET: lambda _data: None,
    LIGHT_SET: _lighter,
    LONG_SET: _longer,
}
SETS = tuple(CHANGES)
# In sentences; the journal's lines keep the names above.
SHORT = {
    SPEC_SET: SPEC_SET,
    LIGHT_SET: LIGHT_SET,
    LONG_SET: "longer rod (160 mm, 0.28 kg), slider of 0.21 kg",
}
# The spec's inertias with the paper's control of the step in place of roots, at two tolerances.
STEP_CONTROLS: Mapping[str, Change] = {
    "the paper's control of the step": lambda _data: None,
    "the paper's control of the step at a tolerance of 1e-6": _looser,
}

# Means over revolutions.
MEANS = (
    "contact_fraction",
    "impacts",
    "max_penetration_um",
    "force_p99_N",
    "max_force_N",
    "drive_work_J",
    "normal_dissipation_J",
    "friction_dissipation_J",
    "evaluations",
)
# Ratios of sums over revolutions, with their factors: means over the time in contact, mean steps,
# and mean durations of a contact and of a flight.
RATIOS = {
    "mean_penetration_um": ("penetration_integral_um_s", "contact_time_s", 1.0),
    "mean_force_N": ("impulse_N_s", "contact_time_s", 1.0),
    "mean_step_contact_us": ("contact_time_s", "contact_steps", 1e6),
    "mean_step_flight_us": ("flight_time_s", "flight_steps", 1e6),
    "contact_us": ("contact_time_s", "impacts", 1e6),
    "flight_us": ("flight_time_s", "impacts", 1e6),
    "step_us": ("time_s", "steps", 1e6),
}
QUANTITIES = (*MEANS, *RATIOS)
# Numbers of a whole run.
WHOLE = ("counted", "continued", "left", "deepest_um", "energy_error")
_RUNS: dict[str, pd.DataFrame] = {}


@dataclass(frozen=True)
class LongRun:
    """A run: the inertias, the case and how long."""

    design: str
    case: Case
    revolutions: int  # with `FIRST`

    @property
    def allowed(self) -> float | None:
        """The penetration at onset in m that the paper's step control allows."""
        return ALLOWED_PENETRATION if self.design in STEP_CONTROLS else None

    def mechanism(self, data: Mapping[str, Any]) -> Mechanism:
        """Return its mechanism, from the data of the spec."""
        changed = copy.deepcopy(dict(data))
        {**CHANGES, **STEP_CONTROLS}[self.design](changed)
        return mechanism_from(changed, self.design, **vars(self.case))


def is_lossless(case: Case) -> bool:
    """Whether nothing dissipates."""
    return case.restitution == 1.0 and case.friction == 0.0


def _whirls(case: Case) -> bool:
    """Whether the journal comes and goes along the wall, which takes long to compute."""
    small = case.clearance == min(JOINT_CLEARANCES)
    return small and case.restitution == 1.0 and case.friction != 0.0


def planned(design: str, case: Case) -> LongRun:
    """Return the run of a case."""
    counted = FEW if is_lossless(case) or (_whirls(case) and design != SPEC_SET) else MANY
    counted = STEP_CONTROLLED if design in STEP_CONTROLS else counted
    return LongRun(design, case, FIRST + counted)


# The longest first, so that no worker is left with one at the end. Other inertias and the control
# of the step serve the ledger of what the paper states, which is of its own laws.
PLAN = sorted(
    (
        planned(design, case)
        for design in (*SETS, *STEP_CONTROLS)
        for case in (CASES if design == SPEC_SET else PAPER_CASES)
    ),
    key=lambda run: (-run.revolutions, *astuple(run.case)[1:3]),
)


def key_of(run: LongRun, data: Mapping[str, Any]) -> str:
    """Return a hash of all that the numbers of a run depend on."""
    model = run.mechanism(data)
    joint = model.clearance.contact
    law = LAWS[vars(run.case)["law"]]()
    depth = np.minimum(np.array(PROBES) * 1e-3, 0.9 * float(law.max_penetration(joint.pair)))
    loads = [f"{load:.9g}" for load in law.load(depth, joint.pair)]
    described = {k: v for k, v in model.data.items() if k != "name"}
    parts = (described, run.revolutions, FIRST, run.allowed, loads, f"{joint.chi:.9g}")
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()[:16]


def long_runs(bench: Bench, progress: Progress = silent) -> pd.DataFrame:
    """Return what is kept of all runs, by `design` and `Case`; run what is missing."""
    data = mechanism(bench).data
    stamp = json.dumps([data, str(bench.root)])
    journal = Journal(bench.input(LONG_RUNS), "long runs", "1")
    if stamp not in _RUNS:
        runs = {key_of(run, data): run for run in PLAN}
        calls: dict[tuple[str, ...], Call] = {
            (key,): call_for(key, _call(bench, data, key, run)) for key, run in runs.items()
        }
        entries = run_recorded(
            calls, journal, lambda line: (line["key"], line), lambda _key, line: line, True,
            bench.jobs, lambda done, total: progress("long runs", done, total),
        )  # fmt: skip
        _RUNS[stamp] = pd.DataFrame(
            [{"design": run.design, **vars(run.case), **entries[key]} for key, run in runs.items()]
        )
    return _RUNS[stamp]


def _call(bench: Bench, data: Mapping[str, Any], key: str, run: LongRun) -> Call:
    """Return the call of `entry` for a run."""
    module = __name__.rpartition(".")[2]
    given = json.dumps(data), key, run.design, run.case, run.revolutions
    return call(call_in_bench, bench.root, module, "entry", *given)


def entry(data: str, key: str, design: str, case: Case, revolutions: int) -> dict[str, Any]:
    """Run a case and return what the journal keeps of it."""
    run = LongRun(design, case, revolutions)
    model = run.mechanism(json.loads(data))
    found = long_run(
        model, run.revolutions, FIRST, beyond="tangent", allowed_penetration=run.allowed
    )
    mean, half_width = numbers(found)
    windows = {name: numbers(part) for name, part in _windows(found, run.case).items()}
    return {
        "key": key,
        "set": run.design,
        "case": list(vars(run.case).values()),
        "counted": len(found.by_revolution),
        "mean": mean,
        "half_width": half_width,
        "period": found.period,
        "windows": {name: mean for name, (mean, _) in windows.items()},
        "scatter": {name: width for name, (_, width) in windows.items() if name in BATCHED},
        **_extremes(found.revolutions, limit_reached(model) * 1e3),
    }


def _windows(found: Statistics, case: Case) -> dict[str, Statistics]:
    """Return the statistics over windows: from the start, and without losses after it."""
    ends = {f"1-{WINDOWS[0]}": (0, WINDOWS[0])}
    if is_lossless(case):
        ends |= {str(length): (FIRST, FIRST + length) for length in WINDOWS}
    return {
        name: replace(found, revolutions=found.revolutions[:end], first=first)
        for name, (first, end) in ends.items()
    }


def _extremes(table: pd.DataFrame, limit: float) -> dict[str, float]:
    """Return numbers of a whole run, of which a limit of the penetration in µm is given.

    The share of contacts that were `continued` along the law's tangent, of revolutions that passed
    the limit (`left`), the deepest penetration, and the largest error of the energy balance over
    the largest kinetic energy.
    """
    deepest = table["max_penetration_um"]
    error = table["energy_error_J"].abs().max() / table["kinetic_energy_J"].max()
    return {
        "continued": float(table["beyond_law"].sum() / table["contacts"].sum()),
        "left": float((deepest > limit).mean()),
        "deepest_um": float(deepest.max()),
        "energy_error": float(error),
    }


Numbers = dict[str, float | None]


def numbers(found: Statistics) -> tuple[Numbers, Numbers]:
    """Return the means and their half-widths by batch means; None where there is none.

    Without losses there is no steady state: a half-width then tells how the mean scatters over
    its window, and nothing of other windows.
    """
    table = found.by_revolution.assign(time_s=found.mechanism.period)
    table = table.assign(flight_steps=table["steps"] - table["contact_steps"])
    over, under = np.empty((2, len(table), len(QUANTITIES)))
    for column, name in enumerate(QUANTITIES):
        top, bottom, factor = RATIOS.get(name, (name, "", 1.0))
        over[:, column] = factor * table[top]
        under[:, column] = table[bottom] if bottom else 1.0
    batches = BatchMeans.of(over, under)
    return _kept(batches.ratio), _kept(batches.half_width(LEVEL))


def _kept(values: FloatArray) -> Numbers:
    """Return the numbers of all quantities as JSON keeps them, to nine digits and without NaN."""
    return {
        name: float(f"{value:.9g}") if np.isfinite(value) else None
        for name, value in zip(QUANTITIES, values, strict=True)
    }


def statistics_table(bench: Bench, design: str = SPEC_SET, window: str = "") -> pd.DataFrame:
    """Return the numbers of a set's cases, with the half-widths of their intervals (95 %).

    Of the cases without losses over a window, such as "8" revolutions that count; of all cases
    over "1-8", from the start. By default over those of the run.
    """
    table = long_runs(bench)
    rows = []
    for record in table[table["design"] == design].to_dict("records"):
        chosen = record["windows"].get(window)
        mean = record["mean"] if chosen is None else chosen
        width = record["half_width"] if chosen is None else record["scatter"].get(window, {})
        rows.append(
            {name: record[name] for name in (*vars(CASES[0]), *WHOLE)}
            | {k: _number(v) for k, v in mean.items()}
            | {f"{k}_half_width": _number(width.get(k)) for k in mean}
        )
    order = {case: number for number, case in enumerate(CASES)}
    result = pd.DataFrame(rows)
    keys = [order[Case(*key)] for key in result[list(vars(CASES[0]))].to_numpy()]
    result["flight_fraction"] = 1 - result["contact_fraction"]
    result["flight_fraction_half_width"] = result["contact_fraction_half_width"]
    return result.iloc[np.argsort(keys)].reset_index(drop=True)


def _number(value: float | None) -> float:
    return np.nan if value is None else value
