"""Laws defined by a Python function of the user, which a campaign names as module:function.

The function is `load(penetration, pair, **parameters)`: penetration in mm, an array; the pair that
belongs to each element; the load in N/mm, of the same shape. It has to increase with the
penetration. It runs in a process of its own. The module is imported from the campaign's folder,
else from Python's path, and only if a campaign or a command line names it. Reading a result
imports nothing.
"""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, inside_or_nan
from cylcontact.errors import InputError
from cylcontact.fitting.user_process import LAW_TIMEOUT, process_of
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.laws.definition import LawModel, Parameter
from cylcontact.pair import Contact, CylinderPair
from cylcontact.reading import SPEC_BYTES, read_bytes

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
    seconds : float
        How long a call may take.
    """

    spec: str
    folder: str | None
    digest: str = ""
    seconds: float = LAW_TIMEOUT

    def __call__(
        self, penetration: FloatArray, pair: CylinderPair, parameters: Mapping[str, float]
    ) -> FloatArray:
        """Call the function in its process."""
        if self.folder is None:
            raise InputError(
                self.spec,
                "law",
                None,
                "is code of your own, which is not run because a result names it",
                f"redo the fit from its campaign, or name it: fit RESULT.json --law {self.spec}",
            )
        _require_same_file(self.spec, self.folder, self.digest)
        process = process_of(self.spec, self.folder, self.digest, self.seconds)
        loads: FloatArray = process.call((penetration, pair, dict(parameters)), self.seconds)
        return loads


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
        loads = self.function(np.where(touching, delta, 0.0), pair, self.parameters)
        return inside_or_nan(loads, touching)

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
            below = self.function(np.exp(middle), pair, self.parameters) < target
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
            reached = self.function(delta, pair, self.parameters)
            low = np.where(reached < load, delta, low)
            high = np.where((reached >= load) & np.isnan(high), delta, high)
        return low, high


def user_model(
    spec: str, folder: Path, contact: Contact, source: str, seconds: float | None = None
) -> LawModel:
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
    seconds : float, optional
        How long a call may take; by default a minute.

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
    function = UserFunction(spec, str(folder), _digest(path), seconds or LAW_TIMEOUT)
    try:
        # Anew: what the module imports may have changed since.
        process = process_of(spec, str(folder), function.digest, function.seconds, anew=True)
    except InputError as error:
        raise InputError(source, "law", spec, error.rule, error.remedy) from error
    parameters = tuple(
        Parameter(name, -np.inf, np.inf, nominal, value=nominal)
        for name, nominal in process.parameters.items()
    )
    return named_user_model(function, parameters, contact)


def named_user_model(
    function: UserFunction, parameters: tuple[Parameter, ...], contact: Contact
) -> LawModel:
    """Return the model of a function with these parameters, without importing it."""

    def build(values: Mapping[str, float]) -> ContactLaw:
        return UserLaw(function, dict(values))

    return LawModel(
        function.spec,
        contact,
        parameters,
        build,
        nominal_is_published=False,
        digest=function.digest,
    )


@lru_cache(maxsize=64)
def _require_same_file(spec: str, folder: str, digest: str) -> None:
    """Raise `InputError` if the module's file is not the one that the fit has begun with."""
    path = _file_of(spec, folder)
    if _digest(path) != digest:
        raise InputError(
            spec,
            "law",
            None,
            f"{path} is missing or changed on {platform.node()}",
            "leave it alone during a fit; on a cluster, put it at the same place on all machines",
        )


def _file_of(spec: str, folder: str) -> Path:
    """Return the file of a module in the folder, which may not be there."""
    return Path(folder, *spec.partition(":")[0].split(".")).with_suffix(".py")


def _digest(path: Path) -> str:
    """Return the hash of a file, empty if there is none."""
    if not path.is_file():
        return ""
    return hashlib.sha256(read_bytes(path, SPEC_BYTES)).hexdigest()
