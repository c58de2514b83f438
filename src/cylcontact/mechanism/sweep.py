"""Many cases of one mechanism: laws × clearances × restitutions × frictions, one tidy table."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, astuple, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.choices import Beyond, Method
from cylcontact.errors import InputError
from cylcontact.journal import Journal
from cylcontact.mechanism.model import Mechanism, mechanism_from
from cylcontact.mechanism.simulate import settings_for, simulate
from cylcontact.mechanism.studies import horizon
from cylcontact.mechanism.trajectory import Trajectory
from cylcontact.parallel import Call, Workers, call, call_for, run_recorded
from cylcontact.progress import Progress, silent
from cylcontact.provenance import spec_hash

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Case", "Plan", "cases", "run_case", "sweep"]


@dataclass(frozen=True)
class Case:
    """What varies in a sweep: a law's name, the clearance in mm, restitution, friction.

    None stands for the value of the mechanism's spec.
    """

    law: str | None
    clearance: float | None
    restitution: float | None
    friction: float | None


@dataclass(frozen=True)
class Plan:
    """How every case of a sweep is run.

    Statistics count revolutions from `first` on. With a second tolerance, `against`, every case is
    run at that one as well; statistics then count only revolutions beyond the horizon up to which
    the two agree, unless they agree to the end.
    """

    revolutions: int
    first: int = 0
    method: Method | None = None
    tolerance: float | None = None
    beyond: Beyond = "stop"
    against: float | None = None


def cases(
    laws: Iterable[str | None],
    clearances: Iterable[float | None],
    restitutions: Iterable[float | None],
    frictions: Iterable[float | None],
) -> list[Case]:
    """Return all combinations, the last one varying fastest.

    Examples
    --------
    >>> [case.friction for case in cases(["johnson"], [0.5], [0.9], [0.0, 0.1])]
    [0.0, 0.1]
    """
    varied: list[list[Any]] = [[*laws], [*clearances], [*restitutions], [*frictions]]
    return [Case(*values) for values in itertools.product(*varied)]


def sweep(
    mechanism: Mechanism,
    wanted: Sequence[Case],
    plan: Plan,
    workers: Workers = 1,
    progress: Progress = silent,
    checkpoint: Path | None = None,
    resume: bool = False,
) -> pd.DataFrame:
    """Simulate cases of a mechanism, in parallel.

    Parameters
    ----------
    mechanism : Mechanism
        What all cases have in common.
    wanted : sequence of Case
        The cases; see `cases`.
    plan : Plan
        How to run each.
    workers : int or Cluster
        Where to run them; the table does not depend on it.
    progress : callable, optional
        Called with a stage, the cases done and their number.
    checkpoint : Path, optional
        The journal of complete cases; the caller removes it once the table is saved.
    resume : bool
        Whether to take the cases already in `checkpoint` from there.

    Returns
    -------
    DataFrame
        One row for each case in their order: what varies, `status` ("complete", or "stopped" with
        the reason in `message`), the largest energy error relative to the peak of the kinetic
        energy, the largest drift of a constraint (NaN in minimal coordinates, from which bodies are
        placed so that joints close), and the assumptions. From `Statistics`: of every quantity the
        mean, the standard deviation over the revolutions (`_std`), half the 95 % interval
        (`_half_width`) and the verdict (`_stationary`), the `period`, the δ̇⁽⁻⁾ carried
        (`carried_m_per_s`) and the `warnings`. With `plan.against` also the horizon in revolutions
        and the statistics at the other tolerance (`_against`).

    Raises
    ------
    InputError
        If there are no cases, a case cannot be (an unknown law, a negative clearance), or the
        plan leaves no revolution to count.

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism
    >>> mechanism = read_mechanism("datasets/slider_crank.toml")
    >>> table = sweep(mechanism, cases(["enhanced"], [0.02], [0.9], [0.0]), Plan(revolutions=1))
    >>> print(table[["law", "status", "impacts"]].to_string(index=False))
         law   status  impacts
    enhanced complete      6.0
    """
    import pandas as pd

    _require_possible(mechanism, wanted, plan)
    journal = Journal(checkpoint, "sweep", _key(mechanism, plan)) if checkpoint else None
    calls: dict[tuple[Case, ...], Call] = {
        (case,): call_for(case, call(run_case, mechanism.data, mechanism.source, case, plan))
        for case in wanted
    }
    rows = run_recorded(
        calls, journal, _row_from, _entry, resume, workers, partial(progress, "cases")
    )
    return pd.DataFrame([rows[case] for case in wanted])


def _row_from(entry: dict[str, Any]) -> tuple[Case, dict[str, Any]]:
    """Return the case and the row that a journal entry records."""
    return Case(**entry["case"]), entry["row"]


def _entry(case: Case, row: dict[str, Any]) -> dict[str, Any]:
    """Return the journal entry that records a case and its row."""
    return {"case": asdict(case), "row": row}


def run_case(data: dict[str, Any], source: str, case: Case, plan: Plan) -> dict[str, Any]:
    """Simulate one case and return its row of the table."""
    mechanism = mechanism_from(data, source, **asdict(case))
    joint = mechanism.data["clearance"]
    row: dict[str, Any] = {
        "law": joint["law"],
        "clearance_mm": joint["radial"],
        "restitution": joint["restitution"],
        "friction": joint["friction"],
        "revolutions": plan.revolutions,
        "first": plan.first,
    }
    try:
        run = simulate(mechanism, plan.method, plan.revolutions, plan.tolerance, plan.beyond)
        if plan.against is None:
            return row | _complete(run, plan.first)
        other = simulate(mechanism, plan.method, plan.revolutions, plan.against, plan.beyond)
    except InputError as error:
        return row | {"status": "stopped", "message": str(error)}
    reach = horizon(run, other)
    if reach < plan.revolutions:
        row["first"] = max(plan.first, math.ceil(reach))
    second = {f"{name}_against": value for name, value in _numbers(other, row["first"]).items()}
    compared = {"horizon_revolutions": reach, "against": plan.against}
    return row | _complete(run, row["first"]) | compared | second


def _complete(run: Trajectory, first: int) -> dict[str, Any]:
    """Return what a complete run adds to a row."""
    return {
        "status": "complete",
        "message": run.statistics().continuation,
        **_numbers(run, first),
        "method": run.settings.method,
        "tolerance": run.settings.tolerance,
        "energy_error": float(np.abs(run.energy_error).max() / run.kinetic_energy.max()),
        "drift": _drift(run),
        "assumptions": "; ".join(run.assumptions),
    }


def _drift(run: Trajectory) -> float:
    """Return the largest |Φ| in m or rad; NaN in minimal coordinates, which cannot violate it."""
    return math.nan if run.settings.method == "minimal" else float(run.drift[:, 0].max())


def _numbers(run: Trajectory, first: int) -> dict[str, Any]:
    """Return the statistics of every quantity; none where no revolution is left."""
    if first >= run.revolutions:
        return {}
    statistics = run.statistics(first)
    columns = statistics.interval().assign(std=statistics.scatter, stationary=statistics.stationary)
    numbers: dict[str, Any] = {}
    for name, row in columns.to_dict("index").items():
        numbers[str(name)] = row.pop("mean")
        numbers |= {f"{name}_{key}": value for key, value in row.items()}
    return numbers | {
        "period": statistics.period,
        "carried_m_per_s": statistics.carried,
        "warnings": "; ".join(statistics.warnings),
    }


def _require_possible(mechanism: Mechanism, wanted: Sequence[Case], plan: Plan) -> None:
    """Refuse what no worker could run."""
    if not wanted:
        raise InputError("sweep", "cases", [], "there is none", "give every list a value")
    if not 0 <= plan.first < plan.revolutions:
        raise InputError(
            "sweep", "first", plan.first, f"leaves none of {plan.revolutions} revolutions",
            "start earlier, or simulate more revolutions",
        )  # fmt: skip
    for tolerance in {plan.tolerance, plan.against}:
        settings_for(mechanism, plan.method, tolerance, plan.beyond)
    for case in wanted:
        mechanism_from(mechanism.data, mechanism.source, **asdict(case))


def _key(mechanism: Mechanism, plan: Plan) -> str:
    """Return a hash of everything that a case's row depends on besides the case."""
    return spec_hash({"mechanism": mechanism.data, "plan": astuple(plan)})
