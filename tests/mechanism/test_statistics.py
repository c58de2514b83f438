"""Statistics of runs: intervals, trends and periods on series known in advance, and long runs."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from cylcontact import InputError
from cylcontact.mechanism import Interrupted, long_run, simulate
from cylcontact.mechanism.batch_means import BatchMeans
from cylcontact.mechanism.joint_motion import Limits, numbers_of
from cylcontact.mechanism.statistics import HELD, LONGEST, QUANTITIES, REPEATS, period_of
from tests.support.mechanism_cases import slider_crank


def autoregressive(correlation, runs, length, seed):
    """Stationary AR(1) series of mean 5 and unit variance, shape (length, runs)."""
    noise = np.random.default_rng(seed).standard_normal((length, runs))
    series = np.empty_like(noise)
    series[0] = noise[0]
    for k in range(1, length):
        series[k] = correlation * series[k - 1] + np.sqrt(1 - correlation**2) * noise[k]
    return 5.0 + series


def means_of(series):
    """Batch means of plain means."""
    return BatchMeans.of(series, np.ones_like(series))


class TestIntervals:
    def test_their_width_is_that_of_the_known_autocorrelation(self):
        """The variance of a mean of n is (1 + ρ)/(1 − ρ)/n."""
        found = means_of(autoregressive(0.5, 400, 1000, seed=2))
        expected = stats.t.ppf(0.975, 19) * np.sqrt(3.0 / 1000)
        assert np.sqrt(np.mean(found.half_width(0.95) ** 2)) == pytest.approx(expected, rel=0.1)

    def test_that_of_plain_means_is_students_of_the_batches(self):
        series = autoregressive(0.3, 1, 100, seed=3)
        batches = series.reshape(20, 5).mean(axis=1)
        low, high = stats.t.interval(0.9, 19, batches.mean(), stats.sem(batches))
        found = means_of(series)
        assert found.ratio[0] == pytest.approx(series.mean(), rel=1e-14)
        assert found.half_width(0.9)[0] == pytest.approx((high - low) / 2, rel=1e-12)

    def test_a_ratio_of_sums_is_not_a_mean_of_ratios_and_its_interval_holds_it(self):
        """Penetration over a time that is long where it is deep: E(xy)/E(y) with y = x is 1.25."""
        generator = np.random.default_rng(4)
        time = 1 + 0.5 * generator.choice([-1.0, 1.0], (1000, 400))
        depth = time + 0.1 * generator.standard_normal(time.shape)
        found = BatchMeans.of(depth * time, time)
        assert found.ratio.mean() == pytest.approx(1.25, abs=0.002)
        assert depth.mean() == pytest.approx(1.0, abs=0.01)
        held = np.abs(found.ratio - 1.25) < found.half_width(0.95)
        assert 0.90 < held.mean() < 0.98

    @pytest.mark.parametrize(("revolutions", "batches"), [(7, 0), (8, 4), (11, 5), (1000, 20)])
    def test_short_runs_have_fewer_batches_or_none(self, revolutions, batches):
        found = means_of(autoregressive(0.0, 3, revolutions, seed=5))
        assert found.batches == batches
        assert np.isnan(found.half_width(0.95)).all() == (batches == 0)
        assert not (batches == 0 and (found.drifts.any() or found.correlated.any()))


class TestTrends:
    def test_one_in_a_hundred_stationary_series_is_called_drifting(self):
        found = means_of(autoregressive(0.5, 4000, 400, seed=6))
        assert 0.005 < found.drifts.mean() < 0.02
        assert 0.005 < means_of(autoregressive(0.0, 4000, 400, seed=7)).correlated.mean() < 0.02

    def test_what_a_run_that_settles_still_moves_is_no_drift(self):
        settling = 5.0 + 1e-6 * np.exp(-np.arange(100.0) / 30)[:, None]
        found = means_of(settling)
        assert not found.drifts[0]
        assert not found.correlated[0]
        assert means_of(5.0 + 1e5 * (settling - 5.0)).drifts[0]


class TestPeriods:
    @pytest.mark.parametrize("period", range(1, LONGEST + 1))
    def test_the_shortest_one_is_found(self, period):
        points = np.resize(np.arange(period, dtype=float), 80)[:, None] * [1.0, -2.0]
        assert period_of(points) == period
        assert period_of(points + 0.9 * REPEATS * np.resize([0.0, 1.0], (80, 1))) == period

    def test_there_is_none_where_a_section_differs_or_it_is_longer(self):
        assert period_of(np.resize(np.arange(LONGEST + 1.0), 90)[:, None]) == 0
        still = np.zeros((80, 2))
        still[-HELD, 1] = 2 * REPEATS
        assert period_of(still) == 0
        still[-HELD, 1], still[: -HELD - 1] = 0.0, 1.0
        assert period_of(still) == 1  # only the end counts

    def test_a_short_run_cannot_say(self):
        assert period_of(np.zeros((HELD, 1))) is None
        assert period_of(np.resize([0.0, 1.0], (HELD + 1, 1))) is None
        assert period_of(np.zeros((HELD + 1, 1))) == 1


@pytest.fixture(scope="module")
def sensitive():
    """A run that flies, and touches in every revolution."""
    return simulate(slider_crank("johnson", 0.5, 0.9, 0.0), revolutions=40)


def reproducible(statistics):
    return statistics.revolutions.drop(columns="seconds")


class TestStatistics:
    def test_means_are_ratios_of_sums(self, sensitive):
        """Here of the steps, by the trapezoidal rule."""
        statistics = sensitive.statistics(first=5)
        rows = np.flatnonzero(sensitive.rows.revolution >= 5)
        span = slice(rows[0] - 1, None)
        dt, inside = np.diff(sensitive.time[span]), sensitive.in_contact[span][1:]
        for name, values in (
            ("mean_penetration_um", sensitive.penetration[span] * 1e6),
            ("mean_force_N", sensitive.normal_force[span]),
        ):
            middle = 0.5 * (values[1:] + values[:-1])
            expected = (middle * dt)[inside].sum() / dt[inside].sum()
            assert statistics.mean[name] == pytest.approx(expected, rel=2e-3)
            # The mean of the revolutions' means is another number.
            assert statistics.by_revolution[name].mean() != pytest.approx(expected, rel=5e-3)
        steps = sensitive.counts["steps"].to_numpy()[5:]
        assert statistics.mean["steps"] == pytest.approx(steps.mean())
        flying = dt[~inside & (dt > 0)].mean() * 1e6
        assert statistics.mean["mean_step_flight_us"] == pytest.approx(flying, rel=1e-9)

    def test_it_shows_intervals_and_verdicts(self, sensitive):
        statistics = sensitive.statistics(first=10)
        table = statistics.interval()
        assert list(table.index) == list(QUANTITIES)
        assert (table["half_width"].drop("normal_dissipation_J") >= 0).all()
        wide = statistics.interval(0.99)["half_width"]
        assert (wide[wide > 0] > table["half_width"][wide > 0]).all()
        assert "no period up to 8 revolutions" in repr(statistics)
        with pytest.raises(InputError, match=r"level = 95: must lie in \(0, 1\)"):
            statistics.interval(95)

    def test_without_losses_there_is_no_steady_state_and_no_interval(self):
        statistics = long_run(slider_crank("enhanced", 0.5, 1.0, 0.0), revolutions=10)
        assert set(statistics.stationary) == {"no steady state"}
        assert statistics.interval()["half_width"].isna().all()
        assert "nothing dissipates" in repr(statistics)
        assert np.isfinite(statistics.mean["impacts"])

    def test_a_short_run_shows_what_it_has(self):
        statistics = long_run(slider_crank("enhanced", 0.1 + 0.2), revolutions=2)
        assert "too short" not in repr(statistics)
        assert "too few revolutions for intervals" in repr(statistics)
        assert statistics.summary["clearance (mm)"] == 0.3

    def test_a_contact_without_end_says_what_rate_it_carries(self):
        statistics = long_run(slider_crank("johnson"), revolutions=60)
        rate = statistics.carried
        assert rate == statistics.revolutions["impact_rate_m_per_s"].iloc[-1] > 0
        assert f"the δ̇⁽⁻⁾ of its onset, {rate:.3g} m/s" in repr(statistics)
        assert "periodic: repeats after 1 revolution" in repr(statistics)
        verdicts = statistics.stationary
        assert verdicts.pop("mean_step_flight_us") == "-"
        assert set(verdicts) == {"yes"}
        assert np.isnan(long_run(slider_crank("johnson", friction=0.0), revolutions=5).carried)


class TestLongRuns:
    def test_equals_the_statistics_of_the_trajectory_to_the_bit(self, sensitive):
        whole = long_run(sensitive.mechanism, revolutions=40, first=5)
        expected = sensitive.statistics(5)
        pd.testing.assert_frame_equal(reproducible(whole), reproducible(expected), check_exact=True)
        pd.testing.assert_series_equal(
            whole.mean.drop("evaluations"), expected.mean.drop("evaluations"), check_exact=True
        )

    def test_one_taken_up_equals_one_never_interrupted(self, sensitive):
        calls = []

        def stop(_, done, __):
            calls.append(done)
            if done == 15:
                raise KeyboardInterrupt

        with pytest.raises(Interrupted) as caught:
            long_run(sensitive.mechanism, revolutions=40, progress=stop)
        part = caught.value.statistics
        assert len(part.revolutions) == 15
        assert part.first == 8
        whole = long_run(part.mechanism, revolutions=40, first=5, resume=part)
        expected = reproducible(sensitive.statistics())
        pd.testing.assert_frame_equal(reproducible(whole), expected, check_exact=True)

    @pytest.mark.parametrize(("rate", "period"), [(0.01, 1), (0.1, 4), (0.3, 0)])
    def test_another_rate_can_be_carried_on_and_decides_the_motion(self, rate, period):
        """The way to hold δ̇⁽⁻⁾: give the state at the end another one, and go on."""
        settled = long_run(slider_crank("johnson", 0.02), revolutions=10)
        held = replace(settled, end=replace(settled.end, impact_rate=np.array([rate])))
        went_on = long_run(held.mechanism, revolutions=150, resume=held)
        assert went_on.carried == rate
        assert went_on.period == period


class TestWarnings:
    def test_impacts_slower_than_the_floor_are_counted(self):
        """Three impacts of .5, 2 and .9 mm/s; a contact under way at the start is none."""
        modes = [1, 0, 1, 1, 0, 1, 0, 0, 1]
        rates = [0.1, 0, 0.5, 0.5, 0, 2.0, 0, 0, 0.9]
        depth, steps = np.array([3.0, 0, 1, 4, 0, 2, 0, 0, 1]), np.array([[8.0, 16.0, 0.1]])
        run = SimpleNamespace(time=np.arange(9.0), rows=SimpleNamespace(counts=steps))
        joint = SimpleNamespace(
            run=run, in_contact=np.array(modes, dtype=bool), impact_rate=np.array(rates) * 1e-3,
            penetration=depth, normal_force=depth, force_within=np.zeros((8, 1)),
            ledger=lambda _: np.zeros(9), eccentricity=np.zeros((9, 2)),
            eccentricity_rate=np.zeros((9, 2)), max_elastic_load=0.0,
            limits=Limits(2.5, np.inf, 1e-3),
        )  # fmt: skip
        row = numbers_of(joint)
        assert (row["impacts"], row["contacts"], row["contact_steps"]) == (3, 4, 4)
        assert (row["grazing"], row["grazing_s"]) == (2, 2.0)
        assert (row["above_yield"], row["above_yield_s"]) == (2, 0.0)
        assert (row["beyond_law"], row["contact_fraction"]) == (0, 0.5)
        assert np.isnan(row["beyond_law_s"])

    def test_an_energy_balance_that_a_coarse_step_control_spoils_is_told(self):
        mechanism = slider_crank(friction=0.0)
        fine = simulate(mechanism, revolutions=3)
        coarse = simulate(mechanism, revolutions=3, allowed_penetration=1e-5)
        told = [text for text in coarse.warnings if text.startswith("the energy balance is off")]
        worst = coarse.statistics().revolutions["energy_error_J"].abs().max()
        assert f"by up to {worst:.3g} J" in told[0]
        assert not any("energy balance" in text for text in fine.warnings)
