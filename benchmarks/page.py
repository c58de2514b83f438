"""The results as a file and as a page: a table of aims and one of ratios."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from benchmarks.harness import Row
from cylcontact.files.reading import marked, unmarked
from cylcontact.files.writing import replacing

ROOT = Path(__file__).resolve().parents[1]
RESULTS, PAGE = ROOT / "datasets" / "benchmarks.json", ROOT / "docs" / "speed.md"
# The cases of the table of ratios: benchmark, words in the case, and the title of their rows.
SHOWN = (
    ("law", "array, 1,000,000", "Johnson's load, 1,000,000 values at once"),
    ("law", "compiled", "Johnson's load, compiled, one value"),
    ("law", "called", "Johnson's load, called from Python"),
    ("law", "making", "A curve of conformal contact, which is made once"),
    ("sampling", "10,000,000", "A sample of 10,000,000, to moments"),
    ("search", "120", "A generation of the genetic search, 120 candidates"),
    ("calibration", "4,572", "A calibration to within 0.1 % of the best, 4,572 samples"),
    ("calibration", "1,001,925", "The same, 1,001,925 samples"),
    ("calibration", "100,000,000", "The same, 100,000,000 samples"),
    ("mechanism", "accuracy", "Slider-crank, one revolution, elastic, without friction"),
    ("finite_element", "2,932", "A pin in a hole by finite elements, 3 loads, 2,932 cells"),
)
HEAD = """# Speed

How fast the package is, beside what one would use instead: `make bench` measures it and writes this
page. All sides of a comparison give the same answer, for a calibration the same objective of the
same coefficients; this is checked first, and then they take turns. Times are medians, ratios to the
first line of each task, which is ours. Those computed are the evaluations that were needed on the
small grid times the cost of one. Searches that had not arrived within 0.1 % of the best when their
budget ended are left out; the aim for PyGAD, one of them, has that budget, a lower bound.

Measured on {cores} cores of {processor} ({system}), with {libraries}.
"""


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
        return f"| {_short(value)} | {'reached' if meets else '**not reached**'} |"


def find(rows: Iterable[Row], benchmark: str, case: str, side: str) -> Row:
    """Return the one row whose case and side contain these words."""
    of_it = (row for row in rows if row.benchmark == benchmark)
    (actual,) = (row for row in of_it if case in row.case and side in row.side)
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
    return max(row.ratio for row in rows if row.side == "cylcontact at 1e-8")


def compilation(rows: Sequence[Row]) -> float:
    """Return how many seconds longer the first simulation takes than the next."""
    first, again = (find(rows, "start_up", "install", side) for side in ("compiles", "again"))
    return first.value - again.value


MILLION, LARGE = "1,001,925", "10,000,000"
AIMS = (
    Aim(
        "Calibration at 1e6 samples, in s", measured("calibration", MILLION, "genetic search"), 0.1
    ),
    Aim(
        "Calibration at 1e6 samples: times as fast as PyGAD used plainly, which did not arrive",
        over("calibration", MILLION, "PyGAD", "genetic search"),
        2000,
        at_least=True,
    ),
    Aim(
        "Calibration at 1e6 samples: times as fast as scipy's least squares on rows",
        over("calibration", MILLION, "scipy least_squares", "genetic search"),
        50,
        at_least=True,
    ),
    Aim(
        "The same by descents from random starts alone, as it makes them",
        over("calibration", MILLION, "scipy least_squares", "descents alone"),
        50,
        at_least=True,
    ),
    Aim(
        "Calibration at 4,572 samples: in units of scipy's least squares on rows",
        over("calibration", "4,572", "genetic search", "scipy least_squares"),
        2,
    ),
    Aim(
        "Sampling to moments, all cores: in units of one pass of numpy.log on one core",
        over("sampling", LARGE, "threads", "numpy.log"),
        4,
    ),
    Aim(
        "Johnson's load in arrays: in units of numpy.power",
        over("law", "array", "Johnson", "numpy.power"),
        3,
    ),
    Aim(
        "The explicit law's load in arrays: in units of numpy.power",
        over("law", "array", "Explicit()", "numpy.power"),
        8,
    ),
    Aim(
        "Johnson's load in compiled code: in units of the enhanced law's",
        over("law", "compiled", "kernel_load, Johnson", "kernel_load, enhanced"),
        2,
    ),
    Aim(
        "A load of conformal contact in arrays: in units of numpy.power",
        over("law", "array", "Conformal().load", "numpy.power"),
        6,
    ),
    Aim(
        "Its penetration in arrays: in units of numpy.power",
        over("law", "array", "Conformal().penetration", "numpy.power"),
        15,
    ),
    Aim(
        "Its load in compiled code: in units of a power",
        over("law", "compiled", "conformal", "a power alone"),
        2,
    ),
    Aim("Its curve for one material, in ms", measured("law", "making", "one material"), 5),
    Aim("Its curve for a thin eye, in ms", measured("law", "making", "thin eye"), 150),
    Aim(
        "Genetic search, 120 candidates: in units of its objective",
        over("search", "120", "genetic search", "objective alone"),
        2,
    ),
    Aim("Mechanism at 1e-8, slowest of 24 cases: in units of real time", slowest, 1),
    Aim("cylcontact --help, in s", measured("start_up", "process", "--help"), 0.3),
    Aim("cylcontact laws, for a joint, in s", measured("start_up", "process", "laws"), 0.9),
    Aim("import cylcontact, in s", measured("start_up", "process", "import cylcontact"), 0.15),
    Aim("Compilation in the first simulation after an install, in s", compilation, 8),
    Aim("All figures from the committed fits, in s", measured("start_up", "figures", "figure"), 30),
)


def save(path: Path, results: dict[str, Any]) -> None:
    """Write the results, complete or not at all."""
    data = results | {"rows": [asdict(row) for row in results["rows"]]}
    with replacing(path) as temporary:
        text = json.dumps(marked(data), indent=1, ensure_ascii=False)
        temporary.write_text(text + "\n", encoding="utf-8")


def load(path: Path) -> dict[str, Any]:
    """Return the results: the computer, why benchmarks were skipped, and the rows as `Row`."""
    data = unmarked(json.loads(path.read_text(encoding="utf-8")), str(path))
    return data | {"rows": [Row(**row) for row in data["rows"]]}


def page(results: dict[str, Any]) -> str:
    """Return the page of the documentation, in Markdown."""
    rows: list[Row] = results["rows"]
    about = dict(results["machine"])
    where = {name: about.pop(name) for name in ("cores", "processor", "system")}
    libraries = ", ".join(f"{name} {value}" for name, value in about.items())
    lines = [HEAD.format(**where, libraries=libraries)]
    lines += ["## Aims", "", "| aim | limit | measured | |", "|---|---|---|---|"]
    for aim in AIMS:
        sign = "≥" if aim.at_least else "≤"
        lines.append(f"| {aim.text} | {sign} {aim.limit:g} {aim.verdict(rows)}")
    lines += ["", "## Ratios", "", "| | time | ratio |", "|---|---:|---:|"]
    for benchmark, case, title in SHOWN:
        sides = [row for row in rows if row.benchmark == benchmark and case in row.case]
        if sides:
            unit = sides[0].unit.partition(" per ")[0]
            lines.append(f"| **{title}** | {unit} | |")
            lines += [_line(row) for row in sides if "not arrived" not in row.note]
    skipped = [f"\nNot measured: {name}, {reason}." for name, reason in results["skipped"].items()]
    return "\n".join([*lines, *skipped]) + "\n"


def _line(row: Row) -> str:
    """Return a row of the table of ratios."""
    note = f" ({row.note})" if row.note else ""
    side = row.side.removeprefix("cylcontact: ") + note
    return f"| {side} | {_short(row.value)} | {_short(row.ratio)} |"


def _short(number: float) -> str:
    """Return a number to three digits, without an exponent."""
    return f"{float(f'{number:.3g}'):,.10g}"
