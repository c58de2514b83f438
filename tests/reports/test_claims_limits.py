"""The claims of Sections 3.2 and 3.3: verdicts, and every number computed once more."""

import dataclasses
import math
import re
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from _cylcontact_bench.claims import section32, section33
from _cylcontact_bench.paper import MATERIALS
from scipy.optimize import minimize_scalar

from cylcontact import InputError
from cylcontact.laws.conformal import pressure
from cylcontact.materials import shipped_materials
from cylcontact.pair import CylinderPair
from cylcontact.reports.bench import Bench
from tests.support.claim_files import claims_of
from tests.support.paper_equations import (
    difference,
    e_star,
    effective_radius,
    enhanced,
    johnson,
    johnson_end,
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
VERDICTS = {
    "3.2-below-10-percent": OPEN,
    "3.2-below-3-percent": OPEN,
    "3.2-finite-elements-below-10-percent": HANGS,
    "3.2-finite-elements-below-3-percent": HANGS,
    "3.2-bounds-at-other-loads": OPEN,
    "3.2-same-trend": CHOICE,
    "3.2-mesh-refinement": OPEN,
    "3.2-element-size": OPEN,
    "3.2-plane-stress-elements": OPEN,
    "3.2-hertz-1-mm": CHOICE,
    "3.2-hertz-0.01-mm": CHOICE,
    "3.2-experiment": NONE,
    "3.3-yield-by-hertz-pressure": OPEN,
    "3.3-yield-load-against-clearance": YES,
    "3.3-yield-load-against-radius": YES,
    "3.3-yield-load-against-contact-area": YES,
    "3.3-size-matters-most": CHOICE,
    "3.3-elastic-constants-matter": YES,
    "3.3-logarithm-at-least-2": YES,
    "3.3-logarithm-physical": CHOICE,
    "3.3-limit-independent-of-radii": YES,
    "3.3-stress-at-limit-against-size": YES,
    "3.3-plastic-before-limit": CHOICE,
}


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
    def test_of_every_claim(self, claims):
        assert {name: claim.verdict for name, claim in claims.items()} == VERDICTS

    def test_whatever_is_not_plainly_reproduced_has_the_best_argument_against(self, claims):
        for claim in claims.values():
            assert claim.against or claim.verdict == YES, claim.id
            if claim.against:
                assert claim.against[0].isupper(), claim.id
                assert claim.against.endswith("."), claim.id

    def test_every_reading_that_fails_says_by_how_much(self, claims):
        for claim in claims.values():
            for reading in claim.finding.readings:
                told = re.search(r"\d", reading.miss)
                assert bool(told) == (reading.holds is False), (claim.id, reading)

    def test_every_finding_is_one_sentence_with_a_number(self, claims):
        for claim in claims.values():
            if claim.verdict != NONE:
                assert re.search(r"\d", claim.finding.ours), claim.id
                assert len(claim.finding.ours) < 220, claim.id
                assert claim.finding.values, claim.id

    def test_the_figures_have_recipes(self, claims):
        names = {name for claim in claims.values() for name in claim.figures}
        assert {"fig06", "fig07"} <= names
        assert all((BENCH.root / "reports" / f"{name}.py").is_file() for name in names)

    def test_a_bench_without_finite_elements_cannot_test_them(self, tmp_path):
        untested = claims_of(Bench(tmp_path), section32)
        of_laws = {"3.2-below-10-percent", "3.2-below-3-percent", "3.2-bounds-at-other-loads"}
        for claim in untested.values():
            assert (claim.verdict == NONE) != (claim.id in of_laws), claim.id
        assert "this set-up does not exist" in untested["3.2-element-size"].basis

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
        of_claim = values(f"3.2-below-{name}-percent")
        assert of_claim[f"enhanced to Johnson, {load:g} N/mm, percent"] == pytest.approx(
            off, rel=1e-4
        )

    def test_no_load_keeps_both_bounds(self, values):
        for load in LOADS:
            name = f"enhanced to Johnson, {load:g} N/mm, percent"
            off = [abs(values(f"3.2-below-{percent}-percent")[name]) for percent, _ in BOUNDS]
            assert off[0] > 10 or off[1] > 3

    def test_readings_by_load(self, claims):
        assert holds(claims, "3.2-below-10-percent") == [False, True, False]
        assert holds(claims, "3.2-below-3-percent") == [True, False, False]
        assert holds(claims, "3.2-bounds-at-other-loads") == [True, False]

    def test_above_the_printed_clearance_at_other_loads(self, values):
        for load in LOADS:
            name = f"{load:g} N/mm, percent"
            assert (
                values("3.2-bounds-at-other-loads")[f"above, {name}"]
                == values("3.2-below-3-percent")[f"enhanced to Johnson, {name}"]
            )


class TestFiniteElements:
    @pytest.mark.parametrize(("name", "lowest"), BOUNDS)
    @pytest.mark.parametrize("load", LOADS)
    def test_largest_differences_from_the_equations(self, values, name, lowest, load):
        actual = rows("recommended", load_N_per_mm=load)
        actual = actual[actual["dR_mm"] >= lowest]
        dR, fe = actual["dR_mm"].to_numpy(), actual["penetration_mm"].to_numpy()
        of_claim = values(f"3.2-finite-elements-below-{name}-percent")
        for label, law in (("Johnson", johnson), ("enhanced", enhanced)):
            off = largest(100 * (law(load, E_STAR, dR) / fe - 1))
            key = f"{label} to finite elements, {load:g} N/mm, percent"
            assert of_claim[key] == pytest.approx(off, rel=1e-9)

    @pytest.mark.parametrize(("name", "lowest"), BOUNDS)
    def test_free_datum_by_an_optimiser(self, values, name, lowest):
        actual = rows("paper")
        actual = actual[actual["dR_mm"] >= lowest]
        dR, fe, load = (
            actual[column].to_numpy() for column in ("dR_mm", "penetration_mm", "load_N_per_mm")
        )
        unit = load / (math.pi * E_STAR)
        laws = np.array([law(load, E_STAR, dR) for law in (johnson, enhanced)])

        def worst(constant):
            return 100 * np.abs(laws / (fe + constant * unit) - 1).max()

        scan = np.linspace(-4.5, 0, 901)
        start = min(scan, key=worst)
        best = minimize_scalar(worst, bounds=(start - 0.01, start + 0.01), method="bounded")
        of_claim = values(f"3.2-finite-elements-below-{name}-percent")
        assert of_claim["all loads, datum free, percent"] == pytest.approx(best.fun, rel=1e-3)

    def test_readings_by_set_up_and_datum(self, claims):
        assert holds(claims, "3.2-finite-elements-below-10-percent") == [
            False,
            True,
            False,
            True,
            True,
        ]
        assert holds(claims, "3.2-finite-elements-below-3-percent") == [
            True,
            True,
            False,
            True,
            False,
        ]
        for name, _ in BOUNDS:
            assert claims[f"3.2-finite-elements-below-{name}-percent"].missing == ("the datum",)

    def test_the_fitted_radius_is_named(self, claims):
        choice = claims["3.2-finite-elements-below-3-percent"].finding.choice
        assert "outer radius fitted to Johnson's law" in choice

    def test_trend_by_ranks(self, values):
        """The rank correlation by its formula of squared differences, there being no ties."""
        lowest, step = 1.0, 0.0
        for load in LOADS:
            actual = rows("recommended", load_N_per_mm=load)
            dR = actual["dR_mm"].to_numpy()
            for depth in (
                actual["penetration_mm"].to_numpy(),
                johnson(load, E_STAR, dR),
                enhanced(load, E_STAR, dR),
            ):
                n, ranks = len(depth), depth.argsort().argsort()
                off = np.sum((ranks - np.arange(n)) ** 2)
                lowest = min(lowest, 1 - 6 * off / (n * (n**2 - 1)))
                step = min(step, 100 * (depth[1:] / depth[:-1] - 1).min())
        trend = values("3.2-same-trend")
        assert trend["rank correlation, recommended, -"] == pytest.approx(lowest, rel=1e-12)
        assert trend["lowest step, recommended, percent"] == pytest.approx(step, rel=1e-9)

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

    def test_elements_over_the_half_width(self, values):
        of_claim = values("3.2-element-size")
        for size, dR in ((1.31, 1.5), (6.63, 1.5), (6.63, 0.1)):
            half_width = 2 * math.sqrt(20 * effective_radius(2.245, dR) / (math.pi * E_STAR))
            assert of_claim[f"elements of {size:g} µm at {dR:g} mm, -"] == pytest.approx(
                1e3 * half_width / size, rel=1e-12
            )
        finest = rows("convergence", variant="base")["penetration_mm"].to_numpy()
        for cells in (4, 8):
            depth = rows("convergence", variant=f"cells {cells}")["penetration_mm"].to_numpy()
            off = largest(100 * (depth / finest - 1))
            assert of_claim[f"off with {cells}, percent"] == pytest.approx(off, rel=1e-12)

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

    @pytest.mark.parametrize("dR", [1.0, 0.01])
    @pytest.mark.parametrize("load", LOADS)
    def test_hertz(self, values, dR, load):
        row = rows("recommended", dR_mm=dR, load_N_per_mm=load).iloc[0]
        R = effective_radius(2.245, dR)
        of_claim = values(f"3.2-hertz-{dR:g}-mm")
        for what, actual, hertz in (
            ("peak pressure", row["peak_pressure_MPa"], math.sqrt(load * E_STAR / (math.pi * R))),
            ("half-width", row["half_width_mm"], 2 * math.sqrt(load * R / (math.pi * E_STAR))),
        ):
            assert of_claim[f"{what} less Hertz's, {load:g} N/mm, percent"] == pytest.approx(
                100 * (actual / hertz - 1), rel=1e-9
            )

    @pytest.mark.parametrize("dR", [1.0, 0.01])
    def test_hertz_is_told_by_the_larger_of_two_deviations(self, claims, values, dR):
        claim, numbers = claims[f"3.2-hertz-{dR:g}-mm"], values(f"3.2-hertz-{dR:g}-mm")
        for load in LOADS:
            both = [
                abs(numbers[f"{what} less Hertz's, {load:g} N/mm, percent"])
                for what in ("peak pressure", "half-width")
            ]
            pattern = rf"([\d.]+) %(?: of Hertz's)? at {load:g} N/mm"
            told = float(re.search(pattern, claim.finding.ours).group(1))
            assert max(both) <= told < max(both) + 0.01
        # The bound of 3 % holds for larger clearances only.
        to_3 = [each for each in claim.finding.readings if "to 3 %" in each.choice]
        assert len(to_3) == (2 if dR == 1 else 0)
        assert all(holds(claims, claim.id))

    @pytest.mark.parametrize("load", [20.0, 100.0])
    def test_the_departure_from_hertz_at_10_um_is_that_of_conformal_contact(self, values, load):
        hertz = math.sqrt(load * E_STAR / (math.pi * effective_radius(2.245, 0.01)))
        pair = CylinderPair.from_dR("internal", 0.01, section32.STEEL, R_i=2.245)
        conformal = 100 * (float(pressure(0.0, load, pair)) / hertz - 1)
        variant = {"variant": "outer radius 10 hole radii", "dR_mm": 0.01, "load_N_per_mm": load}
        (peak,) = rows("sensitivity", **variant)["peak_pressure_MPa"]
        # Persson's plate is infinite. The small one of the claim bends and departs further.
        assert 100 * (peak / hertz - 1) == pytest.approx(conformal, rel=0.1)
        name = f"peak pressure less Hertz's, {load:g} N/mm, percent"
        assert values("3.2-hertz-0.01-mm")[name] > conformal


class TestLimits:
    def test_yield_loads_from_eq_7(self, values):
        E_star = e_star(STEEL.E, STEEL.nu)
        for R_i in (100.0, 10.0, 5.0):
            load = yield_load(STEEL.yield_stress, E_star, effective_radius(R_i, 0.05))
            of_claim = values("3.3-yield-load-against-radius")
            assert of_claim[f"R_i = {R_i:g} mm, N/mm"] == pytest.approx(load, rel=1e-12)
            growth = effective_radius(R_i, 0.001) / effective_radius(R_i, 2.0)
            of_claim = values("3.3-yield-load-against-clearance")
            assert of_claim[f"R_i = {R_i:g} mm, -"] == pytest.approx(growth, rel=1e-12)
            width = 4 * STEEL.yield_stress * effective_radius(R_i, 2.0) / E_star
            of_claim = values("3.3-yield-load-against-contact-area")
            assert of_claim[f"width at R_i {R_i:g} mm, mm"] == pytest.approx(width, rel=1e-12)

    def test_a_snug_pin_yields_at_about_1_4_times_strength_and_radius(self, values):
        """φ → ∞: the load no longer knows the clearance, while the paper's grows as 1/ΔR."""
        of_claim = values("3.3-yield-by-hertz-pressure")
        E_star = e_star(STEEL.E, STEEL.nu)
        curve = yield_load(STEEL.yield_stress, E_star, effective_radius(10.0, 0.001))
        assert of_claim["steel at 1 um, -"] * curve == pytest.approx(
            1.4 * STEEL.yield_stress * 10, rel=0.02
        )

    @pytest.mark.slow
    @pytest.mark.parametrize("factor", [0.5, 2.0])
    def test_hertz_pressure_fails_whatever_the_yield_stresses(self, monkeypatch, factor):
        changed = {name: ROWS[name].material for name in MATERIALS}
        for name, material in changed.items():
            weaker = dataclasses.replace(material, yield_stress=factor * material.yield_stress)
            changed[name] = dataclasses.replace(ROWS[name], material=weaker)
        monkeypatch.setattr(Bench, "material", lambda _bench, name: changed[name])
        changed = claims_of(BENCH, section33)
        assert holds(changed, "3.3-yield-by-hertz-pressure")[:2] == [False] * 2
        assert changed["3.3-plastic-before-limit"].verdict == CHOICE
        assert changed["3.3-size-matters-most"].verdict == CHOICE

    def test_size_against_material(self, claims, values):
        against = claims["3.3-size-matters-most"].against
        of_claim = values("3.3-size-matters-most")
        assert of_claim["by size, -"] == pytest.approx(100 * 99.95 / (5 * 4.95), rel=1e-12)
        assert of_claim["in proportion, -"] == pytest.approx(20, rel=1e-12)
        by_elastic = e_star(600e3, 0.34) / e_star(69e3, 0.24)
        assert of_claim["by E and nu, -"] == pytest.approx(by_elastic, rel=1e-12)
        smaller = 10 * 9.95 / (5 * 4.95)
        assert of_claim["by size, 10 to 5 mm, -"] == pytest.approx(smaller, rel=1e-12)
        # The numbers of the argument against it.
        assert smaller < by_elastic
        assert "the load changes less than by E and ν" in against
        of_claim = values("3.3-elastic-constants-matter")
        assert of_claim["by E, -"] == pytest.approx(600 / 69, rel=1e-12)
        assert of_claim["by nu, -"] == pytest.approx((1 - 0.34**2) / (1 - 0.24**2), rel=1e-12)

    def test_johnsons_end(self, values):
        of_claim = values("3.3-logarithm-at-least-2")
        assert of_claim["logarithm, -"] == pytest.approx(2, abs=1e-4)
        assert of_claim["load over E* dR, -"] == pytest.approx(johnson_end(1.0, 1.0), rel=1e-4)
        for name in MATERIALS:
            material = ROWS[name].material
            end = johnson_end(e_star(material.E, material.nu), 0.05)
            of_claim = values("3.3-limit-independent-of-radii")
            assert of_claim[f"{name}, N/mm"] == pytest.approx(end, rel=1e-12)

    def test_physical_meaning(self, claims, values):
        """Persson's penetration at φ = 0.37 and at 4π/e², from his published relation."""
        of_claim = values("3.3-logarithm-physical")
        assert of_claim["shortfall at ln = 2, percent"] == pytest.approx(47.8, abs=0.05)
        number = 4 * math.pi / math.exp(of_claim["logarithm at 10 percent, -"])
        assert number == pytest.approx(0.37, abs=0.001)
        assert holds(claims, "3.3-logarithm-physical") == [True, False]
        assert claims["3.3-logarithm-physical"].finding.settled

    def test_stress_and_width_at_the_limit(self, values):
        of_claim = values("3.3-stress-at-limit-against-size")
        E_star = e_star(STEEL.E, STEEL.nu)
        for R_i in (100.0, 10.0, 5.0):
            stress = 2 / math.e * E_star * 0.05 / math.sqrt(R_i * (R_i - 0.05))
            assert of_claim[f"R_i = {R_i:g} mm, MPa"] == pytest.approx(stress, rel=1e-12)
        assert of_claim["width over the hole, -"] == pytest.approx(
            4 / math.e * math.sqrt(9.95 / 10), rel=1e-12
        )

    def test_yield_before_the_limit(self, values):
        of_claim = values("3.3-plastic-before-limit")
        E_star = e_star(STEEL.E, STEEL.nu)
        for key, stress in (
            ("low-carbon steel, um", STEEL.yield_stress),
            ("low-carbon steel, half the yield stress, um", STEEL.yield_stress / 2),
        ):
            dR = 1e-3 * of_claim[key]
            at_yield = yield_load(stress, E_star, effective_radius(10.0, dR))
            assert at_yield == pytest.approx(johnson_end(E_star, dR), rel=1e-9)
