"""Files that are too large or too strange are refused in one line, before work and memory."""

import os
from pathlib import Path

import pytest

from cylcontact import InputError
from cylcontact.journal import Journal
from cylcontact.mechanism import Trajectory
from cylcontact.reading import SPEC_BYTES, TABLE_BYTES, plain_integer, plain_number
from cylcontact.spec import read_toml
from cylcontact.tables import MAX_CELLS, MAX_COLUMNS, MAX_ROWS, finite_numbers, read_table
from tests import large_input as large
from tests.counts import counted
from tests.programs import require_package
from tests.spec_files import write_bench

HEAD = "load_N_per_mm,penetration_um\n"
TOML = ("fit", "fit.toml", "-j", "1", "-o", "out.json")
RESULT = ("compare", "fit.json")
TABLE_OPTIONS = ("--law", "power", "--contact", "internal", "-j", "1", "-o", "out.json")

PAIR = ("--E", "207000", "--nu", "0.3", "--dR", "0.05")


def table(name):
    return ("fit", name, *TABLE_OPTIONS)


CSV, XLSX, PARQUET = (table(name) for name in ("t.csv", "t.xlsx", "t.parquet"))
MATERIALS = (*table("small.csv"), "--materials", "mine.csv", "--material", "steel", "--dR", "1")
LAW = ("fit", "small.csv", "--law", "mine:load", *TABLE_OPTIONS[2:], *PAIR)
TOO_LARGE, DEEP = "is 3.2 GB (at most", "it is nested too deeply"
LONG_KEY = "has a key of more than 32 parts; no spec needs more than four"
DIGITS = "a number has too many digits"
# A name, the command, the file that it reads, what writes it, and what is said.
SLOW = {"a million rows of a workbook", "empty rows of a workbook", "a workbook that unpacks"}
CASES = [
    # Sizes.
    ("a large spec", TOML, "fit.toml", large.hole, f"fit.toml: {TOO_LARGE} 1 MB)"),
    ("a large result", RESULT, "fit.json", large.hole, f"fit.json: {TOO_LARGE} 100 MB)"),
    ("a large CSV", CSV, "t.csv", large.hole, f"t.csv: {TOO_LARGE} 100 MB)"),
    ("a large workbook", XLSX, "t.xlsx", large.hole, f"t.xlsx: {TOO_LARGE} 100 MB)"),
    ("a large Parquet file", PARQUET, "t.parquet", large.hole, f"t.parquet: {TOO_LARGE} 100 MB)"),
    ("a large table of materials", MATERIALS, "mine.csv", large.hole, f"{TOO_LARGE} 100 MB)"),
    ("a large module", LAW, "mine.py", large.hole, f"{TOO_LARGE} 1 MB)"),
    # TOML.
    ("a key of many parts", TOML, "fit.toml", large.text("a." * 200_000 + "a = 1"), LONG_KEY),
    ("a quoted key", TOML, "fit.toml", large.text('a = {"b" . ' + "'c'." * 40 + "d=1}"), LONG_KEY),
    ("the name of a table", TOML, "fit.toml", large.text("[" + "a." * 99_999 + "a]"), LONG_KEY),
    ("deep lists", TOML, "fit.toml", large.text("a = " + large.nested(200_000)), DEEP),
    ("deep tables", TOML, "fit.toml", large.text("a = " + "{a = " * 100_000), DEEP),
    ("a long integer", TOML, "fit.toml", large.text("seed = " + "9" * 100_000), DIGITS),
    ("a long hexadecimal", TOML, "fit.toml", large.text("seed = 0x" + "f" * 900_000), DIGITS),
    ("a long list", TOML, "fit.toml", large.text("a = [" + "1," * 490_000 + "]"), "fit.toml: "),
    ("many keys", TOML, "fit.toml", large.text("\n".join(f"k{k}=1" for k in range(90_000))), "k0"),
    ("many tables", TOML, "fit.toml", large.text("[[a.b]]\n" * 120_000), "fit.toml: "),
    ("UTF-16", TOML, "fit.toml", large.text("law = 1".encode("utf-16")), "is not a text file"),
    # JSON.
    ("deep JSON", RESULT, "fit.json", large.text(large.nested(1_000_000)), DEEP),
    ("deep objects", RESULT, "fit.json", large.text('{"a":' * 500_000), DEEP),
    ("a long number", RESULT, "fit.json", large.text("9" * 100_000), DIGITS),
    ("a mark before JSON", RESULT, "fit.json", large.text("\ufeff[]"), "is not a result"),
    ("UTF-16 in JSON", RESULT, "fit.json", large.text("{}".encode("utf-16")), "is not a text"),
    # CSV.
    ("many rows", CSV, "t.csv", large.text(HEAD + "1,2\n" * 5_000_000), f"at most {MAX_ROWS}"),
    ("many columns", CSV, "t.csv", large.text("a," * 2000 + "b\n"), f"at most {MAX_COLUMNS}"),
    ("a million columns", CSV, "t.csv", large.text("a," * 1_000_000), "field larger than"),
    (
        "many cells",
        *(CSV, "t.csv", large.text("a," * 499 + "b\n" + ("1," * 499 + "2\n") * 50_000)),
        f"cells or more (at most {MAX_CELLS})",
    ),
    ("a long cell", CSV, "t.csv", large.text(HEAD + "1" * 1_000_000 + ",2\n"), "field larger than"),
    (
        "an open quote",
        CSV,
        "t.csv",
        large.text(HEAD + '"' + "1\n" * 900_000),
        "field larger than",
    ),
    ("one long line", CSV, "t.csv", large.text("1" * 60_000_000), "field larger than"),
    ("a zero byte", CSV, "t.csv", large.text(HEAD + "1,\0\n"), "it holds zero bytes"),
    ("UTF-16 without a mark", CSV, "t.csv", large.text(HEAD.encode("utf-16-le")), "zero bytes"),
    # Workbooks.
    (
        "a workbook that unpacks",
        *(XLSX, "t.xlsx", large.sheet(" " * 1_000_000 for _ in range(500))),
        "is unpacked to 500 MB (at most 400 MB)",
    ),
    (
        "a million rows of a workbook",
        *(XLSX, "t.xlsx", large.sheet(large.cells(k, "A", "B") for k in range(1, 1_000_001))),
        f"has {MAX_ROWS + 1} rows or more (at most {MAX_ROWS})",
    ),
    (
        "empty rows of a workbook",
        *(XLSX, "t.xlsx", large.sheet(["<row/>" * 1_000_000], "A1:XFD1048576"), "t.xlsx: is empty"),
    ),
    (
        "the last column of a workbook",
        *(XLSX, "t.xlsx", large.sheet(large.cells(k, "XFD") for k in range(1, 20_001))),
        f"has 16384 columns or more (at most {MAX_COLUMNS})",
    ),
    ("no workbook", XLSX, "t.xlsx", large.text("PK" * 1000), "is not an Excel workbook"),
    # Parquet.
    (
        "rows of Parquet",
        *(PARQUET, "t.parquet", large.parquet({"load_N": [1.0] * 2_000_000})),
        f"has 2000000 rows (at most {MAX_ROWS})",
    ),
    (
        "columns of Parquet",
        *(PARQUET, "t.parquet", large.parquet({f"c{k}": [1.0] for k in range(1500)})),
        f"has 1500 columns (at most {MAX_COLUMNS})",
    ),
    (
        "cells of Parquet",
        *(PARQUET, "t.parquet", large.parquet({f"c{k}": [1.0] * 150_000 for k in range(70)})),
        f"cells (at most {MAX_CELLS})",
    ),
    (
        "compressed Parquet",
        *(
            *(PARQUET, "t.parquet"),
            large.parquet(
                {"load_N": ["x" * 10_000 + str(k) for k in range(50_000)]},
                compression="zstd",
                use_dictionary=False,
            ),
            "is unpacked to 500 MB (at most 400 MB)",
        ),
    ),
    (
        "one text repeated in Parquet",
        *(PARQUET, "t.parquet", large.parquet({"load_N": ["x" * 1_000_000] * 2000})),
        "load_N = 'xxx",
    ),
    (
        "lists in Parquet",
        *(PARQUET, "t.parquet", large.parquet({"load_N": [[1.0], [2.0]]})),
        "load_N: holds lists or tables in its cells",
    ),
    ("a broken end of Parquet", PARQUET, "t.parquet", large.without_footer, "is not a Parquet"),
    ("no Parquet", PARQUET, "t.parquet", large.text("PAR1" * 100), "is not a Parquet table"),
]


def names():
    return {str(path) for path in Path().rglob("*")}


def refused(run, file, write, command, said):
    """Check that a command refuses a file in one line, and leaves nothing behind."""
    Path("small.csv").write_text(f"{HEAD}1,2\n2,3\n3,4\n")
    write(Path(file))
    before = names()
    with large.frugally():
        status, out, err = run(*command)
    assert (status, out) == (2, "")
    assert len(err.splitlines()) == 1
    assert said in err
    assert len(err) < 600
    assert names() == before


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(case, id=case[0], marks=pytest.mark.slow if case[0] in SLOW else ())
        for case in CASES
    ],
)
def test_a_file_over_a_limit_is_refused(case, run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    _, command, file, write, said = case
    refused(run, file, write, command, said)


def test_the_cases_are_counted():
    counted("files over a limit", len(CASES))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes here")
@pytest.mark.parametrize(
    ("command", "file"),
    [
        *((TOML, "fit.toml"), (RESULT, "fit.json"), (CSV, "t.csv"), (XLSX, "t.xlsx")),
        (PARQUET, "t.parquet"),
    ],
)
def test_a_pipe_is_refused_and_not_waited_for(command, file, run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refused(run, file, os.mkfifo, command, f"{file}: is a device, a pipe or a socket; name a file")


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="there are no devices here")
def test_a_device_is_refused(tmp_path):
    link = tmp_path / "t.csv"
    link.symlink_to("/dev/zero")
    for read in (read_table, read_toml, Trajectory.load):
        with large.frugally(), pytest.raises(InputError, match="is a device"):
            read(link)
    with pytest.raises(InputError, match="it is a link"):
        Journal(link, "sweep", "key")


def test_a_trajectory_is_read_from_a_file_alone(tmp_path):
    require_package("pyarrow")
    for name, write, rule in (
        ("folder", Path.mkdir, "Is a directory"),
        ("text", large.text("PAR1" * 100), "not a Parquet file"),
        ("broken", large.without_footer, "not a Parquet file"),
        ("table", large.parquet({"load_N": [1.0]}), "holds no trajectory"),
    ):
        path = tmp_path / name
        write(path)
        with pytest.raises(InputError, match=rule):
            Trajectory.load(path)


def test_a_limit_is_the_largest_that_is_read(tmp_path):
    path = tmp_path / "fit.toml"
    path.write_text("a = 1".ljust(SPEC_BYTES))
    assert read_toml(path) == {"a": 1}
    path.write_text("a = 1".ljust(SPEC_BYTES + 1))
    with pytest.raises(InputError, match=r"is 1 MB \(at most 1 MB\)"):
        read_toml(path)
    path.write_text("a." * 31 + "a = 1")
    assert read_toml(path)
    content = f"{HEAD}" + "1,2\n" * MAX_ROWS
    assert len(content) < TABLE_BYTES
    path = tmp_path / "t.csv"
    path.write_text(content)
    assert len(read_table(path).lines) == MAX_ROWS


def test_lines_may_end_as_on_an_old_macintosh(tmp_path):
    path = tmp_path / "t.csv"
    path.write_bytes(f"{HEAD}1,2\n3,4\n".replace("\n", "\r").encode())
    assert read_table(path).columns == [["1", "3"], ["2", "4"]]


# --- numbers ------------------------------------------------------------------------------------

NUMBERS = {"1": 1, "+1.5": 1.5, "-.5e-3": -5e-4, "2.": 2, " 7 ": 7, "1E5": 1e5, "007": 7}
NO_NUMBERS = (
    *("1_700", "１７００", "١٧٠٠", "0x10", "1e5j", "infinity", "inf", "nan", "-nan", "1e999"),
    *("", " ", ".", "e5", "1e", "--1", "1 700", "1,5", "½", "²", "1d5", "1\x00", "True"),
)


def test_numbers_are_those_that_a_spreadsheet_writes():
    assert {text: plain_number(text) for text in NUMBERS} == NUMBERS
    for text in NO_NUMBERS:
        with pytest.raises(ValueError, match="is not a number"):
            plain_number(text)
    for text in (*NO_NUMBERS, "1.0", "1e3"):
        with pytest.raises(ValueError, match="is not an integer"):
            plain_integer(text)
    assert [plain_integer(text) for text in ("12", "-3", " +4 ")] == [12, -3, 4]
    counted("texts that are no numbers", len(NO_NUMBERS))


@pytest.mark.parametrize("text", ["1_700", "１７００", "١٧٠٠", "0x10", "1e5j", "infinity", "nan"])
def test_no_place_takes_another_number(text, run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_bench(tmp_path)
    path = tmp_path / "t.csv"
    path.write_text(f"{HEAD}1,2\n3,{text}\n")
    with pytest.raises(InputError, match="must be a finite number"):
        finite_numbers(read_table(path), [0, 1])
    large.sheet([large.cells(1, "A"), f'<row r="2"><c r="A2" t="str"><v>{text}</v></c></row>'])(
        tmp_path / "t.xlsx"
    )
    with pytest.raises(InputError, match="must be a finite number"):
        finite_numbers(read_table(tmp_path / "t.xlsx"), [0])
    path.write_text(f"{HEAD}1,2\n3,4\n")
    for command in (
        *(("laws", "--nu", text), ("laws", "--E", text), ("laws", "--E", f"{text} GPa")),
        ("laws", "--load", text),
        ("figure", "fig12", "--font-size", text),
        *((*CSV, option, text) for option in ("--dR", "--nu", "--load-error", "--E", "--length")),
        *((*CSV, "--fix", f"n={text}"), (*CSV, "--bound", f"n=1:{text}")),
        *((*TOML, option, text) for option in ("--runs", "--seed", "--level")),
        ("fit", "fitting/small.toml", "-j", text),
        ("simulate", "none.toml", "--revolutions", text),
        ("simulate", "none.toml", "--clearance", text),
        ("simulate", "none.toml", "--against", text),
    ):
        status, out, err = run(*command)
        assert (status, out, len(err.splitlines())) == (2, "", 1)
        assert "none.toml" not in err
        assert "fit.toml: cannot be read" not in err
