"""The benchmarks: all sides give the same answers, and the page shows what was measured.

`make bench` measures times, on a quiet machine; no test does.
"""

import shutil
import sys
import warnings
from importlib import import_module

import numpy as np
import pytest

from benchmarks import __main__ as program
from benchmarks import harness, page
from benchmarks.calibration import PEERS, Samples, calibrations, reach, space_of
from benchmarks.harness import Row, compare, require_agreement, rows
from tests.support.programs import require_program


@pytest.fixture(autouse=True)
def old_names_of_peers():
    """A benchmark may run another program's code that is deprecated."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        yield


@pytest.mark.slow
@pytest.mark.parametrize("name", program.BENCHMARKS)
def test_the_sides_of_every_benchmark_agree(name):
    if name == "calculix":
        require_program("ccx")
    tables = list(import_module(f"benchmarks.{name}").measure(short=True))
    measured = [row for table in tables for row in table]
    assert measured
    assert all(row.value > 0 and 0 < row.ratio < np.inf for row in measured)
    assert [table[0].ratio for table in tables] == [1.0] * len(tables)


@pytest.mark.slow
@pytest.mark.parametrize("peer", PEERS)
def test_every_peer_ends_at_the_target_or_with_its_time(peer):
    shape = (3, 1, 9, 3)
    samples = Samples(shape, 2 * space_of(*shape).bound, seconds=2)
    value, seconds = reach(PEERS[peer], samples, 0)
    assert value <= samples.target or seconds > 2
    samples.target, samples.seconds = 0.0, 0.05
    assert reach(PEERS[peer], samples, 0)[1] < 2


@pytest.mark.slow
def test_least_squares_on_samples_reach_our_minimum():
    """`calibrations` also checks that both have the same objective."""
    ours, theirs = calibrations((3, 1, 9, 3), {"it": PEERS["scipy least_squares"]}, 1, 20)
    assert ours.note == theirs.note == ""  # it has arrived


# --- the harness --------------------------------------------------------------------------------


def test_answers_that_differ_end_a_benchmark():
    sides = {"right": lambda: np.array([1.0, 2.0]), "wrong": lambda: [1.0, 2.1]}
    require_agreement(sides, 0.1)
    with pytest.raises(AssertionError, match="wrong"):
        require_agreement(sides, 0.01)


def test_ratios_are_formed_round_by_round():
    one, other = rows("a case", {"one": [1.0, 2.0, 4.0], "other": [3.0, 2.0, 80.0]}, "ms", 1e3)
    assert one == Row("a case", "one", 2e3, "ms", 1.0)
    assert other == Row("a case", "other", 3e3, "ms", 3.0)


def test_sides_take_turns(monkeypatch):
    order = []
    monkeypatch.setattr(harness, "LEAST_SECONDS", 0.0)
    compare("turns", {name: lambda name=name: order.append(name) for name in "abc"}, rounds=3)
    assert "".join(order[-9:]) == "abcbcacab"


# --- a run --------------------------------------------------------------------------------------


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """Results of an earlier run, and a command line on benchmarks that take no time."""
    monkeypatch.setattr(page, "RESULTS", tmp_path / "benchmarks.json")
    monkeypatch.setattr(page, "PAGE", tmp_path / "validation.md")
    page.write(
        {"machine": {"cores": 1}, "skipped": {}, "rows": {"law": [Row("old", "a", 9, "s", 1)]}}
    )

    class Stub:
        fails = ""

        def measure(self, _):
            yield [Row("new", "a", 1.0, "s", 1.0)]
            assert not self.fails

    stub = Stub()
    monkeypatch.setattr(program, "import_module", lambda _: stub)

    def run(*arguments, fails="", programs=True, load=0.0):
        stub.fails = fails
        monkeypatch.setattr(program.os, "getloadavg", lambda: (load, load, load))
        monkeypatch.setattr(sys, "argv", ["benchmarks", *arguments])
        monkeypatch.setattr(shutil, "which", lambda _: programs or None)
        program.main()
        return page.read()

    return run


def test_a_benchmark_replaces_its_earlier_rows_and_keeps_those_of_others(bench):
    bench("calibration")
    with pytest.raises(AssertionError):
        bench("law", fails="in its second case")
    results = bench("law")
    cases = {name: [row.case for row in part] for name, part in results["rows"].items()}
    assert cases == {"law": ["new"], "calibration": ["new"]}
    assert page.PAGE.read_text(encoding="utf-8") == page.page(results)
    before = page.RESULTS.read_bytes()
    bench("mechanism", "--short")
    assert page.RESULTS.read_bytes() == before


def test_of_a_busy_machine_the_page_shows_ratios_alone(bench):
    results = bench("law", load=99.0)
    assert [row.case for row in results["rows"]["law"]] == ["new" + harness.BUSY]
    shown = page.page(results)
    assert f"| **new{harness.BUSY}** | | |\n| a |  | 1 |" in shown
    by_time, ratio = page.Aim("fast", 2.0, "new", "a"), page.Aim("faster", 2.0, "new", "a", "a")
    rows_of_law = results["rows"]["law"]
    assert by_time.line(rows_of_law) == "| fast | 2 | a busy machine | |"
    assert ratio.line(rows_of_law) == "| faster | 2 | 1 | reached |"


def test_a_benchmark_without_its_program_is_skipped_and_the_page_says_so(bench):
    results = bench("calculix", programs=False)
    assert results["machine"] == {"cores": 1}  # nothing was measured
    reason = "needs CalculiX (apt install calculix-ccx)"
    assert page.page(results).endswith(f"\n\nNot measured: calculix, {reason}.\n")
    assert bench("calculix")["skipped"] == {}


# --- what is committed --------------------------------------------------------------------------


def test_the_page_shows_the_results():
    results = page.read()
    assert page.PAGE.read_text(encoding="utf-8") == page.page(results)
    assert {*results["rows"], *results["skipped"]} == set(program.BENCHMARKS)
    measured = [row for part in results["rows"].values() for row in part]
    assert [aim.text for aim in page.AIMS if "not measured" in aim.line(measured)] == []


def test_an_aim_is_judged_by_the_worst_case():
    cases = [Row(case, side, value, "s", 1) for case in "ab" for side, value in
             (("ours", 2.0 if case == "a" else 6.0), ("theirs", 2.0))]  # fmt: skip
    assert "| 5 | 6 | **missed** |" in page.Aim("", 5, "", "ours").line(cases)
    assert "| 3 | 3 | reached |" in page.Aim("", 3, "", "ours", "theirs").line(cases)
    assert "not measured" in page.Aim("", 4, "c", "ours").line(cases)
