"""The page Validation: published benchmarks, coverage of the intervals, speed."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from functools import partial
from math import isnan, nan
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from benchmarks import references
from benchmarks.harness import BUSY, Row
from cylcontact.files.reading import marked, unmarked
from cylcontact.files.writing import replacing

ROOT = Path(__file__).resolve().parents[1]
RESULTS, PAGE = ROOT / "datasets" / "benchmarks.json", ROOT / "docs" / "validation.md"
COVERAGE = ROOT / "datasets" / "coverage.csv"
TEXT = """# Validation

Every numerical result has an independent check: the [published benchmarks](#published-benchmarks),
the [coverage](#coverage-of-the-intervals) of the intervals, and in the tests

| result | checked against |
|---|---|
| laws, their inverses, stress, first yield | mpmath, numerical integrals, the paper's numbers |
| conformal contact and housings | a series solution, our finite elements, CalculiX |
| finite elements | CalculiX on the same mesh, refinement of the mesh |
| fits to tables, their intervals | NIST's certified fits, statsmodels, lmfit, iminuit, ODRPACK |
| slider-crank, clearance joint | CVODE, the balance of energy, Exudyn |
| exported code and FMUs | the library at thousands of states; compilers, Octave, FMPy |

`make bench` writes this page. It takes ten minutes, apart from the coverage, which
`python -m benchmarks.coverage` measures in twenty minutes on one core.

## Published benchmarks

A dash means that no number could be found. `python -m benchmarks.references` prints these
comparisons, and `datasets/references` holds them; to add one, fill in `template/rig.toml` there.

{references}

## Coverage of the intervals

How often do the 95 % intervals of a fit to a table contain the true value? Each kind of data below
is simulated {sets} times with errors of known size and fitted with the explicit law. The columns
give the percentage of sets whose interval contains the true stiffness factor and the true offset;
{precision}. With the right options
the lowest percentage is {lowest:.1f} %, of {worst}.

![Coverage for each kind of data, with the right options and without](pictures/coverage.png)

| data | options | stiffness factor | offset | warned |
|---|---|---:|---:|---:|
{coverage}

The first row of each kind uses the options that describe its errors. The second row, with a quarter
of the sets, leaves one out, and its intervals may be wrong. The last column is the percentage of
sets in which the report then warns and names the missing option. Unstated errors of the load
cannot be detected, because they look like scatter of the penetration, and a wrong clearance or
modulus looks like another stiffness: the report says that both are taken as exact. With fewer than
five series an interval describes these series alone; with eight or more it describes their
population.

## Speed

All methods in a table give the same answer, which is checked first. They then run in turns; times
are medians, and a ratio is the time divided by that of the first line. Measured on {cores} cores of
{processor} ({system}), with {libraries}.

### Aims

| aim | at most | measured | |
|---|---:|---:|---|
{aims}

### Times and ratios

| | time | ratio |
|---|---:|---:|
{ratios}
"""


class Aim(NamedTuple):
    """The largest time of a side, or its largest multiple of another side's, and its limit."""

    text: str
    limit: float
    case: str
    side: str
    other: str = ""

    def measured(self, rows: list[Row]) -> float:
        """Return the number of the slowest case, NaN if something was not measured."""
        of_case = [
            row for row in rows if self.case in row.case and (self.other or BUSY not in row.case)
        ]
        value = {row.case: row.value for row in of_case if row.side == self.side}
        other = {row.case: row.value for row in of_case if row.side == self.other}
        return max(
            (v / other.get(k, nan) if self.other else v for k, v in value.items()), default=nan
        )

    def line(self, rows: list[Row]) -> str:
        """Return what was measured and whether that meets the aim, as a row of a table."""
        value = self.measured(rows)
        verdict = f"{_short(value)} | {'reached' if value <= self.limit else '**missed**'}"
        if isnan(value):
            busy = any(BUSY in row.case for row in rows if self.case in row.case)
            verdict = "a busy machine |" if busy else "not measured |"
        return f"| {self.text} | {self.limit:g} | {verdict} |"


# Text; limit; words of the case; side; the side that it is divided by.
AIMS = tuple(
    Aim(text, float(limit), *sides)
    for text, limit, *sides in (
        line.split("; ")
        for line in """
calibration on 1e6 samples, s; 0.1; on 1,001,925; cylcontact
the same, times scipy's least squares; 0.02; on 1,001,925; cylcontact; scipy least_squares
calibration on 4,575 samples, times scipy's; 2; on 4,575; cylcontact; scipy least_squares
sampling on all cores, times numpy.log on one; 4; a sample of; reduce_grid, all cores; numpy.log
genetic search, times its objective; 2; a generation; genetic search; its objective
Johnson's load in arrays, times numpy.power; 2; array; Johnson().load; numpy.power
explicit law's load in arrays, times numpy.power; 8; array; Explicit().load; numpy.power
conformal load in arrays, times numpy.power; 6; array; Conformal().load; numpy.power
conformal penetration in arrays, times numpy.power; 15; array; Conformal().penetration; numpy.power
Johnson's load, compiled, times the enhanced law's; 1.4; compiled; Johnson; enhanced
conformal load, compiled, times a power; 2; compiled; conformal; a power
1e6 joints of other materials, ns each; 1000; contact, 1,000,000 joints; the state of the contact
first yield of 1e6 joints, ns each; 3000; yield, 1,000,000 joints; first yield
conformal curve of one material, ms; 5; curve; one material
conformal curve of a thin eye, ms; 150; curve; a thin eye
slider-crank, slowest of 24 cases, times real time; 1; restitution; cylcontact, 1e-08; real time
import cylcontact, s; 0.15; a process; import cylcontact
cylcontact --help, s; 0.3; a process; cylcontact --help
cylcontact check, s; 0.9; a process; cylcontact check
cylcontact fit of 60 readings, s; 1.2; a process; cylcontact fit of a table
a fit of 60 readings, times starting its libraries; 1.2; a fit of; 60 readings; start its libraries
a fit of 20,000 readings, times the same; 4; a fit of; 20,000 readings; start its libraries
cylcontact predict, s; 0.6; a process; cylcontact predict
first simulation after an install, s; 9; first simulation; cylcontact simulate
all figures, s; 20; all figures; cylcontact figure
""".strip().splitlines()
    )
)


def write(results: dict[str, Any]) -> None:
    """Write the results and the page, complete or not at all."""
    data = results | {
        "rows": {n: [list(row) for row in part] for n, part in results["rows"].items()}
    }
    with replacing(RESULTS) as temporary:
        text = json.dumps(marked(data), indent=1, ensure_ascii=False)
        one_line = partial(re.sub, r"\n\s+", " ")
        text = re.sub(r"\[\s+(\"[^\[\]]*?)\s+\]", lambda row: f"[{one_line(row[1])}]", text)
        temporary.write_text(text + "\n", encoding="utf-8")
    with replacing(PAGE) as temporary:
        temporary.write_text(page(results), encoding="utf-8")


def read() -> dict[str, Any]:
    """Return the results: the computer, why benchmarks were skipped, and the rows by benchmark."""
    if not RESULTS.exists():
        return {"machine": {}, "skipped": {}, "rows": {}}
    data = unmarked(json.loads(RESULTS.read_text(encoding="utf-8")), str(RESULTS))
    return data | {"rows": {n: [Row(*row) for row in part] for n, part in data["rows"].items()}}


def page(results: dict[str, Any]) -> str:
    """Return the page in Markdown."""
    rows = [row for part in results["rows"].values() for row in part]
    about = dict(results["machine"])
    where = {name: about.pop(name, "?") for name in ("cores", "processor", "system")}
    table = pd.read_csv(COVERAGE, keep_default_na=False)
    complete = table[table["options"] == table.groupby("kind")["options"].transform("first")]
    lowest = complete.loc[complete["coverage_percent"].idxmin()]
    counts = sorted({*complete["sets"]})
    text = TEXT.format(
        references="\n".join(references.lines(sorted(references.FOLDER.glob("*.toml")))),
        sets=" or ".join(map(str, counts)),
        precision=", ".join(f"{n} sets determine 95 % to ± {_precision(n):.0f} %" for n in counts),
        lowest=lowest["coverage_percent"],
        worst=f"the {lowest['parameter'].replace('_', ' ')} for “{lowest['kind']}”",
        coverage="\n".join(_coverage(table)),
        aims="\n".join(aim.line(rows) for aim in AIMS),
        ratios="\n".join(_ratios(rows)),
        libraries=", ".join(f"{name} {value}" for name, value in about.items()),
        **where,
    )
    skipped = [f"\nNot measured: {name}, {reason}." for name, reason in results["skipped"].items()]
    return "\n".join([text.rstrip("\n"), *skipped]) + "\n"


def _precision(sets: int) -> float:
    """Return two standard errors of a percentage of sets that is 95 %."""
    return float(200 * (0.95 * 0.05 / sets) ** 0.5)


def _coverage(table: pd.DataFrame) -> Iterator[str]:
    for (kind, options), rows in table.groupby(["kind", "options"], sort=False):
        percent = rows.set_index("parameter")["coverage_percent"]
        numbers = f"{percent['stiffness_factor']:.1f} | {percent['offset']:.1f}"
        command = f"`{options}`" if options else "none"
        yield f"| {kind} | {command} | {numbers} | {rows['warned_percent'].iloc[0]:.0f} |"


def _ratios(rows: list[Row]) -> Iterator[str]:
    case = ""
    for row in rows:
        if "restitution" in row.case:  # 24 cases, of which an aim names the slowest
            continue
        if row.case != case:
            case = row.case
            unit = "" if BUSY in case else f", {row.unit}"
            yield f"| **{case}**{unit} | | |"
        note = f" ({row.note})" if row.note else ""
        time = "" if BUSY in case else _short(row.value)
        yield f"| {row.side}{note} | {time} | {_short(row.ratio)} |"


def _short(number: float) -> str:
    """Return a number to three digits, without an exponent."""
    return f"{float(f'{number:.3g}'):,.10g}"
