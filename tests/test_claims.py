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
    counts,
    ledger,
    to_json,
    to_records,
    to_table,
    to_text,
)

ROOT = Path(__file__).parents[1]
YES, CHOICE, NO, NONE = VERDICTS
IMPORT = "from cylcontact.reports.claims import Finding, claim\n"
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
    paper_values={"number, -": 1.0}, cases=[
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
    assert four.ours == bench.root.name
    assert seven.paper_values == {"number, -": 1.0, "half, -": 3.5}


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
    assert claim.ours == ""
    assert not claim.ours_values
    assert "internal.json" in claim.choice
    assert "this fit result does not exist" in claim.choice
    assert "  reason    " in to_text([claim], {})


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
    with (claims / "section33.py").open("a", encoding="utf-8") as file:
        file.write(f"\n\n{text}\n")
    code, out, err = run("claims")
    assert (code, err) == (0, "")
    assert "3.2-zz-trial  [not reproduced]\n  claim     the laws agree to 10 %\n" in out
    assert "3.2-zz-trial" not in before[1]
    # It comes first, as its section does.
    assert out.index("3.2-zz-trial") < out.index("3.3-yield-load-against-clearance")


# --- verdicts and exports ---


@pytest.fixture
def claims(bench):
    write(bench, "a", trial("1-a", "one"), CASES, trial("2-b", "two").replace("12.5", "1e-3"))
    return ledger(bench)


def test_a_verdict_follows_from_the_rule_and_the_choice():
    claim = Claim("1-x", "s", "p", "o", "r", holds=True)
    assert claim.verdict == YES
    assert claim.section == "1"
    assert dataclasses.replace(claim, choice="c").verdict == CHOICE
    assert dataclasses.replace(claim, holds=False, choice="c").verdict == NO
    assert dataclasses.replace(claim, holds=None, choice="c").verdict == NONE


def test_counts_add_up(claims):
    assert counts(claims) == {YES: 1, CHOICE: 1, NO: 2, NONE: 0}
    assert tuple(counts(claims)) == VERDICTS
    assert counts([]) == dict.fromkeys(VERDICTS, 0)


def test_text_has_definitions_claims_and_counts(claims):
    flat = " ".join(to_text(claims, {"share": "a part of the domain"}).split())
    assert flat.startswith("Definitions share: a part of the domain Section 1 ")
    for claim in claims:
        assert f"{claim.id} [{claim.verdict}]" in flat
        for text in (claim.statement, claim.paper, claim.ours, claim.choice):
            assert text in flat
    assert flat.endswith(
        "Verdicts 1 reproduced 1 reproduced with a stated choice 2 not reproduced "
        "0 not testable 4 in all"
    )


def test_text_keeps_to_the_width(claims):
    long = [dataclasses.replace(claims[0], choice="a long choice " * 20)]
    assert max(map(len, to_text(long, {"term": "words " * 40}, width=60).splitlines())) <= 60


def test_json_round_trip(claims):
    terms = {"share": "ein Stück"}
    document = json.loads(to_json(claims, terms))
    assert document == {
        "definitions": terms,
        "claims": to_records(claims),
        "counts": counts(claims),
    }


def test_csv_round_trip(claims):
    table = pd.read_csv(
        io.StringIO(to_table(claims).to_csv(index=False)), dtype=str, keep_default_na=False
    )
    for column in ("paper_values", "ours_values"):
        table[column] = table[column].map(json.loads)
    assert table.to_dict("records") == to_records(claims)


def test_table_has_a_row_per_claim(claims):
    assert list(to_table(claims)["id"]) == [claim.id for claim in claims]
