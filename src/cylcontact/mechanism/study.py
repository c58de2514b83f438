"""Many revolutions, many cases: long runs, sweeps, and how long two runs agree."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.mechanism.run import Settings, concatenate, revolutions_of
from cylcontact.mechanism.slider_crank import SliderCrank
from cylcontact.mechanism.statistics import Statistics
from cylcontact.mechanism.trajectory import Trajectory, numbers_of
from cylcontact.support.arrays import require
from cylcontact.support.choices import Beyond
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import Workers, call, collect
from cylcontact.support.progress import Progress, silent

if TYPE_CHECKING:
    import pandas as pd

# Revolutions left out at the start of a run, unless it is short: then a fifth of it.
FIRST = 10
# Assumed: two runs agree while their eccentricities differ by less than this fraction of the
# clearance. Runs diverge fast, so the horizon depends little on the fraction.
AGREEMENT = 0.01


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a long run, with the statistics of its complete revolutions, if any."""

    def __init__(self, statistics: Statistics | None) -> None:
        super().__init__()
        self.statistics = statistics


def first_of(revolutions: int) -> int:
    """Return the number of revolutions that statistics leave out by default."""
    return min(FIRST, revolutions // 5)


def long_run(
    mechanism: SliderCrank,
    revolutions: int = 1000,
    first: int | None = None,
    beyond: Beyond = "stop",
    progress: Progress = silent,
) -> Statistics:
    """Simulate many revolutions, and return their statistics.

    The steps of a revolution are dropped once it is reduced to numbers, so that memory does not
    grow. The numbers equal those of `simulate` to the bit.

    Parameters
    ----------
    mechanism, beyond, progress
        As in `simulate`.
    revolutions : int
        The number of revolutions.
    first : int, optional
        The first revolution that counts, from 0. By default 10 are left out, and of a short run a
        fifth.

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
    >>> statistics = long_run(read_mechanism("datasets/slider_crank.toml"), revolutions=40)
    >>> print(f"{statistics.mean['drive_work_J']:.2f} J, period {statistics.period}")
    3.05 J, period 1
    """
    import pandas as pd

    settings = Settings(beyond)
    first = first_of(revolutions) if first is None else first
    rule, remedy = f"leaves none of {revolutions} revolutions", "start earlier, or simulate more"
    require(0 <= first < max(revolutions, 1), "long_run", "first", first, rule, remedy)
    runs = revolutions_of(mechanism, settings, revolutions, progress)
    last = next(runs)
    origin = float(Trajectory(mechanism, settings, last).energy[0])
    parts = list[Future[dict[str, Any]]]()

    def gathered(first: int) -> Statistics:
        records = [part.result() for part in parts]
        table = pd.DataFrame(records, pd.RangeIndex(len(records), name="revolution"))
        return Statistics(table, mechanism, settings, first)

    with ThreadPoolExecutor(1) as beside:  # reduces a revolution while the next one is integrated
        try:
            for rows in runs:
                wait(parts[-1:])
                steps = concatenate([last, rows])
                run = Trajectory(mechanism, settings, steps)
                parts.append(beside.submit(numbers_of, run, origin))
                last = steps.part(slice(-1, None), 1)
        except KeyboardInterrupt:
            complete = gathered(min(first, len(parts) - 1)) if parts else None
            raise Interrupted(complete) from None
        return gathered(first)


def horizon(run: Trajectory, other: Trajectory, share: float = AGREEMENT) -> float:
    """Return the time until which two runs of the same mechanism agree, in revolutions.

    Parameters
    ----------
    run, other : Trajectory
        The runs, for example at two tolerances.
    share : float
        Allowed difference of the eccentricities, as a fraction of the clearance.

    Returns
    -------
    float
        The time of the first step with a larger difference, or the end if there is none.

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism, simulate
    >>> file = "datasets/slider_crank.toml"
    >>> runs = [simulate(read_mechanism(file, tolerance=t), revolutions=2) for t in (1e-8, 1e-9)]
    >>> horizon(*runs)
    2.0
    """
    time = run.time[run.time <= other.time[-1]]
    apart = np.hypot(*(run.eccentricity[: time.size] - other.eccentricity_at(time)).T)
    parted = apart > share * run.mechanism.joint.radial * 1e-3
    return float(run.revolution[np.argmax(parted)] if parted.any() else run.revolution[-1])


@dataclass(frozen=True)
class Case:
    """What varies in a sweep: law, clearance in mm, restitution, friction. None: the file's."""

    law: str | None = None
    clearance: float | None = None
    restitution: float | None = None
    friction: float | None = None


def cases(
    laws: Iterable[str | None],
    clearances: Iterable[float | None],
    restitutions: Iterable[float | None],
    frictions: Iterable[float | None],
) -> list[Case]:
    """Return all combinations of laws, clearances, restitutions and frictions.

    Examples
    --------
    >>> [case.friction for case in cases(["johnson"], [0.5], [0.9], [0.0, 0.1])]
    [0.0, 0.1]
    """
    return [Case(*case) for case in itertools.product(laws, clearances, restitutions, frictions)]


def sweep(
    mechanism: SliderCrank,
    wanted: Iterable[Case],
    revolutions: int,
    first: int | None = None,
    beyond: Beyond = "stop",
    workers: Workers = 1,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Simulate cases of a slider-crank, in parallel.

    Parameters
    ----------
    mechanism : SliderCrank
        What all cases have in common.
    wanted : iterable of Case
        See `cases`.
    revolutions, first, beyond
        As in `long_run`.
    workers : int or Cluster
        How many processes, or where to run.
    progress : callable, optional
        Called with a stage, the cases done and their number.

    Returns
    -------
    DataFrame
        A row for each case: `law`, `clearance_mm`, `restitution`, `friction`; the first and the
        last revolution that count, from 1; the mean of every quantity of `Statistics.interval` and
        half its 95 % interval (`_half_width`); the `period`; the δ̇⁽⁻⁾ of a contact that lasts
        (`carried_m_per_s`); the largest error of the energy balance since the start
        (`energy_error_J`) at the `tolerance` of the integrator; and `message`, on a law that was
        continued or, where the numbers are missing, why the run has stopped.

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism
    >>> crank = read_mechanism("datasets/slider_crank.toml")
    >>> table = sweep(crank, cases(["enhanced"], [0.02], [0.9], [0.0]), revolutions=1)
    >>> print(table[["law", "clearance_mm", "impacts"]].to_string(index=False))
         law  clearance_mm  impacts
    enhanced          0.02      6.0
    """
    import pandas as pd

    mechanisms = [mechanism.changed(**asdict(case)) for case in wanted]
    calls = [call(_row, changed, revolutions, first, beyond) for changed in mechanisms]
    return pd.DataFrame(collect(calls, workers, progress, "cases"))


def _row(
    mechanism: SliderCrank, revolutions: int, first: int | None, beyond: Beyond
) -> dict[str, Any]:
    """Simulate one case and return its row of the table."""
    joint = mechanism.joint
    row: dict[str, Any] = {
        "law": joint.data["law"],
        "clearance_mm": joint.radial,
        "restitution": joint.data["dissipation"]["restitution"],
        "friction": joint.friction,
    }
    try:
        statistics = long_run(mechanism, revolutions, first, beyond)
    except InputError as error:
        return row | {"tolerance": mechanism.spec.tolerance, "message": str(error)}
    row |= {"first_revolution": statistics.first + 1, "last_revolution": revolutions}
    for name, numbers in statistics.interval().iterrows():
        row |= {str(name): numbers["mean"], f"{name}_half_width": numbers["half_width"]}
    return row | {
        "period": statistics.period,
        "carried_m_per_s": statistics.carried,
        "energy_error_J": float(statistics.revolutions["energy_error_J"].abs().max()),
        "tolerance": mechanism.spec.tolerance,
        "message": statistics.continuation,
    }
