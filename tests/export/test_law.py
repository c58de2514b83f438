"""Every law in every language against NumPy, and what is refused."""

import math
from dataclasses import dataclass, field
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.bodies.material import material_in_MPa
from cylcontact.export import EXPORTABLE, export, export_named, source_and_header
from cylcontact.export.conformal import table_of
from cylcontact.export.law import exported, require_contact_law
from cylcontact.fitting import read_result
from cylcontact.fitting.adapters import ScaledLaw
from cylcontact.fitting.law_models import MODELS
from cylcontact.laws import Conformal, Housing, Sector
from cylcontact.laws.lambert import branch_distance
from cylcontact.laws.user import user_law
from tests.support.export_runners import RUNNERS

RESULTS = Path(__file__).parents[2] / "fitting" / "results"
INTERNAL, EXTERNAL = RESULTS / "internal.json", RESULTS / "external.json"
EPS = 2.0**-52
STEEL, ALUMINIUM = Material("steel", 207e3, 0.3), Material("aluminium", 70e3, 0.33)


@cache
def coefficients(path):
    return read_result(path).coefficients


def pair_of(pin, hole):
    return CylinderPair.internal(R_i=10.0, R_j=9.95, pin=pin, hole=hole, length=12.0)


LIKE, UNLIKE = pair_of(STEEL, STEEL), pair_of(STEEL, ALUMINIUM)
FOLDER = Path(__file__).parents[1] / "support"
POWER, LOOPED = (user_law(f"own_laws:{name}", FOLDER) for name in ("power", "looped"))
LAWS = {
    **{
        f"{name}-{contact}": (laws.LAWS[name](), contact)
        for name in EXPORTABLE if name not in ("conformal", "persson")
        for contact in laws.contacts_of(name)
    },
    "refit-internal": (laws.Enhanced(coefficients(INTERNAL)), "internal"),
    "refit-external": (laws.Enhanced(coefficients(EXTERNAL)), "external"),
    "undefined": (laws.Enhanced(coefficients(INTERNAL) | {"a": -1.0, "b": 0.5}), "internal"),
    "power": (laws.PowerLaw(n=1.237, K_star=0.3), "external"),
    "power-of-one-pair": (laws.PowerLaw(n=1.237, K=312148.0), "internal"),
    "power-dimensionless": (laws.PowerLaw(n=1.14, C=0.913), "internal"),
    "power-clearance": (laws.PowerClearance(0.88, 0.72, 1.13, -0.02, 0.01, 0.001), "internal"),
    "softening": (laws.PowerLaw(n=0.9, K_star=0.3), "internal"),
    "fitted-johnson": (laws.Johnson(kappa=1.3, c=-0.7), "internal"),
    "scaled-twice": (ScaledLaw(ScaledLaw(laws.Liu(), 0.7, 2.0), 1.5), "internal"),
    "own": (POWER, "internal"),
    "looped": (LOOPED, "internal"),
    "own-scaled": (ScaledLaw(LOOPED, 0.7, 1.5), "external"),
}  # fmt: skip
# Conformal contact of one pair, with the error that its file may have in load and stiffness.
TABLES = {
    "persson": (laws.Persson(), None, 1e-6),
    "unlike": (Conformal(), UNLIKE, 1e-6),
    "a number as datum": (Conformal(3.0), UNLIKE, 1e-6),
    "ring": (Conformal(Housing(20.0)), UNLIKE, 1e-6),
    "thick": (Conformal(Housing(50.0)), LIKE, 1e-6),
    "near": (Conformal(Housing(20.0, Sector(60))), LIKE, 1e-6),
    "eye": (Conformal(Housing(20.0, Sector(60, "pulled"))), UNLIKE, 2e-5),
    "thin-eye": (Conformal(Housing(13.0, Sector(300, "pulled"))), UNLIKE, 2e-5),
    "lug": (Conformal(Housing(16.0, Sector.lug(1.0), layers=[(ALUMINIUM, 12.0)])), LIKE, 2e-5),
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
# Where there is no load, or no law.
NO_PENETRATIONS = [-np.inf, -1.0, -1e-300, 0.0, np.nan, np.inf]
NO_PAIRS = [-1.0, 0.0, -np.inf, np.nan]
MATERIALS = [material_in_MPa("any", E=E, nu=nu) for E, nu in ((207e3, 0.3), (2.0, 0.5))]
GAPS = {
    "internal": (
        *(0.001, np.nextafter(0.005, 0), 0.005, 0.05, 0.34954, 1.0),
        *(np.nextafter(10, 0), 10.0, 50.0),
    ),
    "external": (0.02, 1.0, 15.0, 140.0, 1000.0),
}
# The error allowed, in units of rounding; Octave has its own log and pow. A difference over a step
# of 6e-6 loses five digits.
ROUNDINGS, OF_DIFFERENCES = 12, 1e-10 / EPS


@dataclass
class Case:
    """One law's arguments and what NumPy answers, with the condition of each number."""

    law: laws.ContactLaw
    contact: str
    name: str = field(init=False)

    def __post_init__(self):
        of_law = exported(self.law, self.contact)
        self.name, self.differences = of_law.name, of_law.formula.stiffness is None
        blocks = [self.sweep(*each) for each in product(MATERIALS, GAPS[self.contact])]
        blocks += [self.spoiled(name) for name in of_law.arguments[1:]]
        columns = {key: np.concatenate([block[key] for block in blocks]) for key in blocks[0]}
        self.answers = columns["f"], columns["k"]
        self.conditions = columns["of_f"], columns["of_k"]
        self.arguments = {name: columns[name] for name in of_law.arguments}
        self.rows = columns["f"].size

    def source(self, target):
        return export(self.law, self.contact, target)

    def header(self):
        return source_and_header(self.law, self.contact, "c")[1]

    def sweep(self, material, dR):
        """Penetrations over the whole domain of one pair."""
        R_i, R_j = (9.5 + dR, 9.5) if self.contact == "internal" else (dR / 2, dR / 2)
        known = {"R_i": R_i, "R_j": R_j, "length": 12.0}
        pair = CylinderPair(self.contact, dR, material, material, **known)
        largest = float(self.law.max_penetration(pair))
        x = PARTS * (largest if np.isfinite(largest) else dR)
        with np.errstate(all="ignore"):
            f, k = self.law.load(x, pair), self.law.stiffness(x, pair)
            of_f, of_k = self.condition(x, largest)
            block = {
                "penetration": x, "E_star": pair.E_star, "dR": dR, **known,
                "f": f, "k": k, "of_f": of_f, "of_k": of_k,
            }  # fmt: skip
        return {key: value + np.zeros_like(PARTS) for key, value in block.items()}

    def condition(self, x, largest):
        """How far a rounding of the steps moves load and stiffness.

        Near the end of a logarithmic law dw/w = -(1 + w)/w² · dp/p, and f = p/(1 + w), k = 1/w.
        """
        if self.differences:
            return 1.0, OF_DIFFERENCES
        if not math.isfinite(largest):
            return 1.0, 1.0
        w = np.nan_to_num(branch_distance(x / largest))
        return 1 + 1 / np.maximum(w, EPS), 1 + (1 + w) / np.maximum(w, EPS) ** 2

    def spoiled(self, name):
        """Arguments that no pair has: NaN is the answer."""
        values = np.array([-1.0, 0.0, -np.inf, np.nan])
        fine = {"penetration": 1e-3, "E_star": 1e5, "dR": 0.5, "R_i": 10.0, "R_j": 9.5}
        block = fine | {"length": 12.0, name: values, "f": np.nan, "k": np.nan}
        block |= {"of_f": 1.0, "of_k": 1.0}
        return {key: value + np.zeros_like(values) for key, value in block.items()}

    def compare(self, load, stiffness):
        """Compare answers."""
        for actual, wanted, condition in zip(
            (load, stiffness), self.answers, self.conditions, strict=True
        ):
            np.testing.assert_array_equal(np.isnan(actual), np.isnan(wanted))
            np.testing.assert_array_equal(np.isinf(actual), np.isinf(wanted))
            rows = np.isfinite(wanted) & (np.abs(wanted) > 1e-290) | (wanted == 0)
            error = np.abs(actual[rows] - wanted[rows])
            allowed = ROUNDINGS * EPS * condition[rows] * np.abs(wanted[rows])
            assert np.all(error <= allowed), np.max(error / allowed)


class TableCase:
    """Conformal contact of one pair, and what its formula in Python answers."""

    def __init__(self, law, pair):
        self.law, self.pair = law, pair
        self.formula, self.constants = table_of(law, pair)
        self.name = exported(law, None, "", pair).name
        E_star, dR = (1e5, 0.05) if pair is None else (float(pair.E_star), float(pair.dR))
        d = np.concatenate([10.0 ** np.linspace(-300, 300, 61), np.geomspace(1e-9, 1e6, 400)])
        rows = [[x * dR, E_star, dR] for x in d]
        rows += [[x, E_star, dR] for x in NO_PENETRATIONS]
        rows += [[x, *bad] for x in (-1.0, 1e-3) for bad in product((E_star, *NO_PAIRS), NO_PAIRS)]
        rows += [[x, bad, dR] for x in (-1.0, 1e-3) for bad in NO_PAIRS]
        self.arguments = dict(zip(("penetration", "E_star", "dR"), np.array(rows).T, strict=True))
        self.rows = len(rows)

    def source(self, target):
        return export(self.law, None, target, pair=self.pair)

    def header(self):
        return source_and_header(self.law, None, "c", pair=self.pair)[1]

    def compare(self, load, stiffness):
        """Compare with the same nodes in Python."""
        for actual, function in ((load, self.formula.load), (stiffness, self.formula.stiffness)):
            rows = zip(*(column.tolist() for column in self.arguments.values()), strict=True)
            wanted = [self.answer(function, *row) for row in rows]
            np.testing.assert_allclose(actual, wanted, rtol=1e-12, atol=1e-299)

    def answer(self, function, penetration, E_star, dR):
        """What a law answers: 0 apart and at first touch, NaN outside its domain."""
        if penetration < 0:
            return 0.0
        if not (penetration >= 0 and E_star > 0 and dR > 0):
            return math.nan
        if penetration == 0:
            return 0.0
        return function(penetration, E_star, dR, **self.constants)


@cache
def case_of(name):
    return TableCase(*TABLES[name][:2]) if name in TABLES else Case(*LAWS[name])


ALL = [*LAWS, *TABLES]


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
def answers(tmp_path_factory):
    """What the exports of all laws answer, compiled or run at once in each language."""

    @cache
    def of(language):
        folder, cases = tmp_path_factory.mktemp(language), {name: case_of(name) for name in ALL}
        more = [SHAPES.format(folder=folder / "johnson-internal")] if language == "matlab" else []
        return RUNNERS[language](cases, folder, *more)

    return of


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("language", RUNNERS)
def test_a_law_in_another_language_is_the_law(language, name, answers):
    load, stiffness = answers(language)[name]
    case_of(name).compare(load, stiffness)


# --- tables of conformal contact ------------------------------------------------------------------


@pytest.mark.parametrize("name", TABLES)
def test_a_table_of_96_nodes_is_as_near_to_the_series_as_its_comment_says(name):
    law, pair, most = TABLES[name]
    pair = LIKE if pair is None else pair
    formula, constants = table_of(law, pair)
    assert constants["values"].size <= (200 if name == "thin-eye" else 104)
    curve = law.curve(pair)
    phi = np.geomspace(1e-9, min(1e6, 0.999 * curve.end[0]), 1001)
    d = curve.bodies.penetration(phi)
    load = np.array([formula.load(x, 1.0, 1.0, **constants) for x in d.tolist()])
    error = np.abs(load / phi - 1).max()
    said = float(formula.remark.split("within ")[1].split()[0])
    assert error < most
    assert error == pytest.approx(said, rel=0.6)
    slope = np.array([formula.stiffness(x, 1.0, 1.0, **constants) for x in d.tolist()])
    np.testing.assert_allclose(slope, curve.bodies.stiffness(d), rtol=60 * most)
    if np.isfinite(curve.end[1]):
        assert math.isnan(formula.load(1.001 * curve.end[1], 1.0, 1.0, **constants))


JOINT = ("--pin", "207 GPa, 0.3", "--hole", "70 GPa, 0.33", "--Ri", 10, "--Rj", 9.95)


def test_the_command_writes_a_law_in_a_housing_with_its_header(run, tmp_path):
    out = tmp_path / "law.c"
    options = (*JOINT, "--R-o", 20, "--clamp", "pulled:60", "--to", "c", "-o", out)
    code, said, errors = run("export", "conformal", *options)
    assert (code, errors) == (0, ""), errors
    assert "law.c" in said
    assert "law.h" in said
    text = " ".join(out.read_text(encoding="ascii").replace("//", " ").split())
    for words in ("R_o/R_i = 2", "E = 70000 MPa", "of the series", "is for no other direction",
                  "60 degrees of its rim clamped, far from the load"):  # fmt: skip
        assert words in text
    assert 'extern "C"' in out.with_suffix(".h").read_text(encoding="ascii")


def test_the_command_writes_a_fit_with_its_origin(run, monkeypatch):
    monkeypatch.chdir(RESULTS)  # a fit is not mistaken for the law whose name its file begins with
    for path in sorted(RESULTS.glob("*.json")):
        result = read_result(path)
        text = export_named(path.name, None, "c")
        assert f"double cylcontact_{result.law.replace('-', '_')}_{result.contact}_load(" in text
        assert f"fit result '{result.name}'" in " ".join(text.replace("//", "").split())
    code, said, _ = run("export", EXTERNAL, "--to", "fortran")
    assert (code, said.count("end module")) == (0, 1)


# --- what is refused ------------------------------------------------------------------------------


@pytest.mark.parametrize("own", [{"n": -1.0}, {"a": -1.0, "b": 0.0}])
def test_coefficients_that_define_no_law_are_not_exported(own):
    model = MODELS["enhanced", "external"]
    usual = {p.name: p.nominal for p in model.parameters}
    assert export(model.build(usual), "external", "c")
    with pytest.raises(InputError, match="has no load at any penetration"):
        export(model.build({**usual, **own}), "external", "c")


def test_a_load_that_falls_is_refused_with_its_penetration():
    class Odd(laws.Johnson):
        def load(self, penetration, pair):
            load = super().load(penetration, pair)
            return np.where(penetration > 0.01, load / 1e3, load)

    with pytest.raises(InputError, match=r"its load decreases at 0\.0"):
        require_contact_law(Odd(), "internal")
