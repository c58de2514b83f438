"""Laws, limits and maps drawn into anyone's axes, against the paper's equations once more."""

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.contour import QuadContourSet

import cylcontact as cc
from cylcontact import CylinderPair, InputError, Material
from cylcontact.plots import plot_laws, plot_limits, plot_map
from cylcontact.plots.difference_map import map_grid
from tests.support.paper_equations import (
    difference,
    e_star,
    effective_radius,
    enhanced,
    johnson,
    johnson_end,
    yield_load,
)

E, NU, STRENGTH = 110e3, 0.34, 220.0
BRONZE = Material("bronze", E, NU, STRENGTH)
BRITTLE = Material("no yield stress", E, NU)
SOFT = Material("soft", "500 MPa", 0.4, 10.0)
E_STAR = e_star(E, NU)
PAIR = CylinderPair.internal(R_i=10.0, R_j=9.98, material=BRONZE)
DR = 0.02

# Every function, drawing something into `ax`.
EACH = {
    "plot_map": lambda ax=None, **more: plot_map("enhanced", "johnson", BRONZE, ax=ax, **more),
    "plot_laws": lambda ax=None, **more: plot_laws(["johnson", "enhanced"], PAIR, ax=ax, **more),
    "plot_limits": lambda ax=None, **more: plot_limits(BRONZE, ax=ax, **more),
}


@pytest.fixture(autouse=True)
def _no_figures_stay_open():
    yield
    plt.close("all")


def labelled(axes) -> dict:
    handles, labels = axes.get_legend_handles_labels()
    return dict(zip(labels, handles, strict=True))


def contour_lines(axes) -> QuadContourSet:
    (lines,) = (
        drawn
        for drawn in axes.collections
        if isinstance(drawn, QuadContourSet) and not drawn.filled
    )
    return lines


def filled_points(axes) -> np.ndarray:
    """The corners of the filled contours, shape (m, 2)."""
    filled = next(c for c in axes.collections if isinstance(c, QuadContourSet) and c.filled)
    return np.concatenate([path.vertices for path in filled.get_paths()])


@pytest.mark.parametrize("draw", EACH.values(), ids=EACH)
class TestAxes:
    def test_a_figure_of_its_own_is_the_journals_and_unknown_to_pyplot(self, draw) -> None:
        before = dict(mpl.rcParams)
        axes = draw()
        assert axes.figure.get_figwidth() * 25.4 == pytest.approx(90)
        assert axes.xaxis.label.get_fontsize() == 8.0
        assert plt.get_fignums() == []
        assert dict(mpl.rcParams) == before
        assert axes.get_legend() or axes.figure.legends

    def test_the_callers_axes_and_no_others(self, draw) -> None:
        own = {"font.size": 13.0, "axes.labelsize": 13.0, "lines.linewidth": 3.0}
        with mpl.rc_context(own):
            before = dict(mpl.rcParams)
            figure, (axes, other) = plt.subplots(1, 2)
            assert draw(axes) is axes
            assert dict(mpl.rcParams) == before
        assert axes.xaxis.label.get_fontsize() == 13.0
        assert not other.has_data()
        assert other.get_xlabel() == ""
        assert other.get_xscale() == "linear"
        assert axes.get_legend() is None
        assert figure.legends == []

    def test_axes_in_a_part_of_a_figure(self, draw) -> None:
        figure = plt.figure(layout="constrained")
        left, right = figure.subfigures(1, 2)
        axes = draw(left.subplots())
        assert axes in left.axes
        assert right.axes == []
        figure.canvas.draw()

    def test_what_is_no_axes(self, draw) -> None:
        _, panels = plt.subplots(1, 2)
        with pytest.raises(InputError, match=r"ax = array\(.*must be one matplotlib Axes; give"):
            draw(panels)


class TestMap:
    def test_contours_stand_where_eq_9_has_their_levels(self) -> None:
        axes = plot_map(cc.laws.Enhanced(), cc.laws.Johnson(), BRONZE, load=(20.0, 800.0))
        lines = contour_lines(axes)
        checked = 0
        for level, path in zip(lines.levels, lines.get_paths(), strict=True):
            if len(path.vertices) and abs(level) <= 12:
                dR, load = path.vertices.T
                assert difference(load, E_STAR, dR) == pytest.approx(level, abs=0.06)
                checked += len(dR)
        assert checked > 500
        assert axes.get_xlim() == (0.0075, 2.0)
        assert axes.get_ylim() == (20.0, 800.0)

    def test_the_shaded_part_begins_at_the_largest_load(self) -> None:
        axes = plot_map("enhanced", "johnson", SOFT, load=(1.0, 500.0))
        shaded = labelled(axes)["beyond Johnson's largest load"]
        dR, load = shaded.get_paths()[0].vertices.T
        edge = (load < 500.0) & (load > 1.0)
        assert edge.sum() > 100
        assert load[edge] == pytest.approx(
            johnson_end(e_star(500.0, 0.4), dR[edge]), rel=1e-12, abs=0
        )
        reached = filled_points(axes)
        top = johnson_end(e_star(500.0, 0.4), reached[:, 0])
        assert (reached[:, 1] <= top * 1.02).all()
        assert reached[:, 1].max() > 400.0

    def test_a_reference_that_ends_below_the_window_at_some_clearances(self) -> None:
        axes = plot_map("enhanced", "johnson", SOFT, load=(10.0, 500.0))
        lowest = 10.0 * np.e**2 / (4 * np.pi * e_star(500.0, 0.4))  # mm, by Eq 8
        reached = filled_points(axes)[:, 0]
        assert lowest <= reached.min() < 1.05 * lowest
        pair, loads = map_grid(cc.laws.Johnson(), SOFT, load=(10.0, 500.0))
        assert (np.isnan(loads) == (pair.dR < lowest)).all()

    @pytest.mark.parametrize(("R_i", "strength"), [(5.0, STRENGTH), (20.0, STRENGTH / 2)])
    def test_the_yield_line_by_hertz_is_eq_7_of_the_weaker_body(self, R_i, strength) -> None:
        pin = Material("pin", E, NU, strength)
        axes = plot_map("enhanced", "johnson", BRONZE, material_j=pin, R_i=R_i, criterion="Hertz")
        dR, load = labelled(axes)[
            f"first yield (Hertz), $R_i$ = {R_i:g} mm; ticked side yields"
        ].get_data()
        expected = yield_load(strength, E_STAR, effective_radius(R_i, dR))
        assert load == pytest.approx(expected, rel=1e-12, abs=0)

    @pytest.mark.parametrize(
        ("material", "criterion"), [(BRITTLE, "von Mises"), (BRONZE, None)], ids=["none", "off"]
    )
    def test_no_yield_line(self, material: Material, criterion) -> None:
        axes = plot_map("enhanced", "persson", material, criterion=criterion)
        assert labelled(axes) == {}
        assert axes.figure.legends == []

    def test_a_law_with_a_length(self) -> None:
        assert len(filled_points(plot_map("goldsmith", "johnson", BRONZE, length=10.0))) > 0


class TestLaws:
    def test_penetrations_are_eq_1_and_eqs_5_and_6(self) -> None:
        axes = plot_laws([cc.laws.Johnson(), "enhanced"], PAIR, load=(20.0, 600.0))
        for name, law in {"johnson": johnson, "enhanced": enhanced}.items():
            load, micrometres = labelled(axes)[name].get_data()
            assert load[[0, -1]] == pytest.approx([20.0, 600.0])
            assert micrometres == pytest.approx(1e3 * law(load, E_STAR, DR), rel=1e-9, abs=0)
        assert axes.get_xscale() == axes.get_yscale() == "log"
        assert axes.get_ylabel() == "penetration (µm)"

    def test_two_rollers(self) -> None:
        rollers = CylinderPair.external(R_i=20.0, R_j=30.0, material=BRONZE)
        line = plot_laws(["enhanced"], rollers).lines[0]
        expected = 1e3 * enhanced(line.get_xdata(), E_STAR, 50.0, "external")
        assert line.get_ydata() == pytest.approx(expected, rel=1e-9, abs=0)

    @pytest.mark.parametrize("relative_to", ["Eq 1", "johnson", cc.laws.Johnson()])
    def test_differences_are_eq_9(self, relative_to) -> None:
        laws = {"Eq 1": cc.laws.Johnson(), "Eqs 5-6": "enhanced"}
        axes = plot_laws(laws, PAIR, relative_to=relative_to)
        load, percent = labelled(axes)["Eqs 5-6"].get_data()
        assert percent == pytest.approx(difference(load, E_STAR, DR), rel=1e-9, abs=1e-9)
        assert labelled(axes)["Eq 1"].get_ydata() == pytest.approx(np.zeros(161), abs=1e-12)
        assert axes.get_yscale() == "linear"

    def test_a_line_ends_where_its_law_does(self) -> None:
        end = johnson_end(E_STAR, DR)
        axes = plot_laws(["johnson", "persson"], PAIR, load=(end / 10, 10 * end))
        load, drawn = labelled(axes)["johnson"].get_data()
        assert (np.isfinite(drawn) == (load <= end)).all()
        assert np.isfinite(labelled(axes)["persson"].get_ydata()).all()


class TestLimits:
    def test_loads_are_eqs_7_and_8(self) -> None:
        axes = plot_limits(BRONZE, R_i=5.0, criterion="Hertz", dR=(0.01, 1.0))
        (dR, yields), (_, ends) = (line.get_data() for line in axes.lines)
        assert dR[[0, -1]] == pytest.approx([0.01, 1.0])
        expected = yield_load(STRENGTH, E_STAR, effective_radius(5.0, dR))
        assert yields == pytest.approx(expected, rel=1e-12, abs=0)
        assert ends == pytest.approx(johnson_end(E_STAR, dR), rel=1e-12, abs=0)
        assert axes.get_ylabel() == "load (N/mm)"

    def test_pressures_are_eq_7(self) -> None:
        axes = plot_limits(BRONZE, criterion="Hertz", pressure=True)
        yields, ends = axes.lines
        assert yields.get_ydata() == pytest.approx(np.full(100, STRENGTH), rel=1e-12)
        dR = ends.get_xdata()
        peak = np.sqrt(johnson_end(E_STAR, dR) * E_STAR / np.pi / effective_radius(10.0, dR))
        assert ends.get_ydata() == pytest.approx(peak, rel=1e-12)
        assert axes.get_ylabel() == "peak pressure (MPa)"


MAP = {"law": "enhanced", "reference": "johnson", "material": BRONZE}
LINES, LIMIT = {"laws": ["johnson"], "pair": PAIR}, {"material": BRONZE}
ARRAY = Material("family", np.array([1e5, 2e5]), 0.3)
REFUSALS = [
    (plot_map, MAP, {"law": "no-such"}, "law = 'no-such': is not a law with its coefficients"),
    (plot_map, MAP, {"law": cc.laws.Enhanced}, "must be a law or its name; give e.g. laws.J"),
    (plot_map, MAP, {"law": "lankarani-nikravesh"}, "length"),
    (plot_map, MAP, {"reference": 3}, "reference = 3: must be a law or its name"),
    (plot_map, MAP, {"dR": (2.0, 0.1)}, "must be two positive numbers, the lower first"),
    (plot_map, MAP, {"load": (1.0, 10.0, 100.0)}, "must be two positive numbers, the lower"),
    (plot_map, MAP, {"dR": (0.1, 12.0)}, "leaves the pin a radius that is not positive"),
    (plot_map, MAP, {"R_i": np.array([5.0, 10.0])}, "must hold single numbers, no arrays"),
    (plot_map, MAP, {"material": "bronze"}, "must be a Material"),
    (plot_map, MAP, {"material": ARRAY}, "must hold single numbers, no arrays; call once"),
    (plot_map, MAP, {"criterion": "hertz"}, "criterion = 'hertz': must be 'von Mises', 'Tr"),
    (plot_map, MAP, {"material": SOFT, "dR": (0.001, 0.002)}, "is undefined in the whole"),
    (plot_laws, LINES, {"laws": []}, "laws = []: must not be empty; give a list of laws, or"),
    (plot_laws, LINES, {"laws": ["johnson", cc.laws.Johnson()]}, "two laws have the same name; "),
    (plot_laws, LINES, {"relative_to": "Johnson"}, "relative_to = 'Johnson': is not a law"),
    (plot_laws, LINES, {"pair": CylinderPair.from_dR("internal", [0.01, 0.02], BRONZE)},
     "pair: must hold single numbers, no arrays; call once for each, with the same ax"),
    (plot_limits, LIMIT, {"criterion": None, "johnson": False}, "leave nothing to draw; give"),
    (plot_limits, LIMIT, {"material": BRITTLE}, "yield_stress: is not known for both materials"),
    (plot_limits, LIMIT, {"dR": (1.0, 0.1)}, "dR = (1.0, 0.1): "),
]  # fmt: skip


@pytest.mark.parametrize(("plot", "good", "changes", "words"), REFUSALS)
def test_bad_input_is_refused_in_one_line(plot, good, changes, words) -> None:
    with pytest.raises(InputError) as caught:
        plot(**good | changes)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
