"""Inputs known only so well: Gaussian statements about them count as further readings."""

import json

import numpy as np
import pandas as pd
import pytest

import cylcontact as cc
from cylcontact import InputError, laws
from cylcontact.fitting import read_result
from cylcontact.fitting.campaign import read_table
from tests.support.measured_files import STEEL
from tests.support.noisy_series import PAIR, readings

LOAD = np.geomspace(10.0, 1000.0, 12)
KNOWN = {"dR": "2 um", "E": "5%"}


def frame(seed=0, pair=PAIR, number=12):
    load = np.geomspace(10.0, 1000.0, number)
    depth, rng = laws.Explicit().penetration(load, pair), np.random.default_rng(seed)
    depth = depth * (1 + 0.01 * rng.normal(size=number))
    return pd.DataFrame({"load_N_per_mm": load, "penetration_um": 1e3 * depth})


@pytest.fixture(scope="module")
def fits():
    return cc.fit(frame(), "explicit", PAIR), cc.fit(frame(), "explicit", PAIR, uncertain=KNOWN)


def test_what_is_known_widens_the_stiffness_as_by_hand(fits):
    """By the general least squares of readings and statements, linearised with scipy's slopes."""
    _, known = fits
    optimum, names = known.optimum, known.optimum.fit.names
    assert [*names] == ["stiffness_factor", "offset", "dR", "E_factor"]

    def reading(values):
        S, offset, dR, E = values
        steel = cc.Material("steel", E=E * STEEL.E, nu=STEEL.nu)
        pair = cc.CylinderPair.internal(R_i=10.0, R_j=10.0 - dR, material=steel, length=20.0)
        return laws.Explicit().penetration(LOAD / S, pair) + offset

    steps = 1e-5 * np.array([1.0, 1e-3, 0.03, 1.0])
    columns = [
        (reading(optimum.point + step) - reading(optimum.point - step)) / (2 * step.sum())
        for step in np.diag(steps)
    ]
    weighed = np.array(columns).T / optimum.fit.noise.scale[:, None]
    statements = np.zeros((2, 4))
    statements[0, 2], statements[1, 3] = 1 / 0.002, 1 / 0.05
    both = np.vstack([weighed, statements])
    errors = np.sqrt(np.diag(np.linalg.inv(both.T @ both)))
    assert optimum.errors == pytest.approx(errors, rel=1e-4)
    width = [
        fit.estimates["stiffness_factor"].high - fit.estimates["stiffness_factor"].low
        for fit in fits
    ]
    assert width[1] > 5 * width[0]
    assert known.estimates["E_factor"].verdict == "as given"
    assert known.estimates["E_factor"].high == pytest.approx(1 + 1.96 * 0.05, abs=2e-3)


def test_a_report_says_what_is_exact_or_known(fits):
    exact, known = (" ".join(str(fit).split()) for fit in fits)
    assert "radii and moduli are taken as exact: 1 µm more of ΔR would change" in exact
    assert "known from elsewhere, and fitted as further readings: dR, E_factor" in known


def test_the_change_that_a_report_names_is_that_of_a_fit_with_another_clearance(fits):
    (note,) = [text for text in fits[0].notes if "taken as exact" in text]
    change = float(note.split("stiffness_factor by ")[1].split(" %")[0])
    pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.969, material=STEEL, length=20.0)
    moved = cc.fit(frame(), "explicit", pair).coefficients["stiffness_factor"]
    expected = 100 * (moved / fits[0].coefficients["stiffness_factor"] - 1)
    assert change == pytest.approx(expected, rel=0.1)


def test_a_result_keeps_what_was_uncertain(fits, tmp_path):
    _, known = fits
    known.save(tmp_path / "r.json")
    again = read_result(tmp_path / "r.json")
    assert again == known
    at = [100.0, 500.0]
    pd.testing.assert_frame_equal(again.predict(at), known.predict(at), rtol=1e-9)
    # The law for any pair has the modulus that was found, and not the pair's own clearance.
    law, (S, E) = again.to_law(), (known.coefficients[n] for n in ("stiffness_factor", "E_factor"))
    assert law.load(1e-3, PAIR) == pytest.approx(S * E * laws.Explicit().load(1e-3, PAIR), rel=1e-9)


def test_each_clearance_of_a_table_is_another_measurement():
    parts = []
    for dR in (0.03, 0.06):
        pair = cc.CylinderPair.internal(R_i=10.0, R_j=10.0 - dR, material=STEEL, length=20.0)
        parts.append(frame(1, pair).assign(dR_um=1e3 * dR))
    constants = {"E_GPa": 207.0, "nu": 0.3, "R_i_mm": 10.0, "length_mm": 20.0}
    given = {"contact": "internal", "constants": constants, "uncertain": {"dR": "10%"}}
    campaign = read_table(pd.concat(parts), "explicit", None, **given).campaign("explicit")
    assert {"dR_0.03", "dR_0.06"} <= {p.name for p in campaign.parameters if p.is_free}


@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in (1, 2))])
def test_a_wrong_clearance_is_inside_its_interval(seed):
    stated = cc.CylinderPair.internal(R_i=10.0, R_j=9.967, material=STEEL, length=20.0)
    table = frame(seed, number=30)  # of a clearance of 30 µm, stated as 33 µm
    plain = cc.fit(table, "explicit", stated).estimates["stiffness_factor"]
    assert not plain.low < 1 < plain.high
    known = cc.fit(table, "explicit", stated, uncertain={"dR": "2 um"})
    for name, truth in (("stiffness_factor", 1.0), ("dR", 0.03)):
        assert known.estimates[name].low < truth < known.estimates[name].high


@pytest.mark.parametrize("modulus", ["E_i", "E_j"])
def test_the_law_of_a_fit_with_one_uncertain_modulus_is_that_of_the_contact(modulus):
    known = cc.fit(frame(), "explicit", PAIR, uncertain={modulus: "5%"})
    expected = known.coefficients["stiffness_factor"] * laws.Explicit().load(1e-3, PAIR)
    assert known.to_law().load(1e-3, PAIR) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("uncertain", "words"),
    [
        ({"dr": 0.002}, "uncertain.dr: is not an input or a parameter of this fit; choose dR"),
        ({"dR": "2 kg"}, 'must be a positive standard uncertainty; give e.g. "2 um"'),
        ({"E": "-5%"}, "of a tolerance ±t it is t/√3, of a certificate's U it is U/2"),
        ({"dR": 0.001, "R_i": 0.001}, "uncertain.R_i: is uncertain as well as dR; keep one"),
        ({"load": 5.0}, 'must be a share of the load; give e.g. "1%"'),
    ],
)
def test_refusals(uncertain, words):
    with pytest.raises(InputError) as caught:
        cc.fit(frame(), "explicit", PAIR, uncertain=uncertain)
    assert words in str(caught.value)


def test_compared_fits_of_one_table_are_called_by_their_folders(run, tmp_path, fits):
    paths = [tmp_path / name / "result.json" for name in ("exact", "uncertain")]
    for fit, path in zip(fits, paths, strict=True):
        path.parent.mkdir()
        fit.save(path)
    (one,), (other,) = (kind["results"] for kind in json.loads(run("compare", *paths, "--json")[1]))
    assert (one["name"], other["name"]) == ("exact", "uncertain")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("settings", "more"),
    [
        ({"load_error": 0.02}, {}),
        ({"group": "group"}, {}),
        ({"group": "group", "load_error": 0.01}, {"load": "1%"}),
        ({"fixed": {"compliance": 0.0}}, {"compliance": 1e-8}),
    ],
)
def test_laws_are_compared_with_uncertain_inputs_beside_other_noise(settings, more):
    table = readings(2, 6, 6, offset=2e-4, gain=0.03) if "group" in settings else frame(1)
    choice = cc.choose(
        table, PAIR, laws=["explicit", "johnson"], uncertain=KNOWN | more, **settings
    )
    assert "explicit" in choice.undecided
    names = {"dR", "E_factor", "compliance", *["load_factor"] * ("load" in more)}
    assert all(names <= {*law.optimum.fit.names} for law in choice.laws)
    assert choice.best.optimum.best["dR"] == pytest.approx(0.03, abs=3 * 0.002)


# --- what a sampler needs, and a table for a paper ----------------------------------------------


def test_the_log_posterior_falls_as_a_profile_rises(fits):
    _, known = fits
    optimum, best = known.optimum, known.log_posterior({})
    held = optimum.fit.fixing(dR=0.032)
    point, value = held.minimise(held.point(optimum.best))
    there = known.log_posterior(
        held.coefficients(point) and {n: held.coefficients(point)[n] for n in known.free}
    )
    assert best - there == pytest.approx(0.5 * optimum.rise(np.array([value]))[0] ** 2, rel=1e-6)
    assert known.log_posterior({"stiffness_factor": 30.0}) == -np.inf
    with pytest.raises(InputError, match="was not searched; give stiffness_factor"):
        known.log_posterior({"c": 1.0})


def test_a_latex_table_has_the_cells_of_the_report(fits):
    table = fits[1].to_latex()
    assert table.startswith(r"\begin{tabular}{lrrrrr}")
    assert r"stiffness\_factor & " in table
    assert table.count(r"\\") == len(fits[1].table.rows) + 1
