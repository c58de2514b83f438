"""Whole runs: the two forms against each other, energy in all 24 cases, events, the law's end."""

import numpy as np
import pytest

from cylcontact import InputError
from cylcontact.joint.clearance import TANGENT_FROM
from cylcontact.laws import Johnson
from cylcontact.mechanism import LawDomainError, mechanism_from, simulate
from cylcontact.mechanism import run as running
from cylcontact.mechanism.run import Run, State, settings_for
from cylcontact.mechanism.study import eccentricity_at
from cylcontact.support.progress import silent
from tests.support.mechanism_cases import (
    CASES,
    FOUR_BAR,
    LAWS,
    ODD,
    SLIDER_CRANK,
    TURNED,
    slider_crank,
    with_clearance,
)
from tests.support.spec_files import changed

# Those that keep to one path, as the horizons in datasets/mechanism show.
NOT_SENSITIVE = [(law, 0.5, 0.9, 0.1) for law in LAWS] + [
    (law, 0.02, 0.9, friction) for law in LAWS for friction in (0.0, 0.1)
]

# Steps so short that interpolation between them does not count.
CLOSE = {"integration.max_step": 1e-5}


def apart(one, other, end, points=5000):
    """How far two runs are from each other up to a time, in m."""
    time = np.linspace(0.0, end, points)
    return np.hypot(
        *(eccentricity_at(one.joint, time) - eccentricity_at(other.joint, time)).T
    ).max()


def in_both_forms(mechanism):
    """A revolution in both forms, which agree to a nanometre."""
    runs = [
        simulate(mechanism, method, revolutions=1, tolerance=1e-12)
        for method in ("minimal", "multiplier")
    ]
    assert apart(*runs, runs[0].time[-1]) < 1e-9
    return runs


@pytest.mark.parametrize("case", NOT_SENSITIVE, ids=str)
def test_both_forms_agree_over_a_revolution(case):
    in_both_forms(slider_crank(*case, spec=CLOSE))


def test_both_forms_agree_for_odd_lengths_angles_and_gravity():
    for bearing in ("rod", "slider"):
        spec = ODD | CLOSE | (TURNED if bearing == "slider" else {})
        runs = in_both_forms(slider_crank("lankarani-nikravesh", 0.02, spec=spec))
        for name in ("drive_work", "friction_dissipation", "potential_energy", "kinetic_energy"):
            ends = [getattr(run, name)[-1] for run in runs]
            assert ends[0] == pytest.approx(ends[1], rel=1e-6)
        assert runs[0].coordinates[-1] == pytest.approx(runs[1].coordinates[-1], abs=1e-9)
        # On the way too, where the weights, which do no work in a revolution, have done some.
        for run in runs:
            assert np.abs(run.energy_error).max() < 1e-7 * run.kinetic_energy.max()


@pytest.mark.parametrize("case", CASES, ids=str)
def test_the_energy_balance_closes_over_ten_revolutions(case):
    """Johnson's law leaves its domain in some cases at .02 mm, so it goes on along its tangent."""
    run = simulate(slider_crank(*case), revolutions=10, beyond="tangent")
    assert np.abs(run.energy_error).max() < 1e-5 * run.kinetic_energy.max()


@pytest.mark.parametrize("clearance", [0.5, 0.1, 0.01])
def test_a_four_bar_with_a_clearance_keeps_its_energy(clearance):
    run = simulate(mechanism_from(FOUR_BAR, clearance=clearance), revolutions=2)
    assert run.settings.method == "multiplier"
    assert len(run.contacts) > 3
    assert np.abs(run.energy_error).max() < 1e-6 * run.kinetic_energy.max()
    assert run.drift[:, 0].max() < 1e-9


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


def test_no_shallow_contact_is_leapt_over():
    """Without a look at turning points, a contact 10 nm deep is missed in this run."""
    run = simulate(slider_crank(friction=0.0), revolutions=10, tolerance=1e-6)
    time = np.linspace(0, run.time[-1], 200_000)
    excess = (
        np.hypot(*eccentricity_at(run.joint, time).T)
        - run.mechanism.clearance.contact.radial * 1e-3
    )
    row = np.searchsorted(run.time, time, side="left")
    free = ~run.in_contact[row] & (row > 0)
    assert excess[free].max() < 1e-9


def test_the_papers_step_control_begins_contacts_in_depth_and_costs_energy():
    mechanism = slider_crank()
    errors = {}
    for allowed in (1e-5, 1e-6, 1e-7):
        run = simulate(mechanism, revolutions=1, allowed_penetration=allowed)
        begins = np.flatnonzero(np.diff(run.in_contact.astype(int)) == 1) + 1
        depths = run.penetration[begins]
        assert (depths >= 0).all()
        assert depths.max() <= allowed
        assert depths.max() > allowed / 20
        errors[allowed] = np.abs(run.energy_error).max()
    located = np.abs(simulate(mechanism, revolutions=1).energy_error).max()
    assert errors[1e-5] > 100 * errors[1e-6] > 100 * located


def test_johnsons_law_is_left_and_says_where():
    with pytest.raises(LawDomainError) as caught:
        simulate(slider_crank("johnson", 0.02, 1.0, 0.1), revolutions=3)
    message = str(caught.value)
    assert "joint.wrist-pin.law = 'johnson': leaves its domain at t = 0.00109" in message
    assert "reaches 10.83 µm and the limit is 10.83 µm" in message
    assert "tangent" in caught.value.remedy


def test_the_tangent_takes_over_smoothly_and_is_told():
    mechanism = slider_crank("johnson", 0.02, 1.0, 0.1)
    run = simulate(mechanism, revolutions=1, beyond="tangent")
    limit = TANGENT_FROM * float(Johnson().max_penetration(mechanism.clearance.contact.pair))
    assert run.penetration.max() * 1e3 > limit
    note = run.statistics().continuation
    assert note in run.assumptions
    assert note.startswith("beyond 9.744 µm the law goes on along its tangent, up to ")
    below, above = (
        run.joint.elastic_force(limit * 1e-3 * factor) for factor in (1 - 1e-9, 1 + 1e-9)
    )
    assert below == pytest.approx(above, rel=1e-8)
    deeper = run.joint.elastic_force(1.1 * limit * 1e-3)
    slope = float(Johnson().stiffness(limit, mechanism.clearance.contact.pair)) * 10.0
    assert deeper == pytest.approx(below + slope * 0.1 * limit, rel=1e-8)
    assert np.isnan(run.joint.contact.kernel.load(1.2 * limit))


def test_steps_that_collapse_are_told():
    """A rod barely longer than the crank locks up: at 90° it stands square to the slide."""
    spec = {
        "bodies.rod.points": {"pin": [-0.02500001, 0.0], "eye": [0.02500001, 0.0]},
        "bodies.rod.guess": [0.075, 0.0, 0.0],
        "bodies.slider.guess": [0.1, 0.0, 0.0],
    }
    with pytest.raises(InputError, match="the steps collapse at t = ") as caught:
        simulate(slider_crank(spec=spec), "minimal", revolutions=1)
    assert caught.value.key == "integration.tolerance"


LONG_ROD = {
    "bodies.rod.mass": 0.35,
    "bodies.rod.inertia": 1.2e-3,
    "bodies.rod.points": {"pin": [-0.1, 0.0], "eye": [0.1, 0.0]},
    "bodies.rod.guess": [0.15, 0.0, 0.0],
    "bodies.slider.mass": 0.42,
    "bodies.slider.guess": [0.25, 0.0, 0.0],
}
# Where the 782 revolutions before have led to.
AFTER_782 = (
    *(2.790042007541264e-05, -2.5060670061824945e-06, 0.05326960759576507, 0.09644491702193313),
    *(3696.0951019501767, 0.0, 3695.9066341170746, 3.0343558635828955e-05, 37470.84493688622),
)


def test_a_step_that_passes_a_kink_and_turns_back_to_it_is_not_repeated_forever():
    """v_t passes −v1, where friction bends, and would turn within the step to pass it again."""
    mechanism = slider_crank("enhanced", 0.02, 1.0, 0.1, LONG_ROD)
    y, ledgers = AFTER_782[:4], AFTER_782[4:]
    values = np.array((*y, ledgers[0], 0.0, *ledgers[1:]))
    state = State(9.384, values, np.array([True]), np.array([0.05485815933107521]))
    run = Run.start(mechanism, settings_for(mechanism), state)
    (rows,) = run.revolutions(783, silent, 782)
    assert rows.time[-1] == pytest.approx(783 * mechanism.period, rel=1e-15)
    assert rows.counts[0, 0] < 3000


def test_a_revolution_has_a_largest_number_of_steps(monkeypatch):
    for name, value in {"_BUFFER": 64, "_MOST_STEPS": 200, "_MORE_PER_SECOND": 0}.items():
        monkeypatch.setattr(running, name, value)
    with pytest.raises(
        InputError, match=r"revolution 0 has not ended after 256 steps, at t = 0\.00"
    ):
        simulate(slider_crank(), revolutions=2)


def test_minimal_coordinates_are_for_a_slider_crank():
    with pytest.raises(
        InputError, match="is for a slider-crank at constant speed with a clearance"
    ):
        simulate(mechanism_from(FOUR_BAR), "minimal")
    elsewhere = moved("crank-pin")
    with pytest.raises(InputError, match='use "multiplier"'):
        simulate(elsewhere, "minimal")


def moved(joint, **changes):
    """The slider-crank with the clearance of the wrist pin at another joint."""
    ideal = {"joint.wrist-pin": {"name": "wrist-pin", "between": ["rod.eye", "slider.pin"]}}
    return mechanism_from(changed(with_clearance(SLIDER_CRANK, joint, **changes), ideal))
