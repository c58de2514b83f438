"""The ledger as a whole: every claim pinned, none lost, each with what a referee would ask for."""

import json
import re
from pathlib import Path

import pytest
from _cylcontact_bench.paper import REFERENCES

from cylcontact.reports.bench import Bench
from cylcontact.reports.build import find_recipes
from cylcontact.reports.claims import Claim, ledger, withdrawn
from cylcontact.reports.claims_text import to_text, what_stands

pytestmark = pytest.mark.slow


ROOT = Path(__file__).parents[2]
BENCH = Bench(ROOT, jobs=2)
# Verdict of every claim, which of its readings hold, and its numbers.
GOLDEN = json.loads((ROOT / "tests" / "golden" / "claims.json").read_text(encoding="utf-8"))


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
def test_verdict_readings_and_numbers_are_as_pinned(claims, claim_id):
    claim, golden = claims[claim_id], GOLDEN[claim_id]
    assert claim.verdict == golden["verdict"]
    assert [reading.holds for reading in claim.finding.readings] == golden["readings"]
    # What is below 1e-13 is round-off.
    assert dict(claim.finding.values) == pytest.approx(golden["numbers"], rel=1e-5, abs=1e-13)


def test_every_reading_that_misses_says_by_how_much(claims):
    for claim in claims.values():
        for reading in claim.finding.readings:
            assert bool(re.search(r"\d", reading.miss)) == (reading.holds is False), claim.id
        others = [reading.choice for reading in claim.finding.alternatives]
        assert all(others), claim.id
        assert len(set(others)) == len(others), claim.id


def test_figures_that_claims_name_exist(claims):
    recipes = set(find_recipes(BENCH))
    assert {name for claim in claims.values() for name in claim.figures} <= recipes


def test_works_that_claims_cite_are_in_the_references(claims):
    texts = to_text(list(claims.values()), {}).replace("\n", " ")
    flat = re.sub(r"\s+", " ", texts)
    names = "|".join(name.split()[0] for name in REFERENCES)
    cited = set(re.findall(rf"((?:{names})[\w .]*? (?:19|20)\d\d)", flat))
    assert cited <= set(REFERENCES)
    assert {name for name in REFERENCES if name in flat} == set(REFERENCES)


def test_the_readme_says_what_stands(claims):
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    assert what_stands(list(claims.values())) in readme
