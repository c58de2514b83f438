"""The user's laws: a Python function in a file, named as module:function.

The function is `load(penetration, E_star, dR, K=1.0, n=1.1)`: the penetration in mm, what it asks
of the pair (`cylcontact.laws.formula.OF_PAIR`) and constants. It returns the load in N/mm, which
has to increase with the penetration. The penetration is an array; what comes from the pair may be.
The module is imported from the folder of a campaign or the current one, else from Python's path,
and only if a campaign, a joint or a command line names it. Reading a result imports nothing.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import importlib.util
import platform
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.laws.formula import Formula, by_differences
from cylcontact.laws.law import AtPair, Law
from cylcontact.support.arrays import FloatArray, as_floats, require
from cylcontact.support.errors import InputError

_NAMING = "name it as module:function; the campaign's folder is searched first, then this one"


@dataclass(frozen=True)
class UserFunction:
    """The user's function, imported when it is first called in a process."""

    spec: str  # "module:function"
    # The folder of the module's file; empty if Python's path has the module, None if a result names
    # the function, which is then never run.
    folder: str | None
    digest: str = ""  # the hash of the file, so that every process runs this one

    @classmethod
    def named(cls, spec: str, *folders: Path) -> UserFunction:
        """Return the function that a name stands for, its file sought in these folders."""
        module, _, name = spec.partition(":")
        if not all(part.isidentifier() for part in (*module.split("."), name)):
            raise InputError(
                "law", "law", spec, "cannot be imported: it does not name a module and a function",
                _NAMING,
            )  # fmt: skip
        for folder in folders:
            path = _file_of(spec, str(folder.resolve()))
            if path.is_file():
                return cls(spec, str(folder.resolve()), _digest(path))
        return cls(spec, "")

    @property
    def function(self) -> Callable[..., Any]:
        """The function itself."""
        if self.folder is None:
            raise InputError(
                self.spec, "law", None,
                "is your own code, which is never run from a stored result",
                f"add --law {self.spec}, which predict takes, or redo the fit",
            )  # fmt: skip
        return _imported(self.spec, self.folder, self.digest)

    @property
    def formula(self) -> Formula:
        """The function as a formula."""
        return _formula(self.function)


@dataclass(frozen=True)
class UserLaw(Law):
    """A contact law from the user's function."""

    user: UserFunction
    values: Mapping[str, float] = field(default_factory=dict)
    origin: ClassVar[str] = "a function of the user's own"

    @property
    def name(self) -> str:  # type: ignore[override]
        """The function as the campaign names it."""
        return self.user.spec

    @property
    def formula(self) -> Formula:  # type: ignore[override]
        """The function as a formula."""
        return self.user.formula

    def constants_for(self, contact: Contact) -> dict[str, float]:
        """Return the constants of the function by name."""
        return dict(self.values)

    def at_pair(self, pair: CylinderPair) -> AtPair:
        """Return the function with checks of what it returns."""
        numbers = self.numbers_at(pair)
        shape = np.broadcast_shapes(np.shape(pair.E_star), np.shape(pair.dR))
        load = partial(self._loads, shape)
        return AtPair(
            lambda depth: load(depth, *numbers),
            lambda depth: as_floats(by_differences(load, depth, *numbers)),
            as_floats(np.full(shape, np.inf)),
            is_single=False,
        )

    def _loads(self, shape: tuple[int, ...], depth: ArrayLike, *numbers: Any) -> FloatArray:
        """Call the function and check what it returns."""
        shape = np.broadcast_shapes(np.shape(depth), shape)
        try:  # its own array, for it may write into it; what it prints is no part of a report
            with contextlib.redirect_stdout(sys.stderr):
                given = np.array(np.broadcast_to(depth, shape))[()]
                loads = np.asarray(self.formula.load(given, *numbers))
        except InputError:
            raise
        except (Exception, SystemExit) as error:
            rule = f"stopped with {type(error).__name__}: {error}"
            remedy = "correct the function; it gets arrays, of penetration in mm and in the pair"
            raise InputError(self.name, "load", None, rule, remedy) from error
        kinds = {"c": "complex numbers", "b": "true or false", "U": "text"}
        kind, rule = loads.dtype.kind, ""
        if kind not in "iuf":
            rule = f"returns {kinds.get(kind, 'what is not an array of numbers')}"
        elif loads.shape != shape:
            rule = f"returns an array of another shape, {loads.shape}, than the penetration's"
            rule += f" {shape}"
        remedy = "return an array of numbers, one load in N/mm for each penetration"
        require(not rule, self.name, "load", None, rule, remedy)
        return as_floats(loads)


def user_law(spec: str, *folders: Path) -> UserLaw:
    """Return the law of a function whose constants have defaults."""
    user = UserFunction.named(spec, *folders)
    values = user.formula.constants
    for name, value in values.items():
        rule, remedy = f"has no value for {name}", f"give it a default: {name}=1.0"
        require(value is not None, spec, "law", None, rule, remedy)
    return UserLaw(user, {name: float(value or 0.0) for name, value in values.items()})


@lru_cache(maxsize=64)
def _formula(function: Callable[..., Any]) -> Formula:
    return Formula(function, equation=f"the function {function.__name__}")


@lru_cache(maxsize=64)
def _imported(spec: str, folder: str, digest: str) -> Callable[..., Any]:
    """Import a function, from the file in the folder if there is one, under a name of its own."""
    module_name, _, name = spec.partition(":")
    path = _file_of(spec, folder)
    if folder and _digest(path) != digest:
        rule = f"{path} is missing or changed on {platform.node()}"
        remedy = "leave it alone during a fit; on a cluster, put the same file on all machines"
        raise InputError(spec, "law", None, rule, remedy)
    sys.path.insert(0, folder or ".")
    try:
        with contextlib.redirect_stdout(sys.stderr):
            if folder:
                found = importlib.util.spec_from_file_location(f"user_law_{path.stem}", path)
                module = importlib.util.module_from_spec(found)  # type: ignore[arg-type]
                found.loader.exec_module(module)  # type: ignore[union-attr]
            else:
                module = importlib.import_module(module_name)
    except (Exception, SystemExit) as error:  # the user's module may raise anything
        rule = f"cannot be imported ({type(error).__name__}: {error})"
        raise InputError(spec, "law", None, rule, _NAMING) from error
    finally:
        sys.path.pop(0)
    function = getattr(module, name, None)
    if not callable(function):
        raise InputError(spec, "law", None, f"is not a function of {module_name}", _NAMING)
    return function


def _file_of(spec: str, folder: str) -> Path:
    """Return the file of a module in the folder, which may not be there."""
    return Path(folder, *spec.partition(":")[0].split(".")).with_suffix(".py")


def _digest(path: Path) -> str:
    """Return the hash of a file, empty if there is none."""
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else ""
