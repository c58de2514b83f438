"""The figure of two coefficients together: its numbers, from Johnson's law written out anew."""

from pathlib import Path

import numpy as np
import pytest

from cylcontact.materials import shipped_materials

ROOT = Path(__file__).resolve().parents[2]
LOSS_SCALE = 0.04597


@pytest.fixture(scope="module")
def drawing(figures):
    return figures["fig_uncertainty"].drawing


@pytest.mark.slow
def test_the_headline_holds_the_intervals_of_the_example(drawing):
    pinned = {
        "fitted kappa": 1.0195,
        "lowest kappa at 95 %": 0.9842,
        "highest kappa at 95 %": 1.0553,
    }
    pinned |= {"fitted c": -1.0844, "lowest c at 95 %": -1.2662, "highest c at 95 %": -0.8877}
    assert dict(drawing.headline) == pytest.approx(pinned, abs=5e-4)


def huber(kappa, c):
    """Sum of Huber's loss of ln(δ_law/δ) over the table, from its text and the formula."""
    materials = shipped_materials()
    total = 0.0
    for line in (ROOT / "datasets/examples/pin-in-hole.csv").read_text("utf-8").splitlines():
        if line.startswith(("#", "material")):
            continue
        name, dR, f, depth = line.split(",")
        material = materials[name].material
        E_star = material.E / (2 * (1 - material.nu**2))
        dR, f, depth = float(dR) / 1e3, float(f), float(depth) / 1e3
        law = kappa * f / (np.pi * E_star) * (np.log(4 * np.pi * dR * E_star / f) + c)
        r = abs(np.log(law / depth)) / LOSS_SCALE
        total += LOSS_SCALE**2 * (r**2 if r <= 1 else 2 * r - 1)
    return total


def test_the_map_is_the_rise_of_the_loss_over_the_table(drawing):
    noise = drawing.table[drawing.table.panel == "noise"]
    assert len(noise) == 21 * 21
    optimum = huber(*(drawing.headline[f"fitted {name}"] for name in ("kappa", "c")))
    rises = [huber(row.x, row.y) - optimum for row in noise.iloc[::40].itertuples()]
    ratio = noise.height.to_numpy()[::40] / np.array(rises)
    assert ratio == pytest.approx(ratio.mean(), rel=2e-3)


def test_the_published_external_coefficients_cost_what_the_profiles_say(drawing):
    actual = drawing.table[drawing.table.panel == "discrepancy"]
    assert {*actual.coefficient_x} == {"b"}
    assert {*actual.coefficient_y} == {"n"}
    assert 0 <= actual.height.min() < 1e-3
    near = (actual.x - 0.85).abs() / 0.3 + (actual.y - 1.094).abs() / 0.015
    assert 0.05 < actual.height[near.idxmin()] < 0.12
