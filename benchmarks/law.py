"""Loads of the laws: in arrays, in compiled code and called from Python."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

import numpy as np
from numba import njit
from scipy.optimize import brentq, newton
from scipy.special import lambertw

from benchmarks.harness import Row, Sides, compare, require_agreement
from cylcontact import CylinderPair, Material, laws
from cylcontact.laws.conformal.curve import make
from cylcontact.laws.kernels import kernel, kernel_load

PAIR = CylinderPair.internal(R_i=10.0, R_j=9.5, material=Material("steel", E=207e3, nu=0.3))
JOHNSON, ENHANCED, CONFORMAL = laws.Johnson(), laws.Enhanced(), laws.Conformal()
THIN_EYE = laws.Conformal(laws.Housing(13.0, laws.Sector(60, "pulled")))
E_STAR, DR = float(PAIR.E_star), float(PAIR.dR)
K, N = float(ENHANCED.factor(PAIR)), float(ENHANCED.exponent(PAIR))


def measure(short: bool) -> Iterator[list[Row]]:
    """Yield the time of a value in arrays, in compiled code and from Python, and of a curve."""
    # The Lambert function of scipy loses digits near the limit.
    largest = 0.99 * float(JOHNSON.max_penetration(PAIR))
    deltas = largest * 10 ** np.random.default_rng(1).uniform(-6, 0, 1_000 if short else 1_000_000)
    loads, rounds = CONFORMAL.load(deltas, PAIR), 1 if short else 9
    same: Sides = {
        "Johnson().load": lambda: JOHNSON.load(deltas, PAIR),
        "scipy.special.lambertw": lambda: by_lambertw(deltas),
        "scipy.optimize.newton": lambda: by_newton(deltas),
    }
    others: Sides = {
        "numpy.power": lambda: np.power(deltas, N),
        "Enhanced().load": lambda: ENHANCED.load(deltas, PAIR),
        "Explicit().load": partial(laws.Explicit().load, deltas, PAIR),
        "Conformal().load": lambda: CONFORMAL.load(deltas, PAIR),
        "Conformal().penetration": lambda: CONFORMAL.penetration(loads, PAIR),
    }
    yield _per_value(f"array, {deltas.size:,} values", same, others, deltas.size, rounds)
    deltas = deltas[: 200 if short else 20_000]
    johnson, *compiled = (kernel(law, PAIR) for law in (JOHNSON, ENHANCED, CONFORMAL))
    same = {
        "Johnson": lambda: sum_of_kernel(johnson.kind, johnson.parameters, deltas),
        "Newton's method in numba": lambda: sum_by_newton(deltas, E_STAR, DR),
    }
    others = {
        name: partial(sum_of_kernel, law.kind, law.parameters, deltas)
        for name, law in zip(("enhanced", "conformal"), compiled, strict=True)
    } | {"a power": lambda: sum_of_powers(deltas, K, N)}
    yield _per_value("compiled, one value", same, others, deltas.size, rounds)
    numbers = deltas[:200].tolist()
    same = {
        "Johnson": lambda: [kernel_load(johnson.kind, johnson.parameters, x) for x in numbers],
        "scipy.special.lambertw": lambda: [float(by_lambertw(x)) for x in numbers],
        "scipy.optimize.brentq": lambda: [by_brentq(x) for x in numbers],
    }
    yield _per_value("called from Python, one value", same, {}, len(numbers), rounds)
    curves = {"one material": CONFORMAL, "a thin eye": THIN_EYE}
    sides = {name: partial(make, law.curve(PAIR).bodies) for name, law in curves.items()}
    yield compare("the curve of a conformal contact, made once", sides, rounds)


def _per_value(case: str, same: Sides, others: Sides, size: int, rounds: int) -> list[Row]:
    require_agreement(same, 1e-9)
    return compare(case, {**same, **others}, rounds, "ns", 1e9 / size)


def by_lambertw(delta):
    return -np.pi * E_STAR * delta / lambertw(-np.e * delta / (4 * DR), -1).real


def by_newton(delta):
    # From below, where the iteration converges because the penetration is concave.
    return newton(_deficit, 0.1 * E_STAR * delta, _slope, (delta,), tol=1e-9, maxiter=100)


def by_brentq(delta):
    largest = float(JOHNSON.max_load(PAIR))
    return brentq(_deficit, 1e-12 * largest, largest, (delta,), xtol=1e-300, rtol=1e-12)


def _deficit(load, delta):
    return load / (np.pi * E_STAR) * (np.log(4 * np.pi * E_STAR * DR / load) - 1) - delta


def _slope(load, _):
    return (np.log(4 * np.pi * E_STAR * DR / load) - 2) / (np.pi * E_STAR)


@njit
def sum_of_kernel(kind, parameters, deltas):
    total = 0.0
    for delta in deltas:
        total += kernel_load(kind, parameters, delta)
    return total


@njit
def sum_of_powers(deltas, factor, exponent):
    total = 0.0
    for delta in deltas:
        total += factor * delta**exponent
    return total


@njit
def sum_by_newton(deltas, E_star, dR):
    total = 0.0
    for delta in deltas:
        load = change = 0.1 * E_star * delta
        while abs(change) > 1e-14 * load:
            logarithm = math.log(4 * math.pi * E_star * dR / load)
            left = load / (math.pi * E_star) * (logarithm - 1) - delta
            change = left * math.pi * E_star / (logarithm - 2)
            load -= change
        total += load
    return total
