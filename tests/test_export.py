import json
import math
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, laws
from cylcontact.choices import listed
from cylcontact.export import EXPORTABLE, TARGETS, export, export_named
from cylcontact.export.formulas import formula_of
from cylcontact.export.soundness import require_contact_law
from cylcontact.fitting import FitResult
from cylcontact.fitting.law_models import MODELS
from cylcontact.laws.adapters import ScaledLaw
from cylcontact.laws.lambert import branch_distance
from cylcontact.materials import material_in_MPa
from tests import programs
from tests.export_runners import run_c, run_fortran, run_octave

RESULTS = Path(__file__).parents[1] / "fitting" / "results"
INTERNAL, EXTERNAL = RESULTS / "internal.json", RESULTS / "external.json"
EPS = 2.0**-52


@cache
def coefficients(path):
    return FitResult.read(path).coefficients


def two_formulas(law):
    """Whether a law has another formula for external contact."""
    with suppress(InputError):
        return formula_of(law, "external").name != formula_of(law, "internal").name
    return False


# Every law with a name, for each contact that it tells apart, and coefficients of one's own.
LAWS = {
    **{f"{name}-internal": (laws.LAWS[name](), "internal") for name in EXPORTABLE},
    **{
        f"{name}-external": (laws.LAWS[name](), "external")
        for name in EXPORTABLE
        if two_formulas(laws.LAWS[name]())
    },
    "refit-internal": (laws.Enhanced(coefficients(INTERNAL)), "internal"),
    "refit-external": (laws.Enhanced(coefficients(EXTERNAL)), "external"),
    "undefined": (laws.Enhanced(coefficients(INTERNAL) | {"a": -1.0, "b": 0.5}), "internal"),
    "power": (laws.PowerLaw(n=1.237, K_star=0.3), "external"),
    "power-of-one-pair": (laws.PowerLaw(n=1.237, K=312148.0), "internal"),
    "power-dimensionless": (laws.PowerLaw(n=1.14, C=0.913), "internal"),
    "linear": (laws.PowerLaw(n=1.0, K_star=0.3), "internal"),
    "softening": (laws.PowerLaw(n=0.9, K_star=0.3), "internal"),
    "explicit-own": (laws.Explicit({"c": 1.4, "A": 0.4, "B": 3.0}), "internal"),
    "explicit-stiffer": (ScaledLaw(laws.Explicit(), load_factor=1.3), "internal"),
    "liu-softer": (ScaledLaw(laws.Liu(), load_factor=0.7), "internal"),
}

# Parts of the largest penetration, or of ΔR: tiny, dense, up to the limit, at it and beyond.
PARTS = np.concatenate(
    [
        [-np.inf, -1.0, -1e-300, np.nan, 0.0],
        10.0 ** -np.linspace(0, 290, 117)[1:],
        np.linspace(0.01, 0.99, 99),
        1 - 10.0 ** -np.linspace(2, 15.5, 28),
        1 - np.arange(5) * EPS / 2,
        [1 + EPS, 1 + 1e-9, 1.1, 10.0, 1e3, 1e10],
    ]
)
MATERIALS = [
    material_in_MPa("any", E=E, nu=nu) for E, nu in ((69e3, 0.33), (207e3, 0.3), (2.0, 0.5))
]
GAPS = {
    "internal": (
        *(0.001, np.nextafter(0.005, 0), 0.005, 0.0075, 0.05, 0.34, 0.34954, 0.36),
        *(0.5, 1.0, 2.5, np.nextafter(10, 0), 10.0, 50.0),
    ),
    "external": (0.02, 1.0, 15.0, 140.0, 1000.0),
}


def sizes(contact, dR):
    """Radii that differ by dR, or add up to it, and a length."""
    R_i, R_j = (9.5 + dR, 9.5) if contact == "internal" else (dR / 2, dR / 2)
    return {"R_i": R_i, "R_j": R_j, "length": 12.0}


@dataclass
class Case:
    """One law's arguments, what Python answers, and how closely others must."""

    law: laws.ContactLaw
    contact: str

    def __post_init__(self):
        formula = formula_of(self.law, self.contact)
        self.function = formula.name
        pins = MATERIALS if "alpha" in formula.arguments else (None,)
        pairs = product(MATERIALS, pins, GAPS[self.contact])
        blocks = [self.sweep(hole, pin or hole, dR) for hole, pin, dR in pairs]
        blocks += [self.spoiled(formula, name) for name in formula.arguments[1:]]
        columns = {key: np.concatenate([block[key] for block in blocks]) for key in blocks[0]}
        self.load, self.stiffness, self.tolerance = map(columns.pop, ("f", "k", "tolerance"))
        self.arguments = {name: columns[name] for name in formula.arguments}
        self.rows = self.load.size

    def sweep(self, hole, pin, dR):
        """Penetrations over the whole domain of one pair."""
        known = sizes(self.contact, dR)
        pair = CylinderPair(self.contact, dR, hole, pin, **known)
        largest = self.law.max_penetration(pair)
        unit = float(largest) if np.isfinite(largest) else dR
        penetration = PARTS * unit
        with np.errstate(all="ignore"):
            block = {
                "penetration": penetration,
                "E_star": pair.E_star,
                "dR": dR,
                "alpha": pair.alpha,
                "beta": pair.beta,
                **known,
                "f": self.law.load(penetration, pair),
                "k": self.law.stiffness(penetration, pair),
                "tolerance": self.allowed(penetration, float(largest)),
            }
        return {key: value + np.zeros_like(PARTS) for key, value in block.items()}

    def allowed(self, penetration, largest):
        """1e-12, and near the end of a logarithmic law its condition number in roundings.

        There dw/w = -(1 + w)/w² · dp/p; a correctly rounded w - ln(1 + w) leaves dw of the
        order of one rounding, whatever w.
        """
        if math.isinf(largest):
            return 1e-12
        w = branch_distance(penetration / largest)
        return 1e-12 + np.nan_to_num(4 * EPS / w, posinf=0.0)

    def spoiled(self, formula, name):
        """Arguments that no pair has: NaN is the answer."""
        signed = name in ("alpha", "beta")
        values = np.array([-1.0, 1.0 if signed else 0.0, -np.inf, np.nan])
        fine = {"penetration": 1e-3, "E_star": 1e5, "dR": 0.5, **sizes("internal", 0.5)}
        fine |= {"alpha": 0.0, "beta": 0.0}
        assert name in formula.arguments
        block = fine | {name: values, "f": np.nan, "k": np.nan, "tolerance": 0.0}
        return {key: value + np.zeros_like(values) for key, value in block.items()}

    def compare(self, load, stiffness):
        for actual, wanted in ((load, self.load), (stiffness, self.stiffness)):
            assert actual.shape == wanted.shape
            np.testing.assert_array_equal(np.isnan(actual), np.isnan(wanted))
            np.testing.assert_array_equal(np.isinf(actual), np.isinf(wanted))
            finite = np.isfinite(wanted)
            error = np.abs(actual[finite] - wanted[finite])
            # Below 1e-300 there are fewer digits.
            allowed = self.tolerance[finite] * np.abs(wanted[finite]) + 1e-300
            assert np.all(error <= allowed), np.max(error / allowed)


@pytest.fixture(scope="module")
def cases():
    return {name: Case(law, contact) for name, (law, contact) in LAWS.items()}


def test_sweeps_reach_every_edge(cases):
    johnson = cases["johnson-internal"]
    assert np.isinf(johnson.stiffness).sum() == len(MATERIALS) * len(GAPS["internal"])
    assert np.isinf(cases["softening"].stiffness).any()  # at no penetration
    assert np.isnan(cases["undefined"].load).sum() > np.isnan(cases["refit-internal"].load).sum()
    for case in cases.values():
        defined = np.isfinite(case.load)
        assert defined.sum() > 1000
        assert (case.load[defined] == 0).any()
        assert (case.arguments["penetration"][~defined] > 0).any()


@pytest.mark.parametrize("name", LAWS)
def test_c_agrees(name, cases, tmp_path):
    cases[name].compare(*run_c(cases[name], tmp_path))


@pytest.mark.parametrize("name", LAWS)
def test_fortran_agrees(name, cases, tmp_path):
    load, stiffness, *by_functions = run_fortran(cases[name], tmp_path)
    cases[name].compare(load, stiffness)
    np.testing.assert_array_equal(by_functions, [load, stiffness])


SHAPES = """
addpath('{folder}');
[f, k] = cylcontact_johnson(1e-3 * [1 2 3], [1e5; 2e5], 0.05);
assert(size(f), [2 3]); assert(size(k), [2 3]); assert(f(2, :), 2 * f(1, :), 1e-9);
assert(cylcontact_johnson([-1 -Inf], 1e5, 0.05), [0 0]);
assert(isnan(cylcontact_johnson(NaN, 1e5, 1)));
assert(size(cylcontact_johnson(zeros(0, 1), 1e5, 0.05)), [0 1]);
assert(cylcontact_johnson(0, 1e5, 0.05), 0);
assert(isreal(cylcontact_johnson([-1 1e-3 1], 1e5, 0.05)));
"""


@pytest.fixture(scope="module")
def octave(cases, tmp_path_factory):
    folder = tmp_path_factory.mktemp("octave")
    return run_octave(cases, folder, SHAPES.format(folder=folder / "johnson-internal"))


@pytest.mark.parametrize("name", LAWS)
def test_matlab_agrees_in_octave(name, cases, octave):
    cases[name].compare(*octave[name])


SYNTAX = {name: getattr(np, name) for name in ("log", "log1p", "exp", "sqrt", "sin", "pi", "nan")}


def evaluate(document, values):
    """Follow the steps of a JSON export, as its readers would."""
    known = SYNTAX | {"max": max, "atan": np.arctan} | document["constants"] | values
    if values["penetration"] < 0:
        return 0.0, 0.0
    if not all(eval(condition, known) for condition in document["conditions"]):
        return np.nan, np.nan
    for step in document["steps"]:
        exec(step, known)
    return known["f"], known["k"]


@pytest.mark.parametrize("name", LAWS)
def test_json_steps_give_its_check_values(name):
    law, contact = LAWS[name]
    document = json.loads(export(law, contact, "json"))
    table = {key: np.array(list(map(float, v))) for key, v in document["check_values"].items()}
    rows = [dict(zip(table, row, strict=True)) for row in zip(*table.values(), strict=True)]
    wanted = np.array([(row.pop("load"), row.pop("stiffness")) for row in rows])
    with np.errstate(divide="ignore"):
        actual = np.array([evaluate(document, row) for row in rows])
    np.testing.assert_allclose(actual, wanted, rtol=1e-12)
    assert (wanted[0] == 0).all()  # without contact
    assert np.isfinite(wanted).sum() > 20
    assert list(document["arguments"]) == list(rows[0])
    assert document["law"] == law.name


def test_json_check_values_are_the_law(steel):
    document = json.loads(export_named("dubowsky-freudenstein", None, "json"))
    table = document["check_values"]
    pair = CylinderPair.internal(10.0, 9.0, steel, length=25.0)
    chosen = [
        i
        for i, given in enumerate(zip(table["E_star"], table["dR"], table["length"], strict=True))
        if given == (float(pair.E_star), float(pair.dR), 25.0) and table["load"][i] != "NaN"
    ]
    assert len(chosen) == 8
    for i in chosen:
        assert table["load"][i] == pytest.approx(
            float(laws.DubowskyFreudenstein().load(table["penetration"][i], pair)), rel=1e-15
        )


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("target", TARGETS)
def test_text_is_portable(name, target):
    law, contact = LAWS[name]
    text = export(law, contact, target)
    assert text.isascii()
    assert text.endswith("\n")
    assert target == "json" or max(map(len, text.splitlines())) <= 120  # Fortran takes 132
    formula = formula_of(law, contact)
    names = [*formula.arguments, *formula.constants, *(step.name for step in formula.steps)]
    assert len({name.lower() for name in names}) == len(names)  # Fortran ignores case
    assert all(repr(value) in text for value in formula.coefficients.values())


@pytest.mark.parametrize("target", TARGETS)
def test_result_says_where_it_comes_from(target):
    text = " ".join(export_named(str(EXTERNAL), None, target).replace("//", "").split())
    assert "fit result 'external'" in text
    assert all(repr(value) in text for value in coefficients(EXTERNAL).values())


def test_result_and_its_contact_agree():
    assert export_named(str(INTERNAL), "internal", "c") == export_named(str(INTERNAL), None, "c")


@pytest.mark.parametrize("target", TARGETS)
def test_no_name_breaks_out_of_its_comment(target):
    text = export(laws.Enhanced(), "internal", target, "a\nb */ \\ é ??/")
    assert "b */" not in text or target == "json"
    assert all(line.strip() != "b" for line in text.splitlines())


ERRORS = {
    "unknown law": (
        lambda: export_named("hertz", None, "c"),
        "export: law = 'hertz': is neither a law that can be exported nor a fit result; choose "
        f"{', '.join(EXPORTABLE)}, or the path of a result",
    ),
    "name of no file": (
        lambda: export_named("x" * 5000, None, "c"),
        f"export: law = '{'x' * 78}…: is neither a law that can be exported nor a fit result; "
        f"choose {', '.join(EXPORTABLE)}, or the path of a result",
    ),
    "folder": (
        lambda: export_named(str(RESULTS), None, "c"),
        f"{RESULTS}: cannot be read (Is a directory); check the path",
    ),
    "unknown target": (
        lambda: export_named("johnson", None, "rust"),
        f"export: --to = 'rust': is not a known target; choose {listed(TARGETS)}",
    ),
    "unknown contact": (
        lambda: export_named("johnson", "conformal", "c"),
        "export: --contact = 'conformal': is not a contact; choose internal or external",
    ),
    "contact missing": (
        lambda: export_named("enhanced", None, "c"),
        "export: --contact: is missing, and the enhanced law has other coefficients for each; "
        "give --contact internal or --contact external",
    ),
    "contact missing, explicit": (
        lambda: export_named("explicit", None, "c"),
        "export: --contact: is missing, and the explicit law has other coefficients for each; "
        "give --contact internal or --contact external",
    ),
    "contact contradicts result": (
        lambda: export_named(str(INTERNAL), "external", "c"),
        f"{INTERNAL}: contact = 'internal': contradicts --contact external; leave --contact out, "
        "or name a result for that contact",
    ),
    "contact contradicts coefficients": (
        lambda: export(laws.Enhanced(coefficients(INTERNAL)), "external", "c"),
        "export: --contact = 'external': the coefficients are for internal contact; leave it out",
    ),
    "law not for the contact": (
        lambda: export_named("liu", "external", "c"),
        "export: --contact = 'external': the law 'liu' is for a pin in a hole; "
        "give --contact internal, or export johnson",
    ),
    "power without a result": (
        lambda: export_named("power", None, "c"),
        "export: law = 'power': has no coefficients of its own; name a fit result of it",
    ),
    "no closed form": (
        lambda: export(laws.Persson(), "internal", "c"),
        "export: law = 'persson': has no closed form to write in another language; "
        "export explicit, which follows conformal contact",
    ),
    "no closed form, by name": (
        lambda: export_named("persson", None, "c"),
        "export: law = 'persson': has no closed form to write in another language; "
        "export explicit, which follows conformal contact",
    ),
    "winkler's rollers": (
        lambda: export_named("winkler", "external", "c"),
        "export: --contact = 'external': the law 'winkler' is for a pin in a hole; "
        "give --contact internal, or export johnson",
    ),
    "no such result": (
        lambda: export_named("nothing.json", None, "c"),
        "nothing.json: cannot be read (No such file or directory); check the path",
    ),
}


@pytest.mark.parametrize(("act", "message"), ERRORS.values(), ids=ERRORS)
def test_errors(act, message):
    with pytest.raises(InputError) as caught:
        act()
    assert str(caught.value) == message


def test_every_law_that_is_fitted_on_a_grid_can_be_exported():
    models = [model for model in MODELS.values() if model.on_grid]
    assert {model.law for model in models} > {"enhanced", "explicit"}
    for model in models:
        law = model.build({p.name: p.nominal or (p.low + p.high) / 2 for p in model.parameters})
        assert formula_of(law, model.contact).contact in (model.contact, None)


@pytest.mark.parametrize("path", sorted(RESULTS.glob("*.json")), ids=lambda path: path.stem)
def test_every_committed_result_can_be_exported(path):
    result = FitResult.read(path)
    name = f"cylcontact_{result.law.replace('-', '_')}_{result.contact}"
    assert f"void {name}(" in export_named(str(path), None, "c")


def test_an_absent_program_skips_but_where_no_test_may(monkeypatch):
    monkeypatch.setenv("PATH", "")
    for required, outcome in ((True, pytest.fail), (False, pytest.skip)):
        monkeypatch.setattr(programs, "REQUIRED", required)
        with pytest.raises(outcome.Exception, match=r"octave-cli is not .* apt install octave\)"):
            programs.require_program("octave-cli")


@pytest.mark.parametrize(
    ("law", "contact", "coefficients", "rule"),
    [
        ("enhanced", "external", {"n": -1.0}, "has no load at any penetration"),
        ("enhanced", "external", {"a": -1.0, "b": 0.0}, "has no load at any penetration"),
        ("power", "internal", {"K_star": -2.0}, "positive and finite"),
        ("power", "internal", {"n": 0.0}, "must be positive and finite"),
        ("explicit", "internal", {"A": -3.0}, ""),
        ("winkler", "internal", {"depth": -0.5}, ""),
        ("lankarani-nikravesh", "internal", {"factor": -1.0}, ""),
    ],
)
@pytest.mark.parametrize("target", TARGETS)
def test_coefficients_that_define_no_law_are_not_exported(law, contact, coefficients, rule, target):
    model = MODELS[law, contact]
    usual = {"power": {"K_star": 2.0, "n": 1.1}}.get(
        law, {p.name: p.nominal for p in model.parameters}
    )
    assert export(model.build(usual), contact, target)
    with pytest.raises(InputError) as caught:
        export(model.build({**usual, **coefficients}), contact, target)
    assert rule in caught.value.rule
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("falls", [False, True])
def test_a_load_that_is_negative_or_falls_is_told_with_its_penetration(falls):
    class Odd(laws.Johnson):
        def load(self, penetration, pair):
            load = super().load(penetration, pair)
            return np.where(penetration > 0.01, load / 1e3 if falls else -load, load)

    with pytest.raises(InputError) as caught:
        require_contact_law(Odd(), "internal")
    assert ("its load decreases at 0.0" if falls else "its load is negative at 0.0") in str(
        caught.value
    )
