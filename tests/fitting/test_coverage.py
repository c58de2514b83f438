"""The intervals of fits to measurements hold the truth as often as they say."""

import pandas as pd
import pytest
from scipy.stats import binom

from benchmarks.coverage import KINDS, RESULT, coverage_of

pytestmark = pytest.mark.slow


NAMED = 0  # the first row of each kind and parameter
FEW = 8
# What leaves no trace in the residuals.
NO_TRACE = ("load", "clearance")
# Of 22 numbers none is beyond these quantiles, in 98 of 100 studies.
CHANCE = (0.0005, 0.9995)


@pytest.fixture(scope="module")
def study():
    return pd.read_csv(RESULT, keep_default_na=False)


def test_the_committed_study_is_of_every_kind(study):
    assert list(study["kind"].unique()) == list(KINDS)
    first = study.groupby("kind").head(2)
    assert (first["sets"] >= 100).all()
    assert (study["sets"] >= 25).all()


def test_named_faults_are_covered(study):
    for kind, rows in study.groupby("kind", sort=False):
        named = rows[rows["options"] == rows["options"].iloc[NAMED]]
        hits = named["coverage_percent"] * named["sets"] / 100
        assert hits.between(*(binom.ppf(p, named["sets"], 0.95)[0] for p in CHANCE)).all(), kind


def test_what_is_left_out_is_warned_of(study):
    for kind, rows in study.groupby("kind", sort=False):
        named = rows["options"] == rows["options"].iloc[NAMED]
        assert (rows.loc[named, "warned_percent"] <= 12).all(), kind
        unnamed = rows.loc[~named]
        harmful = (unnamed["coverage_percent"] < 85).any()
        if harmful and not any(word in kind for word in NO_TRACE):
            assert (unnamed["warned_percent"] >= 75).all(), kind


@pytest.mark.parametrize("kind", ["8 series", "errors of the load, a share"])
def test_a_short_study_agrees(kind):
    """So many of few sets are covered as a true coverage of 95 % makes credible."""
    rows = coverage_of(kind, FEW, seed=1)
    named = rows[rows["options"] == rows["options"].iloc[NAMED]]
    assert (named["coverage_percent"] * FEW / 100 >= binom.ppf(1e-4, FEW, 0.95)).all()


@pytest.mark.long
def test_the_same_seed_gives_the_same_study():
    one, other = (coverage_of("constant scatter", 3, seed=2, jobs=jobs) for jobs in (1, 2))
    pd.testing.assert_frame_equal(one, other)
