"""Every recipe: the numbers behind it, recomputed here from the paper's equations, and its files.

Nothing below calls a law of the package: paper_equations.py has the paper's once more.
"""

import math
import re
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest

from cylcontact import InputError
from cylcontact.laws import PUBLISHED
from cylcontact.plots.style import JOURNAL
from cylcontact.reports.bench import Bench
from cylcontact.reports.build import build, chosen_recipes, draw, find_recipes
from tests.support.drawn_figures import DrawnFigures, each_figure
from tests.support.figure_files import (
    GOLDEN,
    embedded_fonts,
    font_sizes_inside,
    page_mm,
    read_columns,
    significant_digits,
)
from tests.support.paper_equations import (
    difference,
    e_star,
    effective_radius,
    enhanced,
    johnson,
    johnson_end,
    power_fit,
    yield_load,
)

BENCH = Bench(Path(__file__).parents[2])
NAMES = chosen_recipes(BENCH)
# E in MPa, ν, yield stress in MPa.
MATERIALS = {
    "ceramics": (600e3, 0.24, 350.0),
    "high-strength steel": (207e3, 0.30, 1000.0),
    "low-carbon steel": (200e3, 0.30, 250.0),
    "titanium alloy": (120e3, 0.34, 830.0),
    "aluminium alloy": (69e3, 0.33, 276.0),
}
MAPS = dict(zip(("fig10", "fig11", "fig12", "fig13", "fig14"), MATERIALS, strict=True))
UNITLESS = {"nu", "n", "R2", "points", "objective", "b"}
UNITLESS |= {"cells", "nodes", "constant"}
UNITLESS |= {"restitution", "friction", "revolution", "onsets", "continued", "left"}
UNITLESS |= {"contact_fraction", "impacts", "counted"}
UNITLESS |= {"constants", "logarithms", "phi_from", "phi_to"}
UNITLESS |= {"alpha", "beta", "phi", "johnson_constant"}
UNITLESS |= {"share", "ratio", "ratio_low", "ratio_high", "place", "x", "y", "height"}
UNITLESS |= {"wanted_restitution", "achieved_restitution", "chi", "error"}
WORDS = {"fit", "panel", "symbol", "contact", "material", "form", "given", "fitted"}
WORDS |= {"body", "variant", "point", "mode", "code"}
WORDS |= {"law", "reference", "pair", "error_of", "range"}
WORDS |= {"group", "side", "computed", "optimizer", "step", "factor"}
WORDS |= {"coefficient_x", "coefficient_y"}
WORDS |= {"changed", "reading", "search", "coefficient", "campaign", "crossover", "kind"}
UNITLESS |= {"value", "objective_published", "run", "population", "evaluations"}
UNITLESS |= {"searched", "polished"}
UNITLESS |= {"e_y_over_clearance", "period"}
UNITLESS |= {"length", "depth", "share", "tilt", "force", "moment"}
UNITLESS |= {"lamina_force", "lamina_moment", "rim_force"}
WORDS |= {"ends", "materials"}
UNITS = ("_mm", "_um", "_us", "_N", "_J")
UNITS += ("_m_per_s", "_N_per_mm", "_MPa", "_GPa", "_percent", "_N_per_mm_n", "_ratio", "_deg")

# Empty beyond the end of a law, or where nothing is counted; finite elements are few.
MAY_END = {"n", "load_error_percent", "penetration_error_percent"}


class TestFiles:
    def test_every_figure_of_the_paper_is_among_them(self) -> None:
        papers = {name for name in find_recipes(BENCH) if re.fullmatch(r"fig\d\d[rcp]?", name)}
        assert papers == {name for name in NAMES if not name.startswith("fig_")}

    @each_figure(NAMES)
    def test_page_has_a_journals_width_and_fits_on_it(
        self, figures: DrawnFigures, name: str
    ) -> None:
        width, height = page_mm(figures[name].paths[0])
        assert min(abs(width - journal) for journal in JOURNAL.widths_mm) < 0.01
        # Sixteen orbits take most of a page.
        assert height < (180 if name in ("fig18", "fig19") else 120)

    @each_figure(NAMES)
    def test_fonts_are_embedded_as_type_42(self, figures: DrawnFigures, name: str) -> None:
        fonts = embedded_fonts(figures[name].paths[0])
        assert {font.partition("-")[0] for font in fonts} <= {"Arimo", "STIXGeneral"}

    @each_figure(NAMES)
    def test_text_is_legible_and_inside_the_page(self, figures: DrawnFigures, name: str) -> None:
        assert font_sizes_inside(figures[name].drawing.figure) <= {7.0, 8.0}

    @each_figure(NAMES)
    def test_table_has_units_and_digits(self, figures: DrawnFigures, name: str) -> None:
        for column, cells in read_columns(figures[name].paths[1]).items():
            may_end = column in MAY_END or column.endswith("_elements_um")
            assert all(cells) or may_end, f"{column} has empty cells"
            cells = [cell for cell in cells if cell]  # noqa: PLW2901
            try:
                [float(cell) for cell in cells]
            except ValueError:
                assert column in WORDS
                continue
            number = column.removesuffix("_half_width")
            assert number in UNITLESS or number.endswith(UNITS)
            assert max(map(significant_digits, cells)) <= 8

    @each_figure(NAMES)
    def test_caption_tells_units_and_nothing_of_this_machine(
        self, figures: DrawnFigures, name: str
    ) -> None:
        drawing = figures[name].drawing
        caption = drawing.caption
        lengths = drawing.table.columns.str.contains("_mm").any()
        assert "mm" in f"{caption} {drawing.method}" or not lengths
        assert caption.endswith(".")
        assert "/home" not in caption
        assert str(BENCH.root) not in caption

    @pytest.mark.parametrize(
        "name",
        [
            "fig13",
            *(pytest.param(n, marks=pytest.mark.slow) for n in ("fig03", "fig_maps_refit")),
        ],
    )
    def test_same_input_gives_the_same_bytes(self, name: str, tmp_path: Path) -> None:
        (one,), (other,) = (build(BENCH, [name], tmp_path / folder) for folder in ("1", "2"))
        assert [path.suffix for path in one.paths][:3] == [".png", ".pdf", ".csv"]
        for first, second in zip(one.paths, other.paths, strict=True):
            assert first.read_bytes() == second.read_bytes()


@each_figure([name for name in GOLDEN if name in NAMES])
def test_headline_is_the_pinned_one(figures: DrawnFigures, name: str) -> None:
    # A committed fit that is made again may differ in its last digits; so may the readings, which
    # are fits made when they are drawn.
    tolerance = 1e-3 if name.startswith(("fig_maps", "fig_readings")) else 1e-5
    assert dict(figures[name].drawing.headline) == pytest.approx(GOLDEN[name], rel=tolerance)


class TestGeometry:
    def test_drawn_lengths(self, figures: DrawnFigures) -> None:
        table = figures["fig01"].drawing.table.pivot_table("value_mm", "symbol", "panel")
        internal, external = table["internal"], table["external"]
        assert internal["dR"] == internal["R_i"] - internal["R_j"] == 3.0
        assert external["dR"] == external["R_i"] + external["R_j"] == 10.5
        assert internal["centre distance"] == internal["dR"] + internal["delta"]
        assert external["centre distance"] == external["dR"] - external["delta"]

    @pytest.mark.parametrize("contact", ["internal", "external"])
    def test_ends_of_the_chord_lie_on_both_outlines(
        self, figures: DrawnFigures, contact: str
    ) -> None:
        table = figures["fig01"].drawing.table.pivot_table("value_mm", "symbol", "panel")[contact]
        half, e = table["2b"] / 2, table["centre distance"]
        y = math.sqrt(table["R_i"] ** 2 - half**2)
        assert math.hypot(half, y - e) == pytest.approx(table["R_j"], rel=1e-12)


class TestPowerLaws:
    @pytest.mark.parametrize(
        ("contact", "loads", "dR", "digits"),
        [
            ("internal", [1, *range(10, 1001, 10)], 0.05, "312148 1.2370"),
            ("external", [1, *range(100, 10001, 100)], 140.0, "44975 1.0939"),
        ],
    )
    def test_fig02_constants(
        self, figures: DrawnFigures, contact: str, loads: list[int], dR: float, digits: str
    ) -> None:
        headline = figures["fig02"].drawing.headline
        K, n = power_fit(loads, e_star(207e3, 0.3), dR)
        x, y = np.log(johnson(np.array(loads), e_star(207e3, 0.3), dR)), np.log(loads)
        assert headline[f"{contact} K"] == pytest.approx(K, rel=1e-9)
        assert headline[f"{contact} n"] == pytest.approx(n, rel=1e-9)
        assert headline[f"{contact} R2"] == pytest.approx(np.corrcoef(x, y)[0, 1] ** 2, rel=1e-9)
        assert f"{K:.0f} {n:.4f}" == digits

    def test_fig02_prints_ours_beside_the_papers(self, figures: DrawnFigures) -> None:
        for axes in figures["fig02"].drawing.figure.axes[:2]:
            texts = {text.get_text() for text in axes.texts}
            assert {"here", "paper", "> 0.998"} <= texts
        assert (
            sum(
                "312148" in text.get_text()
                for text in figures["fig02"].drawing.figure.axes[0].texts
            )
            == 2
        )

    def test_fig02_table_is_eq_1_and_the_line(self, figures: DrawnFigures) -> None:
        drawing = figures["fig02"].drawing
        for contact, rows in drawing.table.groupby("contact"):
            K, n = drawing.headline[f"{contact} K"], drawing.headline[f"{contact} n"]
            for row in rows.itertuples():
                delta = johnson(row.load_N_per_mm, e_star(207e3, 0.3), row.dR_mm)
                assert row.penetration_mm == pytest.approx(delta, rel=1e-12)
                assert row.fitted_load_N_per_mm == pytest.approx(K * delta**n, rel=1e-10)

    @pytest.mark.slow
    def test_fig03_exponents_are_slopes(self, figures: DrawnFigures) -> None:
        table = figures["fig03"].drawing.table
        load = np.geomspace(10, 1000, 41)
        for row in table.iloc[[0, 300, 700, 1000, 1400]].itertuples():
            E_star = e_star(1e3 * row.E_GPa, row.nu)
            inside = load[load <= johnson_end(E_star, row.dR_mm)]
            _, slope = power_fit(inside, E_star, row.dR_mm)
            assert row.points == inside.size
            assert row.n == pytest.approx(slope, rel=1e-10)

    def test_fig03_leaves_out_loads_beyond_johnson(self, figures: DrawnFigures) -> None:
        table = figures["fig03"].drawing.table
        short = table[table["points"] < 41]
        assert set(short["E_GPa"]) == {20.7}
        assert short["dR_mm"].max() < 0.06


class TestLimits:
    def test_fig07_loads(self, figures: DrawnFigures) -> None:
        headline = figures["fig07"].drawing.headline
        assert len(headline) == 30
        for R_i in (100, 10, 5):
            for name, (E, nu, stress) in MATERIALS.items():
                load = yield_load(stress, e_star(E, nu), effective_radius(R_i, 0.1))
                assert headline[f"{name}, R_i = {R_i} mm, dR = 0.1 mm"] == pytest.approx(load)
        assert headline["low-carbon steel, R_i = 10 mm, dR = 0.1 mm"] == pytest.approx(
            1768.91, abs=0.005
        )

    def test_fig08_limits(self, figures: DrawnFigures) -> None:
        headline = figures["fig08"].drawing.headline
        limits = {name: round(value) for name, value in headline.items() if "dR" in name}
        assert limits == {
            "aluminium alloy, dR = 0.0075 mm": 494,
            "aluminium alloy, dR = 0.01 mm": 658,
            "titanium alloy, dR = 0.0075 mm": 865,
        }

    def test_fig08_lines_are_eq_8(self, figures: DrawnFigures) -> None:
        for row in figures["fig08"].drawing.table.iloc[::37].itertuples():
            E, nu, _ = MATERIALS[row.material]
            limit = johnson_end(e_star(E, nu), row.dR_mm)
            assert row.load_N_per_mm == pytest.approx(limit, rel=1e-12)

    @pytest.mark.slow
    def test_fig09_clearances_of_the_yield_stress(self, figures: DrawnFigures) -> None:
        for key, dR in figures["fig09"].drawing.headline.items():
            name, R_i = re.fullmatch(r"(.+), R_i = (\d+) mm: .*", key).groups()
            E, nu, stress = MATERIALS[name]
            pressure = 2 / math.e * e_star(E, nu) * dR / math.sqrt(float(R_i) * (float(R_i) - dR))
            assert pressure == pytest.approx(stress, rel=1e-12)

    def test_fig09_lines_are_eq_7_at_eq_8(self, figures: DrawnFigures) -> None:
        for row in figures["fig09"].drawing.table.iloc[::101].itertuples():
            E_star = e_star(*MATERIALS[row.material][:2])
            R = effective_radius(row.R_i_mm, row.dR_mm)
            load = yield_load(row.stress_MPa, E_star, R)
            assert load == pytest.approx(johnson_end(E_star, row.dR_mm), rel=1e-12)


class TestMaps:
    @pytest.mark.parametrize(("name", "material"), MAPS.items())
    def test_table_is_eq_9(self, figures: DrawnFigures, name: str, material: str) -> None:
        E_star = e_star(*MATERIALS[material][:2])
        table = figures[name].drawing.table
        dR, load = table["dR_mm"].to_numpy(), table["load_N_per_mm"].to_numpy()
        for column, expected in {
            "penetration_mm": enhanced(load, E_star, dR),
            "johnson_penetration_mm": johnson(load, E_star, dR),
        }.items():
            assert table[column].to_numpy() == pytest.approx(expected, rel=1e-10)
        expected = difference(load, E_star, dR)
        assert table["difference_percent"].to_numpy() == pytest.approx(expected, abs=1e-8)

    @pytest.mark.parametrize(("name", "material"), MAPS.items())
    def test_window_is_sect_34s_up_to_johnsons_limit(
        self, figures: DrawnFigures, name: str, material: str
    ) -> None:
        table = figures[name].drawing.table
        assert table["dR_mm"].min() == 0.0075
        assert table["dR_mm"].max() == 2.0
        tops = table.groupby("dR_mm")["load_N_per_mm"].agg(["min", "max"])
        E_star = e_star(*MATERIALS[material][:2])
        limit = johnson_end(E_star, tops.index.to_numpy())
        assert tops["max"].to_numpy() == pytest.approx(np.minimum(1000, limit))
        assert tops["min"].to_numpy() == pytest.approx(10.0)
        assert table["difference_percent"].notna().all()

    def test_shares_exclude_what_yields(self, figures: DrawnFigures) -> None:
        name, (E, nu, _) = "fig12", MATERIALS["low-carbon steel"]
        table, E_star = figures[name].drawing.table, e_star(E, nu)
        inside = table["load_N_per_mm"] <= table["yield_load_N_per_mm"]
        below = np.abs(difference(table["load_N_per_mm"], E_star, table["dR_mm"])[inside]) < 8
        share = figures[name].drawing.headline["share before first yield below 8 %"]
        assert share == pytest.approx(below.mean(), rel=1e-12)

    @pytest.mark.parametrize(
        ("name", "where"),
        [
            ("fig10", "ticked side yields"),
            ("fig11", "outside this map"),
            ("fig12", "ticked side yields"),
            ("fig13", "outside this map"),
            ("fig14", "ticked side yields"),
        ],
    )
    def test_key(self, figures: DrawnFigures, name: str, where: str) -> None:
        (key,) = figures[name].drawing.figure.legends
        texts = {text.get_text() for text in key.get_texts()}
        expected = {
            f"first yield (von Mises), $R_i$ = 10 mm; {where}",
            "coefficients fitted from 0.05 mm on",
        }
        if name in ("fig13", "fig14"):
            expected.add("beyond the reference's largest load")
        assert texts == expected

    @pytest.mark.parametrize("name", MAPS)
    def test_caption_says_what_is_assumed(self, figures: DrawnFigures, name: str) -> None:
        drawing = figures[name].drawing
        assert drawing.caption.endswith("Yield stress assumed.")
        assert re.search(rf"assumed: .*yield stress of {MAPS[name]}", drawing.method)
        assert "The radius is our choice" in drawing.method

    def test_caption_names_the_coefficients(self, figures: DrawnFigures) -> None:
        caption = figures["fig12"].drawing.caption
        assert "enhanced law (Eqs 5-6; published coefficients)" in caption

    def test_refit_with_the_published_coefficients_is_the_published_map(
        self, figures: DrawnFigures, tmp_path: Path
    ) -> None:
        result = BENCH.result("internal")
        coefficients = {name: float(v) for name, v in vars(PUBLISHED["internal"]).items()}
        result.model_copy(update={"coefficients": coefficients}).save(tmp_path / "internal.json")
        drawing = draw("fig_maps_refit", Bench(BENCH.root, tmp_path))
        steel = drawing.table[drawing.table.pop("material") == "low-carbon steel"]
        expected = figures["fig12"].drawing.table
        pd.testing.assert_frame_equal(steel.reset_index(drop=True), expected)
        assert "a = 0.965, b = 0.0965" in drawing.method

    def test_refit_for_the_other_contact_is_refused(self, tmp_path: Path) -> None:
        BENCH.result("external").save(tmp_path / "internal.json")
        with pytest.raises(InputError, match="is not a fit on a grid of internal contacts"):
            draw("fig_maps_refit", Bench(BENCH.root, tmp_path))


def test_drawing_leaves_the_readers_settings_alone() -> None:
    before = dict(mpl.rcParams)
    draw("fig08", BENCH)
    assert dict(mpl.rcParams) == before
