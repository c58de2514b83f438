"""Noise × series × drift × errors of the load × uncertain inputs, against dense matrices."""

import random
from itertools import product

import numpy as np
import pytest
from scipy import stats

from cylcontact import CylinderPair, Material
from cylcontact.fitting import findings
from cylcontact.fitting.noise import positions
from cylcontact.fitting.readings import MEDIAN_TO_SIGMA, Optimum, fit_with_noise
from tests.support.measured_files import STEEL
from tests.support.noisy_series import LAW, PAIR, campaign_of, readings

GIVEN = 5e-5  # mm
COMBINATIONS = [
    *product(("given", "constant", "proportional", "both"), (0, 3, 6), (False, True), (0.0, 0.01),
             (None, {"dR": "2 um"})),
]  # fmt: skip
SIGMA_DR = 2e-3
SAMPLE = random.Random(2).sample(COMBINATIONS, 8)


def settings_of(noise, series, drift, load_error, uncertain):
    settings = {"group": "group"} if series else {}
    settings |= {"drift": True} if drift else {}
    settings |= {"load_error": load_error} if load_error else {}
    settings |= {"uncertain": uncertain} if uncertain else {}
    return settings if noise == "given" else settings | {"noise": noise}


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(
            case, id=" ".join(map(str, case)), marks=[pytest.mark.slow] * (case not in SAMPLE)
        )
        for case in COMBINATIONS
    ],
)
def test_errors_are_those_of_the_dense_covariance(case):
    noise, series, drift, load_error, uncertain = case
    frame = readings(
        7, series or 2, 9, constant=GIVEN, proportional=0.01, offset=2e-4, gain=0.02,
        drift=1e-4, load_error=load_error,
    )  # fmt: skip
    if noise == "given":
        frame["penetration_std_um"] = 1e3 * GIVEN
    pair = CylinderPair.internal(R_i=10.0, R_j=9.97, material=STEEL, length=20.0)
    fit = fit_with_noise(campaign_of(frame, "explicit", pair, starts=2, **settings_of(*case)))
    optimum = Optimum(fit, fit.lowest(np.array([[*([1.0, 2e-4, 0.03][: len(fit.free)])]])))
    assert [*optimum.fit.names] == ["stiffness_factor", "offset", *(["dR"] if uncertain else [])]
    load = frame["load_N_per_mm"].to_numpy()

    def reading(values):
        S, offset, dR = (*values, 0.03)[:3]
        other = CylinderPair.internal(R_i=10.0, R_j=10.0 - dR, material=STEEL, length=20.0)
        return LAW.penetration(load / S, other) + offset

    point = optimum.point
    steps = np.diag([1e-5, 1e-8, 1e-6][: point.size])
    slopes = [(reading(point + h) - reading(point - h)) / (2 * h.sum()) for h in steps]
    depth = reading(point) - point[1]
    per_load = (reading([point[0] / 1.00001, *point[1:]]) - reading(point)) / (1e-5 * load)
    own = optimum.fit.noise.deviations
    V = np.diag(
        (GIVEN if noise == "given" else own.get("constant", 0.0)) ** 2
        + (own.get("proportional", 0.0) * depth) ** 2
        + (per_load * load_error * load) ** 2
    )
    # The first series has its readings in order, as all have; alone, all rows are one.
    rows = load.size if not series else 9
    member = np.arange(load.size) // rows == np.arange(load.size // rows)[:, None]
    place = (np.arange(load.size) % rows) / (rows - 1)
    columns = {"offset": 1.0 + 0 * depth, "gain": depth} if series else {}
    columns |= {"drift": place} if drift else {}
    fixed = []
    for name, column in columns.items():
        parts = member * column
        if series == 6:
            V += own[name] ** 2 * parts.T @ parts
        else:
            fixed += [*(parts if name == "drift" else parts[1:] - parts[:1])]
    design = np.array([*slopes, *fixed]).T
    information = design.T @ np.linalg.solve(V, design)
    if uncertain:
        information[2, 2] += 1 / SIGMA_DR**2
    errors = np.sqrt(np.diag(np.linalg.inv(information)))[: point.size]
    assert optimum.errors == pytest.approx(errors, rel=1e-3, abs=0)


@pytest.mark.parametrize(
    ("time", "along"), [(None, [0, 0.5, 1, 0, 0.5]), ([0, 3, 4, 10, 11], [0, 0.75, 1, 0, 0.25])]
)
def test_a_position_along_a_series_is_a_part_of_the_longest(time, along):
    time = None if time is None else np.array(time, float)
    assert positions(np.array([0, 0, 0, 1, 1]), time).tolist() == along


def test_what_is_known_of_inputs_acts_on_the_pair_and_on_the_load():
    """A share of a clearance is of its value; loads were read in total, over the length."""
    uncertain = {"load": "1%", "length": "1%", "dR": "40%"}
    campaign = campaign_of(readings(1, 1), "explicit", PAIR, uncertain=uncertain, starts=2)
    known = {p.name: p.known for p in campaign.parameters if p.known is not None}
    assert known["dR"] == pytest.approx((0.03, 0.012))
    assert known["load_factor"] == known["length_factor"] == (1.0, 0.01)
    values = {p.name: p.nominal if p.known is None else p.known[0] for p in campaign.parameters}
    values |= {"load_factor": 1.02, "length_factor": 1.01, "offset": 0.0, "stiffness_factor": 1.0}
    law = campaign.model.build(values | {"dR": 0.04})
    wider = CylinderPair.internal(R_i=10.0, R_j=9.96, material=STEEL, length=20.0)
    load = np.array([20.0, 400.0])
    wanted = LAW.penetration(load * 1.02 / 1.01, wider)
    assert law.penetration(load, PAIR) == pytest.approx(wanted, rel=1e-9)
    # Body i is the hole.
    campaign = campaign_of(readings(1, 1), "explicit", PAIR, uncertain={"E_i": "2%"}, starts=2)
    values = {p.name: p.nominal if p.known is None else 1.1 for p in campaign.parameters}
    law = campaign.model.build(values | {"offset": 0.0, "stiffness_factor": 1.0})
    one, other = (
        CylinderPair.internal(10.0, 9.97, pin=STEEL, hole=Material("bronze", E, 0.34), length=20.0)
        for E in (110e3, 121e3)
    )
    assert law.penetration(load, one) == pytest.approx(LAW.penetration(load, other), rel=1e-9)


def test_the_median_of_normal_deviations_gives_their_standard_deviation():
    assert MEDIAN_TO_SIGMA == pytest.approx(1 / stats.norm.ppf(0.75), rel=1e-4)


def test_what_readings_narrow_is_told_in_percent_of_what_was_given():
    uncertain = {"dR": "20 um"}
    fit = fit_with_noise(
        campaign_of(readings(1, 2), "explicit", PAIR, uncertain=uncertain, starts=2)
    )
    optimum = Optimum(fit, fit.lowest(np.array([[1.0, 2e-4, 0.03]])))
    (sentence,) = findings._on_inputs(optimum)
    share = 100 * optimum.errors[2] / 0.02
    assert share < 90
    assert f"dR (±{share:.0f} % of the uncertainty given)" in sentence


@pytest.mark.parametrize(
    ("uncertain", "name", "sigma"),
    [
        ({"dR": "2um"}, "dR", 2e-3), ({"dR": "30 nm"}, "dR", 3e-5), ({"dR": 0.002}, "dR", 2e-3),
        ({"dR": "0.002 mm"}, "dR", 2e-3), ({"R_i": "3 µm", "R_j": "4 um"}, "dR", 5e-3),
        ({"E": "5%"}, "E_factor", 0.05), ({"E_j": "10 GPa"}, "E_j_factor", 10 / 207),
        ({"c": "10%"}, "c", 0.1 * LAW.coefficients_for("internal").c),
        ({"E": "5000 MPa"}, "E_factor", 5 / 207), ({"length": "0.1 mm"}, "length_factor", 0.005),
    ],
)  # fmt: skip
def test_an_uncertainty_is_read_in_its_unit(uncertain, name, sigma):
    campaign = campaign_of(readings(1, 1), "explicit", PAIR, uncertain=uncertain, starts=2)
    known = {p.name: p.known for p in campaign.parameters if p.known is not None}
    assert known.keys() == {name}
    assert known[name][1] == pytest.approx(sigma, rel=1e-9)
