"""The commands that list, compare and export laws."""

import json
import shlex
from pathlib import Path

import numpy as np
import pytest

import cylcontact as cc
from cylcontact import laws

ROOT = Path(__file__).resolve().parents[2]


def shown(run, line):
    """What a command prints."""
    code, out, err = run(*shlex.split(line))
    assert (code, err) == (0, "")
    return out


def test_the_laws_are_listed_with_what_a_fit_searches(run):
    out = shown(run, "laws")
    assert all(f"\n  {name} " in out for name in laws.LAWS)
    assert "    Lambda_factor      fixed at 1 " in out
    assert "johnson" in shown(run, "laws --contact external")


def test_the_accuracy_of_all_laws_as_text_and_as_json(run):
    out = shown(run, "laws accuracy")
    assert [line for line in out.splitlines() if line.startswith("explicit ")]
    rows = {row["law"]: row for row in json.loads(shown(run, "laws accuracy --json"))["rows"]}
    assert 0 < rows["explicit"]["rms"] < rows["johnson"]["rms"]


ROWS = "--material bronze --length 10 --load 300"


def rows(run, line):
    """The rows of `laws compare` by pair and law."""
    found = json.loads(shown(run, f"laws compare {line} --json"))["rows"]
    return {(row["pair"], row["law"]): row for row in found}


def test_all_laws_side_by_side_are_those_of_the_pair_of_a_fit(run):
    """The pairs of an ISO fit, not a placeholder of 1 mm."""
    of_fit = rows(run, f"{ROWS} --iso 20H7/g6")
    fit = cc.iso286.IsoFit.read("20H7/g6")
    for name, share in (("tightest", 0.0), ("loosest", 1.0)):
        R_i, R_j = (float(radius) for radius in fit.radii(share))
        alone = rows(run, f"{ROWS} --Ri {R_i!r} --Rj {R_j!r}")
        for law in laws.LAWS:
            assert of_fit[name, law] == {**alone["joint", law], "pair": name}
    bronze = cc.Material.named("bronze")
    pair = cc.CylinderPair.internal(*fit.middle, bronze)
    depth = 1e3 * float(laws.Johnson().penetration(300.0, pair))
    assert of_fit["middle", "johnson"]["penetration_um"] == pytest.approx(depth, rel=1e-12)
    assert "3.7503" in shown(run, f"laws compare {ROWS} --iso 20H7/g6")


def test_all_laws_take_the_depth_of_a_plane(run):
    line = "--contact external --material bronze --Ri 15 --Rj inf"
    of_depth = rows(run, f"{line} --depth 50")["joint", "johnson"]
    flat = cc.CylinderPair.external(15.0, np.inf, cc.Material.named("bronze"))
    depth = 1e3 * float(laws.Johnson(datum=50.0).penetration(100.0, flat))
    assert of_depth["penetration_um"] == pytest.approx(depth, rel=1e-12)
    assert of_depth["off_percent"] == 0
    assert rows(run, line)["joint", "johnson"]["penetration_um"] is None


def test_all_laws_warn_above_first_yield(run):
    line = "laws compare --material 'low-carbon steel' --iso 20H7/g6 --load 5000"
    code, _, err = run(*shlex.split(line))
    assert (code, "is above first yield of the tightest pair" in err) == (0, True)


def test_export_prints_a_law_and_writes_a_refit_to_a_file(run, tmp_path):
    code, out, err = run("export", "explicit", "--contact", "internal", "--to", "c")
    assert (code, err) == (0, "")
    assert "double cylcontact_explicit_internal_load(" in out
    result, out = ROOT / "fitting/results/external.json", tmp_path / "new" / "law.c"
    message = f"{result} written to {out}, {out.with_suffix('.h')}\n"
    assert run("export", result, "--to", "c", "-o", out) == (0, message, "")
    assert "double cylcontact_enhanced_external" in out.read_text(encoding="ascii")
    code, _, err = run("export", "johnson", "--to", "matlab", "-o", tmp_path / "bad-name.m")
    assert (code, "'bad-name': cannot be called by its name" in err) == (2, True)
