"""Figures 4 to 6 and the sensitivities, from the committed tables."""

import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from _cylcontact_bench.finite_elements import table

from cylcontact import InputError, limits
from cylcontact.materials import Material
from cylcontact.pair import CylinderPair
from cylcontact.reports.bench import Bench
from tests.paper_equations import e_star, enhanced, johnson

BENCH = Bench(Path(__file__).parents[1])
STEEL = Material("steel", 207e3, 0.3)
E_STAR = e_star(207e3, 0.3)


def rows(name):
    """Read a table without the package."""
    path = BENCH.root / "datasets" / "finite_element" / f"{name}-embedded.csv"
    return pd.read_csv(path, comment="#")


class TestFigures:
    def test_fig04_counts_the_mesh(self, figures):
        drawing = figures["fig04"].drawing
        actual = rows("recommended")
        assert drawing.headline["cells"] == actual.loc[actual["dR_mm"] == 0.1, "cells"].iloc[0]
        assert 1.31 < drawing.headline["length of the cells in the contact, µm"] < 6.63

    @pytest.mark.slow
    def test_fig05_is_hertz_at_1_mm_and_departs_at_10_um(self, figures):
        drawing = figures["fig05"].drawing
        off = {
            name: drawing.headline[f"{name}: largest departure from Hertz, % of its peak"]
            for name in ("1 mm", "0.01 mm")
        }
        assert off["1 mm"] < 3.5
        for dR, part in drawing.table.groupby("dR_mm"):
            pair = CylinderPair.from_dR("internal", float(dR), STEEL, R_i=2.245)
            assert part["hertz_MPa"].max() == pytest.approx(float(limits.hertz_stress(20.0, pair)))

    @pytest.mark.slow
    def test_fig06_holds_every_model(self, figures):
        drawing = figures["fig06"].drawing
        actual = drawing.table
        assert len(actual) == 39
        load, dR = actual["load_N_per_mm"].to_numpy(), actual["dR_mm"].to_numpy()
        assert actual["johnson_mm"].to_numpy() == pytest.approx(johnson(load, E_STAR, dR), rel=1e-9)
        assert actual["enhanced_mm"].to_numpy() == pytest.approx(
            enhanced(load, E_STAR, dR), rel=1e-9
        )
        for load in (20, 40, 100):
            headline = drawing.headline[f"{load} N/mm: calculix less finite elements, largest, %"]
            assert headline < 0.2

    def test_sensitivities_are_shifts_of_one_constant(self, figures):
        actual = figures["fig_fe_sensitivity"].drawing.table.set_index("variant")
        for name in ("outer radius 10 hole radii", "load on a disc of a quarter radius"):
            constants = actual.loc[name, "constant"]
            assert np.ptp(constants) < 0.06 * constants.abs().max()
        assert actual.loc["plane stress", "change_percent"].to_numpy() == pytest.approx(
            9.3, abs=0.3
        )
        assert actual.loc["32 cells instead of 16", "change_percent"].abs().max() < 0.1

    def test_a_missing_table_is_told(self, tmp_path):
        folder = tmp_path / "datasets" / "finite_element"
        folder.mkdir(parents=True)
        source = BENCH.root / "datasets" / "finite_element" / "recommended.toml"
        shutil.copy(source, folder)
        with pytest.raises(InputError, match=r"cannot be read .*make finite-element writes it"):
            table(Bench(tmp_path), "recommended")
