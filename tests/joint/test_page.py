"""The page of a joint: the same numbers as the answer, the same file for the same joint."""

import re
from itertools import islice

import pytest

import cylcontact as cc
from cylcontact import InputError, laws
from cylcontact.joint import bush, clevis
from cylcontact.joint.check_page import inputs, page_of
from cylcontact.joint.page import _SMALLER, _Sheet, _written, write_page

STEEL, BRONZE = map(cc.Material.named, ("high-strength steel", "bronze"))
PAIR = cc.CylinderPair.internal(10.0, 9.95, pin=STEEL, hole=BRONZE, length=12.0)
EYE_26 = laws.Housing(26.0, laws.Sector.lug())
EYE = laws.Housing(20.0, laws.Sector.lug())


def test_a_page_has_inputs_answer_warning_and_what_is_not_included(tmp_path):
    check = cc.check_joint(PAIR, 1500.0, iso="20H7/g6", housing=EYE, temperature=60.0, rim="free")
    html = check.save(tmp_path / "joint.html").read_text(encoding="utf-8")
    for row in check.table.loc[["first_yield_N_per_mm", "total_stiffness_N_per_mm"]].to_numpy():
        assert all(f"<td>{float(f'{value:.4g}'):,.10g}</td>" in html for value in row)
    for text in ("table (assumed)", "ISO 286-1", "bending and tilt of the pin", *check.warnings):
        assert text in html
    assert html.count("<svg") == 2
    assert re.search(rf"cylcontact {cc.__version__}, inputs [0-9a-f]{{16}}<", html)
    again = check.save(tmp_path / "again.html").read_text(encoding="utf-8")
    assert again == html


def pages():
    """A check of each kind, and crowded ones."""
    flat = cc.CylinderPair.external(15.0, float("inf"), BRONZE)
    yield page_of(cc.check_joint(flat, 50.0))
    layers = laws.Housing(20.0, laws.Sector.lug(), [(STEEL, 13.0), (BRONZE, 17.0)])
    given = {"iso": "20H7/g6", "housing": layers, "temperature": (80.0, 60.0), "rim": "free"}
    yield page_of(cc.check_joint(PAIR, 2000.0, **given))
    soft = cc.Material("soft", 1e5, 0.3)  # its yield is not sought
    wall = cc.joint.Bush(soft, seat="26H7/r6", wall=(2.98, 3.01))
    yield bush._page(cc.joint.check_bush(wall, soft, "20f7", soft, EYE_26, 500.0, length=20.0))
    ring = laws.Housing(15.0, laws.Sector.lug(), [(STEEL, 10.0)])
    eye = cc.joint.Plate(20.0, BRONZE, (15.02, 15.05), ring)
    cheek = cc.joint.Plate(10.0, STEEL, 15.02)
    soft = cc.joint.Clevis(cc.Material.named("PEEK"), 15.0, eye, cheek, gap=20.0)
    yield clevis._page(cc.joint.check_clevis(soft, 10e3))


@pytest.mark.parametrize("count", [1, pytest.param(4, marks=pytest.mark.slow)])
def test_a_page_of_any_joint_is_one_sheet_with_room_for_all(tmp_path, count):
    for each in islice(pages(), count):
        pdf = write_page(each, tmp_path / "joint.pdf").read_bytes()
        assert pdf.startswith(b"%PDF")
        assert pdf.count(b"/Type /Page ") == 1
        assert b"CreationDate" not in pdf
        assert any(_written(each, _Sheet(smaller)) for smaller in _SMALLER)
    assert write_page(each, tmp_path / "joint.png").read_bytes().startswith(b"\x89PNG")


def test_the_source_of_a_material_is_the_table_only_for_its_numbers():
    own = cc.Material("bronze", 111e3, 0.34)
    pair = cc.CylinderPair.internal(10.0, 9.95, pin=STEEL, hole=own)
    rows = {name: source for name, _, source in inputs(cc.check_joint(pair, 100.0))}
    assert (rows["hole"], rows["pin"]) == ("given", "table (assumed)")


def test_a_page_of_another_kind_is_refused(tmp_path):
    with pytest.raises(InputError):
        cc.check_joint(PAIR, 100.0).save(tmp_path / "joint.docx")
