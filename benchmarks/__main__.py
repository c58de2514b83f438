"""Run the benchmarks and write results.json and docs/speed.md; see README.md."""

from __future__ import annotations

import argparse
import os
import platform
import sys
import time
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

from benchmarks.page import TITLES, load, page, save

HERE = Path(__file__).parent
PAGE = HERE.parent / "docs" / "speed.md"
BENCHMARKS = (
    "law",
    "sampling",
    "search",
    "calibration",
    "mechanism",
    "finite_element",
    "start_up",
)
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
    results = HERE / "results.json"
    kept = load(results)["rows"] if results.exists() else []
    for name in arguments.names or BENCHMARKS:
        started = time.perf_counter()
        measured = import_module(f"benchmarks.{name}").measure(arguments.short)
        print(f"{name}: {time.perf_counter() - started:.0f} s", file=sys.stderr, flush=True)
        replaced = {row.benchmark for row in measured}
        kept = [row for row in kept if row.benchmark not in replaced] + measured
        if not arguments.short:
            save(
                results, machine(), sorted(kept, key=lambda row: list(TITLES).index(row.benchmark))
            )
            PAGE.write_text(page(load(results)), encoding="utf-8")


def machine() -> dict[str, str | int]:
    """Return what the numbers depend on."""
    about = Path("/proc/cpuinfo")
    models = [
        line.split(":", 1)[1].strip()
        for line in (about.read_text().splitlines() if about.exists() else [])
        if line.startswith("model name")
    ]
    found: dict[str, str | int] = {
        "processor": models[0] if models else platform.processor() or platform.machine(),
        "cores": os.cpu_count() or 1,
        "system": platform.system(),
        "python": platform.python_version(),
    }
    return found | {name: version(name) for name in LIBRARIES}


if __name__ == "__main__":
    main()
