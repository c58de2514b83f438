"""What each step of a calibration costs as the grid grows: `python -m benchmarks.scaling`.

Every size is calibrated in a process of its own, the law, the objective and the search the same.
Times stand beside one numpy.log pass over as many values, taken right after, which says how fast
the machine was just then. Memory is the largest sum over all processes of a run (Linux).
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from statistics import median

import numpy as np

from benchmarks.harness import exit_interrupted
from benchmarks.tether import tethered
from cylcontact.datasets.sampling import BLOCK
from cylcontact.files import replacing
from cylcontact.fitting import calibrate, read_campaign

ROOT = Path(__file__).resolve().parents[1]
CAMPAIGN = ROOT / "benchmarks" / "huge.toml"
JOBS = 2
# Points of E, ν, ΔR and load; the last is the campaign's own grid.
SHAPES = ((25, 10, 100, 40), (50, 20, 100, 100), (100, 40, 100, 250), (250, 40, 100, 1000))
STAGES = ("sampling", "searching", "comparing", "profiling")
COLUMNS = (
    "samples",
    *(f"{stage}_s" for stage in STAGES),
    "total_s",
    "numpy_log_s",
    "sampling_over_log",
    "total_over_log",
    "peak_MiB",
    "objective",
)


def main() -> None:
    """Measure every size and write the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.scaling", description=__doc__)
    parser.add_argument("--short", action="store_true", help="the two smallest sizes")
    parser.add_argument("--one", type=int, help=argparse.SUPPRESS)
    parser.add_argument("-o", "--out", type=Path, default=ROOT / "benchmarks" / "scaling.csv")
    arguments = parser.parse_args()
    if arguments.one is not None:
        try:
            print(json.dumps(measure(SHAPES[arguments.one])))
        except KeyboardInterrupt:  # the process that waits for this one says so
            sys.exit(130)
        return
    rows = []
    try:
        for size in range(2 if arguments.short else len(SHAPES)):
            rows.append(_in_own_process(size))
            with replacing(arguments.out) as temporary:  # what is measured is kept
                temporary.write_text(as_csv(rows), encoding="utf-8")
    except KeyboardInterrupt:
        exit_interrupted(len(rows), arguments.out)


def measure(shape: tuple[int, int, int, int]) -> dict[str, float]:
    """Calibrate on a grid of a shape; return the seconds of each stage and what came out."""
    campaign = read_campaign(CAMPAIGN)
    begun: dict[str, float] = {}

    def note(stage: str, _: int, __: int) -> None:
        begun.setdefault(stage, time.perf_counter())

    begun["sampling"] = time.perf_counter()
    result = calibrate(campaign.on(thinned(campaign.grid, shape)), JOBS, note)
    ends = [*(begun[stage] for stage in STAGES), time.perf_counter()]
    seconds = {f"{stage}_s": ends[k + 1] - ends[k] for k, stage in enumerate(STAGES)}
    log = log_pass(result.counts.samples + result.counts.masked)
    return {
        "samples": result.counts.samples + result.counts.masked,
        **seconds,
        "total_s": ends[-1] - ends[0],
        "numpy_log_s": log,
        "sampling_over_log": seconds["sampling_s"] / log,
        "total_over_log": (ends[-1] - ends[0]) / log,
        "objective": result.objective.value,
    }


def thinned(grid, shape):
    """Return a grid over the same ranges with other numbers of points."""
    nE, nnu, ndR, nload = shape
    return replace(
        grid,
        E=np.geomspace(grid.E[0], grid.E[-1], nE),
        nu=np.linspace(grid.nu[0], grid.nu[-1], nnu),
        dR=np.geomspace(grid.dR[0], grid.dR[-1], ndR),
        load=np.geomspace(grid.load[0], grid.load[-1], nload),
    )


def log_pass(number: int) -> float:
    """Return the seconds of a numpy.log pass over so many values, a block at a time: of three."""
    values, out = np.linspace(1.0, 2.0, BLOCK), np.empty(BLOCK)
    seconds = []
    for _ in range(3):
        started = time.perf_counter()
        for first in range(0, number, BLOCK):
            last = min(BLOCK, number - first)
            np.log(values[:last], out=out[:last])
        seconds.append(time.perf_counter() - started)
    return median(seconds)


def as_csv(rows: list[dict[str, float]]) -> str:
    """Return the table, four digits of each number."""
    lines = [COLUMNS]
    for row in rows:
        cells = (row[column] for column in COLUMNS)
        lines.append([f"{c:.4g}" if isinstance(c, float) else str(c) for c in cells])
    return "".join(",".join(line) + "\n" for line in lines)


def read_table(path: Path) -> list[dict[str, float]]:
    """Read the table back."""
    with path.open(encoding="utf-8", newline="") as file:
        return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]


def _in_own_process(size: int) -> dict[str, float]:
    """Measure one size in a process of its own, watching its memory."""
    command = tethered([sys.executable, "-m", "benchmarks.scaling", "--one", str(size)])
    peak = 0.0
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        while process.poll() is None:
            peak = max(peak, memory_of(process.pid))
            time.sleep(0.2)
        output = process.stdout.read()
    if process.returncode:
        raise SystemExit(process.returncode)
    row = json.loads(output) | {"peak_MiB": peak}
    print(", ".join(f"{key} {value:.4g}" for key, value in row.items()), flush=True)
    return row


def memory_of(pid: int) -> float:
    """Return the memory of a process and all its descendants in MiB, shared parts shared out."""
    family, parents = {pid}, _parents()
    for _ in range(4):
        family |= {child for child, parent in parents.items() if parent in family}
    return sum(_proportional_set_size(member) for member in family) / 1024


def _parents() -> dict[int, int]:
    """Return the parent of every process."""
    actual = {}
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit():
            try:
                actual[int(folder.name)] = int(
                    (folder / "stat").read_text().rsplit(")", 1)[1].split()[1]
                )
            except (OSError, IndexError):
                continue
    return actual


def _proportional_set_size(pid: int) -> int:
    """Return a process's memory in KiB; zero where it has just ended."""
    try:
        lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) for line in lines if line.startswith("Pss:")), 0)


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main()
