"""Time alternatives side by side: they agree first, then take turns, and medians are compared."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

# A call shorter than this is repeated within a round until the round lasts as long.
LEAST_SECONDS = 0.02


@dataclass(frozen=True)
class Side:
    """One way to do the work: its name and a call without arguments."""

    name: str
    run: Callable[[], Any]


@dataclass(frozen=True)
class Row:
    """Median and quartiles of a side of a case, and round by round its ratio to the first side."""

    benchmark: str
    case: str
    side: str
    value: float
    low: float
    high: float
    unit: str
    ratio: float
    ratio_low: float
    ratio_high: float
    note: str = ""


def require_agreement(sides: Sequence[Side], rtol: float) -> None:
    """Raise AssertionError unless all sides give the first one's numbers."""
    expected = sides[0].run()
    for side in sides[1:]:
        np.testing.assert_allclose(side.run(), expected, rtol=rtol, err_msg=side.name)


def compare(
    benchmark: str,
    case: str,
    sides: Sequence[Side],
    rounds: int,
    unit: str = "ms",
    scale: float = 1e3,
) -> list[Row]:
    """Time all sides in turns; a second is `scale` times the unit."""
    return rows(benchmark, case, timings(sides, rounds), unit, scale)


def timings(sides: Sequence[Side], rounds: int) -> dict[str, list[float]]:
    """Return the seconds of every round, by side, in an order that changes from round to round."""
    seconds: dict[str, list[float]] = {side.name: [] for side in sides}
    repeats = {side.name: _repeats(side) for side in sides}
    for turn in range(rounds):
        shift = turn % len(sides)
        for side in [*sides[shift:], *sides[:shift]]:
            seconds[side.name].append(seconds_of(side, repeats[side.name]))
    return seconds


def rows(
    benchmark: str,
    case: str,
    seconds: dict[str, list[float]],
    unit: str,
    scale: float,
    notes: dict[str, str] | None = None,
) -> list[Row]:
    """Return what was measured as rows."""
    first = next(iter(seconds.values()))
    actual = []
    for name, times in seconds.items():
        values = [scale * each for each in _spread(times)]
        ratios = _spread([a / b for a, b in zip(times, first, strict=True)])
        note = (notes or {}).get(name, "")
        actual.append(Row(benchmark, case, name, *values, unit, *ratios, note))
    return actual


def _spread(numbers: Sequence[float]) -> tuple[float, float, float]:
    # Quartiles: one round in which the computer was busy elsewhere must not decide the bar.
    low, high = np.percentile(numbers, (25, 75))
    return statistics.median(numbers), float(low), float(high)


def _repeats(side: Side) -> int:
    # The first call may compile or import; an interrupted one would make a round too short.
    seconds_of(side)
    once = seconds_of(side)
    if once < LEAST_SECONDS:
        once = min(once, *(seconds_of(side) for _ in range(3)))
    return max(1, int(np.ceil(LEAST_SECONDS / max(once, 1e-7))))


def seconds_of(side: Side, repeats: int = 1) -> float:
    """Return the mean seconds of a call."""
    started = time.perf_counter()
    for _ in range(repeats):
        side.run()
    return (time.perf_counter() - started) / repeats
