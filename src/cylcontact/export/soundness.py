"""Whether coefficients define a contact law at all, before they are written out as code."""

from __future__ import annotations

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.errors import InputError
from cylcontact.laws.law import ContactLaw
from cylcontact.materials import Material
from cylcontact.pair import CONTACTS, Contact, CylinderPair

# Clearances and sums of radii in mm, moduli in MPa and penetrations relative to ΔR that are tried.
_DR: dict[Contact, tuple[float, float]] = {"internal": (0.005, 9.0), "external": (5.0, 500.0)}
_MODULI = (2e3, 70e3, 207e3, 600e3)
_STEEL = 207e3
_DEPTHS = np.geomspace(1e-6, 1.0, 61)[:, None, None]
# Rounding may take this part from a load that levels off.
_ROUNDING = 1e-9


def require_contact_law(law: ContactLaw, contact: Contact | None) -> None:
    """Refuse a law whose load is negative or decreases for some pair, or exists for none.

    Raises `InputError` with the penetration and the pair where it fails.
    """
    has_load = False
    for each in CONTACTS if contact is None else (contact,):
        try:
            pair, depth, loads = _loads(law, each, _MODULI)
        except InputError:  # some laws are for steel alone
            pair, depth, loads = _loads(law, each, (_STEEL,))
        before = np.fmax.accumulate(np.nan_to_num(loads, nan=-np.inf), axis=0)[:-1]
        falls = loads[1:] < before * (1 - _ROUNDING)
        wrong = np.concatenate([loads[:1] < 0, (loads[1:] < 0) | falls])
        if wrong.any():
            at = tuple(np.argwhere(wrong)[0])
            dR = float(np.broadcast_to(pair.dR, loads.shape)[at])
            E = float(np.broadcast_to(pair.material_i.E, loads.shape)[at])
            what = "is negative" if loads[at] < 0 else "decreases"
            rule = (
                f"is no contact law with these coefficients: its load {what} at {depth[at]:.3g} mm "
                f"for ΔR = {dR:.3g} mm and E = {E:g} MPa"
            )
            raise InputError("export", "law", law.name, rule, "correct them, or redo the fit")
        has_load = has_load or bool(((loads > 0) & np.isfinite(loads)).any())
    if not has_load:
        rule = "has no load at any penetration with these coefficients"
        raise InputError("export", "law", law.name, rule, "correct them, or redo the fit")


def _loads(
    law: ContactLaw, contact: Contact, moduli: tuple[float, ...]
) -> tuple[CylinderPair, FloatArray, FloatArray]:
    """Return pairs of many clearances and moduli, and loads over many penetrations."""
    dR = np.geomspace(*_DR[contact], 13)[:, None]
    material = Material("any", np.array(moduli), 0.3)
    R_i = 20 * dR if contact == "internal" else dR / 2
    pair = CylinderPair.from_dR(contact, dR, material, length=10.0, R_i=R_i)
    with np.errstate(all="ignore"):
        loads = law.load(_DEPTHS * dR, pair)
    depth, loads = np.broadcast_arrays(_DEPTHS * dR, loads)
    return pair, depth, loads
