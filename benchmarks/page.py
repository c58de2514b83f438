"""The results as a file and as a page: what was aimed at, what was measured."""

from __future__ import annotations

import json
import statistics
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from itertools import chain, groupby
from pathlib import Path
from typing import Any

from benchmarks.harness import Row
from cylcontact.files import replacing
from cylcontact.formats import marked, upgraded

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "datasets" / "benchmarks.json"
# By the benchmarks' modules, in the order in which they run and stand on the page.
TITLES = {
    "law": "Johnson's load from the penetration",
    "sampling": "Sampling to moments",
    "search": "Genetic search",
    "calibration": "Calibration, to within 0.1 % of the best objective known",
    "mechanism": "Slider-crank with a clearance",
    "finite_element": "A pin in a hole by finite elements",
    "start_up": "Start-up and figures",
}


# More cases with the same sides than this share a table.
MERGED = 4


@dataclass(frozen=True)
class Aim:
    """What was aimed at: a quotient or a time, and the most or least that it should be."""

    text: str
    measured: Callable[[Sequence[Row]], float]
    limit: float
    at_least: bool = False

    def verdict(self, rows: Sequence[Row]) -> str:
        """Return what was measured and whether that meets the aim."""
        try:
            value = self.measured(rows)
        except ValueError:
            return "| not measured | |"
        meets = value >= self.limit if self.at_least else value <= self.limit
        return f"| {value:.3g} | {'reached' if meets else '**not reached**'} |"


def find(rows: Iterable[Row], benchmark: str, case: str, side: str) -> Row:
    """Return the one row whose case and side contain these words."""
    (actual,) = (
        row for row in rows if row.benchmark == benchmark and case in row.case and side in row.side
    )
    return actual


def over(benchmark: str, case: str, side: str, other: str) -> Callable[[Sequence[Row]], float]:
    """Return how to get the quotient of two sides of a case."""
    return lambda rows: (
        find(rows, benchmark, case, side).value / find(rows, benchmark, case, other).value
    )


def measured(benchmark: str, case: str, side: str) -> Callable[[Sequence[Row]], float]:
    """Return how to get the value of one side of a case."""
    return lambda rows: find(rows, benchmark, case, side).value


def slowest(rows: Sequence[Row]) -> float:
    """Return the slowest case of the mechanism, in units of real time."""
    return max(
        row.ratio
        for row in rows
        if row.side == "cylcontact at 1e-8" and row.benchmark == "mechanism"
    )


def own_mechanism(rows: Sequence[Row]) -> float:
    """Return the milliseconds per revolution of the form for any mechanism, median of its cases."""
    return statistics.median(row.value for row in rows if row.side == "as any mechanism")


AIMS = (
    Aim(
        "Calibration at 1e6 samples: times as fast as PyGAD used plainly",
        over("calibration", "1,001,925", "PyGAD", "genetic search"),
        1000,
        at_least=True,
    ),
    Aim(
        "Calibration at 1e6 samples: times as fast as scipy's least squares on rows",
        over("calibration", "1,001,925", "scipy least_squares", "genetic search"),
        100,
        at_least=True,
    ),
    Aim(
        "Sampling to moments, all cores: in units of one pass of numpy.log on one core",
        over("sampling", "10,000,000", "threads", "numpy.log"),
        3,
    ),
    Aim(
        "Johnson's load in arrays: in units of numpy.power",
        over("law", "array, 1,000,000", "Johnson", "numpy.power"),
        3,
    ),
    Aim(
        "The explicit law's load in arrays: in units of numpy.power",
        over("law", "array, 1,000,000", "Explicit()", "numpy.power"),
        8,
    ),
    Aim(
        "Johnson's load in compiled code: in units of the enhanced law's",
        over("law", "compiled", "kernel_load, Johnson", "kernel_load, enhanced"),
        2,
    ),
    Aim(
        "A load for any two materials (parametric) in arrays: in units of numpy.power",
        over("law", "array, 1,000,000", "Parametric", "numpy.power"),
        50,
    ),
    Aim(
        "A load in a housing in arrays, in ns",
        measured("law", "array, 1,000,000", "housing"),
        400,
    ),
    Aim(
        "A load for any two materials (parametric) in compiled code, in ns",
        measured("law", "compiled", "parametric"),
        300,
    ),
    Aim(
        "Genetic search, 120 candidates: in units of its objective",
        over("search", "120 candidates", "genetic search", "objective alone"),
        2,
    ),
    Aim("Mechanism at 1e-8, slowest case: in units of real time", slowest, 1),
    Aim("The same as any mechanism (multipliers), median case, in ms", own_mechanism, 25),
    Aim(
        "cylcontact --help, in s",
        measured("start_up", "process", "--help"),
        0.3,
    ),
    Aim(
        "import cylcontact, in s",
        measured("start_up", "process", "import cylcontact"),
        0.15,
    ),
    Aim(
        "All figures from the committed fits, in s",
        measured("start_up", "figures", "figure"),
        30,
    ),
)


def save(path: Path, results: dict[str, Any]) -> None:
    """Write the results, complete or not at all."""
    data = results | {"rows": [asdict(row) for row in results["rows"]]}
    with replacing(path) as temporary:
        text = json.dumps(marked("benchmarks", data), indent=1, ensure_ascii=False)
        temporary.write_text(text + "\n", encoding="utf-8")


def load(path: Path) -> dict[str, Any]:
    """Return the results: the machine, why benchmarks were skipped, and the rows as `Row`."""
    data = upgraded("benchmarks", json.loads(path.read_text(encoding="utf-8")), str(path))
    return data | {"rows": [Row(**row) for row in data["rows"]]}


def page(results: dict[str, Any]) -> str:
    """Return the page of the documentation, in Markdown."""
    rows: list[Row] = results["rows"]
    lines = ["# Speed", "", *_introduction(results["machine"]), *_aims(rows)]
    for benchmark, title in TITLES.items():
        of_it = [row for row in rows if row.benchmark == benchmark]
        reason = results["skipped"].get(benchmark)
        if of_it or reason:
            lines += ["", f"## {title}", ""]
        if reason:
            lines += [f"Not measured: {reason}.", ""]
        cases = [list(sides) for _, sides in groupby(of_it, key=lambda row: row.case)]
        for _, group in groupby(cases, key=lambda sides: [row.side for row in sides]):
            alike = list(group)
            lines += _merged(alike) if len(alike) > MERGED else chain(*map(_table, alike))
    return "\n".join(lines).rstrip() + "\n"


def _introduction(machine: dict[str, Any]) -> list[str]:
    libraries = ", ".join(
        f"{name} {value}"
        for name, value in machine.items()
        if name not in ("processor", "cores", "system")
    )
    return [
        "How fast the package is, beside what one would use instead: `make bench` measures it and "
        "writes this page.",
        "",
        "All sides of a comparison give the same answer, which is checked first, and then take "
        "turns. The numbers are medians, with the quartiles of the rounds in brackets. Ratios are "
        "to the first line of each table, formed round by round.",
        "",
        f"Measured on {machine['cores']} cores of {machine['processor']} ({machine['system']}), "
        f"with {libraries}.",
    ]


def _aims(rows: Sequence[Row]) -> list[str]:
    lines = ["", "## Aims", "", "| Aim | Limit | Measured | |", "|---|---|---|---|"]
    for aim in AIMS:
        sign = "≥" if aim.at_least else "≤"
        lines.append(f"| {aim.text} | {sign} {aim.limit:g} {aim.verdict(rows)}")
    return lines


def _merged(cases: Sequence[Sequence[Row]]) -> list[str]:
    """Return one table for cases with the same sides."""
    first = cases[0]
    sides = " | ".join(row.side for row in first)
    lines = [f"{first[0].unit} (ratio to {first[0].side})", ""]
    lines += [f"| | {sides} |", "|---" + "|---:" * len(first) + "|"]
    for start, *others in cases:
        cells = [f"{row.value:.3g} ({row.ratio:.3g})" for row in others]
        lines.append("| " + " | ".join([start.case, f"{start.value:.3g}", *cells]) + " |")
    return [*lines, ""]


def _table(sides: Sequence[Row]) -> list[str]:
    unit = sides[0].unit
    lines = [f"**{sides[0].case}**", "", f"| | {unit} | ratio | |", "|---|---:|---:|---|"]
    for row in sides:
        value = _with_range(row.value, row.low, row.high)
        ratio = _with_range(row.ratio, row.ratio_low, row.ratio_high)
        lines.append(f"| {row.side} | {value} | {ratio} | {row.note} |")
    return [*lines, ""]


def _with_range(value: float, low: float, high: float) -> str:
    if low == high:
        return f"{value:.3g}"
    return f"{value:.3g} ({low:.3g} … {high:.3g})"
