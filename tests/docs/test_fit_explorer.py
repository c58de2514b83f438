"""The sliders of a fit: their ranges, the objective beside its threshold, and the picture."""

import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import cylcontact as cc
from cylcontact import InputError
from cylcontact.fitting.table_campaign import read_campaign
from cylcontact.fitting.table_fit import fit_table
from cylcontact.reports.fit_explorer import FitView, explore_fit

ROOT = Path(__file__).resolve().parents[2]
STEEL = cc.Material("steel", E=207e3, nu=0.3)
PAIR = cc.CylinderPair.internal(R_i=10.0, R_j=9.97, material=STEEL, length=20.0)
LOAD = np.geomspace(10.0, 1000.0, 12)
NOISE = 1 + 0.01 * np.cos(np.arange(12))
OFFSET = 1e-4


def data(noise=NOISE, offset=OFFSET):
    seen = 1e3 * (cc.laws.Explicit().penetration(LOAD, PAIR) * noise + offset)
    return pd.DataFrame({"load_N_per_mm": LOAD, "penetration_um": seen})


@pytest.fixture(scope="module")
def result():
    return cc.fit(data(), "explicit", PAIR)


@pytest.fixture
def parts(result):
    """The sliders, the button, the table and the picture."""
    left, picture = explore_fit(result).children
    *sliders, button, table = left.children
    return sliders, button, table, picture


def test_sliders_start_at_the_best_and_reach_beyond_the_intervals(result, parts):
    sliders, _, table, picture = parts
    names = [slider.description.split(" ")[0] for slider in sliders]
    assert names == list(result.uncertainty.estimates) == ["stiffness_factor", "offset"]
    for name, slider in zip(names, sliders, strict=True):
        ends = result.uncertainty.estimates[name].profile
        assert slider.value == result.coefficients[name]
        assert slider.min < ends.low < ends.high < slider.max
    assert "the objective is 1 times the best, below" in table.value
    assert bytes(picture.value).startswith(b"\x89PNG")


@pytest.mark.parametrize("which", [0, 1])
def test_every_slider_moves_numbers_and_picture_and_the_button_resets_both(parts, which):
    sliders, button, table, picture = parts
    before = table.value, picture.value
    sliders[which].value = sliders[which].max
    assert table.value != before[0]
    assert picture.value != before[1]
    assert "Ruled out" in table.value
    button.click()
    assert (table.value, picture.value) == before


def test_the_objective_is_that_by_hand(result):
    view = FitView(result)
    values = {"stiffness_factor": 0.97, "offset": 2e-4}
    reading = cc.laws.Explicit().penetration(LOAD / 0.97, PAIR) + 2e-4
    seen = 1e-3 * data()["penetration_um"].to_numpy()
    by_hand = np.sqrt((np.log(reading / seen) ** 2).mean())
    assert view.relative(values) * result.objective.value == pytest.approx(by_hand, rel=1e-9, abs=0)
    (drawn,) = view.readings(values)
    assert drawn[[0, -1]] == pytest.approx(reading[[0, -1]], rel=1e-9, abs=0)
    loads, points = view.points
    assert (loads, points) == (pytest.approx(LOAD), pytest.approx(seen))


def test_the_threshold_is_that_of_all_coefficients_together(result):
    # The F distribution with 2 and 10 degrees of freedom has 4.1028 at 95 %.
    by_hand = np.sqrt(1 + 2 / 10 * 4.1028)
    assert FitView(result).threshold == pytest.approx(by_hand, rel=1e-4)


def test_with_one_coefficient_the_threshold_is_at_the_ends_of_its_interval():
    result = cc.fit(data(), "explicit", PAIR, fixed={"offset": OFFSET})
    view, ends = FitView(result), result.uncertainty.estimates["stiffness_factor"].profile
    for end in (ends.low, ends.high):
        times = view.relative({"stiffness_factor": end})
        assert times == pytest.approx(view.threshold, rel=1e-3)
    middle, far = (ends.low + ends.high) / 2, 2 * ends.high - ends.low
    assert view.verdict({"stiffness_factor": middle}).startswith("Not ruled out")
    assert view.verdict({"stiffness_factor": far}).startswith("Ruled out")


def test_bounds_cut_the_sliders_off():
    result = cc.fit(data(), "explicit", PAIR, bounds={"stiffness_factor": (0.99, 1.01)})
    assert FitView(result).ranges["stiffness_factor"] == (0.99, 1.01)


def test_what_is_undefined_or_exact_is_said(result):
    view = FitView(result)
    values = view.best | {"stiffness_factor": -1.0}
    assert view.verdict(values).startswith("The law is undefined at these values")
    (drawn,) = view.readings(values)
    assert np.isnan(drawn).all()
    exact = FitView(cc.fit(data(1.0, 0.0), "explicit", PAIR))
    assert exact.verdict(exact.best).startswith("There is no threshold: the fit is exact")


def test_series_are_taken_off_the_points():
    series = np.repeat(["a", "b"], len(LOAD))
    both = pd.concat([data(), data(offset=3 * OFFSET)], ignore_index=True).assign(series=series)
    view = FitView(cc.fit(both, "explicit", PAIR, group="series"))
    assert view.has_series
    _, points = view.points
    apart = points[: len(LOAD)] - points[len(LOAD) :]
    assert np.abs(apart).max() < 0.1 * OFFSET


def test_each_pair_has_its_curves():
    result = fit_table(read_campaign(ROOT / "fitting/examples/pin-in-hole.toml"))
    view = FitView(result)
    # Of six pairs the first five.
    assert len(view.readings(view.best)) == 5
    assert bytes(explore_fit(result).children[1].value).startswith(b"\x89PNG")


def test_without_widgets_it_says_what_to_install(result, monkeypatch):
    monkeypatch.setitem(sys.modules, "ipywidgets", None)
    with pytest.raises(InputError, match="ipywidgets is not installed; run `make extras`"):
        explore_fit(result)
