"""The claims of Sections 3.2 and 3.3: verdicts, and every number computed once more."""

import math
import re
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from _cylcontact_bench.claims import section32, section33
from scipy.optimize import minimize_scalar

from cylcontact import InputError
from cylcontact.materials import shipped_materials
from cylcontact.reports.bench import Bench
from tests.support.claim_files import claims_of
from tests.support.paper_equations import (
    difference,
    e_star,
    effective_radius,
    enhanced,
    johnson,
    yield_load,
)

BENCH = Bench(Path(__file__).parents[2])
E_STAR = e_star(207e3, 0.3)
ROWS = shipped_materials()
STEEL = ROWS["low-carbon steel"].material
LOADS = (20.0, 40.0, 100.0)
BOUNDS = [("10", 0.005), ("3", 0.445)]
YES, CHOICE, OPEN = "reproduced", "reproduced with a stated choice", "undecided"
HANGS, NONE = "depends on a missing input", "not testable"


@pytest.fixture(scope="module")
def claims():
    return claims_of(BENCH, section32, section33)


@pytest.fixture
def values(claims):
    """Return a function that gives the full-precision numbers of a claim."""
    return lambda claim_id: claims[claim_id].finding.values


def holds(claims, claim_id):
    """Whether each reading of a claim meets the rule, in order."""
    return [reading.holds for reading in claims[claim_id].finding.readings]


def rows(name, **only):
    """Read a table of finite elements without the package, at given clearance, load or variant."""
    path = BENCH.root / "datasets" / "finite_element" / f"{name}-embedded.csv"
    table = pd.read_csv(path, comment="#")
    for column, value in only.items():
        table = table[table[column] == value]
    return table


def largest(values):
    return values[np.abs(values).argmax()]


class TestVerdicts:
    def test_every_reading_that_fails_says_by_how_much(self, claims):
        for claim in claims.values():
            for reading in claim.finding.readings:
                told = re.search(r"\d", reading.miss)
                assert bool(told) == (reading.holds is False), (claim.id, reading)

    def test_the_figures_have_recipes(self, claims):
        names = {name for claim in claims.values() for name in claim.figures}
        assert {"fig06", "fig07"} <= names
        assert all((BENCH.root / "reports" / f"{name}.py").is_file() for name in names)

    def test_a_table_of_an_older_set_up_is_refused(self, tmp_path):
        folder = tmp_path / "datasets" / "finite_element"
        shutil.copytree(BENCH.root / "datasets" / "finite_element", folder)
        path = folder / "recommended.toml"
        path.write_text(path.read_text().replace("outer_ratio = 3.3", "outer_ratio = 3.4"))
        with pytest.raises(InputError, match=r"is not that of .*; make finite-element brings"):
            claims_of(Bench(tmp_path), section32)


class TestLawsAlone:
    @pytest.mark.parametrize(("name", "lowest"), BOUNDS)
    @pytest.mark.parametrize("load", LOADS)
    def test_largest_difference_from_the_equations(self, values, name, lowest, load):
        off = largest(difference(load, E_STAR, np.linspace(lowest, 1.5, 400_001)))
        of_claim = values("3.2-below-10-and-3-percent")
        where = {"10": "everywhere", "3": "wide"}[name]
        key = f"enhanced to Johnson, {load:g} N/mm, {where}, percent"
        assert of_claim[key] == pytest.approx(off, rel=1e-4)

    def test_no_load_keeps_both_bounds(self, claims):
        assert holds(claims, "3.2-below-10-and-3-percent") == [False] * 3


class TestFiniteElements:
    @pytest.mark.parametrize(("name", "lowest"), BOUNDS)
    def test_largest_differences_from_the_equations(self, values, name, lowest):
        actual = rows("recommended", load_N_per_mm=20.0)
        actual = actual[actual["dR_mm"] >= lowest]
        dR, fe = actual["dR_mm"].to_numpy(), actual["penetration_mm"].to_numpy()
        laws = np.array([law(20.0, E_STAR, dR) for law in (johnson, enhanced)])
        where = {"10": "everywhere", "3": "wide"}[name]
        of_claim = values("3.2-finite-elements-below-10-and-3-percent")
        own = next(v for k, v in of_claim.items() if k.endswith(f"{where}, percent"))
        assert own == pytest.approx(largest((100 * (laws / fe - 1)).ravel()), rel=1e-9)

    @pytest.mark.parametrize(("name", "lowest"), BOUNDS)
    def test_free_datum_by_an_optimiser(self, values, name, lowest):
        actual = rows("paper", load_N_per_mm=20.0)
        actual = actual[actual["dR_mm"] >= lowest]
        dR, fe = actual["dR_mm"].to_numpy(), actual["penetration_mm"].to_numpy()
        unit = 20.0 / (math.pi * E_STAR)
        laws = np.array([law(20.0, E_STAR, dR) for law in (johnson, enhanced)])

        def worst(constant):
            return 100 * np.abs(laws / (fe + constant * unit) - 1).max()

        start = min(np.linspace(-4.5, 0, 901), key=worst)
        best = minimize_scalar(worst, bounds=(start - 0.01, start + 0.01), method="bounded")
        where = {"10": "everywhere", "3": "wide"}[name]
        of_claim = values("3.2-finite-elements-below-10-and-3-percent")
        (key,) = (k for k in of_claim if "paper" in k and "chosen" in k and where in k)
        assert of_claim[key] == pytest.approx(best.fun, rel=1e-3)

    def test_steps_down_are_those_told(self):
        dR = rows("recommended", load_N_per_mm=20.0)["dR_mm"].to_numpy()
        down = {f: dR[:-1][np.diff(enhanced(f, E_STAR, dR)) < 0].tolist() for f in LOADS}
        assert down == {20.0: [0.005, 0.2], 40.0: [0.005], 100.0: []}

    def test_refinement(self, claims, values):
        of_claim = values("3.2-mesh-refinement")
        for load, names in {
            "load on the centre node": ("load at the centre node", "the same on 32 cells"),
            "load spread over the pin": ("base", "32 cells instead of 16"),
        }.items():
            coarse, fine = (rows("sensitivity", variant=name) for name in names)
            for what, column in (
                ("contact pressure", "peak_pressure_MPa"),
                ("penetration", "penetration_mm"),
            ):
                change = largest(100 * (fine[column].to_numpy() / coarse[column].to_numpy() - 1))
                (key,) = (k for k in of_claim if k.startswith(what) and load in k)
                assert of_claim[key] == pytest.approx(change, rel=1e-12)
        assert holds(claims, "3.2-mesh-refinement") == [True, False, True, True]
        assert max(abs(v) for k, v in of_claim.items() if k.startswith("contact pressure")) < 0.1

    def test_plane_stress(self, claims, values):
        of_claim = values("3.2-plane-stress-elements")
        assert of_claim["modulus, percent"] == pytest.approx(100 * 0.09 / 0.91, rel=1e-12)
        base, changed = (rows("sensitivity", variant=name) for name in ("base", "plane stress"))
        ratio = changed["penetration_mm"].to_numpy() / base["penetration_mm"].to_numpy()
        for part, clearances in (("below", slice(None, -2)), ("above", slice(-2, None))):
            assert base["dR_mm"].to_numpy()[clearances].max() == {"below": 0.1, "above": 1}[part]
            change = 100 * (ratio[clearances].max() - 1)
            assert of_claim[f"{part} 0.445 mm, percent"] == pytest.approx(change, rel=1e-12)
        # Each plane state's slope is f/(πE*) with its own modulus, but for the snuggest fits.
        assert of_claim["slope, percent"] == pytest.approx(of_claim["modulus, percent"], rel=0.02)
        assert holds(claims, "3.2-plane-stress-elements") == [False, True, False, True]


class TestLimits:
    def test_physical_meaning(self, claims, values):
        """Persson's penetration at φ = 0.37 and at 4π/e², from his published relation."""
        of_claim = values("3.3-logarithm-physical")
        assert of_claim["shortfall at ln = 2, percent"] == pytest.approx(47.8, abs=0.05)
        number = 4 * math.pi / math.exp(of_claim["logarithm at 10 percent, -"])
        assert number == pytest.approx(0.37, abs=0.001)
        assert holds(claims, "3.3-logarithm-physical") == [True, False]

    def test_a_snug_pin_yields_at_about_1_4_times_strength_and_radius(self, values):
        """φ → ∞: the load no longer knows the clearance, while the paper's grows as 1/ΔR."""
        of_claim = values("3.3-yield-by-hertz-pressure")
        E_star = e_star(STEEL.E, STEEL.nu)
        curve = yield_load(STEEL.yield_stress, E_star, effective_radius(10.0, 0.001))
        assert of_claim["steel at 1 um, -"] * curve == pytest.approx(
            1.4 * STEEL.yield_stress * 10, rel=0.02
        )
