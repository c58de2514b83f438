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

from benchmarks.harness import Row, compare, rows, seconds_of

BENCH = Path(__file__).parents[1]
FIT = "fit datasets/examples/pin-in-hole.csv --law johnson --contact internal"
SIMULATE = "simulate datasets/slider_crank.toml --revolutions 2"
CHECK = "check --material bronze --Ri 10 --Rj 9.95 --load 100"


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
