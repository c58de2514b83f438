"""Fit a law to measurements in one call, as `cylcontact fit TABLE` does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from cylcontact.datasets.measurements import Constants
from cylcontact.errors import InputError
from cylcontact.fitting.calibration import calibrate
from cylcontact.fitting.campaign import Campaign, campaign_of_table
from cylcontact.fitting.result import FitResult
from cylcontact.pair import Contact, CylinderPair
from cylcontact.parallel import Workers

__all__ = ["campaign_of", "constants_of", "fit"]


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
) -> FitResult:
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
    FitResult

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
    campaign = campaign_of(
        data,
        law,
        pair,
        contact=contact,
        constants=constants,
        free=free,
        fixed=fixed,
        bounds=bounds,
        **settings,
    )
    return calibrate(campaign, jobs)


def campaign_of(
    data: pd.DataFrame | Path | str,
    law: str,
    pair: CylinderPair | None = None,
    *,
    contact: Contact | None = None,
    constants: Constants | None = None,
    free: Sequence[str] = (),
    fixed: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    **settings: Any,
) -> Campaign:
    """Return the campaign that `fit` runs, with the same parameters."""
    if pair is not None and contact not in (None, pair.contact):
        rule = f"contradicts the pair, which is for {pair.contact} contact"
        raise InputError("fit", "contact", contact, rule, "leave it out")
    kind = pair.contact if pair is not None else contact
    if kind is None:
        raise InputError("fit", "contact", None, "is required without a pair", "give a pair")
    tables = {name: {"value": value, "fixed": True} for name, value in (fixed or {}).items()}
    for name, (low, high) in (bounds or {}).items():
        tables[name] = {"low": low, "high": high}
    return campaign_of_table(
        data if isinstance(data, pd.DataFrame) else Path(data),
        law,
        kind,
        {**(constants_of(pair) if pair is not None else {}), **(constants or {})},
        free=tuple(free) or None,
        parameters=tables or None,
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
