"""Many fits of the enhanced law at once, each to Johnson's law on a grid reduced to Gauss nodes.

At one clearance Johnson's ln δ depends on s = ln(f/E*) alone, so all samples of E, ν and the load
act through their distribution of s. A few Gauss nodes replace it (Golub and Welsch 1969), exactly
for polynomials up to degree 23.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, NamedTuple, Self

import numpy as np

from cylcontact.bodies.material import material_in_MPa
from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.fitting.law_models import MODELS
from cylcontact.fitting.parameters import Parameter
from cylcontact.fitting.search import descend
from cylcontact.fitting.space import Space, central_differences
from cylcontact.laws import PUBLISHED, Johnson
from cylcontact.support.arrays import FloatArray, as_floats

# The number of nodes. At the ends of a distribution with fewer points, fewer are needed.
NODES = 12
# A recursion that gives less than this has met as many nodes as there are points.
_LAST = 1e-10
# The largest deviation is approached through sums of its powers, each from the end of the last.
_POWERS = (1, 2, 4, 8, 16, 32)
_PRECISION = 1e-13
# E = 2 MPa and ν = 0: a composite modulus of 1 MPa, with which a load is f/E*.
_UNIT = material_in_MPa("of unit composite modulus", 2.0, 0.0)


class Deviation(NamedTuple):
    """What an objective sums: of loads or penetrations, of logarithms or not, and the weight."""

    of_load: bool
    is_log: bool
    weight: str  # "one", "penetration" or "load" squared, or "ends", for the largest


DEVIATIONS = {
    "log penetration": Deviation(False, True, "one"),
    "relative penetration": Deviation(False, False, "one"),
    "penetration": Deviation(False, False, "penetration"),
    "log load": Deviation(True, True, "one"),
    "relative load": Deviation(True, False, "one"),
    "load": Deviation(True, False, "load"),
    "largest relative penetration": Deviation(False, False, "ends"),
}


class Axes(NamedTuple):
    """A grid: composite moduli in MPa, clearances in mm and loads in N/mm."""

    E_star: FloatArray
    dR: FloatArray
    load: FloatArray


class Nodes(NamedTuple):
    """Of G grids the clearances, shape (G, m), and the nodes, shape (G, m, 12); weight 0 if none.

    `j` is ln δ of Johnson's law at s = ln(f/E*), and `root` the root of the weight.
    """

    dR: FloatArray
    s: FloatArray
    j: FloatArray
    root: FloatArray


def johnson(s: FloatArray, dR: FloatArray) -> FloatArray:
    """Return ln δ of Johnson's law at s = ln(f/E*) and ΔR in mm; NaN beyond its end (Eq 8)."""
    pair = CylinderPair.from_dR("internal", dR, _UNIT)  # for rollers the law is the same
    return as_floats(np.log(Johnson().penetration(np.exp(s), pair)))


def gauss(x: FloatArray, weight: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return nodes and weights of a discrete measure, by Lanczos with full orthogonalisation.

    Examples
    --------
    >>> x, weight = np.linspace(0.0, 1.0, 1000), np.ones(1000)
    >>> nodes, weights = gauss(x, weight)
    >>> bool(np.isclose(weights @ nodes**23, weight @ x**23, rtol=1e-12))
    True
    """
    middle, half = (x.max() + x.min()) / 2, max(np.ptp(x) / 2, np.finfo(float).tiny)
    t = (x - middle) / half
    vectors = [np.sqrt(weight / weight.sum())]
    diagonal, beside = [], []
    for _ in range(NODES):
        new = t * vectors[-1]
        diagonal.append(new @ vectors[-1])
        for each in vectors + vectors:  # twice is enough
            new = new - (new @ each) * each
        size = float(np.linalg.norm(new))
        if size < _LAST:
            break
        beside.append(size)
        vectors.append(new / size)
    inner = beside[: len(diagonal) - 1]
    at, parts = np.linalg.eigh(np.diag(diagonal) + np.diag(inner, 1) + np.diag(inner, -1))
    nodes, weights = np.full(NODES, middle), np.zeros(NODES)
    nodes[: at.size], weights[: at.size] = middle + half * at, weight.sum() * parts[0] ** 2
    return nodes, weights


def nodes_of(grids: Sequence[Axes], weight: str) -> Nodes:
    """Return the nodes of grids, for the weight of an objective."""
    most = max(grid.dR.size for grid in grids)
    dR, root = np.ones((len(grids), most)), np.zeros((len(grids), most, NODES))
    s = np.full(root.shape, -5.0)
    for k, grid in enumerate(grids):
        own = slice(grid.dR.size)
        dR[k, own] = grid.dR
        s[k, own], weights = _of_grid(grid, weight)
        root[k, own] = np.sqrt(weights / weights.sum())
    j = johnson(s, np.where(root > 0, dR[..., None], 1.0))
    if weight == "penetration":  # whose square is exp(2s) times a factor that is nearly constant
        root = root * np.exp(j - s)
    return Nodes(dR, s, np.where(root > 0, j, 0.0), root)


def _of_grid(grid: Axes, weight: str) -> tuple[FloatArray, FloatArray]:
    """Return s and weights at each clearance, shape (m, 12)."""
    E_star, load = (each.ravel() for each in np.meshgrid(grid.E_star, grid.load, indexing="ij"))
    s = np.log(load / E_star)
    order = np.argsort(s)
    s, load = s[order], load[order]
    each = {"penetration": np.exp(2 * s), "load": load**2}.get(weight, np.ones_like(s))
    pair = CylinderPair.from_dR("internal", grid.dR, _UNIT)
    inside = np.searchsorted(s, np.log(Johnson().max_load(pair)), side="right")
    known = {}
    for count in set(inside.tolist()):
        if weight == "ends":
            known[count] = np.linspace(s[0], s[count - 1], NODES), np.ones(NODES)
        else:
            known[count] = gauss(s[:count], each[:count])
    at = [known[count] for count in inside.tolist()]
    return np.array([x for x, _ in at]), np.array([w for _, w in at])


@dataclass(frozen=True, eq=False)
class OnNodes(Space):
    """One fit on each of many grids. The last of a point is the number of its grid, and is held."""

    deviation: Deviation
    nodes: Nodes
    power: int = 1

    @classmethod
    def of(
        cls, contact: Contact, free: Sequence[Parameter], deviation: Deviation, nodes: Nodes
    ) -> Self:
        """Return the space of the enhanced law with some of its parameters tied or fixed."""
        number = Parameter("grid", 0.0, max(len(nodes.dR) - 1, 1))
        return cls(MODELS["enhanced", contact], (*free, number), deviation, nodes)

    def residuals(self, points: FloatArray) -> FloatArray:
        """Return the residuals at points, shape (P, q)."""
        return self.linearised(points)[0]

    def linearised(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the residuals and their derivatives, shapes (P, q) and (P, k, q)."""
        assert self.model.slope_form is not None
        complete = self.complete(points)
        dR, s, j, root = (each[np.rint(complete[:, -1]).astype(np.intp)] for each in self.nodes)
        with np.errstate(all="ignore"):
            log_K, n, *by_all = self.model.slope_form(complete[:, :-1], dR)
            by_free = self._by_free(points)
            d_log_K, dn = ((by_free @ each)[..., None] for each in by_all)
            c, n = (np.log(dR) - log_K)[..., None], np.where(n > 0, n, np.nan)[..., None]
            if self.deviation.of_load:
                r, slopes = n * j - c - s, d_log_K + dn * j[:, None]
            else:
                r = (s + c) / n - j
                slopes = -(d_log_K + dn * ((s + c) / n)[:, None]) / n[:, None]
            if not self.deviation.is_log:
                slopes *= np.exp(r)[:, None]
                r = np.expm1(r)
            if self.power > 1:
                more = np.abs(r) ** (self.power - 1)
                slopes *= self.power * more[:, None]
                r = r * more
            r, slopes = r * root, slopes * root[:, None]
        return r.reshape(len(points), -1), slopes.reshape(*points.shape, -1)

    def _by_free(self, points: FloatArray) -> FloatArray:
        """Return the derivatives of the coefficients by the free parameters, (P, k, all)."""
        if any(p.tie for p in self.parameters):
            return central_differences(self.complete, self.low, self.high, points)[..., :-1]
        rows = [p.is_free for p in self.parameters]
        return np.eye(len(rows))[rows][:, :-1]

    def curvatures(self, A: FloatArray) -> FloatArray:
        """Return those of each parameter, whose scales differ by orders of magnitude."""
        return np.diagonal(A, axis1=1, axis2=2)

    def fitted(self) -> tuple[FloatArray, FloatArray]:
        """Return the coefficients of the minimum on each grid, (G, all), and its objective.

        The descents begin at the published coefficients: with Eq 6d there is one minimum.
        """
        grids = np.arange(len(self.nodes.dR), dtype=float)
        start = self.point({**PUBLISHED[self.model.contact].__dict__, "grid": 0.0})
        points, held = np.tile(start, (grids.size, 1)), np.zeros((grids.size, start.size), bool)
        points[:, -1], held[:, -1] = grids, True
        values = np.empty(0)
        powers = _POWERS if self.deviation.weight == "ends" else (1,)
        for power in powers:
            points, values = descend(replace(self, power=power), points, _PRECISION, held)
        return self.complete(points)[:, :-1], as_floats(values ** (1 / powers[-1]))


# Bounds of a study, which cut no optimum off: those of a campaign are narrower.
_WIDE = {
    "a": (0.0, 20.0),
    "b": (-2.0, 100.0),
    "n": (0.5, 2.0),
    "Y_log_scale": (0.1, 20.0),
    "Y_log_exponent": (-3.0, 2.0),
    "Y_slope": (-0.2, 0.2),
    "Y_offset": (0.3, 3.0),
    "n_exponent": (-0.5, 0.5),
}


def fit_many(
    contact: Contact,
    grids: Sequence[Axes],
    searched: Mapping[str, Mapping[str, Mapping[str, Any]]],
    objectives: Sequence[str],
) -> dict[tuple[str, str], tuple[FloatArray, FloatArray]]:
    """Fit the enhanced law to Johnson's on each of G grids, for several objectives.

    Parameters
    ----------
    contact : "internal" or "external"
        The contact.
    grids : sequence of Axes
        The grids.
    searched : mapping
        By name, the tables `fixed` and `ties` of a campaign; the other coefficients are searched.
    objectives : sequence of str
        From `DEVIATIONS`.

    Returns
    -------
    dict
        By the names of the two: the coefficients in their order, shape (G, 8) or (G, 3), and the
        objectives (G,).
    """
    found = {}
    nodes: dict[str, Nodes] = {}
    for (name, tables), objective in product(searched.items(), objectives):
        deviation = DEVIATIONS[objective]
        if deviation.weight not in nodes:
            nodes[deviation.weight] = nodes_of(grids, deviation.weight)
        space = OnNodes.of(contact, _free(contact, **tables), deviation, nodes[deviation.weight])
        found[name, objective] = space.fitted()
    return found


def _free(
    contact: Contact, fixed: Mapping[str, float] = {}, ties: Mapping[str, str] = {}
) -> list[Parameter]:
    """Return the parameters of the law, some of them fixed or tied."""
    return [
        replace(p, tie=ties[p.name], value=None)
        if p.name in ties
        else replace(p, value=fixed[p.name])
        if p.name in fixed
        else replace(p, low=_WIDE[p.name][0], high=_WIDE[p.name][1])
        if p.is_free
        else p
        for p in MODELS["enhanced", contact].parameters
    ]
