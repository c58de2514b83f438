"""Tests of what a fit assumes of its noise: that it is independent, steady, and of one size.

Each test that fails is a finding: what the residuals show, and the option that allows for it. All
use the residuals in the units in which they should be alike, whitened by the noise model if there
is one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydantic import Field
from scipy import special

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.measurements import Indices
from cylcontact.fitting.measured_objective import MeasuredObjective, measured
from cylcontact.fitting.noise_model import positions
from cylcontact.fitting.problem import Problem
from cylcontact.spec import Spec

__all__ = ["SURPRISING", "Finding", "findings_of"]

# A test fails below this probability.
SURPRISING = 0.01
# Rows that a test needs, and rows of a series that its trend needs.
_FEWEST, _FEWEST_IN_SERIES = 12, 4


class Finding(Spec):
    """A test of the noise that fails."""

    test: str = Field(description="series, pairs, drift, sequence, spread, branches or repeats")
    p: float = Field(description="the probability of such residuals if the noise were as assumed")
    says: str = Field(description="what the residuals show")
    remedy: str = Field(description="what to do about it")

    @property
    def sentence(self) -> str:
        """What the residuals show, how unlikely that is, and what to do."""
        return f"{self.says} (p = {self.p:.2g}): {self.remedy}"


@dataclass(frozen=True)
class _Residuals:
    """The residuals of a fit with what they may depend on."""

    objective: MeasuredObjective
    r: FloatArray
    parameters: int

    def labels(self, name: str) -> tuple[list[str], Indices] | None:
        """Return the groups of a grouping; None if the table has none or only one."""
        data = self.objective.data
        if name in ("group", "branch") and name not in data.data.labels:
            return None
        names, index = data.groups(name)
        return (names, index) if len(names) > 1 else None

    @property
    def is_allowed(self) -> set[str]:
        """What the noise model allows for."""
        noise = self.objective.noise
        return set() if noise is None else {*noise.covariance.model.effects}


def findings_of(problem: Problem, point: FloatArray) -> list[Finding]:
    """Return the tests of the noise that fail at an optimum.

    Parameters
    ----------
    problem : Problem
        On measurements.
    point : array of float, shape (k,)
        Its optimum.
    """
    objective = measured(problem)
    r = objective.raw(problem.form(point[None, :]))[0]
    if r.size < _FEWEST + point.size:
        return []
    residuals = _Residuals(objective, r, point.size)
    tests = (_series, _drift, _sequence, _spread, _branches, _repeats)
    findings = [finding for test in tests if (finding := test(residuals)) is not None]
    return _without_echoes([f for f in findings if f.p < SURPRISING])


def _without_echoes(findings: list[Finding]) -> list[Finding]:
    """Leave out what another finding explains.

    A series or a drift explains a sequence of like residuals. Branches look like a drift, and a
    drift like branches; the less likely one is left.
    """
    p = {finding.test: finding.p for finding in findings}
    echoes = {"sequence"} if p.keys() & {"series", "pairs", "drift"} else set()
    if p.keys() >= {"drift", "branches"}:
        echoes.add(max("drift", "branches", key=lambda test: p[test]))
    return [f for f in findings if f.test not in echoes]


def _series(residuals: _Residuals) -> Finding | None:
    """Test whether residuals depend on the series: a mean and a trend along the load of each."""
    if "offset" in residuals.is_allowed:
        return None
    over = "group" if residuals.labels("group") else "pair"
    groups = residuals.labels(over)
    if groups is None:
        return None
    names, index = groups
    member = as_floats(index[:, None] == np.arange(len(names)))
    load = np.log(residuals.objective.data.load)
    columns = np.hstack([member, member * (load - load.mean())[:, None]])
    p = _f_test(residuals, columns)
    if p is None:
        return None
    if over == "group":
        return Finding(
            test="series",
            p=p,
            says=f"the {len(names)} series of the column group differ by more than the scatter "
            "within them, so that the intervals are too narrow",
            remedy="allow for it with --group group",
        )
    return Finding(
        test="pairs",
        p=p,
        says=f"the residuals differ between the {len(names)} pairs of the table: each pair has "
        "errors of its own, or the law is wrong in the clearance or the moduli",
        remedy="name the series by a column, and add --group COLUMN",
    )


def _drift(residuals: _Residuals) -> Finding | None:
    """Test whether residuals have trends along the rows of the series, each its own."""
    if "drift" in residuals.is_allowed:
        return None
    groups = residuals.labels("group") or residuals.labels("pair")
    index = groups[1] if groups else np.zeros(residuals.r.size, dtype=np.intp)
    data = residuals.objective.data
    position = _less_mean(positions(index, data.columns.get("time")), index)
    load = _less_mean(np.log(data.load), index)
    if abs(np.corrcoef(position, load)[0, 1]) > 0.9:
        return None  # along a single sweep of the load a drift looks like another law
    p = _f_test(residuals, position[:, None] * (index[:, None] == np.unique(index)))
    if p is None:
        return None
    return Finding(
        test="drift",
        p=p,
        says="the residuals drift along the rows of a series",
        remedy="allow for it with --drift",
    )


def _less_mean(values: FloatArray, index: Indices) -> FloatArray:
    """Return values less the mean of their series."""
    return as_floats(values - (np.bincount(index, values) / np.bincount(index))[index])


def _sequence(residuals: _Residuals) -> Finding | None:
    """Test whether each residual is like the one before, by their correlation."""
    groups = residuals.labels("group")
    index = groups[1] if groups else np.zeros(residuals.r.size, dtype=np.intp)
    order = np.argsort(index, kind="stable")
    r, same = residuals.r[order], np.diff(index[order]) == 0
    r = r - r.mean()
    correlation = float((r[1:] * r[:-1])[same].sum() / (r**2).sum())
    p = float(special.ndtr(-correlation * np.sqrt(r.size)))
    load = residuals.objective.data.load
    turns = np.diff(np.sign(np.diff(load)))
    remedy = "repeat some loads, in another order: this may be a drift, or the law's shape"
    if np.any(turns != 0):
        untried = {
            "offset": "name the series by a column with --group COLUMN",
            "drift": "allow for a drift with --drift",
        }
        options = [text for effect, text in untried.items() if effect not in residuals.is_allowed]
        remedy = ", or ".join([*options, "try other laws with `cylcontact choose`"])
    return Finding(
        test="sequence",
        p=p,
        says=f"readings in sequence err alike (correlation {correlation:.2f}), so that the "
        "intervals are too narrow",
        remedy=remedy,
    )


def _spread(residuals: _Residuals) -> Finding | None:
    """Test whether the size of the residuals depends on the penetration, by ranks."""
    noise = residuals.objective.noise
    if residuals.objective.has_sigma:
        return None
    size = _ranks(np.abs(residuals.r))
    correlation = float(np.corrcoef(size, _ranks(residuals.objective.observed))[0, 1])
    degrees = residuals.r.size - 2
    t = correlation * np.sqrt(degrees / max(1 - correlation**2, 1e-12))
    p = 2 * float(special.stdtr(degrees, -abs(t)))
    grows = "grows" if correlation > 0 else "falls"
    relative = " relative to it" if residuals.objective.is_log else ""
    if noise is not None:
        relative = " relative to that assumed"
    remedy = "allow for both kinds of scatter with --noise both"
    if noise is not None and len(noise.covariance.model.scatter) == 2:
        remedy = "look for what else makes readings scatter"
    return Finding(
        test="spread",
        p=p,
        says=f"the scatter of the readings{relative} {grows} with them",
        remedy=remedy,
    )


def _branches(residuals: _Residuals) -> Finding | None:
    """Test whether unloading reads otherwise than loading."""
    groups = residuals.labels("branch")
    if groups is None:
        return None
    names, index = groups
    p = _f_test(residuals, as_floats(index[:, None] == np.arange(len(names)))[:, 1:])
    if p is None:
        return None
    return Finding(
        test="branches",
        p=p,
        says="loading and unloading differ, by friction in the rig or by plastic flow",
        remedy="fit one of them with --branch loading, and compare",
    )


def _repeats(residuals: _Residuals) -> Finding | None:
    """Test whether the law misses the means of repeated loads by more than they scatter."""
    sets = residuals.objective.data.replicates()
    r, degrees = residuals.r, sum(rows.size - 1 for rows in sets)
    between = r.size - residuals.parameters - degrees
    if degrees < _FEWEST_IN_SERIES or between < 1:
        return None
    pure = sum(float(((r[rows] - r[rows].mean()) ** 2).sum()) for rows in sets)
    if pure <= 0:
        return None
    ratio = max(float((r**2).sum()) - pure, 0.0) / between / (pure / degrees)
    return Finding(
        test="repeats",
        p=float(special.fdtrc(between, degrees, ratio)),
        says="the law misses the means of repeated loads by more than their scatter",
        remedy="try other laws with `cylcontact choose`"
        + ("" if "offset" in residuals.is_allowed else ", or name the series with --group COLUMN"),
    )


def _f_test(residuals: _Residuals, columns: FloatArray) -> float | None:
    """Return the probability of residuals that depend on columns so much; None if too few rows."""
    r = residuals.r
    design = np.column_stack([np.ones(r.size), columns])
    left, singular, _ = np.linalg.svd(design, full_matrices=False)
    basis = left[:, singular > 1e-10 * singular[0]]
    rank, rest = basis.shape[1] - 1, r.size - residuals.parameters - basis.shape[1]
    if rank < 1 or rest < _FEWEST_IN_SERIES:
        return None
    explained = float(((basis.T @ r) ** 2).sum()) - r.size * float(r.mean()) ** 2
    left_over = max(float((r**2).sum()) - float(((basis.T @ r) ** 2).sum()), 1e-300)
    return float(special.fdtrc(rank, rest, max(explained, 0.0) / rank / (left_over / rest)))


def _ranks(values: FloatArray) -> FloatArray:
    """Return the ranks of values; ties share their mean."""
    _, place, counts = np.unique(values, return_inverse=True, return_counts=True)
    last = np.cumsum(counts)
    return as_floats((last - (counts - 1) / 2)[place])
