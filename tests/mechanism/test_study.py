"""Sweeps, the commands, the table of steps and the committed statistics."""

import numpy as np
import pandas as pd
import pytest

from cylcontact.mechanism import Case, Interrupted, cases, horizon, long_run, simulate, sweep
from tests.support.mechanism_cases import CASES, ROOT, SPEC, slider_crank

WANTED = cases(["enhanced", "johnson"], [0.02], [1.0], [0.0, 0.1])
SWEEP = ("sweep", SPEC, "-o", "t.csv")
VARIED = ["law", "clearance_mm", "restitution", "friction"]


@pytest.fixture(scope="module")
def table():
    return sweep(slider_crank(), WANTED, revolutions=2, first=1)


def test_every_case_has_its_row(table):
    assert [Case(*row) for row in table[VARIED].to_numpy()] == WANTED
    # Johnson's law ends where the journal whirls in a dry, elastic bearing.
    assert "leaves its domain at t = 0.00109" in table["message"].iloc[3]
    assert np.isnan(table["impacts"].iloc[3])
    assert np.isfinite(table["impacts"].iloc[:2]).all()
    expected = long_run(slider_crank("enhanced", 0.02, 1.0, 0.1), 2, first=1).mean
    for name in ("contact_fraction", "mean_force_N", "drive_work_J"):
        assert table[name].iloc[1] == expected[name]


@pytest.mark.slow
def test_the_table_does_not_depend_on_the_workers(table):
    other = sweep(slider_crank(), WANTED, revolutions=2, first=1, workers=2)
    pd.testing.assert_frame_equal(table, other)


def test_a_row_has_the_error_of_its_energy_balance_and_the_tolerance(table):
    """The error is that of the run; work less losses is energy that the mechanism keeps."""
    given = WANTED[0]
    changes = {name: value for name, value in vars(given).items() if value is not None}
    run = simulate(slider_crank().changed(**changes), 2)
    errors = run.statistics(1).revolutions["energy_error_J"]
    assert table.iloc[0]["energy_error_J"] == errors.abs().max() < 1e-5
    assert (table["tolerance"] == run.mechanism.spec.tolerance).all()


def test_two_tolerances_agree_for_ever_or_for_some_revolutions():
    for restitution, low, high in ((1.0, 0.1, 2.0), (0.9, 3.0, 3.01)):
        mechanism = slider_crank("johnson", 0.5, restitution, 0.1)
        runs = [simulate(mechanism.changed(tolerance=t), 3) for t in (1e-8, 1e-10)]
        assert low <= horizon(*runs) <= high


# --- the committed statistics -------------------------------------------------------------------

# Johnson's law, from a program of its own, checked against CVODE: over 2,000 revolutions after 10,
# of which the fourth over 5,000. Clearance, restitution, friction; then mean and half-width.
INDEPENDENT = [
    ((0.5, 1.0, 0.1), {
        "contact_fraction": (0.1528, 0.0016), "impacts": (40.6, 0.3),
        "mean_penetration_um": (15.7, 0.2), "mean_force_N": (10682, 118),
        "friction_dissipation_J": (2.828, 0.009)}),
    ((0.5, 0.9, 0.0), {
        "contact_fraction": (0.745, 0.009), "impacts": (16.1, 0.4),
        "mean_penetration_um": (4.22, 0.04), "mean_force_N": (2308, 28),
        "normal_dissipation_J": (0.533, 0.017)}),
    ((0.5, 0.9, 0.1), {
        "contact_fraction": (1.0, 0.0), "mean_penetration_um": (3.235, 0.0005),
        "mean_force_N": (1587, 0.5), "normal_dissipation_J": (0.0230, 0.00005),
        "friction_dissipation_J": (3.0278, 0.00005)}),
    ((0.02, 1.0, 0.1), {
        "contact_fraction": (0.804, 0.012), "impacts": (68, 3), "mean_penetration_um": (3.0, 0.2),
        "mean_force_N": (4530, 470), "friction_dissipation_J": (2.65, 0.03)}),
    ((0.02, 0.9, 0.0), {
        "contact_fraction": (1.0, 0.0), "mean_penetration_um": (1.7188, 0.00005),
        "mean_force_N": (1471, 0.5), "normal_dissipation_J": (0.00174, 0.000005)}),
    ((0.02, 0.9, 0.1), {
        "contact_fraction": (1.0, 0.0), "mean_penetration_um": (1.7112, 0.00005),
        "mean_force_N": (1464, 0.5), "normal_dissipation_J": (0.00447, 0.000005),
        "friction_dissipation_J": (2.8077, 0.00005)}),
]  # fmt: skip


@pytest.fixture(scope="module")
def committed():
    return pd.read_csv(ROOT / "datasets/mechanism/cases.csv").set_index(VARIED)


@pytest.mark.parametrize(("case", "numbers"), INDEPENDENT, ids=str)
def test_the_committed_means_are_those_of_another_program(committed, case, numbers):
    """Two independent intervals of 95 % differ by more than twice their joint width once in 10,000.

    The printed digits of a steady motion are its half-width.
    """
    row = committed.loc["johnson", *case]
    for name, (mean, half_width) in numbers.items():
        joint = np.hypot(half_width, row[f"{name}_half_width"])
        assert abs(row[name] - mean) <= 2 * joint + 1e-9, name


def test_the_committed_cases_are_the_papers_and_those_of_explicit(committed):
    rows = [(law, *rest) for law, *rest in committed.index]
    assert rows == [*CASES, *(("explicit", *case[1:]) for case in CASES[:8])]
    assert (committed["last_revolution"] == 1000).all()
    lossless = (committed.index.get_level_values("restitution") == 1.0) & (
        committed.index.get_level_values("friction") == 0.0
    )
    assert (committed["mean_force_N_half_width"].isna() == lossless).all()


def test_the_committed_start_is_what_comes_out(committed):
    """A steady motion, which has the same mean over fewer revolutions."""
    run = long_run(slider_crank("explicit", 0.02), 60)
    row = committed.loc["explicit", 0.02, 0.9, 0.1]
    for name in ("mean_penetration_um", "mean_force_N", "friction_dissipation_J"):
        assert run.mean[name] == pytest.approx(row[name], rel=1e-4)


# --- the commands -------------------------------------------------------------------------------


def test_simulate_writes_the_steps(run, tmp_path):
    out, parquet = tmp_path / "run.csv", tmp_path / "run.parquet"
    options = ("--revolutions", 2, "--law", "explicit", "--table")
    code, text, err = run("simulate", SPEC, *options, out)
    trajectory = simulate(slider_crank("explicit"), 2)
    assert (code, err) == (0, "")
    assert "agree over all of 2 revolutions" in text
    assert f"written to {out}" in text
    table, expected = pd.read_csv(out), trajectory.to_frame()
    pd.testing.assert_frame_equal(table, expected, check_exact=True)
    assert list(table)[:12] == [
        *("time_s", "crank_angle_rad", "slider_position_m", "slider_velocity_m_s"),
        *("slider_acceleration_m_s2", "crank_moment_Nm", "eccentricity_x_m", "eccentricity_y_m"),
        *("penetration_m", "penetration_rate_m_s", "normal_force_N", "friction_force_N"),
    ]
    run("simulate", SPEC, *options, parquet)
    pd.testing.assert_frame_equal(pd.read_parquet(parquet), expected)


def test_an_interrupted_simulate_prints_what_is_complete(run, monkeypatch):
    statistics = long_run(slider_crank(), 3)

    def interrupted(*_arguments, **_named):
        raise Interrupted(statistics)

    monkeypatch.setattr("cylcontact.mechanism.long_run", interrupted)
    _, text, err = run("simulate", SPEC)
    assert "revolutions: 3" in text
    assert "interrupted; these are the numbers of 3 complete revolutions" in err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("simulate", "none.toml"), "none.toml: cannot be read"),
        (("simulate", SPEC, "--radial-clearance", "-1"), "joint.clearance = -1.0: must be greater"),
        (("simulate", SPEC, "--tolerance", "2"), "tolerance = 2.0: must be less than or equal"),
        (("simulate", SPEC, "--beyond", "wall"), "beyond = 'wall': is not known; choose stop or"),
        (("simulate", SPEC, "--table", "run.gif"), "run.gif: is neither .csv nor .parquet"),
        (("simulate", SPEC, "--revolutions", 2, "--first", 2), "--first = 2: leaves none of 2"),
        (("simulate", SPEC, "--radial-clearance", "0.5,0.02"), "is not a length"),
        (("simulate", SPEC, "--study", "cases"), "No such option: --study; see cylcontact"),
        ((*SWEEP, "--radial-clearance", "0.5;1"), "'0.5;1' is not a length"),
        ((*SWEEP, "--law", "hooke"), "'hooke': is neither a law nor a fit result"),
        ((*SWEEP, "--iso", "20H7/k6"), "--iso = '20H7/k6': is a transition fit"),
        ((*SWEEP, "--iso", "20H7/f7", "--radial-clearance", 1), "conflicts with --radial"),
        ((*SWEEP, "--iso", "40H7/f7"), "is of another size than the hole of the joint, of 20 mm"),
    ],
)  # fmt: skip
def test_bad_input_is_one_line_and_exit_code_two(run, tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_fit_gives_its_tightest_middle_and_loosest_clearance(run, tmp_path):
    table = tmp_path / "band.csv"
    short = "--law", "explicit", "--beyond", "tangent", "--revolutions", 2, "-j", 1
    assert run("sweep", SPEC, "--iso", "20H7/f7", *short, "-o", table)[0] == 0
    clearances = pd.read_csv(table)["clearance_mm"].to_numpy()
    assert clearances == pytest.approx([0.01, 0.0205, 0.031], rel=1e-12)


def test_sweep_writes_a_table_and_says_what_stopped(run, tmp_path):
    out = tmp_path / "table.csv"
    options = (
        *("--law", "johnson,enhanced", "--radial-clearance", 0.02, "--restitution", 1),
        *("--friction", 0.1, "--revolutions", 1, "--jobs", 1),
    )
    code, sentence, error = run("sweep", SPEC, "-o", out, *options)
    assert code == 1
    assert "2 cases, 1 of them stopped" in sentence
    assert "1 of 2 cases stopped; first: " in error
    assert "leaves its domain" in error
    assert error.count("\n") == 1
    assert list(pd.read_csv(out)["contact_fraction"].isna()) == [True, False]
    assert list(tmp_path.iterdir()) == [out]


# --- pictures ------------------------------------------------------------------------------------


def test_the_pictures_show_the_run():
    run = simulate(slider_crank("explicit", 0.1), 3)
    figure = run.plot(revolutions=1)
    slider, crank, force, path, poincare, _ = figure.axes
    rows = run.revolution > 2.0 + 1e-12
    x, y = slider.lines[0].get_data()
    assert np.array_equal(x, run.revolution[rows])
    assert 1e3 * y == pytest.approx(run.slider_acceleration[rows], rel=1e-14)
    assert np.array_equal(crank.lines[1].get_ydata(), run.ideal.crank_moment[rows])
    assert force.lines[0].get_ydata().max() == pytest.approx(1e-3 * run.normal_force[rows].max())
    away = np.hypot(*path.lines[0].get_data())
    assert away.max() == pytest.approx(0.1 + 1e3 * run.penetration[rows].max(), rel=1e-3)
    assert path.patches[0].radius == 0.1
    assert len(poincare.lines[0].get_xdata()) == 3
