"""The commands that print laws: `cylcontact laws` and `cylcontact export`."""

import json
from pathlib import Path

import numpy as np
import pytest

import cylcontact as cc
from cylcontact import laws
from cylcontact.choices import listed
from cylcontact.export import TARGETS

ROOT = Path(__file__).resolve().parents[1]


def test_laws_lists_every_law_and_the_explicit_laws_error(run):
    code, out, err = run("laws")
    assert (code, err) == (0, "")
    assert all(f"\n{name} " in out for name in laws.LAWS)
    assert "internal load: 0.1156 % of persson's" in out


def test_laws_leaves_out_what_is_not_for_rollers(run):
    code, out, _ = run("laws", "--contact", "external")
    assert code == 0
    assert "johnson" in out


def test_laws_advises_on_a_pin_and_a_hole_of_different_materials(run):
    code, out, err = run("laws", "--pin", "high-strength steel", "--hole", "aluminium alloy")
    assert (code, err) == (0, "")
    pin, hole = (cc.Material.named(name) for name in ("high-strength steel", "aluminium alloy"))
    pair = cc.CylinderPair.from_dR("internal", 0.05, hole, R_i=10.0, material_j=pin)
    exact = cc.laws.Conformal().penetration(100.0, pair)
    explicit, johnson = (
        100 * (law.penetration(100.0, pair) / exact - 1)
        for law in (cc.laws.Explicit(), cc.laws.Johnson())
    )
    assert f"α = {pair.alpha:.3f}, β = {pair.beta:.3f}" in out
    assert f"is off by: explicit {explicit:+.2f} %, johnson {johnson:+.2f} %" in out
    loads = np.array([1e-4, 1e-3, 0.01, 0.1, 1.0, 10.0]) * pair.E_star * pair.dR
    exact = cc.laws.Conformal().penetration(loads, pair)
    for law, words in (
        (cc.laws.Parametric(), "use parametric, at most {} % off at the φ below"),
        (cc.laws.ExplicitPair(), "or explicit-pair where one line is wanted, {} %"),
    ):
        worst = 100 * np.abs(law.penetration(loads, pair) / exact - 1).max()
        assert words.format(f"{worst:.2g}") in out
    assert "all penetrations are by Johnson's datum" in out
    at = cc.limits.first_yield(pair)
    assert f"first yield at {at.load:,.0f} N/mm (von Mises, in the {at.body}, " in out
    assert "penetration against conformal's at equal load" in out
    assert "too low against persson's" not in out


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--pin", "ceramics"), "laws: --hole: is missing beside --pin; name both"),
        (("--hole", "ceramics"), "laws: --pin: is missing beside --hole; name both"),
        (("--pin", "ceramics", "--hole", "soap"), "Material.named: name = 'soap': no material"),
        (
            ("--pin", "Bronze", "--hole", "ceramics"),
            "Material.named: name = 'Bronze': no material that ships has this name; choose "
            "ceramics, high-strength steel, low-carbon steel, titanium alloy, aluminium alloy, "
            "bronze, PEEK, PTFE, or",
        ),
        (
            ("--pin", "ceramics", "--hole", "ceramics", "--contact", "external"),
            "laws: --contact = 'external': has no pin and no hole; leave out --pin and --hole",
        ),
        (
            ("--pin", "PTFE", "--hole", "bronze", "--E", "110e3"),
            "laws: --E = 110000.0: is given by --pin and --hole already; leave it out",
        ),
        (
            ("--pin", "PTFE", "--hole", "bronze", "--nu", "0.46"),
            "laws: --nu = 0.46: is given by --pin and --hole already; leave it out",
        ),
    ],
)
def test_laws_refuses_half_a_pair_in_one_line(run, options, message):
    code, out, err = run("laws", *options)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert message in err


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("--nu", "0.7", "nu = 0.7: Poisson's ratio must lie in [0, 0.5]"),
        ("--dR", "-1", "dR = -1.0: must be positive"),
        ("--contact", "sideways", "must be 'internal' or 'external'"),
        ("--load", "many", "Invalid value for '--load'"),
    ],
)
def test_laws_refuses_a_bad_pair_in_one_line(run, option, value, message):
    code, out, err = run("laws", option, value)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert message in err


def test_export_prints_a_function(run):
    code, out, err = run("export", "explicit", "--contact", "internal", "--to", "c")
    assert (code, err) == (0, "")
    assert "double cylcontact_explicit_internal_load(" in out


def test_export_writes_a_refit_to_a_file(run, tmp_path):
    result, out = ROOT / "fitting/results/external.json", tmp_path / "new" / "law.json"
    code, message, err = run("export", result, "--to", "json", "-o", out)
    assert (code, err) == (0, "")
    assert message == f"{result} written to {out}\n"
    assert json.loads(out.read_text(encoding="ascii"))["law"] == "enhanced"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("explicit", "--to", "c"), "give --contact internal or --contact external"),
        (("explicit", "--to", "ada", "--contact", "internal"), f"choose {listed(TARGETS)}"),
        (("nosuch", "--to", "c"), "neither a law that can be exported nor a fit result"),
        (("johnson",), "--to"),
    ],
)
def test_export_refuses_in_one_line_and_writes_nothing(run, tmp_path, arguments, message):
    out = tmp_path / "law.c"
    code, printed, err = run("export", *arguments, "-o", out)
    assert (code, printed, err.count("\n")) == (2, "", 1)
    assert message in err
    assert not out.exists()


@pytest.mark.parametrize("modulus", ["200000", "2e5", "200 GPa", "200000 MPa"])
def test_a_modulus_is_in_mpa_or_has_a_unit(run, modulus):
    asked = run("laws", "--E", modulus)
    assert asked == run("laws", "--E", "200e3")
    assert asked[0] == 0
    assert asked != run("laws")


def test_a_modulus_below_1000_needs_its_unit(run):
    message = (
        "cylcontact: laws: --E = '210': a bare number is in MPa; did you mean \"210 GPa\"? "
        'For a material as soft as that write "210 MPa"\n'
    )
    assert run("laws", "--E", "210") == (2, "", message)
    code, out, err = run("laws", "--E", "210 MPa", "--load", "0.1")
    assert (code, err) == (0, "")
    assert "\n\ninternal contact, ΔR = " in out


def test_a_load_above_first_yield_is_warned_of_and_a_smaller_one_is_not(run):
    bodies = ("laws", "--pin", "low-carbon steel", "--hole", "aluminium alloy", "--dR", "0.01")
    code, out, err = run(*bodies, "--load", "9000")
    assert (code, "warning" in out) == (0, False)
    assert err.startswith("warning: the largest load, 9,000 N/mm, is above first yield at ")
    assert err.endswith("(von Mises, in the hole, at its surface); all laws here are elastic\n")
    assert run(*bodies, "--load", "900")[2] == ""
