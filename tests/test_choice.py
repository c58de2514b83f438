"""Which law describes measurements: the ranking, what it rests on, and when it does not decide."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import cylcontact as cc
from cylcontact import CylinderPair, InputError, laws
from cylcontact.choices import CHOICE_FILES
from cylcontact.fitting.choice import laws_for
from tests.measured_files import STEEL
from tests.noisy_series import PAIR, readings
from tests.spec_files import tree

FEW = ("explicit", "persson", "johnson", "power")
OPTIONS = [
    *("--contact", "internal", "--E", "207000", "--nu", "0.3"),
    *("--Ri", "10", "--Rj", "9.97", "--length", "20"),
]


@pytest.fixture(scope="module")
def frame():
    return readings(1, 1, 30, constant=0.0, proportional=0.01).drop(columns="group")


@pytest.fixture(scope="module")
def choice(frame):
    return cc.choose(frame, PAIR, laws=FEW)


def test_the_law_of_the_data_is_the_best_and_its_equal_cannot_be_told_apart(choice):
    assert set(choice.undecided) == {"explicit", "persson"}
    assert set(choice.table.index[2:]) == {"johnson", "power"}
    assert (choice.table["verdict"][2:] == "worse").all()
    assert choice.table["aicc"].is_monotonic_increasing
    assert choice.table["weight"].sum() == pytest.approx(1.0)
    assert "cannot tell explicit and persson apart" in " ".join(str(choice).split()) or (
        "cannot tell persson and explicit apart" in " ".join(str(choice).split())
    )


def test_aicc_is_that_of_the_fits(frame, choice):
    N = len(frame)
    for law in FEW:
        free = ["offset"] if law == "power" else []
        fit = cc.fit(frame, law, PAIR, free=free)
        k = fit.uncertainty.estimated
        aicc = fit.aic + 2 * k * (k + 1) / (N - k - 1)
        assert choice.table.loc[law, "aicc"] == pytest.approx(aicc, abs=1e-4)
        assert choice.table.loc[law, "parameters"] == k


def test_the_cross_validated_error_is_that_of_refits(frame, choice):
    """Parts are left out by hand, and predicted by `cylcontact.fit` on the others."""
    order = np.random.default_rng(20150101).permutation(len(frame))
    squares = []
    for part in np.array_split(order, 10):
        rest = frame.drop(index=frame.index[part])
        law = cc.fit(rest, "johnson", PAIR)
        predicted = law.predict(frame["load_N_per_mm"].to_numpy()[part])["penetration_mm"]
        measured = 1e-3 * frame["penetration_um"].to_numpy()[part]
        squares += list(np.log(predicted.to_numpy() / measured) ** 2)
    error = np.sqrt(np.mean(squares))
    assert choice.table.loc["johnson", "cv_error"] == pytest.approx(error, rel=1e-5)
    assert 0 < choice.table.loc["johnson", "cv_standard_error"] < error


def test_the_best_is_no_worse_than_itself(choice):
    assert choice.best.behind(choice.best) == 0
    assert choice.table.loc[choice.best.law, "verdict"] == "best"


def test_a_series_left_out_is_what_is_predicted():
    series = readings(2, 5, 8, offset=2e-4, gain=0.03)
    assert cc.choose(series, PAIR, laws=["explicit"]).parts == "5 series"
    modelled = cc.choose(series, PAIR, laws=["explicit", "johnson"], group="group")
    assert modelled.parts == "10 parts of the rows"
    assert modelled.undecided == ["explicit"]
    # What a series adds is predicted from its other readings: errors are near the scatter alone.
    assert modelled.table.loc["explicit", "cv_error"] < 1.6
    assert modelled.table.loc["johnson", "cv_error"] > 1.6


def test_a_law_that_ends_before_the_data_is_left_out_with_the_reason():
    loads = np.geomspace(1e2, 3e4, 24)
    pair = CylinderPair.internal(R_i=10.0, R_j=9.97, material=STEEL, length=20.0)
    depth = laws.Explicit().penetration(loads, pair)
    wiggle = 1 + 0.01 * np.cos(np.arange(24))
    data = pd.DataFrame({"load_N_per_mm": loads, "penetration_um": 1e3 * depth * wiggle})
    choice = cc.choose(data, pair)
    assert "lies outside the domain" in choice.left_out["hertz-cylinder"]
    assert "hertz-cylinder" not in choice.table.index
    assert {*choice.table.index} | {*choice.left_out} == {*laws_for("internal", 1)}
    with pytest.raises(InputError, match="lies outside the domain"):
        cc.choose(data, pair, laws=["hertz-cylinder"])


def test_the_best_law_is_fitted_with_all_its_starts(frame, choice):
    assert choice.fit("johnson").coefficients == cc.fit(frame, "johnson", PAIR).coefficients
    assert len(choice.fit().runs) > 3
    with pytest.raises(InputError, match="hooke"):
        choice.fit("hooke")


def test_the_picture_goes_where_one_says(choice):
    axes = Figure().subplots(1, 2)
    assert choice.plot(axes[0]) is axes[0]
    (points,) = [line for line in axes[0].get_lines() if line.get_label() == "measured"]
    assert len(points.get_xdata()) == 30
    assert not axes[1].has_data()
    labels = [line.get_label() for line in axes[0].get_lines()]
    # Of laws that coincide one is drawn.
    assert len({"explicit", "persson"} & {*labels}) == 1
    assert "johnson" in labels


def test_the_command_ranks_and_writes(tmp_path, run, frame):
    table = tmp_path / "mine.csv"
    frame.to_csv(table, index=False)
    code, said, _ = run("choose", table, *OPTIONS, "--law", "explicit", "--law", "johnson")
    assert code == 0
    assert "mine: 2 laws fitted to 30 measurements" in said
    assert "explicit describes the data best" in " ".join(said.split())
    folder = tmp_path / "results" / "mine"
    assert sorted(file.name for file in folder.iterdir()) == sorted(CHOICE_FILES)
    ranked = pd.read_csv(folder / "choice.csv")
    assert list(ranked["law"]) == ["explicit", "johnson"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((*OPTIONS, "--law", "hooke"), "law = 'hooke': is not a law that can be fitted"),
        ((*OPTIONS, "--loss", "huber"), "leaves no likelihood to rank laws by"),
        ((), "--contact: is required for a table"),
    ],
)
def test_a_bad_command_line_is_told_and_leaves_nothing(tmp_path, run, frame, arguments, message):
    table = tmp_path / "mine.csv"
    frame.to_csv(table, index=False)
    before = tree(tmp_path)
    code, said, errors = run("choose", table, *arguments, "--law", "explicit")
    assert (code, said, len(errors.splitlines())) == (2, "", 1)
    assert message in errors
    assert tree(tmp_path) == before


def test_a_campaign_is_not_a_table(run):
    code, _, errors = run("choose", "fitting/internal.toml")
    assert code == 2
    assert "name a table of measurements" in errors
