"""All cases of a study by either engine, in parallel, each kept as it is done."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal

from threadpoolctl import threadpool_limits

from cylcontact.datasets.finite_element import calculix
from cylcontact.datasets.finite_element.cases import Case
from cylcontact.datasets.finite_element.kept import Kept, Row
from cylcontact.datasets.finite_element.setup import Setup
from cylcontact.datasets.finite_element.solve import solve
from cylcontact.datasets.finite_element.spec import Study
from cylcontact.errors import InputError
from cylcontact.parallel import call, run_calls

Engine = Literal["embedded", "calculix"]
ENGINES: tuple[Engine, ...] = ("embedded", "calculix")
# The stage, what is done of it, and how much there is.
Progress = Callable[[str, int, int], None]


@dataclass(frozen=True)
class Failure:
    """Cases that an engine could not solve.

    Attributes
    ----------
    variant : str
        The set-up's name in its study.
    dR : float
        Clearance in mm.
    loads : tuple of float
        In N/mm.
    reason : str
        What happened.
    lines : tuple of str
        The solver's last lines, where it printed any.
    """

    variant: str
    dR: float
    loads: tuple[float, ...]
    reason: str
    lines: tuple[str, ...] = ()

    def __str__(self) -> str:
        loads = ", ".join(f"{load:g}" for load in self.loads)
        head = f"{self.variant}, ΔR = {self.dR:g} mm, {loads} N/mm: {self.reason}"
        return "\n    ".join([head, *self.lines])


@dataclass(frozen=True)
class _Task:
    """What one worker does at a time: one factorisation, or one run of CalculiX."""

    variant: str
    setup: Setup
    dR: float
    loads: tuple[float, ...]


def engine_name(engine: Engine) -> str:
    """Return the engine with its version, as tables record it.

    Raises
    ------
    InputError
        If it is CalculiX and not installed.
    """
    if engine == "calculix":
        return f"CalculiX {calculix.version(calculix.find_program())}"
    from importlib.metadata import version

    return f"embedded (scikit-fem {version('scikit-fem')})"


def run_study(
    study: Study,
    engine: Engine = "embedded",
    jobs: int = 1,
    progress: Progress = lambda *_: None,
    kept: Path | None = None,
    resume: bool = False,
) -> tuple[list[Row], list[Failure]]:
    """Solve every case of a study.

    Parameters
    ----------
    study : Study
        From `read_study`.
    engine : {"embedded", "calculix"}
        What solves them.
    jobs : int
        Worker processes; the result does not depend on it.
    progress : callable, optional
        Called with the stage, the number of cases done and their total.
    kept : path, optional
        Where finished cases are kept; removed by the caller, once it has saved the table.
    resume : bool
        Whether to take up the cases kept there.

    Returns
    -------
    rows : list of Row
        The solved cases, in the order of variants, clearances and loads.
    failures : list of Failure
        The others.

    Raises
    ------
    InputError
        If CalculiX is asked for and not installed, or the kept cases are of another study.
    """
    program = calculix.find_program() if engine == "calculix" else ""
    keeper = Kept(kept, f"{study.key} {engine_name(engine)}") if kept is not None else None
    rows = keeper.load() if keeper and resume else []
    if keeper and not resume:
        keeper.start()
    done = {row.place for row in rows}
    tasks = [
        task for task in _tasks(study, engine) if (task.variant, task.dR, task.loads[0]) not in done
    ]
    total = len(study.setups) * len(study.dR) * len(study.load)
    failures: list[Failure] = []
    progress("solving", len(rows), total)
    # An interruption ends the workers, which cannot remove what they have written then.
    with TemporaryDirectory(prefix="cylcontact-", ignore_cleanup_errors=True) as scratch:
        calls = [call(_solve_task, task, study.load, program, scratch) for task in tasks]
        with closing(run_calls(calls, jobs, ordered=False)) as found:
            for solved in found:
                if isinstance(solved, Failure):
                    failures.append(solved)
                    continue
                rows += solved
                if keeper:
                    keeper.add(solved)
                progress("solving", len(rows), total)
    places = {name: number for number, name in enumerate(study.setups)}
    return (
        sorted(rows, key=lambda row: (places[row.variant], row.case.dR, row.case.load)),
        sorted(failures, key=lambda failure: (places[failure.variant], failure.dR, failure.loads)),
    )


def _tasks(study: Study, engine: Engine) -> list[_Task]:
    """Return the study's tasks: all loads of a geometry together where it is factorised once."""
    apart = [(load,) for load in study.load]
    groups = [study.load] if engine == "embedded" else apart
    return [
        _Task(variant, setup, dR, group)
        for variant, setup in study.setups.items()
        for dR in study.dR
        for group in groups
    ]


def _solve_task(
    task: _Task, loads: tuple[float, ...], program: str, scratch: str
) -> list[Row] | Failure:
    """Solve one task in a worker."""
    import numpy as np

    try:
        if program:
            found = [
                calculix.run_case(task.setup, task.dR, load, np.array(loads), program, scratch)
                for load in task.loads
            ]
        else:
            with threadpool_limits(limits=1):
                solved = solve(task.setup, task.dR, task.loads)
            found = [
                Case(s.dR, s.load, s.penetration, s.half_width, s.peak_pressure, s.mesh.cells)
                for s in solved
            ]
    except calculix.SolverError as failure:
        reason = f"CalculiX {failure.reason}"
        return Failure(task.variant, task.dR, task.loads, reason, failure.lines)
    except InputError as error:
        return Failure(task.variant, task.dR, task.loads, f"{error.rule}; {error.remedy}")
    return [Row(task.variant, task.setup, case) for case in found]
