"""Sampling: tables that hold Eq 1 where Eq 8 allows it, in bounded memory, for any block size."""

import subprocess
import sys
from dataclasses import fields
from itertools import product

import numpy as np
import pandas as pd
import pytest

from cylcontact import InputError
from cylcontact.datasets import Grid, Moments, reduce_grid, sampling, write_samples
from tests.support.paper_equations import e_star, johnson, johnson_end
from tests.support.programs import require_package
from tests.support.spec_files import GRID, changed, tree, write_toml

COLUMNS = ["E_GPa", "nu", "dR_mm", "load_N_per_mm", "penetration_mm"]

# Small moduli and clearances under large loads, so that Eq 8 masks a part of each.
GRIDS = {
    contact: Grid(
        contact,
        "johnson",
        np.array([0.7, 69.0, 207.0]),
        np.array([0.0, 0.3, 0.5]),
        np.array([1e-5, 0.0075, 0.01, 0.5]),
        np.array([10.0, 100.0, 494.0, 495.0, 658.0, 660.0, 1000.0]),
    )
    for contact in ("internal", "external")
}
MASKED = Grid(
    "internal", "johnson", np.array([1.0]), np.array([0.3]), np.array([1e-6]), np.array([10.0])
)


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
        delta = johnson(load, E_star, dR)
        rows.append((E, nu, dR, load, delta))
    return np.array(rows), masked


def read(path):
    """Return a table's columns and rows."""
    frame = pd.read_parquet(path) if path.suffix == ".parquet" else pd.read_csv(path)
    return list(frame.columns), frame.to_numpy()


# --- tables -----------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".parquet", ".csv"])
def test_tables_hold_the_law_where_it_is_defined(grid, suffix, tmp_path):
    path = tmp_path / f"samples{suffix}"
    counts = write_samples(grid, path)
    columns, rows = read(path)
    expected, masked = by_hand(grid)
    assert columns == COLUMNS
    assert (counts.samples, counts.masked) == (len(expected), masked)
    assert masked > 0
    assert np.array_equal(rows[:, :4], expected[:, :4])
    assert rows[:, 4] == pytest.approx(expected[:, 4], rel=1e-12)


def test_csv_and_parquet_hold_the_same_digits(grid, tmp_path):
    for suffix in ("csv", "parquet"):
        write_samples(grid, tmp_path / f"samples.{suffix}")
    _, csv = read(tmp_path / "samples.csv")
    _, parquet = read(tmp_path / "samples.parquet")
    assert np.array_equal(csv, parquet)


def test_limits_of_the_paper_separate_samples_from_masked_ones(tmp_path):
    """Aluminium in a clearance of 7.5 and 10 µm stays valid up to 494 and 658 N/mm (Sect. 3.4)."""
    loads = np.array([493.0, 495.0, 658.0, 660.0])
    dR = np.array([0.0075, 0.01])
    grid = Grid("internal", "johnson", np.array([69.0]), np.array([0.33]), dR, loads)
    write_samples(grid, tmp_path / "limits.csv")
    _, rows = read(tmp_path / "limits.csv")
    assert rows[:, 2:4].tolist() == [
        [0.0075, 493.0],
        *([0.01, load] for load in (493.0, 495.0, 658.0)),
    ]


@pytest.mark.parametrize("block", [1, 2, 7, 8, 63, 1 << 30])
def test_tables_do_not_depend_on_the_block_size(grid, block, tmp_path, monkeypatch):
    write_samples(grid, tmp_path / "one.csv")
    monkeypatch.setattr(sampling, "BLOCK", block)
    write_samples(grid, tmp_path / "two.csv")
    assert (tmp_path / "one.csv").read_bytes() == (tmp_path / "two.csv").read_bytes()


# --- moments ----------------------------------------------------------------------------------


def test_moments_are_those_of_the_rows_by_hand(grid):
    moments, counts = reduce_grid(grid)
    rows, masked = by_hand(grid)
    assert (counts.samples, counts.masked) == (len(rows), masked)
    assert moments.dR.tolist() == sorted(set(rows[:, 2]))
    for index, dR in enumerate(moments.dR):
        E, nu, _, load, delta = rows[rows[:, 2] == dR].T
        s, j = np.log(load * 2 * (1 - nu**2) / (1e3 * E)), np.log(delta)
        expected = (s.size, s.mean(), j.mean(), s.size * s.var(), s.size * j.var())
        actual = [getattr(moments, n)[index] for n in ("count", "mean_s", "mean_j", "ss", "jj")]
        assert actual == pytest.approx(expected, rel=1e-12)
        covariance = ((s - s.mean()) * (j - j.mean())).sum()
        assert moments.sj[index] == pytest.approx(covariance, rel=1e-12)


@pytest.mark.parametrize("block", [1, 2, 7, 8, 63, 1 << 30])
def test_moments_do_not_depend_on_the_block_size(grid, block, monkeypatch):
    whole, counts = reduce_grid(grid)
    monkeypatch.setattr(sampling, "BLOCK", block)
    parts, same_counts = reduce_grid(grid)
    assert counts == same_counts
    for field in fields(Moments):
        assert getattr(parts, field.name) == pytest.approx(getattr(whole, field.name), rel=1e-12)


@pytest.mark.parametrize("jobs", [2, 3, 100])
def test_moments_are_the_same_to_the_last_bit_for_any_number_of_jobs(grid, jobs, monkeypatch):
    monkeypatch.setattr(sampling, "BLOCK", 5)
    (one, counts), (many, same_counts) = reduce_grid(grid, jobs=1), reduce_grid(grid, jobs=jobs)
    assert counts == same_counts
    for field in fields(Moments):
        assert np.array_equal(getattr(one, field.name), getattr(many, field.name))


# --- what goes wrong --------------------------------------------------------------------------

ALL_MASKED = r"^grid: axes: all 1 samples lie outside the domain of johnson; lower the loads"


@pytest.mark.parametrize("name", ["samples.csv", "samples.parquet", "new/folder/samples.csv"])
def test_a_grid_that_is_masked_completely_is_refused_and_nothing_written(name, tmp_path):
    if name.endswith(".parquet"):
        require_package("pyarrow")
    with pytest.raises(InputError, match=ALL_MASKED):
        write_samples(MASKED, tmp_path / name)
    assert not any(path.is_file() for path in tmp_path.rglob("*"))


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_grid_that_is_masked_completely_has_no_moments(jobs):
    with pytest.raises(InputError, match=ALL_MASKED):
        reduce_grid(MASKED, jobs)


def test_without_its_library_parquet_is_refused_in_one_line(grid, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    said = r"new/s\.parquet: needs the extra 'parquet'; pip install 'cylcontact\[parquet\]'"
    with pytest.raises(InputError, match=said):
        write_samples(grid, tmp_path / "new/s.parquet")
    assert tree(tmp_path) == {}


@pytest.mark.parametrize("name", ["samples", "samples.txt", "new/samples.xlsx", ".csv"])
def test_other_formats_are_refused_and_nothing_written(grid, name, tmp_path):
    with pytest.raises(InputError, match=r": is neither \.parquet nor \.csv; name the output so"):
        write_samples(grid, tmp_path / name)
    assert tree(tmp_path) == {}


@pytest.mark.parametrize("suffix", [".parquet", ".csv"])
def test_an_interrupted_table_leaves_the_old_one(grid, suffix, tmp_path):
    path = tmp_path / f"samples{suffix}"
    path.write_text("old")

    def interrupt(done):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_samples(grid, path, interrupt)
    assert tree(tmp_path) == {path.name: b"old"}


# --- memory -----------------------------------------------------------------------------------

# Prints how far the peak of memory rises, in MiB, over that of a small grid.
PEAK = """
import resource, sys
from cylcontact.datasets import read_grid, reduce_grid, write_samples

def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

small, large, out = sys.argv[1:]
work = (lambda grid: write_samples(grid, out)) if out else (lambda grid: reduce_grid(grid, 2)[1])
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
    target = str(tmp_path / out) if out else ""
    run = subprocess.run(
        [sys.executable, "-c", PEAK, small, large, target],
        capture_output=True,
        text=True,
        check=True,
    )
    size, growth = run.stdout.split()
    assert int(size) == np.prod(list(sizes.values()))
    assert float(growth) < 16
