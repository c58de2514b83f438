"""The claims on the slider-crank, and the long runs that they rest on."""

import json
import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from _cylcontact_bench import long_runs, trends
from _cylcontact_bench.claims import section4, section4_runs
from _cylcontact_bench.long_runs import (
    FIRST,
    LIGHT_SET,
    LONG_SET,
    PLAN,
    SETS,
    SPEC_SET,
    LongRun,
    key_of,
    statistics_table,
)
from _cylcontact_bench.slider_crank import CASES, mechanism
from _cylcontact_bench.trends import Change, Judgement, compare, mostly, trend
from scipy.stats import ttest_ind_from_stats

from cylcontact.mechanism import Case, long_run, simulate
from cylcontact.reports.bench import Bench
from tests.support.claim_files import claims_of
from tests.support.paper_equations import e_star, factor_and_exponent
from tests.support.spec_files import changed

ROOT = Path(__file__).parents[2]
BENCH = Bench(ROOT, jobs=2)
JOURNAL = ROOT / long_runs.LONG_RUNS
E_STAR = e_star(207e3, 0.3)
SPEC = mechanism(BENCH).data


@pytest.fixture(scope="module")
def claims():
    return claims_of(BENCH, section4, section4_runs)


@pytest.fixture(scope="module")
def table():
    return statistics_table(BENCH)


@pytest.fixture
def small(tmp_path, monkeypatch):
    """Return a bench of its own, whose plan is three short runs."""
    (tmp_path / "reports").symlink_to(ROOT / "reports")
    (tmp_path / "datasets").mkdir()
    spec = (ROOT / "datasets/slider_crank.toml").read_text(encoding="utf-8")
    (tmp_path / "datasets/slider_crank.toml").write_text(spec, encoding="utf-8")
    bench = Bench(tmp_path)
    # Another bench's tests may have made the modules anew.
    module = bench.module("long_runs")
    smooth, rough = (Case("enhanced", 0.5, 0.9, friction) for friction in (0.0, 0.1))
    plan = [
        module.LongRun(design, case, FIRST + 2)
        for design, case in ((SPEC_SET, smooth), (SPEC_SET, rough), (LIGHT_SET, rough))
    ]
    monkeypatch.setattr(module, "PLAN", plan)
    return bench


NUMBER = ("x, old → new", "{:g} m", "m")


def row_of(table, case):
    """Return a case's row of the table."""
    rows = table
    for name, value in vars(case).items():
        rows = rows[rows[name] == value]
    return rows.iloc[0]


def recorded():
    """Return the lines of the committed journal by their keys."""
    lines = JOURNAL.read_text(encoding="utf-8").splitlines()[1:]
    return {entry["key"]: entry for entry in map(json.loads, lines)}


class TestLongRuns:
    def test_the_journal_has_every_run_and_is_small(self):
        assert {key_of(run, SPEC) for run in PLAN} == recorded().keys()
        assert len(PLAN) == 24 * 5 + 8
        assert JOURNAL.stat().st_size < 300_000

    @pytest.mark.slow
    def test_a_periodic_run_comes_out_again(self):
        """Contact without end is not sensitive: other machines agree to many digits."""
        case = Case("lankarani-nikravesh", 0.02, 0.9, 0.1)
        run = next(run for run in PLAN if run.design == LONG_SET and run.case == case)
        key = key_of(run, SPEC)
        kept = recorded()[key]
        again = long_runs.entry(json.dumps(SPEC), key, run.design, run.case, run.revolutions)
        assert kept["period"] == again["period"] == 1
        assert kept["counted"] == again["counted"] == 1000
        for name in ("mean_penetration_um", "mean_force_N", "drive_work_J", "contact_fraction"):
            assert again["mean"][name] == pytest.approx(kept["mean"][name], rel=1e-6)

    def test_an_entry_is_that_of_the_steps(self):
        """Durations and the mean step, from the steps themselves."""
        case = Case("johnson", 0.5, 1.0, 0.1)
        run = simulate(LongRun(SPEC_SET, case, 12).mechanism(SPEC), revolutions=12)
        found = long_runs.entry(json.dumps(SPEC), "", SPEC_SET, case, 12)["mean"]
        begin = FIRST * run.mechanism.period
        dt, late = np.diff(run.time), run.time[1:] > begin * (1 + 1e-12)
        touching = run.in_contact[1:]
        onsets = (run.contacts["onset_s"] > begin).sum()
        assert found["impacts"] == onsets / 2
        inside, outside = (dt[late & part].sum() for part in (touching, ~touching))
        assert found["contact_us"] == pytest.approx(1e6 * inside / onsets, rel=1e-8)
        assert found["flight_us"] == pytest.approx(1e6 * outside / onsets, rel=1e-8)
        assert found["step_us"] == pytest.approx(
            1e6 * dt[late].sum() / np.count_nonzero(dt[late]), rel=1e-8
        )

    def test_the_key_is_of_all_that_numbers_depend_on(self):
        run = LongRun(SPEC_SET, CASES[0], 20)
        keys = {
            key_of(each, data)
            for each in (run, LongRun(LIGHT_SET, CASES[0], 20), LongRun(SPEC_SET, CASES[1], 20))
            for data in (
                SPEC,
                SPEC | {"integration": SPEC["integration"] | {"tolerance": 1e-9}},
                changed(SPEC, {"joint.wrist-pin.pin.E": 200.0}),
            )
        }
        assert len(keys) == 9
        assert key_of(LongRun(SPEC_SET, CASES[0], 21), SPEC) not in keys
        told = SPEC | {"name": "another name"}
        assert key_of(run, told) == key_of(run, SPEC)

    def test_another_law_has_another_key(self, monkeypatch):
        run = LongRun(SPEC_SET, Case("johnson", 0.5, 0.9, 0.0), 20)
        before = key_of(run, SPEC)
        law = long_runs.LAWS["johnson"]
        load = law.load
        monkeypatch.setattr(law, "load", lambda self, depth, pair: 1.001 * load(self, depth, pair))
        assert key_of(run, SPEC) != before

    def test_a_changed_spec_is_run_anew(self, small):
        long_runs = small.module("long_runs")
        first = long_runs.long_runs(small)
        file = small.input(long_runs.LONG_RUNS)
        assert len(file.read_text(encoding="utf-8").splitlines()) == 1 + 3
        spec = small.root / "datasets/slider_crank.toml"
        text = spec.read_text(encoding="utf-8").replace("mass = 0.14", "mass = 0.2")
        spec.write_text(text, encoding="utf-8")
        second = long_runs.long_runs(small)
        assert len(file.read_text(encoding="utf-8").splitlines()) == 1 + 6
        forces = [runs["mean"].iloc[1]["mean_force_N"] for runs in (first, second)]
        assert forces[1] > 1.1 * forces[0]

    def test_an_interrupted_command_resumes(self, small, monkeypatch):
        ran = []
        long_runs = small.module("long_runs")
        prepare, entry = small.module("claims.section4_runs").prepare, long_runs.entry

        def counted(*arguments):
            ran.append(arguments[1])
            return entry(*arguments)

        def interrupt(_stage, done, _total):
            if done == 1:
                raise KeyboardInterrupt

        monkeypatch.setattr(long_runs, "entry", counted)
        with pytest.raises(KeyboardInterrupt):
            prepare(small, interrupt)
        assert len(ran) == 1
        told = []
        prepare(small, lambda *call: told.append(call))
        assert len(ran) == len(set(ran)) == 3
        assert told[0] == ("long runs", 1, 3)
        assert told[-1] == ("long runs", 3, 3)

    def test_sets_differ_as_they_say(self):
        ours, light, long = (
            LongRun(name, CASES[0], 1).mechanism(SPEC).data["bodies"] for name in SETS
        )
        assert ours == SPEC["bodies"]
        for body, data in light.items():
            assert data["mass"] == 0.5 * ours[body]["mass"]
            assert data["inertia"] == 0.5 * ours[body]["inertia"]
        span = np.subtract(*long["rod"]["points"].values())
        assert math.hypot(*span) == pytest.approx(0.16)
        # A uniform rod.
        assert long["rod"]["inertia"] == pytest.approx(0.28 * 0.16**2 / 12, rel=0.01)

    @pytest.mark.parametrize(
        ("case", "column", "value", "half_width"),
        [
            ((0.5, 1.0, 0.1), "contact_fraction", 0.1523, 0.0016),
            ((0.5, 1.0, 0.1), "impacts", 40.5, 0.3),
            ((0.5, 1.0, 0.1), "mean_penetration_um", 15.75, 0.2),
            ((0.5, 1.0, 0.1), "mean_force_N", 10717, 118),
            ((0.5, 0.9, 0.1), "mean_penetration_um", 3.235, 0.0005),
            ((0.02, 1.0, 0.1), "contact_fraction", 0.80, 0.03),
            ((0.02, 0.9, 0.0), "mean_penetration_um", 1.7188, 0.0001),
            ((0.02, 0.9, 0.1), "mean_penetration_um", 1.7112, 0.0001),
        ],
    )
    def test_numbers_of_another_program(self, table, case, column, value, half_width):
        """Johnson's law in a solver of its own, over 2000 revolutions, with 95 % intervals."""
        row = row_of(table, Case("johnson", *case))
        assert row[column] == pytest.approx(
            value, abs=math.hypot(half_width, row[f"{column}_half_width"])
        )

    def test_without_losses_a_half_width_is_the_scatter_over_the_window(self, table):
        lossless = (table["restitution"] == 1.0) & (table["friction"] == 0.0)
        assert (table.loc[lossless, "impacts_half_width"] > 0).all()
        assert table["impacts_half_width"].notna().all()
        for window, has in (("8", False), ("60", True), ("1-8", False)):
            rows = statistics_table(BENCH, window=window)[lossless]
            assert (rows["impacts_half_width"].notna() == has).all(), window
        assert set(table.loc[lossless, "counted"]) == {240}
        assert set(table.loc[~lossless, "counted"]) == {1000}

    def test_the_scatter_of_20_batches(self):
        """Impacts per revolution and the mean force, from the sums of 20 batches of two."""
        case = Case("johnson", 0.5, 1.0, 0.0)
        found = long_runs.entry(json.dumps(SPEC), "", SPEC_SET, case, FIRST + 40)
        run = long_run(LongRun(SPEC_SET, case, 1).mechanism(SPEC), FIRST + 40, FIRST)
        sums = run.by_revolution[["impacts", "impulse_N_s", "contact_time_s"]].to_numpy()
        impacts, impulse, time = sums.reshape(20, 2, 3).sum(axis=1).T
        student = 2.0930240544082634  # 95 %, 19 degrees
        error = (impacts / 2).std(ddof=1) / 20**0.5
        assert found["half_width"]["impacts"] == pytest.approx(student * error, rel=1e-8)
        ratio = impulse.sum() / time.sum()
        error = np.sqrt(((impulse - ratio * time) ** 2).sum() / (20 * 19)) / time.mean()
        assert found["mean"]["mean_force_N"] == pytest.approx(ratio, rel=1e-8)
        assert found["half_width"]["mean_force_N"] == pytest.approx(student * error, rel=1e-8)

    def test_a_window_replaces_the_lossless_runs_alone(self, table):
        short = statistics_table(BENCH, window="8")
        lossless = (table["restitution"] == 1.0) & (table["friction"] == 0.0)
        assert (short["impacts"] != table["impacts"])[lossless].all()
        assert (short["flight_fraction"] == 1 - short["contact_fraction"]).all()
        pd.testing.assert_frame_equal(short[~lossless], table[~lossless])
        start = statistics_table(BENCH, window="1-8")
        rough = row_of(start, Case("enhanced", 0.5, 0.9, 0.1))
        run = simulate(mechanism(BENCH, Case("enhanced", 0.5, 0.9, 0.1)), revolutions=8)
        assert rough["impacts"] == run.statistics().mean["impacts"] > 0


class TestTrends:
    def test_margin_is_welchs(self):
        """At a difference of one margin the two-sided test has p = 5 %."""
        change = Change("", 10.0, 12.0, (0.5, 1.5))
        errors = np.array(change.half_widths) / 2.0930240544082634  # Student's t, 19 degrees
        apart = 10.0 * change.margin
        p = ttest_ind_from_stats(
            0, errors[0] * 20**0.5, 20, apart, errors[1] * 20**0.5, 20, equal_var=False
        ).pvalue
        assert p == pytest.approx(0.05, rel=1e-9)

    def test_kinds(self):
        sure, wide = (0.01, 0.01), (1.0, 1.0)
        assert Change("", 1.0, 2.0, sure).kind(1) == "shows"
        assert Change("", 1.0, 2.0, sure).kind(-1) == "reverse"
        assert Change("", 1.0, 1.02, sure).kind(1) == "equal"
        assert Change("", 1.0, 0.8, wide).kind(1) == "open"
        # A fall beyond its interval, but perhaps of less than 5 %, is no failure.
        assert Change("", 1.0, 0.93, (0.02, 0.02)).kind(1) == "open"
        assert Change("", 0.0, 0.0, (0.0, 0.0)).kind(1) == "equal"
        # A rise beyond its interval shows only if it is of more than 5 % of the first value.
        assert Change("", 1.0, 1.06, sure).kind(1) == "shows"
        assert Change("", 1.0, 1.04, sure).kind(1) == "open"
        assert Change("", 1.0, 1.2, (0.3, 0.3)).kind(1) == "open"
        assert Change("", 0.0, 1.0, sure).kind(1) == "shows"

    def test_a_trend_fails_by_a_reverse_and_never_by_low_power(self):
        up, flat = Change("u", 1.0, 2.0), Change("f", 1.0, 1.0)
        down, wide = Change("d", 2.0, 1.0), Change("w", 1.0, 0.5, (1.0, 1.0))
        judged = {
            "holds": trend([up, flat], 1, "up", NUMBER),
            "reverse": trend([up, up, down], 1, "up", NUMBER),
            "open": trend([up, up, wide], 1, "up", NUMBER),
            "equal": trend([flat, flat], 1, "up", NUMBER),
            "few": trend([up, flat, flat], 1, "up", NUMBER),
        }
        assert {name: each.holds for name, each in judged.items()} == {
            "holds": True, "reverse": False, "open": None, "equal": False, "few": None,
        }  # fmt: skip
        assert judged["reverse"].miss == "1 of 3 the other way, most d -50 %"
        assert judged["reverse"].values["d, before, m"] == 2.0

    def test_a_majority(self):
        up, down, wide = Change("", 1, 2), Change("", 2, 1), Change("", 1, 2, (9.0, 9.0))
        assert mostly([up, up, down], 1, "up").holds is True
        assert mostly([up, down, wide], 1, "up").holds is None
        assert mostly([up, down, down], 1, "up").holds is False

    def test_changes_pair_cases_that_differ_in_one_condition(self, table):
        changes = compare(table, "impacts", "friction", 0.0, 0.1)
        assert len(changes) == 16
        one = next(each for each in changes if each.name == "Johnson 0.5 mm c_e = 0.9")
        rows = [row_of(table, Case("johnson", 0.5, 0.9, friction)) for friction in (0.0, 0.1)]
        assert (one.before, one.after) == tuple(row["impacts"] for row in rows)
        assert one.half_widths == tuple(row["impacts_half_width"] for row in rows)
        # The duration of flights exists only where there are some.
        flights = compare(table, "flight_us", "friction", 0.0, 0.1, {"clearance": [0.5]})
        names = ("Lankarani–Nikravesh", "Johnson", "enhanced", "explicit")
        assert [each.name for each in flights] == [f"{name} c_e = 1" for name in names]


class TestClaims:
    def test_figures_exist(self, claims):
        drawn = {path.stem for path in (ROOT / "reports").glob("fig*.py")} | {"fig18", "fig19"}
        assert {name for claim in claims.values() for name in claim.figures} <= drawn

    def test_an_uncertain_share_cannot_tell(self, table):
        judge = section4_runs.cases_above({"law": ["johnson"]}, 0.5, trends.every)
        shares = table.assign(contact_fraction=0.6, contact_fraction_half_width=0.2)
        assert judge(shares).holds is None
        assert judge(shares.assign(contact_fraction_half_width=0.05)).holds is True
        low = judge(shares.assign(contact_fraction=0.1))
        assert (low.holds, low.miss) == (False, "0 of 8, the lowest share 10 %")
        assert isinstance(low, Judgement)

        contact = judge(shares.assign(contact_fraction=1.0, contact_fraction_half_width=0.0))
        assert contact.ours == "all 8 trajectories are in contact all the time"

    def test_numbers_that_are_alike(self, table):
        judge = section4_runs.alike({"clearance": [0.5], "restitution": [0.9], "friction": [0.1]})
        assert judge(table).holds is True
        other = table.copy()
        other.loc[other["law"] == "enhanced", "mean_force_N"] *= 2
        assert judge(other).holds is False
        assert "mean force" in judge(other).ours

    def test_johnson_left_at_the_small_clearance(self, claims):
        claim = claims["4.3-johnson-within-its-domain"]
        values = claim.finding.values
        assert values["limit, um"] == pytest.approx(4e3 * 0.02 / math.e**2, rel=1e-9)
        holds = {
            reading.choice.partition(";")[0]: reading.holds for reading in claim.finding.readings
        }
        assert holds["all runs at 0.02 mm, from the start"] is False
        assert holds["c_e = 0.9"] is True
        assert holds["c_e = 1 without friction"] is holds["c_e = 1 with friction"] is False
        assert values["left, share of revolutions"] == pytest.approx(231 / 250)

    def test_the_sphere_is_the_softest_by_eqs_1_2_and_5(self, claims):
        largest = claims["4.3-sphere-softest"].finding.values["enhanced at 0.02 mm, -"]
        depth = 1e-3 * 1e6 * simulate(
            mechanism(BENCH, Case("enhanced", 0.02, 0.9, 0.0)), revolutions=1
        ).contacts["max_penetration_m"].iloc[0]  # fmt: skip
        K, n = factor_and_exponent(E_STAR, 0.02)
        radius = 10.0 * 9.98 / 0.02
        ratio = 4 / 3 * E_STAR * math.sqrt(radius) * depth**1.5 / (10.0 * K * depth**n)
        assert largest == pytest.approx(ratio, rel=1e-4)

    def test_without_a_mechanism_claims_are_not_testable(self, tmp_path):
        bench = Bench(tmp_path)
        section4_runs.prepare(bench, lambda *_call: None)
        for claim in claims_of(bench, section4, section4_runs).values():
            assert claim.verdict == "not testable"
            assert "slider_crank.toml: this spec does not exist" in claim.basis
