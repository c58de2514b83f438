"""Files appear complete or not at all, and what cannot be read or written is told in a line."""

import os
import stat
from pathlib import Path

import pytest

from cylcontact import InputError
from cylcontact.files.reading import plain_number, read_bytes, unmarked
from cylcontact.files.spec import read_toml
from cylcontact.files.writing import replacing, replacing_all, require_suffix, require_writable
from cylcontact.fitting import read_result
from tests.support.spec_files import assert_told, tree, write_bench

REMEDY = "choose a file in a folder you may write to"


def test_a_file_is_replaced_only_at_the_end_and_keeps_its_permissions(tmp_path):
    path = tmp_path / "one/two/out.json"
    for text in ("old", "new"):
        before = tree(tmp_path)
        with replacing(path) as temporary:
            temporary.write_text(text)
            assert {k: v for k, v in tree(tmp_path).items() if k in before} == before
        path.chmod(0o640)
    assert [file.name for file in path.parent.iterdir()] == ["out.json"]
    assert (path.read_text(), stat.S_IMODE(path.stat().st_mode)) == ("new", 0o640)


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, OSError(28, "No room")])
def test_a_failure_leaves_the_files_of_before(tmp_path, error):
    paths = [tmp_path / "out.csv", tmp_path / "out.png"]
    paths[0].write_text("old")

    def fail():
        with replacing_all(paths) as temporaries:
            for temporary in temporaries:
                temporary.write_text("half")
            raise error

    with pytest.raises(InputError if isinstance(error, OSError) else error) as caught:
        fail()
    assert tree(tmp_path) == {"out.csv": b"old"}
    if isinstance(error, OSError):
        assert_told(caught, tmp_path, "", None, "cannot be written (No room)", "with room left")


def test_files_that_belong_together_are_complete_before_the_first_is_renamed(tmp_path):
    paths = [tmp_path / "out.csv", tmp_path / "out.png"]

    def write_one():
        with replacing_all(paths) as temporaries:
            temporaries[0].write_text("complete")

    with pytest.raises(InputError):
        write_one()
    assert tree(tmp_path) == {}


# What stands where the output is to go, and what is said.
OBSTACLES = {
    "a folder": (lambda folder: (folder / "out").mkdir(), "it is a folder"),
    "a link": (lambda folder: (folder / "out").symlink_to("file"), "it is a link"),
    "a pipe": (lambda folder: os.mkfifo(folder / "out"), "it is a device, a pipe or a socket"),
    "a file for a folder": (lambda folder: (folder / "new").touch(), "new is not a folder"),
}


@pytest.mark.parametrize("obstacle", OBSTACLES)
def test_an_output_that_can_be_no_file_is_refused_before_any_work(tmp_path, obstacle):
    make, problem = OBSTACLES[obstacle]
    make(tmp_path)
    path = tmp_path / ("new/out" if "for a folder" in obstacle else "out")
    before = sorted(tmp_path.rglob("*"))
    for attempt in (require_writable, lambda path: replacing(path).__enter__()):
        with pytest.raises(InputError) as caught:
            attempt(path)
        assert_told(caught, path, "", None, problem, REMEDY)
    assert sorted(tmp_path.rglob("*")) == before


def test_a_device_a_long_name_and_a_closed_folder_are_refused(tmp_path, monkeypatch):
    with pytest.raises(InputError, match="it is a device"):
        require_writable("/dev/null")
    with pytest.raises(InputError, match="File name too long"):
        require_writable(tmp_path / ("x" * 300))
    monkeypatch.setattr(os, "access", lambda *_: False)  # root may write everywhere
    with pytest.raises(InputError, match="no permission to write in"):
        require_writable(tmp_path / "out")


def test_an_output_that_is_an_input_is_refused(tmp_path, monkeypatch, run):
    write_bench(tmp_path)
    monkeypatch.chdir(tmp_path)
    before = tree(tmp_path)
    code, _, errors = run("fit", "fitting/small.toml", "-o", "./fitting/small.toml")
    assert code == 2
    assert "fitting/small.toml: cannot be written (it is an input); choose another" in errors
    assert tree(tmp_path) == before


def test_another_suffix_and_a_missing_library_are_told(monkeypatch):
    with pytest.raises(InputError) as caught:
        require_suffix("out.txt", ".csv", ".parquet")
    assert_told(caught, "out.txt", "", None, "is neither .csv nor .parquet", "name the output")
    monkeypatch.setitem(__import__("sys").modules, "pyarrow.parquet", None)
    with pytest.raises(InputError) as caught:
        require_suffix("out.parquet", ".csv", ".parquet")
    assert_told(caught, "out.parquet", "", None, "needs the extra 'parquet'", "make extras")


# --- reading --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("make", "rule"),
    [
        (lambda _: None, "cannot be read (No such file or directory)"),
        (Path.mkdir, "cannot be read (Is a directory)"),
        (os.mkfifo, "is a device, a pipe or a socket"),  # which would be waited for
    ],
)
def test_what_is_no_file_is_refused(tmp_path, make, rule):
    path = tmp_path / "in.toml"
    make(path)
    for read in (read_bytes, read_toml, read_result):
        with pytest.raises(InputError) as caught:
            read(path)
        assert caught.value.source == str(path)
        assert caught.value.rule == rule


def test_a_spec_beyond_64_kB_is_refused(tmp_path):
    path = tmp_path / "in.toml"
    path.write_text("#" * 64_000)
    assert read_toml(path) == {}
    path.write_text("#" * 70_000)
    with pytest.raises(InputError) as caught:
        read_toml(path)
    assert_told(caught, path, "", None, "has 70 kB (at most 64)", "give a TOML file")


def test_a_file_of_another_version_is_told(tmp_path, small_result):
    path = tmp_path / "result.json"
    small_result.save(path)
    assert read_result(path) == small_result
    path.write_text(path.read_text().replace('"format": 3', '"format": 2'))
    with pytest.raises(InputError) as caught:
        read_result(path)
    rule = "is not version 3, which this cylcontact reads"
    assert_told(caught, path, "format", 2, rule, "read it with the version that wrote it")
    assert unmarked({"key": 3}, "source") == {"key": 3}


@pytest.mark.parametrize(
    "text", ["1_700", "１７００", "0x10", "nan", "inf", "1e999", "", "1,5", "1 7"]
)
def test_a_number_is_what_a_spreadsheet_writes(text):
    with pytest.raises(ValueError, match="is not a number"):
        plain_number(text)
