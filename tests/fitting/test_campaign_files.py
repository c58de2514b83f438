"""Campaign files: what the shipped ones say, where datasets are found, every way to go wrong."""

import json
from pathlib import Path

import pytest

from cylcontact.fitting import read_campaign
from cylcontact.fitting.law_models import MODELS
from cylcontact.fitting.tables import campaign_of
from tests.support.spec_files import (
    CAMPAIGN,
    DROP,
    GRID,
    changed,
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
