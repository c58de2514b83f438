"""Many joints of different materials: conformal contact, first yield, and joints in housings."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.harness import Row, compare, rows, seconds_of
from cylcontact import CylinderPair, Material, laws, limits
from cylcontact.joint.tables import check_table

SIZES, YIELDS = (1_000, 10_000, 100_000, 1_000_000, 10_000_000), (1_000, 100_000, 1_000_000)
LAW, ALONE = laws.Conformal(), 200
# Ratios of moduli and of ΔR to R, and ν, of the joints.
LOG_RATIO, LOG_CLEARANCE, NU = 3.0, (-5.0, -1.0), (0.0, 0.499)


def measure(short: bool) -> Iterator[list[Row]]:
    """Yield the time of a joint by their number with the memory, the errors, and housings."""
    state_of(1_000)()
    yields_of(1_000)()  # both are compiled
    for size in SIZES[:1] if short else SIZES:
        yield _grown("the state of the contact", state_of(size), size)
    for size in YIELDS[:1] if short else YIELDS:
        yield _grown("first yield", yields_of(size), size)
    yield _against_one_by_one(20 if short else ALONE)
    yield _in_housings(2 if short else 100)
    yield _in_a_table(2 if short else 100)


def joints(size: int, seed: int = 5) -> tuple[CylinderPair, np.ndarray]:
    """Return random pairs, all of other materials, and a load for each."""
    rng = np.random.default_rng(seed)
    half = rng.uniform(-LOG_RATIO, LOG_RATIO, size) / 2
    hole, pin = (
        Material("any", np.maximum(1e3, 3.2e4 * 10**exponent), rng.uniform(*NU, size))
        for exponent in (half, -half)
    )
    R = 10 ** rng.uniform(0, 2, size)
    dR = R * 10 ** rng.uniform(*LOG_CLEARANCE, size)
    pair = CylinderPair.internal(R_i=R, R_j=R - dR, hole=hole, pin=pin)
    return pair, pair.E_star * dR * 10 ** rng.uniform(-4, 1, size)


def state_of(size: int) -> Callable[[], Any]:
    pair, load = joints(size)
    return lambda: LAW.state(load, pair)


def yields_of(size: int) -> Callable[[], Any]:
    pair, _ = joints(size)
    return lambda: limits.first_yield(pair, yield_stress=250.0)


def _grown(what: str, run: Callable[[], Any], size: int) -> list[Row]:
    """Return ns a joint beside a power in the same run, and the memory that the call takes."""
    x = np.random.default_rng(1).uniform(0.1, 2.0, size)
    sides = {"numpy.power": partial(np.power, x, 1.1), what: run}
    measured = compare(
        f"{what}, {size:,} joints", sides, 3 if size < 1_000_000 else 1, "ns a joint", 1e9 / size
    )
    tracemalloc.start()
    run()
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return [measured[0], measured[1]._replace(note=f"{peak / 2**20:.0f} MiB")]


def _against_one_by_one(count: int) -> list[Row]:
    """Return ms of joints at once and one by one, with the largest difference in the note."""
    pair, load = joints(count)
    ours, theirs = LAW.state(load, pair), []
    alone = [one_of(pair, k) for k in range(count)]
    seconds = seconds_of(lambda: theirs.extend(LAW.state(load[k], alone[k]) for k in range(count)))
    worst = np.abs(np.array(ours) / np.array(theirs).T - 1).max()
    at_once = seconds_of(lambda: LAW.state(load, pair))
    sides = {"at once": [at_once], "one by one, by curves": [seconds]}
    return rows(
        f"conformal contact of {count:,} joints", sides, "ms", 1e3,
        {"one by one, by curves": f"differences up to {worst:.1e}"},
    )  # fmt: skip


def one_of(pair: CylinderPair, k: int) -> CylinderPair:
    hole, pin = (Material("any", m.E[k], m.nu[k]) for m in (pair.material_i, pair.material_j))
    return CylinderPair.internal(R_i=pair.R_i[k], R_j=pair.R_j[k], hole=hole, pin=pin)


def _in_housings(count: int) -> list[Row]:
    """Return ms a joint of ten clearances in each of many rings, and of their first yield."""
    steel, bronze = Material("steel", 207e3, 0.3), Material("bronze", 110e3, 0.34)
    ratios = np.linspace(1.4, 3.0, count)
    pair = CylinderPair.internal(10.0, 10 - np.geomspace(1e-3, 0.1, 10), pin=steel, hole=bronze)

    def law(radius: float = 10.0) -> None:
        for ratio in ratios:
            scaled = CylinderPair.internal(radius, radius * pair.R_j / 10, pin=steel, hole=bronze)
            laws.Conformal(laws.Housing(radius * ratio)).state(100.0, scaled)

    one = laws.Housing(10.0 * ratios[0])
    sides = {
        "law, in new housings": [seconds_of(law) / (10 * count)],
        "law, in housings of these shapes, three times the size": [
            seconds_of(partial(law, 30.0)) / (10 * count)
        ],
        "first yield": [
            seconds_of(lambda: limits.first_yield(pair, yield_stress=250.0, housing=one)) / 10
        ],
    }
    return rows(f"{10 * count:,} joints in {count} rings", sides, "ms a joint", 1e3)


def _in_a_table(count: int) -> list[Row]:
    """Return ms a joint of a table of ten joints in each of many lugs, with first yield."""
    rng = np.random.default_rng(1)
    R, which = rng.uniform(8, 20, count), rng.integers(0, count, 10 * count)
    lugs = {"R_i_mm": R, "R_o_mm": R * rng.uniform(1.4, 3, count), "clamp": ["lug"] * count}
    frame = pd.DataFrame(lugs).iloc[which].assign(
        radial_clearance_um=rng.uniform(10, 100, which.size), pin="high-strength steel",
        hole="bronze", load_N_per_mm=rng.uniform(100, 2000, which.size),
    )  # fmt: skip
    sides = {"by a table": [seconds_of(lambda: check_table(frame)) / which.size]}
    return rows(f"{which.size:,} joints in {count} lugs, with yield", sides, "ms a joint", 1e3)
