"""Time alternatives side by side: they agree first, then take turns, and medians are compared."""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

# A call shorter than this is repeated within a round until the round lasts as long.
LEAST_SECONDS = 0.02
LONG_SECONDS = 5.0


@dataclass(frozen=True)
class Side:
    """One way to do the work: its name and a call without arguments."""

    name: str
    run: Callable[[], Any]


@dataclass(frozen=True)
class Row:
    """One line of the results.

    Attributes
    ----------
    benchmark, case, side : str
        What was measured, at which size, and done by what.
    value, low, high : float
        Median and quartiles of the rounds, in `unit`.
    unit : str
        Such as "ns per value".
    ratio, ratio_low, ratio_high : float
        How many times as much as the first side of the case, round by round.
    note : str
        What has to be said about the number.
    """

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
    """Raise AssertionError unless all sides give the first one's numbers.

    Parameters
    ----------
    sides : sequence of Side
        Whose answers are numbers or arrays.
    rtol : float
        How far they may differ, relatively.
    """
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
    """Time all sides in turns.

    Parameters
    ----------
    benchmark, case : str
        What the rows are called.
    sides : sequence of Side
        The first is what the others are compared with.
    rounds : int
        In each, every side runs once, in an order that changes from round to round.
    unit, scale : str, float
        What a second is turned into.

    Returns
    -------
    list of Row
        In the order of the sides.
    """
    return rows(benchmark, case, timings(sides, rounds), unit, scale)


def timings(sides: Sequence[Side], rounds: int) -> dict[str, list[float]]:
    """Return the seconds of every round, by side; the arguments are those of `compare`."""
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
    """Return what was measured as rows: medians, quartiles and ratios to the first side."""
    first = next(iter(seconds.values()))
    actual = []
    for name, times in seconds.items():
        ratios = [a / b for a, b in zip(times, first, strict=True)]
        actual.append(
            Row(
                benchmark,
                case,
                name,
                *(scale * each for each in _spread(times)),
                unit,
                *_spread(ratios),
                (notes or {}).get(name, ""),
            )
        )
    return actual


def _spread(numbers: Sequence[float]) -> tuple[float, float, float]:
    # Quartiles: one round in which the machine was busy elsewhere must not decide the bar.
    low, high = np.percentile(numbers, (25, 75))
    return statistics.median(numbers), float(low), float(high)


def _repeats(side: Side) -> int:
    # The first call may compile or import; if it was long a second is not worth the wait. Of the
    # others the shortest counts: after an interrupted one a round would be too short to time.
    once = seconds_of(side, 1)
    if once < LONG_SECONDS:
        once = seconds_of(side, 1)
    if once < LEAST_SECONDS:
        once = min(once, *(seconds_of(side, 1) for _ in range(3)))
    return max(1, int(np.ceil(LEAST_SECONDS / max(once, 1e-7))))


def seconds_of(side: Side, repeats: int = 1) -> float:
    """Return the mean seconds of a call."""
    started = time.perf_counter()
    for _ in range(repeats):
        side.run()
    return (time.perf_counter() - started) / repeats


def exit_interrupted(count: int, path: Path) -> NoReturn:
    """Exit as Ctrl-C does, with a line that says how many measurements a file has gained."""
    noun = "measurement is" if count == 1 else "measurements are"
    message = f"{count} {noun} kept in {path}" if count else "nothing new is kept"
    print(f"interrupted; {message}", file=sys.stderr)
    sys.exit(130)
