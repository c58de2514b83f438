"""The program of a process that imports a user's module and calls a function of it.

`user_process` starts it with the folder of the module and its name, module:function. It answers
every request on its standard input with one reply on its standard output, both pickled: a dict of
what the function takes, or of an array; else {"wrong": rule, "remedy": remedy}. What the code of
the user prints goes to standard error.
"""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import os
import pickle
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.pair import CylinderPair

__all__: list[str] = []

_NAMING = "name it as module:function; the campaign's folder is searched first"
_WRITING = "write it as def load(penetration, pair, K, n): ... with at least one parameter"
_RETURNING = "return an array of numbers, one load in N/mm for each penetration"


class _WrongError(Exception):
    """What is wrong with the user's code: a rule and a remedy."""


def _serve(folder: str, spec: str) -> None:
    """Answer requests until standard input ends."""
    requests, replies = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a terminal sends it to all; the parent ends this
    try:
        function = _imported(folder, spec)
        _reply(replies, {"parameters": _parameters(function)})
    except _WrongError as error:
        _reply(replies, _told(error))
        return
    while True:
        try:
            penetration, pair, parameters = pickle.load(requests)
        except EOFError:
            return
        try:
            _reply(replies, {"load": _loads(function, penetration, pair, parameters)})
        except _WrongError as error:
            _reply(replies, _told(error))


def _reply(replies: BinaryIO, reply: dict[str, Any]) -> None:
    """Send one reply, after all that the code has printed."""
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    pickle.dump(reply, replies)
    replies.flush()


def _told(error: _WrongError) -> dict[str, str]:
    """Return the reply that tells what is wrong."""
    rule, remedy = error.args
    return {"wrong": rule, "remedy": remedy}


def _imported(folder: str, spec: str) -> Callable[..., Any]:
    """Import a function, from a file in the folder if there is one."""
    module_name, _, name = spec.partition(":")
    if not all(part.isidentifier() for part in (*module_name.split("."), name)):
        rule = "cannot be imported: it does not name a module and a function in it"
        raise _WrongError(rule, _NAMING)
    sys.path.insert(0, folder)
    try:
        module = _module(module_name, Path(folder))
    except BaseException as error:  # the user's module may raise anything
        rule = f"cannot be imported ({type(error).__name__}: {error})"
        raise _WrongError(rule, _NAMING) from error
    finally:
        sys.path.remove(folder)
    function = getattr(module, name, None)
    if not callable(function):
        raise _WrongError(f"is not a function of {module_name}", _NAMING)
    found: Callable[..., Any] = function
    return found


def _module(name: str, folder: Path) -> ModuleType:
    """Return a module from a file in the folder, else by name from Python's path.

    A file is loaded under a name of its own, since one of Python's modules may have the same.
    """
    path = folder.joinpath(*name.split(".")).with_suffix(".py")
    if not path.is_file():
        return importlib.import_module(name)
    spec = importlib.util.spec_from_file_location("cylcontact_user_law", path)
    if spec is None or spec.loader is None:
        raise ImportError(f"{path} is not a module")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _parameters(function: Callable[..., Any]) -> dict[str, float | None]:
    """Return the arguments of a function after penetration and pair, with their defaults."""
    try:
        arguments = list(inspect.signature(function).parameters.values())
    except (TypeError, ValueError) as error:
        raise _WrongError("has no signature to read", _WRITING) from error
    plain = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    if len(arguments) < 3 or any(argument.kind not in plain for argument in arguments[2:]):
        names = ", ".join(map(str, arguments))
        rule = f"must take a penetration, a pair and named parameters, and takes ({names})"
        raise _WrongError(rule, _WRITING)
    defaults: dict[str, float | None] = {}
    for argument in arguments[2:]:
        given = argument.default is not inspect.Parameter.empty
        if given and not isinstance(argument.default, int | float):
            rule = f"has a default for {argument.name} that is not a number"
            raise _WrongError(rule, _WRITING)
        defaults[argument.name] = float(argument.default) if given else None
    return defaults


def _loads(
    function: Callable[..., Any],
    penetration: ArrayLike,
    pair: CylinderPair,
    parameters: dict[str, float],
) -> FloatArray:
    """Call the function and check what it returns."""
    shape = np.broadcast_shapes(np.shape(penetration), np.shape(pair.E_star), np.shape(pair.dR))
    try:
        with np.errstate(all="ignore"):  # what is not finite is outside the domain
            loads = np.asarray(function(penetration, pair, **parameters))
    except BaseException as error:  # SystemExit and KeyboardInterrupt too
        rule = f"stopped with {type(error).__name__}: {error}"
        remedy = "correct the function; it gets arrays, of penetration in mm and in the pair"
        raise _WrongError(rule, remedy) from error
    if loads.dtype.kind not in "iuf":
        kinds = {"c": "complex numbers", "b": "true or false", "U": "text"}
        kind = kinds.get(loads.dtype.kind, "what is not an array of numbers")
        raise _WrongError(f"returns {kind}", _RETURNING)
    if loads.shape != shape:
        rule = f"returns an array of another shape, {loads.shape}, than the penetration, {shape}"
        raise _WrongError(rule, _RETURNING)
    return as_floats(loads)


if __name__ == "__main__":
    _serve(*sys.argv[1:])
