"""The study of every choice: its fits against scipy on all samples, and its committed counts."""

from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import least_squares

from cylcontact.files.spec import read_toml
from cylcontact.fitting.cases import (
    by_stages,
    exponent_at,
    factors_over_clearance,
    fit_cases,
    in_sequence,
    routes,
)
from cylcontact.fitting.nodes import Axes, fit_many, gauss, nodes_of
from cylcontact.reports.figures import report_module

ROOT = Path(__file__).resolve().parents[2]
STUDY = report_module(ROOT, "choices")
CHOICES = read_toml(ROOT / "datasets/choices.toml")
SUMMARY = pd.read_csv(ROOT / "fitting/results/choices.csv", comment="#", keep_default_na=False)


def samples(grid):
    """Return E*, ΔR, load and ln δ by Johnson's law (Eq 1) at every sample up to its end (Eq 8)."""
    E, dR, f = (x.ravel() for x in np.meshgrid(grid.E_star, grid.dR, grid.load, indexing="ij"))
    with np.errstate(invalid="ignore"):
        z = np.log(4 * np.pi * E * dR / f) - 1
    E, dR, f, z = (x[z >= 1] for x in (E, dR, f, z))
    return E, dR, f, np.log(f / (np.pi * E) * z)


def by_scipy(contact, grid, complete, start, objective):
    """Return the free coefficients at the least sum of squares over all samples."""
    E, dR, f, j = samples(grid)

    def residuals(x):
        a, b, *rest = complete(x)
        if contact == "internal":
            scale, exponent, slope, offset, of_dR = rest
            logarithmic = scale * np.log(1000 * dR) ** exponent
            n = np.where(dR < 0.34954, logarithmic, slope * dR + offset) * dR**of_dR
        else:
            n = rest[0]
        K = (a * dR + b) * E / dR
        if "load" in objective:
            ratio = np.log(K) + n * j - np.log(f)
            return {"log load": ratio, "relative load": np.expm1(ratio)}.get(
                objective, f * np.expm1(ratio) / 100
            )
        ratio = np.log(f / K) / n - j
        return {"log penetration": ratio, "relative penetration": np.expm1(ratio)}.get(
            objective, 1e3 * np.exp(j) * np.expm1(ratio)
        )

    tight = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-14)
    scale = np.abs(start)
    return least_squares(residuals, start, x_scale=scale, max_nfev=500, **tight).x


def tied(x):
    a, Y = x
    return a, a / 10, Y, -Y / 10, Y / 100, 1 + Y / 10, -0.005


FREE = {
    "internal": [0.965, 0.0965, 1.51, -0.151, 0.0151, 1.151, -0.005],
    "external": [0.39, 0.85, 1.094],
}
ROWS = [
    ("internal", "digits tied", "relative penetration", tied, [0.965, 1.51], 7, [0, 2]),
    ("internal", "all seven", "relative load", tuple, FREE["internal"], 7, range(7)),
    ("internal", "all seven", "penetration", tuple, FREE["internal"], 7, range(7)),
    ("external", "all three", "load", tuple, FREE["external"], 3, range(3)),
    ("external", "a and b", "log load", lambda x: (*x, 1.094), [0.39, 0.85], 3, [0, 1]),
]


@pytest.mark.parametrize(("contact", "way", "objective", "complete", "start", "size", "free"), ROWS)
def test_a_fit_of_the_study_is_that_of_all_samples(
    contact, way, objective, complete, start, size, free
):
    chosen = {"E": "logarithmic to 1000", "nu": "0.1 to 0.5", "dR": "logarithmic", "points": 20}
    grid = next(
        grid for names, grid in STUDY.grids(CHOICES, contact) if chosen.items() <= names.items()
    )
    searched = {way: CHOICES["searched"][contact][way]}
    coefficients, _ = fit_many(contact, [grid], searched, [objective])[way, objective]
    again = by_scipy(contact, grid, complete, start, objective)
    assert coefficients[0, :size][list(free)] == pytest.approx(again, rel=2e-5)


def test_the_stages_are_those_of_a_line_for_each_case():
    """Lines by numpy, one case after another."""
    chosen = {"E": "even to 1000", "nu": "0.3", "dR": "logarithmic", "points": 10, "load": "even"}
    grid = next(
        grid for names, grid in STUDY.grids(CHOICES, "internal") if chosen.items() <= names.items()
    )
    cases = fit_cases(grid)
    for (k, dR), (i, E_star) in product(enumerate(grid.dR), enumerate(grid.E_star)):
        _, _, f, j = samples(Axes(np.array([E_star]), np.array([dR]), grid.load))
        n, log_K = np.polyfit(j, np.log(f), 1)
        assert cases.n[k, i] == pytest.approx(n, rel=1e-9)
        assert cases.K_star[k, i] == pytest.approx(np.exp(log_K) * dR / E_star, rel=1e-8)
    exponents, own = by_stages("internal", cases)
    again = least_squares(
        lambda x: np.ravel(
            exponent_at(grid.dR, dict(zip(exponents, x, strict=True)))[:, None] - cases.n
        ),
        [1.51, -0.151, 0.0151, 1.151, -0.005],
        x_scale=[1, 0.1, 0.01, 1, 0.01], xtol=1e-14, ftol=1e-14, gtol=1e-14,
    ).x  # fmt: skip
    assert [*exponents.values()] == pytest.approx(again, rel=1e-4)
    dR = np.repeat(grid.dR, grid.E_star.size)
    a, b = np.polyfit(dR, cases.K_star_given(own).ravel(), 1)
    assert factors_over_clearance(cases, own) == pytest.approx({"a": a, "b": b}, rel=1e-9)


def test_one_steel_in_sequence_returns_six_numbers():
    chosen = {"E": "207 alone", "nu": "0.1 to 0.5", "dR": "logarithmic", "points": 20}
    grid = next(
        grid
        for names, grid in STUDY.grids(CHOICES, "internal", drawn=True)
        if chosen.items() <= names.items() and names["load"] == "even"
    )
    found = pd.Series(in_sequence(fit_cases(grid)))
    off = STUDY.deviations(found.to_frame().T, "internal").abs().max(axis=None)
    nearest = SUMMARY[(SUMMARY["way"] == "in sequence") & (SUMMARY["end_mm"] == "2.0")]
    assert 100 * off == pytest.approx(nearest["nearest_percent"].iloc[0], rel=1e-4)


def test_a_line_of_relative_squares_is_fitted_to_relative_squares():
    """Each row of a route has the numbers of the choices that it names."""
    grid = Axes(np.array([2e5]), np.geomspace(0.05, 2.0, 12), np.linspace(10.0, 1000.0, 8))
    cases = fit_cases(grid)
    rows = pd.DataFrame(routes("internal", [grid], {"fitted": {}}, [2.0])).set_index("line")
    for line, relative in (("absolute squares", False), ("relative squares", True)):
        for way, expected in (
            ("case by case", factors_over_clearance(cases, relative=relative)),
            ("in sequence", in_sequence(cases, 2.0, relative=relative)),
        ):
            row = rows[rows["way"] == way].loc[line].iloc[0]
            assert (row["a"], row["b"]) == pytest.approx((expected["a"], expected["b"]), rel=1e-12)


def test_nodes_are_exact_for_polynomials():
    x, weight = np.linspace(-3.0, 2.0, 500) ** 3, np.linspace(1.0, 2.0, 500)
    nodes, weights = gauss(x, weight)
    for degree in range(24):
        assert weights @ nodes**degree == pytest.approx(weight @ x**degree, rel=1e-9)


def test_the_largest_error_is_sought_up_to_the_last_samples_of_each_clearance():
    """At small clearances Johnson's law ends before the largest load."""
    grid = Axes(np.array([2e4, 2e5]), np.array([1e-3, 1.0]), np.linspace(10.0, 1000.0, 8))
    E, dR, f, _ = samples(grid)
    ends = nodes_of([grid], "ends").s[0, :, [0, -1]].T
    for at, own in zip(grid.dR, ends, strict=True):
        s = np.log(f / E)[dR == at]
        assert own == pytest.approx([s.min(), s.max()], rel=1e-12)


def test_the_study_has_every_different_grid_once():
    found = {contact: list(STUDY.grids(CHOICES, contact)) for contact in ("internal", "external")}
    assert {contact: len(each) for contact, each in found.items()} == {
        "internal": 632, "external": 316,
    }  # fmt: skip
    once = SUMMARY.drop_duplicates(["contact", "way", "given", "end_mm"])
    fits = dict(zip(once["contact"] + " " + once["way"], once["fits"], strict=False))
    objectives = len(CHOICES["objective"]["levels"])
    assert fits["internal digits tied"] == 632 * objectives
    assert fits["external all three"] == 316 * objectives
    determined = sum(np.sum(grid.dR < 0.34954) >= 2 for _, grid in found["internal"])
    assert fits["internal all seven"] == determined * objectives
    assert fits["internal case by case"] == 4 * determined


def test_the_campaigns_that_recover_are_two_of_the_fits():
    for contact, way in (("internal", "digits tied"), ("external", "a and b")):
        row = SUMMARY[(SUMMARY["contact"] == contact) & (SUMMARY["way"] == way)].iloc[0]
        assert row["all_within_1_percent"] > 0
        campaign = read_toml(ROOT / f"fitting/recovered-{contact}.toml")
        tables = {key: campaign[key] for key in ("fixed", "ties") if key in campaign}
        assert tables == CHOICES["searched"][contact][way]


@pytest.mark.long
def test_the_committed_summary_is_that_of_the_study():
    now = STUDY.summary(STUDY.study(workers=2)).astype(str).set_index(["contact", "way", "given"])
    was = SUMMARY.astype(str).set_index(["contact", "way", "given"])
    counts = [name for name in was if name.startswith(("all_", "within_", "fits"))]
    assert now[counts].equals(was[counts])
