"""The engine of claims, on small benches: discovery, cases, refusals, verdicts and exports."""

import io
import json
import re

import pandas as pd
import pytest

from cylcontact import InputError
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import (
    VERDICTS,
    Claim,
    Finding,
    Reading,
    check,
    ledger,
    untestable,
    withdrawn,
)
from cylcontact.reports.claims_text import (
    counts,
    grouped,
    to_json,
    to_records,
    to_table,
    to_text,
    what_stands,
)

YES, CHOICE, NO, OPEN, HANGS, NONE = VERDICTS
IMPORT = "from cylcontact.reports.claims import Finding, Reading, claim, untestable\n"
TRIAL = '''
@claim("{id}", "the laws agree to 10 %", paper="< 10 %", rule="below 10 % at every load")
def {name}(bench):
    """Return the largest difference in percent."""
    largest = 12.5
    return Finding(
        f"{{largest:.1f}} %", holds=largest < 10, choice="loads of 1 to 100 N/mm",
        values={{"largest, percent": largest}},
    )
'''
CASES = """
@claim(
    "4-{name}", "{name} is {parity}", paper="{number:g} is {parity}", rule="{{}} of 2",
    figures=["fig01"], paper_values={"number, -": 1.0}, cases=[
        {"name": "four", "number": 4, "parity": "even"},
        {"name": "seven", "number": 7, "parity": "even"},
    ],
)
def is_even(number, bench):
    return Finding(
        bench.root.name, holds=number % 2 == 0, paper_values={"half, -": number / 2},
        rule="divides {name}" if number == 7 else "",
    )
"""


def trial(id, name="trial"):
    return TRIAL.format(id=id, name=name)


@pytest.fixture
def bench(tmp_path):
    (tmp_path / "reports" / "claims").mkdir(parents=True)
    return Bench(tmp_path)


def write(bench, name, *functions):
    file = bench.recipes_folder / "claims" / f"{name}.py"
    file.write_text(IMPORT + "\n".join(functions), encoding="utf-8")
    return file


@pytest.fixture
def claims(bench):
    write(bench, "a", trial("1-a", "one"), CASES, trial("2-b", "two").replace("12.5", "1e-3"))
    return ledger(bench)


# --- discovery ---


def test_claims_stand_by_section_then_by_file_then_as_written_and_each_once(bench, tmp_path):
    assert ledger(Bench(tmp_path / "nowhere")) == []
    write(bench, "b", trial("2-first", "z"), trial("1-second", "a"), "from .a import y")
    write(bench, "a", trial("2-before", "x"), trial("1-first", "y"))
    assert [claim.id for claim in ledger(bench)] == ["1-first", "1-second", "2-before", "2-first"]


@pytest.mark.parametrize(
    ("text", "message"),
    [(trial("1-a"), r"1-a.*two claims have this id"), ("def broken(:", "failed with SyntaxError")],
)
def test_what_is_wrong_in_a_file_is_told_in_one_line(bench, text, message):
    write(bench, "a", trial("1-a"))
    write(bench, "b", text)
    with pytest.raises(InputError, match=message) as caught:
        ledger(bench)
    assert "\n" not in str(caught.value)


def test_long_computations_are_prepared_before_any_claim_and_progress_counts(bench):
    recorded = CASES.replace("return Finding", "ORDER.append('claim'); return Finding")
    write(bench, "a", "\nORDER = []\n", recorded)
    prepare = "from .a import ORDER\n\ndef prepare(bench, progress):\n    progress('runs', 1, 1)"
    write(bench, "b", prepare, "    ORDER.append(bench)")
    steps = []
    ledger(bench, lambda *step: steps.append(step))
    assert steps == [("runs", 1, 1), ("claims", 0, 1), ("claims", 1, 1)]
    assert bench.module("claims.a").ORDER == [bench, "claim", "claim"]


# --- functions ---


def test_cases_fill_the_texts_and_the_parameters_that_the_function_has(claims, bench):
    four, seven = claims[2:]
    assert (four.id, four.statement, four.paper) == ("4-four", "four is even", "4 is even")
    assert (four.rule, seven.rule) == ("{} of 2", "divides seven")
    assert (four.verdict, seven.verdict) == (YES, NO)
    assert four.finding.ours == bench.root.name
    assert seven.finding.paper_values == {"number, -": 1.0, "half, -": 3.5}
    assert four.figures == ("fig01",)
    file, line = claims[0].code.split(":")
    source = (bench.root / file).read_text(encoding="utf-8").splitlines()
    assert source[int(line) - 1].startswith('@claim("1-a"')


def test_a_missing_input_is_not_testable_and_a_wrong_one_is_an_error(bench):
    lacking = 'largest = bench.result("internal").objective.value'
    write(bench, "a", trial("1-a").replace("largest = 12.5", lacking))
    (claim,) = ledger(bench)
    assert (claim.verdict, claim.finding.ours, claim.balance) == (NONE, "", "")
    assert "internal.json: this fit result does not exist" in claim.basis
    wrong = 'largest = bench.material("unobtainium").material.E'
    write(bench, "a", trial("1-a").replace("largest = 12.5", wrong))
    with pytest.raises(InputError, match="no material has this name"):
        ledger(bench)


# --- verdicts ---


def judged(holds, **others):
    """Return a claim with a finding."""
    return Claim("1-x", "s", "p", "r", Finding("1 mm", holds, **others))


def reading(holds, missing="", miss="", ground="the caption"):
    return Reading("another way", "2 mm", holds, missing, miss, ground)


@pytest.mark.parametrize(
    ("holds", "alternatives", "choice", "missing", "verdict"),
    [
        (True, [], "", "", YES),
        (True, [], "ours", "", CHOICE),
        (True, [], "", "Table 1", CHOICE),
        (True, [reading(True), reading(True)], "", "", YES),
        (True, [reading(True)], "ours", "", CHOICE),
        (False, [], "", "", NO),
        (False, [reading(False)], "ours", "Table 1", NO),
        (None, [], "ours", "", OPEN),
        (True, [reading(False)], "ours", "", OPEN),
        (False, [reading(True)], "ours", "", OPEN),
        (True, [reading(None)], "ours", "Table 1", OPEN),
        (False, [reading(None, "Table 1")], "ours", "Table 1", OPEN),
        (True, [reading(False, "Table 1")], "ours", "Table 1", HANGS),
        (False, [reading(False), reading(True, "Table 1")], "ours", "Table 1", HANGS),
        # What stands on both sides without the missing input does not hang on it.
        (True, [reading(True, "Table 1"), reading(False)], "ours", "Table 1", OPEN),
        (True, [reading(False, "Table 1")], "ours", "", OPEN),
        (True, [reading(False, "Table 1"), reading(True)], "ours", "Table 1", HANGS),
        (True, [reading(False, "Table 1"), reading(False)], "ours", "Table 1", OPEN),
        # One without a ground in the text is not heard, unless for a missing input.
        (True, [reading(False, ground="")], "ours", "", CHOICE),
        (True, [reading(False, "Table 1", ground="")], "ours", "", OPEN),
    ],
)
def test_a_verdict_follows_from_the_readings(holds, alternatives, choice, missing, verdict):
    claim = judged(holds, alternatives=alternatives, choice=choice, missing=missing)
    assert claim.verdict == verdict
    assert claim.missing == (("Table 1",) if verdict == HANGS else ())
    assert claim.section == "1"


@pytest.mark.parametrize(
    ("value", "rule", "holds", "miss"),
    [
        (9.0, "<", True, ""),
        (10.0, "<", False, "0 points off"),
        (10.0, "<=", True, ""),
        (-12.5, "within", False, "2.5 points off"),
        (-12.5, "<", True, ""),
        (9.0, ">", False, "1 points off"),
        (10.0, ">=", True, ""),
    ],
)
def test_a_number_is_checked_against_a_bound(value, rule, holds, miss):
    found = check(value, rule, 10.0, "%", "ours", ground="Fig 2")
    assert (found.holds, found.miss, found.choice, found.ground) == (holds, miss, "ours", "Fig 2")


# --- exports ---


def test_counts_add_up_and_misprints_stand_apart(bench):
    misprint = trial("1-b", "two").replace("paper=", "misprint=True, paper=")
    write(bench, "a", trial("1-a", "one"), misprint, CASES)
    claims = ledger(bench)
    assert counts(claims) == dict.fromkeys(VERDICTS, 0) | {YES: 1, NO: 2}
    groups = {group: len(each) for group, each in grouped(claims).items()}
    assert groups == {YES: 1, NO: 2, "misprints": 1}
    assert what_stands(claims) == "Of 3 testable statements, 1 is reproduced, and 2 are not."


def test_one_sentence_says_what_stands():
    hangs = judged(True, missing="Table 1", alternatives=[reading(False, "Table 1")])
    none = Claim("1-x", "", "", "", untestable("no"))
    sentence = what_stands([*[judged(None)] * 3, judged(True), judged(False), hangs, none])
    numbers = [int(number) for number in re.findall(r"\d+", sentence)]
    assert numbers == [6, 1, 1, 4, 3, 1]


def test_the_text_has_every_claim_and_what_was_withdrawn(claims, bench, run, monkeypatch):
    flat = " ".join(to_text(claims, {"share": "a part of the domain"}).split())
    assert flat.startswith(what_stands(claims))
    for claim in claims:
        for text in (claim.id, claim.statement, claim.paper, claim.finding.ours, claim.basis):
            assert text in flat
    assert flat.endswith("share: a part of the domain")
    write(bench, "b", "WITHDRAWN = {'3.1-b': 'no statement', '2-c': 'merged'}")
    assert list(withdrawn(bench)) == ["2-c", "3.1-b"]
    monkeypatch.chdir(bench.root)
    code, out, errors = run("claims")
    assert (code, errors) == (0, "")
    assert "2-c: merged" in out


def test_json_and_csv_hold_the_records(claims):
    document = json.loads(to_json(claims, {"share": "ein Stück"}, {"9-gone": "no statement"}))
    assert document["claims"] == to_records(claims)
    assert document["counts"] == counts(claims)
    assert document["definitions"] == {"share": "ein Stück"}
    assert document["withdrawn"] == {"9-gone": "no statement"}
    text = io.StringIO(to_table(claims).to_csv(index=False))
    table = pd.read_csv(text, dtype=str, keep_default_na=False)
    for column in ("misprint", "readings", "missing", "figures", "paper_values", "ours_values"):
        table[column] = table[column].map(json.loads)
    assert table.to_dict("records") == to_records(claims)
