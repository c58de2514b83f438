"""Set-up files, studies, their tables, and the command around them."""

import copy
import json
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from cylcontact import InputError, laws, limits
from cylcontact.datasets import read_grid, write_samples
from cylcontact.datasets.finite_element import (
    outer_ratio_like_johnson,
    read_study,
    read_table,
    run_study,
    solve,
)
from cylcontact.datasets.finite_element.calculix_deck import make_deck
from cylcontact.datasets.finite_element.outer_ratio import mean_offset
from cylcontact.datasets.finite_element.spec import study_from
from cylcontact.datasets.grid import grid_from
from cylcontact.fitting import FitResult, read_campaign
from tests.programs import fake_program
from tests.spec_files import DROP, ELEMENTS, changed, tree, write_toml

ROOT = Path(__file__).parents[1]
TABLES = ROOT / "datasets" / "finite_element"
NAMES = ("recommended", "paper", "sensitivity", "convergence")
in_bench = pytest.mark.usefixtures("bench")
posix = pytest.mark.skipif(os.name == "nt", reason="a shell script stands for CalculiX")


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """A folder with a small set-up."""
    write_toml(tmp_path / "small.toml", ELEMENTS)
    monkeypatch.chdir(tmp_path)
    return tmp_path


class TestSpec:
    @pytest.mark.parametrize(
        ("changes", "message"),
        [
            ({"dR": [0.0, 0.1]}, "dR = [0.0, 0.1]: must be positive and increasing"),
            ({"dR": [0.1, 2.5]}, "dR = 2.5: must lie between 0 and the radius of the hole"),
            ({"E": 207e9}, "E = 207000000000.0: a bare number is in GPa, and diamond has 1200"),
            ({"E": "207e9 GPa"}, "E = '207e9 GPa': is beyond any material"),
            ({"load": []}, "load = []: must be positive and increasing"),
            ({"origin.E": DROP}, "origin.E: is required; mark each key as paper"),
            ({"origin.clamp": "paper"}, "origin.clamp: is not a key of this file"),
            ({"variants": [{"cells": 8}]}, "variants.0: name: is required"),
            ({"variants": [{"name": "a,b"}]}, "must not contain commas, quotes or #"),
            ({"variants": [{"name": "a", "dR": [1.0]}]}, "dR = [1.0]: cannot vary"),
            ({"variants": [{"name": "a"}, {"name": "a"}]}, "'a': is used twice"),
            ({"variants": [{"name": "a", "cells": 1}]}, "cells = 1: must be at least 4"),
        ],
    )
    def test_mistakes_are_told(self, changes, message):
        spec = changed(ELEMENTS, changes)
        with pytest.raises(InputError) as caught:
            study_from(spec, "small", "small.toml")
        assert message in str(caught.value)
        assert str(caught.value).startswith("small.toml")

    def test_variants_change_what_they_name(self):
        spec = changed(ELEMENTS, {"variants": [{"name": "stress", "plane": "stress"}]})
        study = study_from(spec, "small", "small.toml")
        assert list(study.setups) == ["base", "stress"]
        assert study.setups["stress"].plane == "stress"
        assert study.setups["stress"].cells == study.setups["base"].cells == 6

    def test_the_papers_set_up_is_marked_as_such(self):
        study = read_study(TABLES / "paper.toml")
        setup = study.setups["base"]
        assert (setup.plane, setup.load_on, setup.clamp) == ("stress", "centre", "upper half")
        assert study.origin["outer_ratio"] == "assumed"
        assert study.origin["plane"] == study.origin["load_on"] == study.origin["size"] == "paper"


class TestCommittedTables:
    @pytest.mark.parametrize("name", NAMES)
    def test_they_are_of_their_set_ups(self, name):
        study, actual = (
            read_study(TABLES / f"{name}.toml"),
            read_table(TABLES / f"{name}-embedded.csv"),
        )
        assert actual.header["set-up"] == study.key
        sentence = "outer_radius_mm = 7.4085 (3.3 hole radii, {})".format(
            study.origin["outer_ratio"]
        )
        assert sentence in actual.header["calibrated"]
        assert len(actual.rows) == len(study.setups) * len(study.dR) * len(study.load)

    def test_embedded_and_calculix_agree_in_all_39_cases(self):
        one, other = (
            read_table(TABLES / f"recommended-{engine}.csv").rows
            for engine in ("embedded", "calculix")
        )
        assert len(one) == len(other) == 39
        ratio = other["penetration_mm"] / one["penetration_mm"]
        assert np.abs(ratio - 1).max() < 0.002

    def test_a_fresh_run_gives_the_same_numbers(self):
        study = read_study(TABLES / "recommended.toml")
        rows = read_table(TABLES / "recommended-embedded.csv").rows
        for dR in (0.005, 0.1):
            actual = [case.penetration for case in solve(study.setups["base"], dR, study.load)]
            committed = rows.loc[rows["dR_mm"] == dR, "penetration_mm"].to_numpy()
            assert actual == pytest.approx(committed, rel=1e-6)

    def test_johnson_outside_the_conformal_range(self):
        rows = read_table(TABLES / "recommended-embedded.csv").rows
        pair = read_study(TABLES / "recommended.toml").setups["base"].pair(rows["dR_mm"].to_numpy())
        load, actual = rows["load_N_per_mm"].to_numpy(), rows["penetration_mm"].to_numpy()
        johnson = laws.Johnson().penetration(load, pair)
        persson = laws.Persson().penetration(load, pair)
        plain = np.abs(johnson / persson - 1) < 0.001
        assert np.count_nonzero(plain) > 20
        assert np.abs(actual / johnson - 1)[plain].max() < 0.0015
        # Inside it, above Johnson, and as much as Persson has it but for the plate's finite size.
        conformal = johnson / persson < 0.98
        assert np.count_nonzero(conformal) >= 2
        above, predicted = (actual / johnson - 1)[conformal], (persson / johnson - 1)[conformal]
        assert np.all((above > predicted) & (above < 1.4 * predicted))
        assert np.corrcoef(actual / johnson, persson / johnson)[0, 1] > 0.99

    @pytest.mark.slow
    def test_the_outer_ratio_is_the_one_that_gives_johnsons_constant(self):
        study = read_study(TABLES / "recommended.toml")
        ratio = study.setups["base"].outer_ratio
        assert study.origin["outer_ratio"] == "derived"
        # To the one decimal that it has: the constant changes sign within half of it.
        below, above = (
            mean_offset(replace(study.setups["base"], outer_ratio=near), (1.0,), study.load)
            for near in (ratio - 0.05, ratio + 0.05)
        )
        assert below < 0 < above

    def test_an_outer_ratio_that_does_not_exist_is_told(self):
        setup = replace(read_study(TABLES / "recommended.toml").setups["base"], cells=6)
        with pytest.raises(InputError, match="between 2 and 10 never gives Johnson's penetration"):
            outer_ratio_like_johnson(
                replace(setup, load_on="centre", plane="stress"), [1.0], [20.0]
            )

    def test_peak_pressure_converges_to_hertz(self):
        rows = read_table(TABLES / "convergence-embedded.csv").rows
        study = read_study(TABLES / "convergence.toml")
        wide = rows[(rows["dR_mm"] == 1.0) & (rows["load_N_per_mm"] == 20.0)]
        hertz = float(limits.hertz_stress(20.0, study.setups["base"].pair(1.0)))
        peaks = wide.set_index("variant")["peak_pressure_MPa"] / hertz - 1
        errors = peaks[["cells 4", "cells 8", "cells 16", "cells 32", "base"]].abs()
        assert errors.is_monotonic_decreasing
        assert errors["cells 16"] < 0.005

    def test_a_table_edited_by_hand_is_refused(self, tmp_path):
        text = (TABLES / "recommended-embedded.csv").read_text()
        path = tmp_path / "edited.csv"
        path.write_text(text.replace("0.0002753", "0.0002754", 1))
        with pytest.raises(InputError, match="the table was edited by hand"):
            read_table(path)

    @pytest.mark.parametrize("text", ["a,b\n1,2\n", "", "# study: x\nnonsense\n"])
    def test_other_files_are_refused(self, tmp_path, text):
        path = tmp_path / "other.csv"
        path.write_text(text)
        with pytest.raises(InputError, match="is not a table of finite elements"):
            read_table(path)
        with pytest.raises(InputError, match="cannot be read"):
            read_table(tmp_path / "none.csv")


class TestCommand:
    def test_writes_a_table_whatever_the_workers(self, bench, run):
        code, out, _ = run("finite-element", "small.toml", "--jobs", 1)
        assert code == 0
        assert "small-embedded.csv: 4 cases by embedded" in out
        once = (bench / "small-embedded.csv").read_bytes()
        assert run("finite-element", "small.toml", "-o", "other.csv", "-j", 2)[0] == 0
        assert (bench / "other.csv").read_bytes() == once
        assert set(tree(bench)) == {"small.toml", "small-embedded.csv", "other.csv"}

    def test_resumes_what_is_kept(self, bench, run):
        run("finite-element", "small.toml", "-j", 1)
        table = bench / "small-embedded.csv"
        whole = table.read_bytes()
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
                study,
                "embedded",
                1,
                lambda _, done, __, to=counts: to.append(done),
                kept,
                resume=True,
            )
            assert (counts[0], counts[-1], len(rows)) == (complete - 1, 4, 4)
        kept.write_text("".join(lines[:3]))
        table.unlink()
        assert run("finite-element", "small.toml", "--resume", "-j", 1)[0] == 0
        assert table.read_bytes() == whole
        assert not kept.exists()

    def test_kept_cases_of_another_set_up_are_refused(self, bench, run):
        kept = bench / "small-embedded.csv.partial"
        kept.write_text(json.dumps({"format": 1, "study": "another"}) + "\n")
        code, _, err = run("finite-element", "small.toml", "--resume")
        assert code == 2
        assert "belongs to other work: its study or settings differ; run without --resume" in err
        run_study(read_study("small.toml"), checkpoint=kept)
        kept.write_text(kept.read_text() + "{}\n")
        code, _, err = run("finite-element", "small.toml", "--resume")
        assert (code, err.count("\n")) == (2, 1)
        assert "has a damaged line" in err

    @in_bench
    def test_unknown_engine(self, run):
        code, _, err = run("finite-element", "small.toml", "--engine", "marc")
        assert code == 2
        assert "'marc': is not an engine; choose embedded or calculix" in err

    def test_without_calculix(self, bench, run, monkeypatch):
        monkeypatch.setenv("PATH", str(bench))
        code, _, err = run("finite-element", "small.toml", "--engine", "calculix")
        assert (code, err.count("\n")) == (2, 1)
        assert "apt install calculix-ccx" in err
        assert set(tree(bench)) == {"small.toml"}

    @posix
    def test_other_cases_are_kept_when_the_solver_fails(self, bench, run, monkeypatch):
        write_results = (
            "printf ' displacements\\n\\n 9 0. 4.0E-04 0.\\n\\n stresses\\n\\n 1 1 0. -5.0E+02\\n"
            "\\n displacements\\n\\n 9 0. 4.0E-04 0.\\n' > case.dat"
        )
        # The cases at 0.5 mm have the larger plate mesh: kill one, let the others pass.
        study, sizes = read_study("small.toml"), []
        for dR in study.dR:
            mesh = study.setups["base"].mesh(dR, study.loads)
            sizes.append(make_deck(study.setups["base"], dR, 20.0, mesh).text.count("\n"))
        script = fake_program(
            bench / "bin",
            "ccx",
            "case $1 in -v) echo 'This is Version 9.9'; exit;; esac\n"
            f"if [ $(grep -c '' case.inp) -gt {sum(sizes) // 2} ]; then "
            "echo 'about to die'; kill -9 $$; fi\n" + write_results,
        )
        monkeypatch.setenv("PATH", f"{script.parent}:{os.environ['PATH']}")
        code, _, err = run("finite-element", "small.toml", "--engine", "calculix", "-j", 2)
        assert code == 2
        assert "base, ΔR = 0.5 mm, 20 N/mm: CalculiX was killed by signal 9" in err
        assert "    about to die" in err
        assert "2 of 4 cases have no solution" in err
        assert not (bench / "small-calculix.csv").exists()
        kept = (bench / "small-calculix.csv.partial").read_text().splitlines()
        assert "CalculiX 9.9" in kept[0]
        assert len(kept) == 3
        script.write_text(script.read_text().replace("kill -9 $$", "true"))
        code, out, _ = run("finite-element", "small.toml", "--engine", "calculix", "--resume")
        assert (code, "4 cases by CalculiX 9.9" in out) == (0, True)

    def test_a_mesh_too_coarse_fails_its_cases_alone(self, bench, run):
        spec = changed(ELEMENTS, {"size": 0.015, "origin.size": "assumed"})
        write_toml(bench / "coarse.toml", spec)
        code, _, err = run("finite-element", "coarse.toml", "-j", 1)
        assert code == 2
        assert "base, ΔR = 0.5 mm, 20, 40 N/mm: is too coarse" in err
        assert "2 of 4 cases have no solution" in err


class TestReference:
    def test_the_grid_is_the_table(self):
        grid = read_grid(ROOT / "datasets/finite-element.toml")
        rows = read_table(TABLES / "recommended-embedded.csv").rows
        assert grid.shape == (1, 1, 13, 3)
        assert grid.penetrations.ravel() == pytest.approx(rows["penetration_mm"].to_numpy())

    def test_samples_are_the_tables_own(self, tmp_path):
        counts = write_samples(read_grid(ROOT / "datasets/finite-element.toml"), tmp_path / "s.csv")
        assert (counts.samples, counts.masked) == (39, 0)
        rows = read_table(TABLES / "recommended-embedded.csv").rows
        written = pd.read_csv(tmp_path / "s.csv")
        for column in written:
            assert written[column].to_numpy() == pytest.approx(rows[column].to_numpy(), rel=1e-12)

    def test_committed_fit_is_of_the_committed_table(self):
        result = FitResult.read(ROOT / "fitting/results/finite-element.json")
        campaign = read_campaign(ROOT / "fitting/finite-element.toml")
        assert result.reference == "finite-element"
        assert result.counts.samples == 39
        assert json.loads(json.dumps(campaign.settings)) == result.settings
        assert result.objective.value < 0.3 * result.published.objective

    @pytest.mark.parametrize(
        ("changes", "message"),
        [
            ({"table": DROP}, 'table: is required with reference = "finite-element"'),
            ({"table": "none.csv"}, "cannot be read"),
            ({"axes": {}}, "axes: cannot be combined with table"),
            ({"contact": "external"}, "contact = 'external': must be internal"),
        ],
    )
    def test_mistakes_in_a_grid_are_told(self, tmp_path, changes, message):
        spec = changed(
            {
                "contact": "internal",
                "reference": "finite-element",
                "table": str(TABLES / "recommended-embedded.csv"),
            },
            changes,
        )
        with pytest.raises(InputError) as caught:
            read_grid(write_toml(tmp_path / "grid.toml", spec))
        assert message in str(caught.value)

    @pytest.mark.parametrize(
        ("penetrations", "rule"),
        [
            ([[1e-4, 2e-4]], "a list for each dR with a number for each load"),
            ([[1e-4, 2e-4], [1e-4, -2e-4]], "must be positive"),
        ],
    )
    def test_penetrations_must_fit_the_axes(self, penetrations, rule):
        axes = {"E": [207.0], "nu": [0.3], "dR": [0.1, 0.2], "load": [10.0, 20.0]}
        spec = {
            "contact": "internal",
            "reference": "finite-element",
            "axes": {name: {"values": values} for name, values in axes.items()},
            "penetrations": penetrations,
        }
        with pytest.raises(InputError, match=rule):
            grid_from(spec, "inline")
        johnson = copy.deepcopy(spec) | {"reference": "johnson"}
        with pytest.raises(InputError, match="is used only with reference finite-element"):
            grid_from(johnson, "inline")
