"""Tables of joints: each row is the joint of its own, whichever way it is answered."""

import numpy as np
import pandas as pd
import pytest

import cylcontact as cc
from cylcontact import InputError
from cylcontact.joint.answer import NUMBERS
from cylcontact.joint.tables import check_table
from tests.support.programs import require_package

BRONZE = cc.Material.named("bronze")
STEEL = cc.Material.named("high-strength steel")


def plain(number=14, seed=3):
    """Pins in plates and rollers of two materials, as columns."""
    draw = np.random.default_rng(seed)
    names = np.array(["bronze", "high-strength steel", "207 GPa, 0.3"])
    return pd.DataFrame(
        {
            "R_i_mm": draw.uniform(5, 30, number),
            "radial_clearance_um": draw.uniform(5, 100, number),
            "load_kN": draw.uniform(1, 10, number),
            "length_mm": draw.uniform(5, 40, number),
            "pin": names[draw.integers(0, 3, number)],
            "hole": names[draw.integers(0, 3, number)],
            "plane": np.array(["strain", "stress"])[draw.integers(0, 2, number)],
        }
    )


def by_hand(row):
    """The answer for a row of `plain`."""
    numbers = cc.Material("", 207e3, 0.3)
    bodies = {"bronze": BRONZE, "high-strength steel": STEEL, "207 GPa, 0.3": numbers}
    pair = cc.CylinderPair.internal(
        row.R_i_mm, row.R_i_mm - 1e-3 * row.radial_clearance_um, length=row.length_mm,
        pin=bodies[row.pin], hole=bodies[row.hole], plane=row.plane,
    )  # fmt: skip
    return cc.check_joint(pair, 1e3 * row.load_kN / row.length_mm).numbers


def test_many_rows_are_those_alone():
    frame = plain()
    table = check_table(frame).table
    assert (table["error"] == "").all()
    for row in table.itertuples():
        expected = by_hand(row)
        for name in NUMBERS:
            value, wanted = getattr(row, name), getattr(expected, name)
            assert value == pytest.approx(
                wanted, rel=2e-4 if "yield" in name else 1e-8, nan_ok=True
            )


def test_a_table_is_read_in_its_units_from_every_kind_of_file(tmp_path):
    require_package("pyarrow")
    frame = plain(6)
    wanted = check_table(frame).table[list(NUMBERS)]
    own = frame.rename(columns={"R_i_mm": "R i [m]", "load_kN": "Load (N)"})
    own["R i [m]"] /= 1e3
    own["Load (N)"] *= 1e3
    paths = [tmp_path / f"joints.{suffix}" for suffix in ("csv", "xlsx", "parquet", "txt")]
    own.to_csv(paths[0], index=False)
    own.to_excel(paths[1], index=False)
    own.to_parquet(paths[2])
    own.to_csv(paths[3], index=False, sep=";", decimal=",")
    for path in paths:
        found = check_table(path).table
        assert list(found)[: len(own.columns)] == list(own)
        np.testing.assert_allclose(found[list(NUMBERS)].astype(float), wanted, rtol=1e-9)


def test_a_plane_in_a_text_has_a_pressure_and_needs_a_depth(tmp_path):
    path = tmp_path / "planes.csv"
    head = "contact,R_i_mm,R_j_mm,material,load_N_per_mm,depth_mm\n"
    path.write_text(f"{head}external,15,inf,bronze,100,\nexternal,15,inf,bronze,100,50\n")
    table = check_table(path).table
    bronze = cc.Material.named("bronze")
    pair = cc.CylinderPair.external(15.0, np.inf, bronze)
    depth = 1e3 * cc.laws.Johnson(datum=50.0).penetration(100.0, pair)
    np.testing.assert_allclose(table["penetration_um"], [np.nan, depth], rtol=1e-9)
    np.testing.assert_allclose(table["peak_pressure_MPa"], cc.limits.hertz_stress(100.0, pair))


def test_a_row_with_a_fit_has_the_worst_of_its_band():
    frame = pd.DataFrame({"iso": ["20H7/g6"], "material": "bronze", "load_N_per_mm": 200.0})
    table = check_table(frame).table
    fit = cc.check_joint(cc.CylinderPair.internal(10.0, 9.95, BRONZE), 200.0, iso="20H7/g6")
    peaks = [fit.band[name].peak_pressure_MPa for name in ("tightest", "loosest")]
    assert table["worst_peak_pressure_MPa"][0] == max(peaks)
    assert (table["worst"][0], table["worst_factor_to_yield"][0]) == (
        fit.worst[0], fit.worst[1].factor_to_yield
    )  # fmt: skip


def test_a_row_without_an_answer_says_why_and_the_others_are_answered():
    frame = plain(5)
    frame.loc[1, "radial_clearance_um"] = -3.0
    frame.loc[2, "pin"] = "soap"
    frame["load_kN"] = frame["load_kN"].astype(object)
    frame.loc[3, "load_kN"] = "much"
    check = check_table(frame)
    assert (check.answered, check.refused) == (2, 3)
    errors = check.table["error"]
    assert "radial_clearance = -0.003: must be positive" in errors[1]
    assert "pin = 'soap': is not in the tables of materials" in errors[2]
    assert "is not a number" in errors[3]
    assert check.table.loc[[1, 2, 3], "penetration_um"].isna().all()
    assert "2 of 5 joints answered; 3 refused, first: row 2: radial_clearance" in str(check)


def test_the_command_names_the_first_row_without_an_answer_and_exits_with_1(run, tmp_path):
    path, out = tmp_path / "joints.csv", tmp_path / "answers.csv"
    plain(4).assign(pin=["bronze", "soap", "salt", "bronze"]).to_csv(path, index=False)
    code, said, err = run("check", path, "-o", out)
    assert (code, said) == (1, f"{out}: 2 of 4 joints answered\n")
    assert err.startswith("cylcontact: 2 of 4 joints refused; first: line 3: pin = 'soap': is not")
    assert pd.read_csv(out)["error"].isna().tolist() == [True, False, False, True]


def test_what_all_rows_have_in_common_may_be_an_option(run, tmp_path):
    frame = plain(4)[["R_i_mm", "radial_clearance_um"]]
    path, out = tmp_path / "joints.csv", tmp_path / "answers.csv"
    frame.to_csv(path, index=False)
    options = ("--material", "bronze", "--load", "5kN", "--length", 12, "-o", out)
    code, said, _ = run("check", path, *options)
    assert (code, said) == (0, f"{out}: 4 of 4 joints answered\n")
    frame = frame.assign(material="bronze", load_kN=5.0, length_mm=12.0)
    found, wanted = pd.read_csv(out), check_table(frame).table
    np.testing.assert_allclose(found[list(NUMBERS)], wanted[list(NUMBERS)].astype(float), rtol=1e-9)
    code, _, err = run("check", path, *options, "--Ri", 4)
    assert (code, err.count("\n")) == (2, 1)
    assert "R_i = 4.0: is a column of" in err


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"R_i_mm": [1.0], "weight": [2.0]}, "columns: weight is not known; name columns load,"),
        ({"R_i": [1.0], "R_j_mm": [2.0]}, "columns = 'R_i': has no unit; name it e.g. R_i_"),
        ({"R_i_mm": [1.0], "R_i_um": [1.0]}, "gives the same quantity as R_i_mm"),
    ],
)
def test_columns_that_are_not_understood_are_refused(columns, message):
    with pytest.raises(InputError) as caught:
        check_table(pd.DataFrame(columns))
    assert message in str(caught.value)


@pytest.mark.parametrize("more", [(), ("-o", "joint.pdf")])
def test_what_is_wrong_with_the_file_goes_before_what_is_wrong_with_the_output(run, tmp_path, more):
    (tmp_path / "page.html").write_text("<html></html>")
    code, _, err = run("check", tmp_path / "page.html", *more)
    assert (code, "is a web page (HTML)" in err) == (2, True)


def test_a_label_of_a_joint_is_carried_along():
    frame = plain(2)
    found = check_table(frame.assign(name=["first", "second"])).table
    assert found["name"].tolist() == ["first", "second"]
    pd.testing.assert_frame_equal(found.drop(columns="name"), check_table(frame).table)


def test_what_a_file_is_decides_and_what_is_none_names_all_three(run):
    code, _, err = run("check", "datasets/slider_crank.toml")
    assert (code, err.count("\n")) == (2, 1)
    assert "is no joint; give a table of joints, the file of a joint" in err
    code, out, _ = run("check", "datasets/joint.toml", "--load", "5kN", "--json")
    joint = cc.joint.read_joint("datasets/joint.toml")
    assert code == 0
    check = cc.check_joint(joint.pair, 5000 / joint.pair.length)
    assert f'"penetration_um": {check.numbers.penetration_um!r}' in out
    text = run("check", "datasets/joint.toml", "--load", "5kN")[1]
    assert text.startswith("207 GPa pin (R_j = 9.95 mm) in bronze hole (R_i = 10 mm)")


def test_a_map_shows_each_joint_that_has_an_answer():
    frame = plain(30)
    frame.loc[2, "radial_clearance_um"] = -1.0
    axes = check_table(frame).plot("R_i_mm", "load_kN", "peak_pressure_MPa")
    assert len(axes.collections[0].get_offsets()) == 29
    with pytest.raises(InputError, match="is not a column of numbers"):
        check_table(frame).plot("R_i_mm", "pin", "peak_pressure_MPa")


def test_rows_of_one_shape_of_housing_share_its_search_and_are_answered_in_processes(monkeypatch):
    sizes = np.array([10.0, 10.0, 20.0, 10.0])
    frame = pd.DataFrame({
        "R_i_mm": sizes, "radial_clearance_um": sizes * [1.0, 5.0, 5.0, 2.0], "R_o_mm": 2 * sizes,
        "layer": [f"bronze:{1.2 * R:g}; low-carbon steel:{1.5 * R:g}" for R in sizes],
        "clamp": "lug", "material": "high-strength steel", "load_N_per_mm": 200.0,
    })  # fmt: skip
    alone = [check_table(frame[k : k + 1]).table for k in range(4)]
    monkeypatch.setattr("cylcontact.joint.tables._MANY", 2)
    together = check_table(frame).table
    assert (together["error"] == "").all()
    for name in NUMBERS:
        wanted = np.concatenate([each[name] for each in alone])
        np.testing.assert_allclose(together[name], wanted, rtol=3e-6)
