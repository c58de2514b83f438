"""A pin that bends: against elements in three dimensions, relations, the answer and its file."""

import json
import shlex
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from benchmarks.clevis import ClevisOfElements, Joint
from cylcontact import InputError, Material
from cylcontact.joint.clevis import EDGES, check_clevis
from cylcontact.joint.clevis_beam import Clevis, Plate
from cylcontact.joint.tables import check_table
from cylcontact.laws import Housing, Sector

ROOT = Path(__file__).resolve().parents[2]
STEEL = Material("steel", 207e3, 0.3, yield_stress=900.0)
LUG = Housing(15.0, Sector(110, "pulled"))


def clevis(d=15.0, housing=None, **changes):
    plates = Plate(20.0, STEEL, d + 0.02, housing), Plate(10.0, STEEL, d + 0.02, housing)
    return Clevis(**{"pin": STEEL, "diameter": d, "eye": plates[0], "cheek": plates[1], "gap": 1.0}
                  | changes)  # fmt: skip


def numbers(one, force=10e3):
    return check_clevis(one, force).band["joint"]


def errors(found, known):
    """The differences from known numbers, relative."""
    own = {
        key: getattr(found, key) for key in ("movement_um", "moment_Nmm", "shear_plane_moment_Nmm")
    }
    for name in ("eye", "cheek"):
        for share, value in zip(EDGES, getattr(found, f"{name}_ratio"), strict=True):
            own[f"{name}_ratio_{share:g}R"] = value
    return {key: own[key] / known[key] - 1 for key in own}


# Limits of a fair comparison, relative.
LIMITS = {"movement_um": 0.03, "moment_Nmm": 0.05, "shear_plane_moment_Nmm": 0.05}
LIMITS |= {f"{name}_ratio_0.1R": 0.08 for name in ("eye", "cheek")}
LIMITS |= {f"{name}_ratio_0.25R": 0.05 for name in ("eye", "cheek")}
LUG_LIMITS = LIMITS | {"moment_Nmm": 0.08, "shear_plane_moment_Nmm": 0.08} | {
    key: 0.15 for key in LIMITS if "ratio" in key
}  # fmt: skip
TABLE = pd.read_csv(ROOT / "datasets/clevis.csv")


@pytest.mark.parametrize("row", range(len(TABLE)))
def test_the_beam_is_near_elements_in_three_dimensions(row):
    known = TABLE.iloc[row]
    lug = known["program"] == "Cartesian"
    found = errors(numbers(clevis(known["d_mm"], LUG if lug else None)), known)
    for key, limit in (LUG_LIMITS if lug else LIMITS).items():
        assert abs(found[key]) < limit, (key, found[key])


FRESH = {
    "slender": (Joint(6.0, 30.0, 12.0, 2.0, 0.02), 15e3, 0.08),
    "bronze plates": (Joint(12.5, 18.0, 14.0, 0.5, 0.03, E_plates=110e3), 40e3, 0.13),
    "aluminium plates": (Joint(8.0, 25.0, 10.0, 1.0, 0.05, E_plates=70e3), 20e3, 0.11),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", FRESH)
def test_joints_that_no_number_was_fitted_to_are_near_fresh_elements(name):
    joint, force, edge = FRESH[name]
    plate, hole = Material("plate", joint.E_plates, 0.3), 2 * (joint.R + joint.clearance)
    eye, cheek = (Plate(t, plate, hole) for t in (joint.eye, joint.cheek))
    own = Clevis(STEEL, 2 * joint.R, eye, cheek, joint.gap)
    found = errors(numbers(own, force), ClevisOfElements(joint).solved(force))
    for key, limit in LIMITS.items():
        wide = edge if key.endswith("_0.1R") else 0.07 if key.endswith("_0.25R") else limit
        assert abs(found[key]) < wide, (key, found[key])


@pytest.mark.slow
def test_the_elements_are_those_of_another_program():
    """CalculiX, of the joint with d = 15 mm; the table has the finer mesh."""
    coarse = ClevisOfElements(Joint(7.5, 20.0, 10.0, 1.0, 0.01)).solved(10e3)
    other = TABLE[TABLE["program"] == "CalculiX"].iloc[0]
    fine = TABLE[(TABLE["program"] == "harmonics") & (TABLE["d_mm"] == 15)].iloc[0]
    for key, value in coarse.items():
        limit = 0.01 if "ratio" in key else 0.002
        assert value == pytest.approx(other[key], rel=limit)
        assert value == pytest.approx(fine[key], rel=limit)


# --- relations ----------------------------------------------------------------------------------


def test_forces_balance_and_the_moment_ends_at_zero():
    check = check_clevis(clevis(), 10e3)
    state = check.states["joint"]
    force = state.line_load * state.weights
    assert force[state.in_eye].sum() == pytest.approx(5e3, rel=1e-8)
    assert force[~state.in_eye].sum() == pytest.approx(5e3, rel=1e-8)
    assert (state.line_load >= 0).all()
    assert state.moment[0] == pytest.approx(check.band["joint"].moment_Nmm)
    assert abs(state.moment[-1]) < 1e-6 * state.moment[0]


def test_a_clevis_of_twice_the_size_has_the_same_shape():
    """Lengths, clearances and, for the same stress, forces: twice, twice, four times."""
    small, large = clevis(), Clevis(
        STEEL, 30.0, Plate(40.0, STEEL, 30.04), Plate(20.0, STEEL, 30.04), 2.0
    )  # fmt: skip
    one, two = numbers(small), numbers(large, 40e3)
    assert two.movement_um == pytest.approx(2 * one.movement_um, rel=1e-6)
    assert two.moment_Nmm == pytest.approx(8 * one.moment_Nmm, rel=1e-6)
    assert two.bending_stress_MPa == pytest.approx(one.bending_stress_MPa, rel=1e-6)
    assert two.eye_ratio == pytest.approx(one.eye_ratio, rel=1e-6)


def test_the_stiffness_is_the_slope_of_force_over_movement():
    low, high = (numbers(clevis(), f) for f in (9.9e3, 10.1e3))
    slope = 200 / (1e-3 * (high.movement_um - low.movement_um))
    assert numbers(clevis()).stiffness_N_per_mm == pytest.approx(slope, rel=0.01)


def test_a_rigid_pin_carries_what_slices_carry():
    """A thick short pin: the movement is that of two clearances and two plane laws."""
    stout = Clevis(STEEL, 60.0, Plate(8.0, STEEL, 60.1), Plate(4.0, STEEL, 60.1), 0.2)
    check = check_clevis(stout, 20e3)
    found = check.band["joint"]
    state = check.states["joint"]
    spread = np.ptp(state.line_load[state.in_eye]) / state.line_load[state.in_eye].mean()
    assert found.elastic_um > 0
    assert np.isnan(found.bending_stress_MPa)
    assert "shorter than its diameter" in str(check)
    assert spread < 1.0


def test_a_softer_housing_moves_more_and_a_longer_pin_carries_as_much():
    plain, lug = numbers(clevis()), numbers(clevis(housing=LUG))
    assert lug.elastic_um > 1.5 * plain.elastic_um
    longer = numbers(clevis(beyond=5.0))
    assert longer.moment_Nmm == pytest.approx(plain.moment_Nmm, rel=0.01)


def test_a_bush_is_the_ring_around_the_hole():
    bronze = Material("bronze", 110e3, 0.34, 220.0)
    shape = Housing(30.0, Sector.lug(), [(STEEL, 10.0)], seat="sliding")
    bushed = clevis(eye=Plate(20.0, bronze, 15.02, shape))
    assert numbers(bushed).elastic_um > numbers(clevis()).elastic_um
    bonded = clevis(eye=Plate(20.0, bronze, 15.02, Housing(30.0, Sector.lug(), [(STEEL, 10.0)])))
    assert numbers(bushed).elastic_um > numbers(bonded).elastic_um


# --- the answer ---------------------------------------------------------------------------------


def test_designers_rules_beside_the_moment():
    check = check_clevis(clevis(), 10e3)
    uniform = 5e3 * (5.0 + 1.0 + 5.0)
    assert check.rules["uniform bearing"] == uniform
    assert check.rules["forces in the middles, F·L/4"] == 80e3
    text = str(check)
    assert f"{uniform / check.needed_moment:.2f} of it: safe" in text
    stout = check_clevis(clevis(20.0), 10e3)
    assert stout.rules["built in, F·L/8"] < stout.needed_moment
    assert "of it: UNSAFE" in str(stout)
    assert "no factor: a sharp edge has no yield load" in text
    assert check.factor == pytest.approx(900 / check.band["joint"].bending_stress_MPa)
    lug = check_clevis(clevis(housing=LUG), 10e3)
    assert lug.factor == pytest.approx(900 / 1.1 / lug.band["joint"].bending_stress_MPa)


def test_classes_give_a_band_and_json_has_its_numbers():
    holes = Plate(20.0, STEEL, "20H8"), Plate(10.0, STEEL, "20H8")
    check = check_clevis(clevis(diameter="20f7", eye=holes[0], cheek=holes[1]), 10e3)
    assert list(check.band) == ["tightest", "middle", "loosest"]
    clearances = [each.eye_clearance_um for each in check.band.values()]
    assert clearances == pytest.approx([10.0, 23.5, 37.0])
    alone = numbers(Clevis(STEEL, 19.97 - 0.0005, Plate(20.0, STEEL, 20.0165),
                           Plate(10.0, STEEL, 20.0165), 1.0))  # fmt: skip
    assert check.band["middle"].moment_Nmm == pytest.approx(alone.moment_Nmm, rel=1e-9)
    data = json.loads(check.to_json())
    for name, column in data["numbers"].items():
        for key, value in column.items():
            assert value == check.table.loc[key, name]
    assert "<table" in check._repr_html_()


def test_what_is_outside_of_the_comparison_is_warned_of():
    peek = Material("PEEK", 3.6e3, 0.38)
    soft = clevis(eye=Plate(20.0, peek, 15.02), gap=20.0)
    words = check_clevis(soft, 1e3).warnings
    assert any("the eye is of PEEK" in each for each in words)
    assert any("the gap is 2.7 R" in each for each in words)
    assert check_clevis(clevis(), 10e3).warnings == ()
    ring = Plate(20.0, STEEL, 15.02, Housing(15.0, layers=[(STEEL, 10.0)]))
    assert any(
        "no such joint was compared" in w for w in check_clevis(clevis(eye=ring), 1e3).warnings
    )
    weak = Material("weak", 207e3, 0.3, 50.0)
    assert any("the pin yields" in w for w in check_clevis(clevis(pin=weak), 10e3).warnings)


REFUSED = {
    "gap = 0.0: must be positive": lambda: clevis(gap=0.0),
    "beyond = -1.0: must not be negative": lambda: clevis(beyond=-1.0),
    "eye.hole = 14.0: leaves no clearance": lambda: clevis(eye=Plate(20.0, STEEL, 14.0)),
    "diameter = '20z7': has a pin z": lambda: clevis(diameter="20z7"),
    "force = -1.0: must be positive": lambda: check_clevis(clevis(), -1.0),
    "is given by compliances": lambda: clevis(
        eye=Plate(20.0, STEEL, 15.02, Housing.from_compliances([-0.1, 0.4, -0.05, -1e-5]))
    ),
}


@pytest.mark.parametrize("rule", REFUSED)
def test_what_a_clevis_refuses(rule):
    with pytest.raises(InputError, match=rule):
        REFUSED[rule]()


# --- the file -----------------------------------------------------------------------------------


def test_the_file_gives_the_answer_of_python_and_a_page(run, tmp_path):
    file = ROOT / "datasets/clevis.toml"
    hard, mild = Material.named("high-strength steel"), Material.named("low-carbon steel")
    lug = Housing(40.0, Sector.lug())
    own = Clevis(
        hard, "40f7", Plate(30.0, mild, "40H8", lug), Plate(15.0, mild, "40H8", lug), 1.0, 3.0
    )
    check = check_clevis(own, 60e3)
    page = tmp_path / "clevis.html"
    code, out, err = run("check", str(file), "-o", str(page))
    assert (code, err) == (0, "")
    assert out == f"{check}\n"
    html = page.read_text("utf-8")
    assert html.count("<svg") == 2
    assert "Check of a clevis" in html
    code, out, _ = run("check", str(file), "--json")
    assert json.loads(out) == json.loads(check.to_json())


CHANGES = {
    "gap = 1.0": ("gap = -1.0", "gap = -1.0"),
    "thickness = 30.0": ("thick = 30.0", "eye.thick"),
    'hole = "40H8"': ('hole = "40h8"', "leaves no clearance"),
    'load = "60 kN"': ("load = 0.0", "force = 0.0: must be positive"),
    "[eye]": ("[eyes]", "is not a known key"),
}


@pytest.mark.parametrize("old", CHANGES)
def test_what_a_file_of_a_clevis_is_refused_for(run, tmp_path, old):
    new, message = CHANGES[old]
    text = (ROOT / "datasets/clevis.toml").read_text("utf-8").replace(old, new)
    assert tomllib.loads(text)
    (tmp_path / "clevis.toml").write_text(text, "utf-8")
    code, _, err = run(*shlex.split(f"check {tmp_path / 'clevis.toml'}"))
    assert code == 2
    assert message in err


def test_a_row_of_a_table_of_clevises_is_answered_as_the_clevis_is(run, tmp_path):
    file, out = tmp_path / "clevises.csv", tmp_path / "answers.csv"
    hard, mild = Material.named("high-strength steel"), Material.named("low-carbon steel")
    shapes = [None, Housing(40.0, Sector.lug()), Housing(40.0, layers=[(hard, 24.0)])]
    frame = pd.DataFrame({
        "name": list("abcd"), "pin_diameter": ["40f7"] * 3 + ["41"], "eye_hole": "40H8",
        "eye_R_o_mm": [None, 40, 40, None], "eye_clamp": [None, "lug", "rim", None],
        "eye_layer": [None, None, "high-strength steel:24", None], "cheek_hole_mm": 40.05,
        "eye_thickness_mm": 30, "cheek_thickness_mm": 15, "gap_mm": 1, "load_kN": 60,
    }).assign(eye="low-carbon steel", cheek="low-carbon steel")  # fmt: skip
    frame.to_csv(file, index=False)
    code, _, err = run("check", file, "-o", out, "--pin", "high-strength steel")
    assert (code, err[:49]) == (1, "cylcontact: 1 of 4 joints refused; first: line 5:")
    found = pd.read_csv(out)
    for shape, (_, row) in zip(shapes, found.iterrows(), strict=False):
        eye, cheek = Plate(30.0, mild, "40H8", shape), Plate(15.0, mild, 40.05)
        check = check_clevis(Clevis(hard, "40f7", eye, cheek, 1.0), 60e3)
        for key, value in check.table["middle"].items():
            assert row[key] == pytest.approx(value, rel=1e-9), key
        assert row["needed_moment_Nmm"] == pytest.approx(check.needed_moment, rel=1e-9)
        assert row["lowest_pin_factor"] == pytest.approx(check.factor, rel=1e-9)
    assert "leaves no clearance" in found["error"][3]


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"eye": ["bronze"], "eye_width_mm": [3.0]}, "eye_width_mm is not known in a table of"),
        ({"eye": ["bronze"], "load_kN": [3.0]}, "columns: lacks gap, pin, pin_diameter, eye_hole"),
    ],
)
def test_columns_of_clevises_that_are_not_understood_are_refused(columns, message):
    with pytest.raises(InputError, match=message):
        check_table(pd.DataFrame(columns))
