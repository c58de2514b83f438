"""Start-up: the import, the command line's help, and every figure from the committed fits."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from benchmarks.harness import Row, Side, compare, rows, seconds_of

BENCH = Path(__file__).parents[1]
CYLCONTACT = (sys.executable, "-m", "cylcontact.cli")


def measure(short: bool) -> Iterator[list[Row]]:
    """Yield the wall-clock time of fresh processes."""
    imports = [
        Side("import cylcontact", partial(_run, sys.executable, "-c", "import cylcontact")),
        Side("import numpy", partial(_run, sys.executable, "-c", "import numpy")),
        Side("cylcontact --help", partial(_run, *CYLCONTACT, "--help")),
    ]
    yield compare("start_up", "a fresh process", imports, 1 if short else 9, "s", 1.0)
    if short:
        return
    with tempfile.TemporaryDirectory() as folder:
        draw = Side("cylcontact figure", partial(_run, *CYLCONTACT, "figure", "-o", folder))
        # Once: a fresh process is as warm as it will be, and this is the longest of all sides.
        seconds = {draw.name: [seconds_of(draw)]}
    yield rows("start_up", f"{len(list(BENCH.glob('reports/*.py')))} figures", seconds, "s", 1.0)


def _run(*command: str) -> None:
    subprocess.run(command, cwd=BENCH, check=True, capture_output=True)
