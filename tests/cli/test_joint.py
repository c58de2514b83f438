"""The commands `check` and `size`: a joint as options give it."""

import json
import re
import shlex

import pytest

import cylcontact as cc
from cylcontact import laws, limits

PIN_IN_EYE = (
    "--pin 'high-strength steel' --hole bronze --Ri 10 --radial-clearance 0.05 --R-o 20 "
    "--clamp pulled:60"
)


def shown(run, line, warnings=False):
    """What `cylcontact check`, or another command that is named, prints."""
    words = shlex.split(line)
    words = words if words[0] == "size" else ["check", *words]
    code, out, err = run(*words)
    assert (code, bool(err)) == (0, warnings)
    return out


def answer(run, line, warnings=False):
    """The answer as JSON has it."""
    return json.loads(shown(run, f"{line} --json", warnings))


def numbers(run, line):
    """The numbers of a joint, as JSON has them."""
    return answer(run, line)["numbers"]


def test_the_answer_comes_first_and_on_one_screen(run):
    out = shown(run, f"{PIN_IN_EYE} --load 1000 --length 10")
    lines = out.splitlines()
    assert len(lines) <= 20
    assert max(map(len, lines)) <= 100
    steel, bronze = (cc.Material.named(name) for name in ("high-strength steel", "bronze"))
    pair = cc.CylinderPair.internal(10.0, 9.95, pin=steel, hole=bronze, length=10.0)
    law = laws.Conformal(laws.Housing(20.0, laws.Sector(60, "pulled")))
    depth = float(law.penetration(1000.0, pair))
    assert lines[5] == f"penetration         {1e3 * depth:.4g} µm"
    assert "clearance 50 µm radial, 100 µm on the diameter" in out
    assert "10,000 N on 10 mm" in out
    assert f"projected pressure  {1000 / (2 * 9.95):.4g} MPa" in out
    assert f"contact angle       {float(law.contact_angle(1000.0, pair)):.4g}°, each side" in out
    yields = float(limits.first_yield(pair, housing=law.datum).load)
    assert f"factor to yield     {yields / 1000:.4g}" in out
    assert "not included        bending and tilt of the pin, friction, wear, plastic flow" in out


def test_json_has_the_numbers_of_the_text(run):
    line = f"{PIN_IN_EYE} --load 1000 --length 10"
    text, found = shown(run, line), numbers(run, line)["joint"]
    rows = {
        "penetration": "penetration_um",
        "stiffness": "stiffness_N_per_mm2",
        "total stiffness": "total_stiffness_N_per_mm",
        "contact angle": "contact_angle_deg",
        "width of contact": "width_mm",
        "peak pressure": "peak_pressure_MPa",
        "peak is at": "peak_at_deg",
        "projected pressure": "projected_pressure_MPa",
        "first yield": "first_yield_N_per_mm",
        "factor to yield": "factor_to_yield",
    }
    for name, key in rows.items():
        printed = re.search(rf"^{name} +([\d,.]+)", text, re.MULTILINE)[1].replace(",", "")
        assert float(printed) == pytest.approx(found[key], rel=6e-4)


def test_a_lug_is_the_pulled_sector_that_it_names(run):
    line = "--material 'low-carbon steel' --Ri 20 --Rj 19.98 --R-o 40 --load 1000"
    for lug, sector in (("lug", "pulled:110"), ("lug:1.3", "pulled:130")):
        assert numbers(run, f"{line} --clamp {lug}") == numbers(run, f"{line} --clamp {sector}")
        housing = shown(run, f"{line} --clamp {lug}").splitlines()[2]
        assert f"lug of R_o = 40 mm, shank {80 * float(lug[4:] or 1):g} mm wide" in housing
        assert f"as {sector}: first yield 0 to" in housing
        assert len(housing) <= 100


def test_a_lug_outside_the_study_says_so(run):
    line = "--material 'low-carbon steel' --Ri 20 --Rj 19.9 --R-o 23 --clamp lug --load 50"
    out = shown(run, line, warnings=True)
    assert "(as pulled:110)" in out
    assert "% low" not in out
    assert "outside of what finite elements have checked" in answer(run, line, True)["warnings"][0]


def test_the_worst_pair_of_a_fit_is_warned_of(run):
    line = "--iso 20H7/g6 --pin 'low-carbon steel' --hole bronze --load 3250"
    out = answer(run, line, warnings=True)
    factors = {name: each["factor_to_yield"] for name, each in out["numbers"].items()}
    assert factors["tightest"] < 1 < factors["loosest"]
    assert out["worst"] == "tightest"
    assert "is above first yield of the tightest pair" in out["warnings"][0]


def test_a_tight_end_of_a_fit_leaves_the_others(run):
    out = shown(run, "--material 'low-carbon steel' --iso 20H7/k6")
    assert "no clearance" in out
    assert "31 % of the pairs have no clearance" in out


def test_a_fit_without_yield_stresses_has_all_other_rows(run):
    out = shown(run, "--iso 20H7/g6 --pin 'low-carbon steel' --hole '1.5 GPa, 0.4' --load 20")
    assert "peak pressure, MPa" in out
    assert "the yield stresses are not given" in out
    assert "factor" not in out


def test_a_material_by_numbers_has_a_yield_stress(run):
    line = "--material '207 GPa, 0.3, 350 MPa, 12e-6/K' --Ri 10 --radial-clearance 0.05"
    out = shown(run, line)
    pair = cc.CylinderPair.internal(10.0, 9.95, cc.Material("", 207e3, 0.3, 350.0))
    assert f"{float(limits.first_yield(pair).load):,.0f} N/mm (von Mises" in out
    line = "--material '207 GPa, .3' --Ri 10 --radial-clearance .05"
    assert "yield stresses are not given" in shown(run, line)


def test_a_layer_keeps_all_numbers_of_its_material(run):
    """Its expansion, its yield stress and its name."""
    line = "--pin 'high-strength steel' --hole bronze --Ri 10 --Rj 9.98 --R-o 20 --load 100"
    names = ("high-strength steel", "bronze", "low-carbon steel")
    steel, bronze, soft = (cc.Material.named(name) for name in names)
    pair = cc.CylinderPair.internal(10.0, 9.98, pin=steel, hole=bronze)
    warm = f"{line} --temperature 80 --rim free --layer"
    by_name = numbers(run, f"{warm} 'low-carbon steel:12'")
    housing = laws.Housing(20.0, layers=[(soft, 12.0)])
    expected = cc.check_joint(pair, 100.0, housing=housing, temperature=80.0, rim="free")
    assert by_name == expected.to_dict()["numbers"]
    assert numbers(run, f"{warm} '200 GPa, 0.3, 250 MPa, 12e-6/K:12'") == by_name
    own = numbers(run, f"{line} --layer '110 GPa, 0.3:15'")["joint"]
    assert own["first_yield_N_per_mm"] is None


# --- size ---------------------------------------------------------------------------------------


def test_a_clearance_is_found_with_and_without_a_housing(run):
    line = "size clearance --material '207 GPa, .3' --Ri 10 --stiffness 2e5 --load 500"
    pair = cc.CylinderPair.from_dR("internal", 0.05, cc.Material("", 207e3, 0.3), R_i=10.0)
    dR = cc.sizing.find("clearance", pair, 500.0, stiffness=2e5)
    last = shown(run, line).splitlines()[-1]
    assert last == (
        f"radial clearance = {dR:.6g} mm ({2 * dR:.6g} mm on the diameter) gives a stiffness of "
        "200000 N/mm² under 500 N/mm"
    )
    law = laws.Conformal(laws.Housing(20.0))
    dR = cc.sizing.find("clearance", pair, 500.0, stiffness=2e5, law=law)
    assert answer(run, f"{line} --R-o 20")["value"] == dR


def test_a_size_of_a_fit_serves_all_of_its_pairs(run):
    """The numbers for the middle of the fit, not those for a clearance of 1 mm."""
    line = "--material bronze --iso 20H7/g6"
    modulus = answer(run, f"size modulus {line} --stiffness 1e5 --load 300")
    assert modulus["values"]["middle"] == pytest.approx(113_928, rel=1e-5)
    assert modulus["value"] == max(modulus["values"].values())
    length = answer(run, f"size length {line} --penetration 3 --load 3000")
    assert length == answer(run, f"size length {line} --penetration '0.003 mm' --load 3000")
    assert length["values"]["middle"] == pytest.approx(15.9, rel=1e-3)
    assert length["value"] == length["values"]["loosest"]


# --- what is refused ----------------------------------------------------------------------------

BOTH = "--material bronze"
PIN = f"{BOTH} --Ri 10 --radial-clearance .05"
REFUSED = [
    f"{PIN} --clamp pulled:60 | check: --R-o: is required",
    f"{BOTH} --R-o 20 --clamp side:60 | '--clamp': 'side:60' is not a clamp; write rim, lug",
    f"{BOTH} --R-o 20 --clamp lug:0.4 | check: --clamp = 0.4: must be at least 0.5",
    "--R-o 20 --layer bronze | '--layer': 'bronze' is not a material with an inner radius",
    f"{PIN} --R-o 9 | check: --R-o = 9.0: must be larger than the hole",
    f"{BOTH} --iso 20H5/n6 | check: --iso = '20H5/n6': leaves no clearance at any pair",
    f"{BOTH} --iso 20H7/g6 --radial-clearance .1 | = 0.1: is given by --iso 20H7/g6",
    f"{BOTH} --iso 8H7/g6 --contact external | --contact = 'external': has no fit (--iso 8H7/g6)",
    f"{BOTH} --iso 20H7 | check: --iso = '20H7': is not an ISO fit",
    "--temperature hot | '--temperature': 'hot' must be one number or two",
    f"{PIN} --rim free | --rim = 'free': is for a temperature, which is missing",
    f"{PIN} --temperature 80 --R-o 20 | check: --rim: is missing: how far",
    f"{BOTH} --Ri 10 --Rj 20 --contact external --temperature 80 | --temperature = (80.0, 80.0): is"
    " for a pin in a hole, and contact is external",
    "--pin PEEK --hole bronze --Ri 10 --Rj 9.9 --temperature 80 | is a polymer",
    f"{BOTH} --hole-diameter 40 | --Rj: is missing: two of --Ri, --Rj and --radial-clearance are",
    f"{BOTH} --contact external --Ri 15 | check: --Rj: is missing; give the radii of both rollers",
    f"{PIN} --depth 5 | check: --depth = 5.0: is for a plane, R_j = inf",
    f"{BOTH} --contact external --Ri 15 --Rj inf --depth .1 | must be at least ten half-widths",
    f"{PIN} --plane flat | --plane = 'flat': must be strain or stress",
    "--pin ceramics --Ri 10 --Rj 9 | check: --hole: is missing; give e.g. --material",
    "--pin PTFE --hole 2e5, | '--hole': '2e5,' is not a material; write its",
    "--pin PTFE --hole 210,.3 | '--hole': '210,.3': a bare number is in MPa; did you",
    "--pin ceramics --hole soap | --hole = 'soap': is not in the tables of materials; choose",
    f"{BOTH} --pin bronze --Ri 10 --Rj 9 | --material: is of both bodies, and --pin is of one",
    f"{BOTH} {PIN} | --material: is given more than once; for a pin in a hole give --pin and",
    f"{BOTH} --hole-diameter 20 --Ri 10 | --hole-diameter: says the same as --Ri",
    f"{PIN} --Rj 9 | check: --radial-clearance = 0.05: follows from the radii",
    "--pin PTFE --hole PTFE --contact external | has no pin and no hole; leave out --pin",
    "--material '207 GPa, 30' --Ri 10 --Rj 9.9 | --material = 30.0: Poisson's ratio must lie in",
    f"{BOTH} --Ri 10 --radial-clearance -1 | radial-clearance = -1.0: must be positive",
    f"{BOTH} --Ri 50 --Rj 50 | --Rj: leaves no clearance, and the laws need one; give the least",
    f"{BOTH} --Ri 10 --radial-clearance 0 | = 0.0: leaves no clearance",
    f"{BOTH} --Ri 60 --Rj -20 | --Rj = -20.0: must be positive; a concave surface is the hole of",
    "--contact sideways | must be 'internal' or 'external'",
    f"{PIN} --load many | --load = 'many': is not a load",
    f"{PIN} --load 6kN | no single axial length is known; give --length, or the load in N/mm",
    "--material 207e9,.3 | '--material': '207e9,.3': is beyond any material",
    "size R | size: WHAT = 'R': must be clearance, modulus or length",
    f"size clearance {BOTH} --Ri 10 | --stiffness: is missing; give one of --stiffness, --penetra",
    f"size clearance {BOTH} --Ri 10 --peak 1 --factor 2 | --factor: is given beside --peak",
    f"size clearance {PIN} --peak 9 | --radial-clearance = 0.05: is what is sought (size",
    f"size clearance {BOTH} --peak 9 --pin-diameter 20 | --pin-diameter = 20.0: is what is sought",
    f"{BOTH} --Ri 9 --pin-diameter -20 | check: --pin-diameter = -20.0: must be positive; give it",
    f"{BOTH} --hole-diameter 20 --pin-diameter 21 | = 21.0: must be smaller than the hole (--hole-",
    f"size clearance {BOTH} --peak 9 --iso 8H7/g6 | --iso = '8H7/g6': gives the clearance, which",
    f"size length {PIN} --length 5 --peak 9 | --length = 5.0: is what is sought (size length)",
    f"size clearance {BOTH} --Ri 10 --stiffness 1e9 | --stiffness = 1000000000.0: is met by no cl",
    f"size length {BOTH} --contact external --Ri 15 --Rj inf --penetration 3 | --penetration = '3"
    " µm': is not defined for a plane of unknown depth",
    "size modulus --material '2 GPa,.4' --Ri 10 --Rj 9 --factor 2 | --factor: is not known for b",
]


@pytest.mark.parametrize("case", REFUSED)
def test_what_one_may_mistake_is_refused_in_one_line(run, case):
    options, _, message = case.partition(" | ")
    words = shlex.split(options)
    code, out, err = run(*(words if words[0] == "size" else ["check", *words]))
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert message in err


STEEL = "--Ri 10 --radial-clearance 0.05"


def test_a_modulus_is_in_mpa_or_has_a_unit(run):
    asked = [
        shown(run, f"--material '{E}, 0.3' {STEEL}") for E in ("200e3", "200 GPa", "200000 MPa")
    ]
    assert asked[0] == asked[1] == asked[2] != shown(run, f"--material '207 GPa, 0.3' {STEEL}")


def test_a_load_above_first_yield_is_warned_of_and_a_smaller_one_is_not(run):
    line = "check --pin 'low-carbon steel' --hole 'aluminium alloy' --Ri 10 --Rj 9.99 --load"
    code, out, err = run(*shlex.split(f"{line} 9000"))
    assert (code, "warning" in out) == (0, False)
    assert err.startswith("warning: the load, 9,000 N/mm, is above first yield at ")
    assert run(*shlex.split(f"{line} 900"))[2] == ""


def test_a_pair_may_be_given_in_several_ways(run, tmp_path, monkeypatch):
    own = tmp_path / "own.csv"
    own.write_text("name;E_GPa;nu\npewter;102,5;0,34\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    line = f"--pin Pewter --hole pewter --materials {own}"
    by_name = shown(run, f"{line} --hole-diameter 20 --pin-diameter 19.9")
    for radii in ("--Ri 10 --Rj 9.95", STEEL, "--Rj 9.95 --radial-clearance 50um"):
        text = shown(run, f"--material '102.5 GPa, 0.34' {radii}")
        assert text.replace("102.5 GPa", "pewter") == by_name
    (tmp_path / "datasets").mkdir()
    own.rename(tmp_path / "datasets/materials.csv")
    assert shown(run, f"--material pewter {STEEL}") == by_name


def test_lengths_and_total_loads_may_have_units(run):
    line = "--material bronze --Ri 10"
    plain = shown(run, f"{line} --radial-clearance 0.04 --length 15 --load 400")
    for length, load in (("'0.015 m'", "'6 kN'"), ("0.015m", "6kN"), ("15", "6000N")):
        units = f"--radial-clearance '40 µm' --length {length} --load {load}"
        assert shown(run, f"{line} {units}") == plain
    for wrong, why in (
        ("--radial-clearance '40 um/mm'", "'40 um/mm' is not a length"),
        ("--radial-clearance 0.04 --load '6 km'", "is not a load with its unit"),
    ):
        code, out, err = run("check", *shlex.split(f"{line} {wrong}"))
        assert (code, out, err.count("\n")) == (2, "", 1)
        assert why in err


@pytest.mark.parametrize(
    ("options", "warning"),
    [
        ("--hole-diameter 20 --Rj 5", "the radial clearance over the hole's radius is"),
        ("--Ri 10 --radial-clearance 0.00005", "a diameter, or the clearance in metres?"),
        (f"{STEEL} --length 0.15", "the axial length over the radius of the hole is 0.015"),
        ("--Ri 10 --Rj 9.5", ""),
        ("--contact external --Ri 3 --Rj 300", ""),
    ],
)
def test_lengths_that_can_hardly_be_meant_are_warned_of(run, options, warning):
    code, _, err = run("check", "--load", "1e-3", "--material", "bronze", *shlex.split(options))
    assert code == 0
    assert warning in err
    assert bool(err) == bool(warning)
