"""Functions of the user's own that misbehave: each is told in one line, and nothing is written."""

import sys

import pytest

from tests.support.measured_files import write_measured
from tests.support.spec_files import tree

POWER = "K * E_star / dR * penetration**1.1"
HEAD = "import sys\nimport numpy as np\n"
# What a law `load(penetration, E_star, dR, K)` does, and what is said of it. None of them is a law.
BODIES = {
    "sys.exit(0)": "stopped with SystemExit: 0",
    "raise ValueError('two\\nlines')": "stopped with ValueError: two lines",
    f"return -{POWER}": "is negative",
    "return K * penetration / (1 + (penetration / 1e-3)**2)": "decreases with the penetration at",
    "return K + 0 * penetration": "does not grow with the penetration at",
    f"return {POWER} - 50": "is negative",
    "return penetration[:-1]": "returns an array of another shape",
    "return penetration + np.nan": "lies outside the domain",
    "return penetration + 1j": "returns complex numbers",
    "return ['much'] * penetration.size": "returns text",
    "return {'load': penetration}": "returns what is not an array of numbers",
    "return penetration * missing": "stopped with NameError",
}
MODULES = {
    "def load(:": "cannot be imported (SyntaxError",
    "import sys; sys.exit()": "cannot be imported (SystemExit",
    "import absent_module": "cannot be imported (ModuleNotFoundError",
    "load = 3": "is not a function of mine",
    "class load: pass": "must take a penetration and named numbers",
    "def load(penetration, pair, K): return K": "takes a pair, and has to take what it needs",
}
GIVEN = "--E 207GPa --nu 0.3 --Ri 10 --bound K=1:10 --runs 1 -j 1"
# Names that are not of a module and a function beside the table.
NAMES = ("..mine:load", "/etc/mine:load", "mine:", ":load", "mine:a.b")


@pytest.fixture
def fit(tmp_path, run, monkeypatch):
    """Fit a law of a module mine.py to points of a power law, with little patience."""
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # of mine.py, beside it
    table = write_measured(tmp_path / "measured.csv", "power", "internal")

    def fit(module, law="mine:load", *more):
        (tmp_path / "mine.py").write_text(module)
        return run(
            *("fit", table, "--law", law, "--contact", "internal", *GIVEN.split()),
            *("-o", tmp_path / "r.json", *more),
        )

    return fit


def refused(fit, tmp_path, rule, *arguments):
    """Check that a fit is refused in one line, without a file."""
    before = {*tree(tmp_path)} | {"mine.py"}
    code, said, errors = fit(*arguments)
    assert (code, said) == (2, ""), errors
    assert len(errors.splitlines()) == 1
    assert rule in errors
    assert {*tree(tmp_path)} <= before | {"r.json.partial"}  # runs, before their best is refused


def law(body):
    return f"{HEAD}\ndef load(penetration, E_star, dR, K):\n    {body}\n"


@pytest.mark.parametrize(
    "body",
    [
        pytest.param(b, marks=[pytest.mark.slow] * ("grow" in s or "decr" in s))
        for b, s in BODIES.items()
    ],
)
def test_a_law_that_misbehaves_is_told_in_one_line(fit, tmp_path, body):
    refused(fit, tmp_path, BODIES[body], law(body))


@pytest.mark.parametrize("module", MODULES)
def test_a_module_that_misbehaves_is_told_in_one_line(fit, tmp_path, module):
    refused(fit, tmp_path, MODULES[module], module + "\n")


@pytest.mark.parametrize("name", NAMES)
def test_only_the_name_of_a_module_and_a_function_is_imported(fit, tmp_path, name):
    refused(fit, tmp_path, "cannot be imported: it does not name", law(f"return {POWER}"), name)


def test_a_law_of_ones_own_takes_no_housing(fit):
    own = law(f"return {POWER}"), "mine:load"
    code, _, errors = fit(*own, "--R-o", "20", "--clamp", "rim")
    assert (code, "'mine:load': takes no housing" in errors) == (2, True)


def test_what_a_law_prints_is_no_part_of_the_report(fit):
    code, said, _ = fit(law(f"print('a look'); return {POWER}"))
    assert (code, "a look" in said) == (0, False)
