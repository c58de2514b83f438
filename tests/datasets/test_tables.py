"""Tables as they come: separators, decimal marks, encodings, workbooks, names, units, branches."""

import datetime

import numpy as np
import pandas as pd
import pytest

from cylcontact import InputError
from cylcontact.datasets.branches import is_unloading
from cylcontact.datasets.measurements import measurements_of
from cylcontact.datasets.measurements import read_measured as read_with
from cylcontact.datasets.reading import TableSpec
from cylcontact.files.units import column_named
from tests.support.machine_files import workbook
from tests.support.programs import require_package

PAIR = {"E_GPa": 207.0, "nu": 0.3, "dR_um": 50.0}
SEMI = "load_N_per_mm;penetration_um\n"
LOADS, DEPTHS = [10.5, 20.0, 40.25], [2.5e-4, 4e-4, 7e-4]
# Loads up, down, up again.
CYCLE = [0.0, 10.0, 20.0, 30.0, 40.0, 30.0, 20.0, 10.0, 0.0, 15.0, 45.0]


def read_measured(source, contact, constants=None, **keys):
    return read_with(source, contact, constants, spec=TableSpec(**keys))


def written(path, content, encoding="utf-8"):
    path.write_bytes(content.encode(encoding) if isinstance(content, str) else content)
    return path


def read(path, content=None, encoding="utf-8", **keywords):
    """Read a table, and check it row by row."""
    if content is not None:
        written(path, content, encoding)
    data = read_measured(path, "internal", PAIR, **keywords)
    return measurements_of(data, str(path))


def told(source, said, where="", pair=PAIR, **keywords):
    """Hold that a table is refused in one line that begins with its place, and says these parts."""
    with pytest.raises(InputError) as caught:
        measurements_of(read_measured(source, "internal", pair, **keywords), str(source))
    message = str(caught.value)
    assert len(message.splitlines()) == 1
    assert message.startswith(where)
    assert all(part in message for part in said.split("|")), message


# --- files --------------------------------------------------------------------------------------


BAD_FILES = [
    # Thousands: certain, or possible.
    (SEMI + "1.234,5;2\n", 2, "load_N_per_mm = '1.234,5'|separators of thousands|without"),
    (SEMI + "1.234.567;2,5\n", 2, "'1.234.567'|separators of thousands"),
    (SEMI + "1 234,5;2,5\n", 2, "'1 234,5'|separators of thousands"),
    (SEMI + "1'234.5;2.5\n", 2, "separators of thousands|without"),
    (
        SEMI + "1,234;2\n5,678;3\n",
        2,
        "load_N_per_mm = '1,234'|may be of thousands|--decimal ',' if it is 1.234",
    ),
    (SEMI + "1.234;2\n567;3\n", 2, "may be of thousands|--decimal ',' if it is 1234"),
    (SEMI + "1,5;2\n2.5;3\n", 2, "'1,5'|a comma, and other numbers of the column a point"),
    # Cells and rows.
    (SEMI + "1,5;x\n", 2, "penetration_um = 'x'|must be a finite number|decimal point"),
    (SEMI + "1e999;2\n", 2, "load_N_per_mm = '1e999'|must be a finite number"),
    (SEMI + "1,5;2 µm\n2;3\n", 2, "penetration_um = '2 µm'|must be a finite number|its unit"),
    (SEMI + "1,5;\n", 2, "penetration_um|is empty|fill it in"),
    (SEMI + "1,5;2;3\n", 2, "has 3 cells for 2 columns|separated by semicolons"),
    ("nu,material\n.3,\n", 2, "material|is empty"),
    ("Lauf 3\nload_N,x\n1,2\n", None, "lacks the penetration and the length|UNIT=x"),
    (SEMI + "0;0,1\n0;0\n", None, "load = 0.0|is zero in all rows|above zero"),
    ("", None, "is empty|line of column names"),
    ("load_N_per_mm,penetration_um\n", None, "holds no rows|at least one"),
    ('load_N\n"1\n', None, "is not a CSV table|save it as CSV"),
    # Bytes.
    (b"load_N;\x81\n", None, "in an encoding that is not known|--encoding cp1251|UTF-8"),
    (b"\xff\xfe\x00load", None, "is not a CSV table|UTF-8"),
    ("load_N\n1\n".encode("utf-16-le"), None, "holds zero bytes|UTF-8"),
    # Units and names.
    ("force;delta\nN/mm;\n", None, "holds no rows"),
    ("force;delta\nN/mm;\n1;2\n", None, "columns = 'delta'|has no unit|penetration_UNIT=delta"),
    ("force [tf];x\n1;2\n", None, "'force [tf]'|has a unit that is not known|ignore"),
    ("force;x\ntf;µm\n1;2\n", None, "'force'|has a unit that is not known|convert its numbers"),
    ("F [N];x\nkN;µm\n1;2\n", None, "'F [N]'|has 'kN' below its name|correct one"),
    ("F [N];load_N\n1;2\n", None, "'load_N'|same quantity as F [N]|--ignore load_N"),
    ("F [N];F [N]\n1;2\n", None, "same quantity as F [N]|another name"),
    (
        "F [N];x\n1;2\n",
        None,
        "lacks the penetration and the length|--columns penetration_UNIT=x --length 20|not read",
    ),
    ("F [N];delta_um\n1;2\n", None, "lacks the length; add your own, e.g. --length 20"),
]


@pytest.mark.parametrize(("content", "line", "said"), BAD_FILES)
def test_a_file_in_doubt_is_told_in_one_line(tmp_path, content, line, said):
    path = written(tmp_path / "t.csv", content)
    told(path, said, f"{path}: " if line is None else f"{path}, line {line}: ")


def test_one_number_shows_what_a_comma_marks(tmp_path):
    # 1,234 alone may be a thousand; with 0,206 or 1,5 beside it it is not.
    for other in ("0,206", "1,5", "12,3456", "1,2340"):
        actual = read(tmp_path / "t.csv", f"{SEMI}1,234;2\n{other};3\n")
        assert actual.load[0] == pytest.approx(1.234)
    # A file separated by commas is as it always was.
    plain = read(tmp_path / "t.csv", "load_N_per_mm,penetration_um\n1.234,2\n567,3\n")
    assert plain.load == pytest.approx([1.234, 567])


def test_too_many_rows_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("cylcontact.files.sheet.MAX_ROWS", 3)
    told(written(tmp_path / "t.csv", "load_N\n" + "1\n" * 4), "at most 3")


# --- workbooks, Parquet and frames --------------------------------------------------------------


def test_a_workbook_says_the_same_as_a_csv(tmp_path):
    rows = [
        [None, None, None, None],
        ["# made up", None, None, None],
        ["load", "displacement", None, "Datum"],
        ["N/mm", "µm", None, None],
        [10.5, 0.25, None, datetime.datetime(2024, 5, 1)],
        [None, None, None, None],
        [20, 0.4, None, datetime.datetime(2024, 5, 2)],
        ["40,25", 0.7, None, datetime.datetime(2024, 5, 2)],
    ]
    path = workbook(tmp_path / "t.XLSX", {"empty": [], "Lauf 1": rows, "more": [["x"]]})
    actual = read(path, group="Datum")
    assert actual.load == pytest.approx(LOADS)
    assert actual.penetration == pytest.approx(DEPTHS, abs=0)
    assert (actual.data.row_word, actual.data.lines) == ("row", [5, 7, 8])
    assert actual.data.labels["group"] == ["2024-05-01", "2024-05-02", "2024-05-02"]


def test_a_frame_and_a_parquet_say_the_same_as_their_file(tmp_path):
    require_package("pyarrow")
    table = {"F [N/mm]": LOADS, "Weg": [0.25, 0.4, 0.7], "Lauf": [1, 1, 2], "t [ms]": [0, 500, 900]}
    frame = pd.DataFrame(table, index=[7, 8, 9])
    frame.to_csv(tmp_path / "t.csv", index=False)
    frame.to_parquet(tmp_path / "t.parquet")
    keywords = {"columns": {"penetration_um": "Weg"}, "group": "Lauf"}
    expected = read_measured(tmp_path / "t.csv", "internal", PAIR, **keywords)
    assert expected.numbers["time"] == pytest.approx([0, 0.5, 0.9])
    assert expected.lines == [2, 3, 4]
    for other in (frame, tmp_path / "t.parquet"):
        actual = read_measured(other, "internal", PAIR, **keywords)
        assert (actual.numbers, actual.labels) == (expected.numbers, expected.labels)
        assert (actual.row_word, actual.lines) == ("row", [1, 2, 3])


def test_what_is_no_table_is_refused(tmp_path):
    require_package("pyarrow")
    good = workbook(tmp_path / "good.xlsx", {"one": [["load_N"], [1.0]]}).read_bytes()
    empty = workbook(tmp_path / "none.xlsx", {"one": [], "two": [[]]}).read_bytes()
    formula = [["load_N_per_mm", "penetration_um"], [1.0, 0.1], [2.0, "=B2*2"]]
    cases = [
        ("t.json", b"{}", "is not a table"),
        ("t.XLS", b"\xd0\xcf\x11\xe0", "is a workbook of Excel before 2007"),
        ("t.ods", b"PK\x03\x04\x00", "is an archive (zip); unpack it"),
        ("t.xlsx", b"load_N\n", r"is not an Excel workbook (File is not a zip file)"),
        ("t.xlsx", good[:400], "is not an Excel workbook"),
        ("t.xlsx", good[:-30], "is not an Excel workbook"),
        ("t.xlsx", empty, "is empty"),
        ("t.xlsx", workbook(tmp_path / "f.xlsx", {"one": formula}).read_bytes(),
         "row 3: penetration_um: is empty, or a formula without a stored value|save the workbook"),
        ("t.xlsx", workbook(tmp_path / "c.xlsx", {"cover": [["Info"], ["x"]]}).read_bytes(),
         "holds no rows"),
        ("t.parquet", b"not parquet", "is not a Parquet table"),
    ]  # fmt: skip
    for name, content, said in cases:
        told(written(tmp_path / name, content), said, f"{tmp_path / name}")
    told(tmp_path / "missing.csv", "cannot be read (No such file")
    for bad, rule in (([1.0, np.nan], "empty"), (["1", "x"], "finite"), ([1, True], "finite")):
        frame = pd.DataFrame({"load_N": bad, "penetration_mm": [1.0, 2.0]}, dtype=object)
        told(frame, rule, "DataFrame, row 2: load_N")
    told(pd.DataFrame({"load_N": []}), "holds no rows", "DataFrame: ")


# --- names --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("names", "quantity", "unit", "factor"),
    [
        (
            "load_N|F_N|force_N|F [N]|F (N)|Force / N|F/N|Force, N|Normal force [N]",
            "load",
            "N",
            1.0,
        ),
        ("Force in N|Load (N)", "load", "N", 1.0),
        (
            "load N/mm|F [N/mm]|Line load [N mm^-1]|load [N·mm⁻¹]|P [N / mm]",
            "load",
            "N_per_mm",
            1.0,
        ),
        (
            "displacement [µm]|δ [μm]|delta_um|Approach (micron)|deflection_µm",
            "penetration",
            "um",
            1e-3,
        ),
        ("Penetration depth / mm|indentation_mm", "penetration", "mm", 1.0),
        ("t [min]|Time (min)|time_min", "time", "min", 60.0),
        ("ΔR [µm]|dR_um", "dR", "um", 1e-3),
        ("E [GPa]|E_GPa", "E", "GPa", 1e3),
        ("E_i [GPa]|E_i_GPa", "E_i", "GPa", 1e3),
        ("ν|nu|nu [-]", "nu", "", 1.0),
    ],
)
def test_names_of_users_are_understood(names, quantity, unit, factor):
    for name in names.split("|"):
        column = column_named(name)
        assert (column.quantity, column.unit, column.factor) == (quantity, unit, factor), name


@pytest.mark.parametrize(
    "name",
    ["load cell", "load_step", "travel rate [mm/s]", "F/A", "f [Hz]", "T [°C]", "", "[N]", "d"],
)
def test_other_names_are_left_out(tmp_path, name):
    actual = read(tmp_path / "t.csv", SEMI.replace("\n", f";{name}\n") + "1;2;a\n2;3;b\n")
    assert actual.load.tolist() == [1, 2]
    assert f"left out: 1 column: {name!r}" in actual.read
    assert "time" not in actual.columns


def test_a_row_of_units_completes_the_names(tmp_path):
    text = "load\tdepth\tdR\tmaterial\n[kN/m]\tmm\tµm\t\n10\t0,001\t50\tceramics\n"
    path = written(tmp_path / "t.csv", text)
    data = read_measured(path, "internal", columns={"penetration": "depth"})
    kept = {name: data.numbers[name] for name in ("load", "penetration", "dR", "E_i")}
    assert kept == {"load": [10.0], "penetration": [0.001], "dR": [0.05], "E_i": [600e3]}
    assert data.lines == [3]


@pytest.mark.parametrize(
    ("keywords", "said"),
    [
        ({"columns": {"load_N": "Hub"}}, "columns.load_N = 'Hub': is not a column|it has Kraft"),
        ({"columns": {"colour": "Kraft"}}, "columns.colour = 'Kraft': is not a known quantity"),
        ({"columns": {"load": "Kraft"}}, "'Kraft': has no unit that is known|load_N_per_mm"),
        ({"columns": {"load_N": "Kraft", "load_kN": "Weg"}}, "'Weg'|same quantity as Kraft"),
        ({"columns": {"load_N": "Kraft", "dR_um": "Kraft"}}, "columns.dR_um|is load already"),
        ({"columns": {"load_N": "a"}}, "'a': is the name of 2 columns; give each"),
        ({"group": "a"}, "'a': is the name of 2 columns; give each"),
        ({"group": "Lauf"}, "group = 'Lauf': is not a column of the table"),
        ({"ignore": ("nobody",)}, "ignore = 'nobody': is not a column of the table"),
    ],
)
def test_columns_that_are_named_wrongly_are_told(tmp_path, keywords, said):
    path = written(tmp_path / "t.csv", "Kraft;Weg;a;a\n1;2;3;4\n")
    told(path, said, f"{path}: ", **keywords)


def test_the_unit_of_an_option_corrects_that_of_the_table(tmp_path):
    for text in ("Kraft;Weg\nkN/m;mm\n5;2\n", "Kraft [kN/m];Weg in mm\n5;2\n"):
        names = text.split("\n")[0].split(";")
        columns = {"load_N_per_m": names[0], "penetration_mm": names[1]}
        actual = read(tmp_path / "t.csv", text, columns=columns)
        assert (actual.load, actual.penetration) == (pytest.approx(5e-3), pytest.approx(2))
        assert f"column {names[0]!r} is taken in N/m, not in kN/m" in actual.read[-1]


def test_a_column_that_is_named_takes_the_place_of_others(tmp_path):
    text = "F, N/mm;Weg [mm];displacement [µm];group;t [s];x\n1,5;0,5;9;a;3;5\n2;1;9;b;3;5\n"
    keywords = {"columns": {"penetration": "Weg [mm]"}, "group": "t [s]", "ignore": ("x",)}
    actual = read(tmp_path / "t.csv", text, **keywords)
    assert actual.penetration == pytest.approx([0.5, 1])
    assert actual.data.labels["group"] == ["3", "3"]
    assert actual.columns["time"] == pytest.approx([3, 3])
    assert "left out: 3 columns: 'displacement [µm]', 'group', 'x'" in actual.read


# --- rows ---------------------------------------------------------------------------------------


def cycle(**others):
    return pd.DataFrame({"load_N_per_mm": CYCLE, "penetration_um": np.sqrt(CYCLE), **others})


def test_rows_of_zero_load_are_left_out_and_branches_told():
    data = read_measured(cycle(time_s=range(11)), "internal", PAIR)
    rises, falls = ["loading"] * 4, ["unloading"] * 3
    assert data.lines == [2, 3, 4, 5, 6, 7, 8, 10, 11]
    assert data.labels == {"branch": [*rises, *falls, "loading", "loading"]}
    assert data.numbers["time"] == [1, 2, 3, 4, 5, 6, 7, 9, 10]
    assert data.read[1] == "left out: 2 rows of zero load (rows 1, 9)"
    assert read_measured(cycle(), "internal", PAIR, branch="loading").lines == [2, 3, 4, 5, 10, 11]
    down = read_measured(cycle(), "internal", PAIR, branch="unloading")
    assert (down.lines, set(down.labels["branch"])) == ([6, 7, 8], {"unloading"})


def test_a_branch_that_is_not_there_is_refused():
    frame = pd.DataFrame({"load_N_per_mm": [1.0, 2, 3], "penetration_um": [1.0, 2, 3]})
    told(frame, "branch = 'unloading': has no rows of unloading; leave", branch="unloading")
    loads = np.random.default_rng(3).permutation(20) + 1.0
    frame = pd.DataFrame({"load_N_per_mm": loads, "penetration_um": loads})
    assert "branch" not in read_measured(frame, "internal", PAIR).labels
    told(frame, "'loading': cannot be told: the loads rise and", branch="loading")


@pytest.mark.parametrize(
    ("load", "expected"),
    [
        ([1, 2, 3, 4], "0000"),
        ([4, 3, 2, 1], "0000"),  # a table in falling order
        ([3, 2, 1, 3, 2, 1], "000000"),
        ([1, 2, 3, 1, 2, 3], "000000"),  # two runs one below the other
        ([5, 5, 5], "000"),
        ([1, 5, 9, 9, 6, 2], "000011"),  # held at the peak
        ([9, 6, 2, 5, 9, 12], "111000"),
        ([1, 5, 9, 8.9, 9.1, 12, 7, 1], "00000011"),  # noise near 9
        ([1, 9, 5, 3], "0011"),
        ([7], "0"),
        ([1, np.inf, np.inf, 3], "0000"),  # divided by a length of zero, which is refused later
    ],
)
def test_turning_points_part_loading_and_unloading(load, expected):
    actual = is_unloading(np.array(load, float), np.zeros(len(load), dtype=int))
    assert "".join(map(str, actual.astype(int))) == expected


def test_each_group_and_pair_has_its_own_course():
    load = np.array([1.0, 2, 3, 4, 4, 3, 2, 1])
    runs = np.repeat([0, 1], 4)
    assert is_unloading(load, runs).tolist() == [False] * 4 + [True] * 4
    assert not is_unloading(load[::-1], np.arange(8)).any()
    # Two specimens that are measured by turns, and two pairs one below the other.
    frame = pd.concat([cycle(Probe=1), cycle(Probe=2)]).sort_index(kind="stable")
    data = read_measured(frame, "internal", PAIR, group="Probe")
    one = read_measured(cycle(), "internal", PAIR).labels["branch"]
    assert data.labels["branch"][::2] == data.labels["branch"][1::2] == one
    both = pd.concat([cycle(material="ceramics"), cycle(material="bronze")])
    assert read_measured(both, "internal", {"dR_um": 50.0}).labels["branch"] == one * 2
