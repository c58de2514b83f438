"""The benchmarks: that all sides give the same answers, and that the page says what was measured.

Times are looked at by `make bench`, on a quiet machine, never here.
"""

from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from benchmarks import harness, peers
from benchmarks.__main__ import BENCHMARKS, PAGE
from benchmarks.calibration import CLOSE, require_same_objective
from benchmarks.harness import Side, compare, require_agreement, rows
from benchmarks.page import AIMS, TITLES, find, load, page, save
from benchmarks.sampling import grid_of
from benchmarks.search import problem_of
from cylcontact import InputError
from cylcontact.fitting.run import execute, plan_runs
from cylcontact.reports.benchmarks import GROUPS, ratio_panel, ratios_of
from tests.programs import require_program

RESULTS = Path(__file__).parents[1] / "benchmarks" / "results.json"
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


@pytest.mark.parametrize("name", BENCHMARKS)
def test_the_sides_of_every_benchmark_agree(name):
    if name == "finite_element":
        require_program("ccx")
    measured = import_module(f"benchmarks.{name}").measure(short=True)
    assert measured
    for row in measured:
        assert row.benchmark in TITLES
        assert 0 < row.low <= row.value <= row.high < np.inf
        assert 0 < row.ratio_low <= row.ratio <= row.ratio_high < np.inf


@pytest.mark.parametrize("peer", peers.PEERS)
def test_every_peer_counts_what_it_evaluates_and_ends_at_the_target(peer):
    problem = problem_of(3, 1, 9, 3)
    samples = peers.rows_of(grid_of(3, 1, 9, 3), problem, np.inf)
    assert peers.reach(peer, samples, 0)[1] >= 1
    samples.target = 2 * problem.objective.bound
    value, evaluations = peers.reach(peer, samples, 0)
    assert value <= samples.target or evaluations >= peers.BUDGET


def test_the_peers_minimise_what_we_minimise():
    problem = problem_of(3, 2, 9, 5)
    require_same_objective(problem, peers.rows_of(grid_of(3, 2, 9, 5), problem, 0.0))


def test_least_squares_on_rows_find_our_minimum():
    problem = problem_of(3, 1, 9, 3)
    plans = plan_runs(4, (60,), ("uniform",), 100, 1)
    best = min(execute(problem, plan).objective for plan in plans)
    samples = peers.rows_of(grid_of(3, 1, 9, 3), problem, CLOSE * best)
    value, _ = peers.reach("scipy least_squares, random starts", samples, 0)
    assert best * (1 - 1e-6) <= value <= CLOSE * best


# --- the harness ------------------------------------------------------------------------------


def test_answers_that_differ_end_a_benchmark():
    sides = [Side("right", lambda: np.array([1.0, 2.0])), Side("wrong", lambda: [1.0, 2.1])]
    require_agreement(sides, 0.1)
    with pytest.raises(AssertionError, match="wrong"):
        require_agreement(sides, 0.01)


def test_ratios_are_formed_round_by_round():
    found = rows("law", "a case", {"one": [1.0, 2.0, 4.0], "other": [3.0, 2.0, 8.0]}, "ms", 1e3)
    assert [(row.value, row.low, row.high) for row in found] == [
        (2e3, 1.5e3, 3e3),
        (3e3, 2.5e3, 5.5e3),
    ]
    assert (found[1].ratio, found[1].ratio_low, found[1].ratio_high) == (2.0, 1.5, 2.5)


def test_one_interrupted_round_does_not_decide_the_range():
    (_, other) = rows("law", "", {"one": [1.0] * 5, "other": [2.0, 2.1, 50.0, 1.9, 2.0]}, "s", 1.0)
    assert (other.low, other.value, other.high) == (2.0, 2.0, 2.1)


def test_sides_take_turns(monkeypatch):
    order = []
    sides = [Side(name, lambda name=name: order.append(name)) for name in "abc"]
    monkeypatch.setattr(harness, "LEAST_SECONDS", 0.0)
    compare("law", "turns", sides, rounds=3)
    assert "".join(order[-9:]) == "abcbcacab"


# --- what is committed ------------------------------------------------------------------------


def test_the_page_is_that_of_the_results():
    assert PAGE.read_text(encoding="utf-8") == page(load(RESULTS))


def test_every_aim_is_judged_by_what_was_measured():
    measured = load(RESULTS)["rows"]
    assert [aim.text for aim in AIMS if "reached" not in aim.verdict(measured)] == []
    (aim,) = [aim for aim in AIMS if "--help" in aim.text]
    row = find(measured, "start-up", "process", "--help")
    for seconds, verdict in ((0.2, "| 0.2 | reached |"), (9.0, "| 9 | **not reached** |")):
        assert aim.verdict([replace(row, value=seconds)]) == verdict
    assert aim.verdict([]) == "| not measured | |"


# --- the figure -------------------------------------------------------------------------------


def results_in(folder, leave_out=""):
    """Results of the figure's groups, one of them perhaps left out; ours is twice the first."""
    found = []
    for name, group in GROUPS.items():
        if name == leave_out:
            continue
        seconds = {
            "a limit": [1.0, 1.0],
            f"cylcontact: {group.ours}": [2.0, 2.0],
            "another": [8.0, 10.0],
        }
        notes = {"another": "computed: 3 evaluations"}
        found += rows(group.benchmark, f"{group.case} …", seconds, "s", 1.0, notes)
    save(folder / "results.json", {}, found)
    return folder / "results.json"


def test_the_figure_shows_ratios_to_ours_whichever_side_comes_first(tmp_path):
    table = ratios_of(results_in(tmp_path))
    assert set(table["group"]) == set(GROUPS)
    by_side = table.groupby("side").first()
    assert by_side.loc["a limit", "ratio"] == 0.5
    assert by_side.loc["another", ["ratio_low", "ratio", "ratio_high"]].tolist() == [
        4.25,
        4.5,
        4.75,
    ]
    assert by_side["computed"].to_dict() == {"a limit": False, "another": True}
    figure = ratio_panel(table)
    labels = [text.get_text() for text in figure.axes[0].get_yticklabels()]
    assert labels == ["a limit", "another"] * len(GROUPS)


def test_the_figure_says_which_results_it_lacks(tmp_path):
    with pytest.raises(InputError, match=r"results.json: cannot be read; make bench writes it"):
        ratios_of(tmp_path / "results.json")
    name = "Genetic search, 120 candidates"
    with pytest.raises(InputError, match=rf"rows = '{name}': is not in the file; redo make bench"):
        ratios_of(results_in(tmp_path, leave_out=name))
