"""Planar mechanisms with a clearance joint: those of Section 4 of the paper, and your own."""

from cylcontact.mechanism.clearance_joint import (
    ClearanceJoint,
    JointState,
    JointWrench,
    joint_from,
    read_joint,
)
from cylcontact.mechanism.impact import Impact, isolated_impact
from cylcontact.mechanism.long_run import long_run
from cylcontact.mechanism.loop import LawDomainError, RunError
from cylcontact.mechanism.model import Mechanism, mechanism_from, read_mechanism
from cylcontact.mechanism.simulate import Interrupted, simulate
from cylcontact.mechanism.statistics import Statistics
from cylcontact.mechanism.step_history import Settings
from cylcontact.mechanism.studies import horizon
from cylcontact.mechanism.sweep import Case, Plan, cases, sweep
from cylcontact.mechanism.trajectory import Trajectory

__all__ = [
    "Case",
    "ClearanceJoint",
    "Impact",
    "Interrupted",
    "JointState",
    "JointWrench",
    "LawDomainError",
    "Mechanism",
    "Plan",
    "RunError",
    "Settings",
    "Statistics",
    "Trajectory",
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
]


def __dir__() -> list[str]:
    return __all__
