"""Compilation by numba, with a disk cache that is invalidated when any source changes.

numba recompiles a cached function only when its own file changes. It does not notice a change in a
function that it calls, or in a constant from another module, and would return the numbers of the
old formula. Therefore the cache folder is named after a hash of all sources of compiled functions.

This module imports numba, which is slow: import it where it is needed.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.extending import register_jitable

from cylcontact.support.arrays import FloatArray

# Typed as Any: numba declares neither attributes nor every option to a type checker.
_SETTINGS: Any = numba.config
_njit: Any = numba.njit
_registered: Any = register_jitable
# IEEE division. Arrays are made by Python alone: to count who holds one takes longer than a law.
_OPTIONS: Any = {"error_model": "numpy", "_nrt": False}

PACKAGE = Path(__file__).parents[1]
# The packages and modules that contain compiled functions and their constants.
PARTS = ("impact", "laws", "limits", "joint", "mechanism", "support/numba_cache")

_Function = TypeVar("_Function", bound=Callable[..., Any])


def compiled(function: _Function, **settings: Any) -> _Function:
    """Compile a function that Python calls, and cache it on disk.

    It must be defined in one of the `PARTS`, whose sources name the cache.
    """
    folder, before = _folder(), _SETTINGS.CACHE_DIR
    _SETTINGS.CACHE_DIR = str(folder or "")  # numba reads it now, not when it compiles
    try:
        options = {"cache": folder is not None, "no_cfunc_wrapper": True, "nogil": True}
        compiler = _njit(**options, **_OPTIONS, **settings)
        return cast(_Function, compiler(function))
    finally:
        _SETTINGS.CACHE_DIR = before


def called(function: _Function, **settings: Any) -> _Function:
    """Let compiled functions call a function; called from Python it is not compiled.

    It is compiled in half the time, as nothing is made for Python to call, or to load from disk.
    """
    return cast(_Function, _registered(**_OPTIONS, **settings)(function))


def inlined(function: _Function) -> _Function:
    """Let compiled functions call a function, and put it into all of them.

    For the innermost functions of a loop, where a call costs as much as the work.
    """
    return called(function, forceinline=True)


def merged(function: _Function) -> _Function:
    """Let one compiled function call another, as a part of it from the start.

    What is called or inlined is compiled alone, and once more with each of its callers, and theirs.
    """
    return cast(_Function, _njit(inline="always", **_OPTIONS)(function))


@inlined
def copy_to(values: FloatArray, out: FloatArray) -> None:
    """Copy a row in compiled code; of `out[:] = values` numba compiles a message for seconds."""
    for n in range(values.size):
        out[n] = values[n]


@cache
def _folder() -> Path | None:
    """Return a writable folder named after the sources, or None if there is none.

    Files in it are loaded as code, so only folders of the user are considered.
    """
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser())
    own = [Path(_SETTINGS.CACHE_DIR)] if _SETTINGS.CACHE_DIR else []
    for base in (*own, PACKAGE / "__pycache__", home / "cylcontact"):
        folder = base / f"compiled-{source_hash(PACKAGE)[:16]}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    return None


def source_hash(package: Path) -> str:
    """Return a hash of all sources in the `PARTS` of a package."""
    digest = hashlib.sha256()
    for part in PARTS:
        for path in sorted([*package.glob(f"{part}.py"), *(package / part).rglob("*.py")]):
            content = path.read_bytes()
            digest.update(f"{path.relative_to(package).as_posix()} {len(content)}\n".encode())
            digest.update(content)
    return digest.hexdigest()
