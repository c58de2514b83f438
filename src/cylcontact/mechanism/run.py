"""Runs: a mechanism prepared for the compiled integrator, advanced revolution by revolution.

The integrator restarts at the end of every revolution of the driver. A revolution then depends only
on the state at its start, and a resumed run equals an uninterrupted one to the bit.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cylcontact.joint import contact
from cylcontact.joint.clearance import require_defined
from cylcontact.laws.kernels import TABLE
from cylcontact.mechanism import integrate
from cylcontact.mechanism.dop853 import STAGES, Model
from cylcontact.mechanism.linkage import assemble, linkage_of
from cylcontact.mechanism.model import Mechanism
from cylcontact.mechanism.slider_crank import recognise
from cylcontact.support.arrays import BoolArray, FloatArray, require
from cylcontact.support.choices import BEYOND, METHODS, Beyond, Method
from cylcontact.support.errors import InputError
from cylcontact.support.progress import Progress

# The last states of a run, ledgers: energies in J of drivers and dampers, and of each joint
# energies in J and the integrals over the time in contact of the penetration in m s and of the
# normal force in N s.
LEDGERS = ("drive_work", "damping")
JOINT_LEDGERS = ("normal_dissipation", "friction_dissipation", "penetration_integral", "impulse")

# Scales of the absolute tolerances in m and m/s: lengths of the size of the clearance, speeds of
# some metres per second.
_LENGTH_SCALE, _SPEED_SCALE = 1e-4, 1.0
# Relative tolerance where only the absolute one shall apply: to absolute positions and angles, and
# to a rod that is free at both ends, whose energy a relative one would keep three times worse.
_NOT_RELATIVE = 1e-15
# Steps between two checks for Ctrl-C.
_BUFFER = 4096
# Numbers in an array that is larger than all those of a revolution.
_KEPT = 1 << 20
# Most steps of one revolution, and how many more for each second of it. Joints of restitution .5 to
# .9 take 500 to 15,000, at tolerances down to 1e-14; the most seen are 290,000, without any loss at
# 1e-12. In contact a step takes about 8 µs however slow the driver is.
_MOST_STEPS, _MORE_PER_SECOND = 3_000_000, 1_000_000


class RunError(InputError):
    """A run cannot go on.

    `simulate` leaves the Trajectory of the complete revolutions in `trajectory`; None without one.
    """

    trajectory: Any = None


class LawDomainError(RunError):
    """The penetration has reached the end of the contact law's domain during a run."""


@dataclass(frozen=True)
class Settings:
    """Settings of a run: method, tolerance (dimensionless), longest step in s, and so on."""

    method: Method
    tolerance: float
    max_step: float
    beyond: Beyond
    allowed_penetration: float | None = None


@dataclass(frozen=True)
class State:
    """Everything that the rest of a run depends on, in SI; contact and δ̇⁽⁻⁾ by joint."""

    time: float
    values: FloatArray
    in_contact: BoolArray
    impact_rate: FloatArray


@dataclass(frozen=True)
class StepHistory:
    """The n accepted steps: states with ledgers by time in s, and by joint contact and δ̇⁽⁻⁾ in m/s.

    Of every revolution `counts` has the accepted steps, the evaluations and the seconds.
    """

    time: FloatArray
    values: FloatArray
    in_contact: BoolArray
    impact_rate: FloatArray
    revolution: NDArray[np.int32]
    counts: FloatArray

    @classmethod
    def of(cls, state: State) -> StepHistory:
        """Return a state as a single row."""
        parts = {name: np.array(part)[None] for name, part in vars(state).items()}
        return cls(**parts, revolution=np.zeros(1, np.int32), counts=np.empty((0, 3)))

    @property
    def end(self) -> State:
        """The last state."""
        last = (self.values[-1], self.in_contact[-1], self.impact_rate[-1])
        return State(float(self.time[-1]), *last)

    @property
    def ledgers(self) -> FloatArray:
        """The `LEDGERS`, and then the `JOINT_LEDGERS` of each joint, since the start."""
        count = len(LEDGERS) + len(JOINT_LEDGERS) * self.impact_rate.shape[1]
        return self.values[:, -count:]

    def taken(self, rows: slice, index: int) -> StepHistory:
        """Return some rows, with the counts of the revolution `index`."""
        parts = {field.name: getattr(self, field.name)[rows] for field in fields(self)}
        return StepHistory(**parts | {"counts": self.counts[index : index + 1]})


def concatenate(parts: list[StepHistory]) -> StepHistory:
    """Return the rows of all parts, in order."""
    names = [field.name for field in fields(StepHistory)]
    return StepHistory(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def settings_for(
    mechanism: Mechanism,
    method: Method | None = None,
    tolerance: float | None = None,
    beyond: Beyond = "stop",
    allowed_penetration: float | None = None,
) -> Settings:
    """Return the settings of a run, checked and with defaults filled in; see `simulate`."""
    fits = recognise(mechanism) is not None
    method = method or ("minimal" if fits else "multiplier")
    for key, value, known in (("method", method, METHODS), ("beyond", beyond, BEYOND)):
        remedy = f"choose {', '.join(known)}"
        require(value in known, "simulate", key, value, "is not known", remedy)
    require(
        fits or method != "minimal", mechanism.source, "method", method,
        "is for a slider-crank at constant speed with a clearance between rod and slider, and none "
        "or one between crank and rod",
        'use "multiplier", which takes any mechanism',
    )  # fmt: skip
    tolerance = mechanism.integration.tolerance if tolerance is None else tolerance
    rule, good = "must lie in [1e-14, 1e-3]", 1e-14 <= tolerance <= 1e-3
    require(good, "simulate", "tolerance", tolerance, rule, "give e.g. 1e-8")
    depth, remedy = allowed_penetration, "give it in m, or leave it out"
    good = depth is None or 0 < depth < np.inf
    require(good, "simulate", "allowed_penetration", depth, "must be positive", remedy)
    return Settings(method, tolerance, mechanism.integration.max_step, beyond, depth)


@dataclass
class Run:
    """A mechanism prepared for the integrator, and its present state.

    `scale` is that of the absolute tolerance of each coordinate and rate, beside which there is a
    `relative` one.
    """

    mechanism: Mechanism
    settings: Settings
    model: Model
    scale: FloatArray
    relative: float
    state: State

    @classmethod
    def start(cls, mechanism: Mechanism, settings: Settings, state: State | None = None) -> Run:
        """Return a run at its start, or at the state where an earlier one ended."""
        q, v = assemble(mechanism)
        shape = recognise(mechanism) if settings.method == "minimal" else None
        coordinates = np.concatenate((q, v)) if shape is None else np.zeros(shape.size)
        joints = np.zeros(len(mechanism.clearances), contact.JOINT)
        laws = [np.empty(0)]
        for k, joint in enumerate(mechanism.clearances):
            require_defined(joint.contact, mechanism.source, f"joint.{joint.name}.law")
            joints[k] = joint.contact.record(settings.beyond)
            record = joints[k]
            record["allowed_penetration"] = settings.allowed_penetration or 0.0
            record["i"], record["j"] = joint.i, joint.j
            record["x_i"], record["y_i"] = joint.point_i
            record["x_j"], record["y_j"] = joint.point_j
            record["first"] = sum(part.size for part in laws)
            laws.append(joint.contact.kernel.parameters)
        if state is None:
            ledgers = np.zeros(len(LEDGERS) + len(JOINT_LEDGERS) * joints.size)
            free = np.zeros(joints.size)
            state = State(0.0, np.concatenate((coordinates, ledgers)), free.astype(bool), free)
        if shape is None:
            form: tuple[Any, Any, Any] = (None, None, linkage_of(mechanism))
        else:
            form = shape.record, shape.pin, None
        room = np.zeros((STAGES + 1, state.values.size)), np.zeros(coordinates.size)
        model = Model(joints, np.concatenate(laws), *form, *room)
        relative = shape is not None and shape.pin is None
        return cls(
            mechanism,
            settings,
            model,
            np.repeat([_LENGTH_SCALE, _SPEED_SCALE], coordinates.size // 2),
            settings.tolerance if relative else _NOT_RELATIVE,
            state,
        )

    def advance(self, end: float, label: int = 0) -> tuple[StepHistory, int]:
        """Integrate to `end`; return the steps, as rows of a revolution, and the evaluations."""
        state, split, joints = self.state, self.scale.size, self.model.joints
        y, ledgers = state.values[:split].copy(), state.values[split:].copy()
        joints["touching"], joints["onset_rate"] = state.in_contact, state.impact_rate
        now = np.zeros(1, integrate.NOW)
        now["time"] = state.time
        absolute = self.settings.tolerance * self.scale
        tolerances = self.relative, absolute, self.settings.max_step
        most = _MOST_STEPS + _MORE_PER_SECOND * (end - state.time)
        parts: list[StepHistory] = []
        status = integrate.FULL
        while status == integrate.FULL and len(parts) * _BUFFER < most:
            buffers: tuple[Any, ...] = (
                np.empty(_BUFFER), np.empty((_BUFFER, state.values.size)),
                np.empty((_BUFFER, joints.size), np.bool_), np.empty((_BUFFER, joints.size)),
            )  # fmt: skip
            space = integrate.Space.of(split, joints.size)
            about = self.model, tolerances, space, buffers
            n, status = integrate.integrate(now[0], y, ledgers, end, *about)
            time_s, values, touching, rates = (buffer[:n] for buffer in buffers)
            labels, counts = np.full(n, label, dtype=np.int32), np.empty((0, 3))
            parts.append(StepHistory(time_s, values, touching, rates, labels, counts))
        values = np.concatenate((y, ledgers))
        reached, in_contact = float(now["time"][0]), joints["touching"].astype(bool)
        self.state = State(reached, values, in_contact, joints["onset_rate"].copy())
        if status == integrate.LAW_LEFT:
            raise self._law_left(int(now["joint"][0]))
        if status == integrate.FULL:
            what = f"revolution {label} has not ended after {len(parts) * _BUFFER:,} steps, at"
            remedy = (
                "check masses, inertias and units, change the tolerance, or lower a restitution"
            )
            raise self._error(what, f"{remedy} of 1")
        if status == integrate.COLLAPSED or not np.isfinite(values).all():
            remedy = "loosen the tolerance, or look for a dead centre of the mechanism there"
            raise self._error("the steps collapse at", remedy)
        return concatenate(parts), int(now["evaluations"][0])

    def revolutions(self, total: int, progress: Progress, first: int = 0) -> Iterator[StepHistory]:
        """Yield the steps of each revolution of the driver from `first` on."""
        require(total >= 1, "simulate", "revolutions", total, "must be at least 1", "give e.g. 10")
        # Freed at once, so that glibc keeps what smaller arrays free: else every revolution asks
        # the system for its arrays anew, which takes a seventh of the time.
        np.empty(_KEPT)
        for index in range(first, total):
            progress("revolutions", index, total)
            start, begun = self.state.time, time.perf_counter()
            rows, evaluations = self.advance((index + 1) * self.mechanism.period, index)
            seconds = time.perf_counter() - begun
            # The second row of an event, in the mode that begins there, is not a step.
            steps = np.count_nonzero(np.diff(rows.time, prepend=start) > 0)
            yield replace(rows, counts=np.array([[steps, evaluations, seconds]]))
        progress("revolutions", total, total)

    def penetration(self, number: int) -> float:
        """Return δ of a joint at the present state in m."""
        values, joint = self.state.values[: self.scale.size], self.model.joints[number]
        return integrate.penetration(self.state.time, values, joint, self.model)

    def _law_left(self, number: int) -> LawDomainError:
        joint, record = self.mechanism.clearances[number], self.model.joints[number]
        # A tabulated law may be defined beyond its table.
        of_table = ", the end of its table" if record["kernel"] == TABLE else ""
        return LawDomainError(
            self.mechanism.source,
            f"joint.{joint.name}.law",
            joint.contact.data.get("law", joint.contact.law.name),
            f"leaves its domain at t = {self.state.time:.6g} s, where the penetration reaches "
            f"{self.penetration(number) * 1e6:.4g} µm and the limit is "
            f"{record['stop_penetration'] * 1e6:.4g} µm{of_table}",
            'choose another law, or let it go on along its tangent, beyond = "tangent" '
            "(--beyond tangent)",
        )

    def _error(self, what: str, remedy: str) -> RunError:
        depths = [
            f"the penetration in {joint.name} is {self.penetration(k) * 1e6:.4g} µm"
            for k, joint in enumerate(self.mechanism.clearances)
        ]
        where = f", where {' and '.join(depths)}" if depths else ""
        return RunError(
            self.mechanism.source, "integration.tolerance", self.settings.tolerance,
            f"{what} t = {self.state.time:.6g} s{where}", remedy,
        )  # fmt: skip
