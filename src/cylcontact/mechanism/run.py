"""Runs: a slider-crank integrated revolution by revolution.

The integrator restarts at the end of every revolution, so that a revolution depends only on
the state at its start.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cylcontact.joint.contact import DEEPEST_SHARE
from cylcontact.laws.kernels import TABLE
from cylcontact.mechanism import integrate
from cylcontact.mechanism.slider_crank import COORDINATES, RATES, SliderCrank
from cylcontact.support.arrays import BoolArray, FloatArray, require
from cylcontact.support.choices import BEYOND, Beyond, listed
from cylcontact.support.errors import InputError
from cylcontact.support.progress import Progress, silent

# Scales of the absolute tolerances: lengths of the size of the clearance in m, and speeds in m/s.
_SCALES = np.array([1e-4, 1e-4, 1.0, 1.0])
# Steps in a buffer.
_BUFFER = 4096
# Numbers in an array that is larger than all those of a revolution.
_LARGE = 1 << 20
# Most steps of one revolution, and how many more for each second of it. Joints of restitution .5 to
# .9 take 500 to 15,000; the most seen are 290,000, without any loss at a tolerance of 1e-12.
_MOST_STEPS, _MORE_PER_SECOND = 3_000_000, 1_000_000
# For estimates: the steps of a fast revolution, to which a slow one adds those of the longest step,
# and how many are computed in a second. An estimate is given from so many steps on.
_STEPS_PER_REVOLUTION, _STEPS_PER_SECOND, _MANY_STEPS = 2000, 4e5, 3e7


class RunError(InputError):
    """The integration failed."""


class LawDomainError(RunError):
    """The penetration has reached the end of the contact law's domain during a run."""


@dataclass(frozen=True)
class Settings:
    """Settings of a run; see `simulate`."""

    beyond: Beyond = "stop"

    def __post_init__(self) -> None:
        rule, remedy = "is not known", f"choose {listed(BEYOND)}"
        require(self.beyond in BEYOND, "simulate", "beyond", self.beyond, rule, remedy)


@dataclass(frozen=True)
class Steps:
    """The accepted steps of a run, in SI.

    `values` are E and Ė, and the ledgers: the driver's work, and `slider_crank.JOINT_LEDGERS`. An
    onset or release has two rows at the same time, one in each mode. `counts` has the steps, the
    evaluations and the seconds of computing of every revolution.
    """

    time: FloatArray
    values: FloatArray
    in_contact: BoolArray
    impact_rate: FloatArray
    revolution: NDArray[np.int32]
    counts: FloatArray

    def part(self, rows: slice, index: int) -> Steps:
        """Return some rows, with the counts of the revolution `index`."""
        parts = {name.name: getattr(self, name.name)[rows] for name in fields(self)}
        return Steps(**parts | {"counts": self.counts[index : index + 1]})


def concatenate(parts: list[Steps]) -> Steps:
    """Return the rows of all parts, in order."""
    names = [name.name for name in fields(Steps)]
    return Steps(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def start_of(values: FloatArray) -> Steps:
    """Return a state in flight at time 0 as a single row."""
    zero, none = np.zeros(1), np.empty((0, 3))
    return Steps(zero, values[None].copy(), zero > 0, zero.copy(), np.zeros(1, np.int32), none)


def estimate(mechanism: SliderCrank, revolutions: int) -> str:
    """Return a warning for a run of very many steps, otherwise an empty text."""
    longest = mechanism.spec.max_step
    steps = revolutions * (_STEPS_PER_REVOLUTION + mechanism.period / longest)
    if steps < _MANY_STEPS:
        return ""
    minutes = steps / _STEPS_PER_SECOND / 60
    duration = f"{minutes:.0f} minutes" if minutes < 120 else f"{minutes / 60:,.0f} hours"
    number = "a revolution" if revolutions == 1 else f"{revolutions:,} revolutions"
    return (
        f"{number} of {mechanism.period:.3g} s in steps of up to {longest:g} s: expect about "
        f"{steps:.1g} steps, which take some {duration}"
    )


def revolutions_of(
    mechanism: SliderCrank, settings: Settings, total: int, progress: Progress = silent
) -> Iterator[Steps]:
    """Yield the start of a run, and then the steps of each revolution."""
    require(total >= 1, "simulate", "revolutions", total, "must be at least 1", "give e.g. 10")
    run = Run(mechanism, settings)
    yield start_of(run.values)
    # Freed at once, so that glibc keeps what smaller arrays free: else every revolution asks the
    # system for its arrays anew, which takes a seventh of the time.
    np.empty(_LARGE)
    for index in range(total):
        progress("revolutions", index, total)
        yield run.advance((index + 1) * mechanism.period, index)
    progress("revolutions", total, total)


@dataclass
class Run:
    """A slider-crank prepared for the integrator, and its present state."""

    mechanism: SliderCrank
    settings: Settings
    now: Any = field(default_factory=lambda: np.zeros(1, integrate.NOW)[0])

    def __post_init__(self) -> None:
        joint = self.mechanism.joint
        self.joint = joint.record(self.settings.beyond)
        self.values = np.zeros(RATES)
        self.values[:COORDINATES] = self.mechanism.start
        work = np.zeros((integrate.STAGES + 1, RATES)), np.zeros(COORDINATES)
        law, crank = joint.kernel.parameters, self.mechanism.record
        self.model = integrate.Model(self.joint, law, crank, *work)

    def advance(self, end: float, label: int) -> Steps:
        """Integrate to `end`, and return the steps."""
        spec, now, start = self.mechanism.spec, self.now, float(self.now["time"])
        y, ledgers = self.values[:COORDINATES].copy(), self.values[COORDINATES:].copy()
        now["step"] = now["stuck"] = now["evaluations"] = 0
        tolerances = spec.tolerance, spec.tolerance * _SCALES, spec.max_step
        most = _MOST_STEPS + _MORE_PER_SECOND * (end - start)
        begun, parts, status = time.perf_counter(), list[Steps](), integrate.FULL
        while status == integrate.FULL and len(parts) * _BUFFER < most:
            buffers: tuple[Any, ...] = (
                np.empty(_BUFFER), np.empty((_BUFFER, RATES)), np.empty(_BUFFER, np.bool_),
                np.empty(_BUFFER),
            )  # fmt: skip
            n, status = integrate.integrate(
                now, y, ledgers, end, self.model, tolerances, np.zeros(COORDINATES), buffers
            )
            times, values, touching, rates = (buffer[:n] for buffer in buffers)
            labels, counts = np.full(n, label, np.int32), np.empty((0, 3))
            parts.append(Steps(times, values, touching, rates, labels, counts))
        self.values = np.concatenate((y, ledgers))
        self._require_end(status, label, len(parts) * _BUFFER)
        steps, seconds = concatenate(parts), time.perf_counter() - begun
        # The second row of an event, in the mode that begins there, is not a step.
        taken = np.count_nonzero(np.diff(steps.time, prepend=start) > 0)
        return replace(steps, counts=np.array([[taken, now["evaluations"], seconds]]))

    def _require_end(self, status: int, label: int, steps: int) -> None:
        """Raise an error unless the end of a revolution was reached."""
        joint, limit = self.joint, self.joint["stop_penetration"]
        depth = np.hypot(*self.values[:2]) - joint["clearance"]
        when, depth_um = f"t = {self.now['time']:.6g} s", f"{depth * 1e6:.4g} µm"
        source, tolerance = self.mechanism.source, self.mechanism.spec.tolerance
        if status == integrate.LAW_LEFT:
            of_table = ", the end of its table" if joint["kernel"] == TABLE else ""
            raise LawDomainError(
                source, "joint.law", self.mechanism.joint.data["law"],
                f"leaves its domain at {when}, where the penetration reaches {depth_um} "
                f"and the limit is {limit * 1e6:.4g} µm{of_table}",
                'choose another law, or continue along its tangent, beyond = "tangent" '
                "(--beyond tangent)",
            )  # fmt: skip
        if status == integrate.HOLE_LEFT:
            raise RunError(
                source, "joint", None,
                f"the pin leaves its hole at {when}: the penetration of {depth_um} is above "
                f"{DEEPEST_SHARE:g} of the hole's radius",
                "check units and moduli, lower masses or speed, or choose a stiffer law",
            )  # fmt: skip
        if status == integrate.FULL:
            rule = f"revolution {label} has not ended after {steps:,} steps, at {when}"
            remedy = "check masses and units, change the tolerance, or lower a restitution of 1"
            raise RunError(source, "tolerance", tolerance, rule, remedy)
        if status == integrate.COLLAPSED or not np.isfinite(self.values).all():
            rule = f"the step size became too small at {when}, where the penetration is {depth_um}"
            raise RunError(source, "tolerance", tolerance, rule, "loosen the tolerance")
