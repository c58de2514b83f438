"""The commands `simulate`, `sweep`, `bifurcation` and `tolerances`."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import nullcontext
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cylcontact import choices
from cylcontact.arrays import require
from cylcontact.choices import BEYOND, METHODS, OUTPUT_SUFFIXES, listed
from cylcontact.cli.options import Jobs, Scheduler, expand_options, integer_from, resumable
from cylcontact.cli.terminal import progress_bars, workers
from cylcontact.errors import InputError
from cylcontact.files import owning, require_suffix, write_table

if TYPE_CHECKING:
    from cylcontact.mechanism import Mechanism, Settings, Statistics, Trajectory

__all__ = [
    "PAPER",
    "Changes",
    "Integration",
    "SpecFile",
    "bifurcation",
    "simulate",
    "sweep",
    "tolerances",
]

# The cases of Sect. 4.3: laws, clearances in mm, restitutions, friction coefficients.
PAPER = (
    ("lankarani-nikravesh", "johnson", "enhanced"),
    (0.5, 0.02),
    (1.0, 0.9),
    (0.0, 0.1),
)


def _joined(values: Iterable[object]) -> str:
    """Return values separated by commas."""
    return ",".join(f"{value}" for value in values)


SpecFile = Annotated[
    Path, typer.Argument(help="A mechanism's spec, e.g. datasets/slider_crank.toml.")
]
_Revolutions = Annotated[
    int | None,
    typer.Option(
        parser=integer_from(1), metavar="INTEGER", help="Revolutions in all; the spec's by default."
    ),
]
TableFile = Annotated[
    Path, typer.Option("-o", "--out", help="The .csv or .parquet table to write.")
]


@dataclass(frozen=True)
class Changes:
    """Options that replace values of a mechanism's spec; None leaves one as it is."""

    law: Annotated[str | None, typer.Option(help="A contact law, e.g. johnson.")] = None
    clearance: Annotated[float | None, typer.Option(help="Radial clearance, mm.")] = None
    restitution: Annotated[float | None, typer.Option(help="Restitution, (0, 1].")] = None
    friction: Annotated[float | None, typer.Option(help="Friction coefficient.")] = None


@dataclass(frozen=True)
class Losses:
    """The changes of a spec but for the clearance."""

    law: Annotated[str | None, typer.Option(help="A contact law, e.g. johnson.")] = None
    restitution: Annotated[float | None, typer.Option(help="Restitution, (0, 1].")] = None
    friction: Annotated[float | None, typer.Option(help="Friction coefficient.")] = None


Beyond = Annotated[
    choices.Beyond,
    typer.Option(
        parser=str,
        metavar="WHAT",
        help=f"Where the contact law ends: {listed(BEYOND)} (go on along it).",
    ),
]


@dataclass(frozen=True)
class Integration:
    """Options of the integration; None for the spec's."""

    method: Annotated[
        choices.Method | None,
        typer.Option(
            parser=str,
            metavar="METHOD",
            help=f"{listed(METHODS)}; the first is the faster, and taken if it fits.",
        ),
    ] = None
    tolerance: Annotated[
        float | None, typer.Option(help="Of the integrator; the spec's by default.")
    ] = None
    beyond: Beyond = "stop"


@expand_options
def simulate(
    spec: SpecFile,
    *,
    changes: Changes,
    revolutions: _Revolutions = None,
    integration: Integration,
    allowed_penetration: Annotated[
        float | None,
        typer.Option(help="The paper's step control: how deep contact may begin, µm."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Write the trajectory to this .parquet.")
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on from what --out holds, with its settings.")
    ] = False,
    first: Annotated[
        int | None,
        typer.Option(
            parser=integer_from(0),
            metavar="INTEGER",
            help="First revolution that counts, from 0; by default 10, and a fifth of a short run.",
        ),
    ] = None,
    table: Annotated[
        Path | None, typer.Option(help="Write the numbers by revolution to this .csv or .parquet.")
    ] = None,
) -> None:
    """Simulate a mechanism with a clearance joint, and print its statistics.

    Without --out the steps are not kept, and memory does not grow with the revolutions.
    """
    from cylcontact.mechanism import read_mechanism
    from cylcontact.mechanism.long_run import first_of
    from cylcontact.mechanism.simulate import settings_for
    from cylcontact.mechanism.studies import agreement

    mechanism = read_mechanism(spec, **asdict(changes))
    if out is not None:
        require_suffix(out, ".parquet")
    if table is not None:
        require_suffix(table, *OUTPUT_SUFFIXES)
    allowed = None if allowed_penetration is None else allowed_penetration * 1e-6
    settings = settings_for(mechanism, **asdict(integration), allowed_penetration=allowed)
    total = revolutions or mechanism.integration.revolutions
    first = first_of(total) if first is None else first
    require(
        first < total, "simulate", "--first", first, f"leaves none of {total} revolutions",
        "start earlier, or simulate more",
    )  # fmt: skip
    with owning(out) if out else nullcontext(), owning(table) if table else nullcontext():
        if out is None:
            require(
                not resume, "simulate", "--resume", None, "needs a file to go on from",
                "name it: -o",
            )  # fmt: skip
            statistics = _statistics(mechanism, settings, total, first)
        else:
            statistics = _kept(mechanism, settings, total, out, resume).statistics(first)
        if table is not None:
            write_table(statistics.by_revolution.reset_index(), table)
    typer.echo(statistics.to_text(), nl=False)
    for path in (out, table):
        if path is not None:
            typer.echo(f"\nwritten to {path}")
    if not mechanism.ideal:
        typer.echo(f"\n{agreement(mechanism, settings, total)}")
    for warning in (*mechanism.warnings, *statistics.warnings):
        typer.echo(f"warning: {warning}", err=True)


def _statistics(
    mechanism: Mechanism, settings: Settings, revolutions: int, first: int
) -> Statistics:
    """Simulate without keeping the steps; print what an interrupted run has given."""
    from cylcontact.mechanism import Interrupted, long_run

    try:
        with progress_bars() as progress:
            return long_run(
                mechanism,
                revolutions,
                first,
                settings.method,
                settings.tolerance,
                settings.beyond,
                progress,
                allowed_penetration=settings.allowed_penetration,
            )
    except Interrupted as interruption:
        if interruption.statistics is None:
            raise KeyboardInterrupt from None
        typer.echo(interruption.statistics.to_text(), nl=False)
        count = len(interruption.statistics.revolutions)
        raise KeyboardInterrupt(
            f"interrupted; these are the numbers of {count} complete revolutions"
        ) from None


def _kept(
    mechanism: Mechanism, settings: Settings, revolutions: int, out: Path, resume: bool
) -> Trajectory:
    """Simulate and save the trajectory."""
    earlier = _earlier(mechanism, settings, out) if resume else None
    run = _run(mechanism, settings, revolutions, earlier, out)
    run.save(out)
    return run


def _earlier(mechanism: Mechanism, settings: Settings, out: Path) -> Trajectory | None:
    """Return the run to resume; refuse one of another mechanism or other options."""
    from cylcontact.mechanism import Trajectory

    if not out.exists():
        typer.echo(f"cylcontact: there is no {out} yet; the run starts anew", err=True)
        return None
    earlier = Trajectory.load(out)
    if (earlier.mechanism.data, earlier.settings) != (mechanism.data, settings):
        raise InputError(
            str(out), "", None, "is of another mechanism or other options",
            "restore them, or run without --resume to start anew",
        )  # fmt: skip
    return earlier


def _run(
    mechanism: Mechanism,
    settings: Settings,
    revolutions: int,
    earlier: Trajectory | None,
    out: Path,
) -> Trajectory:
    """Simulate; save the complete revolutions of an interrupted run."""
    from cylcontact.mechanism import Interrupted
    from cylcontact.mechanism import simulate as run

    try:
        with progress_bars() as progress:
            return run(
                mechanism,
                settings.method,
                revolutions,
                settings.tolerance,
                settings.beyond,
                progress,
                earlier,
                settings.allowed_penetration,
            )
    except Interrupted as interruption:
        if interruption.trajectory is None:
            raise KeyboardInterrupt from None
        interruption.trajectory.save(out)
        count = interruption.trajectory.revolutions
        raise KeyboardInterrupt(
            f"interrupted; {count} complete revolutions are kept in {out}; "
            "the same command with --resume goes on from there"
        ) from None


@dataclass(frozen=True)
class Varied:
    """The values of a sweep, separated by commas; by default those of the paper."""

    laws: Annotated[str, typer.Option(help="Contact laws, separated by commas.")] = _joined(
        PAPER[0]
    )
    clearances: Annotated[str, typer.Option(help="Radial clearances, mm.")] = _joined(PAPER[1])
    restitutions: Annotated[str, typer.Option(help="Restitutions.")] = _joined(PAPER[2])
    frictions: Annotated[str, typer.Option(help="Friction coefficients.")] = _joined(PAPER[3])


@expand_options
def sweep(
    spec: SpecFile,
    *,
    out: TableFile,
    varied: Varied,
    revolutions: _Revolutions = None,
    first: Annotated[
        int,
        typer.Option(
            parser=integer_from(0), metavar="INTEGER", help="First revolution that counts, from 0."
        ),
    ] = 0,
    integration: Integration,
    against: Annotated[
        float | None,
        typer.Option(help="Run at this tolerance too; count only what lies beyond the horizon."),
    ] = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    resume: Annotated[bool, typer.Option("--resume", help="Resume an interrupted sweep.")] = False,
) -> None:
    """Simulate laws × clearances × restitutions × frictions into one table."""
    from cylcontact.mechanism import Plan, cases, read_mechanism
    from cylcontact.mechanism import sweep as run

    mechanism = read_mechanism(spec)
    require_suffix(out, *OUTPUT_SUFFIXES)
    wanted = cases(
        [law.strip() for law in varied.laws.split(",")],
        _numbers("--clearances", varied.clearances),
        _numbers("--restitutions", varied.restitutions),
        _numbers("--frictions", varied.frictions),
    )
    turns = revolutions or mechanism.integration.revolutions
    plan = Plan(turns, first, **asdict(integration), against=against)
    where = workers(jobs, scheduler)
    with owning(out), resumable(out, "case") as journal:
        with progress_bars() as progress:
            table = run(mechanism, wanted, plan, where, progress, journal, resume)
        write_table(table, out)
    stopped = table[table["status"] != "complete"]
    typer.echo(f"{out}: {len(table)} cases, {len(stopped)} of them stopped")
    for message in stopped["message"]:
        typer.echo(f"  {message}")


def tolerances(
    spec: SpecFile,
    out: TableFile,
    values: Annotated[
        str, typer.Option("--tolerances", help="Separated by commas.")
    ] = "1e-5,1e-6,1e-7,1e-8,1e-9,1e-10,1e-11",
    revolutions: _Revolutions = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
) -> None:
    """Tabulate energy balance and drift by tolerance, over the paper's 24 cases in both forms."""
    from cylcontact.mechanism import Plan, cases, read_mechanism
    from cylcontact.mechanism import sweep as run
    from cylcontact.mechanism.studies import tolerance_table

    mechanism = read_mechanism(spec)
    require_suffix(out, *OUTPUT_SUFFIXES)
    turns = revolutions or mechanism.integration.revolutions
    wanted = cases(*PAPER)
    where = workers(jobs, scheduler)
    plans = [
        Plan(turns, method=method, tolerance=value, beyond="tangent")
        for method in METHODS
        for value in _numbers("--tolerances", values)
    ]
    with owning(out), progress_bars() as progress:
        tables = []
        for done, plan in enumerate(plans):
            progress("sweeps", done, len(plans))
            tables.append(run(mechanism, wanted, plan, where))
        progress("sweeps", len(plans), len(plans))
        table = tolerance_table(tables)
        write_table(table, out)
    typer.echo(table.to_string(index=False, float_format="%.3g"))


@expand_options
def bifurcation(
    spec: SpecFile,
    *,
    out: TableFile,
    clearances: Annotated[
        str, typer.Option(help="The smallest and the largest radial clearance, mm.")
    ] = "0.01,0.5",
    points: Annotated[
        int, typer.Option(parser=integer_from(1), metavar="INTEGER", help="How many of them.")
    ] = 40,
    changes: Losses,
    revolutions: Annotated[
        int, typer.Option(parser=integer_from(2), metavar="INTEGER", help="Length of each run.")
    ] = 200,
    last: Annotated[
        int, typer.Option(parser=integer_from(1), metavar="INTEGER", help="Sections kept of each.")
    ] = 50,
    rates: Annotated[
        str,
        typer.Option(
            "--impact-rates",
            help="δ̇⁽⁻⁾ that contact carries, m/s, separated by commas; 0 for that of its onset.",
        ),
    ] = "0",
    beyond: Beyond = "stop",
    jobs: Jobs = None,
    scheduler: Scheduler = None,
) -> None:
    """Tabulate the Poincaré sections of a mechanism over its clearance: periodic or not."""
    import numpy as np
    import pandas as pd

    from cylcontact.mechanism import read_mechanism
    from cylcontact.mechanism.studies import bifurcation as run

    require_suffix(out, *OUTPUT_SUFFIXES)
    mechanism = read_mechanism(spec, **asdict(changes))
    ends = _numbers("--clearances", clearances)
    require(
        len(ends) == 2 and min(ends) > 0, "--clearances", "", clearances,
        "must be two positive numbers", "e.g. 0.01,0.5",
    )  # fmt: skip
    values = [float(f"{value:.4g}") for value in np.geomspace(ends[0], ends[1], points)]
    where = workers(jobs, scheduler)
    with owning(out):
        with progress_bars() as progress:
            tables = [
                run(mechanism, values, revolutions, last, rate or None, beyond, where, progress)
                for rate in _numbers("--impact-rates", rates)
            ]
        table = pd.concat(tables, ignore_index=True)
        write_table(table, out)
    periods = table.drop_duplicates(["clearance_mm", "held_m_per_s"])["period"]
    counts = {
        f"of period {period:g}" if period else "of no period up to 8": int(
            (periods == period).sum()
        )
        for period in sorted(periods.dropna().unique())
    }
    counts["too short to tell"] = int(periods.isna().sum())
    texts = ", ".join(f"{count} {what}" for what, count in counts.items() if count)
    typer.echo(f"{out}: {len(periods)} runs, {texts}")


def _numbers(option: str, text: str) -> list[float]:
    """Return the numbers of a list separated by commas."""
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise InputError(
            option, "", text, "must be numbers separated by commas", "e.g. 0.5,0.02"
        ) from None
