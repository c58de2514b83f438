"""All cases of a study by either engine, in parallel, each recorded as it is solved."""

from __future__ import annotations

from contextlib import closing
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from threadpoolctl import threadpool_limits

from cylcontact.choices import Engine
from cylcontact.datasets.finite_element import calculix
from cylcontact.datasets.finite_element.cases import Case, Row
from cylcontact.datasets.finite_element.setup import Setup
from cylcontact.datasets.finite_element.solve import solve
from cylcontact.datasets.finite_element.spec import Study
from cylcontact.errors import InputError
from cylcontact.journal import Journal
from cylcontact.parallel import call, run_calls
from cylcontact.progress import Progress, silent

__all__ = ["Failure", "engine_name", "run_study"]


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
    progress: Progress = silent,
    checkpoint: Path | None = None,
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
    checkpoint : path, optional
        The journal of solved cases; the caller removes it once the table is saved.
    resume : bool
        Whether to take the cases already in `checkpoint` from there.

    Returns
    -------
    rows : list of Row
        The solved cases, in the order of variants, clearances and loads.
    failures : list of Failure
        The others.

    Raises
    ------
    InputError
        If CalculiX is asked for and not installed, or `checkpoint` belongs to another study.
    """
    program = calculix.find_program() if engine == "calculix" else ""
    journal = (
        Journal(checkpoint, "study", f"{study.key} {engine_name(engine)}") if checkpoint else None
    )
    recorded = journal.load(_row_from) if journal and resume else []
    if journal and not resume:
        journal.start()
    rows = {row.place: row for row in recorded}
    tasks = [
        task
        for task in _tasks(study, engine)
        if any((task.variant, task.dR, load) not in rows for load in task.loads)
    ]
    total = len(study.setups) * len(study.dR) * len(study.load)
    failures: list[Failure] = []
    progress("solving", len(rows), total)
    # An interruption ends the workers, which cannot remove what they have written then.
    with TemporaryDirectory(prefix="cylcontact-", ignore_cleanup_errors=True) as scratch:
        calls = [call(_solve_task, task, study.load, program, scratch) for task in tasks]
        with closing(run_calls(calls, jobs, ordered=False)) as results:
            for solved in results:
                if isinstance(solved, Failure):
                    failures.append(solved)
                    continue
                rows |= {row.place: row for row in solved}
                if journal:
                    journal.add(*map(asdict, solved))
                progress("solving", len(rows), total)
    places = {name: number for number, name in enumerate(study.setups)}
    return (
        sorted(rows.values(), key=lambda row: (places[row.variant], row.case.dR, row.case.load)),
        sorted(failures, key=lambda failure: (places[failure.variant], failure.dR, failure.loads)),
    )


def _row_from(entry: dict[str, Any]) -> Row:
    """Return the row that a journal entry records."""
    return Row(entry["variant"], Setup(**entry["setup"]), Case(**entry["case"]))


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
            cases = [
                calculix.run_case(task.setup, task.dR, load, np.array(loads), program, scratch)
                for load in task.loads
            ]
        else:
            with threadpool_limits(limits=1):
                solved = solve(task.setup, task.dR, task.loads)
            cases = [
                Case(s.dR, s.load, s.penetration, s.half_width, s.peak_pressure, s.mesh.cells)
                for s in solved
            ]
    except calculix.SolverError as failure:
        reason = f"CalculiX {failure.reason}"
        return Failure(task.variant, task.dR, task.loads, reason, failure.lines)
    except InputError as error:
        return Failure(task.variant, task.dR, task.loads, f"{error.rule}; {error.remedy}")
    return [Row(task.variant, task.setup, case) for case in cases]
