"""Parameter block, initial state and tolerances of a mechanism, for the integrator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.laws.kernels import Kernel, kernel, kernel_load, kernel_stiffness
from cylcontact.mechanism import augmented, constraints, contact, dop853
from cylcontact.mechanism import minimal_coordinates as minimal
from cylcontact.mechanism.assembly import assemble, joint_table
from cylcontact.mechanism.model import Mechanism
from cylcontact.mechanism.slider_crank import masses, recognise
from cylcontact.mechanism.step_history import LEDGERS

__all__ = ["TANGENT_FROM", "System", "augmented_block", "build", "law_block"]

# Assumed: where the straight line of "tangent" takes over, as a fraction of the law's largest
# penetration. At the limit itself Johnson's law is infinitely stiff.
TANGENT_FROM = 0.9

# Scales of the absolute tolerances in m and m/s: lengths of the size of the clearance, speeds of
# some metres per second.
_LENGTH_SCALE, _SPEED_SCALE = 1e-4, 1.0


@dataclass(frozen=True)
class System:
    """One mechanism with one method.

    Attributes
    ----------
    model : int
        `dop853.MINIMAL` or `dop853.AUGMENTED`.
    block : array of float
        The parameter block.
    start : array of float
        The state at t = 0.
    scale : array of float
        The scale of the absolute tolerance of each coordinate and rate.
    relative : bool
        Whether the tolerance is also relative to the state, which would be too coarse for
        absolute positions.
    source, law : str
        Names of the mechanism and the law in errors.
    """

    model: int
    block: FloatArray
    start: FloatArray
    scale: FloatArray
    relative: bool
    source: str
    law: str


def build(
    mechanism: Mechanism,
    method: str,
    beyond: str = "stop",
    allowed_penetration: float | None = None,
) -> System:
    """Return a mechanism prepared for the integrator.

    Parameters
    ----------
    mechanism : Mechanism
        The mechanism.
    method : {"minimal", "multiplier"}
        The equations of motion.
    beyond : {"stop", "tangent"}
        What to do at the end of the law.
    allowed_penetration : float, optional
        In m; see `simulate`.

    Raises
    ------
    InputError
        If the mechanism cannot be assembled, or minimal coordinates do not apply to it.
    """
    q, v = assemble(mechanism)
    if method == "minimal":
        numbers, start = _minimal_numbers(mechanism), np.zeros(minimal.STATES)
        model = dop853.MINIMAL
    else:
        numbers, start = (
            _augmented_numbers(mechanism),
            np.concatenate((q, v, np.zeros(len(LEDGERS)))),
        )
        model = dop853.AUGMENTED
    scale = np.repeat([_LENGTH_SCALE, _SPEED_SCALE], (start.size - len(LEDGERS)) // 2)
    block = _block(mechanism, numbers, beyond)
    block[contact.ALLOWED_PENETRATION] = allowed_penetration or 0.0
    law = str(mechanism.data["clearance"]["law"])
    return System(model, block, start, scale, method == "minimal", mechanism.source, law)


def _joint_kernel(mechanism: Mechanism) -> Kernel | None:
    """Return the compiled law of the clearance joint; None where the joint is ideal."""
    joint = mechanism.clearance
    return None if joint.pair is None else kernel(joint.law, joint.pair)


def _block(mechanism: Mechanism, numbers: FloatArray, beyond: str) -> FloatArray:
    """Return the parameter block of a mechanism."""
    joint = mechanism.clearance
    p = law_block(_joint_kernel(mechanism), numbers, beyond)
    p[contact.IMPACT_RATE] = p[contact.RATE_FLOOR] = joint.rate_floor
    p[contact.CHI], p[contact.FRICTION] = joint.chi, joint.friction
    p[contact.V0], p[contact.V1] = joint.v0, joint.v1
    # With an infinite clearance the journal never reaches the bearing, as in an ideal joint.
    p[contact.CLEARANCE] = np.inf if mechanism.ideal else joint.radial
    p[contact.R_BEARING] = joint.R_bearing
    p[contact.R_JOURNAL] = joint.R_bearing - joint.radial
    p[contact.LENGTH] = joint.length
    return p


def law_block(law: Kernel | None, numbers: FloatArray, beyond: str = "stop") -> FloatArray:
    """Return a parameter block with the numbers of the law and of the model, otherwise zero.

    The block consists of the header, the numbers of the law and those of the model.
    """
    law_numbers = np.empty(0) if law is None else law.parameters
    p = np.concatenate((np.zeros(contact.HEADER), law_numbers, numbers))
    p[contact.BRANCH] = p[contact.REGIME] = contact.ANY
    p[contact.KERNEL_START] = contact.HEADER
    p[contact.KERNEL_SIZE] = law_numbers.size
    p[contact.MODEL_START] = contact.HEADER + law_numbers.size
    p[contact.LAST_PENETRATION] = p[contact.STOP_PENETRATION] = np.inf
    if law is not None:
        p[contact.KERNEL] = law.kind
        if np.isfinite(law.max_penetration):
            _end_of_law(p, law, beyond)
    return p


def _end_of_law(p: FloatArray, law: Kernel, beyond: str) -> None:
    """Set the end of the law and the continuation of the load.

    The continuation is needed even if the run stops there, for trial steps of the integrator.
    """
    last = law.max_penetration * (TANGENT_FROM if beyond == "tangent" else 1.0)
    p[contact.LAST_PENETRATION] = last
    p[contact.LAST_LOAD] = kernel_load(law.kind, law.parameters, last)
    if beyond == "tangent":
        p[contact.LAST_SLOPE] = kernel_stiffness(law.kind, law.parameters, last)
    else:
        p[contact.STOP_PENETRATION] = last * 1e-3


def _minimal_numbers(mechanism: Mechanism) -> FloatArray:
    """Return the model's numbers for `minimal`."""
    shape = recognise(mechanism)
    crank, rod, slider = masses(mechanism, shape)
    a, b = shape.rod_centre
    turn = np.exp(-1j * shape.slide) * complex(*mechanism.gravity)
    m = np.zeros(minimal.MODEL_SIZE)
    m[minimal.CRANK], m[minimal.ROD], m[minimal.OFFSET] = (
        shape.crank_length, shape.rod_length, shape.offset,
    )  # fmt: skip
    m[minimal.ROD_A], m[minimal.ROD_B] = a, b
    m[minimal.ROD_INERTIA] = rod.inertia + rod.mass * (a * a + b * b)
    m[minimal.ROD_MASS], m[minimal.SLIDER_MASS] = rod.mass, slider.mass
    m[minimal.OMEGA], m[minimal.ANGLE], m[minimal.SIDE] = (
        shape.omega,
        shape.angle,
        shape.side,
    )
    m[minimal.GRAVITY_X], m[minimal.GRAVITY_Y] = turn.real, turn.imag
    m[minimal.CRANK_A], m[minimal.CRANK_B] = shape.crank_centre
    m[minimal.CRANK_MASS] = crank.mass
    m[minimal.PER_ROD], m[minimal.PER_SLIDER_MASS] = 1 / shape.rod_length, 1 / slider.mass
    m[minimal.PER_ROD_INERTIA] = 1 / m[minimal.ROD_INERTIA]
    return m


def _augmented_numbers(mechanism: Mechanism) -> FloatArray:
    """Return the model's numbers for `multiplier`: header, masses, table of joints."""
    joints, joint = mechanism.constraints, mechanism.clearance
    table = joint_table(joints)
    sizes = [constraints.CONSTRAINTS[kind] for kind in table[:, 0]]
    driver = next(k for k, j in enumerate(joints) if j.kind == "driver")
    m = np.zeros(augmented.MODEL_HEADER)
    m[augmented.BODIES], m[augmented.JOINTS] = len(mechanism.bodies), len(joints)
    m[augmented.ROWS], m[augmented.DRIVER_ROW] = sum(sizes), sum(sizes[:driver])
    m[augmented.DRIVER_I], m[augmented.DRIVER_J] = joints[driver].i, joints[driver].j
    m[augmented.BODY_I], m[augmented.BODY_J] = joint.i, joint.j
    m[augmented.I_X], m[augmented.I_Y] = joint.point_i
    m[augmented.J_X], m[augmented.J_Y] = joint.point_j
    m[augmented.ALPHA], m[augmented.BETA] = (
        mechanism.integration.alpha,
        mechanism.integration.beta,
    )
    m[augmented.GRAVITY_X], m[augmented.GRAVITY_Y] = mechanism.gravity
    mass = np.array([[body.mass, body.mass, body.inertia] for body in mechanism.bodies]).ravel()
    return augmented_block(m, mass, np.repeat(table[:, 1:3], sizes, axis=0), table)


def augmented_block(
    header: FloatArray, mass: FloatArray, bodies: FloatArray, table: FloatArray
) -> FloatArray:
    """Return the numbers of `augmented` in one array, from those of its parts.

    These are the header, masses and inertias, the two bodies of every constraint and the table of
    the joints.
    """
    return np.concatenate((header, mass, 1 / mass, bodies.ravel(), table.ravel()))
