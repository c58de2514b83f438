"""Every place that takes a housing: tables, fits, comparisons and joints."""

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, choose, fit, laws
from cylcontact.laws import Housing, Sector
from cylcontact.mechanism import joint_from
from tests.support.joint_runners import run_c

STEEL, BRONZE = Material("steel", 207e3, 0.3), Material("bronze", 110e3, 0.34)
PAIR = CylinderPair.internal(R_i=10.0, R_j=9.95, pin=STEEL, hole=BRONZE, length=20.0)


def readings(tmp_path):
    """Readings of a rod eye that is pulled, with one percent of scatter."""
    law = laws.Conformal(Housing(20.0, Sector(60, "pulled")))
    f = np.geomspace(20.0, 2000.0, 40)
    delta = law.penetration(f, PAIR) * (1 + 0.01 * np.random.default_rng(3).standard_normal(40))
    lines = [f"{x!r},{1e3 * y!r}" for x, y in zip(f.tolist(), delta.tolist(), strict=True)]
    path = tmp_path / "eye.csv"
    path.write_text("\n".join(["load_N_per_mm,penetration_um", *lines]) + "\n")
    return path


EYE = {"R_o": 20.0, "clamp": "sector", "angle": 60.0, "side": "pulled"}


@pytest.mark.slow
def test_a_fit_in_a_known_housing_finds_the_stiffness_of_the_materials(tmp_path):
    path = readings(tmp_path)
    result = fit(path, "conformal", PAIR, housing=EYE, fixed={"offset": 0.0})
    estimate = result.estimates["stiffness_factor"]
    assert estimate.low < 1 < estimate.high
    assert estimate.high - estimate.low < 0.02
    # By Johnson's datum the same readings say that the materials are soft.
    plain = fit(path, "conformal", PAIR, fixed={"offset": 0.0})
    assert plain.coefficients["stiffness_factor"] < 0.5


@pytest.mark.slow
def test_choose_holds_the_compliance_of_the_law_in_the_housing(tmp_path):
    choice = choose(readings(tmp_path), PAIR, laws=["conformal", "johnson"], housing=EYE)
    assert choice.table.index[0] == "conformal"
    names = {law.law: law.optimum.fit.model.names for law in choice.laws}
    assert "compliance" not in names["conformal"]
    assert "compliance" in names["johnson"]


def test_a_law_that_takes_no_housing_is_refused(tmp_path):
    with pytest.raises(InputError, match="takes no housing; choose conformal"):
        fit(readings(tmp_path), "johnson", PAIR, housing=EYE)


JOINT = {
    "name": "eye", "units": "mm", "law": "conformal", "length": 10.0,
    "bearing": {"R": 10.0, "E": 110.0, "nu": 0.34}, "pin": {"R": 9.95, "E": 207.0, "nu": 0.3},
    "dissipation": {"factor": "exact", "restitution": 0.9}, "housing": {"R_o": 20.0},
    "friction": {"coefficient": 0.1, "v0": 0.1, "v1": 1.0},
}  # fmt: skip


def test_a_joint_takes_a_whole_rim_and_is_exported_with_it(tmp_path):
    joint = joint_from(JOINT)
    expected = float(laws.Conformal(Housing(20.0)).load(5e-3, joint.pair))
    assert joint.kernel.load(5e-3) == pytest.approx(expected, rel=1e-12)
    bearing, pin = [0.0] * 6, [0.05 + 0.005, 0.0, 0.0, 0.0, 0.0, 0.0]
    answers = run_c(joint, np.array([[0.0, *bearing, *pin]]), tmp_path)
    assert answers[0, 8] == pytest.approx(10.0 * expected, rel=1e-8)


SECTOR = {"clamp": "sector", "angle": 60.0, "side": "pulled"}


@pytest.mark.parametrize(
    ("law", "housing", "words"),
    [
        ("conformal", {"layers": [{"R_i": 12.0, "E": 70.0}]}, "layers.0.nu: is required"),
        ("conformal", {"layers": [{"R_i": 12.0, "material": "x"}]}, "housing.layers = 'x'"),
        ("conformal", SECTOR, "has a direction"),
        ("johnson", {}, "takes no housing"),
        ("conformal", {"clamp": "sector"}, "is missing for a sector"),
    ],
)
def test_a_joint_in_no_housing_is_refused(law, housing, words):
    with pytest.raises(InputError, match=words):
        joint_from({**JOINT, "law": law, "housing": {"R_o": 20.0, **housing}})
