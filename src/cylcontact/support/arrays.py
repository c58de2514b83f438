"""Array types, and helpers of the functions that take arrays."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import fields
from functools import lru_cache
from threading import Lock
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cylcontact.support import errors
from cylcontact.support.errors import InputError

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IndexArray = NDArray[np.intp]
require = errors.require
# Rows that are looked at to see whether many are alike.
_SAMPLE = 1024


def as_floats(values: object) -> FloatArray:
    """Return `values` as float64, an array or a NumPy scalar; refuse what is no such array."""
    if isinstance(values, np.ma.MaskedArray):
        rule, remedy = "is a masked array", "give values.filled(np.nan) or values.compressed()"
        raise InputError("", "", None, rule, remedy)
    try:
        array: FloatArray = np.asarray(values, dtype=np.float64)[()]
    except (TypeError, ValueError):  # text, or lists of unequal length in a list
        rule, remedy = "must be a number or an array of them", "give numbers"
        raise InputError("", "", values, rule, remedy) from None
    return array


def as_numbers(values: object, source: str, key: str) -> FloatArray:
    """Return real numbers as `as_floats`; raise `InputError` for anything else."""
    try:
        array = np.asarray(values)
    except ValueError:  # lists of unequal length in a list
        array = np.array(None)
    numeric = array.dtype.kind in "iuf"
    remedy = "give a number, or an array of numbers"
    require(numeric, source, key, values, "must be a real number or an array of them", remedy)
    return as_floats(array)


def require_one_shape(source: str, **arrays: ArrayLike) -> None:
    """Raise `InputError` for arrays that do not broadcast against each other."""
    shapes = {name: shape for name, value in arrays.items() if (shape := np.shape(value))}
    try:
        np.broadcast_shapes(*shapes.values())
    except ValueError:
        text = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
        rule = f"the shapes do not go together: {text}"
        remedy = "give arrays of the same length, or single numbers"
        raise InputError(source, "", None, rule, remedy) from None


def inside_or_nan(values: FloatArray, inside: BoolArray) -> FloatArray:
    """Return `values` where `inside` is true and NaN elsewhere."""
    result: FloatArray = np.where(inside, values, np.nan)[()]
    return result


def require_positive(
    value: object, source: str, key: str, remedy: str, rule: str = "must be positive and finite"
) -> FloatArray:
    """Return real numbers; raise `InputError` unless all are positive and finite."""
    numbers = as_numbers(value, source, key)
    require((numbers > 0) & np.isfinite(numbers), source, key, value, rule, remedy)
    return numbers


class OfArrays:
    """A frozen dataclass with arrays of its own, which are read-only and compared by value."""

    def _own_arrays(self) -> None:
        """Replace arrays and lists by read-only copies."""
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray | list | tuple):
                own = np.array(value)
                own.flags.writeable = False
                object.__setattr__(self, name, own)

    def __eq__(self, other: object) -> bool:
        names = [field.name for field in fields(self)]  # type: ignore[arg-type]
        return type(self) is type(other) and all(
            np.array_equal(getattr(self, name), getattr(other, name)) for name in names
        )

    def __hash__(self) -> int:
        values = (getattr(self, field.name) for field in fields(self))  # type: ignore[arg-type]
        return hash(
            tuple(
                tuple(np.ravel(value).tolist()) if isinstance(value, np.ndarray) else value
                for value in values
            )
        )


class _Limit:
    """The limit on threads of linear algebra while any thread of Python wants it."""

    lock = Lock()
    users: ClassVar[int] = 0
    limiter: ClassVar[Any] = None


@contextmanager
def on_one_thread() -> Iterator[None]:
    """Keep linear algebra on one thread: small matrices are slower on several."""
    with _Limit.lock:
        _Limit.users += 1
        if _Limit.users == 1:
            _Limit.limiter = _threads("scipy.linalg" in sys.modules).limit(limits=1)
    try:
        yield
    finally:
        with _Limit.lock:
            _Limit.users -= 1
            if _Limit.users == 0:
                _Limit.limiter.restore_original_limits()


@lru_cache(maxsize=2)
def _threads(scipy_is_loaded: bool) -> ThreadpoolController:  # noqa: ARG001 - looks again after it
    """Return what limits threads of the libraries loaded; to look for them takes milliseconds.

    SciPy brings a library of its own, and may be loaded later.
    """
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


def require_not_negative(value: ArrayLike, source: str, key: str, remedy: str) -> FloatArray:
    """Return finite numbers that are not negative; raise `InputError` for others."""
    numbers = as_floats(value)
    holds = (numbers >= 0) & np.isfinite(numbers)
    require(holds, source, key, value, "must be finite and not negative", remedy)
    return numbers


def blocks(size: int, most: int) -> Iterator[slice]:
    """Return slices of at most so many numbers."""
    return (slice(first, min(first + most, size)) for first in range(0, size, most))


def on_all_cores(function: Callable[[Any], None], parts: Iterable[Any]) -> None:
    """Call a function for all parts in threads, which is of use where most of it is compiled."""
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        list(pool.map(function, parts))


def equal_rows(columns: Sequence[FloatArray], size: int) -> IndexArray:
    """Return for each of N rows the number, from 0, of those that equal it in all columns."""
    which = np.zeros(size, dtype=np.intp)
    for column in columns:  # sorting numbers is much faster than sorting rows
        if column.strides != (0,):
            values, of_column = np.unique(column, return_inverse=True, equal_nan=False)
            which = np.unique(which * values.size + of_column, return_inverse=True)[1]
    return which


def distinct_columns(rows: Sequence[FloatArray]) -> tuple[FloatArray, list[IndexArray]]:
    """Return the distinct columns of rows of one length, and where each of them is."""
    which = equal_rows(rows, rows[0].size)
    order = np.argsort(which, kind="stable")
    places = np.split(order, np.flatnonzero(np.diff(which[order])) + 1)
    return np.stack([row[[place[0] for place in places]] for row in rows]), places


def fewest_kinds(rows: Sequence[FloatArray]) -> int:
    """Return how many distinct columns a sample of rows has: at least so many are in all."""
    sample = np.stack([row[:: rows[0].size // _SAMPLE + 1] for row in rows])
    return int(np.unique(sample, axis=1).shape[1])
