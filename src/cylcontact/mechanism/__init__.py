"""Planar mechanisms with clearance joints: those of Section 4 of the paper, and your own."""

from cylcontact.joint.clearance import (
    ClearanceJoint,
    JointState,
    JointWrench,
    joint_from,
    read_joint,
)
from cylcontact.joint.spatial import SpatialJoint, SpatialState, SpatialWrench
from cylcontact.mechanism.impact import Impact, isolated_impact
from cylcontact.mechanism.joint_motion import JointMotion
from cylcontact.mechanism.model import Mechanism, mechanism_from, read_mechanism
from cylcontact.mechanism.run import LawDomainError, RunError, Settings
from cylcontact.mechanism.statistics import Statistics
from cylcontact.mechanism.study import (
    Case,
    Plan,
    bifurcation,
    cases,
    horizon,
    long_run,
    sweep,
    tolerances,
)
from cylcontact.mechanism.trajectory import Interrupted, Trajectory, simulate

__all__ = [
    "Case",
    "ClearanceJoint",
    "Impact",
    "Interrupted",
    "JointMotion",
    "JointState",
    "JointWrench",
    "LawDomainError",
    "Mechanism",
    "Plan",
    "RunError",
    "Settings",
    "SpatialJoint",
    "SpatialState",
    "SpatialWrench",
    "Statistics",
    "Trajectory",
    "bifurcation",
    "cases",
    "horizon",
    "isolated_impact",
    "joint_from",
    "long_run",
    "mechanism_from",
    "read_joint",
    "read_mechanism",
    "simulate",
    "sweep",
    "tolerances",
]


def __dir__() -> list[str]:
    return __all__
