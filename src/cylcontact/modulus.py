"""Young's modulus in specs: a number of GPa, or a text with its unit."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator

from cylcontact.errors import InputError
from cylcontact.materials import modulus_in_MPa
from cylcontact.spec import broken

# In GPa, above diamond's 1200: a larger bare number was probably meant in MPa.
_LARGEST_BARE = 1500.0


def _in_GPa(E: object) -> object:
    """Return a modulus with a unit as a number of GPa; pydantic judges what has none."""
    if isinstance(E, str) and E.rstrip().endswith("Pa"):
        try:
            return float(modulus_in_MPa(E, "", "")) * 1e-3
        except InputError as error:
            raise broken("", E, error.rule, error.remedy) from None
    if isinstance(E, int | float) and _LARGEST_BARE < E < 1e300:
        remedy = f'did you mean {E * 1e-3:g}? Or write "{E:g} GPa"'
        raise broken("", E, "a bare number is in GPa, and diamond has 1200", remedy)
    return E


Modulus = Annotated[float, BeforeValidator(_in_GPa)]
