"""What a fit to a reference law is worth: discrepancy of models, without any talk of noise."""

import json
from dataclasses import replace

import numpy as np
import pytest

from cylcontact import InputError
from cylcontact.fitting import DataFit, fit_table
from cylcontact.fitting.calibration import problem_of
from cylcontact.fitting.discrepancy import study_discrepancy
from cylcontact.fitting.objectives import collect_samples, form_of
from cylcontact.fitting.polish import polish
from cylcontact.fitting.study import study_noise
from cylcontact.progress import silent
from tests.support.measured_files import measured_campaign


@pytest.fixture(scope="module")
def study(small_result):
    return study_discrepancy(small_result, leave_out="dR", with_pairs=True)


def test_the_spread_is_that_of_eq_9_over_the_samples(small_campaign, small_result, study):
    rows, _ = collect_samples(small_campaign.grid)
    point = np.array([[small_result.coefficients[name] for name in small_campaign.model.names]])
    ratio = form_of(small_campaign.model, point, rows.dR).log_ratio(0, rows)
    for share, value in study.spread_percent.items():
        expected = 100 * np.expm1(np.quantile(ratio, float(share) / 100, method="inverted_cdf"))
        assert value == pytest.approx(expected, abs=0.02)


def test_leaving_a_clearance_out_is_fitting_the_others(small_campaign, small_result, study):
    grid = small_campaign.grid
    assert [left.group for left in study.left_out] == [f"dR = {v:.6g}" for v in grid.dR]
    rest = small_campaign.on(replace(grid, dR=grid.dR[1:]))
    problem, _ = problem_of(rest, 1, silent)
    point, _ = polish(problem, problem.point(small_result.coefficients))
    assert study.left_out[0].coefficients == pytest.approx(problem.coefficients(point), rel=1e-4)
    alone, _ = problem_of(small_campaign.on(replace(grid, dR=grid.dR[:1])), 1, silent)
    assert study.left_out[0].own_rms == pytest.approx(alone.value(point), rel=1e-4)
    assert sum(left.rows for left in study.left_out) == small_result.counts.samples


def test_a_map_of_a_pair_is_the_objective_reoptimised(small_campaign, small_result, study):
    (mapped,) = study.pairs
    problem, _ = problem_of(small_campaign, 1, silent)
    value = problem.value(np.array([mapped.x[3], mapped.y[5]]))
    optimum = problem.value_of(small_result.coefficients)
    assert mapped.rise[5][3] == pytest.approx(value / optimum - 1, rel=1e-9)
    assert mapped.names == ("K_star", "n")


def test_a_masked_value_has_no_say(small_campaign, small_result):
    # At the smallest clearance a load beyond Johnson's limit masks every sample of that load.
    grid = replace(small_campaign.grid, load=np.array([10.0, 1000.0, 1e9]))
    settings = json.loads(json.dumps(small_result.settings))
    settings["dataset"]["axes"]["load"] = {"values": grid.load.tolist()}
    changed = small_result.model_copy(update={"settings": settings})
    study = study_discrepancy(changed, leave_out="load")
    assert (study.left_out[-1].rows, study.left_out[-1].own_rms) == (0, None)


@pytest.mark.parametrize(
    ("axis", "rule"), [("moon", "is not an axis of a grid"), ("E", "has one value only")]
)
def test_what_cannot_be_left_out_is_refused(small_result, axis, rule):
    settings = json.loads(json.dumps(small_result.settings))
    settings["dataset"]["axes"]["E"] = {"values": [207.0]}
    changed = small_result.model_copy(update={"settings": settings})
    with pytest.raises(InputError, match=rule):
        study_discrepancy(changed, leave_out=axis)


def test_coefficients_that_define_no_law_are_refused(tmp_path, small_result):
    wrong = small_result.model_copy(update={"coefficients": {"K_star": -1.0, "n": 1.1}})
    with pytest.raises(InputError, match="leave the law undefined for some of its samples"):
        study_discrepancy(wrong)
    measured = fit_table(measured_campaign(tmp_path, noise=0.01, starts=1)).model_dump()
    changed = {**measured["coefficients"], "kappa": -1.0}
    with pytest.raises(InputError, match="leave the law undefined for some of the data"):
        study_noise(DataFit(**{**measured, "coefficients": changed}))


def test_the_command_reports_discrepancy(tmp_path, small_result, run):
    small_result.save(tmp_path / "r.json")
    arguments = ("--leave-out", "nu", "-j", 1, "--pairs", "-o", tmp_path / "study.json")
    code, said, errors = run("uncertainty", tmp_path / "r.json", *arguments)
    assert (code, errors) == (0, "")
    assert "nu = 0.25" in said
    study = json.loads((tmp_path / "study.json").read_text("utf-8"))
    assert len(study["pairs"]) == 1
