"""The finite elements against Hertz, Persson, Michell's series, CalculiX and the reference law."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.calculix import run_case
from cylcontact import InputError, laws, limits
from cylcontact.datasets.finite_element import Setup, solve, solver
from cylcontact.limits.stress import in_pin, in_plate, pressure_along
from cylcontact.limits.yield_search import equivalent
from tests.support.finite_element_series import PinInRing
from tests.support.programs import require_program

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
PAPERS = {"hole_radius": 2.245, "outer_ratio": 3.3, "E": 207e3, "nu": 0.3}
SETUP, COARSE = Setup(**PAPERS), Setup(**PAPERS, cells=8)


def changed(setup, **keys):
    return Setup(**dict(setup) | keys)


def joint(pin, plate, **keys):
    """A set-up; in so wide a plate the law's datum lacks only 0.02 % of the penetration."""
    of_pin = {"pin_E": f"{pin[0]} MPa", "pin_nu": pin[1]}
    of_plate = {"hole_radius": R_I, "outer_ratio": 80.0, "E": f"{plate[0]} MPa", "nu": plate[1]}
    return Setup(**of_plate | of_pin | {"clamp": "rim", "cells": 12} | keys)


def at(setup, phi):
    """The solution at a load over E*ΔR, that load, and the pair."""
    pair = setup.pair(DR)
    load = phi * float(pair.E_star) * DR
    (case,) = solve(setup, DR, [load])
    return case, load, pair


class TestMesh:
    @pytest.mark.parametrize("dR", [0.005, 0.1, 1.5, 2.2])
    def test_cells_fill_both_bodies_without_gaps(self, dR):
        mesh = SETUP.mesh(dR, [20.0, 100.0])
        radii = {"plate": (SETUP.outer_radius, SETUP.hole_radius), "pin": (2.245 - dR, 0.0)}
        for name, (outer, inner) in radii.items():
            body = getattr(mesh, name)
            corners = body.points[body.quads]
            one, other = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
            areas = (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2
            assert areas.min() > 0
            # Straight sides cut a little off the circles.
            assert areas.sum() == pytest.approx(np.pi / 2 * (outer**2 - inner**2), rel=2e-3)
            sides = np.sort(np.stack([body.quads, np.roll(body.quads, -1, axis=1)], -1), axis=-1)
            _, times = np.unique(sides.reshape(-1, 2), axis=0, return_counts=True)
            assert set(times) == {1, 2}
            assert np.all(body.points[body.axis, 0] == 0)
        x, y = mesh.pin.points[mesh.pin.surface].T
        assert np.hypot(x, y - dR) == pytest.approx(2.245 - dR, rel=1e-12)


class TestContact:
    def test_complementarity(self):
        rng = np.random.default_rng(1)
        roots = rng.normal(size=(40, 40))
        compliance = roots @ roots.T + 40 * np.eye(40)
        cosines = np.linspace(1, 0.5, 40)
        gap = 50 * np.linspace(0, 1, 40) ** 2 + rng.uniform(0, 0.8, 40)
        forces, depth = solver.touch(compliance, gap, cosines, 8.0)
        gaps = gap + compliance @ forces - depth * cosines
        assert forces.min() >= 0
        assert 0 < np.count_nonzero(forces) < 40
        assert gaps.min() > -1e-9 * depth
        assert np.abs(gaps * forces).max() < 1e-9 * depth
        assert forces @ cosines == pytest.approx(4.0, rel=1e-12)

    def test_pressure_carries_the_load_wherever_that_acts(self):
        peaks = []
        for load_on in ("pin", "disc", "centre"):
            (case,) = solve(changed(COARSE, load_on=load_on), 0.1, [20.0])
            pairs = case.mesh.pairs
            along = case.pressure * pairs.length * pairs.normals[:, 1]
            assert 2 * along.sum() == pytest.approx(case.load, rel=1e-9)
            peaks.append(case.peak_pressure)
        assert np.ptp(peaks) < 1e-4 * peaks[0]

    @pytest.mark.slow
    def test_cells_of_ones_own_size(self):
        fine, graded = (
            solve(setup, 0.1, [20.0])[0]
            for setup in (changed(SETUP, size=0.004, contact_size=0.006), SETUP)
        )
        assert fine.penetration == pytest.approx(graded.penetration, rel=2e-3)


class TestHertz:
    @pytest.mark.slow
    def test_pressure_converges_with_the_mesh(self):
        hertz = float(limits.hertz_stress(20.0, SETUP.pair(1.0)))
        cases = [solve(changed(SETUP, cells=cells), 1.0, [20.0])[0] for cells in (4, 16)]
        errors = [abs(case.peak_pressure / hertz - 1) for case in cases]
        assert errors == sorted(errors, reverse=True)
        assert errors[-1] < 0.0005
        width = float(limits.hertz_half_width(20.0, SETUP.pair(1.0)))
        assert cases[-1].half_width == pytest.approx(width, rel=0.005)


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_stress_of_a_uniform_strain(plane):
    case, _, _ = at(joint(RUBBER, STEEL, cells=4, plane=plane), 1e-3)
    gradient = np.array([[1e-3, 4e-3], [2e-3, -3e-3]])
    case = replace(
        case, **{of: getattr(case.mesh, of).points @ gradient.T for of in ("plate", "pin")}
    )
    for of, (E, nu) in (("plate", STEEL), ("pin", RUBBER)):
        strain = np.zeros((3, 3))
        strain[:2, :2] = (gradient + gradient.T) / 2
        if plane == "stress":
            strain[2, 2] = -nu / (1 - nu) * np.trace(strain)
        volume = nu / (1 - 2 * nu) * np.trace(strain) * np.eye(3)
        expected = E / (1 + nu) * (strain + volume)
        mises = np.sqrt(1.5) * np.linalg.norm(expected - np.trace(expected) / 3 * np.eye(3))
        stress = case.stress(of)
        for component, (i, j) in {"xx": (0, 0), "yy": (1, 1), "xy": (0, 1), "zz": (2, 2)}.items():
            np.testing.assert_allclose(
                getattr(stress, component), expected[i, j], atol=1e-7 * mises
            )
        np.testing.assert_allclose(stress.von_mises, mises, rtol=1e-7)


def semi_angle(case):
    """Return where p² vanishes, in degrees: a parabola of tan²(θ/2) through the contact's edge."""
    square = np.tan(case.arc / R_I / 2) ** 2
    share = (case.pressure / case.peak_pressure) ** 2
    flank = (share > 0.01) & (share < 0.8)
    roots = np.roots(np.polyfit(square[flank], share[flank], 2))
    return 2 * np.degrees(np.arctan(np.sqrt(roots[roots > 0].min())))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "plane", "phis"),
    [
        *((name, "strain", (0.03, 0.3, 1.0, 3.0)) for name in PAIRS),
        ("steel in aluminium", "stress", (0.03, 1.0)),
    ],
)
def test_penetration_pressure_and_angle_are_the_laws(name, plane, phis):
    """On two meshes, extrapolated, and the angle on one.

    The cells of the second mesh are half as long and the errors go with their square. What is left
    is 0.064 % of the penetration and 0.071 % of the pressure at most, 0.9 % of the angle.
    """
    law = laws.Conformal(datum=laws.Housing(R_o=80 * R_I))
    for phi in phis:
        (first, *_), (second, load, pair) = (
            at(joint(*PAIRS[name], cells=cells, plane=plane), phi) for cells in (6, 12)
        )
        penetration = (4 * second.penetration - first.penetration) / 3
        assert penetration == pytest.approx(float(law.penetration(load, pair)), rel=1e-3, abs=0)
        peak = (4 * second.peak_pressure - first.peak_pressure) / 3
        assert peak == pytest.approx(float(law.peak_pressure(load, pair)), rel=1e-3)
        assert semi_angle(second) == pytest.approx(float(law.contact_angle(load, pair)), rel=0.01)


@pytest.mark.parametrize("dR", [0.01, pytest.param(0.005, marks=pytest.mark.slow)])
def test_michells_series_in_the_conformal_range(dR):
    series = PinInRing(2.245, dR, SETUP.outer_radius, STEEL)
    for case in solve(changed(SETUP, clamp="rim"), dR, [20.0, 40.0, 100.0]):
        penetration, _, peak = series.penetration(case.load)
        assert case.penetration == pytest.approx(penetration, rel=0.0015)
        assert case.peak_pressure == pytest.approx(peak, rel=0.0015)


class TestIncompressible:
    @pytest.mark.parametrize(
        ("pin", "plate"), [(STEEL, ALUMINIUM), (RUBBER, STEEL), (STEEL, RUBBER), (RUBBER, RUBBER)]
    )
    @pytest.mark.slow
    def test_michells_series_in_a_narrow_ring(self, pin, plate):
        case, load, _ = at(joint(pin, plate, cells=16, outer_ratio=3.3), 0.3)
        penetration, _, peak = PinInRing(R_I, DR, 3.3 * R_I, plate, pin).penetration(load)
        assert case.penetration == pytest.approx(penetration, rel=2e-3, abs=0)
        assert case.peak_pressure == pytest.approx(peak, rel=2e-3)


class TestTwoMaterials:
    @pytest.mark.parametrize(
        ("name", "phi"),
        [
            ("steel in aluminium", 1.0),
            *(
                pytest.param(*case, marks=pytest.mark.slow)
                for case in (("steel in aluminium", 0.1), ("PEEK in steel", 0.1),
                             ("PEEK in steel", 1.0))
            ),
        ],
    )  # fmt: skip
    def test_the_closed_stresses_behind_first_yield(self, name, phi):
        case, load, pair = at(joint(*PAIRS[name]), phi)
        b = np.tan(np.radians(laws.Conformal().contact_angle(load, pair)) / 2)
        pressure = pressure_along(np.atleast_1d(b), float(pair.beta))
        for body, side, nu in (("plate", -1, pair.material_i.nu), ("pin", 1, pair.material_j.nu)):
            depth, stress = case.stress_below(body)
            near = depth < 0.5 * R_I
            shape = depth[near] / R_I
            eta = 1j * (shape / (2 - side * shape))[None, :]
            inside = (
                in_pin(eta, pressure)
                if body == "pin"
                else in_plate(eta, pressure, float(pair.kolosov[0]))
            )
            expected = equivalent(inside, nu, "von Mises")[0] * load / R_I
            # Cells along the axis have their middles beside it.
            actual = stress.von_mises[near]
            np.testing.assert_allclose(actual, expected, atol=0.015 * expected.max())
            assert actual.max() == pytest.approx(expected.max(), rel=0.012)


class TestCalculix:
    @pytest.mark.parametrize(
        ("setup", "dR", "load", "rel"),
        [
            (COARSE, 0.01, 100.0, 0.002),
            pytest.param(COARSE, 1.0, 20.0, 0.002, marks=pytest.mark.slow),
            *(
                pytest.param(*case, marks=pytest.mark.slow)
                for case in [
                    (changed(COARSE, plane="stress", load_on="disc", clamp="rim"), 0.01, 40, 0.002),
                    (joint(STEEL, ALUMINIUM, outer_ratio=10.0), DR, 100.0, 0.003),
                    (joint(RUBBER, STEEL, outer_ratio=10.0), DR, 6e-3, 0.003),
                    (joint(STEEL, RUBBER, outer_ratio=10.0), DR, 6e-3, 0.003),
                ]
            ),
        ],
    )
    def test_it_gives_the_same(self, setup, dR, load, rel):
        require_program("ccx")
        (case,) = solve(setup, dR, [load])
        penetration, peak = run_case(setup, dR, load, [load])
        assert penetration == pytest.approx(case.penetration, rel=rel, abs=0)
        assert peak == pytest.approx(case.peak_pressure, rel=0.02)


WIDTH = float(limits.hertz_half_width(20.0, SETUP.pair(1.0)))


@pytest.mark.parametrize(
    ("attempt", "message"),
    [
        *(
            (lambda keys=keys: Setup(**PAPERS | keys), message)
            for keys, message in (
                ({"nu": 0.5}, "nu = 0.5: must not exceed 0.499999 in plane strain: the stiffness"),
                ({"pin_nu": 0.4999999}, "pin_nu = 0.4999999: must not exceed 0.499999 in plane"),
                ({"E": 207.0}, "E = 207.0: a bare number is in MPa"),
                ({"pin_E": 70e9}, "E = 70000000000.0: is beyond any material"),
                (
                    {"clamp": "pulled:5"},
                    "clamp = 'pulled:5': must be a sector, pushed or pulled, of 10 to 350",
                ),
                ({"clamp": "whole"}, "clamp = 'whole': must be 'upper half' or 'rim'"),
                ({"cells": 3}, "cells = 3: must be at least 4"),
            )
        ),
        (lambda: solve(SETUP, 0.0, [20.0]), "must lie between 0 and the radius of the hole"),
        (lambda: solve(SETUP, 2.245, [20.0]), "must lie between 0 and the radius of the hole"),
        (
            lambda: solve(changed(SETUP, size=0.01), 1.0, [20.0]),
            f"half-width is {WIDTH:.3g} mm, and 4 cells must fit into it; use {WIDTH / 4:.2g} mm",
        ),
        (
            lambda: changed(SETUP, size=1e-6, contact_size=1e-6).mesh(0.1, [10.0]),
            "more than 5000 cells lie side by side",
        ),
        (lambda: solve(COARSE, 0.005, [40_000.0]), "beyond the mesh's pairs; lower it"),
    ],
)
def test_what_cannot_be_solved_is_told(attempt, message):
    with pytest.raises(InputError) as caught:
        attempt()
    assert message in str(caught.value)
