"""Files of slider-cranks: what they hold, every mistake in one line, and hints of units."""

import math

import numpy as np
import pytest

from cylcontact import InputError, Material, laws
from cylcontact.files.spec import read_toml
from cylcontact.mechanism import joint_from, long_run, mechanism_from, read_mechanism, simulate
from tests.support.mechanism_cases import ROOT, SLIDER_CRANK, SPEC
from tests.support.spec_files import DROP, changed, write_toml

MISTAKES = [
    ({"joint.clearance": 10.0}, "joint.clearance = 10.0: leaves no pin"),
    ({"joint.clearance": 0.0}, "joint.clearance = 0.0: must be greater than 0"),
    ({"joint.pin.R": 9.0}, "joint.pin.R = 9.0: is given twice"),
    ({"joint.clearance": DROP}, "joint.pin.R: is required; give R of the pin, or the clearance"),
    ({"joint.law": "power-clearance"}, "'power-clearance': has no fixed coefficients; name a fit"),
    ({"joint.law": "jonson"}, "joint.law = 'jonson': is neither a law nor a fit result"),
    ({"joint.law": "mine.json"}, "joint.law = 'mine.json': is neither beside this file nor in"),
    ({"joint.pin.material": "soap", "joint.pin.E": DROP, "joint.pin.nu": DROP},
     "joint.pin.material = 'soap': is not in the tables of materials"),
    ({"joint.pin.point": [1.0, 0.0]}, "joint.pin.point = (1.0, 0.0): must be 0: the joint is at"),
    ({"joint.housing": {"R_o": 30.0}}, "joint.law = 'enhanced': takes no housing; choose"),
    ({"joint.wear": 1.0}, "joint.wear = 1.0: is not a known key"),
    ({"joint.bearing.E": 2.07e11}, "did you mean 207?"),
    ({"joint.bearing.E": 2.07e5}, "did you mean 207?"),
    ({"joint": [{"name": "main"}]}, "joint"),
    ({"speed": 0.0}, "speed = 0.0: must not be zero; give it in rpm"),
    ({"rod.length": 49.0}, "rod.length = 49.0: is too short: crank, offset and clearance tak"),
    ({"rod.length": 50.6}, "rod.length = 50.6: is too short: crank, offset and clearance tak"),
    ({"offset": -80.0}, "rod.length = 120.0: is too short: crank, offset and clearance take 130.5"),
    ({"eccentricity": [0.3, 0.4]}, "eccentricity = [0.3, 0.4]: is outside the clearance of 0.5 mm"),
    ({"rod.mass": DROP}, "rod.mass: is required; add the mass in kg"),
    ({"tolerance": 2.0}, "tolerance = 2.0: must be less than or equal to 0.001"),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "message"), MISTAKES, ids=lambda value: str(value)[:60])
def test_every_mistake_is_one_line(changes, message):
    with pytest.raises(InputError) as caught:
        mechanism_from(changed(SLIDER_CRANK, changes), "mine.toml")
    assert str(caught.value).startswith("mine.toml: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_every_number_of_the_paper_is_the_papers():
    """Sect. 4.2: 5000 rpm clockwise, 10 mm, 10 mm, 207 GPa, .3, .9, .1, 1e-4 s."""
    mechanism = read_mechanism(SPEC)
    joint, steel = mechanism.joint, Material("", 207e3, 0.3)
    assert mechanism.omega == pytest.approx(-523.5987755982989)
    for material in (joint.pair.material_i, joint.pair.material_j):
        assert (material.E, material.nu) == (steel.E, steel.nu)
    assert (joint.pair.R_i, joint.pair.length, joint.friction) == (10.0, 10.0, 0.1)
    assert joint.data["dissipation"]["restitution"] == 0.9
    assert mechanism.spec.max_step == 1e-4


def test_changes_replace_values_of_the_file():
    mechanism = read_mechanism(SPEC, clearance=0.2, law="johnson", friction=0.0, tolerance=1e-9)
    joint = mechanism.joint
    assert (joint.radial, joint.law.name, joint.friction) == (0.2, "johnson", 0.0)
    assert mechanism.spec.tolerance == 1e-9
    again = mechanism.changed(restitution=1.0)
    assert (again.joint.pair, again.joint.chi) == (joint.pair, 0.0)
    assert read_mechanism(SPEC).joint.radial == 0.5
    with pytest.raises(InputError, match="speed = 3: cannot be set; choose law, clearance"):
        read_mechanism(SPEC, speed=3)


def test_a_clearance_replaces_a_fit():
    fitted = {"joint.iso": "20H7/g6", "joint.clearance": DROP, "joint.bearing.R": DROP}
    mechanism = mechanism_from(changed(SLIDER_CRANK, fitted))
    assert mechanism.joint.radial == pytest.approx(0.012)
    wide = mechanism.changed(clearance=0.2).joint.pair
    assert (wide.R_i, wide.dR) == pytest.approx((10.00525, 0.2))


def test_the_joint_takes_all_that_a_joints_file_takes():
    """Two materials, a yield stress, a housing; a fit's result; a law as an object."""
    entry = {**read_toml(ROOT / "datasets/joint.toml"), "housing": {"R_o": 30.0}}
    alone, mechanism = joint_from(entry), mechanism_from({**SLIDER_CRANK, "joint": entry})
    depth = np.linspace(0, 0.02, 9)
    assert (mechanism.joint.pair, mechanism.joint.first_yield) == (alone.pair, alone.first_yield)
    loads = [joint.law.load(depth, alone.pair) for joint in (mechanism.joint, alone)]
    assert np.array_equal(*loads)
    fitted = mechanism_from(SLIDER_CRANK, law=str(ROOT / "fitting/results/internal.json"))
    assert fitted.joint.origin.startswith("fit result 'internal'")
    own = laws.PowerLaw(n=1.3, K_star=1.1)
    run = simulate(read_mechanism(SPEC, law=own).changed(friction=0.0), revolutions=1)
    load = own.load(np.maximum(run.penetration, 0) * 1e3, run.mechanism.joint.pair)
    assert run.normal_force.max() == pytest.approx((load * 10.0 * run.in_contact).max(), rel=0.2)


def test_a_fits_result_is_searched_beside_the_file_first(tmp_path, monkeypatch):
    """The one in the working folder is of external contact, and would be refused."""
    (tmp_path / "here").mkdir()
    for source, target in (("internal", "mine.json"), ("external", "here/mine.json")):
        text = (ROOT / f"fitting/results/{source}.json").read_text(encoding="utf-8")
        (tmp_path / target).write_text(text, encoding="utf-8")
    write_toml(tmp_path / "crank.toml", changed(SLIDER_CRANK, {"joint.law": "mine.json"}))
    monkeypatch.chdir(tmp_path / "here")
    assert read_mechanism("../crank.toml").joint.origin.startswith("fit result 'internal'")


def test_a_material_of_a_users_table_is_that_of_all_cases(tmp_path):
    own = tmp_path / "own.csv"
    own.write_text("name,E_GPa,nu\ngunmetal,102.5,0.34\n", encoding="utf-8")
    changes = {"joint.pin": {"material": "Gunmetal"}}
    mechanism = mechanism_from(changed(SLIDER_CRANK, changes), "mine", own)
    for case in (mechanism, mechanism.changed(clearance=0.1)):
        pin = case.joint.pair.material_j
        assert (float(pin.E), pin.nu) == (102.5e3, 0.34)


@pytest.mark.parametrize(
    ("changes", "sentences"),
    [
        ({}, []),
        # The cube of 0.17 m in a material of 20,000 kg/m³ weighs 98.26 kg.
        ({"slider.mass": 98.25}, []),
        ({"slider.mass": 98.27}, ["the slider has 98.27 kg; masses are in kg, not in g"]),
        ({"slider.mass": 500.0, "joint.length": 450.0}, []),
        ({"crank.mass": 300.0, "rod.mass": 210.0}, ["the crank has 300 kg", "the rod has 210 kg"]),
        ({"rod.inertia": 250.0}, ["the rod, 120 mm long, has a radius of gyration of"]),
        ({"crank.inertia": 1e-7}, ["the crank, 50 mm long, has a radius of gyration of 0.577 mm"]),
        ({"gravity": [0.0, -9.81]}, []),
        ({"gravity": [0.0, -9810.0]}, ["gravity is 9810 m/s²; it is in m/s², not in mm/s²"]),
        ({"joint.bearing.R": 0.01, "joint.clearance": 5e-4, "joint.law": "explicit"},
         ["the radius of the hole in mm is 0."]),
    ],
)  # fmt: skip
def test_numbers_that_are_hardly_meant_have_a_warning(changes, sentences):
    warnings = mechanism_from(changed(SLIDER_CRANK, changes)).warnings
    assert len(warnings) >= len(sentences)
    for warning, sentence in zip(warnings, sentences, strict=False):
        assert warning.startswith(sentence)
    assert sentences or not warnings


# --- the start ----------------------------------------------------------------------------------


@pytest.mark.parametrize("bearing_of", ["rod", "slider"])
def test_a_run_starts_where_the_file_says(bearing_of):
    start = {"eccentricity": [0.1, -0.3], "eccentricity_rate": [40.0, 20.0]}
    mechanism = mechanism_from(changed(SLIDER_CRANK, start | {"bearing_of": bearing_of}))
    run = simulate(mechanism, revolutions=1)
    assert run.eccentricity[0] == pytest.approx([1e-4, -3e-4], rel=1e-15)
    assert run.eccentricity_rate[0] == pytest.approx([0.04, 0.02], rel=1e-15)
    E_x, E_y = run.mechanism.side * run.eccentricity[0]
    position = 0.05 + math.sqrt(0.12**2 - E_y**2) + E_x
    assert run.slider_position[0] == pytest.approx(position, rel=1e-14)
    assert np.abs(run.energy_error).max() < 1e-6 * run.kinetic_energy.max()


def test_a_mirrored_start_gives_the_mirrored_motion():
    """Speed, offset and start mirrored in the slide."""
    start = {"eccentricity": [0.1, -0.3], "eccentricity_rate": [40.0, 20.0], "offset": 5.0}
    mirrored = {"eccentricity": [0.1, 0.3], "eccentricity_rate": [40.0, -20.0], "offset": -5.0}
    one = simulate(mechanism_from(changed(SLIDER_CRANK, start)), revolutions=1)
    spec = mirrored | {"speed": -SLIDER_CRANK["speed"]}
    other = simulate(mechanism_from(changed(SLIDER_CRANK, spec)), revolutions=1)
    assert one.eccentricity * [1, -1] == pytest.approx(other.eccentricity, abs=1e-12)
    assert one.crank_moment == pytest.approx(-other.crank_moment, rel=1e-6, abs=1e-6)


def test_the_estimate_is_for_runs_of_very_many_steps():
    from cylcontact.mechanism.run import estimate

    assert not estimate(read_mechanism(SPEC), 1000)
    slow = mechanism_from(changed(SLIDER_CRANK, {"speed": 1e-3}))
    expected = "a revolution of 6e+04 s in steps of up to 0.0001 s: expect about 6e+08 steps"
    assert estimate(slow, 1) == f"{expected}, which take some 25 minutes"
    assert math.isnan(long_run(read_mechanism(SPEC, friction=0.0), 5).carried)
