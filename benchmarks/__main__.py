"""Run the benchmarks and write datasets/benchmarks.json and docs/speed.md; see README.md."""

from __future__ import annotations

import argparse
import os
import platform
import shutil
import sys
import time
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

from benchmarks.harness import Row
from benchmarks.page import PAGE, RESULTS, load, page, save
from cylcontact.files.writing import replacing

BENCHMARKS = (
    "law", "sampling", "search", "calibration", "mechanism", "finite_element", "start_up",
)  # fmt: skip
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
    for name in arguments.names or BENCHMARKS:
        program, reason = PROGRAMS.get(name, ("", ""))
        started, rows = time.perf_counter(), []
        if not program or shutil.which(program):
            reason = ""
            module = import_module(f"benchmarks.{name}")
            rows = [row for table in module.measure(arguments.short) for row in table]
        said = f"skipped, {reason}" if reason else f"{time.perf_counter() - started:.0f} s"
        print(f"{name}: {said}", file=sys.stderr, flush=True)
        if not arguments.short:
            write(name, rows, reason)


def write(name: str, measured: list[Row], skipped: str = "") -> None:
    """Write the results and the page: a benchmark's rows replaced, or why there are none."""
    results = load(RESULTS) if RESULTS.exists() else {"skipped": {}, "rows": []}
    if measured or "machine" not in results:  # a skip says nothing about the rows that stay
        results["machine"] = computer()
    results["skipped"].pop(name, None)
    if skipped:
        results["skipped"][name] = skipped
    rows = measured + [row for row in results["rows"] if row.benchmark != name]
    results["rows"] = sorted(rows, key=lambda row: BENCHMARKS.index(row.benchmark))
    save(RESULTS, results)
    with replacing(PAGE) as temporary:
        temporary.write_text(page(results), encoding="utf-8")


def computer() -> dict[str, str | int]:
    """Return what the numbers depend on."""
    about = Path("/proc/cpuinfo")
    lines = about.read_text().splitlines() if about.exists() else []
    models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    actual: dict[str, str | int] = {
        "processor": models[0] if models else platform.processor() or platform.machine(),
        "cores": os.cpu_count() or 1,
        "system": platform.system(),
        "python": platform.python_version(),
    }
    return actual | {name: version(name) for name in LIBRARIES}


if __name__ == "__main__":
    main()
