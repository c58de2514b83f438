"""Sampling: tables that hold Eq 1 where Eq 8 allows it, in bounded memory, for any block size."""

import subprocess
import sys
from dataclasses import fields
from itertools import product

import numpy as np
import pandas as pd
import pytest

from cylcontact import CylinderPair, InputError, Material
from cylcontact.datasets import Grid, Moments, reduce_grid, sample, sampling
from cylcontact.laws import LAWS, REFERENCES
from tests.support.paper_equations import e_star, johnson, johnson_end
from tests.support.spec_files import GRID, changed, write_toml

COLUMNS = ["E_GPa", "nu", "dR_mm", "load_N_per_mm", "penetration_mm"]


def grid_of(E, nu, dR, load, contact="internal"):
    return Grid(contact, "johnson", *(np.array(axis) for axis in (E, nu, dR, load)))


# Small moduli and clearances under large loads, so that Eq 8 masks a part of each. Aluminium in
# clearances of 7.5 and 10 µm stays valid up to 494 and 658 N/mm (Sect. 3.4).
LOADS = [10.0, 100.0, 494.0, 495.0, 658.0, 660.0, 1000.0]
AXES = [0.7, 69.0, 207.0], [0.0, 0.3, 0.5], [1e-5, 0.0075, 0.01, 0.5], LOADS
GRIDS = {contact: grid_of(*AXES, contact) for contact in ("internal", "external")}
MASKED = grid_of([1.0], [0.3], [1e-6], [10.0])


@pytest.fixture(params=GRIDS.values(), ids=GRIDS)
def grid(request):
    return request.param


def by_hand(grid):
    """Return the rows of Eq 1 within Eq 8, E, ν and load within ΔR, and the number left out."""
    rows, masked = [], 0
    for dR, E, nu, load in product(grid.dR, grid.E, grid.nu, grid.load):
        E_star = e_star(1e3 * E, nu)
        if load > johnson_end(E_star, dR):
            masked += 1
            continue
        rows.append((E, nu, dR, load, johnson(load, E_star, dR)))
    return np.array(rows), masked


@pytest.mark.parametrize("suffix", [".parquet", ".csv"])
def test_tables_hold_the_law_where_it_is_defined(grid, suffix, tmp_path):
    path = tmp_path / f"samples{suffix}"
    counts = sample(grid, path)
    frame = pd.read_parquet(path) if suffix == ".parquet" else pd.read_csv(path)
    rows = frame.to_numpy()
    expected, masked = by_hand(grid)
    assert list(frame.columns) == COLUMNS
    assert (counts.samples, counts.masked) == (len(expected), masked)
    assert masked > 0
    assert np.array_equal(rows[:, :4], expected[:, :4])
    assert rows[:, 4] == pytest.approx(expected[:, 4], rel=1e-12)


@pytest.mark.parametrize("reference", REFERENCES)
def test_a_frame_holds_any_reference_law(reference):
    grid = Grid("internal", reference, *(np.array(axis) for axis in AXES))
    done = []
    frame = sample(grid, progress=lambda *step: done.append(step))
    assert list(frame.columns) == COLUMNS
    assert done[-1] == ("sampling", 4, 4)
    for row in frame.iloc[:: len(frame) // 7].itertuples():
        material = Material("", f"{row.E_GPa!r} GPa", row.nu)
        pair = CylinderPair.from_dR("internal", row.dR_mm, material)
        depth = LAWS[reference]().penetration(row.load_N_per_mm, pair)
        assert row.penetration_mm == pytest.approx(float(depth), rel=1e-12)


def test_moments_are_those_of_the_rows_by_hand(grid):
    moments, counts = reduce_grid(grid)
    rows, masked = by_hand(grid)
    assert (counts.samples, counts.masked) == (len(rows), masked)
    assert moments.dR.tolist() == sorted(set(rows[:, 2]))
    for index, dR in enumerate(moments.dR):
        E, nu, _, load, delta = rows[rows[:, 2] == dR].T
        s, j = np.log(load * 2 * (1 - nu**2) / (1e3 * E)), np.log(delta)
        covariance = ((s - s.mean()) * (j - j.mean())).sum()
        expected = (s.size, s.mean(), j.mean(), s.size * s.var(), covariance, s.size * j.var())
        actual = [getattr(moments, field.name)[index] for field in fields(Moments)[1:]]
        assert actual == pytest.approx(expected, rel=1e-12)


def test_rows_of_one_modulus_are_as_many_samples_of_it():
    one, three = (grid_of([1.0], nu, [1.0], [1.0, 10.0]) for nu in ([0.0], [0.0, 1e-310, 1e-308]))
    (once, _), (thrice, _) = reduce_grid(one), reduce_grid(three)
    assert thrice.jj == pytest.approx(3 * once.jj, rel=1e-12)


@pytest.mark.parametrize("block", [1, 7, 63, 1 << 30])
def test_nothing_depends_on_the_block_size_or_the_jobs(grid, block, tmp_path, monkeypatch):
    sample(grid, tmp_path / "one.csv")
    whole, counts = reduce_grid(grid)
    monkeypatch.setattr(sampling, "BLOCK", block)
    sample(grid, tmp_path / "two.csv")
    assert (tmp_path / "one.csv").read_bytes() == (tmp_path / "two.csv").read_bytes()
    (parts, same), (many, also) = reduce_grid(grid), reduce_grid(grid, jobs=3)
    assert counts == same == also
    for field in fields(Moments):
        of_parts = getattr(parts, field.name)
        assert of_parts == pytest.approx(getattr(whole, field.name), rel=1e-12)
        assert np.array_equal(of_parts, getattr(many, field.name))


# --- what goes wrong --------------------------------------------------------------------------


def test_what_cannot_be_written_leaves_nothing(grid, tmp_path, monkeypatch):
    masked = r"^grid: axes: all 1 samples lie outside the domain of johnson; lower the loads"
    format_ = r": is neither \.parquet nor \.csv; name the output so"
    for each, name, said in (
        (MASKED, "samples.csv", masked),
        (MASKED, "new/samples.csv", masked),
        (grid, "samples.txt", format_),
        (grid, ".csv", format_),
    ):
        with pytest.raises(InputError, match=said):
            sample(each, tmp_path / name)
    with pytest.raises(InputError, match=masked):
        reduce_grid(MASKED, 2)
    with pytest.raises(InputError, match=masked):
        sample(MASKED)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(InputError, match=r"pip install 'cylcontact\[parquet\]'"):
        sample(grid, tmp_path / "s.parquet")
    assert not any(path.is_file() for path in tmp_path.rglob("*"))


# Prints how far the peak of memory rises, in MiB, over that of a small grid.
PEAK = """
import resource, sys
from cylcontact.datasets import read_grid, reduce_grid, sample

def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

small, large, out = sys.argv[1:]
work = (lambda grid: sample(grid, out)) if out else (lambda grid: reduce_grid(grid, 2)[1])
work(read_grid(small))
before = peak()
counts = work(read_grid(large))
print(counts.samples + counts.masked, peak() - before)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="the peak of memory is read the Unix way")
@pytest.mark.parametrize("out", ["samples.parquet", "samples.csv", ""])
def test_memory_does_not_grow_with_the_grid(out, tmp_path):
    """Four million samples are 160 MB as a table; moments of sixteen million would be 640."""
    sizes = {"E": 40, "nu": 10, "dR": 100 if out else 400, "load": 100}
    spans = {"E": (20.7, 1000.0), "nu": (0.1, 0.5), "dR": (0.05, 10.0), "load": (10.0, 1000.0)}
    axes = {
        name: {"min": low, "max": high, "points": sizes[name], "spacing": "linear"}
        for name, (low, high) in spans.items()
    }
    small = write_toml(tmp_path / "small.toml", changed(GRID, {"axes": axes, "axes.dR.points": 2}))
    large = write_toml(tmp_path / "large.toml", changed(GRID, {"axes": axes}))
    command = [sys.executable, "-c", PEAK, small, large, str(tmp_path / out) if out else ""]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    size, growth = run.stdout.split()
    assert int(size) == np.prod(list(sizes.values()))
    assert float(growth) < 16
