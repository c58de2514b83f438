"""The slider-crank of Section 4 of the paper, with a clearance joint between rod and slider."""

from typing import Any

from cylcontact.joint import (
    ClearanceJoint,
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
from cylcontact.support.errors import refuse_gone_name

__all__ = [
    "Case",
    "ClearanceJoint",
    "Interrupted",
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
# Names of 1.0.0rc1 that are gone, with what to use instead. Kept for one release.
_GONE = {
    "Impact": "integrate one mass against the law with scipy.integrate.solve_ivp",
    "JointMotion": "Trajectory has its arrays",
    "Mechanism": "use SliderCrank",
    "Plan": "give its values to sweep as arguments",
    "bifurcation": "use sweep over clearances, and Statistics.period",
    "isolated_impact": "integrate one mass against the law with scipy.integrate.solve_ivp",
    "tolerances": "use sweep with mechanisms of several tolerances",
}


def __getattr__(name: str) -> Any:
    refuse_gone_name(__name__, name, _GONE)
    raise AttributeError(f"module 'cylcontact.mechanism' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
