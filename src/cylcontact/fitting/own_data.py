"""Fit a law to measurements in one call, or choose one, as `cylcontact fit` and `choose` do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from cylcontact.datasets.measurements import Constants
from cylcontact.errors import InputError
from cylcontact.fitting.choice import Choice, choose_law
from cylcontact.fitting.results import DataFit
from cylcontact.fitting.table_campaign import MeasuredTable, read_table
from cylcontact.fitting.table_fit import fit_table
from cylcontact.pair import Contact, CylinderPair
from cylcontact.parallel import Workers


def fit(
    data: pd.DataFrame | Path | str,
    law: str,
    pair: CylinderPair | None = None,
    *,
    contact: Contact | None = None,
    constants: Constants | None = None,
    free: Sequence[str] = (),
    fixed: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    jobs: Workers = 1,
    **settings: Any,
) -> DataFit:
    """Fit a law to measurements.

    Parameters
    ----------
    data : DataFrame or path
        Columns of loads and penetrations with their units, such as load_N and penetration_um, and
        of whatever differs from row to row: dR_um, E_GPa, material, ….
    law : str
        Its name, or module:function for one of your own.
    pair : CylinderPair, optional
        The two cylinders, if they are the same in all rows.
    contact : {"internal", "external"}, optional
        Without a pair, a pin in a hole or two rollers.
    constants : mapping, optional
        Values for all rows by column name, in place of a pair or beside it.
    free : sequence of str, optional
        Parameters to search beside the usual ones, with their default bounds: the constants of a
        law's shape, or the compliance of the rig.
    fixed : mapping of str to float, optional
        Parameters to hold at a value.
    bounds : mapping of str to (low, high), optional
        Parameters to search between two values.
    jobs : int or Cluster, optional
        Worker processes; the result does not depend on them.
    **settings
        Other keys of a campaign file: noise, group, drift, load_error, loss, columns, branch,
        objective, ignore, materials, ties, starts, seed, name.

    Returns
    -------
    DataFit

    Raises
    ------
    InputError
        If the data or a setting is invalid, or the law is undefined for some of the data.

    Examples
    --------
    >>> import cylcontact as cc
    >>> steel = cc.Material("steel", E="207 GPa", nu=0.3)
    >>> pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.97, material=steel, length=20.0)
    >>> load, noise = np.geomspace(10.0, 1000.0, 9), 1 + 0.01 * np.cos(np.arange(9))
    >>> depth = cc.laws.Explicit().penetration(load, pair) * noise
    >>> data = pd.DataFrame({"load_N": load * 20.0, "penetration_um": 1e3 * depth})
    >>> result = cc.fit(data, "explicit", pair)
    >>> print(result.to_frame().loc["stiffness_factor", ["value", "standard_error"]].to_dict())
    {'value': 1.0008..., 'standard_error': 0.0043...}
    """
    settings |= _parameters(free, fixed, bounds)
    return fit_table(_table(data, law, pair, contact, constants, settings).campaign(law), jobs)


def choose(
    data: pd.DataFrame | Path | str,
    pair: CylinderPair | None = None,
    *,
    contact: Contact | None = None,
    constants: Constants | None = None,
    laws: Sequence[str] = (),
    fixed: Mapping[str, float] | None = None,
    **settings: Any,
) -> Choice:
    """Fit all laws that apply to measurements, rank them, and say whether the data can tell.

    Parameters
    ----------
    data, pair, contact, constants
        As for `fit`.
    laws : sequence of str, optional
        The laws to compare; by default all for the contact.
    fixed : mapping of str to float, optional
        Values of offset or compliance, or of parameters that all these laws have, that are known.
    **settings
        As for `fit`.

    Returns
    -------
    Choice

    Raises
    ------
    InputError
        If the data or a setting is invalid, or no law can be fitted.

    Examples
    --------
    >>> import cylcontact as cc
    >>> steel = cc.Material("steel", E="207 GPa", nu=0.3)
    >>> pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.97, material=steel, length=20.0)
    >>> load, noise = np.geomspace(10.0, 3000.0, 30), 1 + 0.01 * np.cos(np.arange(30))
    >>> depth = cc.laws.Explicit().penetration(load, pair) * noise
    >>> data = pd.DataFrame({"load_N": load * 20.0, "penetration_um": 1e3 * depth})
    >>> cc.choose(data, pair, laws=["johnson", "explicit", "power"]).undecided
    ['explicit']
    """
    first = laws[0] if laws else "johnson"
    settings = _parameters((), fixed, None) | settings
    return choose_law(_table(data, first, pair, contact, constants, settings), laws)


def _parameters(
    free: Sequence[str],
    fixed: Mapping[str, float] | None,
    bounds: Mapping[str, tuple[float, float]] | None,
) -> dict[str, Any]:
    """Return parameters as the keys of a campaign."""
    tables: dict[str, dict[str, Any]] = {}
    for name, value in (fixed or {}).items():
        tables[name] = {"value": value, "fixed": True}
    for name, (low, high) in (bounds or {}).items():
        tables[name] = {"low": low, "high": high}
    return {"free": tuple(free) or None, "parameters": tables or None}


def _table(
    data: pd.DataFrame | Path | str,
    law: str,
    pair: CylinderPair | None,
    contact: Contact | None,
    constants: Constants | None,
    settings: Mapping[str, Any],
) -> MeasuredTable:
    """Return measurements of a pair."""
    if pair is not None and contact not in (None, pair.contact):
        rule = f"contradicts the pair, which is for {pair.contact} contact"
        raise InputError("fit", "contact", contact, rule, "leave it out")
    kind = pair.contact if pair is not None else contact
    if kind is None:
        raise InputError("fit", "contact", None, "is required without a pair", "give a pair")
    return read_table(
        data if isinstance(data, pd.DataFrame) else Path(data),
        law,
        kind,
        {**(constants_of(pair) if pair is not None else {}), **(constants or {})},
        **settings,
    )


def constants_of(pair: CylinderPair) -> dict[str, float]:
    """Return a pair as constants of a table of measurements.

    Raises
    ------
    InputError
        If it is in plane stress, or holds arrays.
    """
    pair.require_plane_strain("A fit to measurements")
    i, j = pair.material_i, pair.material_j
    values = {"E_i_MPa": i.E, "nu_i": i.nu, "E_j_MPa": j.E, "nu_j": j.nu, "length_mm": pair.length}
    if pair.R_i is None or pair.R_j is None:
        values |= {"dR_mm": pair.dR, "R_i_mm": pair.R_i, "R_j_mm": pair.R_j}
    else:
        values |= {"R_i_mm": pair.R_i, "R_j_mm": pair.R_j}
    given = {name: value for name, value in values.items() if value is not None}
    for name, value in given.items():
        if np.ndim(value):
            rule, remedy = "is an array", "give it as a column of the data"
            raise InputError("fit", name, "of the pair", rule, remedy)
    return {name: float(value) for name, value in given.items()}
