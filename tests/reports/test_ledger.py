"""The ledger as a whole: every claim pinned, none lost, each with what a referee would ask for."""

import json
import math
import re
from pathlib import Path

import pytest
from _cylcontact_bench.claims import section4, section4_runs
from _cylcontact_bench.long_runs import SHORT
from _cylcontact_bench.paper import DEFINITIONS, REFERENCES

from cylcontact.reports.bench import Bench
from cylcontact.reports.build import find_recipes
from cylcontact.reports.claims import VERDICTS, Claim, ledger, withdrawn
from cylcontact.reports.claims_text import to_text, what_stands
from tests.support.claim_files import claims_of

pytestmark = pytest.mark.slow


ROOT = Path(__file__).parents[2]
BENCH = Bench(ROOT, jobs=2)
# Verdict of every claim, and its headline numbers to more digits than are printed.
GOLDEN = json.loads((ROOT / "tests" / "golden" / "claims.json").read_text(encoding="utf-8"))
YES, CHOICE, NO, OPEN, HANGS, NONE = VERDICTS


@pytest.fixture(scope="module")
def claims() -> dict[str, Claim]:
    """The whole ledger, claim by id."""
    return {claim.id: claim for claim in ledger(BENCH)}


def test_every_claim_is_there_once_and_in_the_order_of_the_paper(claims):
    assert list(claims) == list(GOLDEN)
    first, *rest = [claim.section for claim in claims.values()]
    assert first == "abstract"
    assert rest == sorted(rest)
    assert all(claim.id.startswith(f"{claim.section}-") for claim in claims.values())


def test_a_reader_can_read_them_all(claims):
    assert sum(not claim.misprint for claim in claims.values()) <= 50
    assert sum(claim.misprint for claim in claims.values()) == 8
    assert not set(withdrawn(BENCH)) & set(claims)


@pytest.mark.parametrize("claim_id", GOLDEN)
def test_verdict_and_numbers_are_as_pinned(claims, claim_id):
    claim, golden = claims[claim_id], GOLDEN[claim_id]
    assert claim.verdict == golden["verdict"]
    numbers = {name: claim.finding.values[name] for name in golden["numbers"]}
    # What is below 1e-13 is round-off.
    assert numbers == pytest.approx(golden["numbers"], rel=1e-5, abs=1e-13)


def test_every_claim_says_what_it_needs(claims):
    for claim in claims.values():
        assert claim.statement, claim.id
        assert claim.paper, claim.id
        assert claim.basis, claim.id
        if claim.verdict != NONE:
            assert claim.rule, claim.id
            # Something in the text must be a number wherever something was computed.
            assert re.search(r"\d", claim.finding.ours), claim.id
            assert claim.finding.values, claim.id
        assert all(math.isfinite(value) for value in claim.finding.values.values()), claim.id


def test_every_reading_that_misses_says_by_how_much(claims):
    for claim in claims.values():
        for reading in claim.finding.readings:
            assert bool(reading.miss) == (reading.holds is False), (claim.id, reading)
            if reading.holds is False:
                assert re.search(r"\d", reading.miss), (claim.id, reading)
        others = [reading.choice for reading in claim.finding.alternatives]
        assert all(others), claim.id
        assert len(set(others)) == len(others), claim.id


def test_figures_and_code_that_claims_name_exist(claims):
    recipes = find_recipes(BENCH)
    for claim in claims.values():
        assert set(claim.figures) <= set(recipes), claim.id
        file, line = claim.code.split(":")
        assert (ROOT / file).read_text(encoding="utf-8").splitlines()[int(line) - 1] == "@claim("


def test_works_that_claims_cite_are_in_the_references(claims):
    texts = to_text(list(claims.values()), {}).replace("\n", " ")
    flat = re.sub(r"\s+", " ", texts)
    names = "|".join(name.split()[0] for name in REFERENCES)
    cited = set(re.findall(rf"((?:{names})[\w .]*? (?:19|20)\d\d)", flat))
    assert cited <= set(REFERENCES)
    assert {name for name in REFERENCES if name in flat} == set(REFERENCES)


def test_claims_on_the_runs_stand_in_for_the_missing_table():
    runs = claims_of(BENCH, section4_runs)
    assert len(runs) == 10
    for claim in runs.values():
        # At least three sets of masses and lengths, ours among them.
        tagged = [
            r
            for r in claim.finding.readings
            if "Table 2" in r.missing or r.choice in SHORT.values()
        ]
        assert len(tagged) >= 3, claim.id


def test_the_text_has_every_definition(claims):
    flat = " ".join(to_text(list(claims.values()), DEFINITIONS).split())
    for term, meaning in DEFINITIONS.items():
        assert f"{term}: {meaning}" in flat


def test_definitions_carry_their_numbers():
    practical, moderate = DEFINITIONS["practical domain"], DEFINITIONS["moderate loads"]
    assert "0.0075 mm ≤ ΔR ≤ 2 mm" in practical
    assert "10 N/mm up to the lowest of 1000 N/mm" in practical
    assert "R_i = 10 mm" in practical
    assert "assumed" in practical
    assert "31.6 to 316 N/mm" in moderate


def test_the_readme_says_what_stands(claims):
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    assert what_stands(list(claims.values())) in readme


def test_without_a_mechanism_its_claims_are_not_testable(tmp_path):
    for claim in claims_of(Bench(tmp_path), section4, section4_runs).values():
        assert claim.verdict == NONE
        assert "slider_crank.toml: this spec does not exist" in claim.basis
