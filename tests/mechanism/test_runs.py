"""Whole runs: energy in all 24 cases, events, SUNDIALS, the ends of law, hole and steps."""

import numpy as np
import pytest
from sksundae.cvode import CVODE

from cylcontact import InputError
from cylcontact.joint import contact
from cylcontact.joint.clearance import TANGENT_FROM
from cylcontact.laws import Johnson
from cylcontact.mechanism import LawDomainError, RunError, Settings, long_run, simulate
from cylcontact.mechanism import run as running
from cylcontact.support.numba_cache import compiled
from tests.support.mechanism_cases import CASES, Equations, slider_crank

# --- against SUNDIALS ---------------------------------------------------------------------------


def cvode_run(mechanism, end):
    """Return onset, impact rate and release of the contacts up to a time, and the last state.

    CVODE's Adams method on the forces as they are, kinks and all, from event to event.
    """
    equations = Equations(mechanism)
    joint = equations.joint
    t, y, contacts = 0.0, np.zeros(4), []

    def rhs(t, y, out):
        out[:] = equations.rates(t, y)[:4]

    def gap(_, y, out):
        out[0] = equations.gap(y)[0] / joint["clearance"]

    gap.terminal = [True]
    while t < end:
        touching = bool(joint["touching"])
        gap.direction = [-1 if touching else 1]
        solver = CVODE(
            rhs, method="Adams", rtol=1e-12, atol=np.array([1e-16, 1e-16, 1e-12, 1e-12]),
            eventsfn=gap, num_events=1, max_num_steps=100_000, first_step=1e-9,
            max_step=2e-6 if touching else 1e-5,
        )  # fmt: skip
        solution = solver.solve(np.array([t, end]), y)
        t, y = float(solution.t[-1]), solution.y[-1].copy()
        if t >= end:
            break
        if touching:
            contacts[-1][2] = t
            joint["touching"] = 0
        else:
            rate = equations.gap(y)[1]
            contacts.append([t, rate, np.nan])
            joint["touching"], joint["impact_rate"] = 1, rate
    return np.array(contacts), y


@pytest.mark.slow
@pytest.mark.parametrize(
    "case", [("johnson", 0.5, 0.9, 0.1), ("enhanced", 0.02, 1.0, 0.0), ("enhanced", 0.02, 0.9, 0.1)]
)
def test_sundials_gives_the_same_contacts(case):
    mechanism = slider_crank(*case)
    end = 0.3 * mechanism.period
    contacts, last = cvode_run(mechanism, end)
    run = simulate(mechanism.changed(tolerance=1e-12), revolutions=1, beyond="tangent")
    assert len(contacts) > 3
    ours = run.contacts[["onset_s", "impact_rate_m_per_s", "release_s"]].to_numpy()[: len(contacts)]
    # As far as both can be known: errors grow from impact to impact.
    first = 4
    np.testing.assert_allclose(ours[:first, 0], contacts[:first, 0], rtol=1e-7)
    np.testing.assert_allclose(ours[:first, 1], contacts[:first, 1], rtol=1e-5)
    assert np.isfinite(last).all()


# --- what must hold -----------------------------------------------------------------------------


@pytest.mark.parametrize("case", CASES, ids=str)
def test_the_energy_balance_closes_over_ten_revolutions(case):
    """Johnson's law leaves its domain in some cases at .02 mm, so it goes on along its tangent."""
    run = simulate(slider_crank(*case), revolutions=10, beyond="tangent")
    assert np.abs(run.energy_error).max() < 1e-7 * run.kinetic_energy.max()


@pytest.mark.parametrize(
    "clearance",
    [pytest.param(0.5, marks=pytest.mark.slow), pytest.param(0.02, marks=pytest.mark.long)],
)
def test_energy_is_conserved_over_a_thousand_revolutions_without_dissipation(clearance):
    run = long_run(slider_crank("enhanced", clearance, 1.0, 0.0), 1000)
    assert run.revolutions["energy_error_J"].abs().max() < 1e-2


def test_every_onset_and_release_is_on_the_clearance_circle():
    run = simulate(slider_crank(), revolutions=2)
    contacts = run.contacts
    assert len(contacts) > 10
    begins = np.searchsorted(run.time, contacts["onset_s"])
    ends = np.searchsorted(run.time, contacts["release_s"].dropna())
    for rows in (begins, ends):
        assert np.abs(run.penetration[rows]).max() < 1e-13
    # δ̇⁽⁻⁾ is the rate at the root, and the force starts from nothing and ends with it.
    assert run.penetration_rate[begins] == pytest.approx(contacts["impact_rate_m_per_s"], rel=1e-9)
    assert (contacts["impact_rate_m_per_s"] > 0).all()
    assert (run.penetration_rate[ends] < 0).all()
    assert run.normal_force[ends].max() < 1e-4
    # Nothing is missed: δ has the sign of the mode in every row.
    assert run.penetration[run.in_contact].min() > -1e-13
    assert run.penetration[~run.in_contact].max() < 1e-13


def test_events_are_where_the_forces_change_piece():
    """At the kinks of friction a step ends, so that no step has one inside."""
    run = simulate(slider_crank(), revolutions=1)
    v_t, touching = np.abs(run.tangential_velocity), run.in_contact
    together = touching[1:] & touching[:-1] & (np.diff(run.time) > 0)
    before, after = v_t[:-1][together], v_t[1:][together]
    for kink in (1e-3, 1e-2):
        close = 1e-7
        passed = ((before < kink - close) & (after > kink + close)) | (
            (before > kink + close) & (after < kink - close)
        )
        assert not passed.any()


def test_no_shallow_contact_is_leapt_over():
    """Unless turning points are examined, a contact 10 nm deep is missed in this run."""
    run = simulate(slider_crank(friction=0.0, tolerance=1e-6), revolutions=10)
    time = np.linspace(0, run.time[-1], 200_000)
    excess = np.hypot(*run.eccentricity_at(time).T) - run.mechanism.joint.radial * 1e-3
    row = np.searchsorted(run.time, time, side="left")
    free = ~run.in_contact[row] & (row > 0)
    assert excess[free].max() < 1e-9


def test_johnsons_law_is_left_and_says_where():
    with pytest.raises(LawDomainError) as caught:
        simulate(slider_crank("johnson", 0.02, 1.0, 0.1), revolutions=3)
    message = str(caught.value)
    assert "joint.law = 'johnson': leaves its domain at t = 0.00109" in message
    assert "reaches 10.83 µm and the limit is 10.83 µm" in message
    assert "tangent" in caught.value.remedy


@compiled
def elastic(penetration, joint, law):
    return contact.piece_force(penetration, joint, law)


def test_the_tangent_takes_over_smoothly():
    mechanism = slider_crank("johnson", 0.02, 1.0, 0.1)
    run = simulate(mechanism, revolutions=1, beyond="tangent")
    joint, record = mechanism.joint, mechanism.joint.record("tangent")
    limit = TANGENT_FROM * float(Johnson().max_penetration(joint.pair))
    assert run.penetration.max() * 1e3 > limit
    note = run.statistics().continuation
    assert note in run.warnings
    assert note.startswith("beyond 9.744 µm the law goes on along its tangent, up to ")
    below, above, deeper = (
        elastic(1e-3 * limit * factor, record, joint.kernel.parameters)
        for factor in (1 - 1e-9, 1 + 1e-9, 1.1)
    )
    assert below == pytest.approx(above, rel=1e-8)
    slope = float(Johnson().stiffness(limit, joint.pair)) * 10.0
    assert deeper == pytest.approx(below + slope * 0.1 * limit, rel=1e-8)
    assert np.isnan(joint.kernel.load(1.2 * limit))


def test_a_pin_that_leaves_its_hole_ends_the_run():
    """Rubber of 10 MPa in place of steel: a tenth of 10 mm is passed in the first impact."""
    soft = {"joint.bearing.E": 0.01, "joint.pin.E": 0.01, "joint.law": "lankarani-nikravesh"}
    mechanism = slider_crank("lankarani-nikravesh", spec=soft)
    with pytest.raises(RunError, match="the pin leaves its hole at t = 0") as caught:
        simulate(mechanism, revolutions=1)
    assert "is above 0.1 of the hole's radius" in str(caught.value)
    assert str(caught.value).count("\n") == 0


def test_steps_that_collapse_are_an_error(monkeypatch):
    """A rod barely longer than the crank, which a file may not have, stands square to the slide."""
    monkeypatch.setattr("cylcontact.mechanism.slider_crank._LEAST_ROD", 0.0)
    with pytest.raises(InputError, match=r"the step size became too small at t = 0\.00") as caught:
        simulate(slider_crank(spec={"rod.length": 50.00002}), revolutions=1)
    assert caught.value.key == "tolerance"


LONG_ROD = {"rod.length": 200.0, "rod.mass": 0.35, "rod.inertia": 1.2e-3, "slider.mass": 0.42}
# Where the 782 revolutions before have led to.
AFTER_782 = (
    *(2.790042007541264e-05, -2.5060670061824945e-06, 0.05326960759576507, 0.09644491702193313),
    *(3696.0951019501767, 0.0, 3695.9066341170746, 3.0343558635828955e-05, 37470.84493688622),
)


def test_a_step_that_passes_a_kink_and_turns_back_to_it_is_not_repeated_forever():
    """v_t passes −v1, where friction bends, and would turn within the step to pass it again."""
    run = running.Run(slider_crank("enhanced", 0.02, 1.0, 0.1, LONG_ROD), Settings())
    run.now["time"], run.values = 9.384, np.array(AFTER_782)
    run.joint["touching"], run.joint["onset_rate"] = 1, 0.05485815933107521
    end = 783 * run.mechanism.period
    rows = run.advance(end, 782)
    assert rows.time[-1] == pytest.approx(end, rel=1e-15)
    assert rows.counts[0, 0] < 3000


def test_a_revolution_has_a_largest_number_of_steps(monkeypatch):
    for name, value in {"_BUFFER": 64, "_MOST_STEPS": 200, "_MORE_PER_SECOND": 0}.items():
        monkeypatch.setattr(running, name, value)
    with pytest.raises(InputError, match=r"revolution 0 has not ended after 256 steps, at t = 0\."):
        simulate(slider_crank(), revolutions=2)


def test_the_start_of_a_run_is_a_whole_run_of_fewer_revolutions():
    one, three = (simulate(slider_crank("johnson"), revolutions=n) for n in (1, 3))
    rows = one.time.size
    np.testing.assert_array_equal(three.steps.values[:rows], one.steps.values)
    assert three.time[-1] == 3 * three.mechanism.period
    assert three.penetration[0] == -three.mechanism.joint.radial * 1e-3
    assert (np.diff(three.time) >= 0).all()
