"""The embedded finite elements against Hertz, Johnson, Persson and Michell's series."""

from dataclasses import replace

import numpy as np
import pytest

from cylcontact import InputError, laws, limits
from cylcontact.datasets.finite_element import Setup, solve
from cylcontact.datasets.finite_element.contact import Condensed
from cylcontact.laws.conformal import pressure as persson_pressure
from tests.finite_element_series import PinInRing

SETUP = Setup(hole_radius=2.245, outer_ratio=3.3, E=207e3, nu=0.3)
COARSE = replace(SETUP, cells=8)


@pytest.fixture(scope="module")
def wide():
    """ΔR = 1 mm at 20 and 100 N/mm."""
    return solve(SETUP, 1.0, [20.0, 100.0])


class TestMesh:
    @pytest.mark.parametrize("dR", [0.005, 0.1, 1.5, 2.2])
    def test_cells_fill_both_bodies_and_turn_the_right_way(self, dR):
        mesh = SETUP.mesh(dR, np.array([20.0, 100.0]))
        radii = {"plate": (SETUP.outer_radius, SETUP.hole_radius), "pin": (2.245 - dR, 0.0)}
        for name, (outer, inner) in radii.items():
            body = getattr(mesh, name)
            corners = body.points[body.quads]
            one, other = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
            areas = (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2
            assert areas.min() > 0
            # Straight sides cut a little off the circles.
            assert areas.sum() == pytest.approx(np.pi / 2 * (outer**2 - inner**2), rel=2e-3)

    @pytest.mark.parametrize("dR", [0.005, 1.5])
    def test_inner_sides_belong_to_two_cells_and_outer_ones_to_the_boundary(self, dR):
        mesh = SETUP.mesh(dR, np.array([20.0]))
        for body in (mesh.plate, mesh.pin):
            sides = np.sort(np.stack([body.quads, np.roll(body.quads, -1, axis=1)], -1), axis=-1)
            _, times = np.unique(sides.reshape(-1, 2), axis=0, return_counts=True)
            assert set(times) == {1, 2}
        x, y = mesh.pin.points[mesh.pin.surface].T
        assert np.hypot(x, y - dR) == pytest.approx(2.245 - dR, rel=1e-12)
        assert np.all(mesh.pin.points[mesh.pin.axis, 0] == 0)
        assert np.all(mesh.plate.points[mesh.plate.axis, 0] == 0)

    def test_pairs_stand_on_rays_from_the_holes_centre(self):
        mesh = SETUP.mesh(0.3, np.array([20.0]))
        pairs = mesh.pairs
        hole = mesh.plate.points[mesh.plate.surface[: pairs.count]]
        pin = mesh.pin.points[mesh.pin.surface[: pairs.count]]
        assert hole - pin == pytest.approx(pairs.gap[:, None] * pairs.normals, abs=1e-12)
        assert pairs.length.sum() == pytest.approx(pairs.arc[-1], rel=1e-3)

    def test_a_node_stands_where_the_clamp_ends(self):
        mesh = SETUP.mesh(0.1, np.array([20.0]))
        assert np.sum(mesh.plate.points[mesh.outer, 1] == 0) == 1


class TestContact:
    def test_complementarity(self):
        rng = np.random.default_rng(1)
        roots = rng.normal(size=(40, 40))
        compliance = roots @ roots.T + 40 * np.eye(40)
        cosines = np.linspace(1, 0.5, 40)
        gap = 50 * np.linspace(0, 1, 40) ** 2
        problem = Condensed(compliance, rng.uniform(0, 0.1, 40), cosines, gap)
        forces, depth = problem.touch(8.0)
        gaps = gap + 8 * problem.load_opening + compliance @ forces - depth * cosines
        assert forces.min() >= 0
        assert 0 < np.count_nonzero(forces) < 40
        assert gaps.min() > -1e-9 * depth
        assert np.abs(gaps * forces).max() < 1e-9 * depth
        assert forces @ cosines == pytest.approx(4.0, rel=1e-12)

    def test_a_set_that_does_not_settle_is_told(self):
        many = 60
        problem = Condensed(np.eye(many), np.zeros(many), np.ones(many), np.linspace(0, 9, many))
        with pytest.raises(InputError, match="still changes after 1 rounds"):
            problem.touch(50.0, rounds=1)
        assert problem.touch(50.0)[1] > 0

    def test_contact_up_to_the_last_pair_is_refused(self):
        with pytest.raises(InputError, match="beyond the mesh's pairs; lower the load"):
            solve(COARSE, 0.005, [40_000.0])


class TestHertz:
    def test_peak_pressure_at_1_mm(self, wide):
        case = wide[0]
        hertz = float(limits.hertz_stress(20.0, SETUP.pair(1.0)))
        assert case.peak_pressure == pytest.approx(hertz, rel=0.005)
        assert case.half_width == pytest.approx(
            float(limits.hertz_half_width(20.0, SETUP.pair(1.0))), rel=0.005
        )

    def test_peak_pressure_converges_with_the_mesh(self):
        hertz = float(limits.hertz_stress(20.0, SETUP.pair(1.0)))
        errors = []
        for cells in (4, 8, 16):
            (case,) = solve(replace(SETUP, cells=cells), 1.0, [20.0])
            errors.append(abs(case.peak_pressure / hertz - 1))
        assert errors == sorted(errors, reverse=True)
        assert errors[-1] < 0.0005

    def test_pressure_carries_the_load(self, wide):
        for case in wide:
            pairs = case.mesh.pairs
            along = case.pressure * pairs.length * pairs.normals[:, 1]
            assert 2 * along.sum() == pytest.approx(case.load, rel=1e-9)

    def test_stress_below_the_contact_is_hertz_s(self, wide):
        case = wide[0]
        b, peak = (f(20.0, SETUP.pair(1.0)) for f in (limits.hertz_half_width, limits.hertz_stress))
        for body in ("plate", "pin"):
            depth, stress = case.stress_below(body)
            near = depth < 2 * b
            expected = -peak / np.sqrt(1 + (depth[near] / b) ** 2)
            assert np.count_nonzero(near) > 10
            assert np.all(np.diff(depth) > 0)
            assert stress.yy[near] == pytest.approx(expected, abs=0.01 * peak)
            assert stress.zz == pytest.approx(0.3 * (stress.xx + stress.yy), rel=1e-9, abs=1e-9)


class TestSemiAnalytical:
    @pytest.mark.parametrize("dR", [0.005, 0.01])
    def test_michells_series_in_the_conformal_range(self, dR):
        setup = replace(SETUP, clamp="whole")
        series = PinInRing(setup.hole_radius, dR, setup.outer_radius, (setup.E, setup.nu))
        for case in solve(setup, dR, [20.0, 40.0, 100.0]):
            penetration, _, peak = series.penetration(case.load)
            assert case.penetration == pytest.approx(penetration, rel=0.0015)
            assert case.peak_pressure == pytest.approx(peak, rel=0.0015)

    @pytest.mark.slow
    def test_persson_in_a_large_plate_with_one_constant(self):
        """With a plate 40 times the hole its boundary moves no harmonic but the load's."""
        setup = replace(SETUP, outer_ratio=40.0, clamp="whole")
        loads = [20.0, 100.0]
        cases = [case for dR in (0.01, 0.1, 1.0) for case in solve(setup, dR, loads)]
        persson = laws.Persson()
        E_star = float(setup.pair(1.0).E_star)
        constants = []
        for case in cases:
            theory = float(persson.penetration(case.load, setup.pair(case.dR)))
            constants.append((case.penetration - theory) * np.pi * E_star / case.load)
        for case, constant in zip(cases, constants, strict=True):
            off = (constant - np.mean(constants)) * case.load / (np.pi * E_star)
            assert abs(off) < 0.0015 * case.penetration

    def test_conformal_pressure_is_perssons(self):
        setup = replace(SETUP, outer_ratio=40.0, clamp="whole")
        (case,) = solve(setup, 0.005, [100.0])
        angle = case.arc / np.sqrt(2.245 * 2.24)
        theory = persson_pressure(angle, 100.0, setup.pair(0.005))
        assert case.pressure == pytest.approx(theory, abs=0.02 * theory[0])


class TestSetups:
    def test_penetration_scales_with_load_over_modulus(self):
        (soft,) = solve(COARSE, 0.1, [20.0])
        (stiff,) = solve(replace(COARSE, E=2 * COARSE.E), 0.1, [40.0])
        assert stiff.penetration == pytest.approx(soft.penetration, rel=1e-9)
        assert stiff.peak_pressure == pytest.approx(2 * soft.peak_pressure, rel=1e-9)

    def test_all_lengths_scale(self):
        (small,) = solve(COARSE, 0.1, [20.0])
        (large,) = solve(replace(COARSE, hole_radius=3 * 2.245), 0.3, [60.0])
        assert large.penetration == pytest.approx(3 * small.penetration, rel=1e-9)

    def test_loads_together_or_apart_on_one_mesh(self):
        together = solve(COARSE, 0.1, [20.0, 60.0])[0]
        apart = solve(COARSE, 0.1, [20.0])[0]
        assert apart.penetration == pytest.approx(together.penetration, rel=1e-3)

    def test_plane_stress_is_softer_by_the_moduli(self):
        (strain,) = solve(COARSE, 1.0, [20.0])
        (stress,) = solve(replace(COARSE, plane="stress"), 1.0, [20.0])
        factor = (stress.peak_pressure / strain.peak_pressure) ** 2
        assert factor == pytest.approx(1 - 0.3**2, rel=2e-3)
        assert 1.08 < stress.penetration / strain.penetration < 1.10

    def test_load_on_one_node_grows_with_refinement(self):
        actual = {}
        for load_on in ("pin", "disc", "centre"):
            setups = (replace(SETUP, load_on=load_on, cells=cells) for cells in (8, 16))
            coarse, fine = (solve(setup, 0.1, [20.0])[0].penetration for setup in setups)
            actual[load_on] = (coarse, fine / coarse - 1)
        assert actual["pin"][0] < actual["disc"][0] < actual["centre"][0]
        assert abs(actual["pin"][1]) < 0.003
        assert abs(actual["disc"][1]) < 0.003
        assert actual["centre"][1] > 0.01

    def test_contact_does_not_know_where_the_load_acts(self):
        pressures = [
            solve(replace(COARSE, load_on=where), 0.1, [20.0])[0].peak_pressure
            for where in ("pin", "disc", "centre")
        ]
        assert np.ptp(pressures) < 1e-4 * pressures[0]


class TestBadInput:
    @pytest.mark.parametrize("dR", [0.0, -0.1, 2.245, 3.0])
    def test_clearance_zero_or_larger_than_the_hole(self, dR):
        with pytest.raises(InputError, match=r"must lie between 0 and the radius of the hole"):
            solve(SETUP, dR, [20.0])

    def test_mesh_too_coarse_says_the_size_needed(self):
        setup = replace(SETUP, size=0.01)
        with pytest.raises(InputError) as caught:
            solve(setup, 1.0, [20.0])
        width = float(limits.hertz_half_width(20.0, setup.pair(1.0)))
        assert f"half-width is {width:.3g} mm, and 4 cells must fit into it" in str(caught.value)
        assert f"use {width / 4:.2g} mm or less" in str(caught.value)

    def test_a_size_of_ones_own(self):
        fine, graded = (
            solve(setup, 0.1, [20.0])[0]
            for setup in (replace(SETUP, size=0.004, contact_size=0.006), SETUP)
        )
        assert fine.penetration == pytest.approx(graded.penetration, rel=2e-3)
