"""The engine of claims, on small benches: discovery, cases, refusals, verdicts and exports."""

import dataclasses
import io
import json
import shutil
from pathlib import Path

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
    described,
    grouped,
    to_json,
    to_records,
    to_table,
    to_text,
    what_stands,
)

ROOT = Path(__file__).parents[2]
YES, CHOICE, NO, OPEN, HANGS, NONE = VERDICTS
IMPORT = "from cylcontact.reports.claims import Finding, Reading, claim, untestable\n"
TRIAL = '''
@claim(
    "{id}",
    "the laws agree to 10 %",
    paper="< 10 %",
    rule="below 10 % at every load",
)
def {name}() -> Finding:
    """Return the largest difference in percent."""
    largest = 12.5
    return Finding(
        f"{{largest:.1f}} %",
        holds=largest < 10,
        choice="loads of 1 to 100 N/mm",
        values={{"largest, percent": largest}},
    )
'''


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


# --- discovery ---


def test_files_in_alphabetical_order_claims_as_written_then_by_section(bench):
    write(bench, "b", trial("2-first", "z"), trial("1-second", "a"), trial("2-third", "m"))
    write(bench, "a", trial("2-before", "x"), trial("1-first", "y"))
    assert [claim.id for claim in ledger(bench)] == [
        "1-first",
        "1-second",
        "2-before",
        "2-first",
        "2-third",
    ]


def test_a_bench_without_claims_has_an_empty_ledger(tmp_path, bench):
    assert ledger(bench) == []
    assert ledger(Bench(tmp_path / "nowhere")) == []


def test_a_claim_that_another_file_imports_counts_once(bench):
    write(bench, "a", trial("1-a", "one"))
    write(bench, "b", "from .a import one", trial("1-b", "two"))
    write(bench, "helpers", "LOADS = (10.0, 1000.0)")
    assert [claim.id for claim in ledger(bench)] == ["1-a", "1-b"]


def test_two_claims_with_one_id_are_refused(bench):
    write(bench, "a", trial("1-a"))
    write(bench, "b", trial("1-a"))
    with pytest.raises(InputError, match=r"1-a.*two claims have this id"):
        ledger(bench)


def test_a_syntax_error_is_told_in_one_line(bench):
    file = write(bench, "a", "def broken(:")
    with pytest.raises(InputError, match=r"failed with SyntaxError") as caught:
        ledger(bench)
    assert str(file) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_progress_counts_the_functions(bench):
    write(bench, "a", trial("1-a", "one"), trial("1-b", "two"))
    steps = []
    ledger(bench, lambda *step: steps.append(step))
    assert steps == [("claims", 0, 2), ("claims", 1, 2), ("claims", 2, 2)]


# --- functions ---

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


def test_cases_fill_the_texts_and_the_parameters_that_the_function_has(bench):
    write(bench, "a", CASES)
    four, seven = ledger(bench)
    assert (four.id, four.statement, four.paper) == ("4-four", "four is even", "4 is even")
    assert (four.rule, seven.rule) == ("{} of 2", "divides seven")
    assert (four.verdict, seven.verdict) == (YES, NO)
    assert four.finding.ours == bench.root.name
    assert seven.finding.paper_values == {"number, -": 1.0, "half, -": 3.5}
    assert four.figures == ("fig01",)


def test_without_cases_braces_are_left_alone(bench):
    write(bench, "a", trial("1-a").replace("the laws agree", "the set {{a, b}} agrees"))
    assert ledger(bench)[0].statement == "the set {{a, b}} agrees to 10 %"


def test_a_missing_input_is_not_testable_for_its_reason(bench):
    write(
        bench,
        "a",
        trial("1-a")
        .replace("def trial()", "def trial(bench)")
        .replace("largest = 12.5", 'largest = bench.result("internal").objective.value'),
    )
    (claim,) = ledger(bench)
    assert claim.verdict == NONE
    assert claim.finding.ours == ""
    assert not claim.finding.values
    assert "internal.json" in claim.basis
    assert "this fit result does not exist" in claim.basis
    assert "we find" not in to_text([claim], {})


def test_a_wrong_input_is_an_error(bench):
    write(
        bench,
        "a",
        trial("1-a")
        .replace("def trial()", "def trial(bench)")
        .replace("largest = 12.5", 'largest = bench.material("unobtainium").material.E'),
    )
    with pytest.raises(InputError, match="no material has this name"):
        ledger(bench)


@pytest.mark.slow
def test_a_claim_of_the_shipped_bench_takes_one_function_of_18_lines(tmp_path, run, monkeypatch):
    """In a copy of the bench's helpers and of one file of claims."""
    text = trial("3.2-zz-trial").strip()
    assert len(text.splitlines()) <= 18
    claims = tmp_path / "reports" / "claims"
    claims.mkdir(parents=True)
    for file in (ROOT / "reports").glob("*.py"):
        shutil.copy(file, claims.parent)
    shutil.copy(ROOT / "reports" / "claims" / "section33.py", claims)
    monkeypatch.chdir(tmp_path)
    before = run("claims")
    assert before[0] == 0, before
    with (claims / "section33.py").open("a", encoding="utf-8") as file:
        file.write(f"\n\n{text}\n")
    code, out, err = run("claims")
    assert (code, err) == (0, "")
    assert "3.2-zz-trial\n  the paper says  the laws agree to 10 %: < 10 %\n" in out
    assert out.index("Not reproduced (") < out.index("3.2-zz-trial")
    assert "3.2-zz-trial" not in before[1]


# --- verdicts and exports ---


@pytest.fixture
def claims(bench):
    write(bench, "a", trial("1-a", "one"), CASES, trial("2-b", "two").replace("12.5", "1e-3"))
    return ledger(bench)


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
    ],
)
def test_a_verdict_follows_from_the_readings(holds, alternatives, choice, missing, verdict):
    claim = judged(holds, alternatives=alternatives, choice=choice, missing=missing)
    assert claim.verdict == verdict
    assert claim.missing == (("Table 1",) if verdict == HANGS else ())
    assert claim.section == "1"


@pytest.mark.parametrize("holds", [True, False, None])
def test_a_reading_without_a_ground_in_the_text_is_shown_and_not_heard(holds):
    claim = judged(True, choice="ours", alternatives=[reading(holds, ground="")])
    assert (claim.verdict, claim.balance) == (CHOICE, "")
    assert len(claim.finding.readings) == 2
    heard = judged(True, choice="ours", alternatives=[reading(holds, "Table 1", ground="")])
    assert heard.verdict == {True: CHOICE, False: OPEN, None: OPEN}[holds]


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


def test_what_cannot_be_computed_is_not_testable():
    claim = Claim("1-x", "s", "p", "r", untestable("no data"))
    assert (claim.verdict, claim.basis, claim.balance) == (NONE, "no data", "")


def test_the_basis_tells_rule_choice_and_how_the_readings_stand():
    claim = judged(
        True,
        choice="ours",
        missing="Table 1",
        ground="every digit",
        alternatives=[reading(False, "Table 1", "1 mm off"), reading(None)],
    )
    assert claim.basis == (
        "rule: r; choice: ours; ground: every digit; met by 1 of 3 readings; "
        "1 cannot tell; Table 1 would decide"
    )
    assert [described(each) for each in claim.finding.alternatives] == [
        "another way: 2 mm (not met, 1 mm off, in place of Table 1, the caption)",
        "another way: 2 mm (cannot tell, the caption)",
    ]


def test_counts_add_up_and_groups_follow_the_verdicts(claims):
    assert counts(claims) == dict.fromkeys(VERDICTS, 0) | {YES: 1, CHOICE: 1, NO: 2}
    assert list(counts(claims)) == list(VERDICTS)
    assert {verdict: len(each) for verdict, each in grouped(claims).items()} == {
        YES: 1,
        CHOICE: 1,
        NO: 2,
    }
    assert counts([]) == dict.fromkeys(VERDICTS, 0)
    assert grouped([]) == {}


def test_misprints_are_listed_apart_and_not_counted(bench):
    write(
        bench,
        "a",
        trial("1-a", "one"),
        trial("1-b", "two").replace("paper=", "misprint=True, paper="),
    )
    claims = ledger(bench)
    assert [claim.misprint for claim in claims] == [False, True]
    assert {group: len(each) for group, each in grouped(claims).items()} == {NO: 1, "misprints": 1}
    assert counts(claims)[NO] == 1
    assert what_stands(claims) == "Of 1 testable statement, 0 are reproduced, and 1 is not."


def test_one_sentence_says_what_stands(claims):
    assert what_stands(claims) == (
        "Of 4 testable statements, 2 are reproduced (1 as printed, 1 with a choice that we "
        "state), and 2 are not."
    )
    hangs = judged(True, missing="Table 1", alternatives=[reading(False, "Table 1")])
    many = [*[judged(None)] * 3, judged(True), hangs, Claim("1-x", "", "", "", untestable("no"))]
    assert what_stands(many) == (
        "Of 5 testable statements, 1 is reproduced, and 4 stay open: for 3 the readings "
        "disagree or the uncertainty includes the limit; for 1 the answer depends on "
        "something that the text lacks."
    )


def test_text_has_what_stands_then_the_claims_by_group_and_the_terms(claims):
    flat = " ".join(
        to_text(claims, {"share": "a part of the domain"}, {"9-gone": "no statement"}).split()
    )
    assert flat.startswith(f"{what_stands(claims)} You can rely on: - ")
    assert flat.index("You can rely on") < flat.index("You cannot rely on")
    assert flat.index("Reproduced (1): ") < flat.index("with a stated choice (1): ")
    for claim in claims:
        for text in (claim.id, claim.statement, claim.paper, claim.finding.ours, claim.basis):
            assert text in flat
    assert "Withdrawn" in flat
    assert "9-gone: no statement" in flat
    assert flat.endswith("share: a part of the domain")


def test_withdrawn_claims_keep_their_reason(bench, run, monkeypatch):
    write(bench, "a", trial("1-a"), "WITHDRAWN = {'3.1-b': 'no statement', '2-c': 'merged'}")
    assert list(withdrawn(bench).items()) == [("2-c", "merged"), ("3.1-b", "no statement")]
    monkeypatch.chdir(bench.root)
    assert "2-c: merged" in run("claims")[1]


def test_text_keeps_to_the_width(claims):
    long = dataclasses.replace(claims[0].finding, choice="a long choice " * 20)
    texts = to_text(
        [dataclasses.replace(claims[0], finding=long)], {"term": "words " * 40}, width=60
    )
    assert max(map(len, texts.splitlines())) <= 60


def test_json_round_trip(claims):
    terms, gone = {"share": "ein Stück"}, {"9-gone": "no statement"}
    assert json.loads(to_json(claims, terms, gone)) == {
        "format": 1,
        "what_stands": what_stands(claims),
        "definitions": terms,
        "claims": to_records(claims),
        "counts": counts(claims),
        "withdrawn": gone,
    }


def test_csv_round_trip(claims):
    table = pd.read_csv(
        io.StringIO(to_table(claims).to_csv(index=False)), dtype=str, keep_default_na=False
    )
    for column in ("misprint", "readings", "missing", "figures", "paper_values", "ours_values"):
        table[column] = table[column].map(json.loads)
    assert table.to_dict("records") == to_records(claims)


def test_the_code_of_a_claim_is_its_file_and_line(claims, bench):
    file, line = claims[0].code.split(":")
    source = (bench.root / file).read_text(encoding="utf-8").splitlines()
    assert source[int(line) - 1].startswith("@claim")
    assert claims[0].id in source[int(line)]


def test_long_computations_are_prepared_before_any_claim(bench):
    order = "\nORDER = []\n"
    write(
        bench, "a", order, CASES.replace("return Finding", "ORDER.append('claim'); return Finding")
    )
    prepare = "from .a import ORDER\n\ndef prepare(bench, progress):\n    progress('runs', 1, 1)"
    write(bench, "b", prepare, "    ORDER.append(bench)")
    steps = []
    ledger(bench, lambda *step: steps.append(step))
    assert steps == [("runs", 1, 1), ("claims", 0, 1), ("claims", 1, 1)]
    assert bench.module("claims.a").ORDER == [bench, "claim", "claim"]
