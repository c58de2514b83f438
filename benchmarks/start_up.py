"""Start-up: the import, the help, the first simulation after an install, and every figure."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from benchmarks.harness import Row, Side, compare, rows, seconds_of
from cylcontact.reports.figures import recipes

BENCH = Path(__file__).parents[1]
CYLCONTACT = (sys.executable, "-m", "cylcontact.cli")
SIMULATE = (*CYLCONTACT, "simulate", "datasets/slider_crank.toml", "--revolutions", "2")
LAWS = "laws --material bronze --Ri 10 --Rj 9.95 --load 100"
# As after an install: a sandbox may keep Python from saving what it has compiled.
ENVIRONMENT = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}


def measure(short: bool) -> Iterator[list[Row]]:
    """Yield the wall-clock time of fresh processes."""
    imports = [
        Side("import cylcontact", partial(_run, sys.executable, "-c", "import cylcontact")),
        Side("import numpy", partial(_run, sys.executable, "-c", "import numpy")),
        Side("cylcontact --help", partial(_run, *CYLCONTACT, "--help")),
        Side("cylcontact laws", partial(_run, *CYLCONTACT, *LAWS.split())),
    ]
    yield compare("start_up", "a fresh process", imports, 1 if short else 9, "s", 1.0)
    if short:
        return
    seconds = {"with what numba compiles": [], "again": []}
    for _ in range(3):
        with tempfile.TemporaryDirectory() as folder:
            simulate = Side("", partial(_run, *SIMULATE, NUMBA_CACHE_DIR=folder))
            for times in seconds.values():
                times.append(seconds_of(simulate))
    yield rows("start_up", "the first simulation after an install", seconds, "s", 1.0)
    with tempfile.TemporaryDirectory() as folder:
        draw = Side("cylcontact figure", partial(_run, *CYLCONTACT, "figure", "-o", folder))
        # Once: a fresh process is as warm as it will be, and this is the longest of all sides.
        seconds = {draw.name: [seconds_of(draw)]}
    yield rows("start_up", f"{len(recipes(BENCH))} figures", seconds, "s", 1.0)


def _run(*command: str, **environment: str) -> None:
    environment = ENVIRONMENT | environment
    subprocess.run(command, cwd=BENCH, check=True, capture_output=True, env=environment)
