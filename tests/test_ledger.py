"""The claims of the bench: pinned, computed once more, and their verdicts under other numbers."""

import dataclasses
import json
import math
import re
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from _cylcontact_bench.claims import (
    section4,
    section4_runs,
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
from _cylcontact_bench.slider_crank import AGAINST, mechanism, revolutions_of, statistics_table
from _cylcontact_bench.trends import Change, compare, is_trend, rule, tally, values_or_ratios
from scipy.optimize import minimize

from cylcontact.materials import shipped_materials
from cylcontact.mechanism import Case, simulate
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import VERDICTS, Claim, counts, ledger, to_text
from tests.claim_files import STATICS, claims_of
from tests.paper_equations import difference as eq9
from tests.paper_equations import (
    e_star,
    effective_radius,
    factor_and_exponent,
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


@pytest.fixture(scope="session")
def table() -> pd.DataFrame:
    """The statistics of the mechanism's cases."""
    return statistics_table(BENCH)


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


def test_claims_of_the_mechanism_say_what_is_assumed(claims):
    of_mechanism = [*compute(section4), *compute(section4_runs)]
    assert len(of_mechanism) == 25
    for claim_id in of_mechanism:
        assert "Table 2 is missing" in claims[claim_id].choice, claim_id


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


# --- the mechanism: each number again from the runs, and verdicts that follow from them ---


def from_table(monkeypatch, table):
    """Return the claims on the runs with other statistics."""
    monkeypatch.setattr(section4_runs, "statistics_table", lambda _bench: table)
    return compute(section4_runs)


def test_crossings_by_bisection_on_eqs_1_and_5(claims):
    """The penetration at which both laws give the same force, written out once more."""
    for clearance, claim_id, at in (
        (0.5, "4.3-johnson-stiffer-0.5mm", 27.7),
        (0.02, "4.3-enhanced-stiffer-0.02mm", 5.53),
    ):
        depth = max(v for k, v in claims[claim_id].ours_values.items() if "even" in k) * 1e-3
        E_star = e_star(207e3, 0.3)
        K, n = factor_and_exponent(E_star, clearance)
        assert johnson(K * depth**n, E_star, clearance) == pytest.approx(depth, rel=1e-5)
        assert 1e3 * depth == pytest.approx(at, rel=2e-3)


def test_the_violation_of_constraints_is_that_of_the_tolerance(claims):
    values = claims["4.2-baumgarte"].ours_values
    assert 0 < values["with it, m"] < 1e-9
    assert 0 < values["without, m"] < 1e-9


def test_steps_by_hand(claims, table):
    values = claims["4.3-small-clearance-larger-steps"].ours_values
    row = table[
        (table["law"] == "johnson")
        & (table["clearance"] == 0.02)
        & (table["restitution"] == 1.0)
        & (table["friction"] == 0.0)
    ].iloc[0]
    mean = (row["step_us"] + row[f"step_us{AGAINST}"]) / 2
    assert values["Johnson c_e = 1 c_f = 0, after, us"] == pytest.approx(mean, rel=1e-12)
    assert (
        values["Johnson c_e = 1 c_f = 0, after, us"] < values["Johnson c_e = 1 c_f = 0, before, us"]
    )


def test_settled_cases_have_several_stable_digits(table):
    """Those that do not hang on the tolerance."""
    settled = table[(table["clearance"] == 0.02) & (table["restitution"] == 0.9)]
    assert (settled["contact_fraction"] == 1.0).all()
    means = dict(
        zip(
            settled["law"] + settled["friction"].astype(str),
            settled["mean_penetration_um"],
            strict=True,
        )
    )
    assert means["enhanced0.0"] == pytest.approx(1.566, rel=2e-3)
    assert means["johnson0.1"] == pytest.approx(1.712, rel=2e-3)
    assert means["lankarani-nikravesh0.0"] == pytest.approx(2.604, rel=2e-3)


def test_other_numbers_give_other_verdicts(table, monkeypatch):
    """With steps, forces and contacts as the paper has them, everything is reproduced."""
    papers = table.copy()
    smooth = (papers["restitution"] < 1).astype(float) + 2 * (papers["clearance"] < 0.1)
    smooth += (papers["friction"] > 0) + 0.6 * (papers["law"] == "lankarani-nikravesh")
    for run in ("", AGAINST):
        papers[f"step_us{run}"] = 1 + smooth
        papers[f"contact_fraction{run}"] = 0.1 + 0.2 * smooth
        papers[f"impacts{run}"] = 100 - 10 * smooth
        papers[f"force_p99_N{run}"] = 1000 - 100 * smooth
        for column in ("step_us", "contact_fraction", "impacts", "force_p99_N"):
            papers[f"{column}_std{run}"] = 0.0
    changed = from_table(monkeypatch, papers)
    for claim_id in (
        "4.3-sphere-most-in-contact",
        "4.3-small-clearance-smoother",
        "4.3-friction-lowers-forces",
        "4.3-cylinders-higher-forces",
        "4.3-friction-larger-steps",
        "4.3-small-clearance-larger-steps",
        "4.3-cylinders-smaller-steps",
    ):
        assert changed[claim_id].verdict == CHOICE, claim_id


def change(*pairs, name="", freedom=4):
    """Return a change of values before and after with an error, by tolerance."""
    return Change(name, np.array(pairs, float).T, freedom)


def test_a_trend_needs_a_majority_and_no_reverse():
    up, flat, down = (
        change(*[(1.0, to, 0.1)] * 2, name=name) for name, to in (("u", 2), ("f", 1.1), ("d", 0))
    )
    assert is_trend([up, up, flat], 1)
    assert not is_trend([up, flat], 1)
    assert not is_trend([up, up, up, down], 1)
    assert is_trend([down], -1)
    assert tally([up, flat, down], 1) == (
        "in 1 of 3 pairs; the reverse in 1 (d); undecided in 1 (f)"
    )
    assert values_or_ratios([up] * 7, "{:g}") == "ratios from 2.00 to 2.00"
    assert "more than half of the 7 pairs by over 5% and beyond 95% confidence" in rule([up] * 7)


def test_a_change_has_a_sign_only_if_both_tolerances_agree():
    rise, fall = (1.0, 2.0, 0.01), (2.0, 1.0, 0.01)
    assert change(rise, rise).sign == 1
    assert change(fall, fall).sign == -1
    assert change(rise, fall).sign == 0
    # The tolerances rise by very different amounts: 0.5 and 0.1 of the larger.
    assert change(rise, (1.0, 1.111, 0.001)).sign == 0
    # However sure, 4 % is no change.
    assert change(*[(0.96, 1.0, 1e-6)] * 2).sign == 0
    assert change(*[(0.94, 1.0, 1e-6)] * 2).sign == 1
    # Student's t for 95 %: 2.776 with 4 degrees of freedom, 2.120 with 16.
    assert change(*[(1.0, 2.0, 1 / 2.7)] * 2).sign == 0
    assert change(*[(1.0, 2.0, 1 / 2.8)] * 2).sign == 1
    assert change(*[(1.0, 2.0, 1 / 2.2)] * 2, freedom=16).sign == 1
    assert change(*[(0.0, 0.0, 0.0)] * 2).sign == 0
    assert values_or_ratios([change((0.0, 1.0, 0.1))] * 7, "{:g}") == "from 0 in all"


def test_changes_pair_cases_that_differ_in_one_condition(table):
    changes = compare(table, "impacts", "friction", 0.0, 0.1)
    assert len(changes) == 12
    one = next(each for each in changes if each.name == "Johnson 0.5 mm c_e = 0.9")
    rows = table[
        (table["law"] == "johnson") & (table["clearance"] == 0.5) & (table["restitution"] == 0.9)
    ].set_index("friction")
    for (before, after, error), run in zip(one.by_run.T, ("", AGAINST), strict=True):
        impacts = rows[f"impacts{run}"]
        assert (before, after) == (impacts[0.0], impacts[0.1])
        assert error == pytest.approx(np.hypot(*rows[f"impacts_std{run}"]) / 5**0.5)
    assert one.before == rows.loc[0.0, ["impacts", f"impacts{AGAINST}"]].mean()
    assert one.freedom == 4


def test_the_second_run_is_at_a_tighter_tolerance_and_whirls_last_longer(table):
    case = Case("enhanced", 0.5, 0.9, 0.0)
    assert revolutions_of(case) == 8
    run = simulate(mechanism(BENCH, case), revolutions=8, tolerance=1e-9)
    row = table.iloc[[Case(*key) for key in table[list(vars(case))].to_numpy()].index(case)]
    mean = run.statistics(3).mean
    assert row[f"impacts{AGAINST}"] == mean["impacts"] != row["impacts"]
    assert row[f"force_p99_N{AGAINST}"] == mean["force_p99_N"]
    long = table[table["counted"] == 13]
    assert (long["clearance"] == 0.02).all()
    assert (long["restitution"] == 1.0).all()
    assert list(long["friction"]) == [0.1] * 3
    assert (table["counted"].drop(index=long.index) == 5).all()


def test_texts_follow_the_table(table, monkeypatch):
    other = table.copy()
    for run in ("", AGAINST):
        other[f"contact_fraction{run}"] = np.where(other["clearance"] == 0.5, 1.0, 0.3)
        other[f"force_p99_N{run}"] = np.where(other["friction"] > 0, 100.0, 200.0)
    text = from_table(monkeypatch, other)["4.3-dissipation-keeps-contact"].alternatives
    assert "without friction 3 of 3 at 0.5 mm and 0 of 3 at 0.02 mm" in text
    assert from_table(monkeypatch, other)["4.3-friction-lowers-forces"].alternatives == ""
    whirl = (other["law"] == "enhanced") & (other["clearance"] == 0.5)
    whirl &= (other["restitution"] == 1.0) & (other["friction"] > 0)
    other.loc[whirl, "force_p99_N"] = 900.0
    text = from_table(monkeypatch, other)["4.3-friction-lowers-forces"].alternatives
    assert text == (
        "in the mean it rises in 1 pairs: enhanced 0.5 mm c_e = 1 200 N → 500 N; over 20% apart "
        "at the two tolerances: enhanced 0.5 mm c_e = 1 c_f = 0.1 900 N and 100 N"
    )
    # One run of two is not enough for contact without end.
    other["contact_fraction"] = 1.0
    text = from_table(monkeypatch, other)["4.3-dissipation-keeps-contact"].ours
    assert text == "6 of 12 cases with c_e = 0.9 are in contact 99% of the time"


def test_laws_without_any_impact_can_be_compared(table, monkeypatch):
    other = table.copy()
    for run in ("", AGAINST):
        other.loc[other["law"] == "johnson", [f"impacts{run}", f"impacts_std{run}"]] = 0.0
        other.loc[other["law"] == "enhanced", f"impacts{run}"] = 10.0
        other.loc[other["law"] == "enhanced", f"impacts_std{run}"] = 0.1
    alike = from_table(monkeypatch, other)["4.3-johnson-and-enhanced-alike"]
    assert "impacts, 0.5 mm c_e = 0.9 c_f = 0.1 0 → 10" in alike.ours
    assert all(math.isfinite(value) for value in alike.ours_values.values())


def test_no_length_fits_if_the_lengths_are_further_apart_than_both_margins(claims):
    claim = claims["5-sphere-knows-no-length"]
    for clearance in ("0.5", "0.02"):
        least, largest = (
            claim.ours_values[f"{clearance} mm, {end}, mm of length"]
            for end in ("least", "largest")
        )
        assert largest / least > 1.1 / 0.9
    assert "within 10%" in claim.rule
    assert "1.22 times" in claim.rule


def test_without_a_mechanism_its_claims_are_not_testable(tmp_path):
    for claim in compute(section4, section4_runs, bench=Bench(tmp_path)).values():
        assert claim.verdict == NONE
        assert "slider_crank.toml: this spec does not exist" in claim.choice
