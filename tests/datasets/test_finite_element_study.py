"""Set-up files, their studies and tables, the command around them, and what reads the tables."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from benchmarks.calculix import run_case
from cylcontact import InputError, laws
from cylcontact.datasets.finite_element import (
    Setup,
    outer_ratio_like_johnson,
    read_study,
    read_table,
    run_study,
    solve,
)
from cylcontact.datasets.finite_element.study import study_from
from tests.support.programs import require_program
from tests.support.spec_files import DROP, ELEMENTS, changed, tree, write_toml

ROOT = Path(__file__).parents[2]
TABLES = ROOT / "datasets" / "finite_element"
# A pin of another material.
BOTH = changed(
    ELEMENTS,
    {
        "pin_E": 3.6,
        "pin_nu": 0.38,
        "origin.pin_E": "assumed",
        "origin.pin_nu": "assumed",
        "variants": [{"name": "aluminium", "pin_E": 70.0, "pin_nu": 0.4999}],
    },
)


_AXES = {"E": [207.0], "nu": [0.3], "dR": [0.1, 0.2], "load": [10.0, 20.0]}
AXES = {"axes": {name: {"values": values} for name, values in _AXES.items()}}


def rows_of(name):
    """Read a committed table without the package."""
    return pd.read_csv(TABLES / f"{name}.csv", comment="#")


def base_of(name):
    return read_study(TABLES / f"{name}.toml").setups["base"]


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """A folder with a small set-up."""
    write_toml(tmp_path / "small.toml", ELEMENTS)
    monkeypatch.chdir(tmp_path)
    return tmp_path


class TestFiles:
    @pytest.mark.parametrize(
        ("changes", "message"),
        [
            ({"dR": [0.0, 0.1]}, "dR = [0.0, 0.1]: must be positive and increasing"),
            ({"dR": [0.1, 2.5]}, "dR = 2.5: must lie between 0 and the radius of the hole"),
            ({"E": 207e9}, "E = 207000000000.0: a bare number is in GPa, and diamond has 1200"),
            ({"E": "steel"}, "E = 'steel': must be a number"),
            ({"pin_E": 0.0}, "pin_E = 0.0: must be greater than 0"),
            ({"pin_nu": 0.6}, "pin_nu = 0.6: must be less than or equal to 0.5"),
            (
                {"clamp": "pulled:5", "origin.clamp": "assumed"},
                "clamp = 'pulled:5': must be a sector",
            ),
            ({"origin.E": DROP}, "origin.E: is required; mark each key as paper"),
            ({"origin.clamp": "paper"}, "origin.clamp: is not a key of this file"),
            ({"variants": [{"cells": 8}]}, "variants.0: name: is required"),
            ({"variants": [{"name": "a,b"}]}, "must not contain commas, quotes or #"),
            ({"variants": [{"name": "a", "dR": [1.0]}]}, "dR = [1.0]: cannot vary"),
            ({"variants": [{"name": "a"}, {"name": "a"}]}, "'a': is used twice"),
            ({"variants": [{"name": "a", "nu": 0.5}]}, "variants.0: nu = 0.5: must not exceed"),
        ],
    )
    def test_mistakes_are_told(self, changes, message):
        with pytest.raises(InputError) as caught:
            study_from(changed(ELEMENTS, changes), "small", "small.toml")
        assert message in str(caught.value)
        assert str(caught.value).startswith("small.toml")

    def test_variants_change_what_they_name(self):
        variants = [{"name": "stress", "plane": "stress"}, {"name": "eye", "clamp": "pulled:60"}]
        study = study_from(changed(ELEMENTS, {"variants": variants}), "small", "small.toml")
        base = dict(study.setups["base"])
        assert base["cells"] == 6
        assert dict(study.setups["stress"]) == base | {"plane": "stress"}
        assert dict(study.setups["eye"]) == base | {"clamp": laws.Sector(60.0, "pulled")}


class TestCommittedTables:
    @pytest.mark.parametrize("name", ["recommended", "paper", "sensitivity", "convergence"])
    def test_they_are_of_their_set_ups(self, name):
        study = read_study(TABLES / f"{name}.toml")
        rows, header = read_table(TABLES / f"{name}-embedded.csv")
        assert header["set-up"] == study.key
        sentence = f"outer_radius_mm = 7.4085 (3.3 hole radii, {study.origin['outer_ratio']})"
        assert sentence in header["calibrated"]
        assert len(rows) == len(study.setups) * len(study.dR) * len(study.load)

    def test_a_fresh_run_gives_the_same_numbers(self):
        rows = rows_of("recommended-embedded")
        cases = solve(base_of("recommended"), 0.1, [20.0, 40.0, 100.0])
        committed = rows.loc[rows["dR_mm"] == 0.1, "penetration_mm"].to_numpy()
        assert [case.penetration for case in cases] == pytest.approx(committed, rel=1e-6)

    def test_calculix_gives_the_same(self):
        one, other = (rows_of(f"recommended-{name}") for name in ("embedded", "calculix"))
        assert len(one) == len(other) == 39
        ratio = other["penetration_mm"] / one["penetration_mm"]
        assert np.abs(ratio - 1).max() < 0.002

    @pytest.mark.slow
    def test_a_fresh_run_of_calculix_gives_the_committed_row(self):
        require_program("ccx")
        other = rows_of("recommended-calculix")
        row = other[(other["dR_mm"] == 0.005) & (other["load_N_per_mm"] == 100)].iloc[0]
        penetration, _ = run_case(base_of("recommended"), 0.005, 100.0, [20.0, 40.0, 100.0])
        assert penetration == pytest.approx(row["penetration_mm"], rel=1e-5)

    @pytest.mark.slow
    def test_the_outer_ratio_is_the_one_that_gives_johnsons_constant(self):
        setup = base_of("recommended")
        assert read_study(TABLES / "recommended.toml").origin["outer_ratio"] == "derived"
        assert round(outer_ratio_like_johnson(setup), 1) == setup.outer_ratio

    def test_an_outer_ratio_that_does_not_exist_is_told(self):
        keys = {"cells": 6, "load_on": "centre", "plane": "stress"}
        setup = Setup(**dict(base_of("recommended")) | keys)
        with pytest.raises(InputError, match="between 2 and 10 never gives Johnson's penetration"):
            outer_ratio_like_johnson(setup, [1.0], [20.0])

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ((TABLES / "recommended-embedded.csv").read_text().replace("0.0002753", "0.0002754", 1),
             "the table was edited by hand"),
            ("a,b\n1,2\n", "is not a table of finite elements"),
            ("# study: x\nnonsense\n", "is not a table of finite elements"),
            (None, "cannot be read"),
        ],
    )  # fmt: skip
    def test_other_files_are_refused(self, tmp_path, text, message):
        path = tmp_path / "other.csv"
        if text is not None:
            path.write_text(text)
        with pytest.raises(InputError, match=message):
            read_table(path)


class TestCommand:
    @pytest.mark.slow
    def test_writes_a_table_whatever_the_workers(self, bench, run):
        code, out, _ = run("finite-element", "small.toml", "--jobs", 1)
        assert code == 0
        assert "small-embedded.csv: 4 cases by embedded" in out
        once = (bench / "small-embedded.csv").read_bytes()
        assert run("finite-element", "small.toml", "-o", "other.csv", "-j", 2)[0] == 0
        assert (bench / "other.csv").read_bytes() == once
        assert set(tree(bench)) == {"small.toml", "small-embedded.csv", "other.csv"}

    def test_a_table_of_other_inputs_is_not_replaced(self, bench, run):
        target = bench / "small-embedded.csv"
        for contents, rule in (
            ((TABLES / "recommended-embedded.csv").read_bytes(), "came from another set-up, not"),
            (b"mine", "exists and is not a readable table of finite elements; write elsewhere"),
        ):
            target.write_bytes(contents)
            code, _, err = run("finite-element", "small.toml")
            assert (code, rule in err, target.read_bytes()) == (2, True, contents)
        assert run("finite-element", "small.toml", "--force", "-j", 1)[0] == 0

    def test_resumes_what_is_kept(self, bench, run):
        run("finite-element", "small.toml", "-j", 1)
        written = bench / "small-embedded.csv"
        whole = written.read_bytes()
        kept = bench / "small-embedded.csv.partial"
        study = read_study("small.toml")
        run_study(study, checkpoint=kept)
        lines = kept.read_text().splitlines(keepends=True)
        assert len(lines) == 5
        # A kill cuts a line short, be it the first or the second of two loads solved together.
        for complete in (3, 2):
            kept.write_text("".join(lines[:complete]) + lines[complete][:20])
            counts = []
            rows, _ = run_study(
                study, 1, lambda _, done, __, to=counts: to.append(done), kept, resume=True
            )
            assert (counts[0], counts[-1], len(rows)) == (complete - 1, 4, 4)
        kept.write_text("".join(lines[:3]))
        written.unlink()
        assert run("finite-element", "small.toml", "--resume", "-j", 1)[0] == 0
        assert written.read_bytes() == whole
        assert not kept.exists()

    @pytest.mark.parametrize(
        ("size", "said"),
        [
            (0.015, "base, ΔR = 0.5 mm, 20, 40 N/mm: is too coarse|2 of 4 cases|keeps the others"),
            (0.1, "is too coarse|4 of 4 cases have no solution|correct the set-up"),
        ],
    )
    def test_a_mesh_too_coarse_fails_its_cases_alone(self, bench, run, size, said):
        write_toml(
            bench / "coarse.toml", changed(ELEMENTS, {"size": size, "origin.size": "assumed"})
        )
        code, _, err = run("finite-element", "coarse.toml", "-j", 1)
        assert code == 2
        assert all(part in err for part in said.split("|"))
        assert not (bench / "coarse-embedded.csv").exists()

    def test_a_pin_of_its_own_material(self, bench, run):
        study = read_study(write_toml(bench / "both.toml", BOTH))
        assert run("finite-element", "both.toml", "-j", 1)[0] == 0
        rows = read_table("both-embedded.csv").rows
        pins = rows[["variant", "pin_E_GPa", "pin_nu"]].drop_duplicates()
        assert pins.to_numpy().tolist() == [["base", 3.6, 0.38], ["aluminium", 70.0, 0.4999]]
        assert (rows["E_GPa"].unique(), rows["nu"].unique()) == (ELEMENTS["E"], ELEMENTS["nu"])
        kept = bench / "kept"
        solved, _ = run_study(study, checkpoint=kept)
        pd.testing.assert_frame_equal(run_study(study, checkpoint=kept, resume=True)[0], solved)
        pd.testing.assert_frame_equal(solved, rows, rtol=1e-6, check_dtype=False)
