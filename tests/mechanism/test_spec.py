"""Specs of mechanisms: every mistake told in one line."""

import numpy as np
import pytest

from cylcontact import InputError, Material
from cylcontact.files.spec import read_toml
from cylcontact.mechanism import joint_from, mechanism_from, read_mechanism
from tests.support.mechanism_cases import FOUR_BAR, ROOT, SLIDER_CRANK
from tests.support.spec_files import DROP, changed

PIN = "joint.wrist-pin"
IDEAL = {"name": "rocker-pin", "between": ["coupler.rocker", "rocker.pin"]}
MISTAKES = [
    ({f"{PIN}.clearance": 10.0}, f"{PIN}.clearance = 10.0: leaves no pin"),
    ({f"{PIN}.pin.R": 9.0}, f"{PIN}.pin.R = 9.0: is given twice"),
    ({f"{PIN}.clearance": DROP}, f"{PIN}.pin.R: is required; give R of the pin, or the clearance"),
    ({"bodies.ground": SLIDER_CRANK["bodies"]["rod"]}, "bodies.ground: is no body's name"),
    ({f"{PIN}.law": "jonson"}, f"{PIN}.law = 'jonson': is neither a law nor a fit result"),
    ({f"{PIN}.pin.material": "soap", f"{PIN}.pin.E": DROP, f"{PIN}.pin.nu": DROP},
     f"{PIN}.pin.material = 'soap': is not in the tables of materials"),
    ({f"{PIN}.pin.point": [1.0, 0.0]}, f"{PIN}.pin.point: is where `between` says; remove it"),
    ({f"{PIN}.housing": {"R_o": 30.0}}, f"{PIN}.law = 'enhanced': takes no housing; choose"),
    ({f"{PIN}.wear": 1.0}, "joint.2.wear = 1.0: is not a known key; known keys here: name, type"),
    ({"joint.slide.clearance": 0.2}, "joint.slide.type = 'prismatic': has no clearance; give it"),
    ({"joint.main.clearance": 0.2, "joint.main.length": 10.0}, "joint.main.law: is required"),
    ({"joint.main.fit": "20H7/g6"}, "joint.main.length: is required"),
    ({"joint.main.name": "slide"}, "joint = 'slide': is the name of two joints; give each a name"),
    ({"joint.drive.speed": 0.0}, "speed = 0.0: must not be zero"),
    ({"joint.drive.torque": 1.0}, "speed = -5000.0: is given beside a torque"),
    ({"joint.slide.direction": DROP}, "direction: is required for a prismatic"),
    ({"joint.main.between": ["ground.pivot", "wheel.hub"]}, "'wheel.hub': names no body"),
    ({"joint.drive.between": ["ground", "crank.pin"]}, "'crank.pin': names a point"),
    ({"spring": [{"between": ["ground", "crank.pin"]}]}, "'ground': names no point"),
    ({"spring": [{"between": ["ground", "crank"], "length": 0.1}]},
     "spring.0.length = 0.1: is not for a spring between bodies; remove it"),
    ({"spring": [{"between": ["ground.pivot", "crank.pin"], "angle": 3.0}]}, "angle = 3.0: is not"),
    ({"integration.period": 0.1}, "integration.period = 0.1: is given beside a driver"),
    ({"load": [{"at": "crank"}]}, "load.at = 'crank': names no point"),
    ({"joint.drive.speed": DROP, "joint.drive.torque": 1.0},
     "integration.period: is required without a driver of a given speed; add what counts as one"),
    ({"clearance": {"joint": "wrist-pin", "bearing": "slider", "radial": 0.5, "E": 207.0},
      "joints": {"wrist-pin": {"between": ["rod.eye", "slider.pin"]}}},
     '[clearance]: is an entry of [[joint]] now; write [[joint]] with name = "wrist-pin", '),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "message"), MISTAKES, ids=lambda value: str(value)[:60])
def test_mistakes_are_told(changes, message):
    with pytest.raises(InputError) as caught:
        mechanism_from(changed(SLIDER_CRANK, changes), "mine.toml")
    assert str(caught.value).startswith("mine.toml: ")
    assert message in str(caught.value)


def test_every_number_of_the_paper_is_the_papers():
    """Sect. 4.2: 5000 rpm clockwise, 10 mm, 10 mm, 207 GPa, .3, .9, .1, α = β = .5, 1e-4 s."""
    mechanism = read_mechanism(ROOT / "datasets/slider_crank.toml")
    contact, integration = mechanism.clearance.contact, SLIDER_CRANK["integration"]
    assert mechanism.driver.speed == pytest.approx(-523.5987755982989)
    steel = Material("", 207e3, 0.3)
    for material in (contact.pair.material_i, contact.pair.material_j):
        assert (material.E, material.nu) == (steel.E, steel.nu)
    assert (contact.pair.R_i, contact.pair.length, contact.friction) == (10.0, 10.0, 0.1)
    assert contact.data["dissipation"]["restitution"] == 0.9
    assert [integration[key] for key in ("alpha", "beta", "max_step")] == [0.5, 0.5, 1e-4]


def test_changes_take_the_place_of_the_specs_values():
    mechanism = mechanism_from(FOUR_BAR, clearance=0.2, law="johnson", friction=0.0)
    contact = mechanism.clearance.contact
    assert (contact.radial, contact.law.name, contact.friction) == (0.2, "johnson", 0.0)
    assert mechanism_from(mechanism.data).clearance.contact.pair == contact.pair
    assert mechanism_from(FOUR_BAR).clearance.contact.radial == 0.1


def test_a_clearance_may_have_what_a_joint_has():
    """Two materials, a fit's result, a yield stress, a housing: by the keys of a joint's file."""
    joint = read_toml(ROOT / "datasets/joint.toml")
    entry = joint | {"between": ["rod.eye", "slider.pin"], "housing": {"R_o": 30.0}}
    mechanism = mechanism_from(changed(SLIDER_CRANK, {PIN: entry}))
    (found,) = mechanism.clearances
    alone = joint_from(joint | {"housing": {"R_o": 30.0}})
    assert (found.contact.pair, found.contact.first_yield) == (alone.pair, alone.first_yield)
    depth = np.linspace(0, 0.02, 9)
    assert np.array_equal(
        found.contact.law.load(depth, alone.pair), alone.law.load(depth, alone.pair)
    )
    assert found.contact.point_bearing == (60.0, 0.0)
    fitted = mechanism_from(SLIDER_CRANK, law=str(ROOT / "fitting/results/internal.json"))
    assert fitted.clearance.contact.origin.startswith("fit result 'internal'")


def test_a_law_is_read_where_the_clearance_is_0():
    with pytest.raises(InputError, match="'nonsense': is neither a law nor a fit result"):
        mechanism_from(FOUR_BAR, law="nonsense", clearance=0.0)


def test_what_cannot_be_changed_is_told():
    ideal = mechanism_from(changed(FOUR_BAR, {"joint.rocker-pin": IDEAL}))
    assert not ideal.clearances
    assert not ideal.assumptions
    with pytest.raises(InputError, match=r"clearance = 0\.2: is for joints with clearance, and th"):
        mechanism_from(ideal.data, clearance=0.2)
    with pytest.raises(InputError, match="speed = 3: cannot be set; choose law, clearance"):
        mechanism_from(FOUR_BAR, speed=3)


def test_a_material_of_a_users_table_is_kept_in_the_data(tmp_path):
    own = tmp_path / "own.csv"
    own.write_text("name,E_GPa,nu\nbrass,102.5,0.34\n", encoding="utf-8")
    bodies = {
        f"{PIN}.pin": {"material": "Brass"},
        f"{PIN}.bearing": {"R": 10.0, "material": "bronze"},
    }
    mechanism = mechanism_from(changed(SLIDER_CRANK, bodies), "mine", own)
    again = mechanism_from(mechanism.data)  # as a saved run has it, without the table
    for pair in (mechanism.clearance.contact.pair, again.clearance.contact.pair):
        assert (float(pair.material_j.E), pair.material_j.nu) == (102.5e3, 0.34)
        assert pair.material_i == Material.named("bronze")


def test_lengths_in_metres_are_warned_of():
    metres = {f"{PIN}.bearing.R": 0.01, f"{PIN}.clearance": 5e-4}
    (first, *_) = mechanism_from(changed(SLIDER_CRANK, metres)).warnings
    assert first.startswith("the radius of the hole in mm is 0.01")


# The extent of the slider-crank is that from its pivot to its slider, 0.17 m, whose cube of
# 20,000 kg/m³ weighs 98.26 kg.
@pytest.mark.parametrize(
    ("changes", "sentences"),
    [
        ({"bodies.slider.mass": 98.25, "bodies.slider.inertia": 1e-2}, []),
        ({"bodies.slider.mass": 98.27, "bodies.slider.inertia": 1e-2},
         ["slider has 98.27 kg in a mechanism of 0.17 m; masses are in kg, not in g"]),
        ({"bodies.crank.mass": 300.0, "bodies.rod.mass": 210.0}, ["crank has", "rod has"]),
        ({"bodies.crank.inertia": 0.3 * 0.1699**2}, []),
        ({"bodies.crank.inertia": 0.3 * 0.1701**2}, ["crank has a radius of gyration of 0.17 m"]),
        ({"bodies.crank.inertia": 0.3 * 0.1701e-3**2}, []),
        ({"bodies.crank.inertia": 0.3 * 0.1699e-3**2}, ["crank has a radius of gyration of 0.000"]),
        ({"bodies.crank.inertia": 1e5, "bodies.rod.inertia": 2.5e5}, ["crank has a", "rod has a"]),
    ],
)  # fmt: skip
def test_masses_that_can_hardly_be_meant_are_warned_of(changes, sentences):
    warnings = mechanism_from(changed(SLIDER_CRANK, changes)).warnings
    assert len(warnings) == len(sentences)
    for warning, sentence in zip(warnings, sentences, strict=True):
        assert warning.startswith(sentence)
