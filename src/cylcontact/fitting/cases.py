"""The paper's own route to its coefficients: K and n case by case, then n over ΔR, then K* over ΔR.

A case is a clearance and a modulus. Its K and n are the line of ln f over ln δ of Johnson's law at
some loads (Fig 2, whose printed K and n of the hole come back to every digit; a fit of f itself
gives others). Eq 6 then follows the cases against the clearance.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from cylcontact.bodies.pair import Contact
from cylcontact.fitting.nodes import Axes, johnson
from cylcontact.laws.enhanced import PUBLISHED, InternalCoefficients, internal_exponent
from cylcontact.support.arrays import BoolArray, FloatArray, as_floats, require
from cylcontact.support.errors import InputError

# Loads of a case that determine a line and how well it fits.
_FEWEST = 3
# The clearances of the logarithmic branch that its two coefficients need.
_FEWEST_BELOW = 2
_PRINTED = InternalCoefficients()
# Whether K* of a case is determined again with n over ΔR, and what the line of K* minimises.
FACTORS = {"of each case": False, "with n over dR": True}
LINES = ("absolute squares", "relative squares")


class Cases(NamedTuple):
    """The lines ln f = ln(K*·E*/ΔR) + n·ln δ of cases, NaN where Johnson's law ends before them.

    `n` and `K_star` have the shape (clearances, moduli); so have the means of s = ln(f/E*) and of
    j = ln δ over the loads.
    """

    grid: Axes
    n: FloatArray
    K_star: FloatArray
    mean_s: FloatArray
    mean_j: FloatArray

    def K_star_given(self, n: FloatArray) -> FloatArray:
        """Return K* of the cases with the exponent held at one for each clearance, shape (m,)."""
        return as_floats(np.exp(self.mean_s - n[:, None] * self.mean_j) * self.grid.dR[:, None])


def fit_cases(grid: Axes) -> Cases:
    """Return the line of each clearance and modulus of a grid.

    Examples
    --------
    The hole of Fig 2, for which the paper prints K = 312148.4 and n = 1.23700:

    >>> E_star = 207e3 / (2 * (1 - 0.3**2))
    >>> loads = np.append(1.0, 10.0 * np.arange(1, 101))
    >>> cases = fit_cases(Axes(np.array([E_star]), np.array([0.05]), loads))
    >>> print(f"{cases.K_star.item() * E_star / 0.05:.1f} {cases.n.item():.5f}")
    312148.4 1.23700
    """
    s, j, inside = _samples(grid)
    count = inside.sum(axis=2)
    enough = count >= _FEWEST
    with np.errstate(all="ignore"):
        mean_s, mean_j = (np.where(inside, x, 0.0).sum(axis=2) / count for x in (s, j))
        x = np.where(inside, j - mean_j[..., None], 0.0)
        n = np.where(enough, (x * s).sum(axis=2) / (x * x).sum(axis=2), np.nan)
        K_star = np.exp(mean_s - n * mean_j) * grid.dR[:, None]
    mean_s, mean_j = (np.where(enough, x, np.nan) for x in (mean_s, mean_j))
    return Cases(grid, n, as_floats(K_star), mean_s, mean_j)


def _samples(grid: Axes) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return s, j and where Johnson's law holds, shape (clearances, moduli, loads)."""
    s = np.log(grid.load / grid.E_star[:, None])
    with np.errstate(all="ignore"):
        j = johnson(s, grid.dR[:, None, None])
    return np.broadcast_to(s, j.shape), j, np.isfinite(j)


def exponents_over_clearance(cases: Cases, n_exponent: float | None = None) -> dict[str, float]:
    """Return the coefficients of Eqs 6c and 6d that fit the exponents of all cases best.

    Parameters
    ----------
    cases : Cases
        Of a pin in a hole.
    n_exponent : float, optional
        The exponent of ΔR; fitted by default.

    Raises
    ------
    InputError
        With fewer than two clearances below the switch of Y, or none above.
    """
    count = np.isfinite(cases.n).sum(axis=1)
    dR, count = cases.grid.dR[count > 0], count[count > 0]
    n, weight = np.nanmean(cases.n[np.isfinite(cases.n).any(axis=1)], axis=1), np.sqrt(count)
    below = dR < _PRINTED.Y_switch
    rule = f"must have {_FEWEST_BELOW} clearances below {_PRINTED.Y_switch} mm and some above"
    enough = below.sum() >= _FEWEST_BELOW and not below.all()
    require(enough, "cases", "dR", int(below.sum()), rule, "space them logarithmically")
    log_log, log_dR = np.log(np.log(1000 * dR)), np.log(dR)

    def linear(x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return Y_log_scale, Y_slope and Y_offset given the exponents, and the residuals."""
        exponent, of_dR = (x[0], x[1] if n_exponent is None else n_exponent)
        branches = [below * np.exp(exponent * log_log), ~below * dR, 1.0 * ~below]
        terms = weight[:, None] * np.column_stack(branches) * np.exp(of_dR * log_dR)[:, None]
        best = np.linalg.lstsq(terms, weight * n, rcond=None)[0]
        return best, terms @ best - weight * n

    start = [_PRINTED.Y_log_exponent] + ([_PRINTED.n_exponent] if n_exponent is None else [])
    x = _least_squares(lambda x: linear(x)[1], start)
    scale, slope, offset = linear(x)[0].tolist()
    return {
        "Y_log_scale": scale,
        "Y_log_exponent": float(x[0]),
        "Y_slope": slope,
        "Y_offset": offset,
        "n_exponent": float(x[1]) if n_exponent is None else n_exponent,
    }


def exponent_at(dR: FloatArray, coefficients: dict[str, float]) -> FloatArray:
    """Return n at clearances in mm from the coefficients of Eqs 6c and 6d."""
    return as_floats(internal_exponent(dR, **coefficients, Y_switch=_PRINTED.Y_switch))


def factors_over_clearance(
    cases: Cases, n: FloatArray | None = None, relative: bool = False
) -> dict[str, float]:
    """Return a and b of the line K* = a·ΔR + b through the cases.

    Parameters
    ----------
    cases : Cases
        The cases.
    n : array of float, shape (m,), optional
        The exponent at each clearance, with which K* of the cases is determined again. By default
        K* is that of the lines.
    relative : bool, optional
        Whether squares of relative deviations are minimised, not of absolute ones.
    """
    K_star = cases.K_star if n is None else cases.K_star_given(n)
    dR = np.broadcast_to(cases.grid.dR[:, None], K_star.shape)
    known = np.isfinite(K_star)
    a, b = _line(dR[known], K_star[known], relative)
    return {"a": a, "b": b}


def _line(x: FloatArray, y: FloatArray, relative: bool) -> tuple[float, float]:
    """Return slope and intercept, NaN with one point."""
    weight = 1 / y if relative else np.ones_like(y)
    terms = np.column_stack([x, np.ones_like(x)]) * weight[:, None]
    if np.unique(x).size < 2:
        return np.nan, np.nan
    slope, intercept = np.linalg.lstsq(terms, y * weight, rcond=None)[0].tolist()
    return slope, intercept


def by_stages(
    contact: Contact, cases: Cases, n: float | None = None
) -> tuple[dict[str, float], FloatArray]:
    """Return the coefficients of n by the second stage of the paper, and n at each clearance.

    Parameters
    ----------
    contact : "internal" or "external"
        For rollers n is one number, the mean of the cases.
    cases : Cases
        The cases.
    n : float, optional
        For holes the exponent of ΔR, n_exponent, and for rollers n itself; fitted by default.

    Raises
    ------
    InputError
        If the clearances do not determine n.
    """
    if contact == "external":
        one = float(np.nanmean(cases.n)) if n is None else n
        return {"n": one}, np.full(cases.grid.dR.size, one)
    exponents = exponents_over_clearance(cases, n)
    return exponents, exponent_at(cases.grid.dR, exponents)


def routes(
    contact: Contact,
    grids: Sequence[Axes],
    given: Mapping[str, Mapping[str, float]],
    ends: Sequence[float],
) -> list[dict[str, Any]]:
    """Return the coefficients of several grids by the stages of the paper, and in sequence.

    Parameters
    ----------
    contact : "internal" or "external"
        The contact.
    grids : sequence of Axes
        The grids.
    given : mapping
        By name, `n` of `by_stages`, or nothing.
    ends : sequence of float
        `end` of `in_sequence`, for holes.

    Returns
    -------
    list of dict
        The number of the grid, the way with its choices, and the coefficients. Where the clearances
        do not determine n, there is none.
    """
    rows: list[dict[str, Any]] = []
    for number, grid in enumerate(grids):
        cases = fit_cases(grid)
        below = int((grid.dR < _PRINTED.Y_switch).sum())
        if contact == "internal" and below < _FEWEST_BELOW:
            continue
        for name, of_n in given.items():
            exponents, own = by_stages(contact, cases, **of_n)
            for (factor, n), line in product(FACTORS.items(), LINES):
                chosen = {"grid": number, "way": "case by case", "given": name, "factor": factor}
                held = own if n else None
                K_star = factors_over_clearance(cases, held, relative=line == LINES[1])
                rows.append(chosen | {"line": line} | K_star | exponents)
        if contact == "internal":
            for end, line, of_load in product(ends, LINES, (False, True)):
                chosen = {"grid": number, "way": "in sequence", "line": line, "end": end}
                what = "load" if of_load else "penetration"
                found = in_sequence(cases, end, relative=line == LINES[1], of_load=of_load)
                rows.append(chosen | {"objective": f"log {what}"} | found)
    return rows


def in_sequence(
    cases: Cases, end: float = 2.0, relative: bool = False, of_load: bool = False
) -> dict[str, float]:
    """Return the coefficients for holes, found one after another.

    The logarithmic branch of Y follows the cases below its switch, with the published exponent of
    ΔR. There K* with this n gives a and b. Above the switch the linear branch follows the n that
    fits best with these, up to a clearance.

    Parameters
    ----------
    cases : Cases
        Of a pin in a hole.
    end : float, optional
        The largest clearance in mm of the linear branch.
    relative : bool, optional
        Whether the line of K* minimises squares of relative deviations.
    of_load : bool, optional
        Whether n above the switch minimises deviations of ln f, not of ln δ.

    Raises
    ------
    InputError
        With fewer than two clearances on either side of the switch.
    """
    dR, of_dR = cases.grid.dR, _PRINTED.n_exponent
    below = (dR < _PRINTED.Y_switch) & np.isfinite(cases.n).any(axis=1)
    above = (dR >= _PRINTED.Y_switch) & (dR <= end * 1.001)
    for side in (below, above):
        if side.sum() < _FEWEST_BELOW:
            rule = f"must have {_FEWEST_BELOW} clearances below and above {_PRINTED.Y_switch} mm"
            raise InputError("cases", "dR", int(side.sum()), rule, "space them logarithmically")
    scale, exponent = _logarithmic_branch(dR[below], cases.n[below], of_dR)
    n = scale * np.log(1000 * dR[below]) ** exponent * dR[below] ** of_dR
    only = cases._replace(
        grid=cases.grid._replace(dR=dR[below]),
        mean_s=cases.mean_s[below],
        mean_j=cases.mean_j[below],
    )
    K_star = np.exp(np.nanmean(np.log(only.K_star_given(n)), axis=1))
    a, b = _line(dR[below], K_star, relative)
    s, j, inside = _samples(cases.grid._replace(dR=dR[above]))
    with np.errstate(invalid="ignore"):  # a line that turns negative has no n
        t = s + np.log(dR[above] / (a * dR[above] + b))[:, None, None]
    t, j = (np.where(inside, x, 0.0) for x in (t, j))
    tj = (t * j).sum(axis=(1, 2))
    best = tj / (j * j).sum(axis=(1, 2)) if of_load else (t * t).sum(axis=(1, 2)) / tj
    reach = dR[above] ** of_dR
    terms = np.column_stack([dR[above] * reach, reach])
    slope, offset = np.linalg.lstsq(terms, best, rcond=None)[0].tolist()
    values = (a, b, scale, exponent, slope, offset, of_dR)
    return dict(zip(vars(PUBLISHED["internal"]), values, strict=False))


def _logarithmic_branch(dR: FloatArray, n: FloatArray, of_dR: float) -> tuple[float, float]:
    """Return Y_log_scale and Y_log_exponent that fit exponents of cases best."""
    count, n = np.isfinite(n).sum(axis=1), np.nanmean(n, axis=1)
    weight, log_log, reach = np.sqrt(count), np.log(np.log(1000 * dR)), dR**of_dR

    def linear(x: FloatArray) -> tuple[float, FloatArray]:
        term = weight * reach * np.exp(x[0] * log_log)
        scale = float(term @ (weight * n) / (term @ term))
        return scale, scale * term - weight * n

    start = [_PRINTED.Y_log_exponent]
    x = _least_squares(lambda x: linear(x)[1], start)
    return linear(x)[0], float(x[0])


def _least_squares(residuals: Callable[[FloatArray], FloatArray], start: list[float]) -> FloatArray:
    """Minimise a sum of squares over exponents, to the last digits."""
    from scipy.optimize import least_squares  # slow to import

    tight = 1e-12
    return as_floats(
        least_squares(residuals, start, x_scale=0.05, xtol=tight, ftol=tight, gtol=tight).x
    )
