"""A grid of any size: what is held in memory and what is searched do not grow with it."""

import os
import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks import scaling
from benchmarks.scaling import COLUMNS, SHAPES, log_pass, memory_of, read_table, thinned
from cylcontact.fitting import calibrate, read_campaign
from cylcontact.fitting.calibration import problem_of

pytestmark = pytest.mark.slow


ROOT = Path(__file__).resolve().parents[2]
HUGE = ROOT / "benchmarks/huge.toml"
TABLE = ROOT / "benchmarks/scaling.csv"

# The most memory that a process has held, in MiB, after it has reduced a grid of a shape.
PEAK = """
import sys
from dataclasses import replace
from benchmarks.scaling import thinned
from cylcontact.datasets import read_grid, reduce_grid
from cylcontact.fitting.objectives import max_abs_difference_percent
from cylcontact.fitting.law_models import MODELS
shape = tuple(map(int, sys.argv[1:]))
grid = thinned(read_grid("datasets/huge.toml"), shape)
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


def campaign_of(shape):
    campaign = read_campaign(HUGE, runs=1)
    return campaign.on(thinned(campaign.grid, shape))


def test_the_huge_grid_has_a_thousand_million_samples():
    grid = read_campaign(HUGE).grid
    assert grid.size == 10**9
    assert grid.shape == SHAPES[-1]


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere the unit is another one")
def test_memory_does_not_grow_with_the_grid():
    small, large = peak_of((10, 10, 20, 100)), peak_of((50, 20, 20, 250))  # 2e5 and 5e6 samples
    assert large < small + 40
    assert large < 500


def test_what_the_search_is_given_does_not_grow_with_the_grid():
    sizes = []
    for shape in ((5, 3, 20, 10), (40, 20, 20, 50)):
        problem, counts = problem_of(campaign_of(shape), 1, lambda *_: None)
        assert counts.samples + counts.masked == np.prod(shape)
        sizes.append(len(pickle.dumps(problem)))
    assert sizes[0] == sizes[1]


def test_every_stage_is_reported_in_the_order_of_the_table():
    seen = []
    campaign = campaign_of((5, 3, 20, 10))
    genetic = campaign.spec.genetic.model_copy(update={"populations": (8,), "generations": 5})
    quick = replace(campaign, spec=campaign.spec.model_copy(update={"genetic": genetic}))
    calibrate(quick, progress=lambda stage, *_: seen.append(stage))
    stages = [column.removesuffix("_s") for column in COLUMNS if column.endswith("ing_s")]
    assert list(dict.fromkeys(seen)) == stages


def test_the_committed_table():
    """Sampling grows with the grid, the search does not, and memory is bounded."""
    rows = read_table(TABLE)
    assert [row["samples"] for row in rows] == [np.prod(shape) for shape in SHAPES]
    assert all(row["peak_MiB"] < 500 for row in rows)
    assert all(
        row["sampling_over_log"] == pytest.approx(row["sampling_s"] / row["numpy_log_s"], rel=1e-2)
        for row in rows
    )
    # The finer the grid, the closer the objective comes to that of the continuous domain.
    objectives = [row["objective"] for row in rows]
    steps = -np.diff(objectives)
    assert (steps > 0).all()
    assert (np.diff(steps) < 0).all()


def test_an_interrupted_run_says_what_is_kept(tmp_path, monkeypatch, capsys):
    def measure(size):
        if size:
            raise KeyboardInterrupt
        return read_table(TABLE)[0]

    out = tmp_path / "scaling.csv"
    monkeypatch.setattr(scaling, "_in_own_process", measure)
    monkeypatch.setattr(sys, "argv", ["scaling", "-o", str(out)])
    with pytest.raises(SystemExit, match="130"):
        scaling.main()
    assert capsys.readouterr().err == f"interrupted; 1 measurement is kept in {out}\n"
    assert read_table(out) == read_table(TABLE)[:1]


@pytest.mark.skipif(sys.platform != "linux", reason="/proc is Linux's")
def test_the_yardsticks_of_time_and_memory():
    assert log_pass(3) > 0
    assert memory_of(os.getpid()) > 20  # MiB: numpy alone
    assert memory_of(2**30) == 0  # no process has this number
