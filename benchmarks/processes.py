"""Whole processes: commands as a user runs them, the first simulation, all figures."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.harness import Row, compare, rows, seconds_of
from cylcontact import CylinderPair, Material
from cylcontact.laws import Johnson

BENCH = Path(__file__).parents[1]
FIT = "fit datasets/examples/pin-in-hole.csv --law johnson --contact internal"
SIMULATE = "simulate datasets/slider_crank.toml --revolutions 2"
CHECK = "check --material bronze --Ri 10 --Rj 9.95 --load 100"
# What a fit with its picture imports.
LIBRARIES = (
    "import numpy, scipy.special, scipy.optimize, matplotlib.figure, "
    "matplotlib.backends.backend_agg, pydantic, typer"
)


def measure(short: bool) -> Iterator[list[Row]]:
    """Yield the time of processes."""
    with tempfile.TemporaryDirectory() as folder:
        run(FIT, "-o", folder)
        commands = {
            "--help": "--help",
            "check": CHECK,
            "fit of a table": f"{FIT} -o {folder}",
            "predict": f"predict {folder}/result.json --load '100 N/mm'",
            "simulate": SIMULATE,
        }
        sides = {f"cylcontact {name}": partial(run, line) for name, line in commands.items()}
        modules = {
            f"import {name}": partial(python, "-c", f"import {name}")
            for name in ("cylcontact", "numpy")
        }
        yield compare("a process", modules | sides, 1 if short else 9, "s", 1.0)
        table = many_readings(Path(folder) / "many.csv", 200 if short else 20_000)
        of_pair = "--law johnson --contact internal --material bronze --Ri 10 --Rj 9.95"
        fits = {
            "start its libraries": partial(python, "-c", LIBRARIES),
            "60 readings": partial(run, f"{FIT} -o {folder}"),
            "20,000 readings": partial(run, f"fit {table} {of_pair} -o {folder}"),
        }
        yield compare("a fit of a table", fits, 1 if short else 5, "s", 1.0)
        if short:
            return
        folders = [f"{folder}/numba{number}" for number in range(3)]
        first = [seconds_of(partial(run, SIMULATE, NUMBA_CACHE_DIR=each)) for each in folders]
        yield rows("the first simulation after an install", {"cylcontact simulate": first})
        # Once: these take longest.
        long = {
            "cylcontact figure": f"figure -o {folder}",
            "cylcontact fit, internal": f"fit fitting/internal.toml --jobs 1 -o {folder}/a.json",
        }
        yield rows(
            "all figures, a campaign", {n: [seconds_of(partial(run, c))] for n, c in long.items()}
        )


def many_readings(path: Path, number: int) -> Path:
    """Write a table of readings with constant and proportional scatter."""
    rng = np.random.default_rng(3)
    pair = CylinderPair.internal(10.0, 9.95, Material.named("bronze"))
    load = np.exp(rng.uniform(np.log(10.0), np.log(1500.0), number))
    depth = 1e3 * Johnson().penetration(load, pair) * (1 + 0.01 * rng.normal(size=number))
    columns = np.column_stack([load, depth + 0.02 * rng.normal(size=number)])
    header = "load_N_per_mm,penetration_um"
    np.savetxt(path, columns, "%.7g", ",", header=header, comments="")
    return path


def run(line: str, *more: str, **environment: str) -> None:
    """Run a command of the package."""
    python("-m", "cylcontact.cli", *shlex.split(line), *more, **environment)


def python(*arguments: str, **environment: str) -> None:
    # As after an install, where Python keeps what it has compiled.
    inherited = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    subprocess.run(
        [sys.executable, *arguments],
        cwd=BENCH,
        check=True,
        capture_output=True,
        env=inherited | environment,
    )
