"""The numbers behind Figs 15 to 19 and their companions, and the film."""

import functools
import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from _cylcontact_bench.paths import distances
from _cylcontact_bench.slider_crank import (
    CASES,
    LAW_NAMES,
    PAPER_CASES,
    assumed,
    horizons,
    law_ends,
    law_limit,
    limit_reached,
    mechanism,
    simulated,
)
from PIL import Image
from scipy.integrate import quad
from scipy.optimize import brentq

from cylcontact.mechanism import Case, read_mechanism, simulate
from cylcontact.mechanism.contact import stored_energy
from cylcontact.mechanism.drawing import FRAMES_PER_REVOLUTION, driver_circle, film, poses
from cylcontact.reports.bench import Bench
from tests.support.paper_equations import e_star, effective_radius, johnson, johnson_end

ROOT = Path(__file__).parents[2]
BENCH = Bench(ROOT)
SETTLED = Case("enhanced", 0.5, 0.9, 0.1)
E_STAR = e_star(207e3, 0.3)
LENGTH = 10.0


@pytest.fixture(scope="module")
def settled():
    return simulated(BENCH, SETTLED, 3)


@pytest.fixture(scope="module")
def drawing(figures):
    return figures["fig17"].drawing


def sphere_force(depth, dR):
    """Eq 2, from mm to N."""
    return 4 / 3 * E_STAR * np.sqrt(effective_radius(10.0, dR)) * depth**1.5


class TestCases:
    def test_the_paper_has_24_and_the_recommended_law_8(self):
        assert len(set(PAPER_CASES)) == len(PAPER_CASES) == 24
        assert {case.law for case in {*CASES} - {*PAPER_CASES}} == {"explicit"}
        assert len(CASES) == 32

    def test_limit_of_johnsons_law_is_eq_8(self):
        one = mechanism(BENCH, Case("johnson", 0.02, 1.0, 0.1))
        assert law_limit(one) == pytest.approx(4 * 0.02 / math.e**2, rel=1e-9)
        assert law_limit(mechanism(BENCH, SETTLED)) == math.inf

    def test_the_tangent_takes_the_work_of_the_law_at_the_limit_reached(self):
        """By the integrator's energy; that of the law is f δ − ∫ δ df up to Eq 8's end."""
        one = mechanism(BENCH, Case("johnson", 0.02, 1.0, 0.1))
        at, joint = limit_reached(one), one.clearance.contact
        load, end = johnson_end(E_STAR, 0.02), 4 * 0.02 / math.e**2
        inverse, _ = quad(lambda f: johnson(f, E_STAR, 0.02), 0, load)
        work = 1e-3 * LENGTH * (load * end - inverse)
        assert stored_energy(at * 1e-3, joint.block, joint.kernel.parameters) == pytest.approx(
            work, rel=1e-7
        )
        assert end < at < 1.01 * end
        assert limit_reached(mechanism(BENCH, SETTLED)) == math.inf

    def test_a_continued_law_is_told(self):
        case = Case("johnson", 0.02, 1.0, 0.1)
        run = simulated(BENCH, case, 1)
        depths = run.contacts["max_penetration_m"].to_numpy() * 1e3
        limit = 4 * 0.02 / math.e**2
        sentence = law_ends([run])
        assert f"{(depths > 0.9 * limit).sum()} of {depths.size} contacts" in sentence
        # By its work the law itself would end at 10.88 µm of the softer tangent.
        assert f"{(depths > 0.010879).sum()} of them with more work than" in sentence
        assert (depths > 0.010879).any()

    def test_nothing_is_told_where_the_law_holds(self, settled):
        assert law_ends([settled]) == "No law leaves its domain in these runs."

    @pytest.mark.parametrize("clearance", [0.5, 0.02])
    def test_horizons_are_the_tables(self, clearance):
        table = pd.read_csv(ROOT / "datasets/mechanism/cases.csv")
        actual = table[table["clearance_mm"] == clearance]["horizon_revolutions"]
        sentence = horizons(BENCH, clearance)
        assert f"in {(actual == 20).sum()} of the 16 cases" in sentence
        assert f"{actual.min():.2g} to {actual[actual < 20].max():.2g} revolutions" in sentence

    def test_assumptions_are_the_specs(self):
        sentence = assumed(mechanism(BENCH))
        assert "crank 50 mm, 0.3 kg, 0.0001 kg m²" in sentence
        assert "rod 120 mm, 0.21 kg, 0.00025 kg m²" in sentence
        assert "slider 0.14 kg" in sentence


class TestDrawnMechanism:
    def test_fig15_is_eqs_11_to_14(self, figures):
        drawing = figures["fig15"].drawing
        actual = drawing.headline
        lengths = drawing.table.set_index("symbol")["value_mm"]
        assert lengths["|e|"] == lengths["c"] + lengths["delta"] == actual["eccentricity, mm"]
        assert lengths["c"] == lengths["R_i"] - lengths["R_j"] == 0.5
        # Far above v_1 = 10 mm/s all of Coulomb's friction acts, against the sliding.
        assert abs(actual["tangential velocity, m/s"]) > 0.01
        ratio = actual["friction force, N"] / actual["normal force, N"]
        assert ratio == pytest.approx(-0.1 * np.sign(actual["tangential velocity, m/s"]))
        drawn = drawing.table.set_index("symbol")["drawn_mm"]
        assert drawn["|e|"] == pytest.approx(drawn["c"] + drawn["delta"])
        assert drawn["c"] == pytest.approx(drawn["R_i"] - drawn["R_j"])

    def test_fig16_closes(self, figures):
        drawing = figures["fig16"].drawing
        at = drawing.table.set_index(["body", "point"])
        place = {key: row.to_numpy(dtype=float) for key, row in at.iterrows()}
        assert place["crank", "pin"] == pytest.approx(place["rod", "pin"], abs=1e-9)
        assert place["crank", "pivot"] == pytest.approx([0, 0], abs=1e-9)
        rod = place["rod", "eye"] - place["rod", "pin"]
        assert math.hypot(*rod) == pytest.approx(120, rel=1e-12)
        gap = place["rod", "eye"] - place["slider", "pin"]
        assert math.hypot(*gap) == pytest.approx(drawing.headline["eccentricity, mm"], rel=1e-9)
        assert place["slider", "pin"][1] == pytest.approx(0, abs=1e-9)
        assert drawing.headline["radius of the crank circle, mm"] == pytest.approx(50)

    def test_any_mechanism_can_be_drawn(self):
        run = simulate(read_mechanism(ROOT / "datasets/four_bar.toml"), revolutions=1)
        (pose,) = poses(run, np.array([0.0]))
        assert set(pose.points) == {"ground", "crank", "coupler", "rocker"}
        (x, y), radius = driver_circle(run.mechanism, pose)
        assert (x, y) == (0.0, 0.0)
        assert radius == pytest.approx(40.0)


class TestImpacts:
    def test_elastic_forces_are_eqs_1_and_2(self, drawing):
        table = drawing.table[drawing.table["penetration_um"] > 0.1]
        rows = table[table["law"] == "johnson"]
        back = johnson(rows["elastic_force_N"] / LENGTH, E_STAR, rows["clearance_mm"])
        assert 1e3 * back.to_numpy() == pytest.approx(rows["penetration_um"].to_numpy(), rel=1e-9)
        sphere = table[table["law"] == "lankarani-nikravesh"]
        forces = sphere_force(sphere["penetration_um"] * 1e-3, sphere["clearance_mm"])
        assert forces.to_numpy() == pytest.approx(sphere["elastic_force_N"].to_numpy(), rel=1e-9)

    def test_loops_lose_energy_and_go_above_the_law_first(self, drawing):
        for _, loop in drawing.table.groupby(["law", "clearance_mm"], sort=False):
            depth, excess = loop["penetration_um"], loop["force_N"] - loop["elastic_force_N"]
            deepest = int(depth.to_numpy().argmax())
            assert excess.iloc[1:deepest].gt(0).all()
            assert excess.iloc[deepest + 1 : -1].lt(0).all()
            assert np.trapezoid(loop["force_N"], depth) > 0

    def test_all_laws_meet_the_same_impact(self):
        for clearance in (0.5, 0.02):
            rates = {
                simulated(BENCH, Case(law, clearance, 0.9, 0.0), 1).contacts.loc[
                    0, "impact_rate_m_per_s"
                ]
                for law in LAW_NAMES
            }
            assert max(rates) - min(rates) < 1e-9 * max(rates)

    def test_johnsons_peak_is_higher_as_its_law_takes_the_work_at_a_higher_load(self, drawing):
        """The load of Eq 1 at the work of the explicit law's deepest point, as f δ − ∫ δ df."""
        rows = drawing.table[drawing.table["clearance_mm"] == 0.02]
        loops = {law: loop.sort_values("penetration_um") for law, loop in rows.groupby("law")}
        curve = loops["explicit"]
        work = np.trapezoid(curve["elastic_force_N"], curve["penetration_um"] * 1e-3) / LENGTH

        def excess(load):
            delta = lambda f: johnson(f, E_STAR, 0.02)  # noqa: E731
            return load * delta(load) - quad(delta, 0, load)[0] - work

        load = brentq(excess, 1.0, johnson_end(E_STAR, 0.02))
        at_equal_work = load * LENGTH / curve["elastic_force_N"].max()
        actual = loops["johnson"]["force_N"].max() / curve["force_N"].max()
        # A deeper contact lasts longer, and the mechanism moves on: its work differs by 4 %.
        assert actual == pytest.approx(at_equal_work, rel=0.05)
        assert actual > 1.3

    def test_headlines(self, drawing):
        actual = drawing.headline
        assert actual["0.5 mm, Johnson stiffer than enhanced from, um"] == pytest.approx(
            27.73, abs=0.05
        )
        assert actual["0.02 mm, Johnson stiffer than enhanced from, um"] == pytest.approx(
            5.53, abs=0.02
        )
        assert actual["0.5 mm, johnson: force, N"] == pytest.approx(54218, rel=1e-3)
        assert actual["0.02 mm, enhanced: force, N"] == pytest.approx(16910, rel=1e-3)
        johnson_over = actual["0.02 mm, Johnson's largest force over the explicit law's, %"]
        assert johnson_over == pytest.approx(34.3, abs=0.2)


class TestDistances:
    def test_what_stays_outside_the_clearance_circle_is_the_share_in_contact(self):
        case = Case("enhanced", 0.5, 0.9, 0.0)
        run = simulated(BENCH, case, 5)
        table = distances(case, run)
        assert (np.diff(table["distance_um"]) >= 0).all()
        free = np.interp(500.0, table["distance_um"], table["share"])
        assert 1 - free == pytest.approx(run.statistics(3).mean["contact_fraction"], abs=0.006)


class TestSteps:
    def test_lines_are_the_distributions_of_the_tables_steps(self, figures):
        drawing = figures["fig_mechanism_steps"].drawing
        lines = [line for axes in drawing.figure.axes for line in axes.get_lines()]
        by_count = {line.get_label().rpartition("(")[2]: line for line in lines}
        cases = drawing.table.groupby(["clearance_mm", "restitution", "mode"])["step_us"]
        assert len(cases) == 6
        for _, steps in cases:
            line = by_count[f"{len(steps)})"]
            x, y = line.get_xdata(), line.get_ydata()
            for length in steps.quantile([0.2, 0.5, 0.8]):
                assert y[x <= length].max() == (steps <= length).mean()


class TestFilm:
    @pytest.mark.slow
    def test_film_is_short_enough_and_the_same_again(self, tmp_path, settled, monkeypatch):
        monkeypatch.setattr("cylcontact.mechanism.drawing.FRAMES_PER_REVOLUTION", 6)
        calls = []
        for name in ("a.gif", "b.gif"):
            frames = film(settled, tmp_path / name, 2, lambda *call: calls.append(call))
        assert frames == 6 < FRAMES_PER_REVOLUTION
        assert (tmp_path / "a.gif").read_bytes() == (tmp_path / "b.gif").read_bytes()
        assert calls[-1] == ("frames", 6, 6)
        with Image.open(tmp_path / "a.gif") as picture:
            assert picture.n_frames == 6
            pictures = []
            for number in range(6):
                picture.seek(number)
                pictures.append(np.asarray(picture.convert("L"), dtype=float))
        assert all(np.abs(a - b).max() > 100 for a, b in pairwise(pictures))


class TestFilmCommand:
    @pytest.fixture
    def run(self, run, monkeypatch):
        """Run `cylcontact simulate` in this process, with few frames."""
        monkeypatch.setattr("cylcontact.mechanism.drawing.FRAMES_PER_REVOLUTION", 4)
        return functools.partial(run, "simulate")

    def test_writes_a_film_and_tells_what_is_assumed(self, run, tmp_path):
        out = tmp_path / "four-bar.gif"
        code, said, errors = run(ROOT / "datasets/four_bar.toml", "-o", out, "--first", 0)
        assert (code, errors) == (0, "")
        assert "Assumed: start: every pin centred in its bearing" in said
        assert f"written to {out}" in said
        with Image.open(out) as picture:
            assert picture.n_frames == 4

    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            (("-o", "x.avi"), "x.avi: is neither .parquet nor .gif nor .mp4; name the output"),
            (("-o", "no/x.gif", "--clearance", "-1"), "joint.wrist-pin.clearance = -1.0"),
        ],
    )
    def test_bad_input_is_one_line_and_leaves_nothing(
        self, run, tmp_path, monkeypatch, arguments, message
    ):
        monkeypatch.chdir(tmp_path)
        code, said, errors = run(ROOT / "datasets/slider_crank.toml", *arguments)
        assert (code, said) == (2, "")
        assert errors.count("\n") == 1
        assert message in errors
        assert not list(tmp_path.iterdir())
