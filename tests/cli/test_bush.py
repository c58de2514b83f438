"""A bush in the command `check`: on a line, in a file, and what is refused beside it."""

import json
import shlex
import tomllib
from pathlib import Path

import pytest

from cylcontact import Material
from cylcontact.joint.bush import Bush, check_bush
from cylcontact.laws import Housing, Sector

ROOT = Path(__file__).resolve().parents[2]
BODIES = '--pin "high-strength steel" --hole "low-carbon steel"'
AROUND = f"check {BODIES} --R-o 26 --clamp lug"
LINE = f'{AROUND} --bush "bronze, 20E6, 26H7/s6" --pin-diameter 20f7'
FULL = f'{LINE} --plane stress --temperature 80 --load "10 kN" --length 20'


@pytest.fixture(scope="module")
def answer():
    bronze, steel, hard = map(Material.named, ("bronze", "low-carbon steel", "high-strength steel"))
    return check_bush(
        Bush(bronze, "26H7/s6", "20E6"), hard, "20f7", steel, Housing(26.0, Sector.lug()), 500.0,
        length=20.0, plane="stress", temperature=80.0,
    )  # fmt: skip


@pytest.mark.parametrize(
    "line",
    [f"check {ROOT / 'datasets/bush.toml'}", pytest.param(FULL, marks=pytest.mark.slow)],
    ids=["file", "line"],
)
def test_the_line_the_file_and_python_have_one_answer(run, answer, line):
    code, out, err = run(*shlex.split(line))
    assert code == 0
    assert out == f"{answer}\n"
    assert err == "".join(f"warning: {each}\n" for each in answer.warnings)


def test_numbers_in_the_place_of_names_and_classes(run):
    bush = "110 GPa, 0.34, 220 MPa, 18e-6/K, wall 3, 26/26.03, wrapped"
    code, out, err = run(*shlex.split(f'{AROUND} --bush "{bush}" --Rj 9.97 --json'))
    data = json.loads(out)
    assert code == 0
    assert data["numbers"]["joint"]["bore_mm"] == pytest.approx(20.0)
    assert data["numbers"]["joint"]["clearance_um"] == pytest.approx(30.0)
    assert data["not_included"].startswith("wear")
    assert "a wrapped bush yields" in err


@pytest.mark.slow
def test_limits_in_the_place_of_classes(run):
    limits = "wall 2.98:3.01, 26:26.021/26.035:26.048"
    code, out, _ = run(*shlex.split(f'{AROUND} --bush "bronze, {limits}" --Rj 9.97 --json'))
    assert code == 0
    assert list(json.loads(out)["numbers"])[-2:] == ["tightest seat", "loosest seat"]


REFUSED = {
    f'{AROUND} --bush "bronze, 20E6, 26H7/s6"': "--pin-diameter: is missing",
    f"{LINE} --Rj 9.9": "--pin-diameter: says the same as --Rj",
    f"{LINE} --Ri 10": "--Ri: is given by --bush",
    f"{LINE} --radial-clearance 0.02": "--radial-clearance: is given by --bush",
    f"{LINE} --layer bronze:14": "--layer: is for a joint without --bush",
    f"{LINE} --iso 20H7/f7": "--iso: is for a joint without --bush",
    f"{LINE} --depth 5": "--depth: is for a joint without --bush",
    f"{LINE} --contact external": "--bush: is for a pin in a hole, and --contact is external",
    f"{LINE} --load -3": "--load = -3.0: must be positive",
    LINE.replace("--clamp lug", "--clamp rim"): "--rim: is missing for a rim",
    LINE.replace("--R-o 26 --clamp lug", ""): "--R-o: is missing beside --bush",
    LINE.replace("--R-o 26", "--R-o 13"): "--R-o = 13.0: must have its rim outside the seat",
    LINE.replace("s6", "g6"): "--bush = '26H7/g6': has no interference",
    LINE.replace("bronze", "bronce"): "--bush = 'bronce': is not in the tables",
    LINE.replace(", 26H7/s6", ""): "is not a bush; write MATERIAL, BORE, HOLE/BUSH",
    f"check {BODIES} --Ri 10 --pin-diameter 20f7": "--pin-diameter = '20f7': is a class",
    f"check {ROOT / 'datasets/bush.toml'} --load 3": "--load: belongs in the file",
    f"check {ROOT / 'datasets/bush.toml'} --bush 'bronze, 20E6, 26H7/s6'": "--bush: belongs in the",
}


@pytest.mark.parametrize("line", REFUSED, ids=REFUSED.values())
def test_what_is_refused_beside_a_bush(run, line):
    code, out, err = run(*shlex.split(line))
    assert (code, out) == (2, "")
    assert REFUSED[line] in err


CHANGES = {
    'seat = "26H7/s6"': ('seat = "26H7"', "bush: seat = '26H7': is not an ISO fit"),
    'bore = "20E6"': ("depth = 3", "bush.depth"),
    'diameter = "20f7"': ('diameter = "20z7"', "pin = '20z7': has a pin z"),
    "R_o = 26.0": ("R_o = 26.0\nlayers = [{R_i = 20.0, material = 'bronze'}]", "are beside a bush"),
    'load = "10 kN"': ("load = 0.0", "load = 0.0: must be positive"),
}


@pytest.mark.parametrize("old", CHANGES)
def test_what_a_file_is_refused_for(run, tmp_path, old):
    new, message = CHANGES[old]
    text = (ROOT / "datasets/bush.toml").read_text("utf-8").replace(old, new)
    assert tomllib.loads(text)
    (tmp_path / "bush.toml").write_text(text, "utf-8")
    code, _, err = run("check", str(tmp_path / "bush.toml"))
    assert code == 2
    assert message in err
