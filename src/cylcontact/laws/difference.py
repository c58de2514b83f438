"""The difference between two laws, Eq 9."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.pair import CylinderPair

__all__ = ["difference_percent"]


def difference_percent(
    law: ContactLaw, reference: ContactLaw, load: ArrayLike, pair: CylinderPair
) -> FloatArray:
    """Return 100·(δ_law − δ_reference)/δ_reference in percent at equal load (Eq 9).

    Parameters
    ----------
    law, reference : ContactLaw
        The law and the one it is compared with.
    load : array_like
        Load per unit length in N/mm.
    pair : CylinderPair
        The pair, possibly array-valued.

    Returns
    -------
    array of float
        Percent, of the broadcast shape; NaN at zero load and where either law is undefined.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material, laws
    >>> pair = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    >>> print(difference_percent(laws.Enhanced(), laws.Johnson(), [10.0, 100.0], pair).round(2))
    [ 8.51 -2.88]
    """
    delta = law.penetration(load, pair)
    delta_reference = reference.penetration(load, pair)
    with np.errstate(divide="ignore", invalid="ignore"):
        return as_floats(100 * (delta - delta_reference) / delta_reference)
