"""The integrator: DOP853 against SciPy's, whole runs against SUNDIALS, what is conserved."""

import numpy as np
import pytest
from sksundae.cvode import CVODE

from cylcontact.mechanism import long_run, read_mechanism, simulate
from tests.support.mechanism_cases import CASES, ROOT, Equations, slider_crank

# --- against SUNDIALS -------------------------------------------------------------------------


def cvode_run(mechanism, end):
    """Return onset, impact rate and release of the contacts up to a time, and the last state.

    CVODE's Adams method on the forces as they are, kinks and all, from event to event.
    """
    equations = Equations(mechanism, "minimal", "tangent")
    joint = equations.joint
    t, y, contacts = 0.0, np.zeros(4), []

    def rhs(t, y, out):
        out[:] = equations.rates(t, y)[:4]

    def gap(t, y, out):
        out[0] = equations.gap(t, y)[0] / joint["clearance"]

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
            rate = equations.gap(t, y)[1]
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
    run = simulate(mechanism, revolutions=1, tolerance=1e-12, beyond="tangent")
    assert len(contacts) > 3
    ours = run.contacts[["onset_s", "impact_rate_m_per_s", "release_s"]].to_numpy()[: len(contacts)]
    # As far as both can be known: errors grow from impact to impact.
    first = 4
    np.testing.assert_allclose(ours[:first, 0], contacts[:first, 0], rtol=1e-7)
    np.testing.assert_allclose(ours[:first, 1], contacts[:first, 1], rtol=1e-5)
    assert np.isfinite(last).all()


# --- what must hold ---------------------------------------------------------------------------


@pytest.mark.parametrize("case", CASES, ids=str)
def test_a_run_resumed_inside_a_contact_is_the_same_to_the_bit(case):
    mechanism = slider_crank(*case)
    whole = simulate(mechanism, revolutions=3, beyond="tangent")
    part = simulate(mechanism, revolutions=1, beyond="tangent")
    resumed = simulate(mechanism, revolutions=3, resume=part)
    np.testing.assert_array_equal(whole.rows.values, resumed.rows.values)
    np.testing.assert_array_equal(whole.time, resumed.time)


def test_events_are_where_the_forces_change_piece():
    """At the kinks of friction a step ends, so that no step has one inside."""
    mechanism = read_mechanism(ROOT / "datasets/slider_crank.toml", clearance=0.5)
    run = simulate(mechanism, revolutions=1)
    v_t, touching = np.abs(run.tangential_velocity), run.in_contact
    together = touching[1:] & touching[:-1] & (np.diff(run.time) > 0)
    before, after = v_t[:-1][together], v_t[1:][together]
    for kink in (1e-3, 1e-2):
        close = 1e-7
        passed = ((before < kink - close) & (after > kink + close)) | (
            (before > kink + close) & (after < kink - close)
        )
        assert not passed.any()


@pytest.mark.slow
@pytest.mark.parametrize("clearance", [0.5, 0.02])
def test_energy_is_conserved_over_a_thousand_revolutions_without_dissipation(clearance):
    run = long_run(slider_crank("enhanced", clearance, 1.0, 0.0), 1000)
    assert run.revolutions["energy_error_J"].abs().max() < 1e-2
