"""Joints: the check of one under a load, and the force element in the plane and in space."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cylcontact.joint.bush import Bush, BushCheck, check_bush, fitted
    from cylcontact.joint.check import JointCheck, Numbers, check_joint
    from cylcontact.joint.clearance import (
        ClearanceJoint,
        JointJacobian,
        JointState,
        JointWrench,
        joint_from,
        read_joint,
    )
    from cylcontact.joint.clevis import ClevisCheck, check_clevis
    from cylcontact.joint.clevis_beam import Clevis, Plate
    from cylcontact.joint.loaded import LoadedJoint
    from cylcontact.joint.many import ClearanceJoints
    from cylcontact.joint.spatial import SpatialJoint, SpatialState, SpatialWrench
    from cylcontact.joint.tables import TableCheck, check_table

__all__ = [
    "Bush",
    "BushCheck",
    "ClearanceJoint",
    "ClearanceJoints",
    "Clevis",
    "ClevisCheck",
    "JointCheck",
    "JointJacobian",
    "JointState",
    "JointWrench",
    "LoadedJoint",
    "Numbers",
    "Plate",
    "SpatialJoint",
    "SpatialState",
    "SpatialWrench",
    "TableCheck",
    "check_bush",
    "check_clevis",
    "check_joint",
    "check_table",
    "fitted",
    "joint_from",
    "read_joint",
]
# Loaded on first use: a check of a joint needs no compiler.
_NAMES = {
    "bush": ("Bush", "BushCheck", "check_bush", "fitted"),
    "check": ("JointCheck", "Numbers", "check_joint"),
    "clearance": (
        *("ClearanceJoint", "JointJacobian", "JointState", "JointWrench"),
        *("joint_from", "read_joint"),
    ),
    "clevis": ("ClevisCheck", "check_clevis"),
    "clevis_beam": ("Clevis", "Plate"),
    "loaded": ("LoadedJoint",),
    "tables": ("TableCheck", "check_table"),
    "many": ("ClearanceJoints",),
    "spatial": ("SpatialJoint", "SpatialState", "SpatialWrench"),
}
_MODULES = {name: module for module, names in _NAMES.items() for name in names}


def __getattr__(name: str) -> object:
    if name in _MODULES:
        return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
