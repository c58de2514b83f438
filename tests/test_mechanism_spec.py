"""Specs of mechanisms: every mistake told in one line."""

import pytest

from cylcontact import InputError
from cylcontact.mechanism import mechanism_from, read_mechanism
from tests.mechanism_cases import FOUR_BAR, ROOT, SLIDER_CRANK
from tests.spec_files import DROP, changed

MISTAKES = [
    ({"clearance.radial": 10.0}, "clearance.radial = 10.0: leaves no journal"),
    ({"bodies.ground": SLIDER_CRANK["bodies"]["rod"]}, "bodies.ground: is no body's name"),
    ({"clearance.law": "jonson"}, "clearance.law = 'jonson': is not a law; choose johnson"),
    ({"clearance.factor": "none"}, "clearance.factor = 'none': is not known; choose hunt-crossley"),
    ({"clearance.yield_stress": -1}, "clearance.yield_stress = -1: must be greater than 0; give "
     "the yield stress of both bodies in MPa"),
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
