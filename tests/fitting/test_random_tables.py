"""Random tables and random choices of a fit: each ends in a result or in one line."""

import warnings

import numpy as np
import pandas as pd
import pytest

import cylcontact as cc
from benchmarks.coverage import KINDS
from cylcontact.fitting import DataFit, choice
from cylcontact.fitting.choice import laws_for
from cylcontact.fitting.law_models import model_of
from tests.support.measured_files import STEEL
from tests.support.noisy_series import PAIR

PAIRS = {
    "internal": PAIR,
    "external": cc.CylinderPair.external(R_i=10.0, R_j=14.0, material=STEEL, length=20.0),
}
# What readings are of.
TRUE = cc.laws.reference_law("johnson")


def frame(noise=0.0):
    """Return readings of Johnson's law with a relative scatter."""
    load = np.geomspace(10.0, 1000.0, 15)
    scatter = 1 + noise * np.random.default_rng(1).normal(size=15)
    depth = 1e3 * TRUE.penetration(load, PAIRS["internal"]) * scatter
    return pd.DataFrame({"load_N": load * 20.0, "penetration_um": depth})


def random_fit(seed):
    """Return the table, the law and the settings of a fit."""
    rng = np.random.default_rng(seed)
    contact = str(rng.choice(["internal", "internal", "external"]))
    pair, rows = PAIRS[contact], int(rng.integers(4, 40))
    load = np.geomspace(5.0, 10.0 ** rng.uniform(1.5, 3.2), rows)
    if rng.random() < 0.3:
        load = np.concatenate([load[::2], load[1::2][::-1]])
    if rng.random() < 0.3:
        load = rng.permutation(load)
    depth = TRUE.penetration(load, pair)
    size = float(depth.max())
    depth = depth * (1 + 0.01 * rng.choice([0.0, 0.1, 1.0, 5.0]) * rng.normal(size=rows))
    depth += size * 0.01 * rng.choice([0.0, 0.3, 3.0]) * rng.normal(size=rows)
    depth += size * rng.choice([0.0, 0.0, 0.2, 30.0, -30.0])  # where the gauge has its zero
    depth += load * size / load.max() * rng.choice([0.0, 0.0, 0.5, 10.0])  # the rig
    series = np.arange(rows) // max(1, rows // int(rng.integers(1, 7)))
    depth += size * 0.02 * rng.choice([0.0, 1.0]) * rng.normal(size=series.max() + 1)[series]
    if rng.random() < 0.1:
        depth[rng.integers(rows)] *= 3
    if rng.random() < 0.1:
        depth = -depth
    table = {"specimen": [f"S{k}" for k in series], "load_N": load * 20.0}
    table["penetration_um"] = 1e3 * depth
    if rng.random() < 0.1:
        table["penetration_std_um"] = np.full(rows, 20.0 * size)
    law = str(rng.choice(laws_for(contact, 1)))
    names = [*model_of(law, contact, "test").names, "offset", "compliance"]
    settings = {}
    if rng.random() < 0.7:
        chosen = rng.choice(names, size=min(len(names), int(rng.integers(1, 4))), replace=False)
        settings["free"] = [str(name) for name in chosen]
    if rng.random() < 0.6:
        settings["noise"] = str(rng.choice(["constant", "proportional", "both"]))
    for chance, key, value in (
        (0.4, "group", "specimen"),
        (0.3, "drift", True),
        (0.3, "load_error", 0.01),
    ):
        if rng.random() < chance:
            settings[key] = value
    return pd.DataFrame(table), law, pair, settings


def outcome(seed):
    """Return the report; nothing if the fit was refused in one line."""
    table, law, pair, settings = random_fit(seed)
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        try:
            result = cc.fit(table, law, pair, starts=2, **settings)
        except cc.InputError as refusal:
            return "" if len(str(refusal).splitlines()) == 1 else pytest.fail(str(refusal))
    for estimate in result.estimates.values():
        assert estimate.low is None or estimate.low <= estimate.value <= estimate.high
    return str(result)


# The first of some tables, and how many: a few in every run, some before a change goes in.
SLOW, LONG = pytest.mark.slow, pytest.mark.long
TABLES = [
    (16, 4),
    *(pytest.param(first, 8, marks=SLOW) for first in (15, 29)),
    *(pytest.param(first, 50, marks=LONG) for first in range(0, 2000, 50)),
]


@pytest.mark.parametrize(("first", "number"), TABLES)
def test_random_tables_end_in_a_result_or_one_line(first, number):
    assert sum(bool(outcome(seed)) for seed in range(first, first + number)) > number / 2


def test_readings_of_the_opposite_sign_are_named():
    table = frame()
    table["penetration_um"] *= -1
    settings = {"sign": "neither", "noise": "constant", "free": "offset", "starts": 2}
    result = cc.fit(table, "explicit", PAIRS["internal"], **settings)
    assert "opposite sign (--sign penetration" in result.warnings[0]
    assert 'opposite sign (sign="penetration"' in " ".join(str(result).split())


def singular(*_):
    raise np.linalg.LinAlgError("Singular matrix")


def test_a_law_with_a_singular_information_matrix_is_skipped(monkeypatch):
    whole = choice.Optimum.log_likelihood.fget

    def likelihood(optimum):
        return singular() if "explicit" in optimum.fit.model.law else whole(optimum)

    monkeypatch.setattr(choice.Optimum, "log_likelihood", property(likelihood))
    chosen = cc.choose(frame(0.01), PAIRS["internal"], laws=["johnson", "explicit"])
    assert chosen.left_out == {"explicit": "left out: its information matrix is singular"}
    assert [law.law for law in chosen.laws] == ["johnson"]


def test_singular_likelihoods_are_one_sentence(monkeypatch):
    monkeypatch.setattr("cylcontact.fitting.noise.Likelihood._terms", singular)
    with pytest.raises(cc.InputError, match="the information matrix is singular"):
        cc.fit(frame(0.01), "johnson", PAIRS["internal"], noise="both", starts=1)


@pytest.mark.parametrize("number", [2, 4])
def test_a_search_of_the_noise_goes_on_where_the_information_is_singular(number):
    """Sound tables: the search tries such deviations on its way."""
    seed = np.random.SeedSequence([4242, 7]).spawn(number + 1)[number]
    kind = KINDS["8 series with a drift"]
    table = kind.sample(np.random.default_rng(seed))
    assert np.isfinite(cc.fit(table, "explicit", PAIR, starts=1, **kind.options).log_likelihood)


@pytest.mark.slow
def test_choices_do_not_depend_on_workers():
    table, laws = frame(0.01), ["johnson", "explicit"]
    one, two = (cc.choose(table, PAIRS["internal"], laws=laws, jobs=jobs) for jobs in (1, 2))
    assert one.table.equals(two.table)
    assert str(one) == str(two)


def test_a_result_is_saved_under_any_name(tmp_path):
    result = cc.fit(frame(0.01), "johnson", PAIRS["internal"], starts=1)
    for name in ("x.json", "x.txt", "x"):
        for write in (result.save, result.write):
            write(str(tmp_path / name))
            assert DataFit.read(str(tmp_path / name)).coefficients == result.coefficients
            (tmp_path / name).unlink()
