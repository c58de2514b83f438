"""The commands that print laws: `cylcontact laws` and `cylcontact export`."""

import shlex
from pathlib import Path

import pytest

import cylcontact as cc
from cylcontact import laws

ROOT = Path(__file__).resolve().parents[2]


def test_laws_lists_every_law_and_the_explicit_laws_error(run):
    code, out, err = run("laws")
    assert (code, err) == (0, "")
    assert all(f"\n{name} " in out for name in laws.LAWS)
    code, out, err = run("laws", "--list")
    assert (code, err) == (0, "")
    assert all(f"\n  {name} " in out for name in laws.LAWS)
    assert "internal load: 0.1156 % of persson's" in out


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
    assert "for two materials use conformal" in out
    assert "all penetrations are by Johnson's datum" in out
    at = cc.limits.first_yield(pair)
    assert f"first yield at {at.load:,.0f} N/mm (von Mises, in the {at.body}, " in out
    assert "penetration against conformal's at equal load" in out
    assert "too low against persson's" not in out


def test_laws_takes_a_fit_and_temperatures(run):
    materials = ("--pin", "high-strength steel", "--hole", "bronze")
    code, out, err = run("laws", "--fit", "20H7/g6", *materials, "--temperature", "80")
    assert (code, err) == (0, "")
    middle = cc.CylinderPair.of_fit("20H7/g6", cc.Material.named("bronze"), share=0.5)
    grown = float(middle.R_i * 18e-6 * 60 - middle.R_j * 12e-6 * 60)
    assert out.startswith("20H7/g6: hole 20 +0.000 +0.021, pin 20 -0.020 -0.007 mm, ")
    assert f"internal contact, ΔR = {float(middle.dR) + grown:g} mm" in out


def test_laws_finds_a_clearance(run):
    code, out, err = run("laws", "--find", "dR", "--stiffness", "2e5", "--load", "500")
    pair = cc.CylinderPair.from_dR("internal", 0.05, cc.Material("", 207e3, 0.3), R_i=10.0)
    dR = cc.sizing.find("dR", pair, 500.0, stiffness=2e5)
    assert (code, err) == (0, "")
    assert out == f"dR = {dR:.6g} mm gives 200000 N/mm² under 500 N/mm, by Johnson's datum\n"
    code, out, err = run(*shlex.split("laws --find dR --stiffness 2e5 --load 500 --R-o 20"))
    law = cc.laws.Conformal(cc.laws.Housing(20.0))
    dR = cc.sizing.find("dR", pair, 500.0, stiffness=2e5, law=law)
    assert out.startswith(f"dR = {dR:.6g} mm gives 200000 N/mm² under 500 N/mm, in a ring clamped")
    code, out, err = run("laws", "--find", "length", "--penetration", "3", "--load", "1e4")
    assert (code, err) == (0, "")
    assert out.endswith(" mm gives 3 µm under 10000 N, by Johnson's datum\n")


REFUSED = [
    "--clamp far:60 | laws: --R-o: is required",
    "--R-o 20 --clamp side:60 | '--clamp': 'side:60' is no clamp; write rim, near:60",
    "--R-o 20 --layer bronze | '--layer': 'bronze' is no material with an inner radius",
    "--fit 20H7/k6 | laws: --fit = '20H7/k6': is a transition fit: ΔR is -7.5 to 9.5",
    "--fit 20H7/g6 --dR .1 | laws: --dR = 0.1: is given by the fit 20H7/g6",
    "--fit 8H7/g6 --contact external | --contact = 'external': has no fit",
    "--stiffness 1 | laws: --stiffness = 1.0: is for --find",
    "--find R | laws: --find = 'R': cannot be found; dR, E or length",
    "--find dR | laws: --stiffness: is missing; give stiffness or penetration",
    "--temperature hot | '--temperature': 'hot' must be one number or two",
    "--pin ceramics | laws: --hole: is missing beside --pin; name the hole's material",
    "--pin PTFE --hole 2e5, | '--hole': '2e5,' is no material; write its",
    "--pin PTFE --hole 210,.3 | '--hole': '210,.3': a bare number is in MPa; did you",
    "--pin ceramics --hole soap | laws: --hole = 'soap': is not in the tables of materials; choose",
    "--material '110 GPa, .34' --nu .3 | laws: --nu: says the same as --material; keep",
    "--contact external --material-i PTFE | --material-j: is missing beside --material-i; name the",
    "--hole-diameter 20 --Ri 10 | --hole-diameter: says the same as --Ri",
    "--dR .1 --Ri 10 --Rj 9 | laws: --dR = 0.1: follows from the radii",
    "--pin PTFE --hole PTFE --contact external | has no pin and no hole; leave out --pin",
    "--pin PTFE --hole bronze --nu 0.46 | --nu: is of both bodies, and --hole is of one",
    "--nu 30 | laws: --nu = 30.0: Poisson's ratio must lie in [0, 0.5]",
    "--dR -1 | dR = -1.0: must be positive",
    "--contact sideways | must be 'internal' or 'external'",
    "--load many | --load = 'many N/mm': is not a load",
    "--E 207e9 | '--E': '207e9': is beyond any material",
    "--E 210 | '--E': '210': a bare number is in MPa; did you mean \"210 GPa\"? For a",
]


@pytest.mark.parametrize("case", REFUSED)
def test_laws_refuses_what_one_may_mistake_in_one_line(run, case):
    options, _, message = case.partition(" | ")
    code, out, err = run("laws", *shlex.split(options))
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert message in err


def test_export_prints_a_law_and_writes_a_refit_to_a_file(run, tmp_path):
    code, out, err = run("export", "explicit", "--contact", "internal", "--to", "c")
    assert (code, err) == (0, "")
    assert "double cylcontact_explicit_internal_load(" in out
    result, out = ROOT / "fitting/results/external.json", tmp_path / "new" / "law.c"
    message = f"{result} written to {out}\n"
    assert run("export", result, "--to", "c", "-o", out) == (0, message, "")
    assert "double cylcontact_enhanced_external" in out.read_text(encoding="ascii")
    code, _, err = run("export", "johnson", "--to", "matlab", "-o", tmp_path / "bad-name.m")
    assert (code, "'bad-name': cannot be called by its name" in err) == (2, True)


def test_a_modulus_is_in_mpa_or_has_a_unit(run):
    asked = [run("laws", "--E", modulus) for modulus in ("200e3", "200 GPa", "200000 MPa")]
    assert asked[0] == asked[1] == asked[2] != run("laws")
    assert (asked[0][0], run("laws", "--E", "210 MPa", "--load", "0.1")[0]) == (0, 0)


@pytest.mark.slow
def test_a_load_above_first_yield_is_warned_of_and_a_smaller_one_is_not(run):
    bodies = ("laws", "--pin", "low-carbon steel", "--hole", "aluminium alloy", "--dR", "0.01")
    code, out, err = run(*bodies, "--load", "9000")
    assert (code, "warning" in out) == (0, False)
    assert err.startswith("warning: the largest load, 9,000 N/mm, is above first yield at ")
    assert err.endswith("(von Mises, in the hole, at its surface); all laws here are elastic\n")
    assert run(*bodies, "--load", "900")[2] == ""


def shown(run, *options):
    code, out, err = run("laws", *options)
    assert (code, err) == (0, "")
    return out


def test_a_pair_may_be_given_in_several_ways(run, tmp_path, monkeypatch):
    own = tmp_path / "own.csv"
    own.write_text("name;E_GPa;nu\npewter;102,5;0,34\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    by_name = shown(
        *(run, "--pin", "Pewter", "--hole", "pewter", "--materials", own),
        *("--hole-diameter", "20", "--pin-diameter", "19.9"),
    )
    of_both = ("--E", "102.5 GPa", "--nu", "0.34")
    for radii in (("--Ri", "10", "--Rj", "9.95"), ("--Rj", "9.95"), ("--dR", "0.05"), ()):
        assert shown(run, *of_both, *radii) == by_name
    (tmp_path / "datasets").mkdir()
    own.rename(tmp_path / "datasets/materials.csv")
    assert shown(run, "--material", "pewter") == by_name
    apart = shown(run, "--pin", "207 GPa, 0.3", "--hole", "110e3,0.34", "--load", "50")
    bronze = cc.Material("bronze", 110e3, 0.34)
    pair = cc.CylinderPair.internal(
        10.0, 9.95, pin=cc.Material("steel", "207 GPa", 0.3), hole=bronze
    )
    assert f"α = {pair.alpha:.3f}, β = {pair.beta:.3f}" in apart


def test_lengths_and_total_loads_may_have_units(run):
    plain = shown(run, "--dR", "0.04", "--length", "15", "--load", "400")
    assert shown(run, "--dR", "40 µm", "--length", "0.015 m", "--load", "6 kN") == plain
    total = ("--find", "length", "--stiffness", "1e6", "--load")
    assert shown(run, *total, "6 kN") == shown(run, *total, "6000")
    for wrong, why in (
        (("--dR", "40 um/mm"), "'40 um/mm' is not a length"),
        (("--load", "6 kN"), "no single axial length is known; give the length"),
        (("--load", "6 km"), "is not a load with its unit"),
    ):
        code, out, err = run("laws", *wrong)
        assert (code, out, err.count("\n")) == (2, "", 1)
        assert why in err


@pytest.mark.parametrize(
    ("options", "warning"),
    [
        (("--hole-diameter", "20", "--Rj", "5"), "the radial clearance over the hole's radius is"),
        (("--Ri", "10", "--dR", "0.00005"), "is a radius a diameter, or the clearance in metres?"),
        (("--length", "0.15"), "the axial length over the radius of the hole is 0.015"),
        (("--Ri", "10", "--Rj", "9.5"), ""),
        (("--contact", "external", "--Ri", "3", "--Rj", "300"), ""),
    ],
)
def test_lengths_that_can_hardly_be_meant_are_warned_of(run, options, warning):
    code, _, err = run("laws", "--load", "1e-3", *options)
    assert code == 0
    assert warning in err
    assert bool(err) == bool(warning)
