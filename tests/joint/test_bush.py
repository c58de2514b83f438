"""A pressed bush: from the drawing to the clearance, the seat, and first yield of each body."""

import json

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, limits
from cylcontact.bodies.iso286 import diameters
from cylcontact.joint.bush import Bush, check_bush, fitted
from cylcontact.laws import Conformal, Housing, Sector

BRONZE = Material("bronze", 110e3, 0.34, 220.0, 18e-6)
STEEL = Material("steel", 200e3, 0.3, 250.0, 12e-6)
PEEK = Material("PEEK, hot", 3.3e3, 0.38, 70.0, 50e-6)
ALUMINIUM = Material("aluminium", 70e3, 0.33, 250.0, 23e-6)
HARD = Material("hard", 207e3, 0.3, 2000.0, 12e-6)
LUG = Housing(26.0, Sector.lug())
FRAME = {"housing": Housing(26.0), "rim": STEEL}  # a whole rim takes a quarter of the time
SIZES = Bush(BRONZE, seat=(26.0, 26.03), bore=20.04)
S6 = Bush(BRONZE, seat="26H7/s6", bore="20E6")


def check(bush=S6, pin="20f7", hole=STEEL, housing=LUG, load=500.0, **given):
    return check_bush(bush, HARD, pin, hole, housing, load, **{"plane": "stress"} | given)


@pytest.fixture(scope="module")
def warm():
    return check(temperature=80.0, length=20.0)


def test_a_pin_that_is_warmer_than_its_bush_takes_its_growth_from_the_clearance():
    """12e-6/K of a radius of 9.985 mm."""
    cold = fitted(SIZES, 19.97, STEEL, FRAME["housing"], "held")[1]["joint"]
    warm = check(pin=19.97, bush=SIZES, temperature=(60.0, 20.0), **FRAME).band["joint"]
    taken = 1e3 * cold.clearance - warm.clearance_um
    assert taken == pytest.approx(12e-3 * 9.985 * 40.0, rel=1e-6)


# --- from the drawing ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("hole", "wall", "pin", "bore", "clearance"),
    [  # SKF, metric PTFE composite bushings: limits in mm, and in µm on the diameter
        ("23H7", (1.475, 1.505), "20f7", (19.990, 20.071), (10, 112)),
        ("12H7", (0.980, 1.005), "10f7", (9.990, 10.058), (3, 86)),
        ("28H7", (1.475, 1.505), "25f7", (24.990, 25.071), (10, 112)),
    ],
)
def test_a_wrapped_bush_has_the_clearance_of_the_catalogue(hole, wall, pin, bore, clearance):
    outer = diameters(hole)[1]
    bush = Bush(BRONZE, seat=(hole, (outer + 0.02, outer + 0.05)), wall=wall, wrapped=True)
    close_in, band = fitted(bush, pin, STEEL, Housing(40.0, Sector.lug()))
    assert close_in == 1
    ends = band["least"], band["most"]
    assert [2 * each.bore for each in ends] == pytest.approx(bore, abs=1e-9)
    assert [2e3 * each.clearance for each in ends] == pytest.approx(clearance, abs=1e-6)


@pytest.mark.parametrize(
    ("hole", "R_o", "factor", "known"),
    [  # by another program: the least, the middle and the largest bore over 20 mm in µm
        (STEEL, 19.5, 0.731, (5, 24, 43)),
        (STEEL, 26.0, 0.812, (1, 21, 42)),
        (ALUMINIUM, 26.0, 0.560, (13, 29, 45)),
    ],
)
def test_a_solid_bush_closes_in_by_the_rings_around_it(hole, R_o, factor, known):
    """ISO 4379's rule that E6 becomes H8, 0 to 33 µm, does not hold at the limits."""
    close_in, band = fitted(S6, "20f7", hole, Housing(R_o, Sector.lug()))
    assert close_in == pytest.approx(factor, abs=6e-3)
    bores = [2e3 * (band[name].bore - 10) for name in ("least", "middle", "most")]
    assert bores == pytest.approx(known, abs=0.75)
    assert bores[2] > 33


def test_a_bush_in_a_stiff_frame_closes_in_by_more_than_its_interference():
    bush = Bush(PEEK, seat=(26.0, 26.054), bore=20.0)
    close_in, band = fitted(bush, 19.8, STEEL, Housing(400.0), "held")
    a, b, nu = 10.0, 13.0, 0.38
    in_rigid = 2 * a * b / ((1 - nu) * b**2 + (1 + nu) * a**2)
    assert close_in == pytest.approx(in_rigid, rel=0.02)
    assert close_in > 1.04
    assert list(band) == ["joint"]  # sizes without limits


def test_percentiles_are_those_of_drawn_joints():
    rng = np.random.default_rng(5)
    draws = rng.normal(0.5, 1 / 6, (4, 400_000))
    draws = draws[:, (abs(draws - 0.5) <= 0.5).all(axis=0)]
    sizes = S6.sizes
    hole, outer, bore, pin = (
        low + share * (high - low)
        for (low, high), share in zip((*sizes[:3], diameters("20f7")), draws, strict=True)
    )
    close_in, band = fitted(S6, "20f7", STEEL, LUG)
    clearance = (bore - close_in * (outer - hole) - pin) / 2
    for percent in (5, 95):
        found = 1e3 * band[f"{percent} %"].clearance
        assert found == pytest.approx(1e3 * np.percentile(clearance, percent), abs=0.1)


def test_a_wall_may_have_tighter_and_looser_seats_than_the_band():
    walls = Bush(BRONZE, seat="26H7/r6", wall=(2.98, 3.01))
    hole, outer, _, wall = walls.sizes
    close_in, band = fitted(walls, "20f7", STEEL, LUG)
    corners = [B / 2 - W - close_in * (B - H) / 2 for H in hole for B in outer for W in wall]
    edges = [band[name].bore for name in ("least", "most")]
    assert edges == pytest.approx([min(corners), max(corners)])
    assert list(band)[-2:] == ["tightest seat", "loosest seat"]
    ends = [1e3 * band[name].interference for name in ("tightest seat", "loosest seat")]
    assert ends == pytest.approx([20.5, 3.5])


# --- the answer ---------------------------------------------------------------------------------


def test_the_seat_is_that_of_the_rings_at_rest(warm):
    for name, i in (("least", 24.0), ("middle", 15.5), ("most", 7.0)):
        numbers = warm.band[name]
        assert numbers.interference_um == pytest.approx(i)
        radii = [numbers.bore_mm / 2, 13.00525, 26.0]
        for key, T in (("seat_pressure_MPa", 0.0), ("warm_seat_pressure_MPa", 60.0)):
            pressure = limits.at_rest([BRONZE, STEEL], radii, 1e-3 * i, T).pressures[0]
            assert getattr(numbers, key) == pytest.approx(pressure, rel=1e-9)
    assert warm.loose_at == pytest.approx(20 - 0.007 / (13.0053 * 6e-6), abs=0.1)
    assert f"the seat is loose     below {warm.loose_at:.0f} °C" in str(warm)


def test_each_yield_is_the_lower_of_a_seat_that_slides_and_one_that_sticks(warm):
    numbers = warm.band["middle"]
    R_j = sum(diameters("20f7")) / 4
    cold = CylinderPair.internal(numbers.bore_mm / 2, R_j, pin=HARD, hole=BRONZE, plane="stress")
    seat = sum(S6.sizes.hole) / 4
    radii = [numbers.bore_mm / 2, seat, 26.0]
    rest = limits.at_rest([BRONZE, STEEL], radii, 0.0155, 60.0)
    eyes = {s: Housing(26.0, LUG.clamp, [(STEEL, seat)], seat=s) for s in ("sliding", "bonded")}
    pair = limits.at_temperature(
        cold, 80, 80, housing=eyes["sliding"], rim="free", interference=0.0155
    )
    assert numbers.clearance_um == pytest.approx(1e3 * float(pair.dR))
    found = {s: limits.first_yields(pair, eye, rest) for s, eye in eyes.items()}
    for k, body in enumerate(("bush", "housing", "pin")):
        loads = {s: float(each[k].load) for s, each in found.items()}
        least = min(loads, key=lambda s: loads[s])
        assert getattr(numbers, f"{body}_yield_N_per_mm") == pytest.approx(loads[least])
        assert warm.yields["middle"][body][1] == f"seat {least}"
    assert warm.yields["middle"]["housing"][1] == "seat sliding"
    assert found["sliding"][1].load < 0.75 * found["bonded"][1].load
    for s, eye in eyes.items():
        depth = 1e3 * float(Conformal(eye).penetration(500.0, pair))
        assert getattr(numbers, f"{s}_penetration_um") == pytest.approx(depth)
    assert numbers.projected_pressure_MPa == pytest.approx(500 / (2 * float(pair.R_j)))


def test_the_hoop_stress_of_a_small_load_is_that_at_rest(warm):
    answer = check(Bush(BRONZE, seat=(26.0, 26.031), bore=20.04), 19.97, load=1e-3)
    numbers = answer.band["joint"]
    state = limits.at_rest([BRONZE, STEEL], [numbers.bore_mm / 2, 13.0, 26.0], 0.0155)
    assert numbers.hoop_MPa == pytest.approx(float(state.stress(1, 13.0)[1]), rel=1e-4)
    assert warm.band["middle"].hoop_MPa > numbers.hoop_MPa


def test_the_press_fit_alone_may_make_the_bush_yield(warm):
    assert warm.band["least"].bush_yield_N_per_mm == 0
    assert warm.worst[:2] == ("bush", "least")
    assert any("the bush yields by press fit and heat alone (least)" in w for w in warm.warnings)
    assert warm.factor("housing") == pytest.approx(
        min(warm.band[n].housing_yield_N_per_mm for n in ("least", "middle", "most")) / 500
    )


def test_json_has_the_numbers_of_the_text_and_of_the_table(warm):
    data = json.loads(warm.to_json())
    for name, numbers in warm.band.items():
        for key, value in data["numbers"][name].items():
            own = getattr(numbers, key)
            assert value == own or (value is None and not np.isfinite(own))
            assert warm.table.loc[key, name] == own or np.isnan(own)
    text = str(warm)
    for words in ("bronze bush, bore 20E6, seat 26H7/s6", "hard pin 20f7, plane stress, at 80 °C",
                  "not included  wear", "factor", "p·v"):  # fmt: skip
        assert words in text
    assert data["warnings"] == list(warm.warnings)
    assert "<table" in warm._repr_html_()


def test_a_polymer_may_lose_its_stress_at_rest():
    """The press fit raises the yield of a bush under its pin: the lower one is without it."""
    bush = Bush(PEEK, seat=(26.0, 26.054), bore=20.0)
    given = {"housing": Housing(20.0), "rim": STEEL, "load": 100.0, "plane": "strain"}
    answer = check(bush, 19.8, **given)
    assert answer.yields["joint"]["bush"][1].endswith("stress at rest relaxed")
    assert any(w.startswith("a polymer relaxes") for w in answer.warnings)
    cold = check(bush, 19.8, temperature=-60.0, **given)
    assert np.isnan(cold.band["joint"].bush_yield_N_per_mm)
    assert any("the bush is loose at -60 °C" in w for w in cold.warnings)
    assert "not reached with a seat that is closed" in str(cold)
    tight = check(bush, (19.93, 19.95), temperature=120.0, **given)
    assert any("there is no clearance for the pin" in w for w in tight.warnings)


def test_a_wrapped_bush_presses_its_hole_with_no_more_than_its_plastic_pressure():
    weak = Material("weak", 110e3, 0.34, 50.0, 18e-6)
    wrapped = check(Bush(weak, seat=(26.0, 26.06), bore=20.0, wrapped=True), 19.9, **FRAME)
    bore = wrapped.band["joint"].bore_mm / 2
    most = 2 / np.sqrt(3) * 50 * np.log(13 / bore)
    assert wrapped.band["joint"].seat_pressure_MPa == pytest.approx(most)
    solid = limits.at_rest([weak, STEEL], [bore, 13.0, 26.0], 0.03)
    assert solid.pressures[0] > 3 * most
    assert "bush" not in wrapped.yields["joint"]
    assert "it yields when it is pressed in" in str(wrapped)
    assert any(w.startswith("a wrapped bush yields") for w in wrapped.warnings)


def test_a_load_that_opens_the_seat_is_warned_of():
    loose = Bush(BRONZE, seat=(26.0, 26.004), bore=20.0)
    answer = check(loose, 19.96, load=1500.0, **FRAME)
    opens = answer.band["joint"].seat_opens_N_per_mm
    assert opens < 1500
    assert any("from which the loosest seat opens" in w for w in answer.warnings)


def test_a_transition_seat_may_be_loose():
    """From 7.5 µm of interference to a gap of 3 µm."""
    answer = check(Bush(BRONZE, seat=((26.0, 26.021), 26.015), bore=20.04), 19.97, **FRAME)
    assert answer.bush.interference == pytest.approx((-0.003, 0.0075))
    assert answer.loose_at == np.inf
    assert any("some bushes have no interference (-3 µm" in w for w in answer.warnings)
    assert any("the bush is loose at 20 °C (95 %, most)" in w for w in answer.warnings)
    assert np.isnan(answer.band["most"].housing_yield_N_per_mm)
    assert answer.band["most"].bore_mm == pytest.approx(20.04)  # a gap does not close the bore in


def test_at_20_degrees_no_expansion_has_to_be_known():
    """Nor numbers of a polymer at another temperature."""
    given = {"bush": Bush(Material.named("POM"), seat=(24.0, 24.1), bore=20.2), "pin": 19.8}
    answer = check(**given, **FRAME, hole=Material("", 200e3, 0.3))
    assert answer.loose_at == np.inf
    assert answer.band["joint"].clearance_um > 0
    with pytest.raises(InputError, match="temperature: POM is a polymer"):
        check(**given, temperature=80.0)


REFUSED = [
    (lambda: Bush(BRONZE, seat="26H7/s6"), "bore: is missing"),
    (lambda: Bush(BRONZE, seat="26H7/s6", bore=20.0, wall=3.0), "is given, and the wall too"),
    (lambda: Bush(BRONZE, seat="26H7/g6", bore=20.0), "has no interference in its middle"),
    (lambda: Bush(BRONZE, seat="26H7", bore=20.0), "seat = '26H7': is not an ISO fit"),
    (lambda: Bush(BRONZE, seat="26H7/t6", bore=20.0), "a pin t that is not in the table"),
    (lambda: Bush(BRONZE, seat="26H7/s6", bore=26.5), "leaves no wall"),
    (lambda: Bush(BRONZE, seat="26H7/s6", wall=13.5), "leaves no wall"),
    (lambda: Bush(BRONZE, seat="26H7/s6", bore=(20.1, 20.0)), "must be a size, or a lower"),
    (lambda: check(pin="20.2"), "is not a class"),
    (lambda: check(pin=20.2), "leaves no clearance at any joint"),
    (lambda: check(housing=Housing(26.0)), "rim: is missing for a rim that is clamped all round"),
    (lambda: check(housing=Housing(26.0, layers=[(STEEL, 20.0)]), rim="free"), "has layers"),
    (lambda: check(housing=Housing(13.0, Sector.lug())), "must have its rim outside the seat"),
    (lambda: check(load=-1.0), "load = -1.0"),
]  # fmt: skip


@pytest.mark.parametrize(("ask", "rule"), REFUSED, ids=[rule for _, rule in REFUSED])
def test_what_a_bush_refuses(ask, rule):
    with pytest.raises(InputError, match=rule):
        ask()
