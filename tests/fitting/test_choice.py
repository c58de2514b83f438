"""Which law describes measurements: the ranking, what it rests on, and when it does not decide."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import least_squares

import cylcontact as cc
from cylcontact import CylinderPair, InputError, laws
from cylcontact.fitting import read_result
from cylcontact.fitting.choice import _mean, laws_for
from cylcontact.support.choices import CHOICE_FILES
from tests.support.measured_files import STEEL
from tests.support.noisy_series import PAIR, readings

SPECIMENS = Path(__file__).resolve().parents[2] / "datasets/examples/specimens.csv"
FEW = ("explicit", "persson", "johnson", "power-one-pair")
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
    # From another datum a power law, which has a constant more, follows the readings as well.
    assert set(choice.undecided) == {"explicit", "persson", "power-one-pair"}
    assert list(choice.table["verdict"][choice.table["verdict"] == "worse"].index) == ["johnson"]
    assert "best" not in set(choice.table["verdict"])
    assert choice.table["aicc"].is_monotonic_increasing
    assert choice.table["weight"].sum() == pytest.approx(1.0)
    # Akaike's: half of the difference is a logarithm of a likelihood.
    table = choice.table
    ratios, behind = (
        table["weight"] / table["weight"].iloc[0],
        table["aicc"] - table["aicc"].iloc[0],
    )
    assert np.log(ratios).to_numpy() == pytest.approx(-behind.to_numpy() / 2, abs=1e-9)
    said = " ".join(str(choice).split())
    assert "the data cannot tell" in said
    assert "(conformal is its elastic solution)" not in said  # it was not asked for
    assert "cannot tell the law from the compliance" in said


@pytest.mark.parametrize(("behind", "verdict"), [(6.9, "undecided"), (7.1, "worse")])
def test_a_law_that_predicts_worse_is_ruled_out_by_an_aicc_7_behind(choice, behind, verdict):
    best, johnson = choice.best, next(law for law in choice.laws if law.law == "johnson")
    assert johnson.behind(best) > 1
    rival = replace(johnson, aicc=best.aicc + behind)
    assert replace(choice, laws=(best, rival)).table.loc["johnson", "verdict"] == verdict


@pytest.mark.slow
def test_aicc_is_that_of_the_fits(frame, choice):
    N = len(frame)
    for law in ("johnson", "power-one-pair"):  # of two and of three constants
        fit = cc.fit(frame, law, PAIR, free=["offset", "compliance"])
        k = fit.estimated
        aicc = fit.aic + 2 * k * (k + 1) / (N - k - 1)
        assert choice.table.loc[law, "aicc"] == pytest.approx(aicc, abs=1e-4)
        assert choice.table.loc[law, "parameters"] == k


def test_the_error_of_a_mean_is_that_of_its_parts():
    values = np.array([1.0, 4.0, 2.0, 7.0])
    mean, error = _mean(values, np.full(4, 3.0))
    assert (mean, error) == pytest.approx((3.5, values.std(ddof=1) / 2))


def test_aicc_has_the_correction_for_few_readings(frame, choice):
    N = len(frame)
    for law in choice.laws:
        k = law.optimum.estimated
        aicc = 2 * k - 2 * law.optimum.log_likelihood + 2 * k * (k + 1) / (N - k - 1)
        assert choice.table.loc[law.law, "aicc"] == pytest.approx(aicc, rel=1e-9)


def refitted(ranked, law, pair):
    """The cross-validated error by refits of scipy, without each tenth of the rows."""
    fit, unit = ranked.optimum.fit, np.array([1.0, 1e-4, 1e-6])
    load, measured, low, high = fit.data.load, fit.data.penetration, fit.low / unit, fit.high / unit

    def missed(unknown, rows):
        factor, offset, compliance = unknown * unit
        contact = law.penetration(load / factor, pair)
        return ((contact + offset + compliance * load - measured) / fit.noise.scale)[rows]

    order, squares = np.random.default_rng(20150101).permutation(load.size), []
    for part in np.array_split(order, 10):
        rest, start = np.setdiff1d(order, part), [1.0, 0.0, 0.0]
        same = {"bounds": (low, high), "x_scale": "jac", "xtol": 1e-14, "ftol": 1e-14}
        squares += list(missed(least_squares(missed, start, args=(rest,), **same).x, part) ** 2)
    return np.sqrt(np.mean(squares))


def test_the_cross_validated_error_is_that_of_refits(choice):
    ranked = next(law for law in choice.laws if law.law == "explicit")
    assert ranked.cv_error[0] == pytest.approx(refitted(ranked, laws.Explicit(), PAIR), rel=1e-7)
    assert 0 < ranked.cv_error[1] < ranked.cv_error[0]


@pytest.mark.slow
def test_so_it_is_with_a_parameter_at_its_bound():
    """Goldsmith's law has its compliance at the bound, where one descent would stay."""
    frame = pd.read_csv(SPECIMENS, comment="#")
    steel = cc.Material.named("high-strength steel")
    pair = CylinderPair.internal(10.0, 9.97, material=steel, length=20.0)
    (ranked,) = cc.choose(frame, pair, laws="goldsmith").laws
    assert ranked.compliance[0] == pytest.approx(-2e-5)
    assert ranked.cv_error[0] == pytest.approx(
        refitted(ranked, laws.LAWS["goldsmith"](), pair), rel=1e-7
    )


def test_a_reading_is_predicted_with_what_its_series_adds():
    series = readings(2, 5, 8, offset=2e-4, gain=0.03)
    fixed = {"compliance": 0.0}
    (ranked,) = cc.choose(series, PAIR, laws="explicit", group="group", fixed=fixed).laws
    assert ranked.cv_error[0] < 1.6  # in standard deviations of the scatter alone


@pytest.mark.slow
def test_a_series_left_out_is_what_is_predicted():
    series = readings(2, 5, 8, offset=2e-4, gain=0.03)
    assert cc.choose(series, PAIR, laws=["explicit"]).parts == "5 series"
    modelled = cc.choose(series, PAIR, laws=["explicit", "johnson"], group="group")
    assert modelled.parts == "10 parts of the rows"
    assert modelled.undecided == ["explicit"]
    assert modelled.table.loc["explicit", "verdict"] == "best"
    # What a series adds is predicted from its other readings: errors are near the scatter alone.
    assert modelled.table.loc["explicit", "cv_error"] < 1.6
    assert modelled.table.loc["johnson", "cv_error"] > 1.6


@pytest.mark.slow
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


def test_a_law_of_ones_own_is_compared_like_the_packages(tmp_path, monkeypatch, frame, choice):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own_laws.py").write_text(
        "import numpy as np\n\ndef explicit(penetration, E_star, dR, c=1.427, A=0.3602, B=3.84):\n"
        "    d = penetration / dR\n"
        "    inner = c + np.log(1 + A / d * np.log(B / d))\n"
        "    return np.pi * E_star * penetration / (c + np.log(1 + A / d * inner))\n"
    )
    own = cc.choose(frame, PAIR, laws="own_laws:explicit")
    columns = ["parameters", "aicc", "cv_error", "compliance"]
    expected = choice.table.loc["explicit", columns].tolist()
    assert own.table.loc["own_laws:explicit", columns].tolist() == pytest.approx(expected, rel=1e-4)


HOUSING = {"R_o": 20.0}


@pytest.mark.slow
@pytest.mark.parametrize("named", [["johnson", "conformal"], []])
def test_laws_that_know_no_housing_have_a_compliance_in_any_order(tmp_path, frame, choice, named):
    alone = choice.table.loc["johnson", "aicc"]
    choice = cc.choose(frame, PAIR, laws=named, housing=HOUSING)
    if not named:  # conformal's other name
        assert "persson" not in {*choice.table.index, *choice.left_out}
    assert choice.table.loc["johnson", "aicc"] == pytest.approx(alone, rel=1e-9)
    housed = choice.table.loc["conformal"]
    assert (housed["compliance"], housed["parameters"]) == (0.0, 4)
    choice.fit("johnson").save(tmp_path / "r.json")
    assert read_result(tmp_path / "r.json").to_law().name == "johnson"


PEEK = cc.Material("PEEK", E=3600.0, nu=0.38)
SOFT = CylinderPair.internal(10.0, 9.97, material=STEEL, material_j=PEEK, length=20.0)
# Readings counted from another datum than the law's: C·f/(π·E*) more, or to a clamped rim.
DATUMS = {
    "more": ("explicit", 0.5, laws.Explicit(), PAIR),
    "less": ("explicit", -0.5, laws.Explicit(), PAIR),
    "housing": ("conformal", 0.0, laws.Conformal(datum=laws.Housing(R_o=200.0)), SOFT),
    "johnson": ("johnson", 0.0, laws.Johnson(), PAIR),
}


def from_datum(datum, seed):
    """Readings with 1 % of noise, and the names of their law and pair."""
    name, C, law, pair = DATUMS[datum]
    load = np.geomspace(3e-3, 1.0, 30) * pair.E_star * pair.dR
    depth = law.penetration(load, pair) + C * load / (np.pi * pair.E_star)
    seen = 1e3 * depth * (1 + 0.01 * np.random.default_rng(seed).normal(size=load.size))
    return name, pair, pd.DataFrame({"load_N_per_mm": load, "penetration_um": seen})


@pytest.mark.parametrize(
    ("datum", "seed"),
    [
        ("more", 0),
        *(pytest.param(datum, 0, marks=pytest.mark.slow) for datum in DATUMS if datum != "more"),
    ],
)
def test_another_datum_does_not_make_a_wrong_law_the_best(datum, seed):
    name, pair, data = from_datum(datum, seed)
    rivals = [name, "enhanced", "liu"]
    choice = cc.choose(data, pair, laws=rivals)
    assert name in choice.undecided
    assert choice.describes
    assert "liu" not in choice.undecided
    if name == "explicit":
        value, error = choice.table.loc[name, ["compliance", "compliance_error"]]
        C = DATUMS[datum][1]
        assert value * np.pi * pair.E_star == pytest.approx(C, abs=4 * error * np.pi * pair.E_star)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("datum", DATUMS)
def test_of_all_laws_the_right_one_is_not_ruled_out_by_the_datum(datum, seed):
    name, pair, data = from_datum(datum, seed)
    assert name in cc.choose(data, pair).undecided


@pytest.mark.slow
def test_none_is_the_best_of_readings_that_no_law_describes():
    _, pair, data = from_datum("more", 1)
    load = data["load_N_per_mm"]
    data["penetration_um"] += 3 * np.clip((load - 150) / 45, 0, 1)  # a seat that settles
    choice = cc.choose(data, pair, laws=["explicit", "johnson", "power"])
    said = " ".join(str(choice).split())
    assert not choice.describes
    assert choice.undecided == []
    assert "none of the laws describes these readings" in said
    assert "describes the data best" not in said
    assert "! the law does not describe these readings" in " ".join(str(choice.fit()).split())


@pytest.mark.slow
def test_a_law_with_too_many_numbers_for_the_readings_is_not_ranked():
    _, pair, data = from_datum("more", 1)
    choice = cc.choose(data[::5], pair, laws=["explicit", "power"], noise="constant")
    assert [law.law for law in choice.laws] == ["explicit"]
    assert "6 readings are too few to rank it" in choice.left_out["power"]
    with pytest.raises(InputError, match="too few to rank it") as caught:
        cc.choose(data[::6], pair, laws=["explicit", "power"], noise="constant")
    assert len(str(caught.value).splitlines()) == 1


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
