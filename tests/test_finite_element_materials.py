"""Finite elements of two materials, up to nearly incompressible ones."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from cylcontact import InputError, laws, limits
from cylcontact.datasets import read_grid
from cylcontact.datasets.finite_element import Setup, read_study, read_table, run_study, solve
from cylcontact.datasets.finite_element.calculix import find_program, run_case
from cylcontact.datasets.finite_element.spec import study_from
from cylcontact.stress import in_pin, in_plate, pressure_along
from cylcontact.yield_search import equivalent
from tests.finite_element_series import PinInRing
from tests.programs import require_program
from tests.spec_files import ELEMENTS, changed, write_toml

STEEL, ALUMINIUM, PEEK, RUBBER = (207e3, 0.3), (70e3, 0.33), (3.6e3, 0.38), (5.0, 0.4999)
R_I, DR = 10.0, 0.01
# Pins and plates.
PAIRS = {
    "steel in aluminium": (STEEL, ALUMINIUM),
    "aluminium in steel": (ALUMINIUM, STEEL),
    "PEEK in steel": (PEEK, STEEL),
    "steel in PEEK": (STEEL, PEEK),
    "steel in steel": (STEEL, STEEL),
}


def joint(pin, plate, cells=12, outer_ratio=80.0, plane="strain"):
    """Return a set-up; in so wide a plate the law's datum lacks only 0.02 % of the penetration."""
    (E, nu), (pin_E, pin_nu) = plate, pin
    return Setup(
        R_I,
        outer_ratio,
        f"{E} MPa",
        nu,
        plane=plane,
        clamp="whole",
        cells=cells,
        pin_E=f"{pin_E} MPa",
        pin_nu=pin_nu,
    )


def clamped(setup):
    """Return the reference law with the set-up's datum."""
    return laws.Conformal(datum=laws.Housing(R_o=setup.outer_radius))


def semi_angle(case):
    """Return where p² vanishes, in degrees: a parabola of tan²(θ/2) through the contact's edge."""
    square = np.tan(case.arc / R_I / 2) ** 2
    share = (case.pressure / case.peak_pressure) ** 2
    flank = (share > 0.01) & (share < 0.8)
    roots = np.roots(np.polyfit(square[flank], share[flank], 2))
    return 2 * np.degrees(np.arctan(np.sqrt(roots[roots > 0].min())))


def assert_is_the_laws(pin, plate, phis, plane="strain"):
    """Assert penetration and peak pressure on two meshes, extrapolated, and the angle on one.

    The cells of the second mesh are half as long and the errors go with their square. What is left
    is 0.064 % of the penetration and 0.071 % of the pressure at most, 0.9 % of the angle.
    """
    coarse, fine = (joint(pin, plate, cells, plane=plane) for cells in (6, 12))
    pair, law = fine.pair(DR), clamped(fine)
    for phi in phis:
        load = phi * float(pair.E_star) * DR
        (first,), (second,) = (solve(setup, DR, [load]) for setup in (coarse, fine))
        penetration = (4 * second.penetration - first.penetration) / 3
        assert penetration == pytest.approx(float(law.penetration(load, pair)), rel=1e-3, abs=0)
        peak = (4 * second.peak_pressure - first.peak_pressure) / 3
        assert peak == pytest.approx(float(law.peak_pressure(load, pair)), rel=1e-3)
        assert semi_angle(second) == pytest.approx(float(law.contact_angle(load, pair)), rel=0.01)


class TestReferenceLaw:
    @pytest.mark.parametrize("name", PAIRS)
    @pytest.mark.slow
    def test_penetration_pressure_and_angle(self, name):
        assert_is_the_laws(*PAIRS[name], phis=(0.03, 0.3, 1.0, 3.0))

    @pytest.mark.slow
    def test_in_plane_stress(self):
        assert_is_the_laws(STEEL, ALUMINIUM, phis=(0.03, 1.0), plane="stress")

    @pytest.mark.long
    def test_without_extrapolation_on_a_fine_mesh(self):
        for pin, plate in PAIRS.values():
            setup = joint(pin, plate, cells=24)
            pair, law = setup.pair(DR), clamped(setup)
            for phi in (0.3, 1.0, 3.0):
                load = phi * float(pair.E_star) * DR
                (case,) = solve(setup, DR, [load])
                expected = float(law.penetration(load, pair))
                assert case.penetration == pytest.approx(expected, rel=1e-3, abs=0)


class TestIncompressible:
    @pytest.mark.parametrize(
        ("pin", "plate"), [(STEEL, ALUMINIUM), (RUBBER, STEEL), (STEEL, RUBBER), (RUBBER, RUBBER)]
    )
    @pytest.mark.slow
    def test_michells_series_in_a_narrow_ring(self, pin, plate):
        setup = replace(joint(pin, plate, cells=16), outer_ratio=3.3)
        load = 0.3 * float(setup.pair(DR).E_star) * DR
        (case,) = solve(setup, DR, [load])
        penetration, _, peak = PinInRing(R_I, DR, setup.outer_radius, plate, pin).penetration(load)
        assert case.penetration == pytest.approx(penetration, rel=2e-3, abs=0)
        assert case.peak_pressure == pytest.approx(peak, rel=2e-3)

    def test_penetration_tends_to_that_of_an_incompressible_body(self):
        # Not in the wide plate: held all round it cannot leave room for the hole's changes.
        setup = joint((2e3, 0.3), (1e3, 0.3), cells=8, outer_ratio=3.3)
        at = {
            nu: solve(replace(setup, nu=nu, pin_nu=nu), DR, [3.0])[0].penetration
            for nu in (0.4999, 0.49999, 0.499999)
        }
        steps = np.diff(list(at.values()))
        # 1 − 2ν falls to a tenth in each step.
        assert steps[0] / steps[1] == pytest.approx(10.0, rel=0.05)
        assert abs(steps[1]) < 1e-4 * at[0.499999]

    @pytest.mark.slow
    def test_plain_and_other_cells_meet_at_0_4(self):
        setup = joint(STEEL, (70e3, 0.4), cells=16)
        (plain,), (other,) = (solve(replace(setup, nu=nu), DR, [100.0]) for nu in (0.4, 0.400001))
        assert 0 < other.penetration / plain.penetration - 1 < 2e-3

    def test_stress_below_the_contact_has_no_noise(self):
        setup = joint(RUBBER, RUBBER, outer_ratio=10.0)
        load = 1e-4 * float(setup.pair(DR).E_star) * DR
        (case,) = solve(setup, DR, [load])
        b, peak = (f(load, setup.pair(DR)) for f in (limits.hertz_half_width, limits.hertz_stress))
        for body in ("plate", "pin"):
            depth, stress = case.stress_below(body)
            near = depth < 2 * b
            expected = -peak / np.sqrt(1 + (depth[near] / b) ** 2)
            assert stress.yy[near] == pytest.approx(expected, abs=0.02 * peak)

    @pytest.mark.parametrize("key", ["nu", "pin_nu"])
    @pytest.mark.parametrize("nu", [0.5, 0.4999999])
    def test_beyond_the_limit_is_refused(self, key, nu):
        with pytest.raises(InputError) as caught:
            replace(joint(STEEL, STEEL), **{key: nu})
        assert str(caught.value) == (
            f"finite elements: {key} = {nu}: must not exceed 0.499999 in plane strain: the "
            "stiffness of an incompressible body is infinite; use 0.4999, or laws.Conformal(), "
            "which takes 0.5"
        )

    def test_plane_stress_takes_an_incompressible_body(self):
        setup = joint((5.0, 0.5), STEEL, cells=8, plane="stress")
        pair = setup.pair(DR)
        load = float(pair.E_star) * DR
        (case,) = solve(setup, DR, [load])
        expected = float(clamped(setup).penetration(load, pair))
        assert case.penetration == pytest.approx(expected, rel=5e-3, abs=0)


class TestSetup:
    def test_a_pin_of_the_plates_own_material_changes_nothing(self):
        one = Setup(2.245, 3.3, *STEEL, cells=8)
        (first,), (second,) = (
            solve(setup, 0.1, [20.0])
            for setup in (one, replace(one, pin_E=STEEL[0], pin_nu=STEEL[1]))
        )
        assert first.penetration == second.penetration

    def test_each_constant_of_the_pin_is_by_default_the_plates(self):
        setup = Setup(2.245, 3.3, *STEEL, pin_E=70e3)
        pin = setup.material("pin")
        assert (pin.E, pin.nu) == (70e3, 0.3)
        assert setup.pair(0.1).material_i.E == 207e3

    def test_pair_has_the_plane_state(self):
        setup = joint(PEEK, STEEL, plane="stress")
        assert setup.pair(DR).plane == "stress"
        assert setup.pair(DR).alpha == pytest.approx((207 - 3.6) / (207 + 3.6))

    def test_bodies_swap_their_stiffness_not_their_pressure(self):
        """At small loads both are half-planes: only the additive constant knows which is which."""
        load = 1e-3 * float(joint(STEEL, PEEK).pair(DR).E_star) * DR
        (one,), (other,) = (
            solve(joint(*bodies, cells=8), DR, [load]) for bodies in ((STEEL, PEEK), (PEEK, STEEL))
        )
        assert one.peak_pressure == pytest.approx(other.peak_pressure, rel=2e-2)
        assert one.penetration > 1.2 * other.penetration

    def test_stress_is_of_the_bodys_own_material(self):
        setup = joint(RUBBER, STEEL)
        (case,) = solve(setup, DR, [1e-2])
        for body, nu in (("plate", STEEL[1]), ("pin", RUBBER[1])):
            stress = case.stress(body)
            assert stress.zz == pytest.approx(nu * (stress.xx + stress.yy), rel=1e-9, abs=1e-12)


class TestInteriorStress:
    @pytest.mark.slow
    def test_von_mises_below_a_narrow_contact_is_hertzs(self):
        def stress(z, nu=STEEL[1]):
            """Von Mises over the peak pressure at the depth z half-widths; Johnson (1985) 4.46."""
            root = np.hypot(1, z)
            across, along = -((1 + 2 * z**2) / root - 2 * z), -1 / root
            axial = nu * (across + along)
            return np.sqrt(
                ((across - along) ** 2 + (along - axial) ** 2 + (axial - across) ** 2) / 2
            )

        hertz = minimize_scalar(lambda z: -stress(z), bounds=(0.1, 2), method="bounded")
        setup = joint(STEEL, STEEL, cells=16, outer_ratio=10.0)
        load = 1e-5 * float(setup.pair(DR).E_star) * DR
        (case,) = solve(setup, DR, [load])
        for body in ("plate", "pin"):
            depth, below = case.stress_below(body)
            z, actual = depth / case.half_width, below.von_mises / case.peak_pressure
            near = z < 2
            assert actual[near] == pytest.approx(stress(z[near]), abs=0.01)
            assert z[actual.argmax()] == pytest.approx(hertz.x, abs=0.05)
            assert actual.max() == pytest.approx(-hertz.fun, rel=0.01)

    @pytest.mark.slow
    def test_a_conforming_contact_brings_the_plates_maximum_up(self):
        setup, depths = joint(STEEL, STEEL, cells=16, outer_ratio=10.0), []
        for phi in (1e-4, 0.01, 0.1, 0.3):
            (case,) = solve(setup, DR, [phi * float(setup.pair(DR).E_star) * DR])
            depth, below = case.stress_below("plate")
            depths.append(depth[below.von_mises.argmax()] / case.half_width)
        assert depths == sorted(depths, reverse=True)
        assert 0.60 < depths[1] < 0.70
        assert depths[-1] < 0.35


class TestCalculix:
    @pytest.mark.parametrize(
        ("pin", "plate"), [(STEEL, ALUMINIUM), (PEEK, STEEL), (RUBBER, STEEL), (STEEL, RUBBER)]
    )
    def test_two_materials(self, pin, plate):
        require_program("ccx")
        setup = joint(pin, plate, outer_ratio=10.0)
        load = 0.1 * float(setup.pair(DR).E_star) * DR
        (case,) = solve(setup, DR, [load])
        actual = run_case(setup, DR, load, np.array([load]), find_program())
        assert actual.penetration == pytest.approx(case.penetration, rel=3e-3, abs=0)
        assert actual.peak_pressure == pytest.approx(case.peak_pressure, rel=0.02)


class TestFiles:
    BOTH = changed(
        ELEMENTS,
        {
            "pin_E": 3.6,
            "pin_nu": 0.38,
            "origin.pin_E": "assumed",
            "origin.pin_nu": "assumed",
            "variants": [{"name": "aluminium", "pin_E": 70.0, "pin_nu": 0.4999}],
        },
    )

    @pytest.mark.parametrize(
        ("changes", "message"),
        [
            ({"pin_E": 0.0}, "pin_E = 0.0: must be greater than 0"),
            ({"pin_nu": 0.6}, "pin_nu = 0.6: must be less than or equal to 0.5"),
            ({"pin_nu": 0.5}, "pin_nu = 0.5: must not exceed 0.499999 in plane strain"),
            ({"nu": 0.5}, "nu = 0.5: must not exceed 0.499999 in plane strain"),
            ({"variants": [{"name": "a", "nu": 0.5}]}, "variants.0: nu = 0.5: must not exceed"),
            ({"pin_E": "steel"}, "pin_E = 'steel'"),
        ],
    )
    def test_mistakes_are_told_in_a_line(self, tmp_path, monkeypatch, run, changes, message):
        monkeypatch.chdir(tmp_path)
        write_toml(tmp_path / "both.toml", changed(self.BOTH, changes))
        code, _, err = run("finite-element", "both.toml")
        assert (code, err.count("\n")) == (2, 1)
        assert err.startswith("cylcontact: both.toml")
        assert message in err

    def test_an_unmarked_pin_is_told(self):
        spec = changed(ELEMENTS, {"pin_E": 3.6})
        with pytest.raises(InputError, match=r"origin\.pin_E: is required"):
            study_from(spec, "both", "both.toml")

    def test_table_and_journal_have_the_pins_constants(self, tmp_path, monkeypatch, run):
        monkeypatch.chdir(tmp_path)
        study = read_study(write_toml(tmp_path / "both.toml", self.BOTH))
        assert run("finite-element", "both.toml", "-j", 1)[0] == 0
        rows = read_table("both-embedded.csv").rows
        pins = rows[["variant", "pin_E_GPa", "pin_nu"]].drop_duplicates()
        assert pins.to_numpy().tolist() == [["base", 3.6, 0.38], ["aluminium", 70.0, 0.4999]]
        assert (rows["E_GPa"].unique(), rows["nu"].unique()) == (ELEMENTS["E"], ELEMENTS["nu"])
        kept = tmp_path / "kept"
        solved, _ = run_study(study, checkpoint=kept)
        assert run_study(study, checkpoint=kept, resume=True)[0] == solved
        assert [row.case.penetration for row in solved] == pytest.approx(
            rows["penetration_mm"].to_numpy(), rel=1e-6
        )

    def test_a_grid_of_one_material_refuses_such_a_table(self, tmp_path, monkeypatch, run):
        monkeypatch.chdir(tmp_path)
        write_toml(tmp_path / "both.toml", self.BOTH)
        run("finite-element", "both.toml", "-j", 1)
        spec = {
            "contact": "internal",
            "reference": "finite-element",
            "table": "both-embedded.csv",
        }
        with pytest.raises(InputError, match="is of a pin and a plate of different materials"):
            read_grid(write_toml(tmp_path / "grid.toml", spec))


class TestFirstYield:
    """The closed-form stresses behind `limits.first_yield`, on the line of the load."""

    @pytest.mark.parametrize("name", ["steel in aluminium", "PEEK in steel", "steel in steel"])
    @pytest.mark.parametrize("phi", [0.1, 1.0])
    def test_von_mises_stress_inside_both_bodies(self, name, phi):
        setup = joint(*PAIRS[name])
        pair = setup.pair(DR)
        load = phi * float(pair.E_star) * DR
        (case,) = solve(setup, DR, [load])
        law = laws.Conformal()
        b = np.tan(np.radians(law.contact_angle(load, pair)) / 2)
        pressure = pressure_along(np.atleast_1d(b), float(pair.beta))
        for body, side, kappa, nu in (
            ("plate", -1, float(pair.kolosov[0]), pair.material_i.nu),
            ("pin", 1, None, pair.material_j.nu),
        ):
            depth, found = case.stress_below(body)
            near = depth < 0.5 * R_I
            shape = depth[near] / R_I
            eta = 1j * (shape / (2 - side * shape))[None, :]
            inside = in_pin(eta, pressure) if body == "pin" else in_plate(eta, pressure, kappa)
            expected = equivalent(inside, nu, "von Mises")[0] * load / R_I
            # Cells along the axis have their middles beside it.
            np.testing.assert_allclose(found.von_mises[near], expected, atol=0.015 * expected.max())
            assert found.von_mises[near].max() == pytest.approx(expected.max(), rel=0.012)
