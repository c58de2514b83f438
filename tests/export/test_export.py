"""Every law in every language against NumPy, and what is refused."""

import math
from dataclasses import dataclass, field
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from cylcontact.export.exported_law import exported, require_contact_law
from cylcontact.export.in_housing import InHousing, law_in_housing

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.bodies.material import material_in_MPa
from cylcontact.export import EXPORTABLE, export, export_named
from cylcontact.fitting import FitResult
from cylcontact.fitting.law_models import MODELS
from cylcontact.laws.adapters import ScaledLaw
from cylcontact.laws.lambert import branch_distance
from cylcontact.laws.logarithmic import adjusted_logarithmic
from cylcontact.laws.user import user_law
from tests.support.export_runners import RUNNERS, module_of, require_jax, run_octave

RESULTS = Path(__file__).parents[2] / "fitting" / "results"
INTERNAL, EXTERNAL = RESULTS / "internal.json", RESULTS / "external.json"
EPS = 2.0**-52


@cache
def coefficients(path):
    return FitResult.read(path).coefficients


def in_a_housing(clamp):
    """The law of a steel pin in a housing of twice the radius: five constants, or a table."""
    pair = CylinderPair.internal(10.0, 9.95, material_in_MPa("steel", E=207e3, nu=0.3))
    return law_in_housing(laws.Conformal(laws.Housing(20.0, clamp)), pair)[0]


FOLDER = Path(__file__).parents[1] / "support"
OWN, LOOPED = (user_law(f"own_laws:{name}", FOLDER) for name in ("awkward", "looped"))
LAWS = {
    **{
        f"{name}-{contact}": (laws.LAWS[name](), contact)
        for name in EXPORTABLE
        for contact in laws.LAWS[name]().contacts
    },
    "refit-internal": (laws.Enhanced(coefficients(INTERNAL)), "internal"),
    "refit-external": (laws.Enhanced(coefficients(EXTERNAL)), "external"),
    "undefined": (laws.Enhanced(coefficients(INTERNAL) | {"a": -1.0, "b": 0.5}), "internal"),
    "power": (laws.PowerLaw(n=1.237, K_star=0.3), "external"),
    "power-of-one-pair": (laws.PowerLaw(n=1.237, K=312148.0), "internal"),
    "power-dimensionless": (laws.PowerLaw(n=1.14, C=0.913), "internal"),
    "power-clearance": (laws.PowerClearance(0.88, 0.72, 1.13, -0.02, 0.01, 0.001), "internal"),
    "linear": (laws.PowerLaw(n=1.0, K_star=0.3), "internal"),
    "softening": (laws.PowerLaw(n=0.9, K_star=0.3), "internal"),
    "scaled-johnson": (adjusted_logarithmic(laws.Johnson(), 1.3, -0.7, 2.0), "internal"),
    "scaled-explicit": (ScaledLaw(laws.Explicit(), 1.3, 0.8), "internal"),
    "scaled-twice": (ScaledLaw(ScaledLaw(laws.Liu(), 0.7, 2.0), 1.5), "internal"),
    "looped": (LOOPED, "internal"),
    "own": (OWN, "internal"),
    "own-scaled": (ScaledLaw(OWN, 0.7, 1.5), "external"),
    "in-a-ring": (in_a_housing("rim"), "internal"),
    "in-an-eye": (in_a_housing(laws.Sector(60, "far")), "internal"),
}

# Parts of the largest penetration, or of ΔR: tiny, dense, up to the limit, at it and beyond.
PARTS = np.concatenate(
    [
        [-np.inf, -1.0, -1e-300, np.nan, 0.0],
        10.0 ** -np.linspace(0, 290, 37)[1:],
        np.linspace(0.01, 0.99, 33),
        1 - 10.0 ** -np.linspace(2, 15.5, 28),
        1 - np.arange(5) * EPS / 2,
        [1 + EPS, 1 + 1e-9, 1.1, 10.0, 1e3, 1e10],
    ]
)
MATERIALS = [material_in_MPa("any", E=E, nu=nu) for E, nu in ((207e3, 0.3), (2.0, 0.5))]
GAPS = {
    "internal": (
        *(0.001, np.nextafter(0.005, 0), 0.005, 0.05, 0.34954, 1.0),
        *(np.nextafter(10, 0), 10.0, 50.0),
    ),
    "external": (0.02, 1.0, 15.0, 140.0, 1000.0),
}
# The error allowed, in units of rounding; Octave and JAX have their own log and pow.
ROUNDINGS = 12


@dataclass
class Case:
    """One law's arguments and what NumPy answers, with the condition of each number."""

    law: laws.ContactLaw
    contact: str
    name: str = field(init=False)

    def __post_init__(self):
        of_law = exported(self.law, self.contact)
        self.name = of_law.name
        pins = MATERIALS if "alpha" in of_law.arguments else (None,)
        pairs = product(MATERIALS, pins, GAPS[self.contact])
        blocks = [self.sweep(hole, pin or hole, dR) for hole, pin, dR in pairs]
        blocks += [self.spoiled(name) for name in of_law.arguments[1:]]
        columns = {key: np.concatenate([block[key] for block in blocks]) for key in blocks[0]}
        self.answers = columns["f"], columns["k"]
        self.conditions = columns["of_f"], columns["of_k"]
        self.arguments = {name: columns[name] for name in of_law.arguments}
        self.rows = columns["f"].size

    def each_row(self):
        return zip(*(column.tolist() for column in self.arguments.values()), strict=True)

    def sweep(self, hole, pin, dR):
        """Penetrations over the whole domain of one pair."""
        R_i, R_j = (9.5 + dR, 9.5) if self.contact == "internal" else (dR / 2, dR / 2)
        known = {"R_i": R_i, "R_j": R_j, "length": 12.0}
        pair = CylinderPair(self.contact, dR, hole, pin, **known)
        largest = float(self.law.max_penetration(pair))
        x = PARTS * (largest if np.isfinite(largest) else dR)
        with np.errstate(all="ignore"):
            f, k = self.law.load(x, pair), self.law.stiffness(x, pair)
            of_f, of_k = self.condition(x, largest)
            block = {
                "penetration": x, "E_star": pair.E_star, "dR": dR, "alpha": pair.alpha,
                "beta": pair.beta, **known, "f": f, "k": k, "of_f": of_f, "of_k": of_k,
            }  # fmt: skip
        return {key: value + np.zeros_like(PARTS) for key, value in block.items()}

    def condition(self, x, largest):
        """How far a rounding of the steps moves load and stiffness.

        Near the end of a logarithmic law dw/w = -(1 + w)/w² · dp/p, and f = p/(1 + w), k = 1/w.
        """
        if isinstance(self.law, InHousing):  # exp(ln f)
            return 2e3, 2e3
        if not math.isfinite(largest):
            return 1.0, 1.0
        w = np.nan_to_num(branch_distance(x / largest))
        return 1 + 1 / np.maximum(w, EPS), 1 + (1 + w) / np.maximum(w, EPS) ** 2

    def spoiled(self, name):
        """Arguments that no pair has: NaN is the answer."""
        values = np.array([-1.0, 1.0 if name in ("alpha", "beta") else 0.0, -np.inf, np.nan])
        fine = {"penetration": 1e-3, "E_star": 1e5, "dR": 0.5, "R_i": 10.0, "R_j": 9.5}
        fine |= {"length": 12.0, "alpha": 0.0, "beta": 0.0}
        block = fine | {name: values, "f": np.nan, "k": np.nan, "of_f": 1.0, "of_k": 1.0}
        return {key: value + np.zeros_like(values) for key, value in block.items()}

    def compare(self, load, stiffness, apart=None):
        """Compare answers, but in the rows `apart`."""
        for actual, wanted, condition in zip(
            (load, stiffness), self.answers, self.conditions, strict=True
        ):
            rows = np.ones(self.rows, bool) if apart is None else ~apart
            np.testing.assert_array_equal(np.isnan(actual)[rows], np.isnan(wanted)[rows])
            np.testing.assert_array_equal(np.isinf(actual)[rows], np.isinf(wanted)[rows])
            rows &= np.isfinite(wanted) & (np.abs(wanted) > 1e-290) | (wanted == 0)
            error = np.abs(actual[rows] - wanted[rows])
            allowed = ROUNDINGS * EPS * condition[rows] * np.abs(wanted[rows])
            assert np.all(error <= allowed), np.max(error / allowed)


STEELS = (Material("steel", E=207e3, nu=0.3), Material("another", E=200e3, nu=0.28))


@cache
def case_of(name):
    return Case(*LAWS[name])


# What JAX compiles: not every logarithmic law, which are one function.
IN_JAX = tuple(
    name for name, (law, contact) in LAWS.items()
    if not isinstance(law, laws.LogarithmicLaw) or law.needs or name == "johnson-internal"
)  # fmt: skip


@pytest.mark.parametrize(
    ("language", "name"),
    [(language, n) for language in RUNNERS for n in (IN_JAX if language == "jax" else LAWS)],
)
def test_a_law_in_another_language_is_the_law(language, name, tmp_path):
    case = case_of(name)
    apart = None
    if language == "jax":  # 0 at first touch; XLA divides by a constant in its own way, and
        x = case.arguments["penetration"]  # leaves out what would overflow
        least = 1e-15 if name == "power-clearance" else 1e-100  # its exponent is rounded as well
        apart = (x >= 0) & (x < least) | (case.conditions[0] > 1e7)
    case.compare(*RUNNERS[language](case, tmp_path), apart)


SHAPES = """
addpath('{folder}');
[f, k] = cylcontact_johnson_internal(1e-3 * [1 2 3], [1e5; 2e5], 0.05);
assert(size(f), [2 3]); assert(size(k), [2 3]); assert(f(2, :), 2 * f(1, :), 1e-9);
assert(cylcontact_johnson_internal([-1 -Inf], 1e5, 0.05), [0 0]);
assert(isnan(cylcontact_johnson_internal(NaN, 1e5, 1)));
assert(size(cylcontact_johnson_internal(zeros(0, 1), 1e5, 0.05)), [0 1]);
assert(isreal(cylcontact_johnson_internal([-1 1e-3 1], 1e5, 0.05)));
"""


@pytest.fixture(scope="module")
def octave(tmp_path_factory):
    folder = tmp_path_factory.mktemp("octave")
    cases = {name: case_of(name) for name in LAWS}
    return run_octave(cases, folder, SHAPES.format(folder=folder / "johnson-internal"))


@pytest.mark.parametrize("name", LAWS)
def test_a_law_in_matlab_is_the_law(name, octave):
    case_of(name).compare(*octave[name])


@pytest.mark.parametrize(
    "name", ["johnson-internal", "scaled-explicit", "looped", "own", "power", "explicit-external"]
)
def test_jax_differentiates_the_inverse_and_by_the_pair(name):
    """Against the stiffness, and differences over a tenth of the digits for the pair."""
    jax = require_jax()
    case, module = case_of(name), module_of(case_of(name), "jax")
    x = case.arguments["penetration"]
    inside = np.isfinite(case.answers[0]) & (x > 1e-30) & (case.conditions[1] < 50)
    chosen = np.flatnonzero(inside)[::37]
    arguments = [column[chosen] for column in case.arguments.values()]
    f, k = (answer[chosen] for answer in case.answers)

    found = jax.jit(module["penetration"])(f, *arguments[1:])
    np.testing.assert_allclose(found, x[chosen], rtol=1e-12)
    inverse = jax.vmap(jax.grad(module["penetration"]))(f, *arguments[1:])
    np.testing.assert_allclose(inverse * k, 1.0, rtol=1e-10)
    forward = jax.vmap(jax.grad(module["load"]))(*arguments)
    np.testing.assert_allclose(forward / k, 1.0, rtol=1e-10)
    # By E* and ΔR: the inverse function has minus the load's derivative over the stiffness.
    for position in (1, 2):
        load = jax.vmap(jax.grad(module["load"], position))(*arguments)
        of_inverse = jax.vmap(jax.grad(module["penetration"], position))(f, *arguments[1:])
        assert np.all(np.abs(of_inverse * k + load) <= 1e-9 * np.abs(f / arguments[position]))
        step = 1e-6 * arguments[position]
        sides = []
        for sign in (1, -1):
            moved = list(arguments)
            moved[position] = moved[position] + sign * step
            sides.append(np.asarray(module["load"](*moved)))
        slope = (sides[0] - sides[1]) / (2 * step)
        assert np.all(np.abs(load - slope) <= 1e-7 * np.abs(f / arguments[position]))


def test_jax_outside_the_domain_and_at_the_second_derivative():
    jax = require_jax()
    module = module_of(case_of("johnson-internal"), "jax")
    load, penetration = module["load"], module["penetration"]
    end = 4 * 0.05 / math.e**2
    f = load(np.array([-1.0, 0.0, 1e-3, end * 1.01]), 1e5, 0.05)
    assert list(np.isnan(f)) == [False, False, False, True]
    assert list(f[:2]) == [0.0, 0.0]
    slopes = jax.vmap(jax.grad(load, (0, 1, 2)), (0, None, None))(np.array([-1.0, 0.0]), 1e5, 0.05)
    assert all((np.asarray(slope) == 0).all() for slope in slopes)
    largest = 4 * math.pi * 1e5 * 0.05 / math.e**2
    depth = penetration(np.array([-1.0, 0.0, 0.999 * largest, 1.001 * largest]), 1e5, 0.05)
    np.testing.assert_allclose(depth, [np.nan, 0.0, end, np.nan], rtol=1e-6)
    step = 1e-6
    slope = jax.grad(load)
    bend = float(slope(1e-3 + step, 1e5, 0.05) - slope(1e-3 - step, 1e5, 0.05)) / (2 * step)
    assert float(jax.grad(slope)(1e-3, 1e5, 0.05)) == pytest.approx(bend, rel=1e-6)


@pytest.mark.parametrize("path", sorted(RESULTS.glob("*.json")), ids=lambda path: path.stem)
def test_every_committed_result_can_be_exported(path):
    result = FitResult.read(path)
    text = export_named(str(path), None, "c")
    name = f"cylcontact_{result.law.replace('-', '_')}_{result.contact}"
    assert f"void {name}(" in text
    comment = " ".join(text.replace("//", "").split())
    assert f"fit result '{result.name}'" in comment
    assert all(repr(x) in text for x in result.coefficients.values()) or "load_factor" in text


ERRORS = {
    "unknown law": (lambda: export_named("hertz", None, "c"), "neither a law that can be exported"),
    "unknown target": (lambda: export_named("johnson", None, "rust"), "is not a known target"),
    "unknown contact": (lambda: export_named("johnson", "conformal", "c"), "is not a contact"),
    "contact missing": (
        lambda: export_named("explicit", None, "c"),
        "--contact: is missing, and the explicit law has other coefficients for each",
    ),
    "contact contradicts result": (
        lambda: export_named(str(INTERNAL), "external", "c"), "contradicts --contact external",
    ),
    "law not for the contact": (
        lambda: export_named("liu", "external", "c"), "the law 'liu' is for a pin in a hole",
    ),
    "no formula": (lambda: export_named("persson", None, "c"), "has no closed form to write"),
    "on a plane": (
        lambda: export(laws.Johnson(datum=5.0), None, "c"), "is for a plane, which has no dR",
    ),
    "not translatable": (
        lambda: export(user_law("own_laws:untranslatable", FOLDER), None, "c"),
        "line 29 = 'abs(penetration)': is not known in other languages",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("act", "message"), ERRORS.values(), ids=ERRORS)
def test_what_is_refused_is_refused_in_a_line(act, message):
    with pytest.raises(InputError) as caught:
        act()
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("law", "contact", "own", "rule"),
    [
        ("enhanced", "external", {"n": -1.0}, "has no load at any penetration"),
        ("enhanced", "external", {"a": -1.0, "b": 0.0}, "has no load at any penetration"),
        ("lankarani-nikravesh", "internal", {"factor": -1.0}, "must be positive and finite"),
    ],
)
def test_coefficients_that_define_no_law_are_not_exported(law, contact, own, rule):
    model = MODELS[law, contact]
    usual = {p.name: p.nominal for p in model.parameters}
    assert export(model.build(usual), contact, "c")
    with pytest.raises(InputError, match=rule):
        export(model.build({**usual, **own}), contact, "c")


def test_a_load_that_falls_is_refused_with_its_penetration():
    class Odd(laws.Johnson):
        def load(self, penetration, pair):
            load = super().load(penetration, pair)
            return np.where(penetration > 0.01, load / 1e3, load)

    with pytest.raises(InputError, match=r"its load decreases at 0\.0"):
        require_contact_law(Odd(), "internal")
