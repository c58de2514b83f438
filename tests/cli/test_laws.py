"""The commands that print laws: `cylcontact laws` and `cylcontact export`."""

import json
import shlex
from pathlib import Path

import numpy as np
import pytest

import cylcontact as cc
from cylcontact import laws, limits

ROOT = Path(__file__).resolve().parents[2]


PIN_IN_EYE = "--pin 'high-strength steel' --hole bronze --Ri 10 --dR 0.05 --R-o 20 --clamp far:60"


def shown(run, line):
    """What `cylcontact laws` prints."""
    code, out, err = run("laws", *shlex.split(line))
    assert (code, err) == (0, "")
    return out


def numbers(run, line):
    """The numbers of a joint, as JSON has them."""
    return json.loads(shown(run, f"{line} --json"))["numbers"]


def test_the_answer_comes_first_and_on_one_screen(run):
    out = shown(run, f"{PIN_IN_EYE} --load 1000 --length 10")
    lines = out.splitlines()
    assert len(lines) <= 20
    assert max(map(len, lines)) <= 100
    steel, bronze = (cc.Material.named(name) for name in ("high-strength steel", "bronze"))
    pair = cc.CylinderPair.internal(10.0, 9.95, pin=steel, hole=bronze, length=10.0)
    law = laws.Conformal(laws.Housing(20.0, laws.Sector(60, "far")))
    depth = float(law.penetration(1000.0, pair))
    assert lines[4] == f"penetration       {1e3 * depth:.4g} µm"
    assert "10,000 N on 10 mm" in out
    assert f"nominal pressure  {1000 / (2 * 9.95):.4g} MPa" in out
    yields = float(limits.first_yield(pair, housing=law.datum).load)
    assert f"factor to yield   {yields / 1000:.3g}" in out


def test_a_lug_is_the_far_sector_that_it_names(run):
    line = "--material 'low-carbon steel' --Ri 20 --Rj 19.98 --R-o 40 --load 1000"
    for lug, sector in (("lug", "far:110"), ("lug:1.3", "far:130")):
        assert numbers(run, f"{line} --clamp {lug}") == numbers(run, f"{line} --clamp {sector}")
        housing = shown(run, f"{line} --clamp {lug}").splitlines()[1]
        assert f"lug of R_o = 40 mm, shank {80 * float(lug[4:] or 1):g} mm wide" in housing
        assert f"as {sector}: first yield 0 to" in housing
        assert len(housing) <= 100


def test_all_laws_side_by_side_their_accuracy_and_their_names(run):
    out = shown(run, "--material bronze --Ri 10 --dR 0.05 --length 10 --all")
    assert all(f"{name} " in out for name in laws.LAWS)
    out = shown(run, "--accuracy")
    assert [line for line in out.splitlines() if line.startswith("explicit ")]
    out = shown(run, "--list")
    assert all(f"\n  {name} " in out for name in laws.LAWS)


def test_a_fit_is_answered_for_its_band_in_its_housing(run):
    line = "--pin 'high-strength steel' --hole bronze --R-o 20 --load 1000"
    band = numbers(run, f"{line} --fit 20H7/g6")
    for name, share in (("tightest", 0.0), ("middle", 0.5), ("loosest", 1.0)):
        fit = cc.fits.Fit.read("20H7/g6")
        R_i, R_j = (float(radius) for radius in fit.radii(share))
        alone = numbers(run, f"{line} --Ri {R_i!r} --Rj {R_j!r}")["joint"]
        for key in ("penetration_um", "stiffness_N_per_mm2", "first_yield_N_per_mm"):
            assert band[name][key] == pytest.approx(alone[key], rel=1e-6)
    assert band["5 %"]["penetration_um"] < band["mean"]["penetration_um"]


def test_a_tight_end_of_a_fit_leaves_the_others(run):
    out = shown(run, "--material 'low-carbon steel' --fit 20H7/k6")
    assert "no clearance" in out
    assert "% of the pairs have no clearance" in out


def test_a_plane_state_and_a_plane_body(run):
    stress = numbers(run, "--material bronze --Ri 10 --dR 0.05 --plane stress")["joint"]
    bronze = cc.Material.named("bronze")
    pair = cc.CylinderPair.internal(10.0, 9.95, bronze, plane="stress")
    expected = 1e3 * float(laws.Conformal().penetration(100.0, pair))
    assert stress["penetration_um"] == pytest.approx(expected, rel=1e-9)
    line = "--contact external --material-i bronze --material-j bronze --Ri 15 --Rj inf --depth 50"
    flat = cc.CylinderPair.external(15.0, np.inf, bronze)
    expected = 1e3 * float(laws.Johnson(datum=50.0).penetration(100.0, flat))
    assert numbers(run, line)["joint"]["penetration_um"] == pytest.approx(expected, rel=1e-9)


def test_a_material_by_numbers_has_a_yield_stress(run):
    out = shown(run, "--material '207 GPa, 0.3, 350 MPa, 12e-6/K' --Ri 10 --dR 0.05")
    pair = cc.CylinderPair.internal(10.0, 9.95, cc.Material("", 207e3, 0.3, 350.0))
    assert f"{float(limits.first_yield(pair).load):,.0f} N/mm (von Mises" in out
    assert "yield stresses are not given" in shown(run, "--E '207 GPa' --nu .3 --Ri 10 --dR .05")


def test_laws_takes_temperatures(run):
    line = "--pin 'high-strength steel' --hole bronze --temperature 80"
    middle = cc.CylinderPair.of_fit("20H7/g6", cc.Material.named("bronze"), share=0.5)
    grown = 1e3 * float(middle.R_i * 18e-6 * 60 - middle.R_j * 12e-6 * 60)
    band = numbers(run, f"{line} --fit 20H7/g6")
    assert band["middle"]["clearance_um"] == pytest.approx(1e3 * float(middle.dR) + grown)
    free = numbers(run, f"{line} --Ri 10 --Rj 9.95 --R-o 20 --rim free")["joint"]
    held = numbers(run, f"{line} --Ri 10 --Rj 9.95 --R-o 20 --rim held")["joint"]
    assert held["clearance_um"] < free["clearance_um"]


def test_laws_finds_a_clearance(run):
    line = "--E '207 GPa' --nu .3 --Ri 10 --find dR --stiffness 2e5 --load 500"
    pair = cc.CylinderPair.from_dR("internal", 0.05, cc.Material("", 207e3, 0.3), R_i=10.0)
    dR = cc.sizing.find("dR", pair, 500.0, stiffness=2e5)
    datum = "by Johnson's datum"
    assert shown(run, line) == f"dR = {dR:.6g} mm gives 200000 N/mm² under 500 N/mm, {datum}\n"
    dR = cc.sizing.find("dR", pair, 500.0, stiffness=2e5, law=laws.Conformal(laws.Housing(20.0)))
    assert shown(run, f"{line} --R-o 20").startswith(f"dR = {dR:.6g} mm gives 200000 N/mm²")
    rollers = "--E '207 GPa' --nu .3 --Ri 10 --dR .05 --find length --penetration 3 --load 1e4"
    assert shown(run, rollers).endswith(f" mm gives 3 µm under 10000 N, {datum}\n")


BOTH = "--material bronze"
REFUSED = [
    f"{BOTH} --Ri 10 --dR .05 --clamp far:60 | laws: --R-o: is required",
    f"{BOTH} --R-o 20 --clamp side:60 | '--clamp': 'side:60' is no clamp; write rim, lug",
    f"{BOTH} --R-o 20 --clamp lug:0.4 | laws: --clamp = 0.4: must be at least 0.5",
    "--R-o 20 --layer bronze | '--layer': 'bronze' is no material with an inner radius",
    f"{BOTH} --fit 20H5/n6 | leaves no clearance at any pair",
    f"{BOTH} --fit 20H7/g6 --dR .1 | laws: --dR = 0.1: is given by the fit 20H7/g6",
    f"{BOTH} --fit 8H7/g6 --contact external | --contact = 'external': has no fit",
    "--stiffness 1 | laws: --stiffness = 1.0: is for --find",
    f"{BOTH} --Ri 10 --dR .05 --find R | laws: --find = 'R': cannot be found; dR, E or length",
    f"{BOTH} --find dR | laws: --stiffness: is missing; give stiffness or penetration",
    "--temperature hot | '--temperature': 'hot' must be one number or two",
    f"{BOTH} --Ri 10 --dR .05 --rim free | laws: --rim = 'free': is for --temperature",
    f"{BOTH} --Ri 10 --dR .05 --temperature 80 --R-o 20 | laws: --rim: is missing: how far",
    "--pin PEEK --hole bronze --Ri 10 --dR .05 --temperature 80 | is a polymer",
    f"{BOTH} --hole-diameter 40 | laws: --Rj: is missing: two of --Ri, --Rj and --dR are needed",
    f"{BOTH} --contact external --Ri 15 | laws: --Rj: is missing; give the radii of both rollers",
    f"{BOTH} --contact external --Ri 15 --Rj inf | laws: --depth: is missing for a plane",
    f"{BOTH} --Ri 10 --dR .05 --plane flat | --plane = 'flat': must be strain or stress",
    "--pin ceramics --Ri 10 --dR .1 | laws: --hole: is missing; give e.g. --material",
    "--pin PTFE --hole 2e5, | '--hole': '2e5,' is no material; write its",
    "--pin PTFE --hole 210,.3 | '--hole': '210,.3': a bare number is in MPa; did you",
    "--pin ceramics --hole soap | laws: --hole = 'soap': is not in the tables of materials; choose",
    "--material '110 GPa, .34' --nu .3 | laws: --nu: says the same as --material; keep",
    f"{BOTH} --hole-diameter 20 --Ri 10 | --hole-diameter: says the same as --Ri",
    f"{BOTH} --dR .1 --Ri 10 --Rj 9 | laws: --dR = 0.1: follows from the radii",
    "--pin PTFE --hole PTFE --contact external | has no pin and no hole; leave out --pin",
    "--pin PTFE --hole bronze --nu 0.46 | --nu: is of both bodies, and --hole is of one",
    "--E '207 GPa' --nu 30 --Ri 10 --dR .1 | laws: --nu = 30.0: Poisson's ratio must lie in",
    f"{BOTH} --Ri 10 --dR -1 | dR = -1.0: must be positive",
    "--contact sideways | must be 'internal' or 'external'",
    f"{BOTH} --Ri 10 --dR .1 --load many | --load = 'many N/mm': is not a load",
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
    message = f"{result} written to {out}, {out.with_suffix('.h')}\n"
    assert run("export", result, "--to", "c", "-o", out) == (0, message, "")
    assert "double cylcontact_enhanced_external" in out.read_text(encoding="ascii")
    code, _, err = run("export", "johnson", "--to", "matlab", "-o", tmp_path / "bad-name.m")
    assert (code, "'bad-name': cannot be called by its name" in err) == (2, True)


STEEL = "--nu 0.3 --Ri 10 --dR 0.05"


def test_a_modulus_is_in_mpa_or_has_a_unit(run):
    asked = [shown(run, f"--E '{E}' {STEEL}") for E in ("200e3", "200 GPa", "200000 MPa")]
    assert asked[0] == asked[1] == asked[2] != shown(run, f"--E '207 GPa' {STEEL}")


def test_a_load_above_first_yield_is_warned_of_and_a_smaller_one_is_not(run):
    line = "laws --pin 'low-carbon steel' --hole 'aluminium alloy' --Ri 10 --dR 0.01 --load"
    code, out, err = run(*shlex.split(f"{line} 9000"))
    assert (code, "warning" in out) == (0, False)
    assert err.startswith("warning: the largest load, 9,000 N/mm, is above first yield at ")
    assert run(*shlex.split(f"{line} 900"))[2] == ""


def test_a_pair_may_be_given_in_several_ways(run, tmp_path, monkeypatch):
    own = tmp_path / "own.csv"
    own.write_text("name;E_GPa;nu\npewter;102,5;0,34\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    line = f"--pin Pewter --hole pewter --materials {own}"
    by_name = shown(run, f"{line} --hole-diameter 20 --pin-diameter 19.9")
    for radii in ("--Ri 10 --Rj 9.95", "--Ri 10 --dR 0.05", "--Rj 9.95 --dR 50um"):
        text = shown(run, f"--E '102.5 GPa' --nu 0.34 {radii}".replace("50um", "'50 um'"))
        assert text.replace("102.5 GPa", "pewter") == by_name
    (tmp_path / "datasets").mkdir()
    own.rename(tmp_path / "datasets/materials.csv")
    assert shown(run, "--material pewter --Ri 10 --dR 0.05") == by_name


def test_lengths_and_total_loads_may_have_units(run):
    line = "--material bronze --Ri 10"
    plain = shown(run, f"{line} --dR 0.04 --length 15 --load 400")
    assert shown(run, f"{line} --dR '40 µm' --length '0.015 m' --load '6 kN'") == plain
    for wrong, why in (
        ("--dR '40 um/mm'", "'40 um/mm' is not a length"),
        ("--dR 0.04 --load '6 kN'", "no single axial length is known; give the length"),
        ("--dR 0.04 --load '6 km'", "is not a load with its unit"),
    ):
        code, out, err = run("laws", *shlex.split(f"{line} {wrong}"))
        assert (code, out, err.count("\n")) == (2, "", 1)
        assert why in err


@pytest.mark.parametrize(
    ("options", "warning"),
    [
        ("--hole-diameter 20 --Rj 5", "the radial clearance over the hole's radius is"),
        ("--Ri 10 --dR 0.00005", "is a radius a diameter, or the clearance in metres?"),
        ("--Ri 10 --dR .05 --length 0.15", "the axial length over the radius of the hole is 0.015"),
        ("--Ri 10 --Rj 9.5", ""),
        ("--contact external --Ri 3 --Rj 300", ""),
    ],
)
def test_lengths_that_can_hardly_be_meant_are_warned_of(run, options, warning):
    code, _, err = run("laws", "--load", "1e-3", "--material", "bronze", *shlex.split(options))
    assert code == 0
    assert warning in err
    assert bool(err) == bool(warning)
