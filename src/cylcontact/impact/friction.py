"""Friction in a contact: Coulomb's law, modified (Eqs 14–15).

The paper's Eq 14 makes f_t a vector,
−c_f·c_d·f_n·**v**_t/v_t, and Eq 13 then multiplies it by the tangent **t** as if it were a scalar;
**v**_t is not defined. Here f_t is the scalar. With the velocities of the two bodies at the contact
point,

    v_t = (v_i − v_j)·t,    f_t = −c_f·c_d(|v_t|)·f_n·sgn(v_t),

and f_t·t acts on body i, −f_t·t on body j. Reversing t changes the sign of both v_t
and f_t, and leaves the force unchanged. The power f_t·v_t of the pair of forces is never positive.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.support.arrays import (
    FloatArray,
    as_floats,
    inside_or_nan,
    require,
    require_not_negative,
)


def friction_load(
    normal_load: ArrayLike,
    tangential_velocity: ArrayLike,
    coefficient: ArrayLike,
    v0: float,
    v1: float,
) -> FloatArray:
    """Return f_t = −c_f·c_d·f_n·sgn(v_t), the friction on body i along the tangent (Eq 14).

    Parameters
    ----------
    normal_load : array_like
        f_n ≥ 0, in N or N/mm.
    tangential_velocity : array_like
        v_t = (v_i − v_j)·t at the contact point, in mm/s.
    coefficient : array_like
        Friction coefficient c_f ≥ 0.
    v0, v1 : float
        The speeds of Eq 15 in mm/s, 0 ≤ v0 < v1. With v0 above 0 nothing holds at rest; with
        v0 = 0 a load below the friction limit creeps, at v1 times the share of the limit that it
        asks for.

    Returns
    -------
    array of float
        In the unit of `normal_load`, of the broadcast shape; 0 at v_t = 0, and NaN where the
        normal load is negative (no contact).

    Raises
    ------
    InputError
        If the coefficient is negative or not finite, or not 0 ≤ v0 < v1.

    Examples
    --------
    >>> print(friction_load(50.0, [-20.0, 2.0, 20.0], coefficient=0.1, v0=1.0, v1=5.0))
    [ 5.   -1.25 -5.  ]
    """
    remedy = "give e.g. 0.1, or 0 for no friction"
    c_f = require_not_negative(coefficient, "friction", "coefficient", remedy)
    f_n = as_floats(normal_load)
    c_d = dynamic_correction(tangential_velocity, v0, v1)
    touching = f_n >= 0
    # The sign of −v_t instead of minus the sign of v_t avoids a negative zero at rest.
    direction = np.sign(0.0 - as_floats(tangential_velocity))
    return inside_or_nan(c_f * c_d * np.where(touching, f_n, 0.0) * direction, touching)


def dynamic_correction(speed: ArrayLike, v0: float, v1: float) -> FloatArray:
    """Return c_d: 0 up to v0, 1 from v1 on, linear in between (Eq 15).

    Speeds are in mm/s, v_t of either sign; raises `InputError` unless 0 ≤ v0 < v1. Without the
    correction friction would jump where v_t changes sign, and an integrator would chatter there.

    Examples
    --------
    >>> print(dynamic_correction([0.0, 1.0, 2.0, 5.0, 100.0], v0=1.0, v1=5.0))
    [0.   0.   0.25 1.   1.  ]
    """
    rule = "must be finite, with 0 ≤ v0 < v1"
    remedy = "give two speeds in mm/s, the smaller one first"
    require(0 <= v0 < v1 and np.isfinite(v1), "friction", "v0, v1", (v0, v1), rule, remedy)
    # Clip first: a very large speed would overflow in the quotient.
    return as_floats((np.clip(np.abs(as_floats(speed)), v0, v1) - v0) / (v1 - v0))
