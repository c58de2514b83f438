"""Johnson's load from the penetration, against the usual ways to solve for it and a bare power."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

import numpy as np
from numba import njit
from scipy.optimize import brentq, newton
from scipy.special import lambertw

from benchmarks.harness import Row, Side, compare, require_agreement
from cylcontact import CylinderPair, Material, laws
from cylcontact.laws.conformal.curve import make
from cylcontact.laws.kernels import kernel, kernel_load

PAIR = CylinderPair.internal(R_i=10.0, R_j=9.5, material=Material("steel", E=207e3, nu=0.3))
JOHNSON, ENHANCED, EXPLICIT = laws.Johnson(), laws.Enhanced(), laws.Explicit()
CONFORMAL, HOUSED = laws.Conformal(), laws.Conformal(laws.Housing(R_o=20.0))
THIN_EYE = laws.Conformal(laws.Housing(13.0, laws.Sector(60, "far")))
E_STAR, DR = float(PAIR.E_star), float(PAIR.dR)
K, N = float(ENHANCED.factor(PAIR)), float(ENHANCED.exponent(PAIR))
# scipy's Lambert function loses digits near the limit, so the comparison stops before it.
LARGEST = 0.99 * float(JOHNSON.max_penetration(PAIR))
TOLERANCE = 1e-9


def measure(short: bool) -> Iterator[list[Row]]:
    """Yield the cost of a value in arrays, in compiled code, and called one at a time."""
    rng = np.random.default_rng(1)
    deltas = LARGEST * 10 ** rng.uniform(-6, 0, 1_000 if short else 1_000_000)
    yield _in_arrays(deltas, 1 if short else 9)
    deltas = LARGEST * 10 ** rng.uniform(-6, 0, 200 if short else 20_000)
    yield _in_compiled_code(deltas, 1 if short else 15)
    yield _one_at_a_time(deltas[:200], 1 if short else 5)
    yield _curves(1 if short else 9)


def _in_arrays(deltas: np.ndarray, rounds: int) -> list[Row]:
    loads = CONFORMAL.load(deltas, PAIR)
    sides = [
        Side("cylcontact: Johnson().load", lambda: JOHNSON.load(deltas, PAIR)),
        Side("scipy.special.lambertw", lambda: _by_lambertw(deltas)),
        Side("scipy.optimize.newton, whole array", lambda: _by_newton(deltas)),
    ]
    limits = [
        Side("numpy.power alone", lambda: np.power(deltas, N)),
        Side("cylcontact: Enhanced().load", lambda: ENHANCED.load(deltas, PAIR)),
        Side("numpy.log alone", lambda: np.log(deltas)),
        *(
            Side(f"cylcontact: {type(law).__name__}().load", partial(law.load, deltas, PAIR))
            for law in (EXPLICIT, CONFORMAL)
        ),
        Side("cylcontact: the same in a housing", partial(HOUSED.load, deltas, PAIR)),
        Side("cylcontact: Conformal().penetration", partial(CONFORMAL.penetration, loads, PAIR)),
        Side(
            "cylcontact: Conformal().peak_pressure", partial(CONFORMAL.peak_pressure, loads, PAIR)
        ),
    ]
    return _rows("array", deltas, sides, limits, rounds)


def _in_compiled_code(deltas: np.ndarray, rounds: int) -> list[Row]:
    johnson = kernel(JOHNSON, PAIR)
    sides = [
        Side(
            "cylcontact: kernel_load, Johnson",
            lambda: _sum_of_kernel(johnson.kind, johnson.parameters, deltas),
        ),
        Side("Newton's method in numba", lambda: _sum_by_newton(deltas, E_STAR, DR)),
    ]
    limits = [
        *(
            Side(
                f"cylcontact: kernel_load, {law.name} law",
                partial(_sum_of_kernel, own.kind, own.parameters, deltas),
            )
            for law in (ENHANCED, EXPLICIT, CONFORMAL)
            for own in [kernel(law, PAIR)]
        ),
        Side("a power alone", lambda: _sum_of_powers(deltas, K, N)),
    ]
    return _rows("compiled scalar", deltas, sides, limits, rounds)


def _one_at_a_time(deltas: np.ndarray, rounds: int) -> list[Row]:
    numbers = deltas.tolist()
    johnson = kernel(JOHNSON, PAIR)
    sides = [
        Side(
            "cylcontact: kernel_load, Johnson",
            lambda: [kernel_load(johnson.kind, johnson.parameters, x) for x in numbers],
        ),
        Side("scipy.special.lambertw", lambda: [float(_by_lambertw(x)) for x in numbers]),
        Side("scipy.optimize.brentq", lambda: [_by_brentq(x) for x in numbers]),
        Side("scipy.optimize.newton", lambda: [float(_by_newton(x)) for x in numbers]),
    ]
    return _rows("called from Python", deltas, sides, [], rounds)


def _curves(rounds: int) -> list[Row]:
    """Return the time that the curve of a pair takes, which is made once."""
    sides = []
    for name, law in {"one material": CONFORMAL, "a ring": HOUSED, "a thin eye": THIN_EYE}.items():
        bodies = law.curve(PAIR).bodies
        sides.append(Side(f"cylcontact: the curve of {name}", partial(make, bodies)))
    return compare("law", "making a curve", sides, rounds, "ms", 1e3)


def _rows(kind: str, deltas: np.ndarray, sides: list[Side], limits: list[Side], rounds: int):
    case = f"{kind}, {deltas.size:,} values"
    require_agreement(sides, TOLERANCE)
    return compare("law", case, [*sides, *limits], rounds, "ns per value", 1e9 / deltas.size)


def _by_lambertw(delta):
    return -np.pi * E_STAR * delta / lambertw(-np.e * delta / (4 * DR), -1).real


def _deficit(load, delta):
    return load / (np.pi * E_STAR) * (np.log(4 * np.pi * E_STAR * DR / load) - 1) - delta


def _slope(load, _):
    return (np.log(4 * np.pi * E_STAR * DR / load) - 2) / (np.pi * E_STAR)


def _by_newton(delta):
    # From below, where the iteration is sure to converge as the penetration is concave.
    return newton(_deficit, 0.1 * E_STAR * delta, _slope, (delta,), tol=1e-9, maxiter=100)


def _by_brentq(delta: float) -> float:
    largest = float(JOHNSON.max_load(PAIR))
    return brentq(_deficit, 1e-12 * largest, largest, (delta,), xtol=1e-300, rtol=1e-12)


@njit
def _sum_of_kernel(kind, parameters, deltas):
    total = 0.0
    for delta in deltas:
        total += kernel_load(kind, parameters, delta)
    return total


@njit
def _sum_of_powers(deltas, factor, exponent):
    total = 0.0
    for delta in deltas:
        total += factor * delta**exponent
    return total


@njit
def _sum_by_newton(deltas, E_star, dR):
    total = 0.0
    for delta in deltas:
        load = 0.1 * E_star * delta
        change = load
        while abs(change) > 1e-14 * load:
            logarithm = math.log(4 * math.pi * E_star * dR / load)
            left = load / (math.pi * E_star) * (logarithm - 1) - delta
            change = left * math.pi * E_star / (logarithm - 2)
            load -= change
        total += load
    return total
