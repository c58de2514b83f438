"""Work that needs more memory or disk than there is, is refused before it begins."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from cylcontact import InputError
from cylcontact.datasets.finite_element.setup import Setup
from cylcontact.memory import available, require_memory, require_space
from cylcontact.parallel import call, collect
from tests import large_input as large
from tests.counts import counted
from tests.spec_files import CAMPAIGN, GRID, changed, write_bench, write_toml

pytestmark = pytest.mark.slow


MANY = 10**7
# Grids whose samples, pairs or calls would not fit.
AXIS = {"min": 1.0, "max": 2.0, "points": MANY, "spacing": "linear"}
SIGNED = {"min": -0.4, "max": 0.4, "points": MANY, "spacing": "linear"}
NU = {"min": 0.1, "max": 0.4, "points": MANY, "spacing": "linear"}
HUGE = changed(GRID, {"axes.E": AXIS, "axes.nu": NU, "axes.dR": AXIS, "axes.load": AXIS})
PAIRS = {
    "contact": "internal",
    "reference": "conformal",
    "axes": {"alpha": SIGNED, "beta": SIGNED, "phi": {"values": [1.0]}},
}
# A name, the command and what it says.
REQUESTS = [
    ("samples on a disk", ("sample", "huge.toml", "-o", "out.parquet"), "of disk space"),
    ("samples as text", ("sample", "huge.toml", "-o", "out.csv"), "of disk space"),
    ("pairs of a grid", ("sample", "pairs.toml", "-o", "out.parquet"), "thin alpha or beta"),
    ("moments of a grid", ("fit", "huge-fit.toml", "-j", "1", "-o", "out.json"), "thin the axes"),
    ("workers", ("fit", "fitting/small.toml", "-j", "100000", "-o", "out.json"), "jobs = 100000"),
    ("width", ("figure", "fig12"), "width_mm = 1000000000.0: must be"),
]


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bench")
    write_toml(folder / "huge.toml", HUGE)
    write_toml(folder / "pairs.toml", PAIRS)
    write_toml(folder / "reports/style.toml", {"width_mm": 1e9})
    write_toml(folder / "huge-fit.toml", {**CAMPAIGN, "dataset": "huge.toml"})
    write_bench(folder, {"genetic.runs": 100_000})
    return folder


@pytest.mark.parametrize("request_", REQUESTS, ids=[request[0] for request in REQUESTS])
def test_a_request_beyond_the_machine_is_refused(request_, run, bench, monkeypatch):
    monkeypatch.chdir(bench)
    _, command, said = request_
    before = {path for path in bench.rglob("*") if not path.name.endswith(".lock")}
    with large.frugally():
        status, _, err = run(*command)
    assert status == 2
    assert len([line for line in err.splitlines() if line.startswith("cylcontact:")]) == 1
    assert said in err
    assert "Traceback" not in err
    assert {path for path in bench.rglob("*") if not path.name.endswith(".lock")} == before


def test_the_requests_are_counted():
    counted("requests beyond the machine", len(REQUESTS))


def test_what_is_available_is_less_than_the_machine_has():
    assert 0 < available() < 1e15
    require_memory("example", "", None, available() / 2, "any")
    with pytest.raises(InputError, match=r"needs about .* of memory, and .* are free; use less"):
        require_memory("example", "rows", 1, 2 * available(), "use less")


@pytest.mark.skipif(sys.platform != "linux", reason="Linux tells how much a process has taken")
def test_a_limit_of_the_process_counts():
    code = "from cylcontact.memory import available; print(available())"
    command = ["sh", "-c", 'ulimit -v 2000000 && exec "$0" -c "$1"', sys.executable, code]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    told = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert 0 < float(told.stdout) < 2e6 * 1024
    with Path("/proc/meminfo").open() as file:
        free = next(int(line.split()[1]) for line in file if line.startswith("MemAvailable"))
    assert free > 2e6, "this machine has too little memory to tell the limit from it"


def test_the_disk_is_that_of_a_folder_to_come(tmp_path):
    require_space(tmp_path / "new/folder/file.csv", 1.0, "any")
    with pytest.raises(InputError, match=r"needs about 1.0e\+06 TB of disk space, .*; thin it"):
        require_space(tmp_path / "new/folder/file.csv", 1e18, "thin it")


def test_workers_beyond_the_memory_are_not_started():
    with large.frugally(), pytest.raises(InputError, match=r"jobs = 1000000: .*use fewer: --jobs"):
        collect([call(abs, -1)] * 1_000_000, 1_000_000)


def test_cells_too_small_for_any_memory_are_refused():
    setup = Setup(10.0, 5.0, 207e3, 0.3, size=1e-6, contact_size=1e-6)
    with large.frugally(), pytest.raises(InputError, match="more than 5000 cells lie side by side"):
        setup.mesh(0.1, np.array([10.0]))
