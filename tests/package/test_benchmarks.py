"""The benchmarks: that all sides give the same answers, and that the page says what was measured.

Times are looked at by `make bench`, on a quiet machine, never here.
"""

import os
import shutil
import subprocess
import sys
import warnings
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from benchmarks import harness, peers
from benchmarks.__main__ import BENCHMARKS
from benchmarks.calibration import CLOSE, require_same_objective
from benchmarks.harness import Side, compare, require_agreement, rows
from benchmarks.page import AIMS, PAGE, RESULTS, find, load, page, save
from benchmarks.sampling import grid_of
from benchmarks.search import space_of
from cylcontact.fitting.runs import searches
from cylcontact.fitting.specs import GeneticSpec
from tests.support.programs import require_program

pytestmark = pytest.mark.slow


@pytest.fixture(autouse=True)
def old_names_of_peers():
    """A benchmark may run another program's code that is deprecated."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        yield


@pytest.mark.parametrize("name", BENCHMARKS)
def test_the_sides_of_every_benchmark_agree(name):
    if name == "finite_element":
        require_program("ccx")
    tables = list(import_module(f"benchmarks.{name}").measure(short=True))
    assert all(len({row.case for row in table}) == 1 for table in tables)
    measured = [row for table in tables for row in table]
    assert measured
    for row in measured:
        assert row.benchmark == name
        assert 0 < row.low <= row.value <= row.high < np.inf
        assert 0 < row.ratio_low <= row.ratio <= row.ratio_high < np.inf


@pytest.mark.parametrize("peer", peers.PEERS)
def test_every_peer_counts_what_it_evaluates_and_ends_at_the_target(peer):
    space = space_of(3, 1, 9, 3)
    samples = peers.rows_of(grid_of(3, 1, 9, 3), space, np.inf)
    assert peers.reach(peer, samples, 0)[1] >= 1
    samples.target = 2 * space.bound
    value, evaluations = peers.reach(peer, samples, 0)
    assert value <= samples.target or evaluations >= peers.BUDGET


def test_the_peers_minimise_what_we_minimise():
    space = space_of(3, 2, 9, 5)
    require_same_objective(space, peers.rows_of(grid_of(3, 2, 9, 5), space, 0.0))


def test_least_squares_on_rows_find_our_minimum():
    space = space_of(3, 1, 9, 3)
    genetic = GeneticSpec(runs=4, populations=(60,), crossovers=("uniform",), generations=100)
    planned = searches(space, genetic, 1)
    best = min(run(*arguments).objective for run, arguments, _ in planned)
    samples = peers.rows_of(grid_of(3, 1, 9, 3), space, CLOSE * best)
    value, _ = peers.reach("scipy least_squares, random starts", samples, 0)
    assert best * (1 - 1e-6) <= value <= CLOSE * best


# --- the harness ------------------------------------------------------------------------------


def test_answers_that_differ_end_a_benchmark():
    sides = [Side("right", lambda: np.array([1.0, 2.0])), Side("wrong", lambda: [1.0, 2.1])]
    require_agreement(sides, 0.1)
    with pytest.raises(AssertionError, match="wrong"):
        require_agreement(sides, 0.01)


def test_ratios_are_formed_round_by_round():
    actual = rows("law", "a case", {"one": [1.0, 2.0, 4.0], "other": [3.0, 2.0, 8.0]}, "ms", 1e3)
    assert [(row.value, row.low, row.high) for row in actual] == [
        (2e3, 1.5e3, 3e3),
        (3e3, 2.5e3, 5.5e3),
    ]
    assert (actual[1].ratio, actual[1].ratio_low, actual[1].ratio_high) == (2.0, 1.5, 2.5)


def test_one_interrupted_round_does_not_decide_the_range():
    (_, other) = rows("law", "", {"one": [1.0] * 5, "other": [2.0, 2.1, 50.0, 1.9, 2.0]}, "s", 1.0)
    assert (other.low, other.value, other.high) == (2.0, 2.0, 2.1)


def test_sides_take_turns(monkeypatch):
    order = []
    sides = [Side(name, lambda name=name: order.append(name)) for name in "abc"]
    monkeypatch.setattr(harness, "LEAST_SECONDS", 0.0)
    compare("law", "turns", sides, rounds=3)
    assert "".join(order[-9:]) == "abcbcacab"


# --- a run ------------------------------------------------------------------------------------

ROOT = Path(__file__).parents[2]


def case(benchmark, name, seconds):
    return rows(benchmark, name, {"a side": [seconds]}, "s", 1.0)


@pytest.fixture
def bench(tmp_path):
    """A repository of two benchmarks, to be replaced, and of results as from an earlier run."""
    (tmp_path / "benchmarks").mkdir()
    for name in ("__main__", "harness", "page"):
        shutil.copy(ROOT / f"benchmarks/{name}.py", tmp_path / "benchmarks")
    stub(tmp_path, "law")
    stub(tmp_path, "search")
    earlier = {
        "law": ("first", "second", "no longer measured"),
        "sampling": ("first",),
        "search": ("first",),
        "finite_element": ("first",),
    }
    table = [row for key, names in earlier.items() for name in names for row in case(key, name, 9)]
    machine = {"processor": "earlier", "cores": 1, "system": "earlier"}
    path = tmp_path / "datasets/benchmarks.json"
    save(path, {"machine": machine, "skipped": {}, "rows": table})
    return tmp_path


def stub(bench, name, fails=""):
    """Write a benchmark of two cases."""
    (bench / f"benchmarks/{name}.py").write_text(
        f"""
from benchmarks.harness import rows

def measure(short):
    yield rows("{name}", "first", {{"a side": [1.0]}}, "s", 1.0)
    {fails}
    yield rows("{name}", "second", {{"a side": [1.0]}}, "s", 1.0)
"""
    )


def run(bench, *arguments):
    """Return the exit code and the errors of a run with no program on the path."""
    command = [sys.executable, "-m", "benchmarks", *arguments]
    env = os.environ | {"PATH": str(bench)}
    done = subprocess.run(command, cwd=bench, env=env, capture_output=True, text=True, check=False)
    return done.returncode, done.stderr


def results_of(bench):
    """Return the results, whose page must stand beside them, and the seconds of every case."""
    results = load(bench / "datasets/benchmarks.json")
    assert (bench / "docs/speed.md").read_text(encoding="utf-8") == page(results)
    return results, {(row.benchmark, row.case): row.value for row in results["rows"]}


def test_what_is_measured_replaces_all_of_the_same_benchmark(bench):
    assert run(bench, "search", "law")[0] == 0
    results, seconds = results_of(bench)
    assert list(seconds.items()) == [
        (("law", "first"), 1),
        (("law", "second"), 1),
        (("sampling", "first"), 9),
        (("search", "first"), 1),
        (("search", "second"), 1),
        (("finite_element", "first"), 9),
    ]
    assert results["machine"]["processor"] != "earlier"
    assert results["skipped"] == {}


def test_a_benchmark_without_its_program_is_skipped_until_it_comes(bench):
    (bench / "benchmarks/finite_element.py").write_text("raise AssertionError")
    code, errors = run(bench, "finite_element")
    assert code == 0
    reason = "needs CalculiX (apt install calculix-ccx)"
    assert errors == f"finite_element: skipped, {reason}\n"
    results, seconds = results_of(bench)
    assert results["skipped"] == {"finite_element": reason}
    assert results["machine"]["processor"] == "earlier"  # nothing was measured
    assert ("finite_element", "first") not in seconds
    assert page(results).endswith(f"\n\nNot measured: finite_element, {reason}.\n")
    (bench / "ccx").touch(mode=0o755)
    stub(bench, "finite_element")
    assert run(bench, "finite_element")[0] == 0
    results, seconds = results_of(bench)
    assert results["skipped"] == {}
    assert seconds["finite_element", "second"] == 1


def test_the_first_run_needs_no_results(bench):
    shutil.rmtree(bench / "datasets")
    assert run(bench, "search")[0] == 0
    assert set(results_of(bench)[1]) == {("search", "first"), ("search", "second")}


def test_short_runs_write_nothing(bench):
    before = (bench / "datasets/benchmarks.json").read_bytes()
    assert run(bench, "--short", "law", "finite_element")[0] == 0
    assert (bench / "datasets/benchmarks.json").read_bytes() == before
    assert not (bench / "docs").exists()


def test_an_error_loses_no_benchmark_that_is_finished(bench):
    stub(bench, "search", fails="raise ZeroDivisionError")
    code, errors = run(bench, "law", "search", "finite_element")
    assert code == 1
    assert errors.endswith("ZeroDivisionError\n")
    _, seconds = results_of(bench)
    assert seconds["law", "second"] == 1
    assert seconds["search", "first"] == seconds["finite_element", "first"] == 9


# --- what is committed ------------------------------------------------------------------------


def test_the_page_is_that_of_the_results():
    results = load(RESULTS)
    assert PAGE.read_text(encoding="utf-8") == page(results)
    assert {row.benchmark for row in results["rows"]} | set(results["skipped"]) == set(BENCHMARKS)


def test_every_aim_is_judged_by_what_was_measured():
    measured = load(RESULTS)["rows"]
    assert [aim.text for aim in AIMS if "reached" not in aim.verdict(measured)] == []
    (aim,) = [aim for aim in AIMS if "--help" in aim.text]
    row = find(measured, "start_up", "process", "--help")
    for seconds, verdict in ((0.2, "| 0.2 | reached |"), (9.0, "| 9 | **not reached** |")):
        assert aim.verdict([replace(row, value=seconds)]) == verdict
    assert aim.verdict([]) == "| not measured | |"
