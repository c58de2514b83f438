"""Clearance joints, planar and spatial, and the slider-crank of the paper (its Section 4)."""

from cylcontact.joint import (
    ClearanceJoint,
    ClearanceJoints,
    JointJacobian,
    JointState,
    JointWrench,
    SpatialJoint,
    SpatialState,
    SpatialWrench,
    joint_from,
    read_joint,
)
from cylcontact.mechanism.motion import Motion
from cylcontact.mechanism.run import LawDomainError, RunError, Settings
from cylcontact.mechanism.slider_crank import SliderCrank, mechanism_from, read_mechanism
from cylcontact.mechanism.statistics import Statistics
from cylcontact.mechanism.study import Case, Interrupted, cases, horizon, long_run, sweep
from cylcontact.mechanism.trajectory import Trajectory, simulate

__all__ = [
    "Case",
    "ClearanceJoint",
    "ClearanceJoints",
    "Interrupted",
    "JointJacobian",
    "JointState",
    "JointWrench",
    "LawDomainError",
    "Motion",
    "RunError",
    "Settings",
    "SliderCrank",
    "SpatialJoint",
    "SpatialState",
    "SpatialWrench",
    "Statistics",
    "Trajectory",
    "cases",
    "horizon",
    "joint_from",
    "long_run",
    "mechanism_from",
    "read_joint",
    "read_mechanism",
    "simulate",
    "sweep",
]


def __dir__() -> list[str]:
    return __all__
