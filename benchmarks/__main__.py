"""Run the benchmarks and write datasets/benchmarks.json and docs/validation.md; see README.md."""

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

from benchmarks.harness import BUSY
from benchmarks.page import read, write

BENCHMARKS = ("law", "many", "calibration", "mechanism", "calculix", "processes")
# Programs that pip cannot install; without them a benchmark is skipped.
PROGRAMS = {"calculix": ("ccx", "needs CalculiX (apt install calculix-ccx)")}
LIBRARIES = ("cylcontact", "numpy", "scipy", "numba", "pygad", "cma", "lmfit", "exudyn")


def main() -> None:
    """Run the benchmarks named on the command line, or all; write after each."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(BENCHMARKS))
    parser.add_argument("--short", action="store_true", help="small sizes, nothing written")
    parser.add_argument("--page", action="store_true", help="write the page alone")
    arguments = parser.parse_args()
    unknown = set(arguments.names) - set(BENCHMARKS)
    if unknown:
        parser.error(f"no such benchmark: {', '.join(sorted(unknown))}")
    results = read()
    if arguments.page:
        write(results)
        return
    # What else runs: the benchmarks themselves load no more than all cores.
    is_busy = os.getloadavg()[0] > (os.cpu_count() or 1) + 1
    for name in arguments.names or BENCHMARKS:
        program, reason = PROGRAMS.get(name, ("", ""))
        started, rows = time.perf_counter(), []
        if not program or shutil.which(program):
            reason = ""
            measured = import_module(f"benchmarks.{name}").measure(arguments.short)
            rows = [row for table in measured for row in table]
            if is_busy:
                rows = [row._replace(case=row.case + BUSY) for row in rows]
        outcome = f"skipped, {reason}" if reason else f"{time.perf_counter() - started:.0f} s"
        print(f"{name}: {outcome}", file=sys.stderr, flush=True)
        if arguments.short:
            continue
        results["skipped"].pop(name, None)
        if rows:
            results["machine"] = computer()
            results["rows"][name] = rows
        else:  # rows measured earlier stay
            results["skipped"][name] = reason
        results["rows"] = {n: results["rows"][n] for n in BENCHMARKS if n in results["rows"]}
        write(results)


def computer() -> dict[str, str | int]:
    """Return what the numbers depend on."""
    about = Path("/proc/cpuinfo")
    lines = about.read_text().splitlines() if about.exists() else []
    models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return {
        "processor": models[0] if models else platform.processor() or platform.machine(),
        "cores": os.cpu_count() or 1,
        "system": platform.system(),
        "python": platform.python_version(),
        **{name: version(name) for name in LIBRARIES},
    }


if __name__ == "__main__":
    main()
