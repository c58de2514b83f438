"""Laws defined by a Python function of the user, which a campaign names as module:function.

The function is `load(penetration, pair, **parameters)`: penetration in mm, an array; the pair that
belongs to each element; the load in N/mm, of the same shape. It has to increase with the
penetration. The module is imported from the campaign's folder, else from Python's path, and only
if a campaign or a command line names it. Reading a result imports nothing.
"""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import inspect
import platform
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, inside_or_nan
from cylcontact.errors import InputError
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.laws.definition import LawModel, Parameter
from cylcontact.pair import Contact, CylinderPair

__all__ = ["UserFunction", "UserLaw", "named_user_model", "user_model"]

# Decades searched for a bracket of the penetration, and bisections to machine precision.
_DECADES = 40
_BISECTIONS = 200
_RELATIVE_STEP = 1e-6


@dataclass(frozen=True)
class UserFunction:
    """A function of the user, imported when it is called.

    Attributes
    ----------
    spec : str
        "module:function".
    folder : str or None
        Where the module is searched for first. None if a result names the function, which is
        then never run.
    digest : str
        The hash of the module's file, so that every process runs this one; empty if Python's path
        has it.
    """

    spec: str
    folder: str | None
    digest: str = ""

    def __call__(self, penetration: FloatArray, pair: CylinderPair, **parameters: float) -> Any:
        """Call the function, importing it in this process first."""
        if self.folder is None:
            raise InputError(
                self.spec,
                "law",
                None,
                "is code of your own, which is not run because a result names it",
                f"redo the fit from its campaign, or name it: uncertainty --law {self.spec}",
            )
        return _imported(self.spec, self.folder, self.digest)(penetration, pair, **parameters)


@dataclass(frozen=True)
class UserLaw:
    """A contact law from a function of the user; the inverse is numerical."""

    function: UserFunction
    parameters: Mapping[str, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """The function as the campaign names it."""
        return self.function.spec

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm; NaN below 0."""
        delta = as_floats(penetration)
        touching = np.asarray(delta >= 0)
        return inside_or_nan(self._called(np.where(touching, delta, 0.0), pair), touching)

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm; NaN if the function has none."""
        f = as_floats(load)
        shape = np.broadcast_shapes(f.shape, np.shape(pair.E_star), np.shape(pair.dR))
        target = np.broadcast_to(f, shape)
        low, high = self._bracket(target, pair)
        bracketed = np.isfinite(low) & np.isfinite(high) & (target > 0)
        # Contact laws are nearly straight lines in logarithms.
        a, b = np.log(np.where(bracketed, low, 1.0)), np.log(np.where(bracketed, high, 10.0))
        for _ in range(_BISECTIONS):
            middle = (a + b) / 2
            if np.all((middle == a) | (middle == b)):
                break
            below = self._called(np.exp(middle), pair) < target
            a, b = np.where(below, middle, a), np.where(below, b, middle)
        outside = np.where(target == 0, 0.0, np.nan)
        return as_floats(np.where(bracketed, np.exp((a + b) / 2), outside))

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm², by a central difference."""
        delta = as_floats(penetration)
        step = _RELATIVE_STEP * delta
        with np.errstate(divide="ignore", invalid="ignore"):
            rise = self.load(delta + step, pair) - self.load(delta - step, pair)
            return as_floats(rise / (2 * step))

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return inf: the function states no largest load."""
        return as_floats(np.full_like(pair.E_star * as_floats(pair.dR), np.inf))

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return inf: the function states no largest penetration."""
        return self.max_load(pair)

    def _bracket(self, load: FloatArray, pair: CylinderPair) -> tuple[FloatArray, FloatArray]:
        """Return penetrations a decade apart that bracket the load; NaN if none do."""
        low, high = np.full(load.shape, np.nan), np.full(load.shape, np.nan)
        for decade in range(-_DECADES // 2, _DECADES // 2):
            delta = np.full(load.shape, 10.0**decade)
            reached = self._called(delta, pair)
            low = np.where(reached < load, delta, low)
            high = np.where((reached >= load) & np.isnan(high), delta, high)
        return low, high

    def _called(self, penetration: FloatArray, pair: CylinderPair) -> FloatArray:
        """Call the function and check what it returns."""
        try:
            with np.errstate(all="ignore"):  # what is not finite is outside the domain
                value = self.function(penetration, pair, **self.parameters)
            loads = as_floats(value)
        except InputError:
            raise
        except Exception as error:
            raise InputError(
                self.name,
                "load",
                None,
                f"stopped with {type(error).__name__}: {error}",
                "correct the function; it gets arrays, of penetration in mm and in the pair",
            ) from error
        shape = np.broadcast_shapes(np.shape(penetration), np.shape(pair.E_star), np.shape(pair.dR))
        if loads.shape != shape:
            raise InputError(
                self.name,
                "load",
                loads.shape,
                f"returns an array of another shape than the penetration, {shape}",
                "return an array with one load for each penetration",
            )
        return loads


def user_model(spec: str, folder: Path, contact: Contact, source: str) -> LawModel:
    """Return the model of a function; its parameters are the arguments after the pair.

    Parameters
    ----------
    spec : str
        "module:function".
    folder : Path
        Where the module is searched for first.
    contact : {"internal", "external"}
        The contact of the data.
    source : str
        The campaign's name in errors.

    Returns
    -------
    LawModel
        An argument with a default is fixed at it unless the campaign gives bounds.

    Raises
    ------
    InputError
        If the function cannot be imported, or does not take a penetration, a pair and named
        numbers.
    """
    path = _file_of(spec, str(folder))
    function = UserFunction(spec, str(folder), _digest(path))
    try:
        parameters = _parameters_of(_imported(spec, str(folder), function.digest), spec)
    except InputError as error:
        raise InputError(source, "law", spec, error.rule, error.remedy) from error
    return named_user_model(function, parameters, contact)


def named_user_model(
    function: UserFunction, parameters: tuple[Parameter, ...], contact: Contact
) -> LawModel:
    """Return the model of a function with these parameters, without importing it."""

    def build(values: Mapping[str, float]) -> ContactLaw:
        return UserLaw(function, dict(values))

    return LawModel(function.spec, contact, parameters, build, nominal_is_published=False)


def _parameters_of(function: Callable[..., Any], spec: str) -> tuple[Parameter, ...]:
    """Return the arguments of a function after penetration and pair."""
    remedy = "write it as def load(penetration, pair, K, n): ... with at least one parameter"
    try:
        arguments = list(inspect.signature(function).parameters.values())
    except (TypeError, ValueError) as error:
        raise InputError(spec, "law", None, "has no signature to read", remedy) from error
    plain = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    if len(arguments) < 3 or any(argument.kind not in plain for argument in arguments[2:]):
        names = ", ".join(map(str, arguments))
        rule = f"must take a penetration, a pair and named parameters, and takes ({names})"
        raise InputError(spec, "law", None, rule, remedy)
    parameters = []
    for argument in arguments[2:]:
        has_default = argument.default is not inspect.Parameter.empty
        if has_default and not isinstance(argument.default, int | float):
            rule = f"has a default for {argument.name} that is not a number"
            raise InputError(spec, "law", None, rule, remedy)
        nominal = float(argument.default) if has_default else None
        parameters.append(Parameter(argument.name, -np.inf, np.inf, nominal, value=nominal))
    return tuple(parameters)


@lru_cache(maxsize=64)
def _imported(spec: str, folder: str, digest: str) -> Callable[..., Any]:
    """Import a function, from a file in the folder if there is one."""
    module_name, _, name = spec.partition(":")
    path = _file_of(spec, folder)
    if _digest(path) != digest:
        raise InputError(
            spec,
            "law",
            None,
            f"{path} is missing or changed on {platform.node()}",
            "leave it alone during a fit; on a cluster, put it at the same place on all machines",
        )
    remedy = "name it as module:function; the campaign's folder is searched first"
    try:
        with _first_on_path(folder):
            module = _module(module_name, path)
        function = getattr(module, name, None)
    except Exception as error:  # the user's module may raise anything
        rule = f"cannot be imported ({type(error).__name__}: {error})"
        raise InputError(spec, "law", None, rule, remedy) from error
    if not callable(function):
        rule = f"is not a function of {module_name}"
        raise InputError(spec, "law", None, rule, remedy)
    result: Callable[..., Any] = function
    return result


def _file_of(spec: str, folder: str) -> Path:
    """Return the file of a module in the folder, which may not be there."""
    return Path(folder, *spec.partition(":")[0].split(".")).with_suffix(".py")


def _digest(path: Path) -> str:
    """Return the hash of a file, empty if there is none."""
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else ""


def _module(name: str, path: Path) -> ModuleType:
    """Return a module from a file if that is there, else by name from Python's path.

    A file is loaded under a unique name: another folder may have a module of the same name.
    """
    if not path.is_file():
        return importlib.import_module(name)
    spec = importlib.util.spec_from_file_location(f"cylcontact_user_{abs(hash(path))}", path)
    if spec is None or spec.loader is None:
        raise ImportError(f"{path} is not a module")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@contextmanager
def _first_on_path(folder: str) -> Iterator[None]:
    """Put a folder first on Python's path."""
    sys.path.insert(0, folder)
    try:
        yield
    finally:
        sys.path.remove(folder)
