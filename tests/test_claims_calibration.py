"""The claims about the calibration: judged by the committed results, not testable without."""

import dataclasses
import math
from pathlib import Path

import pytest

from cylcontact.fitting import FitResult
from cylcontact.materials import shipped_materials
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Claim, calibration_claims, ledger, to_text

ROOT = Path(__file__).parents[1]
RESULTS = Bench(ROOT).results_by_name()
CHOICE, NO = "reproduced with a stated choice", "not reproduced"
IDS = (
    "3.1-best-correlation-internal",
    "3.1-best-correlation-external",
    "3.1-external-a",
    "3.1-external-b",
    "3.1-external-n",
    "3.1-several-runs",
)


def by_id(results: dict[str, FitResult]) -> dict[str, Claim]:
    return {claim.id: claim for claim in calibration_claims(results)}


@pytest.fixture(scope="module")
def claims() -> dict[str, Claim]:
    return by_id(RESULTS)


def changed(name: str, **update: object) -> dict[str, FitResult]:
    """Return the committed results with one of them changed."""
    return RESULTS | {name: RESULTS[name].model_copy(update=update)}


def test_every_claim_is_there_in_order(claims):
    assert tuple(claims) == IDS


@pytest.mark.parametrize(
    ("claim_id", "verdict"), list(zip(IDS, (NO, NO, CHOICE, NO, CHOICE, CHOICE), strict=True))
)
def test_verdicts_on_the_committed_results(claims, claim_id, verdict):
    assert claims[claim_id].verdict == verdict


@pytest.mark.parametrize("contact", ["internal", "external"])
def test_published_objective_over_the_refits(claims, contact):
    claim, result = claims[f"3.1-best-correlation-{contact}"], RESULTS[contact]
    ratio = result.published.objective / result.objective.value
    assert claim.ours_values[f"objective ratio on {contact}, -"] == pytest.approx(ratio, rel=1e-15)
    assert f"objective {ratio:.2f} times" in claim.ours
    # Only campaigns of the same contact with published coefficients on the same data.
    told = {name for name, r in RESULTS.items() if r.contact == contact and r.published is not None}
    assert claim.ours_values.keys() == {f"objective ratio on {name}, -" for name in told}


@pytest.mark.parametrize(("name", "published"), [("a", 0.39), ("b", 0.85), ("n", 1.094)])
def test_external_coefficients(claims, name, published):
    claim, result = claims[f"3.1-external-{name}"], RESULTS["external-E1000"]
    found = result.coefficients[name]
    assert claim.paper_values == {f"{name}, -": published}
    assert claim.ours_values[f"{name} on external-E1000, -"] == found
    assert claim.holds == (abs(found / published - 1) <= 0.01)
    assert f"{found:.4g} ({found / published - 1:+.1%})" in claim.ours
    assert "explicit" not in claim.alternatives


def test_several_runs_counts_the_runs_in_a_worse_basin(claims):
    result = RESULTS["internal"]
    best = result.objective.value
    missed = sum(run.objective > 1.001 * best for run in result.runs)
    assert claims["3.1-several-runs"].ours_values == {"runs in a worse basin, -": missed}
    assert missed > 0


def test_verdicts_follow_from_the_results():
    result = RESULTS["external"]
    better = result.published.model_copy(update={"objective": 1.005 * result.objective.value})
    found = by_id(changed("external", published=better))
    assert found["3.1-best-correlation-external"].verdict == CHOICE
    other = RESULTS["external-E1000"].coefficients | {"a": 0.5, "b": 0.85}
    found = by_id(changed("external-E1000", coefficients=other))
    assert found["3.1-external-a"].verdict == NO
    assert found["3.1-external-b"].verdict == CHOICE
    best = min(RESULTS["internal"].runs, key=lambda run: run.objective)
    assert by_id(changed("internal", runs=[best]))["3.1-several-runs"].verdict == NO


def test_without_results_nothing_is_testable_and_the_reason_is_told():
    found = by_id({})
    assert tuple(found) == IDS
    for claim in found.values():
        assert claim.verdict == "not testable"
        assert claim.ours == ""
        assert not claim.ours_values
        assert claim.choice == "no fit result to compute it from; make fits produces them"
    assert "reason    no fit result" in to_text(list(found.values()))


def test_results_of_other_campaigns_alone_do_not_judge():
    found = by_id({"practical": RESULTS["practical"]})
    claim = found["3.1-best-correlation-internal"]
    assert claim.verdict == "not testable"
    assert "practical" in claim.alternatives


def test_they_join_the_ledger(claims):
    rows = shipped_materials()
    whole = ledger(rows, claims.values())
    assert [claim.id for claim in whole if claim.id in claims] == list(IDS)
    assert [claim.section for claim in whole] == sorted(claim.section for claim in whole)


def test_every_claim_says_what_it_needs(claims):
    for claim in claims.values():
        for text in (claim.statement, claim.paper, claim.ours, claim.rule, claim.choice):
            assert text, claim.id
        assert all(math.isfinite(value) for value in claim.ours_values.values())
        assert dataclasses.replace(claim, holds=None).verdict == "not testable"
