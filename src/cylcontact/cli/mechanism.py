"""The commands `simulate` and `sweep` of the slider-crank."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from cylcontact.cli.options import (
    JOBS,
    JSON,
    LENGTH,
    MATERIALS,
    QUIET,
    SCHEDULER,
    Options,
    argument,
    count,
    length,
    number,
    option,
    output,
    require_output,
    several,
    takes,
)
from cylcontact.cli.terminal import note, progress_bars, say
from cylcontact.files.writing import json_text, write_table
from cylcontact.support import choices
from cylcontact.support.choices import BEYOND, OUTPUT_SUFFIXES, listed
from cylcontact.support.errors import InputError, require

if TYPE_CHECKING:
    from cylcontact.mechanism import SliderCrank, Statistics

# How much a fit's diameter and a hole's may differ, as a part of it.
_SAME_SIZE = 0.01
# The second tolerance of `_agreement` relative to the first, and the revolutions that it runs.
_TIGHTER, _LONGEST = 0.1, 10

SPEC = argument("The file of a slider-crank, datasets/slider_crank.toml.", metavar="FILE")
REVOLUTIONS = count(1, "Number of revolutions; the file's by default.")
FIRST = count(0, "First revolution of the statistics, from 0.")
_INSTEAD: dict[str, Any] = {"rich_help_panel": "Instead of the values of the file"}
_COMBINED: dict[str, Any] = {"rich_help_panel": "Values to combine"}
END = option(
    f"At the end of the law: {listed(BEYOND)}.", parser=str, metavar="BEYOND", default="stop"
)
# What replaces values of the file, each by one.
CHANGE: Options = {
    "law": (str | None, option("A law or a fit's result.", metavar="LAW", **_INSTEAD)),
    "clearance": (float | None, length("Radial clearance.", "--radial-clearance", **_INSTEAD)),
    "restitution": (float | None, number("Restitution, above 0 up to 1.", **_INSTEAD)),
    "friction": (float | None, number("Friction coefficient.", **_INSTEAD)),
    "materials": (str | None, MATERIALS),
    "tolerance": (float | None, number("Tolerance of the integrator.", **_INSTEAD)),
}
# The same, each by one or several.
CHANGES: Options = {
    "law": (list[str] | None, several("Laws, e.g. johnson.", of=str, metavar="LAW", **_COMBINED)),
    "clearance": (
        list[float] | None,
        several("Radial clearances.", "--radial-clearance", of=LENGTH, metavar="MM", **_COMBINED),
    ),
    "restitution": (list[float] | None, several("Restitutions, above 0 up to 1.", **_COMBINED)),
    "friction": (list[float] | None, several("Friction coefficients.", **_COMBINED)),
}


@takes("change", CHANGE)
def simulate(
    spec: Path = SPEC,
    *,
    table: Path | None = option("Table of the steps, .csv or .parquet.", metavar="FILE"),
    change: dict[str, Any],
    revolutions: int | None = REVOLUTIONS,
    first: int | None = FIRST,
    beyond: choices.Beyond = END,
    as_json: bool = JSON,
    quiet: bool = QUIET,
) -> None:
    """Simulate a slider-crank with a clearance joint and print its statistics."""
    from cylcontact.mechanism import read_mechanism
    from cylcontact.mechanism import simulate as run
    from cylcontact.mechanism.run import estimate
    from cylcontact.mechanism.study import first_of

    require_output(table, *OUTPUT_SUFFIXES)
    mechanism = read_mechanism(spec, **change)
    total = revolutions or mechanism.spec.revolutions
    first = first_of(total) if first is None else first
    rule = f"leaves none of {total} revolutions"
    require(first < total, "simulate", "--first", first, rule, "start earlier, or simulate more")
    settings: dict[str, Any] = {"beyond": beyond}
    if text := estimate(mechanism, total):
        note(f"cylcontact: {text}", quiet, err=True)
    with progress_bars(quiet) as progress:
        if table is None:
            given = settings | {"progress": progress}
            statistics = _long_run(mechanism, total, first, given)
        else:
            trajectory = run(mechanism, total, progress=progress, **settings)
            write_table(trajectory.to_frame(), table)
            statistics = trajectory.statistics(first)
    if not as_json:
        say(statistics.to_text())
    agreed = "" if estimate(mechanism, total) else _agreement(mechanism, total, settings)
    warnings = [*mechanism.warnings, *statistics.warnings]
    if as_json:
        say(json_text(statistics.to_dict() | {"agreement": agreed, "warnings": warnings}))
    elif agreed:
        say(f"\n{agreed}")
    if table is not None:
        note(f"\nwritten to {table}", quiet or as_json)
    for warning in warnings:
        say(f"warning: {warning}", err=True)


def _long_run(mechanism: SliderCrank, total: int, first: int, given: dict[str, Any]) -> Statistics:
    """Simulate without keeping the steps; print the statistics of a run that is interrupted."""
    from cylcontact.mechanism import Interrupted, long_run

    try:
        return long_run(mechanism, total, first, **given)
    except Interrupted as interruption:
        if interruption.statistics is None:
            raise KeyboardInterrupt from None
        say(interruption.statistics.to_text())
        complete = len(interruption.statistics.revolutions)
        raise KeyboardInterrupt(
            f"interrupted; these are the numbers of {complete} complete revolutions"
        ) from None


def _agreement(mechanism: SliderCrank, total: int, settings: dict[str, Any]) -> str:
    """Say how long two runs agree whose tolerances differ."""
    from cylcontact.mechanism import horizon
    from cylcontact.mechanism import simulate as run

    total, tolerance = min(total, _LONGEST), mechanism.spec.tolerance
    tighter = max(_TIGHTER * tolerance, 1e-14)
    pair = f"runs at the tolerances {tolerance:g} and {tighter:g}"
    try:
        other = run(mechanism.changed(tolerance=tighter), total, **settings)
    except InputError as error:
        return f"{pair} differ: with the second one {error.rule}"
    agreed = horizon(run(mechanism, total, **settings), other)
    if agreed >= total:
        return f"{pair} agree over all of {total} revolutions"
    return f"{pair} separate after {agreed:.1f} revolutions: compare means, not places"


@takes("changes", CHANGES)
def sweep(
    spec: Path = SPEC,
    *,
    out: Path | None = output("The table, .csv or .parquet."),
    changes: dict[str, Any],
    iso: str | None = option("An ISO fit: tightest, middle, loosest.", metavar="CODE", **_COMBINED),
    materials: str | None = MATERIALS,
    revolutions: int | None = REVOLUTIONS,
    first: int | None = FIRST,
    tolerance: float | None = number("Tolerance of the integrator; the file's by default."),
    beyond: choices.Beyond = END,
    jobs: int = JOBS,
    scheduler: Any = SCHEDULER,
    as_json: bool = JSON,
    quiet: bool = QUIET,
) -> None:
    """Simulate every combination of laws, clearances, restitutions and frictions."""
    from cylcontact.mechanism import cases, read_mechanism
    from cylcontact.mechanism import sweep as run
    from cylcontact.mechanism.run import estimate

    require_output(out, *OUTPUT_SUFFIXES)
    rule, remedy = "is missing", "name the table, e.g. -o build/sweep.csv, or print it with --json"
    require(out is not None or as_json, "sweep", "--out", None, rule, remedy)
    mechanism = read_mechanism(spec, materials, tolerance=tolerance)
    if iso is not None:
        rule = "conflicts with --radial-clearance"
        require("clearance" not in changes, "sweep", "--iso", iso, rule, "keep one of them")
        changes["clearance"] = _from_iso(iso, mechanism)
    total = revolutions or mechanism.spec.revolutions
    wanted = cases(*(changes.get(name, [None]) for name in CHANGES))
    if text := estimate(mechanism, total * len(wanted)):
        note(f"cylcontact: {text}", quiet, err=True)
    with progress_bars(quiet) as progress:
        table = run(mechanism, wanted, total, first, beyond, scheduler or jobs, progress)
    if as_json:
        say(json_text({"rows": table}))
    if out is not None:
        write_table(table, out)
    stopped = table[table["contact_fraction"].isna()] if "contact_fraction" in table else table
    note(f"{out}: {len(table)} cases, {len(stopped)} of them stopped", quiet or as_json)
    if len(stopped):
        counted = f"{len(stopped)} of {len(table)} cases stopped"
        say(f"cylcontact: {counted}; first: {stopped['message'].iloc[0]}", err=True)
        raise typer.Exit(1)


def _from_iso(code: str, mechanism: SliderCrank) -> list[float]:
    """Return the radial clearances of the tightest, the middle and the loosest pair in mm."""
    from cylcontact.bodies.iso286 import IsoFit

    fit = IsoFit.read(code, "sweep", "--iso")
    fit.require_clearance("sweep", "--iso")
    hole = 2 * float(mechanism.joint.pair.radii("the joint")[0])
    rule = f"is of another size than the hole of the joint, of {hole:g} mm"
    good = abs(hole - fit.nominal) < _SAME_SIZE * fit.nominal
    require(good, "sweep", "--iso", code, rule, "name a fit of that diameter")
    R_i, R_j = fit.radii([0.0, 0.5, 1.0])
    clearances: list[float] = (R_i - R_j).round(9).tolist()
    return clearances
