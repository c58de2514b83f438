"""How closely unlike processors agree: `python -m benchmarks.cpus` prints the table of a page.

One machine stands for several: numpy, OpenBLAS, numba and the C library each choose their code by
the instructions that the processor has, and each can be told to do without some. Every set of
instructions works in a process of its own. The table is in docs/how-to/cluster.md.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from benchmarks.tether import tethered

ROOT = Path(__file__).resolve().parents[1]
CAMPAIGNS = ("internal", "external", "internal-linear", "conformal", "recovered-internal")
CLEARANCES = (0.02, 0.5)
REVOLUTIONS = (1, 2, 5, 20)
Numbers = dict[str, list[float]]


def main() -> None:
    """Print how far the results differ between the sets of instructions."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.cpus", description=__doc__)
    parser.add_argument("--one", action="store_true", help=argparse.SUPPRESS)
    if parser.parse_args().one:
        print(json.dumps(numbers(CAMPAIGNS, REVOLUTIONS)))
        return
    results = {
        name: in_process([sys.executable, "-m", "benchmarks.cpus", "--one"], variables)
        for name, variables in instruction_sets().items()
    }
    print(as_table(results))


def instruction_sets() -> dict[str, dict[str, str]]:
    """Return the environments that stand for processors, that of this one first.

    Empty but for this one where there is nothing to do without.
    """
    from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

    has = [name for name in __cpu_dispatch__ if __cpu_features__.get(name)]
    beyond = [name for name in has if "512" in name or name == "X86_V4"]
    sets: dict[str, dict[str, str]] = {"this processor": {}}
    if platform.machine() != "x86_64":
        return sets
    if beyond and beyond != has:
        sets["AVX2"] = _without(beyond, "Haswell", "-AVX512F,-AVX512VL,-AVX512BW,-AVX512DQ")
    if has:
        sets["SSE4.2"] = _without(has, "Nehalem", "-AVX512F,-AVX512VL,-AVX2,-AVX,-FMA")
    return sets


def _without(features: list[str], processor: str, hwcaps: str) -> dict[str, str]:
    """Return the environment of a process that is to take this processor for an older one."""
    return {
        "NPY_DISABLE_CPU_FEATURES": " ".join(features),
        "OPENBLAS_CORETYPE": processor,
        "NUMBA_CPU_NAME": processor.lower(),
        "NUMBA_CPU_FEATURES": "",
        "GLIBC_TUNABLES": f"glibc.cpu.hwcaps={hwcaps}",
    }


def in_process(command: list[str], variables: dict[str, str]) -> Numbers:
    """Run a command that prints numbers, with variables in its environment."""
    with TemporaryDirectory() as cache:
        own = {"OPENBLAS_NUM_THREADS": "1", "NUMBA_CACHE_DIR": cache, **variables}
        done = subprocess.run(
            tethered(command),
            cwd=ROOT,
            env={**os.environ, **own},
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
    parsed: Numbers = json.loads(done.stdout)
    return parsed


def numbers(campaigns: tuple[str, ...], revolutions: tuple[int, ...]) -> Numbers:
    """Return what this process gets for moments, fits, runs and finite elements."""
    from cylcontact.datasets.finite_element import Setup, solve
    from cylcontact.datasets.sampling import reduce_grid
    from cylcontact.fitting import calibrate, read_campaign
    from cylcontact.mechanism import read_mechanism, simulate

    out: Numbers = {}
    for name in campaigns:
        campaign = read_campaign(ROOT / f"fitting/{name}.toml")
        moments, _ = reduce_grid(campaign.grid)
        out[f"moments of `{name}`"] = _flat(vars(moments).values())
        result = calibrate(campaign)
        out[f"coefficients of `{name}`"] = [*result.coefficients.values()]
        out[f"objective of `{name}`"] = [result.objective.value]
    setup = Setup(hole_radius=2.245, outer_ratio=3.3, E=207e3, nu=0.3, cells=16)
    cases = solve(setup, 0.1, [20.0, 100.0])
    out["finite elements, penetration"] = [case.penetration for case in cases]
    for clearance in CLEARANCES:
        mechanism = read_mechanism(ROOT / "datasets/slider_crank.toml", clearance=clearance)
        run = simulate(mechanism, revolutions=max(revolutions))
        for count in revolutions:
            last = np.searchsorted(run.rows.revolution, count) - 1
            name = f"`slider_crank`, {clearance:g} mm: place after {count} revolutions"
            out[name] = [*(run.eccentricity[last] * 1e3 / clearance)]
    return out


def _flat(arrays: Any) -> list[float]:
    return [float(value) for array in arrays for value in np.ravel(array)]


def difference(one: list[float], other: list[float]) -> float:
    """Return the largest difference, relative to the largest number."""
    a, b = np.asarray(one), np.asarray(other)
    return float(np.abs(a - b).max() / np.abs(a).max())


def as_table(results: dict[str, Numbers]) -> str:
    """Return the differences from the first set, a row for each quantity."""
    first, *others = results
    lines = [f"| Largest relative difference | {' | '.join(others)} |", "|---" * len(results) + "|"]
    for name, expected in results[first].items():
        cells = [f"{difference(expected, results[other][name]):.1g}" for other in others]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
