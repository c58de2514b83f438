"""The claims of the bench: pinned, computed once more, and their verdicts under other numbers."""

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
)
from _cylcontact_bench.paper import (
    DEFINITIONS,
)
from _cylcontact_bench.slider_crank import AGAINST, mechanism, revolutions_of, statistics_table
from _cylcontact_bench.trends import Change, compare, is_trend, rule, tally, values_or_ratios

from cylcontact.mechanism import Case, simulate
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import VERDICTS, Claim, counts, ledger, to_text
from tests.claim_files import STATICS, claims_of
from tests.paper_equations import (
    e_star,
    factor_and_exponent,
    johnson,
)

ROOT = Path(__file__).parents[1]
BENCH = Bench(ROOT, jobs=2)
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


# --- numbers computed once more: Eqs 1, 5, 6, 7, 8 and 9 in plain Python, and finer grids ---


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
