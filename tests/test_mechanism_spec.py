"""Specs of mechanisms: every mistake told in one line."""

import pytest

from cylcontact import InputError, Material
from cylcontact.mechanism import mechanism_from, read_mechanism
from cylcontact.mechanism.assumptions import assumptions
from tests.mechanism_cases import FOUR_BAR, ROOT, SLIDER_CRANK
from tests.spec_files import DROP, changed

MISTAKES = [
    ({"clearance.radial": 10.0}, "clearance.radial = 10.0: leaves no journal"),
    ({"bodies.ground": SLIDER_CRANK["bodies"]["rod"]}, "bodies.ground: is no body's name"),
    ({"clearance.law": "jonson"}, "clearance.law = 'jonson': is not a law; choose johnson"),
    ({"clearance.factor": "none"}, "clearance.factor = 'none': is not known; choose hunt-crossley"),
    ({"clearance.yield_stress": -1}, "clearance.yield_stress = -1: must be greater than 0; give "
     "the yield stress of both bodies in MPa"),
    ({"clearance.E": 207e3}, "clearance.E = 207000.0: a bare number is in GPa, and diamond has "
     '1200; did you mean 207? Or write "207000 GPa"'),
    ({"clearance.E": "207"}, "clearance.E = '207': must be a number; give Young's modulus"),
    ({"clearance.E": "hard Pa"}, "clearance.E = 'hard Pa': must be a number with a unit; write"),
    ({"clearance.E": -1.0}, "clearance.E = -1.0: must be greater than 0; give Young's modulus"),
    ({"clearance.E": True}, "clearance.E = True: must be a number; give Young's modulus"),
    ({"clearance.E": DROP}, "clearance.E: is required; give E, or pin and hole"),
    ({"clearance.pin": "PEEK"}, "clearance.hole: is required; give hole, or E and nu"),
    ({"clearance.pin": "PEEK", "clearance.hole": "PEEK"},
     "clearance.E = 207.0: is that of the materials already; remove it"),
    ({"clearance.pin": "soap"}, "clearance.pin = 'soap': is not in the tables of materials"),
    ({"clearance.v1": 0.5}, "clearance.v1 = 0.5: must be above v0 = 1.0"),
    ({"clearance.joint": "slide"}, "'slide': is not a revolute joint; choose main, crank-pin"),
    ({"clearance.bearing": "crank"}, "clearance.bearing = 'crank': is not at that joint"),
    ({"joints.drive.speed": 0.0}, "joints.drive.speed = 0.0: must not be zero"),
    ({"joints.drive.speed": DROP}, "joints.drive.speed: is required for a driver"),
    ({"joints.slide.direction": DROP}, "joints.slide.direction: is required for a prismatic"),
    ({"joints.main.speed": 3.0}, "joints.main.speed = 3.0: is not for a revolute"),
    ({"joints.main.between": ["ground.pivot", "wheel.hub"]}, "'wheel.hub': names no body"),
    ({"joints.main.between": ["ground.pivot", "crank.end"]}, "'crank.end': names no point"),
    ({"joints.drive.between": ["ground", "crank.pin"]}, "'crank.pin': names a point"),
    ({"joints.drive.type": "revolute", "joints.drive.speed": DROP,
      "joints.drive.between": ["ground.pivot", "crank.pivot"]}, "there must be one driver"),
    ({"provenance.paper": ["clearance"], "provenance.assumed": ["gravity"]},
     "provenance = 'ground.points.pivot': has no provenance; list it under paper, derived"),
    ({"provenance.derived": ["bodies.flywheel"]}, "'bodies.flywheel': covers nothing in the file"),
    ({"provenance.derived": ["bodies"]}, "provenance = 'bodies': is listed twice"),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "message"), MISTAKES, ids=lambda value: str(value)[:60])
def test_mistakes_are_told(changes, message):
    with pytest.raises(InputError) as caught:
        mechanism_from(changed(SLIDER_CRANK, changes), "mine.toml")
    assert str(caught.value).startswith("mine.toml: ")
    assert message in str(caught.value)


def test_the_shipped_specs_are_read():
    for name, bodies in (("slider_crank", 3), ("four_bar", 3)):
        mechanism = read_mechanism(ROOT / f"datasets/{name}.toml")
        assert len(mechanism.bodies) == bodies
        assert mechanism.assumptions


def test_every_number_of_the_paper_is_the_papers():
    """Sect. 4.2: 5000 rpm clockwise, 10 mm, 10 mm, 207 GPa, .3, .9, .1, α = β = .5, 1e-4 s."""
    mechanism = read_mechanism(ROOT / "datasets/slider_crank.toml")
    clearance, integration = SLIDER_CRANK["clearance"], SLIDER_CRANK["integration"]
    assert mechanism.driver.speed == pytest.approx(-523.5987755982989)
    keys = ("R_bearing", "length", "E", "nu", "restitution", "friction")
    assert [clearance[key] for key in keys] == [10.0, 10.0, 207.0, 0.3, 0.9, 0.1]
    assert [integration[key] for key in ("alpha", "beta", "max_step")] == [0.5, 0.5, 1e-4]
    disclosed = " ".join(mechanism.assumptions)
    for name in ("R_bearing", "length", "clearance.E", "restitution", "speed", "alpha"):
        assert name not in disclosed


def test_changes_take_the_place_of_the_specs_values_and_of_their_provenance():
    mechanism = mechanism_from(FOUR_BAR, clearance=0.2, law="johnson", friction=0.0)
    assert mechanism.clearance.radial == pytest.approx(2e-4)
    assert mechanism.clearance.law.name == "johnson"
    assert mechanism.data["provenance"]["chosen"] == [
        "clearance.radial", "clearance.friction", "clearance.law",
    ]  # fmt: skip
    assert not any(text.startswith("clearance.radial") for text in mechanism.assumptions)
    assert FOUR_BAR["clearance"]["radial"] == 0.1


def test_what_cannot_be_changed_is_told():
    with pytest.raises(InputError, match="speed = 3: cannot be set; choose law, clearance"):
        mechanism_from(FOUR_BAR, speed=3)


def test_a_modulus_may_come_with_its_unit():
    def material(E):
        return mechanism_from(changed(SLIDER_CRANK, {"clearance.E": E})).clearance.pair.material_i

    assert material("207 GPa") == material("207000 MPa") == material(207.0)
    assert material("2000 GPa").E == pytest.approx(2e6)
    table = {"paper": ["joints.drive.speed", "integration"], "assumed": ["clearance"]}
    assert assumptions({"clearance": {"E": "207 GPa"}, "provenance": table}) == (
        "clearance.E = 207 GPa",
    )


def test_pin_and_hole_may_be_of_materials_by_name(tmp_path):
    own = tmp_path / "own.csv"
    own.write_text("name,E_GPa,nu\nbrass,102.5,0.34\n", encoding="utf-8")
    names = {"clearance.pin": "Brass", "clearance.hole": "bronze"}
    without = {"clearance.E": DROP, "clearance.nu": DROP}
    mechanism = mechanism_from(changed(SLIDER_CRANK, names | without), "mine", own)
    pair = mechanism.clearance.pair
    assert (pair.material_j, pair.material_i) == (
        Material("brass", 102.5e3, 0.34),
        Material.named("bronze"),
    )
    again = mechanism_from(mechanism.data)  # as a saved run has it, without the table
    assert again.clearance.pair == pair
    assert "clearance.pin.E = 102.5" in mechanism.assumptions


def test_lengths_in_metres_are_warned_of():
    metres = {"clearance.R_bearing": 0.01, "clearance.radial": 5e-4}
    (first, *_) = mechanism_from(changed(SLIDER_CRANK, metres)).warnings
    assert first.startswith("the radius of the hole in mm is 0.01")


def test_the_shipped_masses_are_not_warned_of():
    for spec in (SLIDER_CRANK, FOUR_BAR):
        assert mechanism_from(spec).warnings == ()


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
