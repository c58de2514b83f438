"""The claims of the bench: pinned, computed once more, and their verdicts under other numbers."""

import dataclasses
import json
import math
import re
import time
from pathlib import Path

import numpy as np
import pytest
from _cylcontact_bench.claims import (
    section31_law,
    section34,
    section34_differences,
)
from _cylcontact_bench.extremes import best_load, largest_difference, share_below
from _cylcontact_bench.paper import (
    DEFINITIONS,
    JOHNSON_ONLY,
    MATERIALS,
    MODERATE,
    PRACTICAL,
    difference,
)
from scipy.optimize import minimize

from cylcontact.materials import shipped_materials
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import VERDICTS, Claim, counts, ledger, to_text
from tests.claim_files import STATICS, claims_of
from tests.paper_equations import difference as eq9
from tests.paper_equations import (
    e_star,
    effective_radius,
    johnson,
    johnson_end,
    yield_load,
)

ROOT = Path(__file__).parents[1]
BENCH = Bench(ROOT, jobs=2)
ROWS = shipped_materials()
# Verdict of every claim, and its headline numbers to more digits than are printed.
GOLDEN = json.loads((ROOT / "tests" / "golden" / "claims.json").read_text(encoding="utf-8"))
YES, CHOICE, NO, NONE = VERDICTS


@pytest.fixture(scope="session")
def claims() -> dict[str, Claim]:
    """The whole ledger, claim by id; the mechanism's cases take most of the time."""
    return {claim.id: claim for claim in ledger(BENCH)}


def compute(*modules, bench=BENCH) -> dict[str, Claim]:
    """Return the claims of some files of the bench, by id."""
    return claims_of(bench, *modules)


@pytest.fixture
def material_rows(monkeypatch):
    """Return a function that makes every bench have other rows in its table of materials."""

    def change(rows):
        monkeypatch.setattr(Bench, "material", lambda _bench, name: rows[name])

    return change


def with_material(row, **changes):
    return dataclasses.replace(row, material=dataclasses.replace(row.material, **changes))


# --- the ledger as a whole ---


def test_every_claim_is_there_once_and_in_the_order_of_the_paper(claims):
    assert list(claims) == list(GOLDEN)
    sections = [claim.section for claim in claims.values()]
    assert sections == sorted(sections)
    assert all(claim.id.startswith(f"{claim.section}-") for claim in claims.values())
    assert sum(counts(claims.values()).values()) == len(claims) == 103
    assert sections.count("4.3") == 20


@pytest.mark.parametrize("claim_id", GOLDEN)
def test_verdict_and_numbers_are_as_pinned(claims, claim_id):
    claim, golden = claims[claim_id], GOLDEN[claim_id]
    assert claim.verdict == golden["verdict"]
    numbers = {name: claim.ours_values[name] for name in golden["numbers"]}
    assert numbers == pytest.approx(golden["numbers"], rel=1e-5)


def test_every_claim_says_what_it_needs(claims):
    for claim in claims.values():
        for text in (claim.statement, claim.paper, claim.ours, claim.rule):
            assert text, claim.id
        assert claim.ours_values or claim.verdict == NONE, claim.id
        assert all(math.isfinite(value) for value in claim.ours_values.values()), claim.id
        # Something in the text must be a number wherever something was computed.
        assert re.search(r"\d", claim.ours) or claim.verdict == NONE, claim.id
        assert claim.choice or claim.verdict in (YES, NO), claim.id


def test_claims_without_a_mechanism_take_seconds():
    start = time.perf_counter()
    compute(*STATICS)
    assert time.perf_counter() - start < 10


def test_the_text_has_every_definition(claims):
    flat = " ".join(to_text(list(claims.values()), DEFINITIONS).split())
    for term, meaning in DEFINITIONS.items():
        assert f"{term}: {meaning}" in flat
    assert flat.endswith("103 in all")


def test_definitions_carry_their_numbers():
    practical, moderate = DEFINITIONS["practical domain"], DEFINITIONS["moderate loads"]
    assert "0.0075 mm ≤ ΔR ≤ 2 mm" in practical
    assert "10 N/mm up to the lowest of 1000 N/mm" in practical
    assert "R_i = 10 mm" in practical
    assert "assumed" in practical
    assert "31.6 to 316 N/mm" in moderate


def test_claims_that_rest_on_the_domains_name_them(claims):
    assert "'practical domain'" in claims["3.4-below-8-percent"].choice
    for claim_id in ("3.4-below-4-percent", "3.4-about-8-percent-at-25um", "5-below-10-percent"):
        assert "'moderate loads'" in claims[claim_id].choice
    for claim_id in ("3.4-below-8-percent", "3.4-below-4-percent"):
        assert "yield stress" in claims[claim_id].choice
        assert "(not reproduced)" in claims[claim_id].alternatives


# --- verdicts follow from the materials ---


def test_a_stiffer_material_gives_other_verdicts(material_rows):
    material_rows(ROWS | {"aluminium alloy": with_material(ROWS["aluminium alloy"], E=140e3)})
    changed = compute(section34)
    assert changed["3.4-limit-aluminium-7.5um"].verdict == NO
    assert changed["3.4-valid-at-1000"].verdict == NO
    assert changed["3.4-limit-titanium-7.5um"].verdict == CHOICE


def test_numbers_of_the_papers_own_need_no_choice(material_rows):
    material_rows(
        {
            name: dataclasses.replace(row, provenance=dict.fromkeys(row.provenance, "paper"))
            for name, row in ROWS.items()
        }
    )
    changed = compute(section34, section34_differences)
    assert changed["3.4-limit-aluminium-7.5um"].verdict == YES
    assert changed["3.4-valid-at-1000"].verdict == YES
    assert changed["3.4-below-8-percent"].choice == "'practical domain' as defined above"


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_the_bounds_do_not_hang_on_the_assumed_yield_stresses(claims, material_rows, factor):
    material_rows(
        {
            name: with_material(ROWS[name], yield_stress=factor * ROWS[name].material.yield_stress)
            for name in MATERIALS
        }
    )
    changed = compute(section34_differences)
    for claim_id in ("3.4-below-8-percent", "3.4-below-4-percent", "5-below-10-percent"):
        assert changed[claim_id].verdict == claims[claim_id].verdict


# --- numbers computed once more: Eqs 1, 5, 6, 7, 8 and 9 in plain Python, and finer grids ---


def test_the_closed_inverse_of_johnson_is_exact(claims):
    assert claims["2-johnson-needs-iteration"].ours_values["round trip error, -"] < 1e-14


def top_load(E_star, dR, yield_stress, highest=1000.0):
    """The largest load of the practical domain, R_i being 10 mm."""
    at_yield = yield_load(yield_stress, E_star, effective_radius(10.0, dR))
    return min(highest, at_yield, johnson_end(E_star, dR))


@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize(
    ("claim_id", "lowest", "highest"),
    [("3.4-below-8-percent", 10.0, 1000.0), ("3.4-below-4-percent", 10**1.5, 10**2.5)],
)
def test_largest_differences_from_the_equations(claims, name, claim_id, lowest, highest):
    material = ROWS[name].material
    E_star = e_star(material.E, material.nu)
    values = claims[claim_id].ours_values
    largest = 0.0
    for dR in np.geomspace(0.0075, 2.0, 241):
        top = top_load(E_star, dR, material.yield_stress, highest)
        if top > lowest:
            differences = eq9(np.geomspace(lowest, top, 81), E_star, dR)
            largest = max(largest, np.abs(differences).max())
    reported = abs(values[f"{name}, percent"])
    # The plain grid can only miss the top; it comes within its own resolution of it.
    assert largest <= reported * (1 + 1e-12)
    assert largest == pytest.approx(reported, rel=0.02)
    dR, load = values[f"{name}, dR, mm"], values[f"{name}, load, N/mm"]
    assert eq9(load, E_star, dR) == pytest.approx(values[f"{name}, percent"], rel=1e-9)
    assert lowest <= load <= top_load(E_star, dR, material.yield_stress, highest) * (1 + 1e-12)


def test_trough_by_an_optimiser(claims):
    E_star = e_star(200e3, 0.3)
    trough = minimize(
        lambda x: eq9(math.exp(x[0]), E_star, math.exp(x[1])),
        [math.log(100), math.log(0.02)],
        method="Nelder-Mead",
        options={"xatol": 1e-9, "fatol": 1e-12},
    )
    values = claims["3.4-peak-near-25um"].ours_values
    assert trough.fun == pytest.approx(values["difference, percent"], rel=1e-10)
    assert math.exp(trough.x[1]) == pytest.approx(values["dR, mm"], rel=1e-5)
    assert math.exp(trough.x[0]) == pytest.approx(values["low-carbon steel, N/mm"], rel=1e-5)


def test_difference_at_25_um_from_the_equations(claims):
    differences = eq9(np.geomspace(10**1.5, 10**2.5, 2001), e_star(200e3, 0.3), 0.025)
    largest = max(differences, key=abs)
    values = claims["3.4-about-8-percent-at-25um"].ours_values
    assert values["low-carbon steel, percent"] == pytest.approx(largest, rel=1e-6)


def test_lankarani_nikravesh_is_softest_as_a_closed_form_says(claims):
    # With f = 4πE*ΔR·exp(−l), F/(L·f) = (4/3)·√(R·δ)·(l − 1)/(π·L) is largest at l = 4, where
    # it is (8/π)·√3·e⁻²·√(R_i·R_j)/L; R_j is nearly R_i where that load is in the domain.
    largest = 8 / math.pi * math.sqrt(3) * math.exp(-2)
    values = claims["2-lankarani-nikravesh-softer"].ours_values
    for name in MATERIALS:
        assert values[f"{name}, largest, -"] == pytest.approx(largest, rel=1e-3)


# --- convergence ---


@pytest.mark.parametrize("domain", [PRACTICAL, MODERATE, JOHNSON_ONLY], ids=lambda d: d.label)
@pytest.mark.parametrize("name", MATERIALS)
def test_no_finer_grid_finds_a_larger_difference(name, domain):
    material = ROWS[name].material
    extreme = largest_difference(material, domain)
    u, v = np.linspace(0, 1, 1501), np.linspace(0, 1, 501)
    dR, load = domain.point(u[:, None], v[None, :], material)
    largest = np.nanmax(np.abs(difference(dR, load, material)))
    assert largest <= abs(extreme.percent) * (1 + 1e-12)
    assert largest == pytest.approx(abs(extreme.percent), rel=3e-3)


@pytest.mark.parametrize("name", MATERIALS)
def test_best_load_is_no_artefact_of_its_grid(name):
    material = ROWS[name].material
    extreme = best_load(material, PRACTICAL)
    dR = np.union1d(np.geomspace(0.0075, 2, 3001), 0.34954)
    top = PRACTICAL.top_load(dR, material)
    for load in np.geomspace(10, 1000, 151):
        worst = np.abs(difference(dR[load <= top], load, material)).max()
        assert worst >= abs(extreme.percent) - 1e-3
    assert abs(extreme.percent) > 4


def test_shares_are_those_of_random_points():
    # Points drawn uniformly on logarithmic axes over the whole rectangle; those beyond the
    # highest load are not in the domain.
    material = ROWS["low-carbon steel"].material
    rng = np.random.default_rng(1)
    dR = 0.0075 * (2 / 0.0075) ** rng.random(400_000)
    load = 10 * 100 ** rng.random(400_000)
    inside = load <= PRACTICAL.top_load(dR, material)
    below = np.abs(difference(dR[inside], load[inside], material)) < 8
    # Four standard errors of the share.
    assert share_below(8.0, material, PRACTICAL) == pytest.approx(100 * below.mean(), abs=0.2)


def test_share_of_the_box_served_by_one_exponent_from_the_box_itself(claims):
    loads, good = np.geomspace(10, 1000, 41), []
    for dR in np.geomspace(0.05, 10.0, 41):
        for E_star in e_star(np.geomspace(20.7e3, 1e7, 41), 0.3):
            inside = loads[loads <= johnson_end(E_star, dR)]
            x, y = np.log(johnson(inside, E_star, dR)), np.log(inside)
            residual = (y - 1.125 * x) - np.mean(y - 1.125 * x)
            good.append(1 - residual @ residual / np.sum((y - y.mean()) ** 2) > 0.998)
    served = claims["3.1-internal-no-single-n"].ours_values["served, percent"]
    # A cell of this grid in four is on the boundary's staircase.
    assert served == pytest.approx(100 * np.mean(good), abs=1.5)


# --- the calibration, judged by the committed results ---


RESULTS = BENCH.results_by_name()
CALIBRATION = {
    "3.1-best-correlation-internal",
    "3.1-best-correlation-external",
    "3.1-external-a",
    "3.1-external-b",
    "3.1-external-n",
    "3.1-several-runs",
}


def calibration(monkeypatch, results):
    """Return the claims on the fit with other results."""
    monkeypatch.setattr(Bench, "results_by_name", lambda _bench: results)
    return {k: claim for k, claim in compute(section31_law).items() if k in CALIBRATION}


def changed_result(name, **update):
    return RESULTS | {name: RESULTS[name].model_copy(update=update)}


@pytest.mark.parametrize("contact", ["internal", "external"])
def test_published_objective_over_the_refits(claims, contact):
    claim, result = claims[f"3.1-best-correlation-{contact}"], RESULTS[contact]
    ratio = result.published.objective / result.objective.value
    assert claim.ours_values[f"objective ratio on {contact}, -"] == pytest.approx(ratio, rel=1e-15)
    assert f"objective {ratio:.2f} times" in claim.ours
    # Only campaigns of the same contact with published coefficients on the same data.
    assert claim.ours_values.keys() == {
        f"objective ratio on {name}, -"
        for name, other in RESULTS.items()
        if other.contact == contact and other.published is not None
    }


@pytest.mark.parametrize(("name", "published"), [("a", 0.39), ("b", 0.85), ("n", 1.094)])
def test_external_coefficients(claims, name, published):
    claim, result = claims[f"3.1-external-{name}"], RESULTS["external-E1000"]
    value = result.coefficients[name]
    assert claim.paper_values == {f"{name}, -": published}
    assert claim.ours_values[f"{name} on external-E1000, -"] == value
    assert claim.holds == (abs(value / published - 1) <= 0.01)
    assert f"{value:.4g} ({value / published - 1:+.1%})" in claim.ours
    assert "explicit" not in claim.alternatives


def test_several_runs_counts_the_runs_in_a_worse_basin(claims):
    result = RESULTS["internal"]
    best = result.objective.value
    missed = sum(run.objective > 1.001 * best for run in result.runs)
    assert claims["3.1-several-runs"].ours_values == {"runs in a worse basin, -": missed}
    assert missed > 0


def test_verdicts_follow_from_the_results(monkeypatch):
    result = RESULTS["external"]
    better = result.published.model_copy(update={"objective": 1.005 * result.objective.value})
    changed = calibration(monkeypatch, changed_result("external", published=better))
    assert changed["3.1-best-correlation-external"].verdict == CHOICE
    other = RESULTS["external-E1000"].coefficients | {"a": 0.5, "b": 0.85}
    changed = calibration(monkeypatch, changed_result("external-E1000", coefficients=other))
    assert changed["3.1-external-a"].verdict == NO
    assert changed["3.1-external-b"].verdict == CHOICE
    best = min(RESULTS["internal"].runs, key=lambda run: run.objective)
    changed = calibration(monkeypatch, changed_result("internal", runs=[best]))
    assert changed["3.1-several-runs"].verdict == NO


def test_without_results_the_calibration_is_not_testable(monkeypatch):
    changed = calibration(monkeypatch, {})
    assert changed.keys() == CALIBRATION
    for claim in changed.values():
        assert claim.verdict == NONE
        assert claim.ours == ""
        assert not claim.ours_values
        assert claim.choice == "no fit result to compute it from; make fits produces them"
    assert "reason    no fit result" in to_text(list(changed.values()), {})


def test_results_of_other_campaigns_alone_do_not_judge(monkeypatch):
    changed = calibration(monkeypatch, {"practical": RESULTS["practical"]})
    claim = changed["3.1-best-correlation-internal"]
    assert claim.verdict == NONE
    assert "practical" in claim.alternatives
