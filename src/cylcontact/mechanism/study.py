"""Many revolutions, many cases: long runs, sweeps, accuracy by tolerance, bifurcations."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import asdict, astuple, dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.files.journal import Journal, call_for, run_recorded
from cylcontact.files.provenance import spec_hash
from cylcontact.mechanism.joint_motion import JointMotion
from cylcontact.mechanism.model import Mechanism, mechanism_from
from cylcontact.mechanism.run import Run, Settings, StepHistory, concatenate, settings_for
from cylcontact.mechanism.statistics import Statistics, require_counted
from cylcontact.mechanism.trajectory import Interrupted, Trajectory, reduced, simulate
from cylcontact.support.arrays import FloatArray, as_floats, require
from cylcontact.support.choices import Beyond, Method
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import Call, Workers, call
from cylcontact.support.progress import Progress, silent

if TYPE_CHECKING:
    import pandas as pd

# Revolutions left out at the start of a run, unless it is short: then a fifth of it.
FIRST = 10
# Assumed: two runs agree while their eccentricities differ by less than this fraction of the
# clearance. Runs diverge fast, so the horizon depends little on the fraction.
AGREEMENT = 0.01
# The second tolerance of `agreement` relative to the first, and how far it looks.
TIGHTER, REVOLUTIONS = 0.1, 10

# --- one mechanism ------------------------------------------------------------------------------


def first_of(revolutions: int) -> int:
    """Return the number of revolutions that statistics leave out by default."""
    return min(FIRST, revolutions // 5)


def long_run(
    mechanism: Mechanism,
    revolutions: int = 1000,
    first: int | None = None,
    method: Method | None = None,
    tolerance: float | None = None,
    beyond: Beyond = "stop",
    progress: Progress = silent,
    resume: Statistics | None = None,
    allowed_penetration: float | None = None,
) -> Statistics:
    """Simulate a mechanism over many revolutions, and return their statistics.

    The steps of a revolution are dropped once it is reduced to numbers, so that memory does not
    grow with them. The numbers equal those of `simulate` to the bit.

    Parameters
    ----------
    mechanism, method, tolerance, beyond, progress, allowed_penetration
        As in `simulate`.
    revolutions : int
        Total number of revolutions.
    first : int, optional
        The first revolution that counts, from 0. By default 10 are left out, and of a short run a
        fifth.
    resume : Statistics, optional
        An earlier run to continue. Its mechanism and settings are used, and of the other arguments
        only `revolutions`, `first` and `progress`.

    Returns
    -------
    Statistics

    Raises
    ------
    InputError
        As `simulate`, and if `first` leaves no revolution.
    Interrupted
        After Ctrl-C, with the statistics of the complete revolutions.

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism
    >>> mechanism = read_mechanism("datasets/slider_crank.toml")
    >>> statistics = long_run(mechanism, revolutions=40)
    >>> print(f"{statistics.mean['drive_work_J']:.2f} J, period {statistics.period}")
    3.05 J, period 1
    """
    import pandas as pd

    if resume is None:
        settings = settings_for(mechanism, method, tolerance, beyond, allowed_penetration)
    else:
        mechanism, settings = resume.mechanism, resume.settings
    first = first_of(revolutions) if first is None else first
    require_counted("long_run", first, max(revolutions, 1))
    run = Run.start(mechanism, settings)
    start = Trajectory(mechanism, settings, StepHistory.of(run.state))
    origin = float(start.energy[0])
    limits = {name: joint.limits for name, joint in start.joints.items()}
    known: list[Mapping[Any, Any]] = []
    if resume is not None:
        known, run.state = [*resume.revolutions.to_dict("records")], resume.end
    last, parts = StepHistory.of(run.state), list[Future[dict[str, Any]]]()

    def gathered(first: int) -> Statistics:
        records = [*known, *(part.result() for part in parts)]
        table = pd.DataFrame(records, pd.RangeIndex(len(records), name="revolution"))
        return Statistics(table, mechanism, settings, last.end, limits, first)

    with ThreadPoolExecutor(1) as beside:  # reduces a revolution while the next one is integrated
        try:
            for rows in run.revolutions(revolutions, progress, len(known)):
                wait(parts[-1:])
                steps = concatenate([last, rows])
                parts.append(beside.submit(reduced, Trajectory(mechanism, settings, steps), origin))
                last = steps.taken(slice(-1, None), 1)
        except KeyboardInterrupt:
            done = len(known) + len(parts)
            complete = gathered(min(first, done - 1)) if done else None
            raise Interrupted(statistics=complete) from None
        return gathered(first)


def eccentricity_at(joint: JointMotion, time: FloatArray) -> FloatArray:
    """Return the eccentricity of a joint in m at times of its run in s, by Hermite's cubics."""
    from scipy.interpolate import CubicHermiteSpline

    steps, rows = np.unique(joint.run.time, return_index=True)
    spline = CubicHermiteSpline(steps, joint.eccentricity[rows], joint.eccentricity_rate[rows])
    return as_floats(spline(time))


def horizon(run: Trajectory, other: Trajectory, share: float = AGREEMENT) -> float:
    """Return the time until which two runs of the same mechanism agree, in revolutions.

    Parameters
    ----------
    run, other : Trajectory
        The runs, for example at two tolerances or with two methods.
    share : float
        Allowed difference of the eccentricities, as a fraction of the clearance.

    Returns
    -------
    float
        The time of the first step with a larger difference, or the end if there is none.

    Raises
    ------
    InputError
        If the runs are of different mechanisms.

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism, simulate
    >>> mechanism = read_mechanism("datasets/slider_crank.toml", clearance=0.02)
    >>> runs = [simulate(mechanism, tolerance=rtol, revolutions=1) for rtol in (1e-8, 1e-10)]
    >>> horizon(*runs)
    1.0
    """
    if run.mechanism.data["joint"] != other.mechanism.data["joint"]:
        raise InputError("horizon", "other", None, "is of another mechanism", "give two alike")
    end = min(run.revolutions, other.revolutions)
    time = run.time[run.time <= end * run.mechanism.period * (1 + 1e-12)]
    time = np.minimum(time, other.time[-1])
    parted = np.zeros(time.size, dtype=bool)
    for name, joint in run.joints.items():
        there = eccentricity_at(other.joints[name], time)
        apart = np.hypot(*(joint.eccentricity[: time.size] - there).T)
        parted |= apart > share * joint.contact.radial * 1e-3
    return float(run.revolution[np.argmax(parted)]) if parted.any() else float(end)


def agreement(mechanism: Mechanism, settings: Settings, revolutions: int = REVOLUTIONS) -> str:
    """Return a sentence on how long a run keeps to its path at a tenth of its tolerance.

    Of the run, `revolutions` long, at most ten revolutions are compared.
    """
    compared = min(revolutions, REVOLUTIONS)
    pair = settings.tolerance, max(settings.tolerance * TIGHTER, 1e-14)
    text = f"tolerances of {pair[0]:g} and {pair[1]:g}"
    try:
        runs = [
            simulate(
                mechanism, settings.method, compared, tolerance, settings.beyond,
                allowed_penetration=settings.allowed_penetration,
            )
            for tolerance in pair
        ]  # fmt: skip
    except InputError as error:
        return f"{text} part: at the second one {error.rule}"
    reach = horizon(runs[0], runs[1])
    unit = "revolution" if compared == 1 else f"{compared} revolutions"
    if reach >= compared:
        return f"{text} keep to one path over the {unit} compared"
    return f"{text} part after {reach:.2g} revolutions: beyond that only statistics mean something"


# --- many ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Case:
    """What varies in a study: a law, the clearance in mm, restitution, friction.

    None stands for the value of the mechanism's spec; others are those of all its joints with
    clearance.
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
    return [Case(*case) for case in itertools.product(laws, clearances, restitutions, frictions)]


# A case and what else a reduction is told of it.
Item = tuple[Case, tuple[Any, ...]]


def study(
    mechanism: Mechanism,
    product: Sequence[Item],
    reduce: Callable[..., Any],
    workers: Workers = 1,
    progress: Callable[[int, int], None] = lambda *_: None,
    journal: Journal | None = None,
    resume: bool = False,
) -> list[Any]:
    """Return what `reduce(mechanism, *rest)` gives for every item of a product, in its order.

    The case of an item changes the mechanism. A journal records results by case, if they are JSON.
    """
    require(len(product) > 0, "study", "cases", [], "there is none", "give every list a value")
    about, calls = (mechanism.data, mechanism.source), dict[tuple[Item, ...], Call]()
    for case, rest in product:
        mechanism_from(*about, **asdict(case))  # refuses what cannot be
        deferred = call(_reduced, *about, case, reduce, rest)
        calls[(case, rest),] = call_for((case, rest), deferred)
    rests = dict(product)

    def parse(entry: dict[str, Any]) -> tuple[Item, Any]:
        case = Case(**entry["case"])
        return (case, rests.get(case, ())), entry["row"]

    results = run_recorded(
        calls, journal, parse, lambda item, row: {"case": asdict(item[0]), "row": row}, resume,
        workers, progress,
    )  # fmt: skip
    return [results[item] for item in product]


def _reduced(
    data: dict[str, Any], source: str, case: Case, reduce: Callable[..., Any], rest: tuple[Any, ...]
) -> Any:
    return reduce(mechanism_from(data, source, **asdict(case)), *rest)


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
        energy, and the largest drift of a constraint (NaN in minimal coordinates). From
        `Statistics`: of every quantity the mean, the standard deviation over the revolutions
        (`_std`), half the 95 % interval (`_half_width`) and the verdict (`_stationary`), the
        `period`, the δ̇⁽⁻⁾ carried (`carried_m_per_s`) and the `warnings`. With `plan.against` also
        the horizon in revolutions and the statistics at the other tolerance (`_against`).

    Raises
    ------
    InputError
        If there are no cases, one cannot be, or the plan leaves no revolution to count.

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

    _require_possible(mechanism, plan)
    key = spec_hash({"mechanism": mechanism.data, "plan": astuple(plan)})
    journal = Journal(checkpoint, "sweep", key) if checkpoint else None
    product = [(case, (plan,)) for case in wanted]
    report = partial(progress, "cases")
    return pd.DataFrame(study(mechanism, product, run_case, workers, report, journal, resume))


def _require_possible(mechanism: Mechanism, plan: Plan) -> None:
    """Refuse a plan that no worker could follow."""
    require_counted("sweep", plan.first, plan.revolutions)
    for tolerance in {plan.tolerance, plan.against}:
        settings_for(mechanism, plan.method, tolerance, plan.beyond)


def run_case(mechanism: Mechanism, plan: Plan) -> dict[str, Any]:
    """Simulate one case and return its row of the table."""
    row: dict[str, Any] = {}
    for joint in mechanism.clearances:
        values = {
            "law": joint.contact.data["law"],
            "clearance_mm": joint.contact.radial,
            "restitution": joint.contact.data["dissipation"]["restitution"],
            "friction": joint.contact.friction,
        }
        prefix = f"{joint.name}." if len(mechanism.clearances) > 1 else ""
        row |= {f"{prefix}{key}": value for key, value in values.items()}
    row |= {"revolutions": plan.revolutions, "first": plan.first}
    try:
        run, *others = (
            simulate(mechanism, plan.method, plan.revolutions, tolerance, plan.beyond)
            for tolerance in (plan.tolerance, *filter(None, [plan.against]))
        )
    except InputError as error:
        return row | {"status": "stopped", "message": str(error)}
    compared: dict[str, Any] = {}
    for other in others:
        reach = horizon(run, other)
        if reach < plan.revolutions:
            row["first"] = max(plan.first, math.ceil(reach))
        compared = {"horizon_revolutions": reach, "against": plan.against}
        numbers = _numbers(other, row["first"]).items()
        compared |= {f"{name}_against": value for name, value in numbers}
    minimal = run.settings.method == "minimal"
    return {
        **row,
        "status": "complete",
        "message": run.statistics().continuation,
        **_numbers(run, row["first"]),
        "method": run.settings.method,
        "tolerance": run.settings.tolerance,
        "energy_error": float(np.abs(run.energy_error).max() / run.kinetic_energy.max()),
        "drift": math.nan if minimal else float(run.drift[:, 0].max()),
        **compared,
    }


def _numbers(run: Trajectory, first: int) -> dict[str, Any]:
    """Return the statistics of every quantity; none where no revolution is left."""
    if first >= run.revolutions:
        return {}
    statistics, numbers = run.statistics(first), dict[str, Any]()
    columns = statistics.interval().assign(std=statistics.scatter, stationary=statistics.stationary)
    for name, row in columns.to_dict("index").items():
        numbers[str(name)] = row.pop("mean")
        numbers |= {f"{name}_{key}": value for key, value in row.items()}
    numbers["period"] = statistics.period
    for name in run.joints:
        prefix = f"{name}." if len(run.joints) > 1 else ""
        numbers[f"{prefix}carried_m_per_s"] = statistics.joint(name).carried
    return numbers | {"warnings": "; ".join(statistics.warnings)}


def tolerances(
    mechanism: Mechanism,
    wanted: Sequence[Case],
    plans: Sequence[Plan],
    workers: Workers = 1,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Return cost and accuracy of cases by the method and tolerance of some plans.

    One row for each plan: `method`, `tolerance`, number of complete `cases`, largest and median
    relative energy error, largest drift of a constraint in m or rad (NaN in minimal coordinates),
    and mean steps and evaluations per revolution. An `InputError` if no case is complete.
    """
    import pandas as pd

    for plan in plans:
        _require_possible(mechanism, plan)
    product = [(case, (plan,)) for plan in plans for case in wanted]
    results = study(mechanism, product, run_case, workers, partial(progress, "cases"))
    rows = []
    for start in range(0, len(results), len(wanted)):
        table = pd.DataFrame(results[start : start + len(wanted)])
        complete = table[table["status"] == "complete"]
        if complete.empty:
            rule = f"no case is complete; the first: {table['message'].iloc[0]}"
            raise InputError("tolerances", "cases", None, rule, "choose other cases")
        row = dict(complete[["method", "tolerance"]].iloc[0]) | {"cases": len(complete)}
        row["energy_error_max"] = complete["energy_error"].max()
        row["energy_error_median"] = complete["energy_error"].median()
        row["drift_max"] = complete["drift"].max()
        row["steps_per_revolution"] = complete["steps"].mean()
        row["evaluations_per_revolution"] = complete["evaluations"].mean()
        rows.append(row)
    return pd.DataFrame(rows)


def bifurcation(
    mechanism: Mechanism,
    clearances: Sequence[float],
    revolutions: int = 200,
    last: int = 50,
    impact_rate: float | None = None,
    beyond: Beyond = "stop",
    workers: Workers = 1,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Return the Poincaré sections of a mechanism over its clearance.

    Parameters
    ----------
    mechanism : Mechanism
        What all runs have in common.
    clearances : sequence of float
        Radial clearances in mm.
    revolutions, last : int
        The length of each run, and how many of its last sections are kept.
    impact_rate : float, optional
        δ̇⁽⁻⁾ in m/s that a contact carries from revolution 10 on if the joint is in contact at its
        end. A contact without end keeps it, and it decides the motion; a flight ends it. By default
        every contact has the rate of its onset.
    beyond : {"stop", "tangent"}
        As in `simulate`.
    workers : int or Cluster
        Where to run.
    progress : callable, optional
        Called with a stage, the runs done and their number.

    Returns
    -------
    DataFrame
        One row for each section: `clearance_mm`, `held_m_per_s` (NaN: not held), `revolution`, the
        section, `impact_rate_m_per_s` (δ̇⁽⁻⁾ at that time, 0 out of contact) and the run's `period`
        (0: none up to 8; NaN: too short).

    Raises
    ------
    InputError
        If there is no clearance, or a run cannot be or stops.

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism
    >>> mechanism = read_mechanism("datasets/slider_crank.toml")
    >>> table = bifurcation(mechanism, [0.5], revolutions=40, last=2)
    >>> print(table[["clearance_mm", "revolution", "in_contact", "period"]].to_string(index=False))
     clearance_mm  revolution  in_contact  period
              0.5          38        True     1.0
              0.5          39        True     1.0
    """
    import pandas as pd

    require(
        0 < last < revolutions, "bifurcation", "last", last,
        f"must be at least 1 and below the {revolutions} revolutions", "keep fewer sections",
    )  # fmt: skip
    require(
        impact_rate is None or impact_rate > 0, "bifurcation", "impact_rate", impact_rate,
        "must be positive", "give it in m/s, or leave it out",
    )  # fmt: skip
    rest = revolutions, last, impact_rate, beyond
    product = [(Case(None, clearance, None, None), (clearance, *rest)) for clearance in clearances]
    tables = study(mechanism, product, _sections, workers, partial(progress, "clearances"))
    return pd.DataFrame(pd.concat(tables, ignore_index=True))


def _sections(
    mechanism: Mechanism,
    clearance: float,
    revolutions: int,
    last: int,
    impact_rate: float | None,
    beyond: Beyond,
) -> pd.DataFrame:
    """Return the rows of `bifurcation` for one clearance in mm."""
    first, start = revolutions - last, None
    if impact_rate is not None:
        start = long_run(mechanism, min(FIRST, first), beyond=beyond)
        end = start.end
        held = np.where(end.in_contact, impact_rate, end.impact_rate)
        start = replace(start, end=replace(end, impact_rate=held))
    run = long_run(mechanism, revolutions, first, beyond=beyond, resume=start)
    rates = [str(name) for name in run.by_revolution if "impact_rate_m_per_s" in str(name)]
    table: pd.DataFrame = run.section.assign(
        **{name: run.by_revolution[name] for name in rates},
        period=np.nan if run.period is None else float(run.period),
    ).reset_index()
    table.insert(0, "clearance_mm", clearance)
    table.insert(1, "held_m_per_s", np.nan if impact_rate is None else impact_rate)
    return table
