"""The numbers behind Figs 15 to 19 and their companions, and the film."""

import math
from pathlib import Path

import numpy as np
import pytest
from _cylcontact_bench.paths import distances
from _cylcontact_bench.slider_crank import law_limit, limit_reached, mechanism, simulated
from PIL import Image
from scipy.integrate import quad

from cylcontact.joint.contact import stored_energy
from cylcontact.mechanism import Case
from cylcontact.reports.bench import Bench
from tests.support.paper_equations import e_star, effective_radius, johnson, johnson_end

ROOT = Path(__file__).parents[2]
BENCH = Bench(ROOT)
E_STAR = e_star(207e3, 0.3)
LENGTH = 10.0


def test_the_tangent_takes_the_work_of_the_law_at_the_limit_reached():
    """By the integrator's energy; that of the law is f δ − ∫ δ df up to Eq 8's end."""
    one = mechanism(BENCH, Case("johnson", 0.02, 1.0, 0.1))
    at, joint = limit_reached(one), one.clearance.contact
    load, end = johnson_end(E_STAR, 0.02), 4 * 0.02 / math.e**2
    assert law_limit(one) == pytest.approx(end, rel=1e-9)
    inverse, _ = quad(lambda f: johnson(f, E_STAR, 0.02), 0, load)
    work = 1e-3 * LENGTH * (load * end - inverse)
    stored = stored_energy(at * 1e-3, joint.block, joint.kernel.parameters)
    assert stored == pytest.approx(work, rel=1e-7)
    assert end < at < 1.01 * end


@pytest.mark.slow
def test_drawn_mechanisms_close(figures):
    drawing = figures["fig15"].drawing
    found = drawing.headline
    ratio = found["friction force, N"] / found["normal force, N"]
    # Far above v_1 = 10 mm/s all of Coulomb's friction acts, against the sliding.
    assert ratio == pytest.approx(-0.1 * np.sign(found["tangential velocity, m/s"]))
    lengths = drawing.table.set_index("symbol")["value_mm"]
    assert lengths["|e|"] == lengths["c"] + lengths["delta"] == found["eccentricity, mm"]
    drawing = figures["fig16"].drawing
    at = drawing.table.set_index(["body", "point"])
    place = {key: row.to_numpy(dtype=float) for key, row in at.iterrows()}
    assert place["crank", "pin"] == pytest.approx(place["rod", "pin"], abs=1e-9)
    assert math.hypot(*place["rod", "eye"] - place["rod", "pin"]) == pytest.approx(120)
    gap = math.hypot(*place["rod", "eye"] - place["slider", "pin"])
    assert gap == pytest.approx(drawing.headline["eccentricity, mm"], rel=1e-9)


def test_fig17_has_eqs_1_and_2_and_loops_that_lose_energy(figures):
    drawing = figures["fig17"].drawing
    table = drawing.table[drawing.table["penetration_um"] > 0.1]
    rows = table[table["law"] == "johnson"]
    back = 1e3 * johnson(rows["elastic_force_N"] / LENGTH, E_STAR, rows["clearance_mm"])
    assert back.to_numpy() == pytest.approx(rows["penetration_um"].to_numpy(), rel=1e-9)
    rows = table[table["law"] == "lankarani-nikravesh"]
    radius = effective_radius(10.0, rows["clearance_mm"])
    forces = 4 / 3 * E_STAR * np.sqrt(radius) * (1e-3 * rows["penetration_um"]) ** 1.5
    assert forces.to_numpy() == pytest.approx(rows["elastic_force_N"].to_numpy(), rel=1e-9)
    for _, loop in drawing.table.groupby(["law", "clearance_mm"], sort=False):
        depth, excess = loop["penetration_um"], loop["force_N"] - loop["elastic_force_N"]
        deepest = int(depth.to_numpy().argmax())
        assert excess.iloc[1:deepest].gt(0).all()
        assert excess.iloc[deepest + 1 : -1].lt(0).all()
        assert np.trapezoid(loop["force_N"], depth) > 0


def test_what_stays_outside_the_clearance_circle_is_the_share_in_contact():
    case = Case("enhanced", 0.5, 0.9, 0.0)
    run = simulated(BENCH, case, 5)
    table = distances(case, run)
    free = np.interp(500.0, table["distance_um"], table["share"])
    assert 1 - free == pytest.approx(run.statistics(3).mean["contact_fraction"], abs=0.006)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("-o", "x.avi"), "x.avi: is neither .parquet nor .gif nor .mp4; name the output"),
        (("-o", "no/x.gif", "--clearance", "-1"), "joint.wrist-pin.clearance = -1.0"),
    ],
)
def test_a_film_that_cannot_be_made_is_told_in_one_line(
    run, tmp_path, monkeypatch, arguments, message
):
    monkeypatch.chdir(tmp_path)
    code, said, errors = run("simulate", ROOT / "datasets/slider_crank.toml", *arguments)
    assert (code, said, errors.count("\n")) == (2, "", 1)
    assert message in errors
    assert not list(tmp_path.iterdir())


def test_a_film_has_its_frames_and_is_the_same_again(run, tmp_path, monkeypatch):
    monkeypatch.setattr("cylcontact.mechanism.drawing.FRAMES_PER_REVOLUTION", 4)
    pictures = []
    for name in ("a.gif", "b.gif"):
        out = tmp_path / name
        spec = ROOT / "datasets/four_bar.toml"
        code, _, errors = run("simulate", spec, "-o", out, "--revolutions", 1)
        assert (code, errors) == (0, "")
        pictures.append(out.read_bytes())
        with Image.open(out) as picture:
            assert picture.n_frames == 4
    assert pictures[0] == pictures[1]
