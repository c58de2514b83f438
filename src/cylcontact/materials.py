"""A linear elastic, isotropic material."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cylcontact.arrays import FloatArray, as_floats, require, same_fields
from cylcontact.card import card


@dataclass(frozen=True, eq=False)
class Material:
    """A linear elastic, isotropic material with an optional yield stress.

    Parameters
    ----------
    name : str
        What reports call it.
    E : float or array_like
        Young's modulus in MPa; an array describes a family of materials and broadcasts
        with everything else.
    nu : float or array_like
        Poisson's ratio, from 0 to 0.5.
    yield_stress : float, optional
        Yield stress (tensile strength for brittle materials) in MPa.

    Raises
    ------
    InputError
        If a modulus or yield stress is not positive and finite, or ν leaves [0, 0.5].

    Examples
    --------
    >>> steel = Material("steel", E=207e3, nu=0.3, yield_stress=250)
    >>> print(f"{steel.plane_strain_modulus:.1f} MPa")
    227472.5 MPa
    """

    name: str
    E: float | FloatArray
    nu: float | FloatArray
    yield_stress: float | None = None

    def __post_init__(self) -> None:
        source = f"Material {self.name!r}"
        modulus, ratio = as_floats(self.E), as_floats(self.nu)
        require(
            (modulus > 0) & np.isfinite(modulus),
            source,
            "E",
            self.E,
            "Young's modulus must be positive and finite",
            "give it in MPa, e.g. 207e3 for steel",
        )
        require(
            (ratio >= 0) & (ratio <= 0.5),
            source,
            "nu",
            self.nu,
            "Poisson's ratio must lie in [0, 0.5]",
            "give e.g. 0.3 for steel",
        )
        if self.yield_stress is not None:
            require(
                self.yield_stress > 0 and np.isfinite(self.yield_stress),
                source,
                "yield_stress",
                self.yield_stress,
                "yield stress must be positive and finite",
                "give it in MPa, or leave it out",
            )

    def __eq__(self, other: object) -> bool:
        return same_fields(self, other)

    __hash__ = None  # type: ignore[assignment]

    def _repr_html_(self) -> str:
        rows = {"E (MPa)": self.E, "ν (-)": self.nu, "yield stress (MPa)": self.yield_stress}
        return card(f"Material {self.name}", rows)

    @property
    def plane_strain_modulus(self) -> FloatArray:
        """E/(1 − ν²) in MPa."""
        modulus, ratio = as_floats(self.E), as_floats(self.nu)
        return modulus / (1 - ratio**2)
