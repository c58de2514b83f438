"""Every malformed input gets one clear line and exit code 2, and nothing is written."""

import re
import subprocess
import sys

import pytest
from tests.counts import counted

from tests import malformed
from tests.spec_files import tree


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
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(contents)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def refused(bench, run):
    """Run cases; return those that were refused, and check how each of them was."""
    before = tree(bench)

    def mistake_in(case):
        """Return what is wrong with how a case is refused, None if it is accepted."""
        if case.path:
            (bench / case.path).write_bytes(case.contents)
        try:
            code, out, errors = run(*case.arguments)
        except Exception as error:
            return f"{type(error).__name__}: {error}"
        if case.path:
            (bench / case.path).write_bytes(before[case.path])
        after = tree(bench)
        for name in after.keys() - before.keys():
            (bench / name).unlink()
        if code in (0, 1):
            return None
        clear = (
            code == 2
            and len(errors.splitlines()) == 1
            and errors.rstrip("\n").isprintable()
            and len(errors) < 1200
            and "Traceback" not in errors
            and (out == "" or not case.arguments)  # without a command, help is shown as well
            and after == before
            and re.match(case.line or "cylcontact: ", errors)
        )
        return "" if clear else f"exit code {code}: {errors!r}, not {case.line!r}"

    def refused(cases):
        mistakes = {case: mistake_in(case) for case in cases}
        assert [f"{case.name}: {mistake}" for case, mistake in mistakes.items() if mistake] == []
        return [case for case, mistake in mistakes.items() if mistake is not None]

    return refused


@pytest.mark.usefixtures("bench")
def test_the_good_files_are_accepted(run):
    """So that what is refused below is refused for what was broken in it."""
    for path, arguments in malformed.READERS.items():
        code, _, errors = run(*arguments)
        assert (code, errors) == (0, ""), path


@pytest.mark.slow
def test_every_mistake_that_a_schema_rules_out_is_told_in_its_words(files, refused):
    cases = list(malformed.by_schema(files))
    assert refused(cases) == cases
    counted("mistakes that a schema rules out, told in its words", len(cases))


def test_every_case_that_breaks_a_rule_is_told_in_one_line(files, refused):
    cases = list(malformed.by_rule(files))
    assert refused(cases) == cases
    counted("files and command lines that break a rule", len(cases))


@pytest.mark.parametrize(
    "arguments",
    [(), ("fit", "table.csv"), ("compare", "mechanism.toml"), ("simulate", "good.json")],
    ids=" ".join,
)
@pytest.mark.slow
def test_a_process_of_its_own_says_the_same(bench, run, arguments):
    before = tree(bench)
    command = [sys.executable, "-m", "cylcontact.cli", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert (done.stderr, done.stdout) == run(*arguments)[:0:-1]
    assert tree(bench) == before
