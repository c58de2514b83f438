"""All cases of a study by either engine, in parallel, each recorded as it is solved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import partial
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
from cylcontact.parallel import call, run_recorded
from cylcontact.progress import Progress, silent

__all__ = ["Failure", "engine_name", "run_study"]

# A case in its study: variant, clearance in mm and load in N/mm.
_Place = tuple[str, float, float]


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

    @property
    def places(self) -> tuple[_Place, ...]:
        """The cases by variant, clearance in mm and load in N/mm."""
        return tuple((self.variant, self.dR, load) for load in self.loads)


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
    # An interruption ends the workers, which cannot remove what they have written then.
    with TemporaryDirectory(ignore_cleanup_errors=True) as scratch:
        calls = {
            task.places: call(_solve_task, task, study.load, program, Path(scratch))
            for task in _tasks(study, engine)
        }
        solved = run_recorded(
            calls, journal, _row_from, _entry, resume, jobs, partial(progress, "solving")
        )
    failures = (result for result in solved.values() if isinstance(result, Failure))
    return (
        [result for result in solved.values() if isinstance(result, Row)],
        list(dict.fromkeys(failures)),  # each is that of all cases of a task
    )


def _row_from(entry: dict[str, Any]) -> tuple[_Place, Row | Failure]:
    """Return the place and the row that a journal entry records."""
    row = Row(entry["variant"], Setup(**entry["setup"]), Case(**entry["case"]))
    return row.place, row


def _entry(_: _Place, solved: Row | Failure) -> dict[str, Any] | None:
    """Return the journal entry that records a row; None for a failure."""
    return asdict(solved) if isinstance(solved, Row) else None


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
    task: _Task, loads: tuple[float, ...], program: str, scratch: Path
) -> Mapping[_Place, Row | Failure]:
    """Solve one task in a worker and return what came of each case."""
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
        failed = Failure(task.variant, task.dR, task.loads, reason, failure.lines)
    except InputError as error:
        failed = Failure(task.variant, task.dR, task.loads, f"{error.rule}; {error.remedy}")
    else:
        rows = [Row(task.variant, task.setup, case) for case in cases]
        return {row.place: row for row in rows}
    return dict.fromkeys(task.places, failed)
