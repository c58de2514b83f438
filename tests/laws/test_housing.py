"""Housings against closed forms, finite elements, quadrature and printed numbers."""

import numpy as np
import pytest

from benchmarks.calculix import run_case
from cylcontact import CylinderPair, Material
from cylcontact.bodies.material import material_in_MPa
from cylcontact.datasets.finite_element import Setup, solve
from cylcontact.datasets.finite_element.solver import clamped_nodes
from cylcontact.laws import Conformal, Housing, Sector
from cylcontact.laws.conformal.series import glauert
from tests.support.programs import require_program
from tests.support.ring_elements import RingOfElements

STEEL, AL = Material("steel", 207e3, 0.3), Material("aluminium", 70e3, 0.33)
PEEK, BRONZE = Material("PEEK", 3.6e3, 0.38), Material("bronze", 110e3, 0.34)
PAIRS = {
    "steel in steel": (STEEL, STEEL),
    "steel in aluminium": (STEEL, AL),
    "steel in PEEK": (STEEL, PEEK),
    "PEEK in steel": (PEEK, STEEL),
}
CLAMPS = {
    "full": "rim",
    "near180": Sector(180, "pushed"),
    "near60": Sector(60, "pushed"),
    "far180": Sector(180, "pulled"),
    "far60": Sector(60, "pulled"),
    "far120": Sector(120, "pulled"),
}


def pair_of(name="steel in steel", plane="strain", R_i=10.0, dR=0.01):
    pin, hole = PAIRS[name]
    return CylinderPair("internal", dR, hole, pin, R_i=R_i, R_j=R_i - dR, plane=plane)


def in_rigid_pin(hole):
    """A pair with w_i = 1: the pin is rigid, and the hole's radius is 1."""
    return CylinderPair("internal", 0.01, hole, material_in_MPa("rigid", 1e22, 0.3), 1.0, 0.99)


def of_kappa(kappa):
    """The same with Kolosov's κ of the hole."""
    return in_rigid_pin(Material("hole", 1e4, (3 - kappa) / 4))


def kernel_of(housing, pair):
    (kernel,) = housing.kernels(pair)[1]
    return kernel


# --- the coefficients ---------------------------------------------------------------------------


@pytest.mark.parametrize("kappa", [1.0, 1.48, 1.8, 2.077, 3.0])
@pytest.mark.parametrize("rho", [1.1, 1.3, 2.0, 5.0, 20.0])
def test_a_clamped_rim_has_the_closed_coefficients(kappa, rho):
    g = np.diag(kernel_of(Housing(rho), of_kappa(kappa)).g)
    Q = rho**2
    assert g[0] == pytest.approx(-1 / (2 + (kappa - 1) * Q), abs=1e-12)
    A = -(1 + (kappa - 1) / (2 * Q)) / (2 * (kappa * Q + 1 / Q))
    U = (kappa + 1) / 4 + kappa * np.log(rho) + A * (kappa - 1 + 2 * Q)
    assert 2 * g[1] == pytest.approx(4 * U / (kappa + 1) ** 2 - 1 / (kappa + 1), abs=1e-12)
    n = np.arange(2.0, len(g))
    Z = Q**n
    top = Z * ((n + 1) * (kappa * Q) ** 2 - n * (n - 1)) + 2 * kappa * n * Q
    top += Z * (n**2 - 1) * (n * (Q - 1) ** 2 + Q**2)
    base = kappa * Q * (Z**2 + 1) + Z * ((kappa * Q) ** 2 + 1 + (n**2 - 1) * (Q - 1) ** 2)
    np.testing.assert_allclose(g[2:], -top / base / (n**2 - 1), atol=1e-12)


# h over w_i for κ = 1.8, printed.
RATIOS = (1.3, 1.5, 2, 3, 5, 10, 20)
PRINTED = {
    "full": (-3.539, -2.562, -1.284, -0.122, 0.846, 1.737, 2.444),
    "near180": (-3.539, -2.562, -1.283, -0.096, 0.956, 2.005, 2.849),
    "near60": (-3.539, -2.559, -1.247, 0.049, 1.284, 2.552, 3.539),
    "far180": (43.84, 17.36, 6.775, 3.764, 2.923, 2.918, 3.297),
    "far120": (91.77, 31.69, 10.358, 5.020, 3.494, 3.211, 3.495),
    "far60": (191.1, 61.86, 18.138, 7.851, 5.002, 4.245, 4.366),
}


@pytest.mark.parametrize("clamp", PRINTED)
def test_small_loads_have_the_printed_constants(clamp):
    pair = of_kappa(1.8)
    h = [kernel_of(Housing(rho, CLAMPS[clamp]), pair).h for rho in RATIOS]
    np.testing.assert_allclose(h, PRINTED[clamp], rtol=7e-4, atol=6e-4)


def ring_by_elements(radii, materials, clamp, count, cells=10):
    """U_nm = 2μu_r of the bore for cos nθ under p = cos mθ, μ that of the innermost ring."""
    ring = RingOfElements(radii, materials, clamp, cells)
    loads = np.array([ring.pressed(lambda theta, n=n: np.cos(n * theta)) for n in range(count)])
    moved = np.array([ring.moved(load) for load in loads])
    share = np.where(np.arange(count) == 0, np.pi, np.pi / 2)  # of ∫cos² over half the bore
    mu = materials[0].E / (2 * (1 + materials[0].nu))
    return 2 * mu * (loads @ moved.T) / share[:, None]


def theory_of_ring(radii, materials, clamp, count):
    """The same from the kernel: the plate's part added again."""
    pair = in_rigid_pin(materials[0])
    layers = list(zip(materials[1:], radii[1:-1], strict=True))
    g = kernel_of(Housing(radii[-1], clamp, layers=layers), pair).g[:count, :count]
    kappa, n = float(pair.kolosov[0]), np.arange(count)
    plate = (kappa / np.maximum(n - 1, 1) + 1 / (n + 1)) / 2
    plate[:2] = 1, 0.25
    return g * np.where(n == 0, 2, 1) * (kappa + 1) / 2 + np.diag(plate)


RINGS = [([1.0, rho], [STEEL], CLAMPS[clamp]) for rho, clamp in [(2.0, "far60"), (1.3, "far180")]]
RINGS += [([1.0, 2.0], [PEEK], Sector(60, "pushed"))]
BUSHES = [
    ([1.0, 1.2, 2.0], [BRONZE, STEEL], "rim"),
    ([1.0, 1.5, 1.8, 3.0], [AL, PEEK, STEEL], "rim"),
    ([1.0, 1.2, 2.0], [BRONZE, STEEL], Sector(60, "pulled")),
    ([1.0, 1.2, 1.7], [STEEL, AL], Sector(120, "pushed")),
]


@pytest.mark.parametrize(("radii", "materials", "clamp"), RINGS + BUSHES)
def test_sectors_and_bonded_rings_are_those_of_finite_elements(radii, materials, clamp):
    elements = ring_by_elements(radii, materials, clamp, 7, cells=12)
    theory = theory_of_ring(radii, materials, clamp, 7)
    np.testing.assert_allclose(elements, theory, rtol=0, atol=5e-4 * np.abs(theory).max())


# --- the law ------------------------------------------------------------------------------------


def L_by_quadrature(b, beta, w_j, C, g):
    """L of an arc from the pressure: the gap at θ = 0 by the kernel itself."""
    solution = glauert(np.array([b]), beta, 96, g)
    t, weights = (np.polynomial.legendre.leggauss(600) + np.array([[1.0], [0.0]])) / 2
    v = np.pi / 2 * (1 - t**4)  # s = 0 at t = 0, where the kernel has a logarithm
    weights = weights * 2 * np.pi * t**3
    sines = np.sin(np.outer(v, 2 * np.arange(96) + 1))
    y = b * np.cos(v)
    p = (sines @ solution.coefficients[0]) * weights * 2 * b * np.sin(v) / (1 + y**2)
    s = 2 * np.arctan(y)
    kernel = -np.cos(s) * np.log(2 * np.sin(s / 2)) + beta * np.sin(s) * (np.pi - s) / 2
    P = 2 * np.cos(np.outer(np.arange(len(g)), s)) @ p
    return 2 * (2 * p @ kernel) - w_j * P[0] + C + 2 * np.sum(g @ P)


@pytest.mark.parametrize(
    ("name", "rho", "clamp"),
    [
        ("steel in steel", 1.3, "full"),
        ("steel in aluminium", 2.0, "near60"),
        ("PEEK in steel", 1.5, "far180"),
        ("steel in PEEK", 1.5, "far60"),
    ],
)
@pytest.mark.parametrize("phi", [0.01, 0.3, 3.0])
def test_the_approach_by_reciprocity_is_that_of_the_kernel(name, rho, clamp, phi):
    pair, housing = pair_of(name), Housing(10 * rho, CLAMPS[clamp])
    law, f = Conformal(housing), phi * pair.E_star * 0.01
    b = np.tan(np.radians(law.contact_angle(f, pair)) / 2)
    C, g = float(housing.constant(pair)), kernel_of(housing, pair).g
    L = L_by_quadrature(float(b), float(pair.beta), float(pair.shares[1]), C, g)
    assert np.pi * law.penetration(f, pair) / (phi * 0.01) == pytest.approx(L, rel=1e-8)


def test_the_law_ends_where_the_pin_would_leave_the_eye_in_the_middle():
    pair, law = pair_of("steel in aluminium"), Conformal(Housing(13.0, Sector(300, "pulled")))
    end = law.max_load(pair)
    assert 1 < end / (pair.E_star * 0.01) < 10
    assert law.penetration(end * (1 - 1e-9), pair) == pytest.approx(law.max_penetration(pair))
    for answer in (law.penetration, law.contact_angle, law.peak_pressure):
        values = answer(end * np.array([1 - 1e-9, 1 + 1e-9]), pair)
        np.testing.assert_array_equal(np.isnan(values), [False, True])
    assert Conformal(Housing(20.0)).max_load(pair) == np.inf


def test_own_compliances_are_a_housing(tmp_path):
    pair, housing = pair_of(), Housing(20.0, Sector(60, "pulled"))
    g = kernel_of(housing, pair).g
    path = tmp_path / "g.csv"
    np.savetxt(path, g, delimiter=",")
    f = np.geomspace(1e-3, 5, 5) * pair.E_star * 0.01
    expected = Conformal(housing).penetration(f, pair)
    for own in (g, path, str(path)):
        law = Conformal(Housing.from_compliances(own))
        np.testing.assert_allclose(law.penetration(f, pair), expected, rtol=1e-10)
    rim = np.diag(kernel_of(Housing(20.0), pair).g)
    law = Conformal(Housing.from_compliances(rim))
    expected = Conformal(Housing(20.0)).penetration(f, pair)
    np.testing.assert_allclose(law.penetration(f, pair), expected, rtol=1e-10)


# --- contact finite elements --------------------------------------------------------------------


def setup_of(name, rho, clamp, plane, phi, cells):
    """Finite elements, their pair, loads, and the law in the same housing."""
    pin, hole = PAIRS[name]
    where = CLAMPS[clamp]
    bodies = {"E": hole.E, "nu": hole.nu, "pin_E": pin.E, "pin_nu": pin.nu, "plane": plane}
    setup = Setup(hole_radius=10.0, outer_ratio=rho, clamp=where, cells=cells, **bodies)
    pair = setup.pair(0.001)
    f = np.asarray(phi) * float(pair.E_star) * 0.001
    if clamp != "full":  # the sector that the nodes have
        mesh = setup.mesh(0.001, f)
        x, y = mesh.plate.points[clamped_nodes(setup, mesh)].T
        side, theta = where.side, np.degrees(np.arctan2(x, y))
        half = theta.max() if side == "pushed" else 180 - theta.min()
        where = Sector(2 * half, side)
    return setup, pair, f, Conformal(Housing(10 * rho, where))


def of_elements(name, rho, clamp, plane, phi, cells):
    """Percent by which penetration and largest pressure of elements exceed the law's, by φ."""
    setup, pair, f, law = setup_of(name, rho, clamp, plane, phi, cells)
    found = [[case.penetration, case.pressure.max()] for case in solve(setup, 0.001, f)]
    theory = np.stack([law.penetration(f, pair), law.peak_pressure(f, pair)], axis=1)
    return 100 * (np.array(found) / theory - 1)


@pytest.mark.parametrize(
    ("name", "rho", "clamp", "plane"),
    [
        ("steel in aluminium", 1.5, "full", "stress"),
        ("PEEK in steel", 1.3, "near180", "strain"),
        pytest.param("steel in steel", 2.0, "far180", "strain", marks=pytest.mark.slow),
    ],
)
def test_contact_by_elements_is_the_same(name, rho, clamp, plane):
    coarse, fine = (of_elements(name, rho, clamp, plane, [0.1, 1.0], n) for n in (10, 20))
    better = (4 * fine - coarse) / 3
    assert np.abs(better[:, 0]).max() < 0.15
    assert np.abs(fine[:, 1]).max() < 0.3


@pytest.mark.slow
@pytest.mark.parametrize(("rho", "clamp"), [(2.0, "full"), (1.5, "near180")])
def test_contact_by_calculix_is_the_same(rho, clamp):
    require_program("ccx")
    away = []
    for cells in (10, 20):
        setup, pair, f, law = setup_of("steel in aluminium", rho, clamp, "strain", [0.3], cells)
        penetration, _ = run_case(setup, 0.001, float(f[0]), f)
        away.append(100 * (penetration / float(law.penetration(f[0], pair)) - 1))
    assert abs(2 * away[1] - away[0]) < 0.15  # its contact of nodes with faces is of first order
    assert abs(away[1]) < 0.5
