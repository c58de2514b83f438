"""The figures of unlike pairs, against a contact and a ring that are solved anew.

Glauert's series is collocated and its moment taken by quadrature, and the ring's equations are
integrated over its radius; no law of the package is called.
"""

import math
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

from cylcontact.laws import ExplicitPair, Parametric
from cylcontact.pair import CylinderPair
from cylcontact.plots.figure import Drawing
from tests.support.drawn_figures import DrawnFigures

# E in GPa and ν.
MATERIALS = {
    "steel": (207.0, 0.30),
    "aluminium": (69.0, 0.33),
    "bronze": (110.0, 0.34),
    "PEEK": (3.6, 0.38),
    "PTFE": (0.5, 0.46),
}
TERMS = 60
ORDERS = 2 * np.arange(TERMS) + 1
# Gauss's rule from 0 to 1.
NODES, WEIGHTS = (np.polynomial.legendre.leggauss(300) + np.array([[1.0], [0.0]])) / 2


def parameters(name: str) -> tuple[float, float, float]:
    """w_i, α and β of "pin in hole", by the compliances (κ + 1)/(8μ)."""
    pin, hole = (MATERIALS[word] for word in name.split(" in "))
    (c_j, g_j), (c_i, g_i) = (
        ((4 - 4 * nu) * (1 + nu) / (4 * E), (1 - 2 * nu) / (2 - 2 * nu)) for E, nu in (pin, hole)
    )
    total = c_i + c_j
    return c_i / total, (c_j - c_i) / total, (c_j * g_j - c_i * g_i) / total


def series(epsilon: float, beta: float) -> tuple[NDArray[np.float64], float, float]:
    """The pressure's coefficients, 2Â and H on the arc of semi-angle ε."""
    b, n = math.tan(epsilon / 2), ORDERS
    v = np.arange(1, TERMS + 1) * np.pi / (2 * TERMS)
    q = 1 + (b * np.cos(v)) ** 2
    system = np.zeros((TERMS + 1, TERMS + 1))
    system[:-1, :-1] = (n / np.sin(v)[:, None] - (2 * b * beta / q)[:, None]) * np.sin(
        np.outer(v, n)
    )
    system[:-1, -1] = -2 * b / (np.pi * q)
    u, weights = np.pi * NODES, 2 * WEIGHTS
    y2 = (b * np.cos(u)) ** 2
    measure = np.pi / 2 * weights * 2 * b * np.sin(u) / (1 + y2)  # dθ
    sines = np.sin(np.outer(u, n))
    system[-1, :-1] = (measure * (1 - y2) / (1 + y2)) @ sines
    right = np.append((1 - beta) * 2 * b / (np.pi * q) * (2 - q) / q, 1.0)
    *a, A = np.linalg.solve(system, right)
    return np.array(a), 2 * A, float((measure @ sines) @ a)


def moment(epsilon: float, beta: float, a: NDArray[np.float64]) -> float:
    """M, by quadrature of the pressure times the kernel of its displacement at θ = 0.

    The substitution tames the logarithm at s = 0 and the root at s = ε.
    """
    t = NODES
    s, slope = epsilon * (1 - (1 - t**2) ** 2), 4 * epsilon * t * (1 - t**2)
    v = np.arccos(np.tan(s / 2) / math.tan(epsilon / 2))
    kernel = -np.cos(s) * np.log(2 * np.sin(s / 2)) + beta * np.sin(s) * (np.pi - s) / 2
    return float(4 * (WEIGHTS * slope * kernel) @ np.sin(np.outer(v, ORDERS)) @ a)


@cache
def johnson_L(phi: float, alpha: float, beta: float) -> float:
    """π·d/φ under the load φ by Johnson's datum."""
    w_i, w_j = (1 - alpha) / 2, (1 + alpha) / 2

    def K(epsilon: float) -> float:
        _, two_A, H = series(epsilon, beta)
        return two_A - w_i * H

    last = 0.2
    while K(last) > math.pi / phi:
        last += 0.2
    epsilon = brentq(lambda e: K(e) - math.pi / phi, 1e-3, last, xtol=1e-13)
    a, _, H = series(epsilon, beta)
    return moment(epsilon, beta, a) - w_j * H + 2 * math.log(2) - 2 + w_j


def error(phi: float, alpha: float, beta: float) -> float:
    """Percent that the penetration of equal bodies is too large by."""
    return 100 * (johnson_L(phi, 0.0, 0.0) / johnson_L(phi, alpha, beta) - 1)


@cache
def ring(rho: float, nu: float, n: int) -> float:
    """Radial displacement, times the shear modulus, of a ring clamped at ρ under cos nθ inside."""
    stiff = (2 - 2 * nu) / (1 - 2 * nu)  # (λ + 2μ)/μ in plane strain
    lam = stiff - 2

    def slopes(r, z):
        u, v, sigma, tau = z
        hoop = (u + n * v) / r
        u_slope = (sigma - lam * hoop) / stiff
        across = lam * u_slope + stiff * hoop
        return np.array([
            u_slope,
            tau + (v + n * u) / r,
            (across - sigma - n * tau) / r,
            (n * across - 2 * tau) / r,
        ])  # fmt: skip

    def ends(inside, outside):
        return np.array([inside[2] + 1, inside[3], outside[0], outside[1]])

    r = np.geomspace(1, rho, 200)
    solution = solve_bvp(slopes, ends, r, np.zeros((4, r.size)), tol=1e-9, max_nodes=100_000)
    assert solution.success
    return float(solution.sol(1.0)[0])


def share_of_pin_and_ring(name: str, rho: float) -> float:
    """C: displacements of the harmonic n = 1, less the (1 + β)/2 that the kernel has of it."""
    pin, hole = (MATERIALS[word] for word in name.split(" in "))
    w_i, _, beta = parameters(name)
    kappa_i, kappa_j = (3 - 4 * nu for _, nu in (hole, pin))
    # E*/μ is 8w/(κ + 1). A disk under a uniform force gives way by E*/(4(λ + μ)).
    plate = 8 * w_i / (kappa_i + 1) * ring(rho, hole[1], 1)
    disk = 8 * (1 - w_i) / (kappa_j + 1) * (1 - 2 * pin[1]) / 4
    return plate + disk - (1 + beta) / 2


@pytest.fixture(scope="module")
def datum(figures: DrawnFigures) -> Drawing:
    return figures["fig_datum"].drawing


@pytest.fixture(scope="module")
def unlike(figures: DrawnFigures) -> Drawing:
    return figures["fig_unlike"].drawing


@pytest.fixture(scope="module")
def any_pair(figures: DrawnFigures) -> Drawing:
    return figures["fig_any_pair"].drawing


class TestDatum:
    @pytest.mark.slow
    def test_constants_are_those_of_a_ring_and_a_disk(self, datum: Drawing) -> None:
        """With all the harmonics that a point load has in a ring beside an infinite plate."""
        for name, rows in datum.table.groupby("pair"):
            w_i, *_ = parameters(name)
            _, nu = MATERIALS[name.split(" in ")[1]]
            kappa = 3 - 4 * nu
            for row in rows.iloc[[6, 20, -1]].itertuples():
                lack = (ring(row.ratio, nu, 0) - 1 / 2) / 2
                for n in range(2, 14):
                    lack += ring(row.ratio, nu, n) - (kappa / (n - 1) + 1 / (n + 1)) / 4
                one = share_of_pin_and_ring(name, row.ratio)
                exact = one + 8 * w_i / (kappa + 1) * lack
                assert row.constant == pytest.approx(exact, abs=1e-5)
                assert row.johnson_constant == pytest.approx(2 * math.log(2) - 1 - w_i, abs=1e-12)

    def test_headline_is_between_its_neighbours(self, datum: Drawing) -> None:
        for name, rows in datum.table.groupby("pair"):
            for key, column in (("C", "constant"), ("added at φ = 1, %", "added_at_phi_1_percent")):
                said = datum.headline[f"{name}, R_o/R_i = 20: {key}"]
                assert said == pytest.approx(np.interp(20, rows["ratio"], rows[column]), rel=1e-2)


class TestUnlike:
    @pytest.mark.slow
    @pytest.mark.parametrize("phi", [0.01, 1.0, 10.0])
    def test_named_pairs(self, unlike: Drawing, phi: float) -> None:
        rows = unlike.table[unlike.table["pair"].str.contains(" in ")]
        assert rows["pair"].nunique() == 7
        for row in rows[rows["phi"] == phi].itertuples():
            _, alpha, beta = parameters(row.pair)
            assert (row.alpha, row.beta) == pytest.approx((alpha, beta), abs=1e-8)
            assert row.error_percent == pytest.approx(error(phi, alpha, beta), abs=1e-4)
            if phi == 1.0:
                assert unlike.headline[f"{row.pair}, φ = 1, %"] == row.error_percent

    @pytest.mark.parametrize("pair", ["any, nu = 0.3", "any"])
    def test_maps(self, unlike: Drawing, pair: str) -> None:
        rows = unlike.table[unlike.table["pair"] == pair]
        for row in rows.iloc[:: len(rows) // 12].itertuples():
            assert row.error_percent == pytest.approx(error(row.phi, row.alpha, row.beta), abs=1e-4)

    def test_the_maps_cover_what_is_possible(self, unlike: Drawing) -> None:
        loads, plane = (
            unlike.table[unlike.table["pair"] == pair] for pair in ("any, nu = 0.3", "any")
        )
        np.testing.assert_allclose(loads["beta"], loads["alpha"] * 2 / 7, atol=1e-8)
        assert (plane["phi"] == 1).all()
        for beta, rows in plane.groupby("beta"):
            low, high = rows["alpha"].min(), rows["alpha"].max()
            # β is least at −w_i/2 and largest at w_j/2, with w_i = (1 − α)/2.
            assert low == pytest.approx(max(-1, 4 * beta - 1), abs=1e-7)
            assert high == pytest.approx(min(1, 4 * beta + 1), abs=1e-7)

    def test_equal_bodies_are_not_wrong(self, unlike: Drawing) -> None:
        """α = 0 alone is not enough: at φ = 1 the line of no error goes through β = 0 there."""
        rows = unlike.table[unlike.table["alpha"] == 0]
        assert (rows.loc[rows["beta"] == 0, "error_percent"] == 0).all()
        assert (rows.loc[rows["beta"] != 0, "error_percent"].abs() > 0.5).all()


class TestAnyPair:
    @pytest.mark.parametrize("law", [Parametric(), ExplicitPair()], ids=lambda law: law.name)
    def test_errors(self, any_pair: Drawing, law: Parametric | ExplicitPair) -> None:
        rows = any_pair.table[(any_pair.table["law"] == law.name) & any_pair.table["phi"].gt(0.01)]
        for row in rows.iloc[:: len(rows) // 12].itertuples():
            d = row.phi / math.pi * johnson_L(row.phi, row.alpha, row.beta)
            load = law.load(d, CylinderPair.from_dundurs(row.alpha, row.beta))
            assert row.error_percent == pytest.approx(100 * (load / row.phi - 1), abs=1e-3)

    def test_what_the_docstrings_say(self, any_pair: Drawing) -> None:
        assert any_pair.headline["parametric: largest error of the load, %"] < 0.06
        assert any_pair.headline["explicit-pair: largest error of the load, %"] < 1.1
