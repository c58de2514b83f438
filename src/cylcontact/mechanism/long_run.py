"""Runs of many revolutions, each reduced to a row of numbers and then dropped."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd

from cylcontact.arrays import require
from cylcontact.choices import Beyond, Method
from cylcontact.mechanism.loop import one_row
from cylcontact.mechanism.model import Mechanism
from cylcontact.mechanism.simulate import Interrupted, begin, one_revolution, settings_for
from cylcontact.mechanism.statistics import Statistics
from cylcontact.mechanism.step_history import concatenate
from cylcontact.mechanism.trajectory import Trajectory
from cylcontact.progress import Progress, silent

__all__ = ["FIRST", "first_of", "long_run"]

# Revolutions left out at the start of a run, unless it is short: then a fifth of it.
FIRST = 10


def first_of(revolutions: int) -> int:
    """Return the number of revolutions that statistics leave out by default.

    Examples
    --------
    >>> [first_of(n) for n in (1000, 10, 3)]
    [10, 2, 0]
    """
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
    if resume is None:
        settings = settings_for(mechanism, method, tolerance, beyond, allowed_penetration)
    else:
        mechanism, settings = resume.mechanism, resume.settings
    first = first_of(revolutions) if first is None else first
    require(
        0 <= first < max(revolutions, 1), "long_run", "first", first,
        f"leaves none of {revolutions} revolutions", "start earlier, or simulate more revolutions",
    )  # fmt: skip
    run = begin(mechanism, settings, revolutions)
    block = run.system.block.copy()
    last = one_row(run.state, 0)
    start = Trajectory(mechanism, settings, last, block)
    origin, limits = float(start.energy[0]), start.limits
    records: list[Mapping[Any, Any]] = []
    if resume is not None:
        records = [*resume.revolutions.to_dict("records")]
        run.state = resume.end
        last = one_row(run.state, 0)
    end = run.state

    def gathered(first: int) -> Statistics:
        table = pd.DataFrame(records, pd.RangeIndex(len(records), name="revolution"))
        return Statistics(table, mechanism, settings, end, limits, first)

    try:
        for index in range(len(records), revolutions):
            progress("revolutions", index, revolutions)
            steps = concatenate([last, one_revolution(run, index, mechanism.period)])
            part = Trajectory(mechanism, settings, steps, block)
            records.append(part.reduced(origin, limits))
            last, end = steps.taken(slice(-1, None), 1), part.end
    except KeyboardInterrupt:
        complete = gathered(min(first, len(records) - 1)) if records else None
        raise Interrupted(statistics=complete) from None
    progress("revolutions", revolutions, revolutions)
    return gathered(first)
