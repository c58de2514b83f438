"""The shipped synthetic tables: the plain fit warns, and what it advises finds the truth."""

import runpy
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import brentq, minimize

import cylcontact as cc
from cylcontact.fitting.campaign import read_table

EXAMPLES = Path(__file__).resolve().parents[2] / "datasets/examples"
RIG, SPECIMENS = EXAMPLES / "rig.csv", EXAMPLES / "specimens.csv"
COLUMNS = {"penetration": "s [µm]"}
# The row of rig.csv that is off, by its line in the file.
OFF_LINE = 24


def script(table):
    return runpy.run_path(str(EXAMPLES / f"make_{table.stem}.py"))


def fit(table, **settings):
    settings = {"starts": 1, **({"columns": COLUMNS} if table == RIG else {}), **settings}
    return cc.fit(table, "explicit", script(table)["PAIR"], **settings)


def holds(result, truth):
    """Whether the interval of each searched coefficient holds its true value, by name."""
    estimates = result.estimates
    return {name: estimates[name].low < truth[name] < estimates[name].high for name in result.free}


@pytest.fixture(scope="module")
def corrected(tmp_path_factory):
    """The rig's table without the row that is off."""
    lines = RIG.read_text(encoding="utf-8").splitlines()
    path = tmp_path_factory.mktemp("rig") / "rig.csv"
    path.write_text("\n".join(lines[: OFF_LINE - 1] + lines[OFF_LINE:]), encoding="utf-8")
    return path


@pytest.mark.parametrize("table", [RIG, SPECIMENS], ids=lambda path: path.stem)
def test_a_table_is_what_its_script_writes(table):
    made = script(table)
    assert made["table"]() == table.read_text(encoding="utf-8")
    assert made["HEADER"].startswith("# SYNTHETIC, derived")
    columns = COLUMNS if table == RIG else {}
    campaign = read_table(table, "explicit", made["PAIR"], columns=columns).campaign("explicit")
    assert campaign.data.load.max() < float(cc.limits.yield_load(made["PAIR"]))


@pytest.mark.slow
def test_a_stiffness_that_is_not_the_pairs_is_told():
    pair = script(SPECIMENS)["PAIR"]
    right = fit(SPECIMENS, group="specimen")
    assert "as given" not in str(right)
    table = pd.read_csv(SPECIMENS, comment="#")
    table["load_kN"] *= 0.5
    wrong = " ".join(str(cc.fit(table, "explicit", pair, group="specimen")).split())
    assert "for the pair as given; possible causes: a diameter given as a radius" in wrong
    assert 'free="compliance"' in wrong


def test_the_plain_fit_of_the_rig_is_wrong_and_says_what_to_do():
    result = fit(RIG)
    truth = script(RIG)["TRUTH"]
    assert result.residuals["penetration_mm"].min() < 0
    assert not holds(result, truth)["stiffness_factor"]
    assert any("drift along the rows" in s and "--drift" in s for s in result.warnings)


@pytest.mark.slow
def test_the_rig_with_its_compliance_and_drift_gives_the_truth(corrected):
    truth = script(RIG)["TRUTH"]
    with_all = fit(RIG, free=["compliance"], drift=True)
    assert with_all.outliers == [OFF_LINE]
    result = cc.fit(
        corrected, "explicit", script(RIG)["PAIR"], columns=COLUMNS, free=["compliance"], drift=True
    )
    assert holds(result, truth) == dict.fromkeys(["stiffness_factor", "offset", "compliance"], True)
    noise = result.noise
    assert noise.deviations["constant"] == pytest.approx(truth["constant"], rel=0.25, abs=0)
    drift = noise.series[0].effects["drift"]
    assert drift == pytest.approx(truth["drift"], rel=0.1, abs=0)
    assert not result.warnings


@pytest.mark.slow
@pytest.mark.parametrize("scale", [0.0, 2.0])
def test_offsets_of_the_series_are_no_misfit_of_the_law(scale):
    pair = script(SPECIMENS)["PAIR"]
    table = pd.read_csv(SPECIMENS, comment="#")
    law = cc.laws.Explicit()
    exact = 1e3 * law.penetration(1e3 * table["load_kN"] / pair.length, pair)
    left = table["penetration_um"] - exact
    own = left.groupby(table["specimen"]).transform("median")
    table["penetration_um"] += (scale - 1) * own
    result = cc.fit(table, "explicit", pair, group="specimen")
    assert result.r_squared == pytest.approx(fit(SPECIMENS, group="specimen").r_squared, abs=1e-3)
    assert "does not describe" not in str(result)


def test_the_specimens_by_groups_give_the_truth():
    truth = script(SPECIMENS)["TRUTH"]
    result = fit(SPECIMENS, group="specimen")
    assert holds(result, truth | {"offset": 0.0}) == {"stiffness_factor": True, "offset": True}
    deviations = result.noise.deviations
    # The standard error of a deviation from n values is 1/√(2(n − 1)) of it: 25 % from 9
    # specimens; of the two scatters each is told by a part of the 90 rows.
    for name, share in {"offset": 0.5, "gain": 0.5, "constant": 0.5, "proportional": 0.3}.items():
        assert deviations[name] == pytest.approx(truth[name], rel=share, abs=0), name
    table = pd.read_csv(SPECIMENS, comment="#")
    law, pair = cc.laws.Explicit(), script(SPECIMENS)["PAIR"]
    load = 1e3 * table["load_kN"].to_numpy() / pair.length
    table["exact"], more = (1e3 * law.penetration(part * load, pair) for part in (1.0, 1.01))
    gains = [
        np.polyfit(rows["exact"], rows["penetration_um"], 1)[0]
        for _, rows in table.groupby("specimen")
    ]
    # The mean of n gains has the standard error sd/√n. 1 % of load acts as a gain of less.
    gain_of_load = (np.polyfit(table["exact"], more, 1)[0] - 1) / 0.01
    by_hand = np.std(gains, ddof=1) / np.sqrt(len(gains)) / gain_of_load
    error = result.to_frame().loc["stiffness_factor", "standard_error"]
    assert error == pytest.approx(by_hand, rel=0.05, abs=0)


def test_an_interval_ends_where_the_fit_is_worse_although_another_coefficient_meets_its_bound():
    result = fit(RIG, bounds={"compliance": (0.0, 2e-5)})
    estimates = result.estimates
    assert estimates["compliance"].low_is_bound
    data = result.residuals
    load, seen = data["load_N_per_mm"].to_numpy(), data["penetration_mm"].to_numpy()
    law, pair = cc.laws.Explicit(), script(RIG)["PAIR"]

    def squares(factor):
        """The least squares by offset and compliance, which is not negative."""
        left = seen - law.penetration(load / factor, pair)
        columns = np.column_stack([np.ones_like(load), load])
        values = np.linalg.lstsq(columns, left, rcond=None)[0]
        if values[1] < 0:
            return float(((left - left.mean()) ** 2).sum())
        return float(((left - columns @ values) ** 2).sum())

    best = minimize(lambda x: 1e6 * squares(x[0]), [0.9], method="Nelder-Mead", tol=1e-9)
    factor = float(best.x[0])
    assert result.coefficients["stiffness_factor"] == pytest.approx(factor, rel=1e-3, abs=0)
    # The F distribution with 1 and 50 degrees of freedom has 4.0343 at 95 %.
    most = squares(factor) * (1 + 4.0343 / (load.size - 3))
    low = brentq(lambda value: squares(value) - most, 0.4, factor)
    high = brentq(lambda value: squares(value) - most, factor, 3.0)
    ends = estimates["stiffness_factor"]
    assert (ends.low, ends.high) == pytest.approx((low, high), rel=1e-3, abs=0)
