"""Tables of measurements: every unit, every way to give a pair, every way to go wrong."""

import numpy as np
import pandas as pd
import pytest

from cylcontact import InputError
from cylcontact.datasets.measurements import MeasuredData, measurements_of, read_measured
from cylcontact.fitting.measured import STANDARDISED
from cylcontact.fitting.table_campaign import campaign_of_table
from cylcontact.materials import COLUMNS
from cylcontact.tables import MAX_ROWS
from cylcontact.units import QUANTITIES, column_named
from tests.support.measured_files import USER_LAW, write_table
from tests.support.programs import require_package
from tests.support.spec_files import assert_told

GOOD = {
    "load_N_per_mm": [10.0, 20.0, 40.0],
    "penetration_um": [0.2, 0.4, 0.7],
    "dR_um": [50.0, 50.0, 80.0],
    "E_GPa": [207.0, 207.0, 69.0],
    "nu": [0.3, 0.3, 0.33],
}


def measured(path, contact="internal", constants=None, materials=None, ignored=()):
    return measurements_of(read_measured(path, contact, constants, materials, ignored), str(path))


def without(*names):
    return {name: column for name, column in GOOD.items() if name not in names}


# --- what is read -----------------------------------------------------------------------------


def test_columns_come_out_in_mm_newton_and_megapascal(tmp_path):
    actual = measured(write_table(tmp_path / "t.csv", GOOD))
    assert actual.load == pytest.approx([10, 20, 40])
    assert actual.penetration == pytest.approx([2e-4, 4e-4, 7e-4])
    assert actual.pair.dR == pytest.approx([0.05, 0.05, 0.08])
    assert actual.pair.E_star == pytest.approx(
        [207e3 / 1.82, 207e3 / 1.82, 69e3 / (2 * (1 - 0.33**2))]
    )


@pytest.mark.parametrize(
    ("quantity", "unit", "factor"),
    [(q, u, f) for q, units in QUANTITIES.items() for u, f in units.items() if u],
)
def test_every_unit_says_the_same_thing(tmp_path, quantity, unit, factor):
    # The same physical table, once in mm, N and MPa and once with one column in another unit.
    length = 10.0
    plain = {
        "load_N_per_mm": [10.0, 20.0],
        "penetration_mm": [2e-4, 4e-4],
        "R_i_mm": [10.0, 10.0],
        "R_j_mm": [9.9, 9.8],
        "E_i_MPa": [2e5, 2e5],
        "nu_i": [0.3, 0.3],
        "E_j_MPa": [7e4, 7e4],
        "nu_j": [0.33, 0.33],
        "length_mm": [length, length],
    }
    if quantity == "E":
        plain = {k: v for k, v in plain.items() if k[:2] not in ("E_", "nu")}
        plain |= {"E_MPa": [2e5, 1e5], "nu": [0.3, 0.3]}
    if quantity == "dR":
        del plain["R_i_mm"]
        plain["dR_mm"] = [0.1, 0.2]
    if quantity.endswith("_std"):
        base = {"load_std": "N_per_mm", "penetration_std": "mm"}[quantity]
        plain[f"{quantity}_{base}"] = [0.5, 0.25]
    if quantity == "time":
        plain["time_s"] = [0.0, 90.0]
    key = next(k for k in plain if column_named(k).quantity == quantity)
    column = column_named(f"{quantity}_{unit}")
    assert column.factor == factor
    divisor = factor / length if column.is_total else factor
    changed = {k: v for k, v in plain.items() if k != key}
    changed[f"{quantity}_{unit}"] = [value / divisor for value in plain[key]]
    one = measured(write_table(tmp_path / "one.csv", plain))
    two = measured(write_table(tmp_path / "two.csv", changed))
    for name, values in one.columns.items():
        assert two.columns[name] == pytest.approx(values, rel=1e-14), name


@pytest.mark.parametrize(
    ("name", "separator"),
    [("t.txt", ","), ("t.TXT", "; "), ("t.tsv", "\t"), ("t.dat", "  "), ("t.asc", " "), ("t", ",")],
)
def test_a_table_in_text_may_have_any_name(tmp_path, name, separator):
    from_csv = measured(write_table(tmp_path / "t.csv", GOOD))
    text = (tmp_path / "t.csv").read_text()
    (tmp_path / name).write_text(text.replace(",", separator))
    for column, values in measured(tmp_path / name).columns.items():
        assert np.array_equal(from_csv.columns[column], values)


def test_parquet_says_the_same_as_csv(tmp_path):
    require_package("pyarrow")
    pd.DataFrame(GOOD).to_parquet(tmp_path / "t.parquet")
    from_parquet = measured(tmp_path / "t.parquet")
    from_csv = measured(write_table(tmp_path / "t.csv", GOOD))
    for name, values in from_csv.columns.items():
        assert np.array_equal(from_parquet.columns[name], values)
    assert (from_csv.line(0), from_parquet.line(0)) == (2, 1)


def test_comments_and_empty_lines_keep_the_numbers_of_the_others(tmp_path):
    path = tmp_path / "t.csv"
    text = "# made up\nload_N_per_mm,penetration_um\n\n# more\n10,0.2\n20,0.4\n"
    path.write_text("\ufeff" + text, encoding="utf-8")
    constants = {"E_GPa": 207.0, "nu": 0.3, "dR_um": 50}
    actual = measured(path, constants=constants)
    assert [actual.line(k) for k in range(2)] == [5, 6]


def test_constants_stand_for_columns(tmp_path):
    columns = without("E_GPa", "nu", "dR_um")
    table = write_table(tmp_path / "t.csv", columns)
    constants = {"E_MPa": 207e3, "nu": 0.3, "R_i_mm": 10, "R_j_mm": 9.95}
    actual = measured(table, constants=constants)
    assert actual.pair.dR == pytest.approx([0.05] * 3)
    assert actual.pair.R_j == pytest.approx([9.95] * 3)
    force = write_table(tmp_path / "f.csv", {**without("load_N_per_mm"), "load_N": [100, 200, 400]})
    assert measured(force, constants={"length_mm": 10.0}).load == pytest.approx([10, 20, 40])


def test_materials_are_looked_up_and_their_provenance_kept(tmp_path):
    names = ["low-carbon steel", "titanium alloy", "low-carbon steel"]
    columns = {**without("E_GPa", "nu"), "material_i": names}
    table = write_table(tmp_path / "t.csv", columns)
    data = read_measured(table, "internal", {"material_j": "aluminium alloy"})
    actual = measurements_of(data, "t")
    assert actual.columns["E_i"] == pytest.approx([200e3, 120e3, 200e3])
    assert actual.columns["E_j"] == pytest.approx([69e3] * 3)
    assert any("titanium alloy" in note and "derived" in note for note in data.notes)
    assert actual.groups("material")[0] == [
        "low-carbon steel on aluminium alloy",
        "titanium alloy on aluminium alloy",
    ]


@pytest.mark.parametrize(
    ("contact", "given", "expected"),
    [
        ("internal", {"dR_mm": 0.5, "R_i_mm": 10}, (10, 9.5)),
        ("internal", {"dR_mm": 0.5, "R_j_mm": 10}, (10.5, 10)),
        ("external", {"dR_mm": 30, "R_i_mm": 10}, (10, 20)),
        ("external", {"dR_mm": 30, "R_j_mm": 10}, (20, 10)),
        ("external", {"R_i_mm": 10, "R_j_mm": 20}, (10, 20)),
    ],
)
def test_geometry_is_completed(tmp_path, contact, given, expected):
    table = write_table(tmp_path / "t.csv", without("dR_um"))
    pair = measured(table, contact, given).pair
    assert (pair.R_i[0], pair.R_j[0]) == pytest.approx(expected)
    sign = 1 if contact == "internal" else -1
    assert pair.dR == pytest.approx(pair.R_i - sign * pair.R_j)


def test_groups_and_duplicates(tmp_path):
    columns = {name: [*column, column[0]] for name, column in GOOD.items()}
    columns["group"] = ["a", "a", "b", "a"]
    actual = measured(write_table(tmp_path / "t.csv", columns))
    assert actual.groups("rows")[0] == ["line 2", "line 3", "line 4", "line 5"]
    assert actual.groups("group")[1].tolist() == [0, 0, 1, 0]
    assert actual.groups("dR")[0] == ["ΔR = 0.05 mm", "ΔR = 0.08 mm"]
    assert actual.groups("material")[0] == ["E = 207000 MPa", "E = 69000 MPa"]
    assert actual.groups("pair")[0][0] == "E = 207000 MPa, ΔR = 0.05 mm"
    assert actual.duplicates() == [[2, 5]]
    part = actual.take(np.array([3, 3, 1]))
    assert [part.line(k) for k in range(3)] == [5, 5, 3]


# --- every way to go wrong --------------------------------------------------------------------

BAD_TABLES = [
    ("", "", "", None, "is empty", "line of column names"),
    ("load_N_per_mm,penetration_um\n", "", "", None, "holds no rows", "at least one"),
    ("load_N_per_mm\n1,2\n", ", line 2", "", None, "2 cells for 1 columns", "for each column"),
    ("load\n1\n", "", "columns", "load", "has no unit", "--columns load_N=load"),
    (
        *("load_N,gap_um\n1,2\n", "", "columns", None),
        "lacks the penetration, ΔR or both radii, the material of the hole, the material of the",
        "columns, e.g. penetration_um, dR_um, material_i, material_j, or options, e.g. --dR; name "
        "one of 'gap_um' with --columns penetration_um=COLUMN",
    ),
    (
        *("load_N,gap,dR_um,material\n1,2,3,PEEK\n", "", "penetration", None, "is required"),
        "one of 'gap' with --columns penetration_um=COLUMN",
    ),
    ("load_N,load_kN\n1,2\n", "", "columns", "load_kN", "same quantity as load_N", "keep one"),
    ("load_N\n1\n,2\n", ", line 3", "", None, "2 cells for 1", "every row"),
    ("nu,load_N\n.3,1\n.3,\n", ", line 3", "load_N", None, "is empty", "fill it in"),
    ("nu,load_N\n.3,1\n.3,x\n", ", line 3", "load_N", "x", "finite number", "decimal point"),
    ("load_N\nnan\n", ", line 2", "load_N", "nan", "finite number", "decimal point"),
    ("load_N\n1e999\n", ", line 2", "load_N", "1e999", "finite number", "decimal point"),
    ("nu,material\n.3,\n", ", line 2", "material", None, "is empty", "fill it in"),
    ('load_N\n"1\n', "", "", None, "is not a CSV table", "save it as CSV"),
]


@pytest.mark.parametrize(("text", "where", "key", "value", "rule", "remedy"), BAD_TABLES)
def test_a_bad_table_is_told_with_its_line(tmp_path, text, where, key, value, rule, remedy):
    path = tmp_path / "t.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_measured(path, "internal")
    assert_told(caught, f"{path}{where}", key, value, rule, remedy)


def test_files_that_are_no_tables_are_refused(tmp_path):
    cases = {
        "t.json": (b"{}", "is not a table"),
        "t.XLS": (b"x", "is a workbook of Excel before 2007"),
        "t.ods": (b"PK\x03\x04\x00", "is not a CSV table"),
        "t.xlsx": (b"x", "is not an Excel workbook"),
        "missing.csv": (None, "cannot be read (No such file"),
        "t.csv": (b"\xff\xfe\x00load", "is not a CSV table"),
    }
    for name, (content, rule) in cases.items():
        if content is not None:
            (tmp_path / name).write_bytes(content)
        with pytest.raises(InputError) as caught:
            read_measured(tmp_path / name, "internal")
        assert rule in caught.value.rule
        assert len(str(caught.value).splitlines()) == 1


def test_what_is_no_parquet_is_refused(tmp_path):
    require_package("pyarrow")
    (tmp_path / "t.parquet").write_bytes(b"not parquet")
    with pytest.raises(InputError, match="is not a Parquet table"):
        read_measured(tmp_path / "t.parquet", "internal")


def test_a_parquet_with_words_or_gaps_is_refused_with_its_row(tmp_path):
    require_package("pyarrow")
    for cells, rule in (([1.0, None], "is empty"), (["1", "x"], "finite number")):
        path = tmp_path / "t.parquet"
        pd.DataFrame({"load_N": cells}).to_parquet(path)
        with pytest.raises(InputError) as caught:
            read_measured(path, "internal")
        assert_told(caught, f"{path}, row 2", "load_N", cells[1], rule, "")


def test_too_many_rows_are_refused(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text("load_N\n" + "1\n" * (MAX_ROWS + 1))
    with pytest.raises(InputError, match=f"at most {MAX_ROWS}"):
        read_measured(path, "internal")


def test_a_column_can_be_left_out_if_it_is_there(tmp_path):
    table = write_table(tmp_path / "t.csv", {**GOOD, "operator": ["x", "y", "z"]})
    assert len(measured(table, ignored=("operator",))) == 3
    with pytest.raises(InputError, match="ignore = 'nobody': is not a column of the table"):
        measured(table, ignored=("nobody",))


# Columns dropped, columns added, constants, and what is wrong then.
BAD_COLUMNS = [
    ((), {"weight": [1, 0, 1]}, {}, ", line 3", "weight", 0.0, "positive", "correct the row"),
    (("load_N_per_mm",), {}, {}, "", "load", None, "is required", "load_N_per_mm"),
    (("penetration_um",), {}, {}, "", "penetration", None, "is required", "penetration_um"),
    (("nu",), {}, {}, "", "nu", None, "is required", "add nu"),
    (("E_GPa", "nu"), {}, {}, "", "material of the hole", None, "is not given", "--hole"),
    ((), {"E_i_GPa": [1, 1, 1]}, {}, "", "material of the hole", None, "must be given once", "E_i"),
    ((), {}, {"E_MPa": 1.0}, "", "constants.E_MPa", 1.0, "is given twice", "keep one"),
    ((), {}, {"load_N": 1.0}, "", "constants.load_N", 1.0, "not a known constant", "e.g."),
    ((), {}, {"colour": 1.0}, "", "constants.colour", 1.0, "not a known constant", "e.g."),
    ((), {}, {"length_mm": "x"}, "", "constants.length_mm", "x", "must be a number", "correct"),
    (("E_GPa", "nu"), {}, {"material": 3.0}, "", "constants.material", 3.0, "be a name", "corr"),
    (("E_GPa", "nu"), {}, {"material": "gold"}, "", "material", "gold", "is not in", "ceramics"),
    (("dR_um",), {}, {}, "", "dR, R_i, R_j", [], "ΔR and one radius", "dR_nm"),
    ((), {}, {"R_i_mm": 10.0, "R_j_mm": 9.0}, "", "dR, R_i, R_j", None, "ΔR and one", "R_i"),
    (
        (),
        {},
        {"R_i_mm": 0.01},
        ", line 2",
        "dR, R_i",
        None,
        "leave the pin's radius = -0.04 mm",
        "",
    ),
    (("dR_um",), {}, {"R_i_mm": 9.0, "R_j_mm": 10.0}, "", "R_i, R_j", None, "is not above", "exch"),
    (("nu",), {}, {"nu": 30}, "", "constants.nu", 30, "must lie in [0, 0.5]", "mind its unit"),
    (("dR_um",), {}, {"dR_um": -1}, "", "constants.dR_um", -1, "must be positive", "mind its unit"),
    (("load_N_per_mm",), {"load_N": [1, 2, 3]}, {}, "", "load", None, "is a total force", "length"),
]


@pytest.mark.parametrize(
    ("dropped", "added", "constants", "where", "key", "value", "rule", "remedy"), BAD_COLUMNS
)
def test_bad_columns_and_constants_are_told(
    tmp_path, dropped, added, constants, where, key, value, rule, remedy
):
    path = write_table(tmp_path / "t.csv", {**without(*dropped), **added})
    with pytest.raises(InputError) as caught:
        measured(path, constants=constants)
    error = caught.value
    assert error.source == f"{path}{where}"
    assert error.key == key
    if value is not None:
        assert error.value == value
    assert rule in error.rule
    assert remedy in error.remedy


@pytest.mark.parametrize(
    ("column", "value", "key"),
    [
        ("load_N_per_mm", -1.0, "load"),
        ("dR_um", 0.0, "dR"),
        ("E_GPa", 0.0, "E_i"),
        ("nu", 0.6, "nu_i"),
        ("nu", -0.1, "nu_i"),
    ],
)
def test_impossible_values_are_told_with_their_line(tmp_path, column, value, key):
    columns = {name: list(cells) for name, cells in GOOD.items()}
    columns[column][1] = value
    columns[column][2] = value
    path = write_table(tmp_path / "t.csv", columns)
    with pytest.raises(InputError) as caught:
        measured(path)
    assert caught.value.source == f"{path}, line 3"
    assert caught.value.key == key
    assert "(1 more like it)" in caught.value.remedy


def test_materials_of_ones_own_stand_beside_those_that_ship(tmp_path):
    path = write_table(tmp_path / "t.csv", without("E_GPa", "nu"))
    own = tmp_path / "own.csv"
    own.write_text(f"{','.join(COLUMNS[:8])}\ngunmetal,110,assumed,0.34,assumed,,,\n")
    pair = {"material_i": "Gunmetal", "material_j": "ceramics"}
    data = read_measured(path, "internal", pair, own)
    assert data.labels["material_i"] == ["gunmetal"]
    assert (data.numbers["E_i"], data.numbers["E_j"]) == ([110e3], [600e3])
    assert [note.split(":")[0] for note in data.notes] == [
        "E and ν of ceramics are from the table that ships",
        "E and ν of gunmetal are from own.csv",
    ]
    for table, name in ((None, "the table that ships"), (own, "own.csv")):
        with pytest.raises(InputError) as caught:
            measured(path, constants={"material": "Brass"}, materials=table)
        remedy = "or name a table of your own with --materials"
        assert_told(caught, path, "material", "Brass", f"is not in {name}", remedy)


def test_unknown_groupings_are_refused(tmp_path):
    actual = measured(write_table(tmp_path / "t.csv", GOOD))
    with pytest.raises(InputError, match="over = 'moon': is unknown"):
        actual.groups("moon")
    with pytest.raises(InputError, match="is not a column of the table; add a column group"):
        actual.groups("group")


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"numbers": {"load": [1.0, 2.0]}}, "numbers.load"),
        ({"numbers": {"colour": [1.0]}}, "numbers.colour"),
        ({"labels": {"material": ["a", "b"]}}, "labels.material"),
        ({"lines": []}, "lines"),
    ],
)
def test_damaged_data_in_a_result_are_refused(tmp_path, changes, key):
    data = read_measured(write_table(tmp_path / "t.csv", GOOD), "internal")
    plain = data.model_dump() | changes
    if changes.get("lines") == []:
        plain["numbers"] = {}
    with pytest.raises(InputError) as caught:
        measurements_of(MeasuredData(**plain), "r.json")
    assert caught.value.key == key
    assert "redo the fit" in caught.value.remedy


# --- which objective --------------------------------------------------------------------------


def campaign_on(tmp_path, columns, law="power", **settings):
    """The campaign of a law on a table of these columns."""
    table = write_table(tmp_path / "t.csv", columns)
    return campaign_of_table(table, law, "internal", {}, **settings)


def test_the_objective_follows_the_standard_deviations(tmp_path):
    (tmp_path / "mine.py").write_text(USER_LAW)
    bounds = {name: {"low": 1.0, "high": 2.0} for name in ("K_star", "n")}
    own = {"law": "mine:load", "parameters": bounds}
    of_load, of_depth = {"load_std_N_per_mm": [1] * 3}, {"penetration_std_um": [1] * 3}
    for added, settings, objective in (
        ({}, {}, "rms-log-penetration"),
        ({}, own, "rms-log-load"),
        (of_load, {}, "rms-load"),
        (of_depth, own, "rms-penetration"),
        ({}, {"objective": "rms-load"}, "rms-load"),
        ({}, {"noise": "constant"}, "rms-penetration"),
        ({}, {"noise": "proportional"}, "rms-log-penetration"),
        ({}, {"noise": "constant", **own}, "rms-penetration"),
    ):
        assert campaign_on(tmp_path, {**GOOD, **added}, **settings).objective == objective


def test_deviations_of_both_quantities_are_a_noise_model(tmp_path):
    both = {**GOOD, "load_std_N_per_mm": [1] * 3, "penetration_std_um": [0.01] * 3}
    campaign = campaign_of_table(write_table(tmp_path / "t.csv", both), "power", "internal", {})
    assert campaign.objective == STANDARDISED
    assert campaign.noise.noise is None


@pytest.mark.parametrize(
    ("added", "given", "noise", "key", "rule"),
    [
        ({}, "rms-difference-percent", None, "objective", "is not an objective for measurements"),
        (
            {"load_std_N_per_mm": [1] * 3},
            "rms-log-load",
            None,
            "objective",
            "leaves the column load_std",
        ),
        ({"load_std_N_per_mm": [1] * 3, "weight": [1] * 3}, None, None, "weight", "conflicts with"),
        ({}, "rms-load", "constant", "noise", "conflicts with objective, which says the same"),
        (
            {"penetration_std_um": [1] * 3},
            None,
            "constant",
            "noise",
            "conflicts with penetration_std, which says the same",
        ),
    ],
)
def test_an_objective_that_contradicts_the_data_is_refused(
    tmp_path, added, given, noise, key, rule
):
    with pytest.raises(InputError) as caught:
        campaign_on(tmp_path, {**GOOD, **added}, objective=given, noise=noise)
    assert caught.value.key == key
    assert rule in caught.value.rule
