"""Array types, and helpers of the functions that take arrays."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cylcontact.errors import InputError

__all__ = [
    "BoolArray",
    "FloatArray",
    "IndexArray",
    "as_floats",
    "inside_or_nan",
    "own_arrays",
    "require",
    "same_fields",
]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IndexArray = NDArray[np.intp]


def as_floats(values: object) -> FloatArray:
    """Return `values` as float64, an array or a NumPy scalar."""
    array: FloatArray = np.asarray(values, dtype=np.float64)[()]
    return array


def inside_or_nan(values: FloatArray, inside: BoolArray) -> FloatArray:
    """Return `values` where `inside` is true and NaN elsewhere.

    Examples
    --------
    >>> inside_or_nan(np.array([1.0, 2.0]), np.array([True, False]))
    array([ 1., nan])
    """
    result: FloatArray = np.where(inside, values, np.nan)[()]
    return result


def own_arrays(instance: Any) -> None:
    """Replace the arrays of a frozen dataclass by read-only copies.

    A later change of the caller's arrays then changes no instance.
    """
    for field in fields(instance):
        value = getattr(instance, field.name)
        if isinstance(value, np.ndarray):
            own = value.copy()
            own.flags.writeable = False
            object.__setattr__(instance, field.name, own)


def require(
    holds: bool | BoolArray | np.bool_, source: str, key: str, value: object, rule: str, remedy: str
) -> None:
    """Raise `InputError` unless `holds` is true for every element."""
    # Laws are made thousands of times in a fit: `np.all` takes longer than the rest.
    if not (holds if isinstance(holds, bool | np.bool_) else np.all(holds)):
        raise InputError(source, key, value, rule, remedy)


def same_fields(instance: Any, other: object) -> bool:
    """Return whether two dataclass instances are equal, arrays compared by value."""
    names = [field.name for field in fields(instance)]
    return type(instance) is type(other) and all(
        np.array_equal(getattr(instance, name), getattr(other, name)) for name in names
    )
