"""Laws of one joint in its housing as files: how near to the series they are, and what they say."""

import numpy as np
import pytest
from cylcontact.export.in_housing import law_in_housing

from cylcontact import CylinderPair, Material, laws
from cylcontact.laws import Housing, Sector

STEEL, BRONZE = Material("steel", 207e3, 0.3), Material("bronze", 110e3, 0.34)
PEEK, ALUMINIUM = Material("PEEK", 3.6e3, 0.38), Material("aluminium", 70e3, 0.33)
PHI = np.geomspace(1e-4, 10.0, 300)
CLAMPS = {"rim": "rim", "near:60": Sector(60), "far:180": Sector(180, "far"),
          "far:60": Sector(60, "far")}  # fmt: skip


def pair_of(pin, hole, R_i=10.0, dR=0.05):
    return CylinderPair.internal(R_i=R_i, R_j=R_i - dR, pin=pin, hole=hole)


@pytest.mark.parametrize("clamp", CLAMPS)
@pytest.mark.parametrize("rho", [1.3, 1.5, 2.0, 5.0])
@pytest.mark.parametrize(("pin", "hole"), [(STEEL, STEEL), (STEEL, PEEK), (PEEK, STEEL)])
def test_an_exported_law_is_as_near_to_its_curve_as_it_says(pin, hole, rho, clamp):
    pair, housing = pair_of(pin, hole), Housing(10 * rho, CLAMPS[clamp])
    series = laws.Conformal(housing)
    stated, words = law_in_housing(series, pair)
    f = PHI * pair.E_star * pair.dR
    delta = series.penetration(f, pair)
    error = np.abs(stated.load(delta, pair) / f - 1).max()
    assert words.startswith("a table of")
    assert error < 0.001
    said = float(words.split("within ")[1].split(" percent")[0])
    assert 100 * error == pytest.approx(said, rel=0.15, abs=0.01)
    stiffness = series.stiffness(delta, pair)
    np.testing.assert_allclose(stated.stiffness(delta, pair), stiffness, rtol=0.008)


def test_a_table_is_smooth_and_increases_at_all_of_its_nodes():
    pair = pair_of(STEEL, BRONZE)
    stated, _ = law_in_housing(laws.Conformal(Housing(13.0, Sector(60, "far"))), pair)
    x, y, slopes = np.array(stated.stated.nodes).T
    f = np.exp(y) * pair.E_star * pair.dR
    at = np.exp(x) * pair.dR
    np.testing.assert_allclose(stated.load(at[:-1], pair), f[:-1], rtol=1e-11)
    for side in (1 - 1e-9, 1 + 1e-9):  # the stiffness is continuous
        there = stated.stiffness(at[:-1] * side, pair)
        np.testing.assert_allclose(there, slopes[:-1] * f[:-1] / at[:-1], rtol=1e-7)
    between = np.geomspace(1e-12 * pair.dR, at[-1], 5000)
    assert np.all(np.diff(stated.load(between, pair)) > 0)
    assert np.all(stated.stiffness(between, pair) > 0)
    step = 1e-6
    f = [stated.load(between[:-1] * (1 + side * step), pair) for side in (-1, 1)]
    rate = (f[1] - f[0]) / (2 * step * between[:-1])
    np.testing.assert_allclose(stated.stiffness(between[:-1], pair), rate, rtol=1e-6)
    assert np.isnan(stated.load(1.001 * at[-1], pair))


def test_a_thin_eye_ends_where_the_pin_leaves_it():
    pair, housing = pair_of(STEEL, ALUMINIUM), Housing(13.0, Sector(300, "far"))
    stated, _ = law_in_housing(laws.Conformal(housing), pair)
    end = float(laws.Conformal(housing).max_penetration(pair))
    assert 0.7 * end < float(stated.max_penetration(pair)) <= end


JOINT = ("--pin", "207 GPa, 0.3", "--hole", "110 GPa, 0.34",
         "--Ri", 10, "--Rj", 9.95)  # fmt: skip


@pytest.mark.parametrize(
    ("clamp", "words"),
    [
        ("rim", ("a table of", "all of its rim clamped")),
        ("far:60", ("a table of", "60 degrees of its rim clamped, far from the load")),
    ],
)
def test_the_command_prints_the_error_and_the_file_says_what_it_is_for(run, tmp_path, clamp, words):
    out = tmp_path / "law.py"
    options = (*JOINT, "--R-o", 20, "--clamp", clamp, "--to", "python", "-o", out)
    code, _, errors = run("export", "conformal", *options)
    assert code == 0
    assert errors.startswith(f"conformal in this housing: {words[0]}")
    text = " ".join(out.read_text(encoding="ascii").replace("#", " ").split())
    for word in (*words, "R_o/R_i = 2", "E = 110000 MPa", "percent of the load by the series"):
        assert word in text
    assert ("is for no other direction" in text) == (clamp == "far:60")
    scope = {}
    exec(out.read_text(encoding="ascii"), scope)
    pair, clamp = pair_of(STEEL, BRONZE), CLAMPS[clamp]
    exact = float(laws.Conformal(Housing(20.0, clamp)).load(0.02, pair))
    arguments = 0.02, float(pair.E_star), float(pair.dR)
    assert scope["load"](*arguments) == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("johnson", *JOINT, "--R-o", 20), "takes no housing; choose conformal"),
        (("conformal", *JOINT, "--R-o", 9), "R_o = 9.0: must be larger than the hole"),
        (("parametric", *JOINT, "--R-o", 20), "RESULT|LAW = 'parametric': is gone; use conformal"),
        (("conformal", "--Ri", 10), "--Ri = 10.0: is for a law in a housing or a joint"),
        (("conformal", "--contact", "external", "--R-o", 20), "leave out --R-o and --clamp"),
    ],
)
def test_what_is_no_law_in_a_housing_is_refused_in_a_line(run, tmp_path, arguments, message):
    out = tmp_path / "law.c"
    code, _, errors = run("export", *arguments, "--to", "c", "-o", out)
    assert (code, errors.count("\n")) == (2, 1)
    assert message in errors
    assert not out.exists()
