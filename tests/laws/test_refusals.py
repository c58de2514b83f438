"""What laws, pairs, housings, fits and sizing refuse: one line each, with the key and the rule."""

# ruff: noqa: ARG001

from functools import partial

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, impact, laws, limits
from cylcontact.bodies.iso286 import IsoFit
from cylcontact.files.spec import read_toml
from cylcontact.joint import joint_from
from cylcontact.laws import Conformal, Housing, Sector
from cylcontact.laws.formula import Formula
from cylcontact.laws.tabulated import tabulate
from cylcontact.limits.sizing import find
from tests.support.spec_files import DROP, changed

STEEL, BRONZE = Material("steel", 207e3, 0.3, 500.0, 12e-6), Material("bronze", 110e3, 0.34)
LAYER = Material("layer", 70e3, 0.33)
PAIR = CylinderPair.internal(10.0, 9.99, pin=STEEL, hole=STEEL, length=10.0)
EYE = CylinderPair.internal(10.0, 9.9, pin=STEEL, hole=STEEL)
ROLLERS = CylinderPair.external(10.0, 25.0, STEEL, length=12.0)
ON_PLANE = CylinderPair.external(10.0, np.inf, STEEL, material_j=BRONZE)
MANY = CylinderPair("internal", 0.05, STEEL, Material("pins", np.array([7e4, 2e5]), 0.3))
PEEK = CylinderPair.internal(10.0, 9.9, pin=Material.named("PEEK"), hole=STEEL)
RUBBER = CylinderPair.internal(10.0, 9.9, Material("rubber", "5 MPa", 0.49))
JOINT = changed(
    read_toml("datasets/joint.toml"), {"bearing.R": DROP, "pin.R": DROP, "iso": "20H7/g6"}
)
BENT = {"A": 0.88, "p": 0.72, "n0": 1.13, "n1": -0.02, "q": 0.012, "n2": 0.001}


class Hole(laws.Johnson):
    """A law that is not defined throughout."""

    name = "law with a hole"

    def load(self, penetration, pair):
        is_out = np.abs(penetration / pair.dR - 0.1) < 0.05
        return np.where(is_out, np.nan, super().load(penetration, pair))


def of_a_pair(penetration, pair, K=1.0):
    return K * penetration


def with_a_default(penetration, E_star, alpha=1.0):
    return E_star * penetration


def with_a_text(penetration, E_star, K="1"):
    return E_star * penetration


def of_anything(penetration, *constants):
    return penetration


def form(function):
    return lambda: Formula(function).asked


def housing(*args, **kwargs):
    return lambda: Conformal(Housing(*args, **kwargs)).load(1e-3, PAIR)


def compliances(values):
    return lambda: Housing.from_compliances(values)


def pair(*args, **kwargs):
    return lambda: CylinderPair(*args, material_i=STEEL, material_j=STEEL, **kwargs)


def internal(*args, **kwargs):
    return lambda: CylinderPair.internal(*args, STEEL, **kwargs)


def at(one, *temperatures):
    return lambda: limits.at_temperature(one, *temperatures)


def clearance(**given):
    return lambda: find("clearance", PAIR, 100.0, **given)


def joint(**changes):
    return lambda: joint_from(changed(JOINT, changes))


friction = partial(impact.friction_load, 1.0, 1.0)
POSITIVE = "must be positive and finite"
REFUSED = [
    # Laws, and their numbers.
    (lambda: Conformal("body"), "Conformal: datum = 'body': must be 'johnson', a finite"),
    (lambda: Conformal(np.inf), "Conformal: datum = inf: must be 'johnson', a finite"),
    (lambda: Conformal(np.array([1.0, 2.0])), "datum = array([1., 2.]): must be 'johnson', a fin"),
    (lambda: Conformal(-2.0).load(1e-3, PAIR), "decrease at large loads; this pair needs C > -"),
    (lambda: Conformal().curve(MANY), "has bodies of several α, β or housings; take one"),
    (lambda: laws.Explicit({"c": 0.0, "A": 0.4, "B": 4.0}), POSITIVE),
    (lambda: laws.Explicit({"c": 1.4, "A": np.inf, "B": 4.0}), POSITIVE),
    (lambda: laws.Explicit({"c": 0.01, "A": 1.0, "B": 0.5}), "a logarithm fails at some penetra"),
    *((partial(laws.PowerClearance, **{**BENT, name: value}), f"PowerClearance: {name} = {value}")
      for name, value in (("A", 0.0), ("A", np.nan), ("n1", np.inf))),
    (lambda: tabulate(Hole(), PAIR), "tabulate: law = 'law with a hole': its load or its stiff"),
    (form(of_a_pair), "write it as def load(penetration, E_star, dR, K=1.0"),
    (form(with_a_default), "has a default for alpha, which comes from the pair"),
    (form(with_a_text), "has a default for K that is not a number"),
    (form(of_anything), "must take a penetration and named numbers"),
    (form(min), "has no signature to read"),
    *((partial(laws.Johnson, datum=datum), POSITIVE) for datum in (0.0, -1.0, np.inf, "deep")),
    *((partial(getattr(law, ask), 1e-3, of), words)
      for ask in ("load", "penetration", "stiffness")
      for law, of, words in [
          (laws.Johnson(), ON_PLANE, "is missing: the pair is a cylinder on a plane"),
          (laws.Johnson(datum=5.0), ROLLERS, "datum = 5.0: is for a cylinder on a plane"),
          (laws.Explicit(), ON_PLANE, "is a plane"),
          (laws.Enhanced(), ON_PLANE, "is a plane"),
      ]),
    # Housings.
    (housing("20"), "Housing: R_o = '20': must be a number"),
    (housing(20.0, "half"), "Housing: clamp = 'half': must be 'rim' or a Sector"),
    (housing(20.0, layers=[(STEEL, 30.0)]), "Housing: layers"),
    (housing(20.0, layers=[15.0]), "Housing: layers"),
    (lambda: Sector(351), "Sector: angle = 351: must be from 10 to 350 degrees"),
    (lambda: Sector(60, "left"), "Sector: side = 'left': must be 'pushed' or 'pulled'"),
    (housing(10.0), "R_o = 10.0: must be larger than"),
    (housing(10.2), "makes a ring thinner than 5 %"),
    (housing(11.0, Sector(300, "pulled")), "does not touch it along one arc"),
    (compliances(np.ones((3, 4))), "Housing: g: has the shape (3, 4)"),
    (compliances([0.1, np.nan, 0]), "Housing: g: must be finite"),
    (compliances(np.triu(np.ones((3, 3)))), "g: must be symmetric"),
    (compliances([-0.1, 0.3, -0.2, -0.05]), "has fewer harmonics than"),
    (compliances("no/such/file"), "no/such/file: g: cannot be read"),
    (lambda: limits.first_yield(
        EYE, housing=Housing.from_compliances([-0.1, 0.4, -0.05, -0.001, 0.0])
    ), "compliances, which have no stresses"),
    (lambda: limits.first_yield(EYE, housing=Housing(20.0, layers=[(LAYER, 12.0)])),
     "not known for all materials"),
    # Pairs and materials.
    (pair("external", 5.0, R_i=10.0, R_j=np.inf), "CylinderPair: dR"),
    (pair("external", np.inf, R_i=10.0), "CylinderPair: dR"),
    (pair("external", np.inf, R_i=np.inf, R_j=np.inf), "CylinderPair: R_i"),
    (pair("external", [15.0, np.inf], R_i=10.0, R_j=[5.0, np.inf]), "CylinderPair: dR"),
    (pair("internal", np.inf, R_i=10.0), POSITIVE),
    (internal(10.0, 9.0, plane="bent"), "plane = 'bent'"),
    (lambda: CylinderPair("internal", 0.1, STEEL, "bronze"), "material_j"),
    (lambda: CylinderPair.internal(10.0, 9.9, pin="bronze", hole=STEEL), "al: pin = 'bronze'"),
    (internal([10.0, 11.0, 12.0], [9.0, 9.5]), "do not go together"),
    (lambda: CylinderPair.from_dR("internal", [0.1, 0.2], STEEL, R_i=[1.0, 2.0, 3.0]),
     "do not go together"),
    (internal(10.0, None), "R_j"),
    (internal([[10.0], [10.0, 11.0]], 9.0), "R_i"),
    (internal(10.0, 9.0, length="long"), "length = 'long'"),
    (lambda: CylinderPair.from_dundurs(1.0, 0.0), "alpha = 1.0"),
    (lambda: CylinderPair.from_dundurs(0.0, 0.3), "beta = 0.3"),
    (lambda: Material("m", [207e3, 70e3], [0.3, 0.3, 0.3]), "do not go together"),
    (lambda: Material("m", 207e3, 0.3, "250"), "yield_stress = '250'"),
    (lambda: Material("m", 207e3, 0.3, thermal_expansion=12.0), "= 12.0: is beyond any material"),
    # Fits of ISO 286.
    *((partial(IsoFit.read, code), rule) for code, rule in [
        ("20H7", "is not an ISO fit"), ("2H7/g6", "3 to 500 mm"), ("501H7/g6", "3 to 500 mm"),
        ("20M7/h6", "a hole M"), ("20h7/g6", "a hole h"), ("20H7/t6", "a pin t"),
        ("20H4/g6", "a grade 4"), ("20H12/g6", "a grade 12"),
        ("20H7/j8", "j8, and ISO 286 has j5 to j7"),
    ]),
    (joint(clearance=0.01), "is given by the fit 20H7/g6"),
    (joint(**{"pin.R": 9.9}), "by the fit"),
    (joint(iso="20H7/k6"), "iso = '20H7/k6': is a transition fit"),
    (joint(iso="20"), "is not an ISO fit"),
    # Temperatures and sizes.
    (at(RUBBER, 50, 50), "needs the thermal_expansion of rubber, which is not known"),
    (at(CylinderPair.from_dR("internal", 0.1, STEEL), 50, 50), "needs both radii"),
    (at(ROLLERS, 50, 50), "no pin and no hole"),
    (at(PAIR, np.nan, 20), "temperature = nan: must be a temperature above"),
    (at(PEEK, 80, 80), "is a polymer, whose modulus and yield stress"),
    (clearance(stiffness=1e9), "is met by no clearance from 1e-05 to 5 mm, which give"),
    (clearance(penetration=10.0), "is met by no clearance"),
    (clearance(), "is missing"),
    (clearance(stiffness=1e5, penetration=1e-3), "is given beside stiffness"),
    (clearance(stiffness=-1.0), "must be positive"),
    # Impact and friction.
    *((partial(act, value), f"{key} = ") for act, key, values in [
        *((factor, "restitution", [0.0, 1.0000001, np.nan]) for factor in impact.FACTORS.values()),
        (impact.achieved_restitution, "chi", [-1e-9, np.nan, np.inf, [0.5, -0.5]]),
        (partial(impact.dissipative_load, 1.0, 1.0, 1.0), "chi", [-1.0, np.nan]),
        (lambda v: impact.dissipative_load(1.0, 1.0, 1.0, 0.5, floor=v), "floor",
         [0.0, np.nan, np.inf]),
        (impact.hysteresis_factor, "name", ["anagnostopoulos"]),
        (lambda v: friction(0.1, *v), "v0, v1", [(-1.0, 5.0), (5.0, 5.0)]),
        (lambda c: friction(c, 1.0, 5.0), "coefficient", [-0.1, np.inf, [0.1, -0.1]]),
    ] for value in values),
]  # fmt: skip


@pytest.mark.parametrize(("ask", "message"), REFUSED, ids=[words for _, words in REFUSED])
def test_bad_input_is_refused_in_one_line(ask, message):
    with pytest.raises(InputError) as caught:
        ask()
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("contact", ["internal", "external"])
@pytest.mark.parametrize("changes", [{"dR": 0.6}, {"R_i": 11.0}, {"R_j": 9.4}, {"dR": [0.5, 0.6]}])
def test_radii_and_clearance_agree(contact, changes):
    radii = {"R_i": 10.0, "R_j": 9.5, "dR": 0.5 if contact == "internal" else 19.5}
    CylinderPair(contact, material_i=STEEL, material_j=STEEL, **radii | {"dR": radii["dR"] + 1e-9})
    with pytest.raises(InputError, match=r"CylinderPair: dR = .* contradicts R_i = .* and R_j"):
        CylinderPair(contact, material_i=STEEL, material_j=STEEL, **radii | changes)
