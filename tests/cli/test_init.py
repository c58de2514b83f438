"""A bench laid out by `cylcontact init`: all that git holds of it, and over nothing."""

import subprocess
from pathlib import Path

import pytest

from cylcontact.cli import init
from tests.docs.test_links import LINK
from tests.support.spec_files import tree

ROOT = Path(__file__).resolve().parents[2]


def test_what_ships_is_what_git_holds():
    """A copy made outside of git has no way to tell; the checkout it was made from does."""
    if not (ROOT / ".git").exists():
        pytest.fail("run the tests in a checkout: git says which files belong to the bench")
    command = ["git", "ls-files", "-z", *init.FOLDERS]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert [path.as_posix() for path in init.shipped_files(ROOT)] == sorted(
        listed.strip("\0").split("\0")
    )


def test_a_bench_is_laid_out_and_found(tmp_path, monkeypatch, run):
    code, out, err = run("init", tmp_path / "new" / "bench")
    assert (code, err) == (0, "")
    names = [path.as_posix() for path in init.shipped_files(ROOT)]
    assert out.startswith(f"{len(names)} files in {tmp_path / 'new' / 'bench'}: datasets, fitting")
    laid_out = tmp_path / "new" / "bench"
    assert sorted(name for name in tree(laid_out) if (laid_out / name).is_file()) == sorted(names)
    for name in names:
        if name.endswith(".md"):  # without the links to pages, which are not there
            text = (laid_out / name).read_text("utf-8")
            targets = [link.partition("#")[0] for link in LINK.findall(text)]
            assert all((laid_out / name).parent.joinpath(each).exists() for each in targets), name
        else:
            assert (laid_out / name).read_bytes() == (ROOT / name).read_bytes()
    monkeypatch.chdir(laid_out)
    assert run("compare", "fitting/results/internal.json")[0] == 0
    assert run("figure", "fig12")[:2] == (0, "1 figure in build/figures\n")


def test_here_is_where_it_is_laid_out_by_default(tmp_path, monkeypatch, run):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    assert run("init")[0] == 0
    assert (tmp_path / "fitting" / "internal.toml").is_file()
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_nothing_is_overwritten(tmp_path, monkeypatch, run):
    monkeypatch.chdir(tmp_path)
    for name in ("datasets/internal.toml", "reports/maps.py"):
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).write_text("mine")
    before = tree(tmp_path)
    code, out, err = run("init", ".")
    assert (code, out) == (2, "")
    assert err == (
        "cylcontact: .: has other files named datasets/internal.toml, reports/maps.py, and "
        "nothing is overwritten; choose an empty folder, or move these away\n"
    )
    assert tree(tmp_path) == before


def test_a_bench_is_completed_where_its_files_are_as_they_ship(tmp_path, run):
    assert run("init", tmp_path)[0] == 0
    before = tree(tmp_path)
    (tmp_path / "reports/maps.py").unlink()
    assert run("init", tmp_path)[0] == 0
    assert tree(tmp_path) == before


@pytest.mark.parametrize("command", [("figure", "fig12"), ("verify", "--all")])
def test_outside_of_a_bench_a_command_says_how_to_lay_one_out(tmp_path, monkeypatch, run, command):
    monkeypatch.chdir(tmp_path)
    code, _, err = run(*command)
    assert code == 2
    assert "cylcontact init FOLDER" in err
    assert len(err.splitlines()) == 1
