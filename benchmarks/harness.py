"""Time several ways to do the same work, in turns, and compare their medians."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from math import ceil
from statistics import median
from typing import Any, NamedTuple

import numpy as np

# A shorter call is repeated within a round until the round lasts as long.
LEAST_SECONDS = 0.02

# At the end of a case that was measured while other programs kept the processors busy: its ratios
# count, and its times do not.
BUSY = ", ratios alone: the machine was busy"

Sides = Mapping[str, Callable[[], Any]]


class Row(NamedTuple):
    """The median time of a side of a case, and the median of its ratios to the first side."""

    case: str
    side: str
    value: float
    unit: str
    ratio: float
    note: str = ""


def require_agreement(sides: Sides, rtol: float) -> None:
    """Raise AssertionError unless all sides give the first one's numbers."""
    expected, *others = [(name, run()) for name, run in sides.items()]
    for name, actual in others:
        np.testing.assert_allclose(actual, expected[1], rtol=rtol, err_msg=name)


def compare(
    case: str, sides: Sides, rounds: int, unit: str = "ms", scale: float = 1e3
) -> list[Row]:
    """Time all sides in turns, in an order that changes; a second is `scale` times the unit."""
    repeats = {name: _repeats(run) for name, run in sides.items()}
    seconds: dict[str, list[float]] = {name: [] for name in sides}
    for turn in range(rounds):
        shift = turn % len(sides)
        for name in [*sides][shift:] + [*sides][:shift]:
            seconds[name].append(seconds_of(sides[name], repeats[name]))
    return rows(case, seconds, unit, scale)


def rows(
    case: str,
    seconds: Mapping[str, Sequence[float]],
    unit: str = "s",
    scale: float = 1.0,
    notes: Mapping[str, str] | None = None,
) -> list[Row]:
    """Return the seconds of each round as rows; ratios are formed round by round."""
    first = next(iter(seconds.values()))
    return [
        Row(
            case,
            name,
            scale * median(times),
            unit,
            median(a / b for a, b in zip(times, first, strict=True)),
            (notes or {}).get(name, ""),
        )
        for name, times in seconds.items()
    ]


def seconds_of(run: Callable[[], Any], repeats: int = 1) -> float:
    """Return the mean seconds of a call."""
    started = time.perf_counter()
    for _ in range(repeats):
        run()
    return (time.perf_counter() - started) / repeats


def _repeats(run: Callable[[], Any]) -> int:
    seconds_of(run)  # the first call may compile or import
    once = seconds_of(run)
    if once < LEAST_SECONDS:
        once = min(once, *(seconds_of(run) for _ in range(3)))
    return max(1, ceil(LEAST_SECONDS / max(once, 1e-7)))
