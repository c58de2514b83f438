"""Tables of machines: read as they come, or refused with a remedy that works; never wrong."""

import gzip
import re
import subprocess
from collections import Counter
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings

from cylcontact import InputError
from cylcontact.datasets.measurements import measurements_of, read_measured
from cylcontact.datasets.reading import TableSpec, read_readings
from cylcontact.files.numbers import numbers as read_numbers
from cylcontact.files.sheet import read_sheet
from cylcontact.files.units import LENGTHS, column_named
from cylcontact.fitting import read_result
from tests.support.machine_files import (
    DEPTH,
    FORCE_UNITS,
    LENGTH,
    LENGTH_UNITS,
    LOAD,
    OPTIONS,
    ROWS,
    forms,
    rows,
    workbook,
)
from tests.support.random_layouts import (
    CONSTANTS,
    KINDS,
    SEPARATORS,
    layouts,
    read_with_remedies,
)

FORMS = forms()
# With points between thousands.
GERMAN = [f"{a:,.1f}".translate(str.maketrans(",.", ".,")) for a in LOAD]


def read(path, **keys):
    return measurements_of(
        read_measured(path, "internal", CONSTANTS, spec=TableSpec(**keys)), str(path)
    )


def is_truth(data):
    same = np.allclose(data.load * LENGTH, LOAD, rtol=1e-9, atol=0) and len(data) == ROWS
    return same and np.allclose(data.penetration, DEPTH, rtol=1e-9, atol=0)


# --- as it comes --------------------------------------------------------------------------------


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.name)
def test_a_file_is_read_as_it_is(tmp_path, form):
    path = tmp_path / "t.TRA"
    path.write_bytes(form.content.encode(form.encoding))
    data = read(path, **form.keys)
    assert len(data) == ROWS
    assert data.load * LENGTH == pytest.approx(LOAD, rel=1e-9)
    assert data.penetration == pytest.approx(DEPTH, rel=1e-9)
    block = "\n".join(data.read)
    assert block.startswith(f"read {ROWS} rows of 't.TRA', line")
    assert "\n!" not in block
    for words in form.said.split("; "):
        assert words in block


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.name)
def test_every_line_is_read_or_listed(tmp_path, form):
    """Each line with cells is a row, the names, the units, or among those left out."""
    if "branch" in form.keys:
        form = replace(form, keys={"loads": "5:"})  # of branches only the number of rows is said
    path = tmp_path / "t.csv"
    path.write_bytes(form.content.encode(form.encoding))
    data = read(path, **form.keys)
    text = form.content.replace("\r", "\n").removeprefix("\ufeff").split("\n")
    filled = {n for n, line in enumerate(text, 1) if line.strip("\t; ") and "sep=" not in line}
    named = set()
    for line in data.read[1:]:
        for numbers in re.findall(r"lines? (\d[\d, to]*)", line):
            for part in numbers.strip(", ").split(", "):
                first, _, last = part.partition(" to ")
                named |= {*range(int(first), int(last or first) + 1)}
    missing = filled - named - {*data.data.lines}
    # The line of the names, and none else.
    assert len(missing) == (0 if "no names" in form.name else 1)


def test_times_of_a_clock_and_of_dates_are_seconds(tmp_path):
    for name in ("clock", "dates"):
        form = next(form for form in FORMS if form.name == name)
        (tmp_path / "t.csv").write_text(form.content, encoding="utf-8")
        time = read(tmp_path / "t.csv").columns["time"]
        assert time - time[0] == pytest.approx(np.arange(ROWS))


def test_dates_over_midnight_and_a_typographic_minus(tmp_path):
    rows = "2024-01-01T23:59:00,100,−0.5\n2024-01-03T00:01:00,200,−0.25\n"
    (tmp_path / "t.csv").write_text(f"Time,Force [N],Displacement [mm]\n{rows}", encoding="utf-8")
    data = read(tmp_path / "t.csv", sign="neither")
    assert np.diff(data.columns["time"]) == pytest.approx([86_520])
    assert data.penetration.tolist() == [-0.5, -0.25]


def test_units_are_those_of_the_definitions():
    for text, value in FORCE_UNITS.items():
        column = column_named(f"Force [{text}]")
        assert (column.quantity, column.factor) == ("load", pytest.approx(value, rel=1e-14))
        for length, size in LENGTH_UNITS.items():
            column = column_named(f"Line load ({text}/{length})")
            assert column.factor == pytest.approx(value / size, rel=1e-14)
    for text, value in LENGTH_UNITS.items():
        assert column_named(f"Travel in {text}").factor == pytest.approx(value, rel=1e-14)
    assert len(LENGTHS) == len(LENGTH_UNITS)


def test_the_sheet_of_load_and_penetration_is_read(tmp_path):
    notes = [["Force and travel of pin 3"], ["Operator", "XY"], ["Width", 6.0]]
    head = [["Report"], [], ["Nr.", "Force\n[N]", "Displacement\n[mm]"]]
    table = [[k, *each] for k, each in enumerate(zip(LOAD.tolist(), DEPTH.tolist(), strict=True))]
    double = [[k, 2 * f, w] for k, f, w in table]
    path = workbook(
        tmp_path / "t.xlsx", {"Notes": notes, "One": head + table, "Two": head + double}
    )
    data = read(path)
    assert is_truth(data)
    assert "sheet 'One' of 3, the first of 2 with such columns (--sheet)" in data.read[2]
    assert is_truth(read(path, header=3))  # of the sheets that have such a row
    assert read(path, sheet="Two").load == pytest.approx(2 * LOAD / LENGTH)
    with pytest.raises(InputError, match="sheet = 'Three': is not a sheet with cells; it has 'N"):
        read(path, sheet="Three")


def test_specimens_with_a_number_sign_stay_in_workbooks(tmp_path):
    cells = zip(["A", "#2", "#3"] * 3, LOAD.tolist(), DEPTH.tolist(), strict=True)
    table = [["Specimen", "Force [N]", "Travel [mm]"], *map(list, cells), ["#A", 5.0, 0.5]]
    data = read(workbook(tmp_path / "t.xlsx", {"one": table}), group="Specimen")
    assert is_truth(data)
    assert set(data.data.labels["group"]) == {"A", "#2", "#3"}
    assert f"left out: row {ROWS + 2} with # in front" in data.read[1]


# --- signs and ranges ---------------------------------------------------------------------------


def frame(load, depth):
    return pd.DataFrame({"load_N": load, "penetration_mm": depth})


def test_a_sign_that_is_likely_is_named_and_an_option_turns_it():
    data = read(frame(LOAD, 1 - DEPTH))
    assert "! the penetration falls as the load rises" in data.read[-1]
    assert data.penetration == pytest.approx(1 - DEPTH)
    turned = read(frame(LOAD, 1 - DEPTH), sign="penetration")
    assert turned.penetration == pytest.approx(DEPTH - 1)
    assert not any(line.startswith("!") for line in turned.read)
    assert read(frame(-LOAD, DEPTH), sign="load").load == pytest.approx(LOAD / LENGTH)


def test_neither_sign_is_turned_where_that_is_said():
    assert read(frame(LOAD, -DEPTH), sign="neither").penetration == pytest.approx(-DEPTH)
    with pytest.raises(InputError, match=r"row 1: load_N = -64.0: must be positive.*--sign load"):
        read(frame(-LOAD, -DEPTH), sign="neither")


def test_a_specimen_that_breaks_is_no_wrong_sign():
    """Behind the largest load the travel goes on while the load falls."""
    load = np.concatenate([LOAD, np.linspace(6000, 40, 30)])
    depth = np.concatenate([DEPTH, np.linspace(0.02, 0.3, 30)])
    data = read(frame(load, depth))
    assert data.penetration == pytest.approx(depth)
    assert not any(line.startswith("!") for line in data.read)
    # A table in falling order of its loads has the sign of its rows.
    assert is_truth(read(frame(LOAD[::-1], -DEPTH[::-1])).take(np.arange(ROWS)[::-1]))


@pytest.mark.parametrize(
    ("loads", "kept"), [("700:", 6), (":700", 3), ("310:1250", 3), ("-1:1e9", ROWS)]
)
def test_rows_outside_a_range_of_loads_are_left_out(loads, kept):
    data = read(frame(LOAD, DEPTH), loads=loads)
    assert len(data) == kept
    assert "rows with loads" in data.read[1] if kept < ROWS else len(data.read) == 1, data.read


# --- refusals -----------------------------------------------------------------------------------

# What is in the file, the keys, where it is refused, and what is said.
REFUSED = [
    ("F [N],w [mm]\n1,0.1\n2,x\n", {}, ", line 3: w [mm] = 'x'", "must be a finite number"),
    ("#N,F [N],w [mm]\n1,2,0.1\n2,#N/A,0.2\n", {}, ", line 3: F [N] = '#N/A'", "must be a finite"),
    ("F [N],w [mm]\n#N/A,0.1\n2,0.2\n", {}, ", line 2: F [N] = '#N/A'", "must be a finite"),
    ("F [N],w [mm]\n1,0.1\n2,\n", {}, ", line 3: w [mm]", "is empty"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\nMean,0.3\n", {}, ", line 4: F [N] = 'Mean'", "finite"),
    ("F [N],w [mm]\n1,0.1\n2\n", {}, ", line 3: has 1 cell for 2 columns", "others with #"),
    ('A;"B\nF [N];w [mm];n\n1;0,1;a\n2;0,2;"b"\n', {}, ": is not a CSV table", "a quote is open"),
    ("F [N],w [mm]\n1,0.1\nF [N],s [mm]\n2,0.2\n", {}, ", line 3: F [N] = 'F [N]'", "--header 3"),
    ("F [N];w [mm]\n10;0,5\n1.000;0,00111\n", {"decimal": "."}, ", line 2: w [mm] = '0,5'",
     "does not have its decimals marked by '.'"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"loads": "5:"}, ": loads = '5:'", "its loads are 1 to 2"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"loads": "9:5"}, ": loads = '9:5'", "lower end first"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"loads": "5"}, ": loads = '5'", "write e.g. 5:400"),
    ("F (x10) [N],w [mm]\n1,0.1\n2,0.2\n", {}, ": columns = 'F (x10) [N]'",
     "--columns 'load [10 N]=F (x10) [N]' if it is 10 N, or --columns 'load [0.1 N]=F (x10) [N]'"),
    ("F [N],w [Âµm]\n1,0.1\n2,0.2\n", {"columns": {"penetration": "2"}}, ": columns.penetration",
     "has no unit that is known"),
    ("F [N],Weg [Âµm]\n1,0.1\n2,0.2\n", {}, ": columns = 'Weg [Âµm]'", "not known, 'Âµm'"),
    ("F [N],Weg (tf)\n1,0.1\n2,0.2\n", {}, ": columns = 'Weg (tf)'", "not known, 'tf'"),
    ("F [N],Weg (LVDT)\n1,0.1\n2,0.2\n", {}, ": columns = 'Weg (LVDT)'",
     "say its unit with --columns 'penetration_UNIT=Weg (LVDT)'"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"exclude": ("7",)}, ": exclude = '7'", "they are lines 2, 3"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"exclude": ("b.csv:2",)}, ": exclude", "of another file"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"exclude": ("2", "3")}, ": exclude", "leaves no row"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"encoding": "moon"}, ": encoding = 'moon'", "not a known"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"separator": "tab"}, ": holds no rows", "below the names"),
    ("F,w\n1.500 kN,0.1 mm\n2 N,0.2 mm\n", {"columns": {"load_N": "1"}}, ", line 2: F = '1.500 kN'",
     "must be a finite number"),
    ("F [N],w [mm]\nkN,mm\n1,2\n", {"columns": {"load": "F [N]"}}, ": columns.load", "has no unit"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"sheet": "A"}, ": sheet = 'A'", "leave it out"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"header": 7}, ": header = 7", "is no line with"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"columns": {"weight": "1"}}, ": columns.weight", "a known"),
    ("a,w [mm]\n1,0.1\n2,0.2\n", {"columns": {"load_UNIT": "a"}}, ": columns.load_UNIT", "unit"),
    ("a,w [mm]\n1,0.1\n2,0.2\n", {"columns": {"load_N": "3"}}, ": columns.load_N = '3'", "a, w"),
    ("dR (furlong),F [N],w [mm]\n1,2,3\n", {"_without": "R_j_mm"}, ": columns = 'dR (furlong)'",
     "has a unit that is not known, 'furlong'"),
]  # fmt: skip


@pytest.mark.parametrize(("content", "keys", "where", "said"), REFUSED)
def test_a_file_in_doubt_is_refused_at_its_cell(tmp_path, content, keys, where, said):
    path = tmp_path / "t.csv"
    path.write_text(content, encoding="utf-8")
    left = keys.get("_without")
    constants = {n: v for n, v in CONSTANTS.items() if left is None or n not in (left, "R_i_mm")}
    spec = TableSpec(**{name: value for name, value in keys.items() if name != "_without"})
    with pytest.raises(InputError) as caught:
        read_measured(path, "internal", constants, spec=spec)
    message = str(caught.value)
    assert message.startswith(f"{path}{where}")
    assert said in message
    assert len(message.splitlines()) == 1


# What is no table, by its first bytes.
KINDS_OF_FILES = {
    "a web page": (b"<html><body><table><tr><td>1</td></tr></table>", "is a web page (HTML)"),
    "XML": (b'<?xml version="1.0"?><Workbook>', "is an XML file"),
    "MATLAB": (b"MATLAB 5.0 MAT-file, Platform: GLNXA64", "is a MATLAB file"),
    "HDF5": (b"\x89HDF\r\n\x1a\n", "is an HDF5 file"),
    "LabVIEW": (b"TDSm\x0e\0\0\0", "is a TDMS file of LabVIEW"),
    "zip": (b"PK\x03\x04....", "is an archive (zip)"),
    "OpenDocument": (
        b"PK\x03\x04mimetypeapplication/vnd.oasis.opendocument.spreadsheet",
        "is a workbook of OpenDocument",
    ),
    "xz": (b"\xfd7zXZ\0", "is compressed by xz"),
    "damaged gzip": (gzip.compress(b"F [N],w [mm]\n1,2\n")[:-9], "is a damaged gzip file"),
    "another alphabet": ("Время (с),Сила (Н)\n1,2\n".encode("cp1251"), "--encoding cp1251"),
    "Chinese": ("时间,力 (N),位移\n1,2,3\n".encode("gbk"), "in an encoding that is not known"),
}


@pytest.mark.parametrize("kind", KINDS_OF_FILES)
def test_a_file_that_is_no_table_is_called_what_it_is(tmp_path, kind):
    content, said = KINDS_OF_FILES[kind]
    (tmp_path / "t.xls").write_bytes(content)
    with pytest.raises(InputError) as caught:
        read(tmp_path / "t.xls")
    assert said in str(caught.value)


def test_a_table_compressed_by_gzip_and_a_workbook_under_another_name_are_read(tmp_path):
    text = f"F [N],w [mm]\n{rows(LOAD, DEPTH)}"
    (tmp_path / "t.csv.gz").write_bytes(gzip.compress(text.encode()))
    assert is_truth(read(tmp_path / "t.csv.gz"))
    cells = [["F [N]", "w [mm]"], *map(list, zip(LOAD.tolist(), DEPTH.tolist(), strict=True))]
    book = workbook(tmp_path / "t.xlsx", {"one": cells})
    assert is_truth(read(book.rename(tmp_path / "t.xls")))


# --- several files ------------------------------------------------------------------------------


@pytest.fixture
def three(tmp_path):
    """The truth in three files of different layout and units."""
    parts = [slice(0, 3), slice(3, 6), slice(6, None)]
    texts = [
        "F [N],w [mm]\n" + rows(LOAD[parts[0]], DEPTH[parts[0]]),
        "Kraft [kN];Weg [µm]\n"
        + rows(LOAD[parts[1]] / 1e3, DEPTH[parts[1]] * 1e3, separator=";", mark=","),
        "w [mm]\tF [N]\n" + rows(DEPTH[parts[2]], LOAD[parts[2]], separator="\t"),
    ]
    paths = [tmp_path / name for name in ("a.csv", "b.csv", "c.txt")]
    for path, text in zip(paths, texts, strict=True):
        path.write_text(text, encoding="utf-8")
    return paths


def test_several_files_are_read_as_one_table(three):
    data = read(three)
    assert is_truth(data)
    assert [data.line(k) for k in (0, 3, 8)] == ["a.csv:2", "b.csv:2", "c.txt:4"]
    assert data.groups("rows")[0][3] == "line b.csv:2"  # not one with line 2 of a.csv
    assert "3 files (--group file takes each as a series)" in data.read[-1]
    names, of_row = read(three, group="file").groups("group")
    assert names == ["a.csv", "b.csv", "c.txt"]
    assert of_row.tolist() == [0] * 3 + [1] * 3 + [2] * (ROWS - 6)


def test_a_row_is_excluded_by_its_file_and_line(three):
    data = read(three, exclude=("b.csv:3",))
    assert data.load * LENGTH == pytest.approx(np.delete(LOAD, 4))
    assert "left out: 1 row excluded (line 3)" in "\n".join(data.read)
    with pytest.raises(InputError, match=r"'3': is not a row of a\.csv or of b\.csv"):
        read(three, exclude=("3",))


def test_a_column_may_be_named_in_one_of_several_files(three):
    three[0].write_text("Kanal [N],w [mm]\n" + rows(LOAD[:3], DEPTH[:3]), encoding="utf-8")
    assert is_truth(read(three, columns={"load": "Kanal [N]"}))
    with pytest.raises(InputError, match="'Hub': is a column of none of the tables"):
        read(three, columns={"load_N": "Hub"})


def test_several_files_that_do_not_fit_together_are_refused(three):
    with pytest.raises(InputError, match=r"has no one unit: loads of a\.csv in N, b\.csv in kN"):
        read(three, loads="5:")
    with pytest.raises(InputError, match="is given twice; give each table once"):
        read([three[0], three[0]])
    three[2].write_text("w [mm],F [N],t_ms,load_std_N\n1,2,3,4\n2,3,4,5\n")
    with pytest.raises(InputError, match=r"a\.csv: load_std: is not given, and c\.txt has it"):
        read(three)
    assert "time" not in read(three, ignore=("load_std_N",)).columns


def test_a_mark_of_decimals_and_a_sheet_are_for_the_files_that_need_them(three, tmp_path):
    three[1].write_text("F [N];w [mm]\n" + rows(GERMAN[3:6], DEPTH[3:6], separator=";", mark=","))
    with pytest.raises(InputError, match="separators of thousands"):
        read(three)
    assert is_truth(read(three, decimal=","))
    cells = [["F [N]", "w [mm]"], *map(list, zip(LOAD.tolist(), DEPTH.tolist(), strict=True))]
    sheets = {"one": cells[:1] + cells[1:4], "two": cells[:1] + cells[4:7]}
    book = workbook(tmp_path / "t.xlsx", sheets)
    data = read([three[0], book, three[2]], sheet="two")
    assert is_truth(data)


def test_files_of_one_name_are_told_apart_by_their_paths(tmp_path):
    paths = [tmp_path / name / "t.csv" for name in "ab"]
    for path in paths:
        path.parent.mkdir()
        path.write_text(f"F [N],w [mm]\n{rows(LOAD, DEPTH)}")
    assert set(read(paths).data.labels["file"]) == set(map(str, paths))
    frames = [frame(LOAD[:5], DEPTH[:5]), frame(LOAD[5:], DEPTH[5:])]
    assert is_truth(read(frames))
    assert read(frames).line(6) == "DataFrame 2:2"


# --- remedies -----------------------------------------------------------------------------------

# A word of a shell.
WORD = r"""(?:[^\s'";,]|'[^']*'|"[^"]*")+"""
SEMI = {"separator": ";", "mark": ","}
TWO = "Results 1\nLoad,Extension,Area\n(N),(mm),(m2)\n9,8,7\n\n"
# A file that is refused, options given before, and in what order to paste what errors offer: `UNIT`
# stands for the unit that the user knows.
REMEDIES = {
    "no unit in the names": ("Force;Extension (in)\n", (LOAD, DEPTH / 25.4), SEMI, "N"),
    "mm below, an unknown word": ("Force;Fuehler\nN;mm\n", (LOAD, DEPTH), SEMI, ""),
    "a word with brackets": ("Kanal 1 [kN];Taster (in)\n", (LOAD / 1e3, DEPTH / 25.4), SEMI, ""),
    "a quote in a name": ("Load's (kN);d'un (µm)\n", (LOAD / 1e3, DEPTH * 1e3), SEMI, ""),
    "a mass as a force": ("Load (kg);Extension (mm)\n", (LOAD / 9.80665, DEPTH), SEMI, ""),
    "two loads": ("Load (N);Force (N);Depth (mm)\n", (LOAD, LOAD * 3, DEPTH), SEMI, ""),
    "two of one name": ("F (N);F (N);Depth (mm)\n", (LOAD, LOAD * 3, DEPTH), SEMI, ""),
    "points of thousands": ("Kraft [N];Weg [mm]\n", (GERMAN, DEPTH), SEMI, ""),
    "no names": ("", (LOAD, DEPTH), SEMI, "N mm"),
    "a factor": ("Kraft (x10) [N];Weg_x1000_mm\n", (LOAD / 10, DEPTH * 1e3), SEMI, "first second"),
    "a factor of another word": ("Kanal x10 [N];Weg [mm]\n", (LOAD / 10, DEPTH), SEMI, "10_N"),
    "powers": ("Kanal 10^3 N;Taster/10^-3 mm\n", (LOAD / 1e3, DEPTH * 1e3), SEMI, ""),
    "below zero": ("F [N];w [mm]\n-0,2;0,001\n", (LOAD, DEPTH), SEMI, ""),
    "two tables": (f"{TWO}Load,Depth,Nr\n(N),(mm),\n", (LOAD, DEPTH, [1] * ROWS), {}, ""),
}


@pytest.mark.parametrize("name", REMEDIES)
def test_a_remedy_pasted_into_a_shell_reads_the_truth(tmp_path, run, name):
    head, columns, style, units = REMEDIES[name]
    table, out, known = tmp_path / "my table.csv", tmp_path / "fit.json", units.split()
    table.write_text(head + rows(*columns, **style), encoding="utf-8")
    command = ["fit", table, *OPTIONS, "--length", LENGTH, "--law", "explicit", "--runs", 1]
    command += ["-j", 1, "-o", out]
    code, _, errors = run(*command)
    assert code == 2
    for _ in range(3):
        offered = re.findall(rf"--(?:columns|ignore|decimal|header|loads) {WORD}", errors)
        assert offered, errors
        wanted = [one for one in offered if one.startswith("--columns")] or offered[:1]
        if "if it is" in errors and len(wanted) > 1:  # one of two choices, which the user knows
            wanted = [wanted[("first", "second").index(known.pop(0))]]
        if "UNIT" in " ".join(wanted):  # pasted as it is, it asks for the unit
            code, _, errors = run(*command, *pasted(wanted))
            assert code == 2
            assert "needs its unit" in errors
            wanted = [one.replace("UNIT", known.pop(0)) if "UNIT" in one else one for one in wanted]
        command += pasted(wanted)
        code, _, errors = run(*command)
        if code == 0:
            break
    assert (code, errors) == (0, "")
    assert is_truth(read_result(out).data)


def pasted(options):
    """The words that bash makes of options."""
    command = ["bash", "-c", f"printf '%s\\0' {' '.join(options)}"]
    said = subprocess.run(command, capture_output=True, check=True)
    return said.stdout.decode().split("\0")[:-1]


# --- layouts at random --------------------------------------------------------------------------


def count_layouts(path, separator, kind, examples):
    """Read layouts at random, and paste what is offered; return how many were read at once, with
    remedies, or not at all.
    """
    counts = Counter()

    @settings(max_examples=examples)
    @given(layouts(separator, kind))
    def is_right_or_refused(layout):
        path.write_bytes(layout.content)
        data, pasted = read_with_remedies(path, layout)
        counts["refused" if data is None else "pasted" if pasted else "read"] += 1
        if data is not None:
            load = np.array(data.numbers["load"]) * LENGTH
            assert load == pytest.approx(layout.load[layout.load > 0], rel=1e-11, abs=0), pasted
            depth = layout.penetration[layout.load > 0]
            assert data.numbers["penetration"] == pytest.approx(depth, rel=1e-11, abs=0), pasted

    is_right_or_refused()
    return counts


@pytest.mark.parametrize("examples", [10, pytest.param(400, marks=pytest.mark.long)])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("separator", SEPARATORS)
def test_a_random_layout_is_read_right_or_refused(tmp_path, separator, kind, examples):
    """With every remedy that the reader prints pasted, no number is wrong."""
    counts = count_layouts(tmp_path / "t.txt", separator, kind, examples)
    assert counts["read"] + counts["pasted"] > 0.8 * counts.total(), counts


# --- size ---------------------------------------------------------------------------------------


def test_columns_read_at_once_are_those_read_cell_by_cell(tmp_path, monkeypatch):
    """Of many rows a plain column is read at once; other notations take each cell."""
    rng = np.random.default_rng(4)
    numbers = 10 ** rng.uniform(-9, 9, 400) * rng.choice([-1, 1], 400)
    texts = [[format(x, form) for x in numbers] for form in (".7g", ".3f", "+.9E", ".0f")]
    path = tmp_path / "t.csv"
    for separator, mark in ((",", "."), (";", ","), ("\t", ".")):
        path.write_text("a,b,c,d\n".replace(",", separator) + rows(
            *([x.replace(".", mark) for x in column] for column in texts), separator=separator
        ))  # fmt: skip
        sheet = read_sheet(path)
        at_once = [read_numbers(sheet, k) for k in range(4)]
        with monkeypatch.context() as patched:
            patched.setattr("cylcontact.files.numbers._plain_column", lambda *_: None)
            assert [read_numbers(sheet, k) for k in range(4)] == at_once


@pytest.mark.slow
def test_a_hundred_thousand_rows_are_read(tmp_path):
    count = 100_000
    load = np.linspace(10.0, 5000.0, count)
    text = rows(np.arange(count) / 100, load, load * 1e-6, separator=";", mark=",")
    (tmp_path / "t.csv").write_text(f"Zeit;Kraft;Weg\ns;N;mm\n{text}", encoding="utf-8")
    readings = read_readings(tmp_path / "t.csv", TableSpec())
    assert readings.numbers["load"] == pytest.approx(load, rel=1e-11)
