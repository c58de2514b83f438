"""Every malformed input gets one clear line and exit code 2, and nothing is written."""

import contextlib
import io
import subprocess
import sys

import pytest

from cylcontact import cli
from tests import malformed
from tests.spec_files import CAMPAIGN, tree, write_bench

# Of each file that is broken by chance.
BY_CHANCE = 40


@pytest.fixture(scope="module")
def files(small_result, tmp_path_factory):
    """The good files, by name."""
    path = tmp_path_factory.mktemp("result") / "good.json"
    small_result.save(path)
    return malformed.good_files(path.read_bytes())


@pytest.fixture
def bench(files, tmp_path, monkeypatch):
    """The good files in a folder of their own."""
    for name, contents in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(contents)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(arguments, monkeypatch):
    """Run the command line in this process; return its exit code, output and errors."""
    monkeypatch.setattr(sys, "argv", ["cylcontact", *arguments])
    out, errors = io.StringIO(), io.StringIO()
    with (
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(errors),
        pytest.raises(SystemExit) as caught,
    ):
        cli.main()
    return caught.value.code, out.getvalue(), errors.getvalue()


def mistake_in(case, bench, monkeypatch):
    """Run a case; say what is wrong with how it is told of, and whether it was refused at all."""
    kept = (bench / case.path).read_bytes() if case.path else b""
    if case.path:
        (bench / case.path).write_bytes(case.contents)
    before = tree(bench)
    try:
        code, said, errors = run(case.arguments, monkeypatch)
    except Exception as error:
        return f"{case.name}: {type(error).__name__}: {error}", True
    after = tree(bench)
    if case.path:
        (bench / case.path).write_bytes(kept)
    if code in (0, 1):
        for name in set(after) - set(before):
            (bench / name).unlink()
        return "", False
    clear = (
        code == 2
        and errors.startswith("cylcontact: ")
        and len(errors.splitlines()) == 1
        and errors.rstrip("\n").isprintable()
        and len(errors) < 1200
        and "Traceback" not in errors
        and (said == "" or not case.arguments)  # without a command, help is shown as well
        and after == before
    )
    return "" if clear else f"{case.name}: exit code {code}: {errors!r}", True


@pytest.mark.usefixtures("bench")
def test_the_good_files_are_accepted(monkeypatch):
    """So that what is refused below is refused for what was broken in it."""
    for path, arguments in malformed.READERS.items():
        if path != "elements.toml":  # takes minutes; a mistake in it is found before the first case
            code, _, errors = run(arguments, monkeypatch)
            assert (code, errors) == (0, ""), path


def test_every_case_that_breaks_a_rule_is_told_in_one_line(bench, files, monkeypatch):
    cases = malformed.by_rule(files["good.json"])
    assert len({(case.arguments, case.path, case.contents) for case in cases}) >= 150
    found = [mistake_in(case, bench, monkeypatch) for case in cases]
    assert [told for told, _ in found if told] == []
    accepted = [case.name for case, (_, refused) in zip(cases, found, strict=True) if not refused]
    assert accepted == []


def test_files_broken_by_chance_are_told_of_in_one_line_or_are_still_good(
    bench, files, monkeypatch
):
    cases = malformed.by_chance(files, BY_CHANCE)
    found = [mistake_in(case, bench, monkeypatch) for case in cases]
    assert [told for told, _ in found if told] == []
    assert sum(refused for _, refused in found) >= 150


@pytest.mark.parametrize(
    "arguments",
    [("fit", "table.csv"), ("compare", "mechanism.toml"), ("simulate", "good.json"), ("nonsense",)],
    ids=lambda arguments: arguments[0],
)
def test_a_process_of_its_own_says_the_same(bench, monkeypatch, arguments):
    before = tree(bench)
    command = [sys.executable, "-m", "cylcontact.cli", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == run(arguments, monkeypatch)[2]
    assert tree(bench) == before


def test_the_campaign_of_the_corpus_is_that_of_the_other_tests(tmp_path):
    """Its changes make it quick, no more."""
    assert set(malformed.QUICK) == set(CAMPAIGN)
    assert write_bench(tmp_path).exists()
