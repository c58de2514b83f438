"""The optimisers: the same budget, the same answer for the same seed, the global optimum found."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from cylcontact import InputError
from cylcontact.fitting import calibrate, read_campaign
from cylcontact.fitting.calibration import problem_of
from cylcontact.fitting.comparison import compare_optimizers
from cylcontact.fitting.optimizers import OPTIMIZERS
from cylcontact.fitting.polish import polish
from tests.support.spec_files import assert_told, tree, write_bench

ROOT = Path(__file__).resolve().parents[2]


def search(problem, optimizer, population, generations, crossover, seed):
    """Search a problem with one of the optimisers."""
    return OPTIMIZERS[optimizer].search(problem, population, generations, crossover, seed)


@pytest.fixture(params=OPTIMIZERS)
def optimizer(request):
    """Each optimiser whose library is there."""
    return request.param


@pytest.fixture(params=[name for name in OPTIMIZERS if name != "descents"])
def searching(request):
    """Each optimiser that searches by itself."""
    return request.param


@pytest.fixture(scope="module")
def problem():
    """The paper's external calibration, E up to 1000 GPa: three parameters, one basin."""
    return problem_of(read_campaign(ROOT / "fitting/external-E1000.toml"), 1, lambda *_: None)[0]


def test_every_optimiser_finds_the_optimum_that_is_known(problem, optimizer):
    actual = search(problem, optimizer, 40, 60, "blend", seed=3)
    point, value = polish(problem, actual.point)
    assert value == pytest.approx(0.0547, abs=5e-5)
    assert problem.coefficients(point) == pytest.approx(
        {"a": 0.391, "b": 1.049, "n": 1.0933}, abs=5e-4
    )


def test_every_optimiser_searches_for_a_single_parameter(tmp_path, searching):
    alone = {"parameters.n": {"value": 1.2, "fixed": True}}
    problem, _ = problem_of(read_campaign(write_bench(tmp_path, alone)), 1, lambda *_: None)
    values = [search(problem, searching, 20, 20, "blend", seed=seed).value for seed in range(4)]
    assert values == pytest.approx([min(values)] * 4, rel=1e-2)


def test_the_same_seed_gives_the_same_bits_whatever_the_global_generator(problem, optimizer):
    actual = []
    for state in (1, 2):
        np.random.seed(state)  # noqa: NPY002 - the one that must play no part
        before = np.random.get_state()[1].copy()  # noqa: NPY002
        actual.append(search(problem, optimizer, 12, 20, "blend", seed=5))
        assert (np.random.get_state()[1] == before).all()  # noqa: NPY002
    assert actual[0].value == actual[1].value
    assert actual[0].point.tobytes() == actual[1].point.tobytes()
    assert search(problem, optimizer, 12, 20, "blend", seed=6).value != actual[0].value


def test_candidates_for_which_the_law_is_undefined_are_survived(problem, optimizer):
    """With a and b also negative, K* is undefined over most of the box."""
    wide = tuple(
        replace(p, low=-3.0, high=1.5) if p.name in "ab" else p for p in problem.parameters
    )
    actual = search(replace(problem, parameters=wide), optimizer, 30, 40, "blend", seed=1)
    assert np.isfinite(actual.value)


# --- campaigns --------------------------------------------------------------------------------


def test_a_missing_extra_is_named(small_campaign, monkeypatch):
    monkeypatch.setitem(sys.modules, "cma", None)  # what Python itself does for "not there"
    spec = small_campaign.spec.model_copy(update={"optimizer": "cma"})
    with pytest.raises(InputError) as caught:
        calibrate(replace(small_campaign, spec=spec))
    assert_told(
        caught,
        small_campaign.source,
        "optimizer",
        "cma",
        "needs the extra 'peers'",
        "make extras, or pip install 'cylcontact[peers]'",
    )


# --- the comparison ---------------------------------------------------------------------------


@pytest.fixture(scope="module")
def compared(small_campaign):
    return compare_optimizers(small_campaign, list(OPTIMIZERS)[:3], jobs=2)


def test_all_optimisers_share_seeds_and_polish(compared, small_result):
    genetic, *others = (own for _, own in compared.groupby("optimizer", sort=False))
    runs = small_result.runs
    assert list(genetic["polished"]) == [run.objective for run in runs]
    assert list(genetic["searched"]) == [run.objective_before_polish for run in runs]
    for own in (genetic, *others):
        assert list(own["seed"]) == [run.seed for run in runs]


def test_the_command_writes_the_file_and_shows_the_table(tmp_path, monkeypatch, run):
    write_bench(tmp_path)
    monkeypatch.chdir(tmp_path)
    arguments = ("genetic", "least-squares", "-o", "o.csv", "-j", 1)
    code, said, _ = run("optimizers", "fitting/small.toml", *arguments)
    assert code == 0
    lines = said.splitlines()
    assert [line.split()[0] for line in lines] == ["optimizer", "genetic", "least-squares"]
    assert len((tmp_path / "o.csv").read_text().splitlines()) == 7
    assert not [name for name in tree(tmp_path) if name.endswith((".lock", ".partial"))]


# --- the figure -------------------------------------------------------------------------------


@pytest.mark.long
def test_the_committed_comparison_is_what_the_command_gives():
    fresh = compare_optimizers(read_campaign(ROOT / "fitting/internal.toml"), jobs=2)
    committed = pd.read_csv(ROOT / "fitting/results/optimizers-internal.csv")
    pd.testing.assert_frame_equal(fresh[["optimizer", "run", "seed"]], committed.iloc[:, :3])
    np.testing.assert_allclose(fresh["polished"], committed["polished"], rtol=1e-6)
