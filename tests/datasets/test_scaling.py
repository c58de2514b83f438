"""A grid of any size: what is held in memory and what is searched do not grow with it."""

import pickle
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.search import problem_of

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
# The most memory that a process has held, in MiB, after it has reduced a grid of a shape.
PEAK = """
import sys
from dataclasses import replace
from benchmarks.sampling import grid_of
from cylcontact.datasets import reduce_grid
from cylcontact.fitting.objectives import max_abs_difference_percent
from cylcontact.fitting.law_models import MODELS
grid = grid_of(*map(int, sys.argv[1:]))
moments, counts = reduce_grid(grid, 2)
model = MODELS["enhanced", "internal"]
max_abs_difference_percent(replace(grid, dR=grid.dR[:2]), model, [model.published], 2)
assert counts.samples + counts.masked == grid.size
status = dict(line.split(":", 1) for line in open("/proc/self/status"))
print(int(status["VmHWM"].split()[0]) / 1024)
"""


def peak_of(shape):
    # Not ru_maxrss, which starts at what the parent holds when it forks.
    command = [sys.executable, "-c", PEAK, *map(str, shape)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    return float(done.stdout)


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere the unit is another one")
def test_memory_does_not_grow_with_the_grid():
    small, large = peak_of((10, 10, 20, 100)), peak_of((50, 20, 20, 250))  # 2e5 and 5e6 samples
    assert large < small + 40
    assert large < 500


def test_what_the_search_is_given_does_not_grow_with_the_grid():
    sizes = [len(pickle.dumps(problem_of(*shape))) for shape in ((5, 3, 20, 10), (40, 20, 20, 50))]
    assert sizes[0] == sizes[1]
