"""Run the benchmarks and write datasets/benchmarks.json and docs/speed.md; see README.md."""

from __future__ import annotations

import argparse
import os
import platform
import shutil
import sys
import time
from collections.abc import Iterator, Sequence
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

from benchmarks.harness import Row, exit_interrupted
from benchmarks.page import RESULTS, ROOT, TITLES, load, page, save
from cylcontact.files import replacing

PAGE = ROOT / "docs" / "speed.md"
BENCHMARKS = tuple(TITLES)
# Programs that no Python package brings, and why a benchmark without its program is skipped.
PROGRAMS = {"finite_element": ("ccx", "needs CalculiX (apt install calculix-ccx)")}
LIBRARIES = ("cylcontact", "numpy", "scipy", "numba", "pygad", "pymoo", "cma", "lmfit", "exudyn")


def main() -> None:
    """Run what is named on the command line, by default everything."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(BENCHMARKS))
    parser.add_argument("--short", action="store_true", help="small sizes, nothing written")
    arguments = parser.parse_args()
    unknown = set(arguments.names) - set(BENCHMARKS)
    if unknown:
        parser.error(f"no such benchmark: {', '.join(sorted(unknown))}")
    written = 0
    try:
        for _ in run(arguments.names or BENCHMARKS, arguments.short):
            written += 1
    except KeyboardInterrupt:
        exit_interrupted(written, RESULTS.relative_to(ROOT))


def run(names: Sequence[str], short: bool) -> Iterator[None]:
    """Run benchmarks, those without their program excepted; yield after each case written."""
    skipped = {
        name: reason
        for name, (program, reason) in PROGRAMS.items()
        if name in names and shutil.which(program) is None
    }
    for name, reason in skipped.items():
        print(f"{name}: skipped, {reason}", file=sys.stderr, flush=True)
    for name in names:
        measured: list[Row] = []
        if name not in skipped:
            started = time.perf_counter()
            for table in import_module(f"benchmarks.{name}").measure(short):
                measured += table
                if not short:
                    write(name, measured)
                    yield
            print(f"{name}: {time.perf_counter() - started:.0f} s", file=sys.stderr, flush=True)
        if not short:
            write(name, measured, complete=True, skipped=skipped.get(name, ""))


def write(name: str, measured: list[Row], complete: bool = False, skipped: str = "") -> None:
    """Write the results and the page, a benchmark's earlier rows replaced.

    Parameters
    ----------
    name : str
        The benchmark.
    measured : list of Row
        What this run has measured of it.
    complete : bool
        Whether that is all; if not, earlier rows of the cases still to come stay.
    skipped : str
        Why it was not measured.
    """
    results = load(RESULTS) if RESULTS.exists() else {"skipped": {}, "rows": []}
    if measured or "machine" not in results:  # a skip says nothing about the rows that stay
        results["machine"] = machine()
    results["skipped"].pop(name, None)
    if skipped:
        results["skipped"][name] = skipped
    cases = {row.case for row in measured}
    earlier = [
        row
        for row in results["rows"]
        if row.benchmark != name or not (complete or row.case in cases)
    ]
    # Sorting is stable: the cases of this run come first, in their order.
    results["rows"] = sorted(measured + earlier, key=lambda row: BENCHMARKS.index(row.benchmark))
    save(RESULTS, results)
    with replacing(PAGE) as temporary:
        temporary.write_text(page(results), encoding="utf-8")


def machine() -> dict[str, str | int]:
    """Return what the numbers depend on."""
    about = Path("/proc/cpuinfo")
    models = [
        line.split(":", 1)[1].strip()
        for line in (about.read_text().splitlines() if about.exists() else [])
        if line.startswith("model name")
    ]
    actual: dict[str, str | int] = {
        "processor": models[0] if models else platform.processor() or platform.machine(),
        "cores": os.cpu_count() or 1,
        "system": platform.system(),
        "python": platform.python_version(),
    }
    return actual | {name: version(name) for name in LIBRARIES}


if __name__ == "__main__":
    main()
