"""Tables as they come: separators, decimal marks, encodings, workbooks, names, units, branches."""

import datetime
import re
import zipfile

import numpy as np
import openpyxl
import pandas as pd
import pytest

from cylcontact import InputError
from cylcontact.datasets.columns import is_unloading
from cylcontact.datasets.measurements import measurements_of, read_measured
from cylcontact.fitting.table_campaign import campaign_of_table, read_campaign
from cylcontact.units import column_named
from tests.support.measured_files import CONSTANTS, write_measured
from tests.support.spec_files import assert_told

PAIR = {"E_GPa": 207.0, "nu": 0.3, "dR_um": 50.0}
PLAIN = "load_N_per_mm,penetration_um\n10.5,0.25\n20,0.4\n40.25,0.7\n"
LOADS, DEPTHS = [10.5, 20.0, 40.25], [2.5e-4, 4e-4, 7e-4]
# Loads up, down, up again, with readings that hang back on the way down.
CYCLE = [0.0, 10.0, 20.0, 30.0, 40.0, 30.0, 20.0, 10.0, 0.0, 15.0, 45.0]


def written(path, content, encoding="utf-8"):
    path.write_bytes(content.encode(encoding) if isinstance(content, str) else content)
    return path


def read(path, content=None, encoding="utf-8", **keywords):
    """Read a table, and check it row by row."""
    if content is not None:
        written(path, content, encoding)
    data = read_measured(path, "internal", PAIR, **keywords)
    return measurements_of(data, str(path))


def workbook(path, sheets):
    """Write sheets of rows as a workbook."""
    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


# --- files --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "steps"),
    [
        (PLAIN, []),
        (PLAIN.replace(",", ",\t"), []),
        (PLAIN.replace(",", ";"), ["semicolons"]),
        (PLAIN.replace(",", "\t"), ["tabs"]),
        (PLAIN.replace(",", ";").replace(".", ","), ["semicolons", "decimals"]),
        (PLAIN.replace(",", "\t").replace(".", ","), ["tabs", "decimals"]),
        (PLAIN.replace(",", '","').replace("\n", '"\n"').replace(".", ",")[:-1], ["decimals"]),
        (PLAIN.replace(",", ";").replace("\n", "\r\n"), ["semicolons"]),
        ("sep=;\n" + PLAIN.replace(",", ";"), ["semicolons"]),
        ("# a; b, c\n\n" + PLAIN.replace(",", "\t"), ["tabs"]),
    ],
)
def test_separators_and_decimal_marks_are_recognised(tmp_path, text, steps):
    text = f'"{text}' if '","' in text else text
    actual = read(tmp_path / "t.csv", text)
    assert actual.load == pytest.approx(LOADS)
    assert actual.penetration == pytest.approx(DEPTHS, abs=0)
    assert len(actual.data.steps) == len(steps)
    assert all(word in step for word, step in zip(steps, actual.data.steps, strict=True))


def test_names_between_tabs_or_semicolons_may_hold_commas(tmp_path):
    for separator in "\t;":
        text = f"Line load, N/mm{separator}displacement, µm\n1,5{separator}0,25\n"
        actual = read(tmp_path / "t.csv", text)
        assert (actual.load, actual.penetration) == (pytest.approx(1.5), pytest.approx(2.5e-4))


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252", "latin-1"])
def test_text_of_spreadsheet_programs_is_decoded(tmp_path, encoding):
    text = "load [N/mm];approach [µm];Prüfstück\n10;0,25;Bügel\n20,5;0,5;Öse\n"
    actual = read(tmp_path / "t.csv", text, encoding, group="Prüfstück")
    assert actual.penetration == pytest.approx([2.5e-4, 5e-4], abs=0)
    assert actual.data.labels["group"] == ["Bügel", "Öse"]
    named = {"utf-16": "UTF-16", "cp1252": "Windows-1252", "latin-1": "Windows-1252"}
    assert any(named.get(encoding, "semicolons") in step for step in actual.data.steps)


SEMI = "load_N_per_mm;penetration_um\n"
BAD_FILES = [
    # Thousands: certain, or possible.
    (SEMI + "1.234,5;2\n", 2, "load_N_per_mm", "1.234,5", "separators of thousands", "without"),
    (SEMI + "1.234.567;2,5\n", 2, "load_N_per_mm", "1.234.567", "separators of thousands", "with"),
    (SEMI + "1 234,5;2,5\n", 2, "load_N_per_mm", "1 234,5", "separators of thousands", "without"),
    (SEMI + "1'234.5;2.5\n", 2, "load_N_per_mm", "1'234.5", "separators of thousands", "without"),
    (SEMI + "1,234;2\n5,678;3\n", 2, "load_N_per_mm", "1,234", "may be of thousands", "1,2340"),
    (SEMI + "1.234;2\n567;3\n", 2, "load_N_per_mm", "1.234", "may be of thousands", "1.2340"),
    ('load_N,nu\n"1,234",2\n', 2, "load_N", "1,234", "may be of thousands", "1,2340"),
    (
        SEMI + "1,5;2\n2.5;3\n",
        2,
        "load_N_per_mm",
        "1,5",
        "a comma, and other numbers a point",
        "wr",
    ),
    # Cells and rows.
    (SEMI + "1,5;x\n", 2, "penetration_um", "x", "must be a finite number", "decimal point"),
    (SEMI + "1,5;2 µm\n", 2, "penetration_um", "2 µm", "must be a finite number", "its unit"),
    (SEMI + "1,5;\n", 2, "penetration_um", None, "is empty", "fill it in"),
    (SEMI + "1,5;2;3\n", 2, "", None, "has 3 cells for 2 columns", "separated by semicolons"),
    ("load_N\tnu\n1\n", 2, "", None, "has 1 cells for 2 columns", "separated by tabs"),
    # Bytes.
    (b"load_N\xe9\x00", None, "", None, "is not a CSV table", "UTF-8"),
    (b"load_N;\x81\n", None, "", None, "is not a CSV table", "UTF-8"),
    (b"load_N;\x95\n", None, "", None, "is not a CSV table", "UTF-8"),
    ("load_N\n1\n".encode("utf-16-le"), None, "", None, "holds zero bytes", "UTF-8"),
    # Units and names.
    ("force;delta\nN/mm;\n", None, "", None, "holds no rows", "at least one"),
    ("force;delta\nN/mm;\n1;2\n", None, "columns", "delta", "has no unit", "penetration_um=delta"),
    (
        "force [lbf];x\n1;2\n",
        None,
        "columns",
        "force [lbf]",
        "has a unit that is not known",
        "ignore",
    ),
    ("E;x\n1;2\n", None, "columns", "E", "has no unit", "--columns E_Pa=E"),
    ("force;x\nlbf;µm\n1;2\n", None, "columns", "force", "has a unit that is not known", "load_N"),
    ("F [N];x\nkN;µm\n1;2\n", None, "columns", "F [N]", "has 'kN' below its name", "correct one"),
    ("F [N];load_N\n1;2\n", None, "columns", "load_N", "same quantity as F [N]", "--ignore 'load"),
    (
        "F [N];x\n1;2\n",
        None,
        "penetration",
        None,
        "is required",
        "'x' with --columns penetration_um=",
    ),
    ("F [N];delta_um\n1;2\n", None, "load", None, "is a total force", "add --length in mm"),
    ("F [N];F [N]\n1;2\n", None, "columns", "F [N]", "same quantity as F [N]", "a name of its own"),
    ("Lauf 3\nload_N,nu\n1,2\n", 2, "", None, "has 2 cells for 1 columns", "others with #"),
    (SEMI + "0;0,1\n0;0\n", None, "load", 0.0, "is zero in all rows", "above zero"),
]


@pytest.mark.parametrize(("content", "line", "key", "value", "rule", "remedy"), BAD_FILES)
def test_a_file_in_doubt_is_told_in_one_line(tmp_path, content, line, key, value, rule, remedy):
    path = written(tmp_path / "t.csv", content)
    with pytest.raises(InputError) as caught:
        read_measured(path, "internal", PAIR)
    where = path if line is None else f"{path}, line {line}"
    assert_told(caught, where, key, value, rule, remedy)


def test_one_number_shows_what_a_comma_marks(tmp_path):
    # 1,234 alone may be a thousand; with 0,206 or 1,5 beside it it is not.
    for other in ("0,206", "1,5", "12,3456", "1,2340"):
        actual = read(tmp_path / "t.csv", f"{SEMI}1,234;2\n5;{other}\n")
        assert actual.load[0] == pytest.approx(1.234)
    # A file separated by commas is as it always was.
    plain = read(tmp_path / "t.csv", "load_N_per_mm,penetration_um\n1.234,2\n567,3\n")
    assert plain.load == pytest.approx([1.234, 567])


# --- workbooks and frames -----------------------------------------------------------------------


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
    assert actual.data.steps[:2] == [
        "sheet 'Lauf 1' is read, the first of 3 with cells",
        "row 4 is read as units",
    ]


def test_a_formula_needs_a_stored_value(tmp_path):
    rows = [["load_N_per_mm", "penetration_um", "note"], [1.0, 0.1, "=A2"], [2.0, "=B2*2", "=A3"]]
    path = workbook(tmp_path / "t.xlsx", {"one": rows})
    with pytest.raises(InputError) as caught:
        read(path)
    rule, remedy = "is empty, or a formula without a stored value", "save the workbook"
    assert_told(caught, f"{path}, row 3", "penetration_um", None, rule, remedy)
    # With a value stored, as a spreadsheet program saves it, the value is read.
    xml = "xl/worksheets/sheet1.xml"
    with_values = tmp_path / "stored.xlsx"
    rewrite(path, with_values, xml, rb"(<f>B2\*2</f>)<v ?/?>(</v>)?", rb"\1<v>0.2</v>")
    assert read(with_values).penetration == pytest.approx([1e-4, 2e-4], abs=0)


def rewrite(source, target, name, pattern, new):
    """Copy an archive with one place in one of its files changed."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as copy:
        for item in old.namelist():
            content = old.read(item)
            if item == name:
                content, count = re.subn(pattern, new, content)
                assert count == 1
            copy.writestr(item, content)


def test_a_workbook_that_is_none_is_refused(tmp_path):
    good = workbook(tmp_path / "good.xlsx", {"one": [["load_N"], [1.0]]}).read_bytes()
    cases = {"is not an Excel workbook": (b"", b"PK\x03\x04", good[:400], good[:-30])}
    cases["is empty"] = (workbook(tmp_path / "none.xlsx", {"one": [], "two": [[]]}).read_bytes(),)
    for rule, contents in cases.items():
        for content in contents:
            path = written(tmp_path / "t.xlsx", content)
            with pytest.raises(InputError) as caught:
                read(path)
            assert rule in caught.value.rule
            assert len(str(caught.value).splitlines()) == 1


def test_a_frame_says_the_same_as_its_file(tmp_path):
    table = {"F [N/mm]": LOADS, "Weg": [0.25, 0.4, 0.7], "Lauf": [1, 1, 2], "t [ms]": [0, 500, 900]}
    frame = pd.DataFrame(table, index=[7, 8, 9])
    frame.to_csv(tmp_path / "DataFrame", index=False, lineterminator="\n")
    path = (tmp_path / "DataFrame").rename(tmp_path / "t.csv")
    keywords = {"columns": {"penetration_um": "Weg"}, "group": "Lauf"}
    expected = read_measured(path, "internal", PAIR, **keywords)
    actual = read_measured(frame, "internal", PAIR, **keywords)
    differ = {"source": "t.csv", "row_word": "line", "lines": [2, 3, 4]}
    assert actual.model_dump() | differ == expected.model_dump()
    assert actual.numbers["time"] == pytest.approx([0, 0.5, 0.9])
    for bad, rule in (
        ([1.0, np.nan], "is empty"),
        (["1", "x"], "finite"),
        ([True, False], "finite"),
    ):
        with pytest.raises(InputError, match=rf"DataFrame, row [12]: load_N.*{rule}"):
            read_measured(pd.DataFrame({"load_N": bad}), "internal", PAIR)
    with pytest.raises(InputError, match="DataFrame: holds no rows"):
        read_measured(frame[:0], "internal", PAIR)


# --- names --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("names", "quantity", "unit"),
    [
        ("load_N,F_N,force_N,F [N],F (N),Force / N,F/N,'Force, N',Normal force [N]", "load", "N"),
        ("Force in N,Load (N)", "load", "N"),
        ("load N/mm,F [N/mm],Line load [N mm^-1],load [N·mm⁻¹],P [N / mm]", "load", "N_per_mm"),
        ("displacement [µm],δ [μm],delta_um,Approach (micron),deflection_µm", "penetration", "um"),
        ("Penetration depth / mm,indentation_mm", "penetration", "mm"),
        ("t [min],Time (min),time_min", "time", "min"),
        ("ΔR [µm],dR_um", "dR", "um"),
        ("E [GPa],E_GPa", "E", "GPa"),
        ("E_i [GPa],E_i_GPa", "E_i", "GPa"),
        ("ν,nu,nu [-]", "nu", ""),
    ],
)
def test_names_of_users_are_understood(names, quantity, unit):
    for name in names.replace("'Force, N'", "Force; N").split(","):
        column = column_named(name.replace(";", ","))
        assert (column.quantity, column.unit) == (quantity, unit), name


@pytest.mark.parametrize(
    "name",
    ["load cell", "load_step", "travel rate [mm/s]", "F/A", "f [Hz]", "T [°C]", "", "[N]", "d"],
)
def test_other_names_are_left_out(tmp_path, name):
    actual = read(tmp_path / "t.csv", SEMI.replace("\n", f";{name}\n") + "1;2;a\n2;3;b\n")
    assert actual.load.tolist() == [1, 2]
    assert actual.data.steps[-1] == f"1 column left out: {name!r}"
    assert "time" not in actual.columns


def test_a_row_of_units_completes_the_names(tmp_path):
    text = "load\tdepth\tdR\tmaterial\n[kN/m]\tmm\tµm\t\n10\t0,001\t50\tceramics\n"
    path = written(tmp_path / "t.csv", text)
    data = read_measured(path, "internal", columns={"penetration": "depth"})
    kept = {name: data.numbers[name] for name in ("load", "penetration", "dR", "E_i")}
    assert kept == {"load": [10.0], "penetration": [0.001], "dR": [0.05], "E_i": [600e3]}
    assert data.lines == [3]
    assert "line 2 is read as units" in data.steps


@pytest.mark.parametrize(
    ("columns", "key", "value", "rule", "remedy"),
    [
        (
            {"load_N_per_mm": "Hub"},
            "columns.load_N_per_mm",
            "Hub",
            "is not a column",
            "it has Kraft",
        ),
        ({"colour": "Kraft"}, "columns.colour", "Kraft", "is not a known quantity", "load_N"),
        ({"load": "Kraft"}, "columns.load", "Kraft", "has no unit that is known", "load_N_per_mm"),
        ({"load_N": "Kraft", "load_kN": "Weg"}, "columns", "Weg", "same quantity as Kraft", "keep"),
        (
            {"load_N": "Kraft", "dR_um": "Kraft"},
            "columns.dR_um",
            "Kraft",
            "is load already",
            "keep",
        ),
    ],
)
def test_columns_that_are_named_wrongly_are_told(tmp_path, columns, key, value, rule, remedy):
    path = written(tmp_path / "t.csv", "Kraft;Weg\n1;2\n")
    with pytest.raises(InputError) as caught:
        read(path, columns=columns)
    assert_told(caught, path, key, value, rule, remedy)


def test_the_unit_of_an_option_corrects_that_of_the_table(tmp_path):
    for text in ("Kraft;Weg\nkN/m;mm\n5;2\n", "Kraft [kN/m];Weg in mm\n5;2\n"):
        names = text.split("\n")[0].split(";")
        columns = {"load_N_per_m": names[0], "penetration_mm": names[1]}
        actual = read(tmp_path / "t.csv", text, columns=columns)
        assert (actual.load, actual.penetration) == (pytest.approx(5e-3), pytest.approx(2))
        assert f"column {names[0]!r} is taken in N/m, not in kN/m" in actual.data.steps
        assert not any("not in mm" in step for step in actual.data.steps)
    for keywords in ({"columns": {"load_N": "a"}}, {"group": "a"}):
        with pytest.raises(InputError, match="= 'a': is the name of 2 columns; give each"):
            read(tmp_path / "t.csv", "a;a;b\n1;2;3\n", **keywords)


def test_a_column_that_is_named_takes_the_place_of_others(tmp_path):
    text = "F [N/mm];Weg [mm];displacement [µm];group;t [s]\n1,5;0,5;9;a;3\n2;1;9;b;3\n"
    keywords = {"columns": {"penetration": "Weg [mm]"}, "group": "t [s]"}
    actual = read(tmp_path / "t.csv", text, **keywords)
    assert actual.penetration == pytest.approx([0.5, 1])
    assert actual.data.labels["group"] == ["3", "3"]
    assert actual.columns["time"] == pytest.approx([3, 3])
    assert "2 columns left out: 'displacement [µm]', 'group'" in actual.data.steps
    many = SEMI.replace("\n", ";" + ";".join(f"c{k}" for k in range(20)) + "\n")
    step = read(tmp_path / "t.csv", many + "1;2" + ";3" * 20 + "\n").data.steps[-1]
    listed = ", ".join(repr(f"c{k}") for k in range(8))
    assert step == f"20 columns left out: {listed} and 12 more"
    with pytest.raises(InputError, match="group = 'Lauf': is not a column of the table"):
        read(tmp_path / "t.csv", group="Lauf")


# --- rows ---------------------------------------------------------------------------------------


def cycle(**others):
    return pd.DataFrame({"load_N_per_mm": CYCLE, "penetration_um": np.sqrt(CYCLE), **others})


def test_rows_of_zero_load_are_left_out_and_branches_told():
    data = read_measured(cycle(time_s=range(11)), "internal", PAIR)
    rises, falls = ["loading"] * 4, ["unloading"] * 3
    assert data.lines == [2, 3, 4, 5, 6, 7, 8, 10, 11]
    assert data.labels == {"branch": [*rises, *falls, "loading", "loading"]}
    assert data.numbers["time"] == [1, 2, 3, 4, 5, 6, 7, 9, 10]
    assert data.steps == [
        "2 rows of zero load left out (rows 1, 9)",
        "6 rows of loading and 3 rows of unloading, all kept (--branch loading keeps the first)",
    ]
    up = read_measured(cycle(), "internal", PAIR, branch="loading")
    assert up.lines == [2, 3, 4, 5, 10, 11]
    assert up.steps[-1] == "3 rows of unloading left out (--branch loading)"
    down = read_measured(cycle(), "internal", PAIR, branch="unloading")
    assert (down.lines, set(down.labels["branch"])) == ([6, 7, 8], {"unloading"})
    assert down.steps[-1] == "6 rows of loading left out (--branch unloading)"


def test_a_branch_that_is_not_there_is_refused():
    frame = pd.DataFrame({"load_N_per_mm": [1.0, 2, 3], "penetration_um": [1.0, 2, 3]})
    with pytest.raises(InputError, match="branch = 'unloading': has no rows of unloading; leave"):
        read_measured(frame, "internal", PAIR, branch="unloading")
    assert read_measured(frame, "internal", PAIR, branch="loading").lines == [1, 2, 3]
    loads = np.random.default_rng(3).permutation(20) + 1.0
    frame = pd.DataFrame({"load_N_per_mm": loads, "penetration_um": loads})
    assert "branch" not in read_measured(frame, "internal", PAIR).labels
    with pytest.raises(InputError, match="branch = 'loading': cannot be told: the loads rise and"):
        read_measured(frame, "internal", PAIR, branch="loading")


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


def test_branches_of_a_noisy_record_are_those_that_made_it():
    # Made from a known course: up, down to 30 %, up, with noise of 1 % of the range.
    rng = np.random.default_rng(5)
    parts = [np.linspace(0, 100, 200), np.linspace(100, 30, 120), np.linspace(30, 110, 150)]
    truth = np.repeat([False, True, False], [200, 120, 150])
    noisy = np.concatenate(parts) + rng.normal(0, 1, 470)
    actual = is_unloading(noisy, np.zeros(470, dtype=int))
    assert np.count_nonzero(actual != truth) <= 12  # rows near the turning points


def test_a_series_that_only_falls_is_unloading_beside_one_that_rises():
    load = np.array([1.0, 2, 3, 4, 4, 3, 2, 1])
    runs = np.repeat([0, 1], 4)
    assert is_unloading(load, runs).tolist() == [False] * 4 + [True] * 4
    assert not is_unloading(load[::-1], np.arange(8)).any()
    assert not is_unloading(np.tile(load[4:], 2), runs).any()


def test_each_group_and_pair_has_its_own_course():
    load = np.array([10.0, 20, 30, 10, 20, 30, 20, 10])
    frame = pd.DataFrame({"load_N_per_mm": load, "penetration_um": load})
    # Specimens b and c are measured by turns.
    frame["Probe"] = ["a", "a", "a", "b", "c", "b", "c", "b"]
    data = read_measured(frame, "internal", PAIR, group="Probe")
    assert "branch" not in data.labels
    both = pd.concat([frame.assign(Probe="x"), frame[::-1].assign(Probe="y")])
    frame = pd.concat([cycle(Probe=1), cycle(Probe=2)]).sort_index(kind="stable")
    data = read_measured(frame, "internal", PAIR, group="Probe")
    one = read_measured(cycle(), "internal", PAIR).labels["branch"]
    assert data.labels["branch"][::2] == data.labels["branch"][1::2] == one
    by_pair = both.rename(columns={"Probe": "material"}).replace({"x": "ceramics", "y": "bronze"})
    data = read_measured(by_pair, "internal", {"dR_um": 50.0})
    assert len(data.lines) == 16


def test_a_rig_that_counts_compression_negative_is_told():
    frame = -cycle()[1:8]
    data = read_measured(frame, "internal", PAIR)
    with pytest.raises(InputError) as caught:
        measurements_of(data, "t")
    assert_told(caught, "t, row 1", "load", -10.0, "must be positive", "turn the sign of both")
    frame["penetration_um"] *= -1
    with pytest.raises(
        InputError, match=r"load = -10\.0: must be positive and finite; correct the"
    ):
        measurements_of(read_measured(frame, "internal", PAIR), "t")


def test_replicates_are_rows_of_the_same_load_and_pair():
    frame = pd.DataFrame(
        {
            "load_N": [1, 2, 1, 1, 2, 3, 1],
            "penetration_um": [1, 2, 3, 4, 5, 6, 7],
            "dR_um": [50, 50, 50, 60, 50, 50, 50],
        }
    )
    pair = {"E_GPa": 207.0, "nu": 0.3, "length_mm": 20.0}
    actual = measurements_of(read_measured(frame, "internal", pair), "t")
    keys = frame["load_N"].astype(str) + " " + frame["dR_um"].astype(str)
    expected = [rows.tolist() for rows in frame.groupby(keys).indices.values() if len(rows) > 1]
    assert sorted(rows.tolist() for rows in actual.replicates()) == sorted(expected)
    assert actual.take(np.array([3, 5])).replicates() == []


# --- campaigns ----------------------------------------------------------------------------------


def test_readings_below_zero_need_a_free_offset_and_constant_noise(tmp_path):
    table = write_measured(tmp_path / "t.csv", "johnson", "internal")
    rows = [line.split(",") for line in table.read_text().splitlines()]
    rows[3][2] = "-0.5"
    table.write_text("\n".join(map(",".join, rows)) + "\n")
    free = {"offset": {"low": -0.01, "high": 0.01}}
    fixed = {"offset": {"value": -0.001, "fixed": True}}
    for objective, parameters in (
        ("rms-penetration", fixed),
        ("rms-log-penetration", free),
        ("rms-log-load", free),
    ):
        with pytest.raises(InputError) as caught:
            campaign_of_table(
                *(table, "johnson", "internal", CONSTANTS),
                **{"objective": objective, "parameters": parameters},
            )
        told = "penetration", -0.0005, "must be positive and finite", "--free offset"
        assert_told(caught, f"{table}, line 4", *told)
        assert "--noise constant" in caught.value.remedy
    settings = {"objective": "rms-penetration", "parameters": free}
    plan = campaign_of_table(table, "johnson", "internal", CONSTANTS, **settings)
    assert plan.measurements.penetration[2] == -0.0005
    file = tmp_path / "campaign.toml"
    file.write_text(
        'data = "t.csv"\ncontact = "internal"\nlaw = "johnson"\nnoise = "proportional"\n'
        "[constants]\nE_GPa = 207\nnu = 0.3\nR_i_mm = 10\nlength_mm = 12\n"
        "[parameters.offset]\nvalue = 0.0\nfixed = true\n"
    )
    with pytest.raises(InputError) as caught:
        read_campaign(file)
    assert caught.value.source == f"{file}, t.csv, line 4"


@pytest.mark.slow
def test_keys_of_a_campaign_and_options_say_the_same(tmp_path, run):
    rows = zip(np.geomspace(0.2, 4, 8), np.geomspace(0.2, 4, 8) ** 0.9, strict=True)
    lines = [f"{f:.5f};{d:.5f};A{k % 2}".replace(".", ",") for k, (f, d) in enumerate(rows)]
    written(tmp_path / "t.csv", "\n".join(["Kraft;Weg;Probe", *lines, *lines[::-1][2:]]))
    campaign = tmp_path / "c.toml"
    campaign.write_text(
        'data = "t.csv"\ncontact = "internal"\nlaw = "power"\ngroup = "Probe"\nbranch = "loading"\n'
        "[constants]\nE_MPa = 207000.0\nnu = 0.3\ndR_mm = 0.03\nlength_mm = 20.0\n"
        '[columns]\nload_kN = "Kraft"\npenetration_um = "Weg"\n'
    )
    options = "--law power --contact internal --E 207000 --nu 0.3 --dR 0.03 --length 20"
    named = ("--columns", "load_kN=Kraft", "--columns", "penetration_um = Weg", "--group", "Probe")
    outs = [tmp_path / "a.json", tmp_path / "b.json"]
    assert run("fit", campaign, "-j", 1, "-o", outs[0])[::2] == (0, "")
    command = ("fit", tmp_path / "t.csv", *options.split(), *named, "--branch", "loading")
    assert run(*command, "-j", 1, "-o", outs[1])[::2] == (0, "")
    a, b = (pd.read_json(out, typ="series")["settings"] for out in outs)
    assert a == b
    assert a["measurements"]["labels"]["group"] == ["A0", "A1"] * 4
    for text, rule in (("Kraft", "is not valid"), ("load_kN=x", "load_kN is given twice")):
        code, _, errors = run(*command, "--columns", text)
        assert (code, len(errors.splitlines())) == (2, 1)
        assert f"--columns = '{text}': {rule}" in errors
    code, _, errors = run(*command, "--branch", "both")
    assert (code, len(errors.splitlines())) == (2, 1)
    assert "branch = 'both': must be 'loading' or 'unloading'" in errors


# Nobody marks thousands as decimals; and between commas a point marks decimals.
MARKS = [
    (separator, decimal, thousands)
    for separator in (",", ";", "\t")
    for decimal in ".,"
    for thousands in ("", ".", ",", " ", "'", "\u00a0")
    if thousands != decimal and (separator, thousands) != (",", ".")
]


@pytest.mark.parametrize(("separator", "decimal", "thousands"), MARKS)
def test_no_number_is_read_as_another(tmp_path, separator, decimal, thousands):
    """Whatever the country, a table is read right or refused."""
    rng = np.random.default_rng(20150101)
    read_right, rules = 0, []
    for _ in range(60):
        digits, size, rows = rng.integers(0, 5), rng.integers(-1, 6), rng.integers(1, 5)
        values = np.round(10.0 ** rng.uniform(-1, size, (rows, 2)), digits) + 1
        cells = [[f"{value:,.{digits}f}" for value in row] for row in values]
        signs = str.maketrans({",": thousands or None, ".": decimal})
        lines = [separator.join(f'"{c.translate(signs)}"' for c in row) for row in cells]
        text = "\n".join([f"load_N_per_mm{separator}penetration_mm", *lines])
        try:
            actual = read(tmp_path / "t.csv", text)
        except InputError as error:
            rules.append(error.rule)
            continue
        read_right += 1
        assert actual.load == pytest.approx(values[:, 0], rel=1e-12)
        assert actual.penetration == pytest.approx(values[:, 1], rel=1e-12)
    assert read_right >= 10
    assert all("thousands" in rule or "and other numbers a point" in rule for rule in rules)
