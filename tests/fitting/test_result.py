"""Result files: written and read back whole, and refused when they are anything else."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from cylcontact.fitting import FitResult, read_campaign
from tests.support.spec_files import tree, write_bench

COMMITTED = sorted((Path(__file__).resolve().parents[2] / "fitting/results").glob("*.json"))
EXTERNAL, RECOVERED = (
    COMMITTED[0].with_name(f"{n}.json") for n in ("external", "recovered-internal")
)


# --- there and back ---------------------------------------------------------------------------


def test_a_result_comes_back_as_it_was_saved(small_result, tmp_path):
    path = tmp_path / "results/small.json"
    small_result.save(path)
    assert FitResult.read(path) == small_result
    assert [file for file in tree(tmp_path) if file != "results"] == ["results/small.json"]


@pytest.mark.parametrize("path", COMMITTED, ids=lambda path: path.stem)
def test_every_committed_result_loads_and_saves_as_it_is(path, tmp_path):
    result = FitResult.read(path)
    assert result.name == path.stem
    result.save(tmp_path / path.name)
    assert (tmp_path / path.name).read_bytes() == path.read_bytes()


def test_a_result_of_the_first_format_is_read(tmp_path):
    data = json.loads(RECOVERED.read_text("utf-8"))
    campaign = data["settings"]["campaign"]
    bounds, fixed = campaign.pop("bounds"), campaign.pop("fixed")
    tables = {name: {"low": ends[0], "high": ends[1]} for name, ends in bounds.items()}
    tables |= {name: {"value": value, "fixed": True} for name, value in fixed.items()}
    former = {"parameters": tables, "optimizer": "genetic"}
    data |= {"format": 1, "settings": {**data["settings"], "campaign": {**campaign, **former}}}
    (tmp_path / "r.json").write_text(json.dumps(data))
    assert FitResult.read(tmp_path / "r.json") == FitResult.read(RECOVERED)


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

    campaign = read_campaign(write_bench(tmp_path))
    git("init", "--quiet")
    git("add", ".")
    git("commit", "--quiet", "--message", "all")
    commit = git("rev-parse", "HEAD")
    assert campaign.provenance["git_commit"] == commit
    write_bench(tmp_path, {"seed": 8})
    assert campaign.provenance["git_commit"] == f"{commit}-dirty"


# --- verdicts ---------------------------------------------------------------------------------


def with_runs(objectives, published=None):
    """A result whose runs have these objectives."""
    result = FitResult.read(EXTERNAL)
    runs = [
        run.model_copy(update={"objective": value})
        for run, value in zip(result.runs, objectives, strict=False)
    ]
    objective = result.objective.model_copy(update={"value": min(objectives)})
    paper = result.published.model_copy(update={"objective": published or 1.0})
    return result.model_copy(update={"runs": runs, "objective": objective, "published": paper})


def test_fewer_than_half_of_the_runs_at_the_best_are_a_warning():
    assert with_runs([0.05, 0.07]).warnings == []
    few = with_runs([0.05, 0.07, 0.08])
    assert "make more runs (--runs 12)" in few.verdicts[0]
    assert few.basins() == [(0.05, 1), (0.07, 1), (0.08, 1)]


def test_round_off_is_one_basin_and_the_optimum():
    verdicts = with_runs([1.8e-8, 2.6e-8, 1e-3], published=2.6e-8).verdicts
    assert verdicts[0] == "the published coefficients are the optimum on this grid, within 0.1 %"
    assert "2 of 3 runs reached the best objective within 0.1 %" in verdicts
