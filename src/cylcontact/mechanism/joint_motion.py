"""The motion of bodies over a run, and of a pin in its bearing, row by row and in numbers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cylcontact.joint import contact
from cylcontact.joint.clearance import ClearanceJoint
from cylcontact.joint.contact import BEYOND_LAW, YIELDS
from cylcontact.mechanism.model import Joint, Mechanism
from cylcontact.mechanism.run import JOINT_LEDGERS, LEDGERS, Settings, StepHistory
from cylcontact.mechanism.slider_crank import SliderCrank, recognise
from cylcontact.support.arrays import BoolArray, FloatArray, IndexArray, as_floats
from cylcontact.support.numba_cache import called, compiled

if TYPE_CHECKING:
    import pandas as pd

# Parts of a step in which the force is looked at.
PARTS = 4
FORCE_PERCENTILES = (50, 95, 99)
# The Poincaré section at the end of every revolution.
SECTION = ("e_x_um", "e_y_um", "e_x_rate_m_per_s", "e_y_rate_m_per_s", "in_contact")


class Limits(NamedTuple):
    """Thresholds that a contact may pass.

    Penetrations in m at first yield (NaN where no yield stress is known) and from which the law is
    continued along its tangent (inf without an end); the slowest impact in m/s that dissipates as
    its factor says.
    """

    first_yield: float
    law: float
    floor: float


@dataclass(frozen=True, eq=False, repr=False)
class Motion:
    """The motion of all bodies in the rows of a run."""

    mechanism: Mechanism
    settings: Settings
    rows: StepHistory

    @property
    def time(self) -> FloatArray:
        """Times in s, shape (n,)."""
        return self.rows.time

    @property
    def revolution(self) -> FloatArray:
        """Time in revolutions of the driver, shape (n,)."""
        return self.rows.time / self.mechanism.period

    @property
    def slider_crank(self) -> SliderCrank | None:
        """The dimensions of a slider-crank if the states are its minimal coordinates."""
        return recognise(self.mechanism) if self.settings.method == "minimal" else None

    @cached_property
    def _motion(self) -> tuple[FloatArray, FloatArray]:
        values, size = self.rows.values, 3 * len(self.mechanism.bodies)
        if self.slider_crank is not None:
            return self.slider_crank.motion(self.time, values)
        return values[:, :size], values[:, size : 2 * size]

    @property
    def coordinates(self) -> FloatArray:
        """x, y in m and θ in rad of every body's centre of mass, shape (n, bodies, 3)."""
        return self._motion[0].reshape(self.time.size, -1, 3)

    @property
    def velocities(self) -> FloatArray:
        """The rates of `coordinates`, shape (n, bodies, 3)."""
        return self._motion[1].reshape(self.time.size, -1, 3)

    def point(self, body: int, local: tuple[float, float]) -> tuple[FloatArray, FloatArray]:
        """Return position in m and velocity in m/s of a point of a body, shapes (n, 2).

        Parameters
        ----------
        body : int
            Its index; −1 is the ground.
        local : pair of float
            The point in m, relative to the centre of mass in the axes of the body.
        """
        if body < 0:
            return np.tile(local, (self.time.size, 1)), np.zeros((self.time.size, 2))
        q, v = self.coordinates[:, body], self.velocities[:, body]
        arm = np.exp(1j * q[:, 2]) * complex(*local)
        rate = 1j * v[:, 2] * arm
        return (
            q[:, :2] + np.column_stack((arm.real, arm.imag)),
            v[:, :2] + np.column_stack((rate.real, rate.imag)),
        )


def _ledger(name: str, about: str) -> Any:
    return property(lambda joint: joint.ledger(name), doc=about)


def _of_forces(columns: int | slice, about: str) -> Any:
    return property(lambda joint: joint._forces[:, columns], doc=about)


@dataclass(frozen=True, eq=False)
class JointMotion:
    """A joint with clearance over a run: arrays of one element or row for each accepted step.

    Attributes
    ----------
    run : Motion
    number : int
        Which of the mechanism's joints with clearance it is.
    joint : Joint
    """

    run: Motion
    number: int
    joint: Joint

    @property
    def contact(self) -> ClearanceJoint:
        """Pair, law, dissipation and friction of the joint."""
        return self.joint.contact

    @cached_property
    def _record(self) -> Any:
        return self.contact.record(self.run.settings.beyond)

    @property
    def _compiled(self) -> tuple[Any, FloatArray]:
        """The joint as compiled functions take it, and the numbers of its law."""
        return self._record, self.contact.kernel.parameters

    @property
    def in_contact(self) -> BoolArray:
        """Whether the row belongs to the contact mode, shape (n,)."""
        return np.ascontiguousarray(self.run.rows.in_contact[:, self.number])

    @property
    def impact_rate(self) -> FloatArray:
        """δ̇⁽⁻⁾ of the current contact in m/s, 0 out of contact, shape (n,)."""
        return np.ascontiguousarray(self.run.rows.impact_rate[:, self.number])

    def ledger(self, name: str) -> FloatArray:
        """Return one of `run.JOINT_LEDGERS` since the start, shape (n,)."""
        before = len(LEDGERS) + len(JOINT_LEDGERS) * self.number
        return self.run.rows.ledgers[:, before + JOINT_LEDGERS.index(name)]

    normal_dissipation = _ledger(
        "normal_dissipation", "Energy dissipated by the normal force since the start in J, (n,)."
    )
    friction_dissipation = _ledger(
        "friction_dissipation", "Energy dissipated by friction since the start in J, shape (n,)."
    )

    @cached_property
    def _eccentricity(self) -> tuple[FloatArray, FloatArray]:
        """e and its rate in global axes; minimal coordinates give them without cancellation."""
        shape = self.run.slider_crank
        if shape is not None:
            return shape.eccentricity(self.run.rows.values, self.number)
        i, i_rate = self.run.point(self.joint.i, self.joint.point_i)
        j, j_rate = self.run.point(self.joint.j, self.joint.point_j)
        return i - j, i_rate - j_rate

    @property
    def eccentricity(self) -> FloatArray:
        """e = r_i − r_j in m, from the pin's centre to the bearing's, shape (n, 2)."""
        return self._eccentricity[0]

    @property
    def eccentricity_rate(self) -> FloatArray:
        """The rate of `eccentricity` in m/s, shape (n, 2)."""
        return self._eccentricity[1]

    @cached_property
    def penetration(self) -> FloatArray:
        """δ = |e| − c in m, negative out of contact, shape (n,)."""
        return as_floats(np.hypot(*self.eccentricity.T) - self._record["clearance"])

    @cached_property
    def penetration_rate(self) -> FloatArray:
        """δ̇ in m/s, shape (n,)."""
        distance = np.hypot(*self.eccentricity.T)
        along = (self.eccentricity * self.eccentricity_rate).sum(axis=1)
        return as_floats(along / np.where(distance > 0, distance, 1.0))

    @cached_property
    def _forces(self) -> FloatArray:
        spins = np.zeros((self.run.time.size, 2))
        for column, body in enumerate((self.joint.i, self.joint.j)):
            if body >= 0:
                spins[:, column] = self.run.velocities[:, body, 2]
        motion, out = (*self._eccentricity, spins), np.zeros((self.run.time.size, 5))
        _joint_forces(*motion, self.in_contact, self.impact_rate, *self._compiled, out)
        return out

    @cached_property
    def force_within(self) -> FloatArray:
        """f_n in N in the middle of equal parts of every step, shape (n − 1, PARTS).

        Steps are long against the peaks of the force. The eccentricity is interpolated by Hermite's
        cubic; out of contact the force is 0.
        """
        motion = self.run.time, *self._eccentricity, self.in_contact, self.impact_rate
        out = np.zeros((self.run.time.size - 1, PARTS))
        _force_within(*motion, *self._compiled, out)
        return out

    force = _of_forces(slice(2), "The contact force on the bearing in N, Eq 13a, shape (n, 2).")
    normal_force = _of_forces(2, "f_n in N, shape (n,).")
    friction_force = _of_forces(3, "f_t in N along t = [n_y, −n_x], on the bearing, shape (n,).")
    tangential_velocity = _of_forces(4, "v_t = (v_i − v_j)·t in m/s at the contact, shape (n,).")

    @cached_property
    def elastic_energy(self) -> FloatArray:
        """Energy stored in the contact in J, shape (n,)."""
        depth = np.where(self.in_contact, self.penetration, 0.0)
        energy = np.zeros_like(depth)
        _elastic_energy(depth, *self._compiled, energy)
        return energy

    @cached_property
    def max_elastic_load(self) -> float:
        """The law's load per unit length at the deepest penetration in N/mm, without damping."""
        deepest = float(self.penetration[self.in_contact].max(initial=0.0))
        return self.elastic_force(deepest) / float(self._record["length"])

    def elastic_force(self, penetration: float) -> float:
        """Return the elastic force in N at a penetration in m, as the run continues the law."""
        return float(_elastic_force(penetration, *self._compiled))

    @property
    def flag(self) -> NDArray[np.int64]:
        """1 above first yield, plus 2 where the law's tangent has taken over, shape (n,)."""
        depth = np.where(self.in_contact, self.penetration, -np.inf)
        yields, beyond = depth > self.limits.first_yield, depth > self.limits.law
        return np.asarray(YIELDS * yields + BEYOND_LAW * beyond, np.int64)

    @cached_property
    def limits(self) -> Limits:
        """What contacts are held against: first yield, the law's tangent, the slowest impact."""
        from scipy.optimize import brentq

        tangent = self.run.settings.beyond == "tangent"
        load, deepest = self.contact.first_yield, float(self._record["R_bearing"])
        first_yield = np.inf if self.contact.can_yield else np.nan
        if self.elastic_force(deepest) > load:
            excess = lambda depth: self.elastic_force(depth) - load  # noqa: E731
            first_yield = float(brentq(excess, 0.0, deepest, xtol=1e-15))
        law = float(self._record["last_penetration"]) * 1e-3 if tangent else np.inf
        return Limits(first_yield, law, float(self._record["rate_floor"]))

    @cached_property
    def contacts(self) -> pd.DataFrame:
        """One row for each contact.

        Columns: `onset_s`, `release_s` (NaN while under way), `impact_rate_m_per_s` (δ̇⁽⁻⁾),
        `max_penetration_m` and `max_force_N`.
        """
        import pandas as pd

        begins, ends = changes(self.in_contact)
        time = self.run.time
        last = np.append(ends, time.size - 1)[: begins.size]
        spans = [slice(a, b + 1) for a, b in zip(begins, last, strict=True)]
        release = np.full(begins.size, np.nan)
        release[: ends.size] = time[ends]
        return pd.DataFrame(
            {
                "onset_s": time[begins],
                "release_s": release,
                "impact_rate_m_per_s": self.impact_rate[begins],
                "max_penetration_m": [self.penetration[span].max() for span in spans],
                "max_force_N": [self._peak(span) for span in spans],
            }
        )

    def _peak(self, span: slice) -> float:
        """Return the largest f_n in N in some rows and within the steps between them."""
        within = self.force_within[span.start : span.stop - 1]
        return float(max(self.normal_force[span].max(), within.max(initial=0.0)))


def changes(in_contact: BoolArray) -> tuple[IndexArray, IndexArray]:
    """Return the rows at which contacts begin and those at which they end."""
    step = np.diff(in_contact.astype(np.int8))
    return np.flatnonzero(step == 1) + 1, np.flatnonzero(step == -1)


def numbers_of(joint: JointMotion) -> dict[str, float]:
    """Return what the row of a revolution in `Statistics` has of the joint."""
    touching, dt = joint.in_contact, np.diff(joint.run.time)
    # A step has the mode of its last row; the second row of an onset has dt = 0.
    inside, moving = touching[1:], dt > 0
    contact_time, flight_time = float(dt[inside].sum()), float(dt[~inside].sum())
    contact_steps = int(np.count_nonzero(inside & moving))
    flight_steps = int(joint.run.rows.counts[0, 0]) - contact_steps
    force, within = joint.normal_force, joint.force_within
    spent = {name: float(np.diff(joint.ledger(name)[[0, -1]])[0]) for name in JOINT_LEDGERS}
    percentiles = _percentiles(dt[inside], within[inside])
    end = (*joint.eccentricity[-1] * 1e6, *joint.eccentricity_rate[-1], bool(touching[-1]))
    return {
        "contact_fraction": contact_time / (contact_time + flight_time),
        "impacts": changes(touching)[0].size,
        "mean_penetration_um": _ratio(spent["penetration_integral"], contact_time) * 1e6,
        "max_penetration_um": float(joint.penetration[touching].max(initial=0.0)) * 1e6,
        "mean_force_N": _ratio(spent["impulse"], contact_time),
        **{f"force_p{p}_N": x for p, x in zip(FORCE_PERCENTILES, percentiles, strict=True)},
        "max_force_N": float(max(force.max(initial=0.0), within.max(initial=0.0))),
        "normal_dissipation_J": spent["normal_dissipation"],
        "friction_dissipation_J": spent["friction_dissipation"],
        "mean_step_contact_us": _ratio(contact_time, contact_steps) * 1e6,
        "mean_step_flight_us": _ratio(flight_time, flight_steps) * 1e6,
        "contact_time_s": contact_time,
        "flight_time_s": flight_time,
        "penetration_integral_um_s": spent["penetration_integral"] * 1e6,
        "impulse_N_s": spent["impulse"],
        "contact_steps": contact_steps,
        "impact_rate_m_per_s": float(joint.impact_rate[-1]),
        **_passed(joint),
        "max_load_N_per_mm": joint.max_elastic_load,
        **dict(zip(SECTION, end, strict=True)),
    }


def _passed(joint: JointMotion) -> dict[str, float]:
    """Return the contacts of a revolution, and how many pass each limit and when first."""
    touching, time, limits = joint.in_contact, joint.run.time, joint.limits

    def first(rows: IndexArray) -> float:
        return float(time[rows[0]]) if rows.size else float("nan")

    begins, _ = changes(touching)
    slow = begins[joint.impact_rate[begins] < limits.floor]
    if touching[0]:  # counted again, so that no revolution depends on another
        begins = np.append(0, begins)
    depth = np.where(touching, joint.penetration, -np.inf)
    deepest = np.maximum.reduceat(depth, begins) if begins.size else np.empty(0)
    numbers = {"contacts": begins.size, "grazing": slow.size, "grazing_s": first(slow)}
    for name, limit in (("above_yield", limits.first_yield), ("beyond_law", limits.law)):
        numbers[name] = float(np.count_nonzero(deepest > limit))
        numbers[f"{name}_s"] = first(np.flatnonzero(depth > limit))
    if np.isnan(limits.first_yield):
        numbers["above_yield"] = float("nan")
    return numbers


def _ratio(numerator: float, denominator: float) -> float:
    return numerator / denominator if denominator > 0 else float("nan")


def _percentiles(dt: FloatArray, values: FloatArray) -> list[float]:
    """Return percentiles over the time of steps, with `values` in equal parts; NaN without any."""
    if not dt.sum() > 0:
        return [float("nan")] * len(FORCE_PERCENTILES)
    weight, sample = np.repeat(dt, values.shape[1]), values.ravel()
    order = np.argsort(sample, kind="stable")
    share = (np.cumsum(weight[order]) - 0.5 * weight[order]) / weight.sum()
    return [float(np.interp(percent / 100, share, sample[order])) for percent in FORCE_PERCENTILES]


_elastic_force = compiled(contact.elastic_force)


@compiled
def _joint_forces(
    e: FloatArray,
    e_rate: FloatArray,
    spins: FloatArray,
    in_contact: BoolArray,
    impact_rate: FloatArray,
    joint: contact.Joint,
    law: FloatArray,
    out: FloatArray,
) -> None:
    """Write force on the bearing (x, y), f_n, f_t in N and v_t in m/s, shape (n, 5)."""
    for k in range(e.shape[0]):
        motion = e[k, 0], e[k, 1], e_rate[k, 0], e_rate[k, 1], spins[k, 0], spins[k, 1]
        out[k, 4] = contact.relative_motion(motion, joint)[4]
        if in_contact[k]:
            rate = max(impact_rate[k], joint.rate_floor)
            f_x, f_y, _, _, normal, _, _, _, _ = contact.forces(motion, rate, joint, law)
            out[k, 0], out[k, 1], out[k, 2] = f_x, f_y, normal
            out[k, 3] = contact.friction_force(normal, out[k, 4], joint)


@compiled
def _force_within(
    time: FloatArray,
    e: FloatArray,
    e_rate: FloatArray,
    in_contact: BoolArray,
    impact_rate: FloatArray,
    joint: contact.Joint,
    law: FloatArray,
    out: FloatArray,
) -> None:
    """Write `JointMotion.force_within`."""
    for k in range(time.size - 1):
        h = time[k + 1] - time[k]
        if not in_contact[k + 1] or h <= 0.0:
            continue
        rate = max(impact_rate[k + 1], joint.rate_floor)
        for part in range(PARTS):
            x = (part + 0.5) / PARTS
            e_x, u_x = _hermite(x, h, e[k, 0], e[k + 1, 0], e_rate[k, 0], e_rate[k + 1, 0])
            e_y, u_y = _hermite(x, h, e[k, 1], e[k + 1, 1], e_rate[k, 1], e_rate[k + 1, 1])
            out[k, part] = contact.forces((e_x, e_y, u_x, u_y, 0.0, 0.0), rate, joint, law)[4]


@called
def _hermite(
    x: float, h: float, start: float, end: float, start_rate: float, end_rate: float
) -> tuple[float, float]:
    """Return a value and its rate at a fraction x of a step, from those at its ends."""
    a, b, c = h * start_rate, end - start, h * end_rate
    cubic, square = a + c - 2.0 * b, 3.0 * b - 2.0 * a - c
    value = start + x * (a + x * (square + x * cubic))
    return value, (a + x * (2.0 * square + x * 3.0 * cubic)) / h


@compiled
def _elastic_energy(
    penetration: FloatArray, joint: contact.Joint, law: FloatArray, out: FloatArray
) -> None:
    """Write ∫ F_el dδ in J up to each penetration in m."""
    for k in range(penetration.size):
        out[k] = contact.stored_energy(penetration[k], joint, law)
