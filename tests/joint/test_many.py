"""Many joints in one call: each row as its joint by itself, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.files.spec import read_toml
from cylcontact.fitting.adapters import ScaledLaw
from cylcontact.joint import ClearanceJoints, joint_from
from cylcontact.joint.clearance import JointState
from tests.support.spec_files import changed

EXAMPLE = read_toml(Path(__file__).resolve().parents[2] / "datasets/joint.toml")
STEEL = Material("steel", E=207e3, nu=0.3)
N = 12
LAWS = {
    "johnson": laws.Johnson(), "enhanced": laws.Enhanced(), "explicit": laws.Explicit(),
    "liu": laws.Liu(), "lankarani-nikravesh": laws.LankaraniNikravesh(),
    "goldsmith": laws.LAWS["goldsmith"](), "conformal": laws.Conformal(),
    "persson": laws.Persson(),
}  # fmt: skip


def numbers(law):
    """What differs between the joints; conformal ones have one material each."""
    rng = np.random.default_rng(0)
    of = {"R": 10 ** rng.uniform(0.9, 1.5, N), "gap": 10 ** rng.uniform(-3, -2.4, N)}
    of |= {"E": rng.uniform(7e4, 2.1e5, N), "nu": rng.uniform(0.25, 0.35, N)}
    own = law in ("conformal", "persson")
    of["E_pin"] = of["E"] if own else rng.uniform(7e4, 2.1e5, N)
    of |= {"e": rng.uniform(0.3, 1, N), "mu": rng.uniform(0, 0.3, N)}
    return of | {"point": rng.uniform(-5, 5, (N, 2)), "length": 12.0}


def joints_for(law, units="SI"):
    of = numbers(law)
    hole, pin = Material("hole", of["E"], of["nu"]), Material("pin", of["E_pin"], of["nu"])
    pair = CylinderPair.internal(
        R_i=of["R"], R_j=of["R"] * (1 - of["gap"]), hole=hole, pin=pin, length=of["length"]
    )
    return ClearanceJoints(
        LAWS[law], pair, of["e"], of["mu"], 1.0, 10.0, point_bearing=of["point"], units=units
    )


def single(law, units, k):
    of = numbers(law)
    R, gap, (x, y) = of["R"][k], of["gap"][k], of["point"][k]
    body = lambda E: {"E": 1e-3 * float(E), "nu": float(of["nu"][k])}  # noqa: E731
    return joint_from(changed(EXAMPLE, {
        "law": law, "units": units, "length": of["length"],
        "bearing": {"R": float(R), "point": [float(x), float(y)], **body(of["E"][k])},
        "pin": {"R": float(R * (1 - gap)), **body(of["E_pin"][k])},
        "dissipation": {"factor": "exact", "restitution": float(of["e"][k])},
        "friction": {"coefficient": float(of["mu"][k]), "v0": 1.0, "v1": 10.0},
    }))  # fmt: skip


@pytest.mark.parametrize("units", ["SI", "mm"])
@pytest.mark.parametrize("law", LAWS)
def test_a_row_is_its_joint_by_itself(law, units):
    """Joints × states: 3 motions each, in another order, one of them free."""
    joints, rng = joints_for(law, units), np.random.default_rng(1)
    of = rng.permutation(np.repeat(np.arange(N), 3))
    unit, data = {"SI": 1e3, "mm": 1.0}[units], numbers(law)
    clearance = (data["R"] * data["gap"])[of]
    away = (
        clearance * rng.choice([0.5, 1.001, 1.02, 1.7], of.size) * np.exp(6j * rng.random(of.size))
    )
    away += data["point"][of] @ [1, 1j]
    pins = rng.normal(size=(of.size, 6)) * [0, 0, 1, 50 / unit, 50 / unit, 5]
    pins[:, 0], pins[:, 1] = away.real / unit, away.imag / unit
    state = joints.accept(joints.start(of.size), np.zeros(6), pins, of)
    wrench = joints.evaluate(state, np.zeros(6), pins, of)
    assert 0.4 < (wrench.penetration > 0).mean() < 0.9
    for row, which in enumerate(of):
        one = single(law, units, which)
        kept = one.accept(one.start(), np.zeros(6), pins[row])
        assert state.impact_rate[row] == pytest.approx(kept.impact_rate, rel=1e-9)
        wanted = one.evaluate(JointState(state.impact_rate[row]), np.zeros(6), pins[row])
        # The clearance R_i − R_j is rounded differently, and a penetration is a part of it.
        for name in wanted._fields:
            got, value = getattr(wrench, name)[row], getattr(wanted, name)
            np.testing.assert_allclose(got, value, rtol=1e-6, atol=1e-9 * np.abs(value).max())


def test_a_row_for_each_joint_is_the_default():
    joints = joints_for("enhanced")
    pins = np.zeros((N, 6))
    assert len(joints) == N
    assert joints.evaluate(joints.start(), np.zeros(6), pins).normal_force.shape == (N,)


def pair_of(pin, hole=STEEL, length=10.0):
    return CylinderPair.internal(10.0, np.array([9.99, 9.98]), pin=pin, hole=hole, length=length)


TWO = Material("two", np.array([7e4, 2e5]), 0.3)
REFUSED = {
    "unlike": (lambda: ClearanceJoints(laws.Conformal(), pair_of(TWO)), "make a ClearanceJoints"),
    "housing": (
        lambda: ClearanceJoints(laws.Conformal(laws.Housing(20.0)), pair_of(STEEL)), "in a housing"
    ),
    "table": (
        lambda: ClearanceJoints(ScaledLaw(laws.Liu(), 0.7), pair_of(STEEL)), "loop over Clearance"
    ),
    "restitution": (lambda: ClearanceJoints(laws.Liu(), pair_of(STEEL), [0.9, 0]), "lie in (0, 1]"),
    "friction": (lambda: ClearanceJoints(laws.Liu(), pair_of(STEEL), friction=3.0), "from 0 to 2"),
    "speeds": (lambda: ClearanceJoints(laws.Liu(), pair_of(STEEL), v0=2.0), "0 ≤ v0 < v1"),
    "one": (
        lambda: ClearanceJoints(laws.Liu(), CylinderPair.internal(10.0, 9.9, STEEL, length=1.0)),
        "as arrays of shape (n,)",
    ),
    "no length": (lambda: ClearanceJoints(laws.Liu(), pair_of(STEEL, length=None)), "axial length"),
    "of": (
        lambda: ClearanceJoints(laws.Liu(), pair_of(STEEL)).evaluate(
            JointState(np.zeros(3)), np.zeros(6), np.zeros((3, 6)), [0, 1, 2]
        ),
        "must be from 0 to 1",
    ),
    "rows": (
        lambda: ClearanceJoints(laws.Liu(), pair_of(STEEL)).evaluate(
            JointState(np.zeros(3)), np.zeros(6), np.zeros((3, 6))
        ),
        "is not one joint for each of 3 rows",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("act", "message"), REFUSED.values(), ids=REFUSED)
def test_what_makes_no_joints_is_refused(act, message):
    with pytest.raises(InputError) as caught:
        act()
    assert message in str(caught.value)


def test_one_pair_of_unlike_materials_shares_a_curve():
    bronze = Material("bronze", 105e3, 0.34)
    joints = ClearanceJoints(laws.Conformal(), pair_of(STEEL, bronze), 1.0)
    pins = np.array([[0.0105e-3, 0, 0, 0, 0, 0], [0.0205e-3, 0, 0, 0, 0, 0]])
    force = joints.evaluate(joints.start(), np.zeros(6), pins).normal_force
    wanted = laws.Conformal().load(np.array([0.5e-3, 0.5e-3]), pair_of(STEEL, bronze)) * 10.0
    np.testing.assert_allclose(force, wanted, rtol=1e-8)
