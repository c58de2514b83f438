"""Tables of machines: read as they come, or refused with a remedy that works; never wrong."""

import re
import subprocess
import time
from collections import Counter
from dataclasses import replace

import numpy as np
import openpyxl
import pandas as pd
import pytest
from hypothesis import given, settings

from cylcontact import InputError
from cylcontact.datasets.measurements import measurements_of, read_measured
from cylcontact.datasets.reading import TableSpec, read_readings
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
    layouts,
    rows,
)

CONSTANTS = {"E_GPa": 207.0, "nu": 0.3, "R_i_mm": 10.0, "R_j_mm": 9.97, "length_mm": LENGTH}
SEPARATORS = (",", ";", "\t", "|", " ")
FORMS = forms()


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


def workbook(path, **sheets):
    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, cells in sheets.items():
        sheet = book.create_sheet(title)
        for row in cells:
            sheet.append(row)
    book.save(path)
    return path


def test_the_sheet_of_load_and_penetration_is_read(tmp_path):
    notes = [["Force and travel of pin 3"], ["Operator", "XY"], ["Width", 6.0]]
    head = [["Report"], [], ["Nr.", "Force\n[N]", "Displacement\n[mm]"]]
    table = [[k, *each] for k, each in enumerate(zip(LOAD.tolist(), DEPTH.tolist(), strict=True))]
    double = [[k, 2 * f, w] for k, f, w in table]
    path = workbook(tmp_path / "t.xlsx", Notes=notes, One=head + table, Two=head + double)
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
    data = read(workbook(tmp_path / "t.xlsx", one=table), group="Specimen")
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
    with pytest.raises(InputError, match=r"row 1: load_N = -64.0: must be positive.*--loads 0:"):
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
    ("F [N],w [mm]\n1,0.1\nF [N],w [mm]\n2,0.2\n", {}, ", line 3: F [N] = 'F [N]'", "--header 3"),
    ("F [N];w [mm]\n10;0,5\n1.000;0,00111\n", {"decimal": "."}, ", line 2: w [mm] = '0,5'",
     "does not have its decimals marked by '.'"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"loads": "5:"}, ": loads = '5:'", "its loads are 1 to 2"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"loads": "9:5"}, ": loads = '9:5'", "lower end first"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"loads": "5"}, ": loads = '5'", "write e.g. 5:400"),
    ("F [N],w [mm]\nkN,mm\n1,2\n", {"columns": {"load": "F [N]"}}, ": columns.load", "has no unit"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"sheet": "A"}, ": sheet = 'A'", "leave it out"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"header": 7}, ": header = 7", "is no line with"),
    ("F [N],w [mm]\n1,0.1\n2,0.2\n", {"columns": {"weight": "1"}}, ": columns.weight", "is gone"),
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


# --- remedies -----------------------------------------------------------------------------------

# A word of a shell.
WORD = r"""(?:[^\s'";,]|'[^']*'|"[^"]*")+"""
SEMI = {"separator": ";", "mark": ","}
GERMAN = [f"{a:,.1f}".translate(str.maketrans(",.", ".,")) for a in LOAD]
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


def count_layouts(path, separator, examples):
    """Read layouts at random; return how many were right and how many refused."""
    counts = Counter()

    @settings(max_examples=examples)
    @given(layouts(separator))
    def is_right_or_refused(layout):
        path.write_bytes(layout.content)
        try:
            readings = read_readings(path, TableSpec())
        except InputError as error:
            counts["refused"] += 1
            if "thousands" not in error.rule:
                return
            readings = read_readings(path, TableSpec(decimal=layout.mark))
        if not {"load", "penetration"} <= readings.numbers.keys():
            counts["refused"] += 1
            return
        counts["right"] += 1
        for name, values in readings.numbers.items():
            if name in ("load", "penetration"):
                assert values == pytest.approx(getattr(layout, name), rel=1e-12, abs=0)

    is_right_or_refused()
    return counts


@pytest.mark.parametrize("examples", [100, pytest.param(2000, marks=pytest.mark.long)])
@pytest.mark.parametrize("separator", SEPARATORS)
def test_a_random_layout_is_read_right_or_refused(tmp_path, separator, examples):
    counts = count_layouts(tmp_path / "t.txt", separator, examples)
    assert counts["right"] > 0.6 * counts.total()


# --- size ---------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_hundred_thousand_rows_are_read_in_a_moment(tmp_path):
    count = 100_000
    load = np.linspace(10.0, 5000.0, count)
    text = rows(np.arange(count) / 100, load, load * 1e-6, separator=";", mark=",")
    (tmp_path / "t.csv").write_text(f"Zeit;Kraft;Weg\ns;N;mm\n{text}", encoding="utf-8")
    started = time.process_time()
    assert len(read_readings(tmp_path / "t.csv", TableSpec()).sheet.lines) == count
    assert time.process_time() - started < 1.5
