"""The law for any pair against printed numbers, closed forms, and a solution by harmonics."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from mpmath import mp

from cylcontact import CylinderPair, Material
from cylcontact.bodies.material import material_in_MPa
from cylcontact.laws import Conformal, Housing, Johnson, Persson
from cylcontact.limits import hertz_stress
from tests.support.strategies import powers_of_ten

LAW = Conformal()
MATERIALS = {
    "steel": Material("steel", 207e3, 0.3),
    "al": Material("aluminium", 70e3, 0.33),
    "bronze": Material("bronze", 110e3, 0.34),
    "PEEK": Material("PEEK", 3.6e3, 0.38),
}
# With E* = 1 MPa and ΔR = 1 mm a load is φ and a penetration is δ/ΔR.
UNIT = material_in_MPa("unit", E=2.0, nu=0.0)
# So large that ΔR = 1 mm is nothing beside it, and R_i = R_j.
R = 2e6


def pair_of(pin, hole, plane="strain", dR=1.0):
    """A pair of named materials with R_i = R_j = R, as the theory takes them."""
    bodies = MATERIALS[hole], MATERIALS[pin]
    return CylinderPair("internal", dR, *bodies, R_i=R, R_j=R, plane=plane)


def pair_of_shares(w_i, g_i, g_j, R_i=R, R_j=R):
    """A pair in plane strain of E* = 1 MPa and ΔR = 1 mm with given shares and g = (κ−1)/(κ+1)."""
    hole, pin = (
        material_in_MPa(name, (1 - nu**2) / share, nu)
        for name, share, nu in (
            ("hole", w_i, (1 - 2 * g_i) / (2 - 2 * g_i)),
            ("pin", 1 - w_i, (1 - 2 * g_j) / (2 - 2 * g_j)),
        )
    )
    return CylinderPair("internal", 1.0, hole, pin, R_i=R_i, R_j=R_j)


load_numbers = powers_of_ten(-12, 8)


# --- printed numbers --------------------------------------------------------------------------

# Pin, hole, plane, φ: ε in degrees, p₀R/f, d by Johnson's datum, C for a body force and the
# harmonic n = 1 of a plate clamped at 20 R, d with it.
CHECKS = [
    ("steel", "steel", "strain", 0.3, 32.31302, 1.177145, 0.283428, 1.055013, 0.395033),
    ("steel", "al", "strain", 0.03, 11.16521, 3.278727, 0.047932, 1.744896, 0.068004),
    ("steel", "al", "strain", 1.0, 50.50110, 0.801989, 0.655212, 1.744896, 1.324271),
    ("al", "steel", "strain", 0.3, 31.98661, 1.191797, 0.292268, 0.355948, 0.313882),
    ("steel", "bronze", "strain", 1.0, 50.30638, 0.805908, 0.674658, 1.470073, 1.225424),
    ("PEEK", "steel", "strain", 1.0, 50.82210, 0.806261, 0.731497, -0.351096, 0.502559),
    ("steel", "al", "stress", 1.0, 51.03590, 0.794401, 0.633257, 1.740290, 1.302118),
]


@pytest.mark.parametrize(("pin", "hole", "plane", "phi", *(f"n{i}" for i in range(5))), CHECKS)
def test_printed_numbers_come_out_to_their_last_digit(pin, hole, plane, phi, n0, n1, n2, n3, n4):
    pair, housing = pair_of(pin, hole, plane), Housing(R_o=20 * R)
    f = phi * pair.E_star
    assert LAW.contact_angle(f, pair) == pytest.approx(n0, abs=5.1e-6)
    assert LAW.peak_pressure(f, pair) * R / f == pytest.approx(n1, abs=5.1e-7)
    assert LAW.penetration(f, pair) == pytest.approx(n2, abs=5.1e-7)
    (kernel,) = housing.kernels(pair)[1]
    assert housing.constant(pair) + 2 * kernel.g[1, 1] == pytest.approx(n3, abs=5.1e-7)
    assert Conformal(n3).penetration(f, pair) == pytest.approx(n4, abs=6e-7)


# --- closed forms at β = 0 --------------------------------------------------------------------


def S_mp(phi, w):
    """S under the load φ at β = 0, by bisection of S·K."""
    low, high = mp.mpf(0), mp.mpf(1)
    for _ in range(200):
        middle = (low + high) / 2
        H = 2 * middle - (1 - middle) ** 2 * mp.log(1 - middle) / middle
        is_below = (1 - middle) ** 2 / middle - w * H > mp.pi / phi
        low, high = (middle, high) if is_below else (low, middle)
    return low


@given(load_numbers, powers_of_ten(-6, 6))
@hypothesis_settings(max_examples=20)
def test_incompressible_bodies_of_any_moduli_are_the_closed_form(phi, ratio):
    """ν = 0.5 makes β zero; π·E*·dδ/df has a closed form of its own."""
    hole, pin = material_in_MPa("hole", 1.0, 0.5), material_in_MPa("pin", ratio, 0.5)
    pair = CylinderPair.from_dR("internal", 1.0, hole, material_j=pin)
    assert pair.beta == 0
    with mp.workdps(60):
        w = mp.mpf(ratio) / (1 + mp.mpf(ratio))
        S = S_mp(mp.mpf(phi), w)
        b2, C = S / (1 - S), 2 * mp.log(2) - 1 - w
        H = 2 * S - (1 - S) ** 2 * mp.log(1 - S) / S
        d = mp.mpf(phi) / mp.pi * (-mp.log(S) + S**2 / 2 + w * H + C)
        slope = -mp.log(S) - 1 + 2 * S - S**2 / 2 + C
        slope += w * (1 + S) ** 2 / (1 + w * (b2 - mp.log(1 + b2)))
        angle = mp.degrees(2 * mp.asin(mp.sqrt(S)))
    f = phi * pair.E_star
    assert LAW.penetration(f, pair) == pytest.approx(float(d), rel=1e-10)
    assert LAW.load(float(d), pair) == pytest.approx(float(f), rel=1e-10)
    assert LAW.contact_angle(f, pair) == pytest.approx(float(angle), rel=1e-10)
    stiffness = float(mp.pi / slope) * pair.E_star
    assert LAW.stiffness(float(d), pair) == pytest.approx(stiffness, rel=1e-8)


@pytest.mark.parametrize("exponent", [-280, -100, -9, -3, -1, 0, 1, 3, 9, 100, 280])
def test_perssons_law_is_right_however_small_or_complete_the_arc(exponent):
    """At hundreds of digits: by u = b² up to the root of N, where the arc is complete."""
    law, unit = Persson(), CylinderPair.from_dR("internal", 1.0, UNIT)
    wide = CylinderPair.from_dR("internal", 1.0, UNIT, R_i=(1 + 5**0.5) / 2)  # √(R_i·R_j) = 1 mm

    def N(u):
        return 2 - 2 * u**2 - mp.log(1 + u)

    with mp.workdps(640):
        t = mp.mpf(10) ** exponent  # u/(U − u)
        u = mp.findroot(N, mp.mpf("0.8346")) * t / (1 + t)
        log, B = mp.log(1 + u), mp.sqrt(1 + u)
        phi = 2 * mp.pi * u * (1 + u) / N(u)
        Z = mp.log(4 * (1 + u) / u) + log / (2 * u * (1 + u)) - 2 / (1 + u) + 1 / (2 * (1 + u) ** 2)
        load_slope = (1 + 2 * u) / (u * (1 + u)) + (4 * u + 1 / (1 + u)) / N(u)
        Z_slope = -1 / (u * (1 + u)) + 2 / (1 + u) ** 2 - 1 / (1 + u) ** 3
        Z_slope += (1 / (1 + u) - log * (1 + 2 * u) / (u * (1 + u))) / (2 * u * (1 + u))
        s = mp.sqrt(u)
        peak = 2 * s / (mp.pi * B) + mp.log((B + s) / (B - s)) / (2 * mp.pi * u * (1 + u))
        exact = [
            phi * Z / mp.pi, phi, mp.pi / (Z + Z_slope / load_slope),
            mp.degrees(2 * mp.atan(s)), phi * peak,
        ]  # fmt: skip
        d, phi, *exact = map(float, exact)
    actual = [
        law.penetration(phi, unit), law.load(d, unit), law.stiffness(d, unit),
        law.contact_angle(phi, unit), law.peak_pressure(phi, wide),
    ]  # fmt: skip
    off = np.abs(np.array(actual) / [d, phi, *exact] - 1)
    assert np.all(off < [1e-10, 1e-10, 1e-8, 1e-11, 1e-11])


# --- an independent solution: Michell's harmonics and straight pieces of pressure ---------------


def influence(pair, nodes, harmonics=200):
    """E* times the gap at the nodes of a unit circle by a hat-shaped pressure at node 0.

    A pressure cos nθ, n ≥ 2, moves a surface by complex potentials: with φ = αz^(n+1),
    ψ = βz^(n−1) the disk by −[κ/(n + 1) + 1/(n − 1)]/(4μ), with φ = αz^(1−n), ψ = βz^(−n−1) the
    plate by [κ/(n − 1) + 1/(n + 1)]/(4μ) outwards; a uniform one by −(κ − 1)/(4μ) and 1/(2μ).
    The harmonic n = 1 is left out: it is a rigid displacement.
    """
    (kappa_i, kappa_j), moduli = pair.kolosov, pair.moduli
    mu_i, mu_j = moduli[0] * (kappa_i + 1) / 8, moduli[1] * (kappa_j + 1) / 8
    n, width = np.arange(nodes * harmonics), 2 * np.pi / nodes
    gap = np.zeros(n.size)
    gap[0] = 1 / (2 * mu_i) + (kappa_j - 1) / (4 * mu_j)
    k = n[2:]
    gap[2:] = (kappa_i / (k - 1) + 1 / (k + 1)) / (4 * mu_i)
    gap[2:] += (kappa_j / (k + 1) + 1 / (k - 1)) / (4 * mu_j)
    hat = width / np.pi * np.sinc(n * width / (2 * np.pi)) ** 2
    hat[0] /= 2
    folded = (gap * hat).reshape(harmonics, nodes).sum(axis=0)
    return np.fft.fft(folded).real * pair.E_star


def solve_arc(pair, part, pieces):
    """φ, L (without the harmonic n = 1) and R·p₀/f for ε = 2π·part, with `pieces` on half an arc.

    The pressure is zero at the edge, where hole and pin still touch; K and L are found with it.
    """
    nodes = round(pieces / part)
    green, width = influence(pair, nodes), 2 * np.pi / nodes
    node, at = np.arange(pieces), np.arange(pieces + 1)
    angle = width * at
    mirrored = np.where(node > 0, green[at[:, None] + node], 0.0)
    carried = np.where(node > 0, 2, 1) * np.cos(angle[:-1]) * width
    carried *= np.sinc(width / (2 * np.pi)) ** 2
    system = np.zeros((pieces + 2, pieces + 2))
    system[:-1, :-2] = green[abs(at[:, None] - node)] + mirrored
    system[:-1, -2], system[:-1, -1] = 1 - np.cos(angle), -np.cos(angle)
    system[-1, :-2] = carried
    solution = np.linalg.solve(system, np.append(np.zeros(pieces + 1), 1.0))
    return np.array([1 / solution[-2], np.pi * solution[-1], solution[0]])


def extrapolated(pair, part):
    """φ, L and R·p₀/f without the errors of first and second order, and how far that is safe."""
    values = [solve_arc(pair, part, pieces) for pieces in (48, 96, 192, 384)]
    ratios = np.diff(values, axis=0)[:-1] / np.diff(values, axis=0)[1:]
    first = [2 * fine - coarse for coarse, fine in pairwise(values)]
    second = [(4 * fine - coarse) / 3 for coarse, fine in pairwise(first)]
    return second[-1], np.abs(second[-1] - first[-1]) + np.abs(second[-1] - second[-2]), ratios


PARTS = (1 / 16, 3 / 16)
NUMERICAL_PAIRS = {
    "steel in aluminium": pair_of("steel", "al"),
    "aluminium in steel": pair_of("al", "steel"),
    "PEEK in steel": pair_of("PEEK", "steel"),
    "steel in PEEK": pair_of("steel", "PEEK"),
    "plane stress": pair_of("steel", "al", "stress"),
    "extreme β": pair_of_shares(0.02, 0.02, 0.49),
    "other extreme β": pair_of_shares(0.98, 0.49, 0.02),
}


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("pair", NUMERICAL_PAIRS.values(), ids=NUMERICAL_PAIRS)
def test_the_solution_by_harmonics_is_the_same(pair, part):
    solution, error, ratios = extrapolated(pair, part)
    np.testing.assert_allclose(ratios, 2.0, atol=0.15)  # first order, by the edge
    assert np.all(error < 4e-5 * solution)
    # Without n = 1 the kernel lacks (1 + β)/2·cos ψ, so L is smaller by C + (1 + β)/2.
    phi, L, peak = solution
    f = phi * pair.E_star
    angle = np.radians(LAW.contact_angle(f, pair))
    shift = LAW.constant(pair) + (1 + pair.beta) / 2
    found = angle, np.pi * LAW.penetration(f, pair) / phi, LAW.peak_pressure(f, pair) * R / f
    # What the error turns out to be: that of the solution by harmonics is a cautious one.
    np.testing.assert_allclose(found, (2 * np.pi * part, L + shift, peak), rtol=2e-6)


# --- limits -----------------------------------------------------------------------------------


@pytest.mark.parametrize(("pin", "hole"), [("steel", "al"), ("al", "steel"), ("PEEK", "steel")])
def test_small_loads_are_those_of_hertz_and_johnson(pin, hole):
    """The departure is of first order in ε, as the 2.5·(256/45π²)·β·√(πφ) of the derivation."""
    pair = pair_of(pin, hole)
    phi = np.array([1e-12, 1e-10, 1e-8, 1e-6])
    f = phi * pair.E_star
    half_width = 2 * np.sqrt(phi / np.pi)
    angle = np.radians(LAW.contact_angle(f, pair))
    assert np.all(np.abs(angle / half_width - 1) < np.sqrt(phi))
    assert np.all(np.abs(LAW.peak_pressure(f, pair) / hertz_stress(f, pair) - 1) < np.sqrt(phi))
    difference = np.pi * (LAW.penetration(f, pair) - Johnson().penetration(f, pair)) / phi
    leading = 2.5 * 256 / (45 * np.pi**2) * pair.beta * np.sqrt(np.pi * phi)
    np.testing.assert_allclose(difference[2:], leading[2:], rtol=0.01)
    assert np.all(np.abs(difference[:2]) < 2e-5)
