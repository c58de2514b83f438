"""The command `simulate`: one run, a film, or a study of many runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cylcontact import choices
from cylcontact.arrays import require
from cylcontact.choices import BEYOND, FILM_SUFFIXES, METHODS, OUTPUT_SUFFIXES, STUDIES, listed
from cylcontact.cli.options import (
    NUMBER,
    Jobs,
    Materials,
    Resume,
    Scheduler,
    expand_options,
    integer_from,
    numbers,
    require_taken,
    resumable,
    split,
)
from cylcontact.cli.terminal import noting, progress_bars, say, workers
from cylcontact.errors import InputError
from cylcontact.files import require_suffix, require_writable, write_table

if TYPE_CHECKING:
    import pandas as pd

    from cylcontact.mechanism import Case, Mechanism, Settings, Statistics, Trajectory

_PANEL = "For a study"
# The tolerances of a study of them, if none is given.
TOLERANCES = (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)


def _count(least: int, help: str, panel: str | None = None) -> Any:
    """Return an option for an integer of at least `least`."""
    parser = integer_from(least)
    return typer.Option(parser=parser, metavar="INTEGER", help=help, rich_help_panel=panel)


def _list(help: str, panel: str | None = None) -> Any:
    """Return an option for numbers, of which a study takes several."""
    return typer.Option(callback=split, metavar="NUMBER[,...]", help=help, rich_help_panel=panel)


@dataclass(frozen=True)
class Changes:
    """Options that replace values of a mechanism's spec, one each or in a study several."""

    law: Annotated[
        list[str] | None,
        typer.Option(
            callback=split, metavar="NAME[,...]", help="The law, e.g. johnson; several in a study."
        ),
    ] = None
    clearance: Annotated[list[str] | None, _list("Radial clearance, mm.")] = None
    restitution: Annotated[list[str] | None, _list("Restitution, above 0 up to 1.")] = None
    friction: Annotated[list[str] | None, _list("Friction coefficient.")] = None
    materials: Materials = None

    def several(self) -> dict[str, list[Any]]:
        """Return the values of each."""
        return {
            name: texts or [] if name == "law" else numbers(f"--{name}", texts)
            for name, texts in asdict(self).items()
            if name != "materials"
        }

    def single(self, *but: str) -> dict[str, Any]:
        """Return one value or None of each except `but`; refuse several."""
        return {
            name: _one(name, values) for name, values in self.several().items() if name not in but
        }


@dataclass(frozen=True)
class Options:
    """Options that only some ways to simulate take; None or False if not given."""

    first: Annotated[int | None, _count(0, "First revolution that counts or is shown, from 0.")] = (
        None
    )
    method: Annotated[
        choices.Method | None,
        typer.Option(
            parser=str,
            metavar="METHOD",
            help=f"{listed(METHODS)}; the first is the faster, and taken if it fits.",
        ),
    ] = None
    tolerance: Annotated[
        list[str] | None, _list("Tolerance of the integrator; the spec's by default.")
    ] = None
    beyond: Annotated[
        choices.Beyond | None,
        typer.Option(
            parser=str,
            metavar="WHAT",
            help=f"Where the contact law ends: {listed(BEYOND)} (go on along it); stop by default.",
        ),
    ] = None
    allowed_penetration: Annotated[
        float | None,
        typer.Option(help="The paper's step control: how deep contact may begin, µm.", **NUMBER),
    ] = None
    table: Annotated[
        Path | None, typer.Option(help="Write the numbers by revolution to this .csv or .parquet.")
    ] = None
    resume: Resume = False
    against: Annotated[
        float | None,
        typer.Option(
            help="Cases: run at this tolerance too; count only revolutions after the two separate.",
            **NUMBER,
            rich_help_panel=_PANEL,
        ),
    ] = None
    points: Annotated[
        int | None, _count(1, "Bifurcation: how many clearances; 40 by default.", _PANEL)
    ] = None
    last: Annotated[
        int | None, _count(1, "Bifurcation: revolutions recorded of each; 50 by default.", _PANEL)
    ] = None
    impact_rate: Annotated[
        list[str] | None,
        _list(
            "Bifurcation: impact rate δ̇⁽⁻⁾ of the damping, m/s; 0, the default: that at onset.",
            _PANEL,
        ),
    ] = None
    jobs: Jobs = None
    scheduler: Scheduler = None

    def integration(self) -> dict[str, Any]:
        """Return the options of one integration."""
        tolerance = _one("tolerance", numbers("--tolerance", self.tolerance))
        return {"method": self.method, "tolerance": tolerance, "beyond": self.beyond or "stop"}


def _one(name: str, values: list[Any]) -> Any:
    """Return the value of an option, None if it is not given; refuse several."""
    if len(values) > 1:
        text = ",".join(str(value) for value in values)
        remedy = "give one, or vary it with --study cases"
        raise InputError("simulate", f"--{name}", text, "must be one value", remedy)
    return values[0] if values else None


@expand_options
def simulate(
    spec: Annotated[
        Path, typer.Argument(help="A mechanism's spec, e.g. datasets/slider_crank.toml.")
    ],
    *,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            help="The trajectory (.parquet), the film (.gif, .mp4), or the table of a study.",
        ),
    ] = None,
    study: Annotated[
        str | None,
        typer.Option(
            metavar="STUDY",
            help=f"{listed(STUDIES)}, over values separated by commas, into one table.",
            rich_help_panel=_PANEL,
        ),
    ] = None,
    changes: Changes,
    revolutions: Annotated[
        int | None,
        _count(
            1,
            "Revolutions in all; by default the spec's, one shown of a film, 200 for bifurcation.",
        ),
    ] = None,
    options: Options,
) -> None:
    """Simulate a mechanism with a clearance joint: its statistics, a film, or a study."""
    if study is None:
        way = "a film" if out is not None and out.suffix in FILM_SUFFIXES else "one run"
    else:
        if study not in STUDIES:
            remedy = f"choose {listed(STUDIES)}"
            raise InputError("simulate", "--study", study, "is unknown", remedy)
        if out is None:
            rule, remedy = "is missing for a study", "name the table, e.g. -o cases.csv"
            raise InputError("simulate", "--out", None, rule, remedy)
        require_suffix(out, *OUTPUT_SUFFIXES)
        require_writable(out)
        way = f"--study {study}"
    run, takes = _WAYS[way][0], {name: names for name, (_, names) in _WAYS.items()}
    require_taken("simulate", way, takes, asdict(options))
    run(spec, changes, revolutions, options, out)


def _one_run(
    spec: Path, changes: Changes, revolutions: int | None, options: Options, out: Path | None
) -> None:
    """Simulate once and print the statistics.

    Without an output the steps are not kept, and memory does not grow with the revolutions.
    """
    from cylcontact.mechanism import read_mechanism
    from cylcontact.mechanism.run import settings_for
    from cylcontact.mechanism.study import agreement, first_of

    mechanism = read_mechanism(spec, changes.materials, **changes.single())
    table = options.table
    if out is not None:
        require_suffix(out, ".parquet", *FILM_SUFFIXES)
    if table is not None:
        require_suffix(table, *OUTPUT_SUFFIXES)
    depth = options.allowed_penetration
    allowed = None if depth is None else depth * 1e-6
    settings = settings_for(mechanism, **options.integration(), allowed_penetration=allowed)
    total = revolutions or mechanism.integration.revolutions
    first = first_of(total) if options.first is None else options.first
    _require_left(first, total)
    require_writable(*filter(None, (out, table)))
    if out is None:
        require(
            not options.resume, "simulate", "--resume", None, "needs a file to go on from",
            "name it: -o",
        )  # fmt: skip
        statistics = _statistics(mechanism, settings, total, first)
    else:
        run = _run(mechanism, settings, total, out, options.resume)
        run.save(out)
        statistics = run.statistics(first)
    if table is not None:
        write_table(statistics.by_revolution.reset_index(), table)
    say(statistics.to_text())
    for path in (out, table):
        if path is not None:
            typer.echo()
            say(f"written to {path}")
    if mechanism.clearances:
        typer.echo()
        say(agreement(mechanism, settings, total))
    for warning in (*mechanism.warnings, *statistics.warnings):
        say(f"warning: {warning}", err=True)


def _require_left(first: int, total: int) -> None:
    """Refuse a first revolution beyond the last."""
    require(
        first < total, "simulate", "--first", first, f"leaves none of {total} revolutions",
        "start earlier, or simulate more",
    )  # fmt: skip


def _statistics(
    mechanism: Mechanism, settings: Settings, revolutions: int, first: int
) -> Statistics:
    """Simulate without keeping the steps; print what an interrupted run has given."""
    from cylcontact.mechanism import Interrupted, long_run

    try:
        with progress_bars() as progress:
            return long_run(
                mechanism, revolutions, first, settings.method, settings.tolerance,
                settings.beyond, progress, allowed_penetration=settings.allowed_penetration,
            )  # fmt: skip
    except Interrupted as interruption:
        if interruption.statistics is None:
            raise KeyboardInterrupt from None
        say(interruption.statistics.to_text())
        count = len(interruption.statistics.revolutions)
        raise KeyboardInterrupt(
            f"interrupted; these are the numbers of {count} complete revolutions"
        ) from None


def _earlier(mechanism: Mechanism, settings: Settings, out: Path) -> Trajectory | None:
    """Return the run to resume, if any; refuse one of another mechanism or other options."""
    from cylcontact.mechanism import Trajectory

    if not out.exists():
        return None
    earlier = Trajectory.load(out)
    if (earlier.mechanism.data, earlier.settings) != (mechanism.data, settings):
        raise InputError(
            str(out), "", None, "is of another mechanism or other options",
            "restore them, or run without --resume to start anew",
        )  # fmt: skip
    return earlier


def _run(
    mechanism: Mechanism, settings: Settings, revolutions: int, out: Path, resume: bool
) -> Trajectory:
    """Simulate; save the complete revolutions of a run that is interrupted, or cannot go on."""
    from cylcontact.mechanism import Interrupted, RunError
    from cylcontact.mechanism import simulate as run

    earlier = _earlier(mechanism, settings, out) if resume else None
    anew = resume and earlier is None
    note = f"there is no {out} yet; the run starts anew" if anew else ""
    try:
        with progress_bars() as bars:
            return run(
                mechanism, settings.method, revolutions, settings.tolerance, settings.beyond,
                noting(bars, "revolutions", note), earlier, settings.allowed_penetration,
            )  # fmt: skip
    except Interrupted as interruption:
        if interruption.trajectory is None:
            raise KeyboardInterrupt from None
        interruption.trajectory.save(out)
        count = interruption.trajectory.revolutions
        raise KeyboardInterrupt(
            f"interrupted; complete revolutions kept in {out}: {count}; "
            "the same command with --resume goes on from there"
        ) from None
    except RunError as error:
        if error.trajectory is None:
            raise
        error.trajectory.save(out)
        kept = f"; complete revolutions kept in {out}: {error.trajectory.revolutions}"
        raise InputError(
            error.source, error.key, error.value, error.rule, error.remedy + kept
        ) from error


def _film(
    spec: Path, changes: Changes, revolutions: int | None, options: Options, out: Path
) -> None:
    """Film a mechanism, the journal magnified beside it; by default its third revolution."""
    from cylcontact.mechanism import read_mechanism
    from cylcontact.mechanism import simulate as run
    from cylcontact.mechanism.drawing import film, require_film

    first = 2 if options.first is None else options.first
    total = revolutions or first + 1
    _require_left(first, total)
    require_film(out)
    require_writable(out)
    mechanism = read_mechanism(spec, changes.materials, **changes.single())
    with progress_bars() as progress:
        trajectory = run(mechanism, revolutions=total, progress=progress, **options.integration())
        frames = film(trajectory, out, first, progress)
    say(f"{frames} frames in {out}; assumed: {'; '.join(trajectory.assumptions)}")


def _cases(
    spec: Path, changes: Changes, revolutions: int | None, options: Options, out: Path
) -> None:
    """Simulate every combination of the changes into one table."""
    from cylcontact.mechanism import Plan, read_mechanism, sweep
    from cylcontact.mechanism.study import first_of

    mechanism = read_mechanism(spec, changes.materials)
    total = revolutions or mechanism.integration.revolutions
    first = first_of(total) if options.first is None else options.first
    plan = Plan(total, first, **options.integration(), against=options.against)
    where = workers(options.jobs, options.scheduler)
    with resumable(out, "case") as journal:
        with progress_bars() as progress:
            wanted = _combinations(changes)
            table = sweep(mechanism, wanted, plan, where, progress, journal, options.resume)
        write_table(table, out)
    stopped = table[table["status"] != "complete"]
    say(f"{out}: {len(table)} cases, {len(stopped)} of them stopped")
    if len(stopped):
        counted = f"{len(stopped)} of {len(table)} cases stopped"
        say(f"cylcontact: {counted}; first: {stopped['message'].iloc[0]}", err=True)
        raise typer.Exit(1)


def _combinations(changes: Changes) -> list[Case]:
    """Return every combination of the changes; the spec's value of what is not given."""
    from cylcontact.mechanism import cases

    return cases(*(values or [None] for values in changes.several().values()))


def _tolerances(
    spec: Path, changes: Changes, revolutions: int | None, options: Options, out: Path
) -> None:
    """Tabulate energy balance and drift by tolerance over the cases, in both forms."""
    from cylcontact.mechanism import Plan, read_mechanism
    from cylcontact.mechanism import tolerances as tabulate

    mechanism = read_mechanism(spec, changes.materials)
    total = revolutions or mechanism.integration.revolutions
    wanted, where = _combinations(changes), workers(options.jobs, options.scheduler)
    methods = METHODS if mechanism.slider_crank is not None else METHODS[1:]
    plans = [
        Plan(total, method=method, tolerance=value, beyond="tangent")
        for method in methods
        for value in numbers("--tolerance", options.tolerance) or TOLERANCES
    ]
    with progress_bars() as progress:
        table = tabulate(mechanism, wanted, plans, where, progress)
    write_table(table, out)
    say(table.to_string(float_format="{:.3g}".format, na_rep="-", index=False))
    missing = len(wanted) * len(table) - int(table["cases"].sum())
    if missing:
        total = len(wanted) * len(table)
        say(f"cylcontact: {missing} of {total} cases stopped, and do not count", err=True)
        raise typer.Exit(1)


def _bifurcation(
    spec: Path, changes: Changes, revolutions: int | None, options: Options, out: Path
) -> None:
    """Tabulate the Poincaré sections over the clearance: periodic or not."""
    import numpy as np
    import pandas as pd

    from cylcontact.mechanism import bifurcation, read_mechanism

    mechanism = read_mechanism(spec, changes.materials, **changes.single("clearance"))
    ends = numbers("--clearance", changes.clearance) or [0.01, 0.5]
    require(
        len(ends) == 2 and min(ends) > 0, "--clearance", "", ",".join(changes.clearance or ()),
        "must be two positive numbers, the smallest and the largest", "e.g. 0.01,0.5",
    )  # fmt: skip
    spaced = np.geomspace(ends[0], ends[1], options.points or 40)
    values = [float(f"{value:.4g}") for value in spaced]
    where = workers(options.jobs, options.scheduler)
    last, beyond = options.last or 50, options.beyond or "stop"
    with progress_bars() as progress:
        tables = [
            bifurcation(
                mechanism, values, revolutions or 200, last, rate or None, beyond, where, progress
            )
            for rate in numbers("--impact-rate", options.impact_rate) or [0.0]
        ]
    table = pd.concat(tables, ignore_index=True)
    write_table(table, out)
    say(f"{out}: {_periods(table)}")


def _periods(table: pd.DataFrame) -> str:
    """Return in words how many runs have which period."""
    periods = table.drop_duplicates(["clearance_mm", "held_m_per_s"])["period"]
    counts = {
        f"of period {period:g}" if period else "of no period up to 8": int(
            (periods == period).sum()
        )
        for period in sorted(periods.dropna().unique())
    }
    counts["too short to tell"] = int(periods.isna().sum())
    texts = ", ".join(f"{count} {what}" for what, count in counts.items() if count)
    return f"{len(periods)} runs, {texts}"


# Each way to simulate: what does it, and what it takes of `Options`.
_INTEGRATION = ("first", "method", "tolerance", "beyond")
_WAYS: dict[str, tuple[Callable[..., None], tuple[str, ...]]] = {
    "one run": (_one_run, (*_INTEGRATION, "allowed_penetration", "table", "resume")),
    "a film": (_film, _INTEGRATION),
    "--study cases": (_cases, (*_INTEGRATION, "against", "resume", "jobs", "scheduler")),
    "--study tolerances": (_tolerances, ("tolerance", "jobs", "scheduler")),
    "--study bifurcation": (
        _bifurcation,
        ("beyond", "points", "last", "impact_rate", "jobs", "scheduler"),
    ),
}
