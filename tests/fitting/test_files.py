"""Campaign files and result files: what the shipped ones say, and what is written and read back."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

import cylcontact as cc
from cylcontact.fitting import Campaign, DataFit, LawFit, read_result
from cylcontact.fitting.calibration import sentences_on, space_of
from cylcontact.fitting.law_models import MODELS
from cylcontact.fitting.results import basins, on_runs
from tests.support.spec_files import (
    CAMPAIGN,
    DROP,
    GRID,
    changed,
    tree,
    write_bench,
    write_toml,
)

ROOT = Path(__file__).resolve().parents[2]
SHIPPED = sorted((ROOT / "fitting").glob("*.toml"))


# --- the shipped campaigns --------------------------------------------------------------------


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_every_shipped_campaign_searches_around_what_is_published(path):
    campaign = Campaign.read(path)
    assert campaign.name == path.stem
    assert {p.name for p in campaign.parameters} == set(campaign.model.names)
    for parameter in campaign.parameters:
        if campaign.model.published is not None and parameter.is_free:
            assert parameter.low < campaign.model.published[parameter.name] < parameter.high


# --- what is read -----------------------------------------------------------------------------


def test_a_parameter_left_out_is_searched_between_the_bounds_of_the_law(tmp_path):
    n = MODELS["power", "internal"].parameters[1]
    for left_out in ({"bounds.n": DROP}, {"bounds": DROP}):
        campaign = Campaign.read(write_bench(tmp_path, left_out))
        assert campaign.parameters[1] == n
        bounds = campaign.settings["campaign"]["bounds"]
        assert bounds["n"] == [n.low, n.high]
        assert list(bounds) == ["K_star", "n"]


def test_runs_and_seed_may_be_given_instead_of_the_files(tmp_path):
    path = write_bench(tmp_path)
    campaign = Campaign.read(path, runs=5, seed=0)
    assert (campaign.spec.genetic.runs, campaign.spec.seed) == (5, 0)
    assert campaign.settings["campaign"]["genetic"]["runs"] == 5
    assert campaign.settings["campaign"]["seed"] == 0
    without = write_bench(tmp_path, {"genetic": DROP})
    assert Campaign.read(without, runs=5).spec.genetic.runs == 5


def test_a_dataset_is_found_beside_the_campaign_or_above_it(tmp_path, monkeypatch):
    for dataset in ("small.toml", "grids/small.toml", "../elsewhere/small.toml"):
        write_toml(tmp_path / "fitting" / dataset, GRID)
        path = write_toml(tmp_path / "fitting/c.toml", changed(CAMPAIGN, {"dataset": dataset}))
        assert Campaign.read(path).data.size == 96
    path = write_bench(tmp_path)
    monkeypatch.chdir(path.parent)
    assert Campaign.read(path.name).data.source == "../datasets/small.toml"


def test_the_key_changes_with_whatever_the_result_depends_on(tmp_path):
    path = write_bench(tmp_path)
    key = Campaign.read(path).key
    assert Campaign.read(path).key == key
    for changes in (
        {"seed": 8},
        {"bounds.n": [1, 1.6]},
        {"genetic.generations": 6},
        {"objective": "rms-difference-percent"},
    ):
        assert Campaign.read(write_bench(tmp_path, changes)).key != key
    path = write_bench(tmp_path)
    write_toml(tmp_path / "datasets/small.toml", changed(GRID, {"axes.E.points": 2}))
    assert Campaign.read(path).key != key


def test_a_campaign_is_redone_from_its_settings(tmp_path):
    campaign = Campaign.read(write_bench(tmp_path))
    settings = json.loads(json.dumps(campaign.settings))
    again = Campaign.of_settings("small", settings, "r.json")
    assert again.key == campaign.key
    assert again.parameters == campaign.parameters
    assert again.data.size == campaign.data.size


COMMITTED = sorted((Path(__file__).resolve().parents[2] / "fitting/results").glob("*.json"))
EXTERNAL, RECOVERED = (
    COMMITTED[0].with_name(f"{n}.json") for n in ("external", "recovered-internal")
)


# --- there and back ---------------------------------------------------------------------------


def test_a_result_comes_back_as_it_was_saved(small_result, tmp_path):
    path = tmp_path / "results/small.json"
    small_result.save(path)
    assert read_result(path) == small_result
    assert [file for file in tree(tmp_path) if file != "results"] == ["results/small.json"]


@pytest.mark.parametrize("path", COMMITTED, ids=lambda path: path.stem)
def test_every_committed_result_loads_and_saves_as_it_is(path, tmp_path):
    result = read_result(path)
    assert result.name == path.stem
    result.save(tmp_path / path.name)
    assert (tmp_path / path.name).read_bytes() == path.read_bytes()


def test_a_result_of_the_other_kind_is_refused():
    with pytest.raises(cc.InputError, match="is not a fit to readings; name a fit to readings"):
        DataFit.read(RECOVERED)
    assert LawFit.read(RECOVERED) == read_result(RECOVERED)


def test_a_result_says_what_it_was_made_with(small_result, small_campaign):
    made_with = small_result.provenance
    assert {"cylcontact", "git_commit", "spec_hashes", "python", "libraries"} == set(made_with)
    assert set(made_with["spec_hashes"]) == {"campaign", "dataset"}
    assert {"numpy", "scipy", "pygad"} <= set(made_with["libraries"])
    assert small_result.settings == small_campaign.settings


@pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")
def test_the_commit_is_that_of_the_campaign_and_marked_when_changed(tmp_path):
    def git(*arguments):
        identity = ["-c", "user.name=n", "-c", "user.email=e", "-c", "commit.gpgsign=false"]
        command = ["git", *identity, *arguments]
        return subprocess.check_output(command, cwd=tmp_path, text=True).strip()

    campaign = Campaign.read(write_bench(tmp_path))
    git("init", "--quiet")
    git("add", ".")
    git("commit", "--quiet", "--message", "all")
    commit = git("rev-parse", "HEAD")
    assert campaign.provenance["git_commit"] == commit
    write_bench(tmp_path, {"seed": 8})
    assert campaign.provenance["git_commit"] == f"{commit}-dirty"


# --- verdicts ---------------------------------------------------------------------------------


def runs_at(*objectives):
    """Runs of a result with these objectives."""
    runs = zip(read_result(EXTERNAL).runs, objectives, strict=False)
    return [run.model_copy(update={"objective": value}) for run, value in runs]


def test_fewer_than_half_of_the_runs_at_the_best_are_a_warning():
    assert on_runs(runs_at(0.05, 0.07), 0.0, [], "--fix")[0] == []
    runs = runs_at(0.05, 0.07, 0.08)
    (warning,), notes = on_runs(runs, 0.0, ["b"], "--fix")
    assert "make more runs (--runs 12), or hold b at a value (--fix)" in warning
    assert "0.07 (1), 0.08 (1)" in notes[1]
    assert basins(runs, 0.0) == [(0.05, 1), (0.07, 1), (0.08, 1)]


def test_round_off_is_one_basin_and_the_optimum():
    result, runs = read_result(EXTERNAL), runs_at(1.8e-8, 2.6e-8, 1e-3)
    space, _ = space_of(Campaign.of_settings("external", result.settings, "r.json"))
    published = result.published.model_copy(update={"objective": 2.6e-8})
    _, notes = sentences_on(space, result.estimates, published, None, runs)
    assert notes[0] == "the published coefficients are the optimum on this grid, within 0.1 %"
    assert "2 of 3 runs reached the best objective within 0.1 %" in notes
