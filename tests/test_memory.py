"""Work that needs more memory or disk than there is, is refused before it begins."""

import importlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from cylcontact import InputError, memory
from cylcontact.datasets.finite_element import Setup, solve
from cylcontact.datasets.grid import grid_from, read_grid
from cylcontact.datasets.sampling import reduce_grid, write_samples
from cylcontact.fitting.calibration import problem_of
from cylcontact.memory import as_size, available, require_memory, require_space
from cylcontact.mechanism import cases, long_run, read_mechanism, simulate
from cylcontact.parallel import call, collect
from tests import large_input as large
from tests.counts import counted
from tests.spec_files import GRID, changed, write_bench, write_toml

ROOT = Path(__file__).resolve().parents[1]
CRANK = str(ROOT / "datasets/slider_crank.toml")
MANY = 10**7
# Grids whose samples, pairs or calls would not fit.
AXIS = {"min": 1.0, "max": 2.0, "points": MANY, "spacing": "linear"}
SIGNED = {"min": -0.4, "max": 0.4, "points": MANY, "spacing": "linear"}
HUGE = changed(GRID, {"axes.E": AXIS, "axes.dR": AXIS, "axes.load": AXIS})
PAIRS = {
    "contact": "internal",
    "reference": "conformal",
    "axes": {"alpha": SIGNED, "beta": SIGNED, "phi": {"values": [1.0]}},
}
FINE = {
    **{"hole_radius": 10.0, "outer_ratio": 5.0, "E": 207.0, "nu": 0.3, "dR": [0.1]},
    **{"load": [10.0], "size": 1e-3, "contact_size": 1e-6},
}
FINE["origin"] = dict.fromkeys(FINE, "assumed")
NUMBERS = ",".join(map(str, range(1, 3000)))
FREE = "are free"
# A name, the command and what it says.
REQUESTS = [
    ("samples on a disk", ("sample", "huge.toml", "-o", "out.parquet"), "of disk space"),
    ("samples as text", ("sample", "huge.toml", "-o", "out.csv"), "of disk space"),
    ("pairs of a grid", ("sample", "pairs.toml", "-o", "out.parquet"), "thin alpha or beta"),
    ("moments of a grid", ("fit", "huge-fit.toml", "-j", "1", "-o", "out.json"), "thin the axes"),
    ("revolutions", ("simulate", CRANK, "--revolutions", "1000000000"), "revolutions = 1000000000"),
    (
        "a trajectory",
        ("simulate", CRANK, "--revolutions", "1000000000", "-o", "out.parquet"),
        "or write no trajectory: statistics need none",
    ),
    (
        "frames",
        ("simulate", CRANK, "--revolutions", "1000000", "-o", "out.gif"),
        "film fewer, or write a .mp4",
    ),
    (
        "cases",
        *(
            (
                *("simulate", CRANK, "--study", "cases", "-o", "out.csv", "--clearance", NUMBERS),
                *("--restitution", NUMBERS, "--friction", NUMBERS),
            ),
            "vary fewer values at a time",
        ),
    ),
    (
        "clearances",
        (
            *("simulate", CRANK, "--study", "bifurcation", "-o", "out.csv"),
            *("--points", "1000000000000"),
        ),
        "--points = 1000000000000: needs about",
    ),
    (
        "cells",
        ("finite-element", "fine.toml", "-j", "1", "-o", "out.csv"),
        "more than 5000 cells lie side by side",
    ),
    ("width", ("figure", "fig12"), "width_mm = 1000000000.0: must be"),
    ("workers", ("fit", "many.toml", "-j", "100000", "-o", "out.json"), "use fewer: --jobs"),
]


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bench")
    runs = {"genetic.runs": 100_000, "genetic.generations": 1}
    write_bench(folder, runs).rename(folder / "many.toml")
    write_toml(folder / "huge.toml", HUGE)
    write_toml(folder / "pairs.toml", PAIRS)
    write_toml(folder / "fine.toml", FINE)
    write_toml(folder / "reports/style.toml", {"width_mm": 1e9})
    text = (folder / "many.toml").read_text()
    (folder / "huge-fit.toml").write_text(text.replace("datasets/small.toml", "huge.toml"))
    return folder


@pytest.mark.parametrize("request_", REQUESTS, ids=[request[0] for request in REQUESTS])
def test_a_request_beyond_the_machine_is_refused(request_, run, bench, monkeypatch):
    monkeypatch.chdir(bench)
    _, command, said = request_
    before = {path for path in bench.rglob("*") if not path.name.endswith(".lock")}
    with large.frugally():
        status, _, err = run(*command)
    lines = [line for line in err.splitlines() if line.startswith("cylcontact:")]
    assert status in (1, 2)
    assert len(lines) == 1
    assert said in err
    assert "Traceback" not in err
    assert {path for path in bench.rglob("*") if not path.name.endswith(".lock")} == before


def test_the_requests_are_counted():
    counted("requests beyond the machine", len(REQUESTS))
