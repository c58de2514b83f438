"""The commands `simulate`, and `sweep`, `tolerances` and `bifurcation` of many runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from cylcontact.cli.options import (
    JOBS,
    MATERIALS,
    RESUME,
    SCHEDULER,
    Options,
    argument,
    count,
    number,
    option,
    output,
    require_output,
    several,
    takes,
)
from cylcontact.cli.terminal import progress_bars, resumable, say
from cylcontact.files.writing import write_table
from cylcontact.support import choices
from cylcontact.support.choices import BEYOND, FILM_SUFFIXES, METHODS, OUTPUT_SUFFIXES, listed
from cylcontact.support.errors import InputError, require

if TYPE_CHECKING:
    import pandas as pd

    from cylcontact.mechanism import Case, Mechanism, Settings, Statistics, Trajectory

# The tolerances of `tolerances`, if none is given.
TOLERANCES = (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)
# How much a fit's diameter and a hole's may differ, as a part of it.
_SAME_SIZE = 0.01

SPEC = argument("A mechanism's spec, e.g. datasets/slider_crank.toml.")
TABLE = output("The table, .csv or .parquet.", default=...)
REVOLUTIONS = count(1, "Revolutions in all; the spec's by default.")
FIRST = count(0, "First revolution that counts, from 0.")
METHOD = option(f"{listed(METHODS)} (for any).", parser=str, metavar="METHOD")
TOLERANCE = number("Of the integrator; else the spec's.")
END = option(f"At the law's end: {listed(BEYOND)}.", parser=str, metavar="WHAT", default="stop")
# What replaces values of a mechanism's spec, each by one.
CHANGE: Options = {
    "law": (str | None, option("The law, e.g. johnson.", metavar="NAME")),
    "restitution": (float | None, number("Restitution, above 0 up to 1.")),
    "friction": (float | None, number("Friction coefficient.")),
    "materials": (str | None, MATERIALS),
}
# The same, each by one or several.
CHANGES: Options = {
    "law": (list[str] | None, several("Laws, e.g. johnson.", of=str, metavar="NAME")),
    "clearance": (list[float] | None, several("Radial clearances, mm.")),
    "restitution": (list[float] | None, several("Restitutions, above 0 up to 1.")),
    "friction": (list[float] | None, several("Friction coefficients.")),
}


def _combined(changes: Mapping[str, Any]) -> list[Case]:
    """Return every combination of the changes; the spec's value of what is not given."""
    from cylcontact.mechanism import cases

    return cases(*(changes.get(name, [None]) for name in CHANGES))


def _of_fit(code: str, mechanism: Mechanism) -> list[float]:
    """Return the radial clearances of the tightest, the middle and the loosest pair in mm."""
    from cylcontact.bodies.fits import Fit

    fit = Fit.read(code, "sweep", "--fit")
    fit.require_clearance("sweep", "--fit")
    for joint in mechanism.clearances:
        hole = 2 * float(joint.contact.pair.radii(joint.name)[0])
        rule = f"is of another size than the hole of {joint.name}, of {hole:g} mm"
        good = abs(hole - fit.nominal) < _SAME_SIZE * fit.nominal
        require(good, "sweep", "--fit", code, rule, "name a fit of that diameter")
    R_i, R_j = fit.radii([0.0, 0.5, 1.0])
    clearances: list[float] = (R_i - R_j).round(9).tolist()
    return clearances


@takes("change", CHANGE)
def simulate(
    spec: Path = SPEC,
    *,
    out: Path | None = output("A .parquet, or a film, .gif or .mp4."),
    table: Path | None = option("By revolution, .csv or .parquet.", metavar="PATH"),
    clearance: float | None = number("Radial clearance, mm."),
    change: dict[str, Any],
    revolutions: int | None = count(1, "In all; the spec's, of a film three."),
    first: int | None = count(0, "First that counts, or shows, from 0."),
    method: choices.Method | None = METHOD,
    tolerance: float | None = TOLERANCE,
    beyond: choices.Beyond = END,
    allowed_penetration: float | None = number("How deep contact may begin, µm."),
    resume: bool = RESUME,
) -> None:
    """Simulate a mechanism with a clearance joint: its statistics, or a film.

    For many runs at once see the commands sweep, tolerances and bifurcation.
    """
    from cylcontact.mechanism import read_mechanism
    from cylcontact.mechanism.run import settings_for
    from cylcontact.mechanism.study import agreement, first_of

    filmed = out is not None and out.suffix in FILM_SUFFIXES
    require_output(out, ".parquet", *FILM_SUFFIXES)
    require_output(table, *OUTPUT_SUFFIXES)
    rule, possible = "needs a file to go on from", out is not None and not filmed
    require(possible or not resume, "simulate", "--resume", None, rule, "name it: -o run.parquet")
    mechanism = read_mechanism(spec, clearance=clearance, **change)
    depth = None if allowed_penetration is None else allowed_penetration * 1e-6
    settings = settings_for(mechanism, method, tolerance, beyond, allowed_penetration=depth)
    if filmed:
        total = revolutions or (2 if first is None else first) + 1
        first = min(2, total - 1) if first is None else first
    else:
        total = revolutions or mechanism.integration.revolutions
        first = first_of(total) if first is None else first
    rule = f"leaves none of {total} revolutions"
    require(first < total, "simulate", "--first", first, rule, "start earlier, or simulate more")
    # The settings as arguments of a run, which finds the longest step itself.
    given = {name: value for name, value in vars(settings).items() if name != "max_step"}
    with progress_bars() as progress:
        given |= {"revolutions": total, "progress": progress}
        if out is None:
            statistics = _statistics(mechanism, first, given)
        elif filmed:
            statistics = _film(mechanism, first, given, out)
        else:
            run = _run(mechanism, settings, given, out, resume)
            run.save(out)
            statistics = run.statistics(first)
    if table is not None:
        write_table(statistics.by_revolution.reset_index(), table)
    say(statistics.to_text())
    for path in filter(None, (out, table)):
        say(f"\nwritten to {path}")
    if mechanism.clearances:
        say(f"\n{agreement(mechanism, settings, total)}")
    for warning in (*mechanism.warnings, *statistics.warnings):
        say(f"warning: {warning}", err=True)


def _statistics(mechanism: Mechanism, first: int, given: dict[str, Any]) -> Statistics:
    """Simulate without keeping the steps; print what an interrupted run has given."""
    from cylcontact.mechanism import Interrupted, long_run

    try:
        return long_run(mechanism, first=first, **given)
    except Interrupted as interruption:
        if interruption.statistics is None:
            raise KeyboardInterrupt from None
        say(interruption.statistics.to_text())
        count = len(interruption.statistics.revolutions)
        raise KeyboardInterrupt(
            f"interrupted; these are the numbers of {count} complete revolutions"
        ) from None


def _film(mechanism: Mechanism, first: int, given: dict[str, Any], out: Path) -> Statistics:
    """Film a mechanism, the journal magnified beside it."""
    from cylcontact.mechanism import simulate as run
    from cylcontact.mechanism.drawing import film, require_film

    require_film(out)
    trajectory = run(mechanism, **given)
    film(trajectory, out, first, given["progress"])
    return trajectory.statistics(first)


def _run(
    mechanism: Mechanism, settings: Settings, given: dict[str, Any], out: Path, resume: bool
) -> Trajectory:
    """Simulate; save the complete revolutions of a run that is interrupted, or cannot go on."""
    from cylcontact.mechanism import Interrupted, RunError, Trajectory
    from cylcontact.mechanism import simulate as run

    earlier = Trajectory.load(out) if resume and out.exists() else None
    if earlier is not None:
        same = (earlier.mechanism.data, earlier.settings) == (mechanism.data, settings)
        remedy = "restore them, or run without --resume to start anew"
        rule = "is of another mechanism or other options"
        require(same, str(out), "", None, rule, remedy)
        if (has := earlier.revolutions) > given["revolutions"]:
            say(f"cylcontact: {out} has {has} revolutions, all of them kept", err=True)
    elif resume:
        say(f"cylcontact: there is no {out} yet; the run starts anew", err=True)
    try:
        return run(mechanism, resume=earlier, **given)
    except (Interrupted, RunError) as error:
        kept, again = "nothing is kept", ""
        if error.trajectory is not None:
            error.trajectory.save(out)
            kept = f"complete revolutions kept in {out}: {error.trajectory.revolutions}"
            again = "; the same command with --resume goes on from there"
        if isinstance(error, RunError):
            remedy = f"{error.remedy}; {kept}"
            raise InputError(error.source, error.key, error.value, error.rule, remedy) from error
        raise KeyboardInterrupt(f"interrupted; {kept}{again}") from None


@takes("changes", CHANGES)
def sweep(
    spec: Path = SPEC,
    *,
    out: Path = TABLE,
    changes: dict[str, Any],
    fit: str | None = option("The clearances of a fit: tightest, middle, loosest.", metavar="CODE"),
    materials: str | None = MATERIALS,
    revolutions: int | None = REVOLUTIONS,
    first: int | None = FIRST,
    method: choices.Method | None = METHOD,
    tolerance: float | None = TOLERANCE,
    beyond: choices.Beyond = END,
    against: float | None = number(
        "Run at this tolerance too; count only revolutions after the two separate."
    ),
    resume: bool = RESUME,
    jobs: int = JOBS,
    scheduler: Any = SCHEDULER,
) -> None:
    """Simulate every combination of laws, clearances and other values."""
    from cylcontact.mechanism import Plan, read_mechanism
    from cylcontact.mechanism import sweep as run
    from cylcontact.mechanism.study import first_of

    require_output(out, *OUTPUT_SUFFIXES)
    mechanism = read_mechanism(spec, materials)
    if fit is not None:
        rule = "conflicts with --clearance"
        require("clearance" not in changes, "sweep", "--fit", fit, rule, "keep one of them")
        changes["clearance"] = _of_fit(fit, mechanism)
    total = revolutions or mechanism.integration.revolutions
    first = first_of(total) if first is None else first
    plan = Plan(total, first, method, tolerance, beyond, against)
    with resumable(out, "case", resume) as (journal, progress):
        where = scheduler or jobs
        table = run(mechanism, _combined(changes), plan, where, progress, journal, resume)
        write_table(table, out)
    stopped = table[table["status"] != "complete"]
    say(f"{out}: {len(table)} cases, {len(stopped)} of them stopped")
    if len(stopped):
        counted = f"{len(stopped)} of {len(table)} cases stopped"
        say(f"cylcontact: {counted}; first: {stopped['message'].iloc[0]}", err=True)
        raise typer.Exit(1)


@takes("changes", CHANGES)
def tolerances(
    spec: Path = SPEC,
    *,
    out: Path = TABLE,
    changes: dict[str, Any],
    materials: str | None = MATERIALS,
    revolutions: int | None = REVOLUTIONS,
    tolerance: list[float] | None = several(
        "Tolerances of the integrator; 1e-5 to 1e-11 by default."
    ),
    jobs: int = JOBS,
    scheduler: Any = SCHEDULER,
) -> None:
    """Tabulate energy balance and drift by the tolerance of the integrator."""
    from cylcontact.mechanism import Plan, read_mechanism
    from cylcontact.mechanism import tolerances as tabulate
    from cylcontact.mechanism.slider_crank import recognise

    require_output(out, *OUTPUT_SUFFIXES)
    mechanism = read_mechanism(spec, materials)
    total = revolutions or mechanism.integration.revolutions
    wanted, where = _combined(changes), scheduler or jobs
    methods = METHODS if recognise(mechanism) is not None else METHODS[1:]
    plans = [
        Plan(total, method=method, tolerance=value, beyond="tangent")
        for method in methods
        for value in tolerance or TOLERANCES
    ]
    with progress_bars() as progress:
        table = tabulate(mechanism, wanted, plans, where, progress)
    write_table(table, out)
    say(table.to_string(float_format="{:.3g}".format, na_rep="-", index=False))
    runs = len(wanted) * len(table)
    missing = runs - int(table["cases"].sum())
    if missing:
        say(f"cylcontact: {missing} of {runs} cases stopped, and do not count", err=True)
        raise typer.Exit(1)


@takes("change", CHANGE)
def bifurcation(
    spec: Path = SPEC,
    *,
    out: Path = TABLE,
    clearance: list[float] | None = several(
        "The smallest and the largest, mm; 0.01,0.5 by default.", metavar="LOW,HIGH"
    ),
    points: int = count(1, "How many clearances.", default=40),
    change: dict[str, Any],
    revolutions: int = count(1, "Revolutions in all.", default=200),
    last: int = count(1, "Revolutions recorded of each.", default=50),
    impact_rate: list[float] | None = several(
        "Impact rate δ̇⁽⁻⁾ of the damping, m/s; 0, the default: that at onset."
    ),
    beyond: choices.Beyond = END,
    jobs: int = JOBS,
    scheduler: Any = SCHEDULER,
) -> None:
    """Tabulate the Poincaré sections over the clearance: periodic or not."""
    import numpy as np
    import pandas as pd

    from cylcontact.mechanism import bifurcation as tabulate
    from cylcontact.mechanism import read_mechanism

    require_output(out, *OUTPUT_SUFFIXES)
    mechanism = read_mechanism(spec, **change)
    ends = clearance or [0.01, 0.5]
    rule = "must be two positive numbers, the smallest and the largest"
    require(len(ends) == 2 and min(ends) > 0, "--clearance", "", ends, rule, "e.g. 0.01,0.5")
    values = [float(f"{value:.4g}") for value in np.geomspace(ends[0], ends[1], points)]
    where, rates = scheduler or jobs, impact_rate or [0.0]
    with progress_bars() as progress:
        tables = [
            tabulate(mechanism, values, revolutions, last, rate or None, beyond, where, progress)
            for rate in rates
        ]
    table = pd.concat(tables, ignore_index=True)
    write_table(table, out)
    periods = table.drop_duplicates(["clearance_mm", "held_m_per_s"])["period"]
    say(f"{out}: {len(periods)} runs, {', '.join(_counted(periods))}")


def _counted(periods: pd.Series) -> Sequence[str]:
    """Return in words how many runs have which period."""
    counts = periods.value_counts().sort_index()
    texts = [
        f"{count} of period {period:g}" if period else f"{count} of no period up to 8"
        for period, count in counts.items()
    ]
    short = int(periods.isna().sum())
    return [*texts, f"{short} too short to tell"] if short else texts
