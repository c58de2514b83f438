"""An isolated impact of a free pin against its bearing.

It uses the same equations, events and integrator as a mechanism, without joints and drive, so that
its restitution can be compared with the closed form of `cylcontact.impact`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from cylcontact.bodies.pair import CylinderPair
from cylcontact.joint.clearance import ClearanceJoint
from cylcontact.laws import ContactLaw
from cylcontact.mechanism.joint_motion import changes
from cylcontact.mechanism.model import GROUND, Body, IntegrationSpec, Joint, Mechanism
from cylcontact.mechanism.run import Run, Settings
from cylcontact.mechanism.trajectory import Trajectory
from cylcontact.support.arrays import require

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
    """Simulate the impact of a pin that flies from the centre of a fixed bearing against it.

    Parameters
    ----------
    law : ContactLaw
        The contact law.
    pair : CylinderPair
        An internal pair with radii and a length, in mm and MPa.
    chi : float
        Hysteresis factor χ.
    mass : float
        Mass of the pin in kg.
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
        If the pair has no radii or length, or the law ends before the pin turns back.

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
        good = 0 < value < np.inf
        require(good, "isolated_impact", key, value, "must be positive", "give it in SI")
    joint = ClearanceJoint("impact", "SI", pair, law, chi, 0.0, 0.0, 1.0, data={"law": law.name})
    flight = joint.radial * 1e-3 / speed
    pin = Body("pin", mass, mass, (0.0, 0.0, 0.0))
    held = Joint("impact", "revolute", GROUND, 0, clearance=joint)
    how = IntegrationSpec(
        alpha=0.0, beta=0.0, max_step=flight, tolerance=1e-8, revolutions=1, period=flight
    )
    mechanism = Mechanism("impact", (pin,), (held,), (), (), (0.0, 0.0), how, {}, "isolated_impact")
    settings = Settings("multiplier", tolerance, flight, "stop")
    run = Run.start(mechanism, settings)
    values = run.state.values.copy()
    values[3] = speed
    run.state = replace(run.state, values=values)
    # Lengths of the size of the clearance, and speeds of that of the impact.
    run.scale, run.relative = np.repeat([joint.radial * 1e-3, speed], 3), tolerance
    rows, _ = run.advance(_CROSSINGS * flight)
    (contact,) = [Trajectory(mechanism, settings, rows).joint]
    begins, ends = changes(contact.in_contact)
    rule, remedy = "the pin does not come back in time", "give a faster or lighter pin"
    require(ends.size > 0, "isolated_impact", "speed", None, rule, remedy)
    first, last = begins[0], ends[0]
    lost = contact.normal_dissipation
    return Impact(
        restitution=float(-rows.values[last, 3] / rows.values[first, 3]),
        duration=float(rows.time[last] - rows.time[first]),
        max_penetration=float(contact.penetration[first : last + 1].max()),
        dissipated=float(lost[last] - lost[first]),
    )
