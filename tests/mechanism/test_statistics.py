"""Statistics of runs: intervals and periods of series known in advance, and of long runs."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from cylcontact import InputError, laws, limits
from cylcontact.mechanism import Interrupted, Settings, Statistics, long_run, simulate
from cylcontact.mechanism.statistics import (
    LONGEST,
    QUANTITIES,
    REPEATED,
    REPEATS,
    SECTION,
    batch_means,
)
from tests.support.mechanism_cases import slider_crank, yields_at


def autoregressive(correlation, runs, length, seed):
    """Stationary AR(1) series of mean 5 and unit variance, shape (length, runs)."""
    noise = np.random.default_rng(seed).standard_normal((length, runs))
    series = np.empty_like(noise)
    series[0] = noise[0]
    for k in range(1, length):
        series[k] = correlation * series[k - 1] + np.sqrt(1 - correlation**2) * noise[k]
    return 5.0 + series


def means_of(series, level=0.95):
    """Plain means with the half-widths of their intervals."""
    return batch_means(series, np.ones_like(series), level)


class TestIntervals:
    def test_their_width_is_that_of_the_known_autocorrelation(self):
        """The variance of a mean of n is (1 + ρ)/(1 − ρ)/n."""
        _, width = means_of(autoregressive(0.5, 400, 1000, seed=2))
        expected = stats.t.ppf(0.975, 19) * np.sqrt(3.0 / 1000)
        assert np.sqrt(np.mean(width**2)) == pytest.approx(expected, rel=0.1)

    def test_that_of_plain_means_is_students_of_the_batches(self):
        series = autoregressive(0.3, 1, 100, seed=3)
        batches = series.reshape(20, 5).mean(axis=1)
        low, high = stats.t.interval(0.9, 19, batches.mean(), stats.sem(batches))
        mean, width = means_of(series, 0.9)
        assert mean[0] == pytest.approx(series.mean(), rel=1e-14)
        assert width[0] == pytest.approx((high - low) / 2, rel=1e-12)

    def test_a_ratio_of_sums_is_not_a_mean_of_ratios_and_its_interval_covers_it(self):
        """Penetration over a time that is long where it is deep: E(xy)/E(y) with y = x is 1.25."""
        generator = np.random.default_rng(4)
        time = 1 + 0.5 * generator.choice([-1.0, 1.0], (1000, 400))
        depth = time + 0.1 * generator.standard_normal(time.shape)
        ratio, width = batch_means(depth * time, time)
        assert ratio.mean() == pytest.approx(1.25, abs=0.002)
        assert depth.mean() == pytest.approx(1.0, abs=0.01)
        assert 0.90 < (np.abs(ratio - 1.25) < width).mean() < 0.98

    def test_short_runs_and_revolutions_without_contact_have_none(self):
        for revolutions, known in ((7, False), (8, True), (11, True)):
            _, width = means_of(autoregressive(0.0, 3, revolutions, seed=5))
            assert np.isfinite(width).all() == known
        ratio, width = batch_means(np.full((20, 1), np.nan), np.ones((20, 1)))
        assert np.isnan([ratio, width]).all()


def period_of(*columns):
    """Return the period of sections, with columns in shares of what counts as the same."""
    mechanism = slider_crank()
    micrometres = 1e3 * mechanism.joint.radial
    table = pd.DataFrame(0.0, range(len(columns[0])), SECTION)
    for name, column in zip(SECTION, columns, strict=False):
        table[name] = micrometres * np.asarray(column)
    return Statistics(table, mechanism, Settings()).period


class TestPeriods:
    @pytest.mark.parametrize("period", range(1, LONGEST + 1))
    def test_the_shortest_one_counts(self, period):
        points = np.resize(np.arange(period, dtype=float), 80)
        assert period_of(points, -2.0 * points) == period
        assert period_of(points + 0.9 * REPEATS * np.resize([0.0, 1.0], 80)) == period

    def test_there_is_none_where_a_section_differs_or_it_is_longer(self):
        assert period_of(np.resize(np.arange(LONGEST + 1.0), 90)) == 0
        still = np.zeros(80)
        still[-REPEATED] = 2 * REPEATS
        assert period_of(np.zeros(80), still) == 0
        still[-REPEATED], still[: -REPEATED - 1] = 0.0, 1.0
        assert period_of(np.zeros(80), still) == 1  # only the end counts

    def test_a_short_run_cannot_say(self):
        assert period_of(np.zeros(REPEATED)) is None
        assert period_of(np.resize([0.0, 1.0], REPEATED + 1)) is None
        assert period_of(np.zeros(REPEATED + 1)) == 1


@pytest.fixture(scope="module")
def sensitive():
    """A run that flies, and touches in every revolution."""
    return simulate(slider_crank("johnson", 0.5, 0.9, 0.0), revolutions=40)


def reproducible(statistics):
    return statistics.revolutions.drop(columns="seconds")


class TestStatistics:
    def test_they_are_those_of_the_steps(self):
        run = simulate(slider_crank(), revolutions=3)
        table, T = run.statistics().by_revolution, run.mechanism.period
        assert table["impacts"].sum() == len(run.contacts)
        inside = (run.contacts["release_s"].fillna(run.time[-1]) - run.contacts["onset_s"]).sum()
        assert table["contact_fraction"].sum() * T == pytest.approx(inside, rel=1e-12)
        assert table["max_penetration_um"].max() == run.penetration.max() * 1e6
        assert table["drive_work_J"].sum() == pytest.approx(run.drive_work[-1], rel=1e-12)
        assert table["steps"].sum() == np.count_nonzero(np.diff(run.time))
        # The peak lies between two steps; with steps of 1 µs it is a step.
        fine = simulate(slider_crank(max_step=1e-6), revolutions=1)
        assert table["max_force_N"].max() == pytest.approx(fine.normal_force.max(), rel=2e-3)
        assert table["max_force_N"].max() > run.normal_force.max()
        # The percentiles, on an even grid of times.
        time = np.linspace(0.0, T, 400_001)
        row = np.minimum(np.searchsorted(fine.time, time), fine.time.size - 1)
        force = np.interp(time, fine.time, fine.normal_force)[fine.in_contact[row]]
        for percent in (50, 95, 99):
            wanted = np.percentile(force, percent)
            assert table.loc[0, f"force_p{percent}_N"] == pytest.approx(wanted, rel=0.01)

    def test_means_are_ratios_of_sums(self, sensitive):
        """Here of the steps, by the trapezoidal rule."""
        statistics = sensitive.statistics(first=5)
        rows = np.flatnonzero(sensitive.steps.revolution >= 5)
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
        flying = dt[~inside & (dt > 0)].mean() * 1e6
        assert statistics.mean["mean_step_flight_us"] == pytest.approx(flying, rel=1e-9)

    def test_intervals_widen_with_their_level(self, sensitive):
        statistics = sensitive.statistics(first=10)
        table, wide = statistics.interval(), statistics.interval(0.99)["half_width"]
        assert list(table.index) == list(QUANTITIES)
        assert (wide > table["half_width"]).sum() > 10
        assert "no period up to 8 revolutions" in repr(statistics)
        with pytest.raises(InputError, match=r"level = 95: must lie in \(0, 1\)"):
            statistics.interval(95)
        with pytest.raises(InputError, match="first = 40: leaves none of 40 revolutions"):
            sensitive.statistics(first=40)

    def test_without_losses_there_is_no_steady_state_and_no_interval(self):
        statistics = long_run(slider_crank("enhanced", 0.5, 1.0, 0.0), revolutions=10)
        assert statistics.interval()["half_width"].isna().all()
        assert "nothing dissipates" in repr(statistics)
        assert np.isfinite(statistics.mean["impacts"])

    def test_a_contact_without_end_says_what_rate_it_carries(self):
        statistics = long_run(slider_crank("johnson"), revolutions=60)
        rate = statistics.carried
        assert rate == statistics.revolutions["impact_rate_m_per_s"].iloc[-1] > 0
        assert f"the δ̇⁽⁻⁾ of its onset, {rate:.3g} m/s" in repr(statistics)
        assert statistics.period == 1

    def test_the_largest_elastic_load_is_compared_with_first_yield(self):
        """The load from the law in Python; 100 MPa are passed, 1000 MPa are not."""
        run = simulate(slider_crank(), revolutions=3)
        pair = run.mechanism.joint.pair
        load = float(laws.Enhanced().load(run.penetration.max() * 1e3, pair))
        largest = run.statistics().revolutions["max_load_N_per_mm"].max()
        assert largest == pytest.approx(load, rel=1e-9)
        assert 0 < load < run.normal_force.max() / 10.0  # which has damping as well
        for yield_stress, passed in ((100.0, True), (1000.0, False)):
            other = simulate(slider_crank(spec=yields_at(yield_stress)), revolutions=3)
            at = float(limits.yield_load(pair, yield_stress=yield_stress))
            text = other.statistics().to_text()
            assert f"{load:,.0f} N/mm, {100 * load / at:.3g} % of first yield" in text
            assert [w.startswith("the largest load") for w in other.warnings] == [True] * passed
            np.testing.assert_array_equal(run.steps.values, other.steps.values)
        assert run.warnings == ()

    def test_a_poor_energy_balance_has_a_warning(self):
        mechanism = slider_crank(friction=0.0)
        fine = simulate(mechanism, revolutions=3)
        coarse = simulate(slider_crank(friction=0.0, tolerance=1e-3), revolutions=3)
        assert any(text.startswith("the energy balance is off") for text in coarse.warnings)
        assert not any("energy balance" in text for text in fine.warnings)


class TestLongRuns:
    def test_they_equal_the_statistics_of_the_trajectory_to_the_bit(self, sensitive):
        whole, expected = long_run(sensitive.mechanism, 40, first=5), sensitive.statistics(5)
        pd.testing.assert_frame_equal(reproducible(whole), reproducible(expected), check_exact=True)
        pd.testing.assert_series_equal(whole.mean, expected.mean, check_exact=True)

    def test_an_interrupted_one_has_its_complete_revolutions(self, sensitive):
        def stop(_, done, __):
            if done == 15:
                raise KeyboardInterrupt

        with pytest.raises(Interrupted) as caught:
            long_run(sensitive.mechanism, revolutions=40, progress=stop)
        part = caught.value.statistics
        assert (len(part.revolutions), part.first) == (15, 8)
        expected = reproducible(sensitive.statistics()).iloc[:15]
        pd.testing.assert_frame_equal(reproducible(part), expected, check_exact=True)
