"""The stresses inside a pin and a plate, against Michell's series and the equations themselves."""

from itertools import product

import numpy as np
import pytest

from cylcontact.laws.conformal import persson_pressure
from cylcontact.laws.conformal.series import glauert
from cylcontact.limits.stress import in_pin, in_plate, pressure_along
from cylcontact.limits.yield_search import FirstYield, equivalent

# Arcs, β and κ of the plate: equal bodies, a soft pin, a stiff pin.
CASES = [
    (b, beta, kappa) for b in (0.1, 0.5, 0.9) for beta, kappa in ((0, 1.8), (0.3, 2), (-0.2, 1.1))
]
ORDERS = np.arange(2, 300)
CRITERIA = ("von Mises", "Tresca")
bodies = pytest.mark.parametrize("body", ["pin", "plate"])
cases = pytest.mark.parametrize(("b", "beta", "kappa"), CASES)


def at(z, body):
    """The η of a point z of a body."""
    w = z if body == "pin" else 1 / z
    eta = 1j * (1 - w) / (1 + w)
    return eta.real + 1j * np.maximum(eta.imag, 0)  # rounding may leave the half plane


def stresses(z, body, b, beta, kappa):
    """σ_rr, σ_θθ and σ_rθ at points z, shape (points,)."""
    pressure = pressure_along(np.array([b]), beta)
    eta = at(np.asarray(z, dtype=complex), body)[None]
    total, difference = in_pin(eta, pressure) if body == "pin" else in_plate(eta, pressure, kappa)
    hoop = (total + difference.real) / 2
    return (total - hoop)[0], hoop[0], difference.imag[0] / 2


def pressure_on(theta, b, beta):
    """The pressure on the arc from its series (β ≠ 0) or from Persson's formula."""
    y = np.tan(theta / 2)
    if beta == 0:
        return persson_pressure(y, np.float64(b**2))
    a = glauert(np.array([b]), beta).coefficients[0]
    v = np.arccos(np.clip(y / b, -1, 1))
    return np.sin(np.outer(v, 2 * np.arange(a.size) + 1)) @ a


def fourier(b, beta):
    """p₀ and pₙ, n = 2, 3, …, by the midpoint rule in v."""
    v = (np.arange(2000) + 0.5) * np.pi / 2000
    y = b * np.cos(v)
    theta = 2 * np.arctan(y)
    p = pressure_on(theta, b, beta) * np.pi / 2000 * 2 * b * np.sin(v) / (1 + y**2)
    return p.sum() / (2 * np.pi), np.cos(np.outer(ORDERS, theta)) @ p / (2 * np.pi)


def michell(z, body, b, beta, kappa):
    """The same stresses by Michell's stress function, a 2×2 system for each cos nθ."""
    p0, pn = fourier(b, beta)
    r, theta, n = np.abs(z), np.angle(z), ORDERS[:, None]
    sign = 1 if body == "pin" else -1  # exponents n, n + 2 or −n, 2 − n
    first, second = sign * n, sign * n + 2

    def of(power):  # σ_rr and σ_θθ over cos nθ, σ_rθ over sin nθ, of r^power·cos nθ
        field = r ** (power - 2)
        return (
            np.stack([power - n**2 + 0 * r, power * (power - 1) + 0 * r, n * (power - 1) + 0 * r])
            * field
        )

    rim = np.array([[(first - n**2), (second - n**2)], [n * (first - 1), n * (second - 1)]])[..., 0]
    A, B = np.linalg.solve(
        np.moveaxis(rim, -1, 0), np.stack([-2 * pn, 0 * pn], axis=-1)[..., None]
    )[..., 0].T
    parts = A[:, None] * of(first) + B[:, None] * of(second)
    rr, hoop, shear = parts[0], parts[1], parts[2]
    rr, hoop = ((part * np.cos(n * theta)).sum(axis=0) for part in (rr, hoop))
    shear = (shear * np.sin(n * theta)).sum(axis=0)
    cosine, sine = np.cos(theta), np.sin(theta)
    if body == "pin":  # an even body force, in equilibrium with −x/π in all directions
        return rr - p0 - r * cosine / np.pi, hoop - p0 - r * cosine / np.pi, shear
    # C·rθ·sin θ + D·r·ln r·cos θ + A/r·cos θ with single-valued displacements
    C = -1 / (2 * np.pi)
    D = -C * (kappa - 1) / (kappa + 1)
    rr = rr - p0 / r**2 + ((2 * C + D) / r - D / r**3) * cosine
    return rr, hoop + p0 / r**2 + (D / r + D / r**3) * cosine, shear + (D / r - D / r**3) * sine


@bodies
@cases
def test_stresses_are_those_of_michell_s_series(body, b, beta, kappa):
    depth, theta = np.array([0.05, 0.1, 0.3, 0.6, 0.9]), np.array([0.0, 0.3, 1.0, 2.0, np.pi])
    r = 1 - depth if body == "pin" else 1 / (1 - depth)
    z = (r[:, None] * np.exp(1j * theta)).ravel()
    found = stresses(z, body, b, beta, kappa)
    for mine, series in zip(found, michell(z, body, b, beta, kappa), strict=True):
        assert mine == pytest.approx(series, abs=2e-8)


# ν and κ; the last two are sheets in plane stress, with ν = 1/3 and 1/2.
KINDS = [(0.0, 3.0), (0.15, 2.4), (0.3, 1.8), (0.45, 1.2), (0.0, 2.0), (0.0, 5 / 3)]


@pytest.mark.parametrize("beta", [-0.25, 0.0, 0.25])
@bodies
def test_the_largest_equivalent_stress_of_a_body_lies_on_the_axis(body, beta):
    """On a grid over the whole body, for arcs up to 120° (β = 0) or the limit of that β."""
    degrees = (2, 20, 40, 60, 80, *((100, 120) if beta == 0 else ()))
    for angle, (nu, kappa) in product(np.radians(degrees), KINDS):
        pressure = pressure_along(np.array([np.tan(angle / 2)]), beta)
        off = np.concatenate([np.linspace(0.02, 1.5, 30) * angle, np.linspace(0.1, 3.1, 20)])
        off = off[(off < np.pi) & (np.abs(off - angle) > 1e-3)]
        depth = np.concatenate([[0], np.geomspace(0.02, 2.5, 60) * np.sin(angle)])
        depth = np.concatenate([depth, np.linspace(0.05, 1.95 if body == "pin" else 10, 80)])

        def along(depth, turns, nu=nu, kappa=kappa, pressure=pressure):
            r = 1 - depth if body == "pin" else 1 + depth
            eta = at((r[:, None] * np.exp(1j * turns)).ravel(), body)[None]
            stress = in_pin(eta, pressure) if body == "pin" else in_plate(eta, pressure, kappa)
            return np.array([equivalent(stress, nu, each).max() for each in CRITERIA])

        everywhere = along(depth[depth < 0.99] if body == "pin" else depth, off)
        assert (everywhere <= 1.0005 * along(np.unique(depth), np.zeros(1))).all()


@pytest.mark.parametrize("beta", [0.0, 0.2])
def test_at_the_centre_of_the_pin_the_stresses_are_those_beside_it(beta):
    radial, hoop, shear = stresses([0.0, 0.004, -0.004, 0.004j], "pin", 0.3, beta, 2.0)
    for each in (radial, hoop):
        assert each[0] == pytest.approx((each[1] + each[2]) / 2, rel=1e-4)
    assert shear[0] == pytest.approx(0.0, abs=1e-3 * abs(hoop[0]))


@pytest.mark.parametrize(("angle", "words"), [(0.2, "surface)"), (31.7, "surface, 32° from the")])
def test_a_place_beside_the_load_line_is_told(angle, words):
    at = FirstYield(np.float64(1234.5), np.str_("hole"), np.float64(0.0), "von Mises", angle)
    assert words in str(at)
    assert str(at).startswith("1,234 N/mm (von Mises, in the hole, at its surface")
