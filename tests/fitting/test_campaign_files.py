"""Campaign files: what the shipped ones say, where datasets are found, every way to go wrong."""

import json
from pathlib import Path

import pytest

from cylcontact import InputError
from cylcontact.fitting import read_campaign
from cylcontact.fitting.law_models import MODELS
from cylcontact.fitting.tables import campaign_of
from tests.support.spec_files import (
    CAMPAIGN,
    DROP,
    GRID,
    assert_told,
    changed,
    labels,
    write_bench,
    write_toml,
)

ROOT = Path(__file__).resolve().parents[2]
SHIPPED = sorted((ROOT / "fitting").glob("*.toml"))
INTERNAL = ("a", "b", "Y_log_scale", "Y_log_exponent", "Y_slope", "Y_offset", "n_exponent")


# --- the shipped campaigns --------------------------------------------------------------------


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_every_shipped_campaign_searches_around_what_is_published(path):
    campaign = read_campaign(path)
    assert campaign.name == path.stem
    assert {p.name for p in campaign.parameters} == set(campaign.model.names)
    for parameter in campaign.parameters:
        if campaign.model.published is not None and parameter.is_free:
            assert parameter.low < campaign.model.published[parameter.name] < parameter.high


# --- what is read -----------------------------------------------------------------------------


def test_a_parameter_left_out_is_searched_between_the_bounds_of_the_law(tmp_path):
    n = MODELS["power", "internal"].parameters[1]
    for left_out in ({"bounds.n": DROP}, {"bounds": DROP}):
        campaign = read_campaign(write_bench(tmp_path, left_out))
        assert campaign.parameters[1] == n
        bounds = campaign.settings["campaign"]["bounds"]
        assert bounds["n"] == [n.low, n.high]
        assert list(bounds) == ["K_star", "n"]


def test_runs_and_seed_may_be_given_instead_of_the_files(tmp_path):
    path = write_bench(tmp_path)
    campaign = read_campaign(path, runs=5, seed=0)
    assert (campaign.spec.genetic.runs, campaign.spec.seed) == (5, 0)
    assert campaign.settings["campaign"]["genetic"]["runs"] == 5
    assert campaign.settings["campaign"]["seed"] == 0
    without = write_bench(tmp_path, {"genetic": DROP})
    assert read_campaign(without, runs=5).spec.genetic.runs == 5


def test_a_dataset_is_found_beside_the_campaign_or_above_it(tmp_path, monkeypatch):
    for dataset in ("small.toml", "grids/small.toml", "../elsewhere/small.toml"):
        write_toml(tmp_path / "fitting" / dataset, GRID)
        path = write_toml(tmp_path / "fitting/c.toml", changed(CAMPAIGN, {"dataset": dataset}))
        assert read_campaign(path).grid.size == 96
    path = write_bench(tmp_path)
    monkeypatch.chdir(path.parent)
    assert read_campaign(path.name).grid.source == "../datasets/small.toml"


def test_the_key_changes_with_whatever_the_result_depends_on(tmp_path):
    path = write_bench(tmp_path)
    key = read_campaign(path).key
    assert read_campaign(path).key == key
    for changes in (
        {"seed": 8},
        {"bounds.n": [1, 1.6]},
        {"genetic.generations": 6},
        {"objective": "rms-difference-percent"},
    ):
        assert read_campaign(write_bench(tmp_path, changes)).key != key
    path = write_bench(tmp_path)
    write_toml(tmp_path / "datasets/small.toml", changed(GRID, {"axes.E.points": 2}))
    assert read_campaign(path).key != key


def test_a_campaign_is_redone_from_its_settings(tmp_path):
    campaign = read_campaign(write_bench(tmp_path))
    settings = json.loads(json.dumps(campaign.settings))
    again = campaign_of("small", settings, "r.json")
    assert again.key == campaign.key
    assert again.parameters == campaign.parameters
    assert again.grid.size == campaign.grid.size


# --- bad input --------------------------------------------------------------------------------

# What no schema says; tests/cli/test_malformed.py has the rest.
# Changes to a good campaign; the key, value, rule and remedy of the error.
BAD_INPUT = [
    ({"law": "hertz"}, "law", "hertz", "is not a law that can be fitted", "enhanced or"),
    ({"objective": "rms"}, "objective", "rms", "is not a known objective", "rms-log-penetration"),
    *(
        ({"genetic.populations": sizes}, "genetic.populations", sizes, "sizes from 4", "e.g. [60")
        for sizes in ([], [3], [100_001])
    ),
    *(
        ({"genetic.crossovers": names}, "genetic.crossovers", names, "known crossovers", "blend")
        for names in ([], ["blend", "two-points"])
    ),
    ({"bounds.n": [1.5, 1]}, "bounds.n", [1.5, 1.0], "below the upper bound", "use [fixed]"),
    ({"bounds.n": [1]}, "bounds.n.1", None, "is required", "[bounds]"),
    ({"bounds.n": ["1", 2]}, "bounds.n.0", "1", "must be a number", "[bounds]"),
    ({"fixed.n": 1.1}, "fixed.n", None, "is also in [bounds]", "keep one of them"),
    ({"ties.n": "K_star"}, "ties.n", None, "is also in [bounds]", "keep one of them"),
    (
        {"bounds": {}, "fixed": {"K_star": 1.1, "n": 1.1}},
        *("parameters", None, "are all fixed or tied", "free at least one"),
    ),
    (
        {"bounds.m": [1, 2]},
        *("bounds.m", None, "not a parameter of power for internal", "K_star, n"),
    ),
    ({"fixed.m": 1}, "fixed.m", None, "not a parameter of power for internal", "K_star, n"),
    # of 1.0.0rc1
    ({"parameters.n": {"low": 1}}, "parameters", None, "is gone", "write [bounds]"),
    ({"optimizer": "cma"}, "optimizer", None, "is gone", "leave it out"),
    *(
        ({"dataset": name}, "dataset", name, "no such file beside the campaign or above", "e.g.")
        for name in ("datasets/none.toml", "datasets", "a\0b")
    ),
]


@pytest.mark.parametrize(
    ("changes", "key", "value", "rule", "remedy"), BAD_INPUT, ids=labels(BAD_INPUT)
)
def test_bad_input_is_told_by_file_key_value_rule_and_remedy(
    tmp_path, changes, key, value, rule, remedy
):
    path = write_bench(tmp_path, changes)
    with pytest.raises(InputError) as caught:
        read_campaign(path)
    assert_told(caught, path, key, value, rule, remedy)


@pytest.mark.parametrize("values", [[0.001, 1.0], [1.0, 10.1]])
def test_clearances_that_the_law_is_not_stated_for_are_refused(tmp_path, values):
    law = {"law": "enhanced", "bounds": {name: [0.1, 1.0] for name in INTERNAL}}
    path = write_bench(tmp_path, law)
    write_toml(tmp_path / "datasets/small.toml", changed(GRID, {"axes.dR": {"values": values}}))
    with pytest.raises(InputError) as caught:
        read_campaign(path)
    rule = "ΔR (mm) leave the range of the enhanced law for internal contact, 0.005 to 10 mm"
    assert_told(caught, path, "dataset", values, rule, "narrow the dR axis of the grid")


def test_a_grid_is_no_campaign_and_a_campaign_no_grid(tmp_path):
    write_bench(tmp_path)
    path = tmp_path / "datasets/small.toml"
    with pytest.raises(InputError) as caught:
        read_campaign(path)
    assert_told(caught, path, "", None, "is a grid spec, not a campaign", "name a campaign")
