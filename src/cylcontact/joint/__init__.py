"""The force element: a journal in a bearing with clearance, in the plane and in space."""

from cylcontact.joint.clearance import (
    ClearanceJoint,
    JointState,
    JointWrench,
    joint_from,
    read_joint,
)
from cylcontact.joint.spatial import SpatialJoint, SpatialState, SpatialWrench

__all__ = [
    "ClearanceJoint",
    "JointState",
    "JointWrench",
    "SpatialJoint",
    "SpatialState",
    "SpatialWrench",
    "joint_from",
    "read_joint",
]


def __dir__() -> list[str]:
    return __all__
