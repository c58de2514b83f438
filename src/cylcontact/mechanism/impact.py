"""An isolated impact of a free journal against its bearing.

It uses the same equations, events and integrator as a mechanism, without joints and drive, so that
its restitution can be compared with the closed form of `cylcontact.impact`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cylcontact.errors import InputError
from cylcontact.laws import ContactLaw
from cylcontact.laws.kernels import kernel
from cylcontact.mechanism import augmented, contact, derived, dop853
from cylcontact.mechanism.loop import Run, advance
from cylcontact.mechanism.step_history import LEDGERS, StepHistory
from cylcontact.mechanism.system import System, augmented_block, law_block
from cylcontact.pair import CylinderPair

__all__ = ["Impact", "isolated_impact"]

# Simulated time, in units of the time to reach the bearing.
_CROSSINGS = 3


@dataclass(frozen=True)
class Impact:
    """Result of an isolated impact.

    Attributes
    ----------
    restitution : float
        Speed after the impact over speed before.
    duration : float
        Duration of contact in s.
    max_penetration : float
        Largest penetration in m.
    dissipated : float
        Dissipated energy in J.
    """

    restitution: float
    duration: float
    max_penetration: float
    dissipated: float


def isolated_impact(
    law: ContactLaw,
    pair: CylinderPair,
    chi: float,
    mass: float,
    speed: float,
    tolerance: float = 1e-10,
) -> Impact:
    """Simulate the impact of a journal that flies from the centre of a fixed bearing against it.

    Parameters
    ----------
    law : ContactLaw
        The contact law.
    pair : CylinderPair
        An internal pair with radii and a length, in mm and MPa.
    chi : float
        Hysteresis factor χ.
    mass : float
        Mass of the journal in kg.
    speed : float
        Its initial speed in m/s.
    tolerance : float
        Tolerance of the integrator.

    Returns
    -------
    Impact

    Raises
    ------
    InputError
        If the pair has no radii or length, or the law ends before the journal turns back.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material, laws, dissipation
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.5, material=steel, length=10.0)
    >>> impact = isolated_impact(laws.Enhanced(), pair, chi=0.1425, mass=0.14, speed=1.0)
    >>> print(f"{impact.restitution:.7f} {dissipation.achieved_restitution(0.1425):.7f}")
    0.9131767 0.9131767
    """
    for key, value in (("mass", mass), ("speed", speed)):
        if not 0 < value < np.inf:
            raise InputError("isolated_impact", key, value, "must be positive", "give it in SI")
    radii = pair.radii("an impact")
    numbers = np.zeros(augmented.MODEL_HEADER)
    numbers[augmented.BODIES], numbers[augmented.DRIVER_ROW] = 1, -1
    numbers[augmented.BODY_I] = -1
    start = np.zeros(6 + len(LEDGERS))
    start[3] = speed
    none = np.empty((0, 2))
    p = law_block(kernel(law, pair), augmented_block(numbers, np.full(3, mass), none, none))
    p[contact.CHI], p[contact.V0], p[contact.V1] = chi, 0.0, 1.0
    p[contact.CLEARANCE] = float(radii[0] - radii[1]) * 1e-3
    p[contact.R_BEARING], p[contact.R_JOURNAL] = radii[0] * 1e-3, radii[1] * 1e-3
    p[contact.LENGTH] = pair.contact_length("an impact")
    scale = np.repeat([p[contact.CLEARANCE], speed], 3)
    system = System(dop853.AUGMENTED, p, start, scale, True, "isolated_impact", law.name)
    flight = p[contact.CLEARANCE] / speed
    rows, _ = advance(Run.start(system, tolerance, flight), _CROSSINGS * flight)
    return _impact(rows, p[contact.CLEARANCE])


def _impact(rows: StepHistory, clearance: float) -> Impact:
    """Return the result for the first contact in the rows."""
    time, values = rows.time, rows.values
    begins, ends = derived.changes(rows.in_contact)
    if not (begins.size and ends.size):
        raise InputError(
            "isolated_impact", "speed", None, "the journal does not come back in time",
            "give a faster or lighter journal",
        )  # fmt: skip
    first, last = int(begins[0]), int(ends[0])
    lost = values[:, LEDGERS["normal_dissipation"]]
    return Impact(
        restitution=float(-values[last, 3] / values[first, 3]),
        duration=float(time[last] - time[first]),
        max_penetration=float(np.hypot(*values[first : last + 1, :2].T).max() - clearance),
        dissipated=float(lost[last] - lost[first]),
    )
