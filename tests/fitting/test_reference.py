"""Objectives and a lower bound, each against a calculation that shares no code with it."""

from itertools import product

import numpy as np
import pytest
from scipy.optimize import minimize

from cylcontact import CylinderPair, Material, laws
from cylcontact.datasets import Grid, reduce_grid
from cylcontact.fitting.law_models import MODELS
from cylcontact.fitting.reference import (
    OBJECTIVES,
    OnMoments,
    OnSamples,
    Samples,
    max_abs_difference_percent,
)

GRIDS = {
    "internal": Grid(
        "internal",
        "johnson",
        np.geomspace(20.7, 1000, 3),
        np.array([0.1, 0.5]),
        np.geomspace(0.05, 9.0, 5),
        np.geomspace(10, 1000, 6),
    ),
    "external": Grid(
        "external",
        "johnson",
        np.geomspace(20.7, 1000, 3),
        np.array([0.2, 0.4]),
        np.geomspace(5, 500, 4),
        np.geomspace(10, 1000, 5),
    ),
}
CANDIDATES = {
    "internal": [
        (0.965, 0.0965, 1.51, -0.151, 0.0151, 1.151, -0.005),
        (0.64, 0.18, 1.7, -0.22, 0.005, 1.127, -0.013),
    ],
    "external": [(0.39, 0.85, 1.094), (0.5, 0.7, 1.12)],
}


def whole(model, candidate):
    """Return all coefficients, the switch of Y as published."""
    return model.published | dict(zip(model.names, candidate, strict=False))


def differences(grid, model, candidate):
    """Penetration and force ratios minus one, sample by sample, through the laws themselves."""
    law = laws.Enhanced(coefficients=whole(model, candidate))
    johnson = laws.Johnson()
    penetration, force = [], []
    for E, nu, dR, load in product(grid.E, grid.nu, grid.dR, grid.load):
        pair = CylinderPair.from_dR(grid.contact, dR, Material("", E * 1e3, nu))
        delta = johnson.penetration(load, pair)
        if np.isfinite(delta):
            penetration.append(law.penetration(load, pair) / delta - 1)
            force.append(law.load(delta, pair) / load - 1)
    return np.array(penetration), np.array(force)


BY_HAND = {
    "rms-log-penetration": lambda d, _: np.sqrt(np.mean(np.log1p(d) ** 2)),
    "rms-difference-percent": lambda d, _: 100 * np.sqrt(np.mean(d**2)),
    "max-difference-percent": lambda d, _: 100 * np.abs(d).max(),
    "rms-relative-force": lambda _, f: np.sqrt(np.mean(f**2)),
    "max-relative-force-percent": lambda _, f: 100 * np.abs(f).max(),
}


def make(name, contact, model=None, grid=None):
    """The space of a law on a grid; from moments where that is possible."""
    grid, model = grid or GRIDS[contact], model or MODELS["enhanced", contact]
    if name == "moments":
        return OnMoments(model, model.parameters, reduce_grid(grid)[0])
    return OnSamples(model, model.parameters, name, Samples.of(grid))


@pytest.mark.parametrize("contact", ["internal", "external"])
@pytest.mark.parametrize("name", ["moments", *OBJECTIVES])
def test_value_is_what_the_laws_give_sample_by_sample(name, contact):
    space = make(name, contact)
    values = space.values(np.array(CANDIDATES[contact]))
    for candidate, value in zip(CANDIDATES[contact], values, strict=True):
        differences_by_hand = differences(GRIDS[contact], space.model, candidate)
        by_hand = BY_HAND["rms-log-penetration" if name == "moments" else name]
        assert value == pytest.approx(by_hand(*differences_by_hand), rel=1e-10)


@pytest.mark.parametrize("name", ["rms-difference-percent", "rms-relative-force"])
def test_squared_residuals_add_up_to_the_objective(name):
    space, points = make(name, "internal"), np.array(CANDIDATES["internal"][:1])
    total = np.sqrt((space.residuals(points) ** 2).sum())
    assert total == pytest.approx(space.values(points)[0], rel=1e-12)


def test_bound_is_reached_by_a_direct_search_at_each_clearance():
    """Nelder-Mead on ln K* and n, one clearance at a time, arrives at the same bound."""
    model, grid, squares = MODELS["power", "external"], GRIDS["external"], []
    for dR in grid.dR:
        single = Grid("external", "johnson", grid.E, grid.nu, np.array([dR]), grid.load)
        alone = make("rms-log-penetration", "external", model, single)

        def value(x, alone=alone):
            return alone.value(np.array([np.exp(x[0]), x[1]]))

        options = {"xatol": 1e-11, "fatol": 1e-13, "maxfev": 20000, "maxiter": 20000}
        start = np.array([1.0, 1.09])
        for _ in range(4):  # a simplex may collapse; restart it
            actual = minimize(value, start, method="Nelder-Mead", options=options)
            start = actual.x
        squares.append(actual.fun**2)
    bound = make("moments", "external", model).bound
    assert bound == pytest.approx(np.sqrt(np.mean(squares)), rel=1e-5)


@pytest.mark.parametrize("name", ["moments", *OBJECTIVES])
def test_undefined_candidates_are_infinitely_bad(name):
    undefined = np.array([[-1.0, 0.0, 1.1], [0.4, 0.8, -1.0], [0.39, 0.85, 1.094]])
    values = make(name, "external").values(undefined)
    assert np.isinf(values[:2]).all()
    assert np.isfinite(values[2])


def test_largest_difference_over_a_grid_is_the_one_found_sample_by_sample():
    model, grid = MODELS["enhanced", "internal"], GRIDS["internal"]
    candidates = [whole(model, c) for c in CANDIDATES["internal"]]
    worst = max_abs_difference_percent(grid, model, candidates)
    for candidate, value in zip(CANDIDATES["internal"], worst, strict=True):
        assert value == pytest.approx(
            100 * np.abs(differences(grid, model, candidate)[0]).max(), rel=1e-10
        )
