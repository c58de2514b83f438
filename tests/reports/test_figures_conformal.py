"""The figures that judge by conformal contact, against a solution of its own.

Persson's pressure is written out once more and integrated here; no law of the package is called.
"""

import math
from pathlib import Path

import numpy as np
import pytest
from _cylcontact_bench.fig_forms import CHOSEN, SIMPLEST
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.optimize import brentq

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from tests.support.drawn_figures import DrawnFigures
from tests.support.figure_files import GOLDEN
from tests.support.paper_equations import e_star, factor_and_exponent, johnson

BENCH = Bench(Path(__file__).parents[2])
ROOT_OF_N = 0.8346152454776572  # of 2 − 2u² − ln(1 + u): the contact is complete
C_DATUM = 2 * math.log(2) - 1.5  # the penetration is Johnson's at small loads
MATERIALS = {
    "ceramics": (600e3, 0.24),
    "high-strength steel": (207e3, 0.30),
    "low-carbon steel": (200e3, 0.30),
    "titanium alloy": (120e3, 0.34),
    "aluminium alloy": (69e3, 0.33),
}


def persson(u: float) -> tuple[float, float]:
    """φ and d at u = tan²(ε/2), the penetration by quadrature of the pressure."""
    phi = 2 * math.pi * u * (1 + u) / (2 - 2 * u**2 - math.log1p(u))
    B, end = math.sqrt(1 + u), 2 * math.atan(math.sqrt(u))

    def integrand(x: float) -> float:
        # θ = ε·sin x tames the ends.
        theta = end * math.sin(x)
        y2 = math.tan(theta / 2) ** 2
        s = math.sqrt(max(u - y2, 0.0))
        pressure = 2 * s / (math.pi * B * (1 + y2))
        pressure += 2 * math.atanh(s / B) / (2 * math.pi * u * (1 + u))
        kernel = -2 * math.cos(theta) * math.log(2 * math.sin(theta / 2)) - 0.5
        return pressure * kernel * end * math.cos(x)

    moment = 2 * quad(integrand, 0, math.pi / 2, epsabs=0, epsrel=1e-11, limit=200)[0]
    return phi, phi / math.pi * (moment + C_DATUM)


def persson_at(phi: float) -> float:
    """d under the load φ."""
    u = brentq(lambda u: persson(u)[0] - phi, 1e-12, ROOT_OF_N - 1e-9, xtol=1e-15, rtol=1e-14)
    return persson(u)[1]


def explicit(d: NDArray[np.float64], c: float, A: float, B: float) -> NDArray[np.float64]:
    """φ of the explicit law."""
    return np.pi * d / (c + np.log1p(A / d * (c + np.log1p(A / d * np.log(B / d)))))


@pytest.fixture(scope="module")
def truth() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """φ from 1e-6 to 60, and d."""
    t = np.geomspace(4e-7, 13.0, 300)
    points = np.array([persson(ROOT_OF_N * x / (1 + x)) for x in t])
    inside = (points[:, 0] >= 1e-6) & (points[:, 0] <= 60)
    assert inside.sum() > 250
    return points[inside, 0], points[inside, 1]


@pytest.fixture(scope="module")
def comparison(figures: DrawnFigures) -> Drawing:
    return figures["fig_explicit"].drawing


@pytest.fixture(scope="module")
def search(figures: DrawnFigures) -> Drawing:
    return figures["fig_forms"].drawing


class TestComparison:
    def test_error_for_internal_contact(self, comparison: Drawing, truth: tuple) -> None:
        phi, d = truth
        errors = 100 * (explicit(d, 1.427, 0.3602, 3.84) / phi - 1)
        said = comparison.headline[
            "explicit, internal: largest error of the load, φ 1e-06 to 60, %"
        ]
        assert said == pytest.approx(0.1156, abs=5e-5)
        assert said == pytest.approx(np.abs(errors).max(), abs=1e-3)
        assert said < 0.8

    def test_error_for_external_contact(self, comparison: Drawing) -> None:
        phi = np.geomspace(1e-9, 0.02, 1000)
        d = johnson(phi, 1.0, 1.0)
        errors = 100 * (explicit(d, 1.427, 0.3597, 2.78) / phi - 1)
        key = "explicit, external: largest error of the load, φ 1e-09 to 0.02, %"
        assert comparison.headline[key] == pytest.approx(np.abs(errors).max(), abs=1e-4)
        assert comparison.headline[key] == pytest.approx(0.06896, abs=1e-5)

    def test_error_of_the_formula_for_the_penetration(
        self, comparison: Drawing, truth: tuple
    ) -> None:
        phi, d = truth
        errors = 100 * (phi / np.pi * (1.4232 + np.log1p(1.0942 / phi)) / d - 1)
        said = comparison.headline["explicit formula: largest error of the penetration, %"]
        assert said == pytest.approx(np.abs(errors).max(), abs=1e-3)
        assert said == pytest.approx(0.3647, abs=1e-4)

    def test_johnson_at_its_end(self, comparison: Drawing) -> None:
        phi, d = 4 * math.pi / math.e**2, 4 / math.e**2
        same_depth = brentq(lambda load: persson_at(load) - d, 0.5, 1.0)
        said = comparison.headline["johnson: largest error of the load, %"]
        assert said == pytest.approx(100 * (phi / same_depth - 1), abs=1e-3)
        table = comparison.table
        rows = table[table["law"] == "johnson"].set_index("phi")
        for quantity, end in (("penetration", phi), ("load", same_depth)):
            defined = rows[f"{quantity}_error_percent"].dropna().index
            assert 0.88 * end < defined.max() <= end

    def test_liu_at_small_loads(self, comparison: Drawing) -> None:
        d = persson_at(1e-6)
        load = math.pi / 2 * d * math.sqrt(d / (2 * (1 + d)))
        said = comparison.headline["liu: largest error of the load, %"]
        assert said == pytest.approx(100 * (1 - load / 1e-6), abs=1e-6)

    def test_published_enhanced_law_at_one_load(self, comparison: Drawing) -> None:
        """At 1 N/mm and 0.5 mm, where its range in the figure begins."""
        E_star, dR = e_star(207e3, 0.3), 0.5
        K, n = factor_and_exponent(E_star, dR)
        error = 100 * (K * (persson_at(1 / (E_star * dR)) * dR) ** n - 1)
        table = comparison.table
        rows = table[(table["law"] == "enhanced") & table["pair"].str.endswith("dR = 0.5 mm")]
        assert rows["phi"].iloc[0] == pytest.approx(1 / (E_star * dR), rel=1e-12)
        assert rows["load_error_percent"].iloc[0] == pytest.approx(error, rel=1e-6)

    def test_what_a_clamped_housing_adds(self, comparison: Drawing) -> None:
        """At small loads C + 2Σ gₙ less Johnson's datum, from the closed forms of a clamped rim."""
        kappa, w, table = 3 - 4 * 0.3, 0.5, comparison.table
        n = np.arange(2.0, 12.0)
        for ratio in (10, 50):
            Q, Z = ratio**2, ratio ** (2 * n)
            A = -(1 + (kappa - 1) / (2 * Q)) / (2 * (kappa * Q + 1 / Q))
            U = (kappa + 1) / 4 + kappa * math.log(ratio) + A * (kappa - 1 + 2 * Q)
            top = Z * ((n + 1) * (kappa * Q) ** 2 - n * (n - 1)) + 2 * kappa * n * Q
            top += Z * (n**2 - 1) * (n * (Q - 1) ** 2 + Q**2)
            base = kappa * Q * (Z**2 + 1) + Z * ((kappa * Q) ** 2 + 1 + (n**2 - 1) * (Q - 1) ** 2)
            others = -np.sum(top / base / (n**2 - 1)) - 1 / (2 + (kappa - 1) * Q)
            plate = 4 * w * U / (kappa + 1) ** 2 - w / (kappa + 1)
            more = plate + 2 * w * others - w / (kappa + 1) - C_DATUM
            rows = table[table["law"] == f"conformal, clamped at R_o/R_i = {ratio}"]
            rows = rows[rows["phi"] < 0.02].iloc[::10]
            assert len(rows) > 2
            for phi, added in zip(rows["phi"], rows["penetration_error_percent"], strict=True):
                expected = 100 * more * phi / math.pi / persson_at(phi)
                assert added == pytest.approx(expected, rel=1e-3)


class TestSearch:
    @pytest.mark.slow
    def test_errors(self, search: Drawing) -> None:
        errors = search.table.set_index("form")["largest_error_percent"]
        assert errors.to_dict() == pytest.approx(GOLDEN["fig_forms, largest error in %"], rel=1e-3)

    def test_chosen_form_is_the_best_with_three_constants(
        self, search: Drawing, truth: tuple
    ) -> None:
        """Its error attains its largest size with alternating signs at least four times."""
        phi, d = truth
        row = search.table.set_index("form").loc[CHOSEN]
        constants = dict(part.split("=") for part in row["fitted"].split())
        errors = 100 * (explicit(d, *(float(constants[name]) for name in "cAB")) / phi - 1)
        near = errors[np.abs(errors) > 0.99 * row["largest_error_percent"]]
        assert np.count_nonzero(np.diff(np.sign(near))) >= 3
        others = search.table[search.table["given"] == "penetration"]
        best = others[others["constants"] <= 3]["largest_error_percent"].min()
        assert best == row["largest_error_percent"]
        assert search.headline["forms"] == len(search.table) == 14
        assert search.table["constants"].max() == 4

    def test_shipped_formula_is_the_simplest_fit(self, search: Drawing) -> None:
        fitted = search.table.set_index("form")["fitted"][SIMPLEST]
        assert [round(float(part.split("=")[1]), 4) for part in fitted.split()] == [1.4232, 1.0942]


class TestDepartures:
    @pytest.mark.parametrize(
        ("percent", "phi"), [(1, 0.052804), (3, 0.132676), (5, 0.204034), (10, 0.370145)]
    )
    def test_fig08(self, figures: DrawnFigures, percent: int, phi: float) -> None:
        drawing = figures["fig08"].drawing
        said = drawing.headline[f"phi at which Johnson's penetration is {percent} % low"]
        assert said == pytest.approx(phi, abs=5e-7)
        assert 100 * (1 - johnson(said, 1.0, 1.0) / persson_at(said)) == pytest.approx(
            percent, abs=1e-6
        )
        column = f"johnson_low_by_{percent}_percent_load_N_per_mm"
        row = drawing.table.iloc[-1]
        assert row["material"] == "aluminium alloy"
        assert row[column] == pytest.approx(said * e_star(69e3, 0.33) * row["dR_mm"])


class TestMaps:
    @staticmethod
    def enhanced(fit: str, load: float, E_star: float, dR: float) -> float:
        """Eqs 5 and 6 with fitted coefficients, solved for the penetration in mm."""
        c = BENCH.result(fit).coefficients
        branch = c["Y_log_scale"] * math.log(1000 * dR) ** c["Y_log_exponent"]
        Y = max(branch, c["Y_slope"] * dR + c["Y_offset"])
        factor = (c["a"] * dR + c["b"]) * E_star / dR
        return (load / factor) ** (1 / (Y * dR ** c["n_exponent"]))

    @pytest.mark.parametrize("fit", ["conformal", "practical"])
    def test_table(self, figures: DrawnFigures, fit: str) -> None:
        drawing = figures[f"fig_maps_{fit}"].drawing
        for row in drawing.table.iloc[:: len(drawing.table) // 53].itertuples():
            load, dR, E_star = row.load_N_per_mm, row.dR_mm, e_star(*MATERIALS[row.material])
            phi = load / (E_star * dR)
            judge = persson_at(phi) if fit == "conformal" else johnson(phi, 1.0, 1.0)
            delta = self.enhanced(fit, load, E_star, dR)
            assert row.difference_percent == pytest.approx(
                100 * (delta / (judge * dR) - 1), abs=1e-5
            )
        assert ("No part is hatched" in drawing.method) == (fit == "conformal")

    def test_window_against_persson_is_whole(self, figures: DrawnFigures) -> None:
        table = figures["fig_maps_conformal"].drawing.table
        tops = table.groupby(["material", "dR_mm"])["load_N_per_mm"].max()
        assert tops.to_numpy() == pytest.approx(1000.0)
        assert table["difference_percent"].notna().all()
