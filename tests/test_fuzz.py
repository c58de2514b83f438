"""Inputs made by chance end well on the command line: see tests/fuzz."""

import sys
import time
from collections import Counter

import pytest

from cylcontact import cli
from tests.counts import counted
from tests.fuzz.cases import Case, case_of, options
from tests.fuzz.judge import Judge
from tests.fuzz.run import CORPUS, read_case, shrunk, write_case

pytestmark = pytest.mark.slow


SEED = 20150101
# The chunks, of which make test-all runs the first four, and their size.
CHUNKS, SIZE = 20, 500
FIRST = 0


@pytest.fixture(scope="module")
def judge(tmp_path_factory):
    with Judge(tmp_path_factory.mktemp("fuzz")) as judge:
        yield judge


def chunk(number):
    return range(number * SIZE, (number + 1) * SIZE)


@pytest.mark.parametrize(
    "number",
    [n if n < 4 else pytest.param(n, marks=pytest.mark.long) for n in range(CHUNKS)],
)
def test_inputs_made_by_chance_end_well(judge, number):
    verdicts = [*judge.verdicts(SEED, chunk(number))]
    assert [(v.case.words, v.wrong) for v in verdicts if v.wrong] == []
    accepted = sum(verdict.code == 0 for verdict in verdicts)
    assert SIZE / 10 < accepted < SIZE / 2


@pytest.mark.parametrize("path", sorted(CORPUS.glob("*.json")), ids=lambda path: path.stem)
def test_inputs_that_once_failed_end_well(judge, path):
    assert judge.verdict(read_case(path)).wrong == ""


def test_good_files_are_accepted(judge):
    for source in (source for each in judge.sources.values() for source in each):
        verdict = judge.verdict(Case(source.kind, source.command, {}))
        assert (verdict.code, verdict.wrong) == (0, ""), source


def test_every_kind_of_file_and_every_command_is_tried(judge):
    cases = [case_of(SEED, n, judge.sources, judge.files) for n in range(CHUNKS * SIZE)]
    kinds = Counter(case.kind if case.files else "command line alone" for case in cases)
    assert kinds.keys() == {*judge.sources} - {"none"} | {"command line alone"}
    assert {case.words[0] for case in cases if case.words} >= options().keys()
    counted("fuzzed inputs, a fifth of them in CI", len(cases))
    for kind, number in kinds.items():
        counted(f"fuzzed inputs: {kind}", number)


def test_a_seed_gives_the_same_inputs_and_verdicts(judge):
    first, again = ([*judge.verdicts(7, range(60))] for _ in range(2))
    assert first == again


# --- what the judge catches ---------------------------------------------------------------------


GOOD = Case("none", ("laws",), {})


@pytest.fixture
def plant(judge, monkeypatch):
    """Let a command do something else, and return what the judge finds wrong with it."""

    def plant(deed, case=GOOD):
        monkeypatch.setattr(cli, "_run", deed)
        return judge.verdict(case).wrong

    return plant


def test_a_traceback_is_caught(plant):
    assert "ZeroDivisionError" in plant(lambda _: 1 // 0)


def test_a_file_left_behind_is_caught(judge, plant):
    left = judge.root / "left.txt"
    assert "left.txt" in plant(lambda _: left.write_text("x") * 0)
    assert not left.exists()


def test_a_good_file_that_is_changed_is_caught_and_restored(judge, plant):
    file = judge.root / "table.csv"
    assert "table.csv" in plant(lambda _: file.write_text("x") * 0)
    assert file.read_bytes() == judge.files["table.csv"]


def test_an_output_that_is_asked_for_is_none(judge, plant):
    case = Case("none", ("export", "johnson", "-o", "new/out.c"), {})

    def deed(_):
        (judge.root / "new").mkdir()
        (judge.root / "new/out.c").write_text("x")
        return 0

    assert plant(deed, case) == ""
    assert "new/out.c" in plant(lambda _: deed(_) or 1, case)


@pytest.mark.parametrize("text", ["one\ntwo\n", "", "no end", "\x1b[31mred\n", "x" * 3000 + "\n"])
def test_an_error_that_is_not_one_printable_line_is_caught(plant, text):
    assert plant(lambda _: sys.stderr.write(text) * 0 + 2) != ""


def test_words_of_an_error_after_success_are_caught(plant):
    assert "exit code 0" in plant(lambda _: sys.stderr.write("RuntimeWarning: overflow\n") * 0)


def test_another_exit_code_is_caught(plant):
    assert "exit code 3" in plant(lambda _: 3)


def test_a_hang_is_caught(judge, plant, monkeypatch):
    monkeypatch.setattr(judge, "patience", 0.1)
    assert "hang" in plant(lambda _: time.sleep(30))


def test_files_left_open_are_caught(judge, monkeypatch):
    monkeypatch.setattr("tests.fuzz.judge.INTERVAL", 1)
    monkeypatch.setattr(judge, "_first_look", None)
    opened = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cli, "_run", lambda _: opened.append(open("table.csv")) or 0)  # noqa: PTH123, SIM115
        verdicts = [*judge.verdicts(SEED, range(3))]
    for file in opened:
        file.close()
    assert "'files': 1" in verdicts[1].wrong


def test_a_finding_is_made_small_and_kept(judge, plant, monkeypatch, tmp_path):
    def deed(words):
        return 1 // 0 if b"nu" in (judge.root / "table.csv").read_bytes() and words[1:] else 0

    monkeypatch.setattr("tests.fuzz.run.CORPUS", tmp_path)
    files = {"table.csv": b"dR\nE\nnu\nload\n\xff\n", "steel.csv": b""}
    case = Case("table .csv", ("fit", "table.csv", "--law", "power"), files)
    wrong = plant(deed, case)
    small = shrunk(case, judge, wrong)
    assert len(small.words) == 2
    assert read_case(write_case(small, wrong)) == small
