"""The benchmarks: all sides give the same answers, and the page shows what was measured.

`make bench` measures times, on a quiet machine; no test does.
"""

import warnings
from importlib import import_module

import numpy as np
import pytest

from benchmarks import __main__ as program
from benchmarks import page
from benchmarks.calibration import PEERS, Samples, calibrations, reach, space_of
from benchmarks.harness import require_agreement
from tests.support.programs import require_program
from tests.support.samples import sampled


@pytest.fixture(autouse=True)
def old_names_of_peers():
    """A benchmark may run another program's code that is deprecated."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        yield


MINUTES = ("calculix", "calibration", "processes")


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    sampled(program.BENCHMARKS, set(program.BENCHMARKS) - set(MINUTES), pytest.mark.long),
)
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


def test_answers_that_differ_end_a_benchmark():
    sides = {"right": lambda: np.array([1.0, 2.0]), "wrong": lambda: [1.0, 2.1]}
    require_agreement(sides, 0.1)
    with pytest.raises(AssertionError, match="wrong"):
        require_agreement(sides, 0.01)


def test_the_page_shows_the_results():
    results = page.read()
    assert page.PAGE.read_text(encoding="utf-8") == page.page(results)
    assert {*results["rows"], *results["skipped"]} == set(program.BENCHMARKS)
    measured = [row for part in results["rows"].values() for row in part]
    assert [aim.text for aim in page.AIMS if "not measured" in aim.line(measured)] == []
