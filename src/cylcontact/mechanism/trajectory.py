"""Trajectories: the steps of a run, what follows from them, and their numbers by revolution."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.joint import contact
from cylcontact.mechanism.motion import Motion
from cylcontact.mechanism.run import Settings, Steps, concatenate, revolutions_of
from cylcontact.mechanism.slider_crank import COORDINATES, DRIVE, JOINT_LEDGERS, SliderCrank
from cylcontact.mechanism.statistics import FORCE_PERCENTILES, SECTION, Statistics
from cylcontact.support.arrays import BoolArray, FloatArray, IndexArray, as_floats
from cylcontact.support.choices import Beyond
from cylcontact.support.html_repr import table_html
from cylcontact.support.numba_cache import called, compiled
from cylcontact.support.progress import Progress, silent

if TYPE_CHECKING:
    import pandas as pd

    from cylcontact.plots import StyledFigure

# Parts of a step in each of which the force is computed once.
PARTS = 4


def _ledger(name: str, about: str) -> Any:
    column = DRIVE + 1 + JOINT_LEDGERS.index(name)
    return property(lambda run: run.steps.values[:, column], doc=about)


def _of_forces(columns: int | slice, about: str) -> Any:
    return property(lambda run: run._forces[:, columns], doc=about)


def _of_motion(name: str) -> Any:
    return property(lambda run: getattr(run.motion, name), doc=getattr(Motion, name).__doc__)


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory:
    """The motion of a slider-crank over whole revolutions.

    Every array has one element or row for each of the n accepted steps, in SI units: m, s, rad, N,
    J. An onset or release of contact has two rows at the same time, one in each mode. Axes are
    along and across the slide.

    Parameters
    ----------
    mechanism : SliderCrank
    settings : Settings
    steps : Steps
        The steps as the integrator has returned them.
    """

    mechanism: SliderCrank
    settings: Settings
    steps: Steps

    @property
    def time(self) -> FloatArray:
        """Times in s, shape (n,)."""
        return self.steps.time

    @property
    def revolution(self) -> FloatArray:
        """Time in revolutions of the crank, shape (n,)."""
        return self.steps.time / self.mechanism.period

    @property
    def in_contact(self) -> BoolArray:
        """Whether the row belongs to the contact mode, shape (n,)."""
        return self.steps.in_contact

    @property
    def impact_rate(self) -> FloatArray:
        """δ̇⁽⁻⁾ of the current contact in m/s, 0 out of contact, shape (n,)."""
        return self.steps.impact_rate

    @property
    def eccentricity(self) -> FloatArray:
        """e = r_i − r_j in m, from the pin's centre to the bearing's, shape (n, 2)."""
        return self.mechanism.side * self.steps.values[:, :2]

    @property
    def eccentricity_rate(self) -> FloatArray:
        """The rate of `eccentricity` in m/s, shape (n, 2)."""
        return self.mechanism.side * self.steps.values[:, 2:COORDINATES]

    def eccentricity_at(self, time: FloatArray) -> FloatArray:
        """Return `eccentricity` in m at times in s, by Hermite's cubics."""
        from scipy.interpolate import CubicHermiteSpline

        steps, rows = np.unique(self.time, return_index=True)
        spline = CubicHermiteSpline(steps, self.eccentricity[rows], self.eccentricity_rate[rows])
        return as_floats(spline(time))

    # --- the joint ---

    @cached_property
    def _compiled(self) -> tuple[Any, FloatArray]:
        """The joint as compiled functions take it, and the numbers of its law."""
        joint = self.mechanism.joint
        return joint.record(self.settings.beyond), joint.kernel.parameters

    @cached_property
    def penetration(self) -> FloatArray:
        """δ = |e| − c in m, negative out of contact, shape (n,)."""
        return as_floats(np.hypot(*self.eccentricity.T) - self._compiled[0]["clearance"])

    @cached_property
    def penetration_rate(self) -> FloatArray:
        """δ̇ in m/s, shape (n,)."""
        distance = np.hypot(*self.eccentricity.T)
        along = (self.eccentricity * self.eccentricity_rate).sum(axis=1)
        return as_floats(along / np.where(distance > 0, distance, 1.0))

    @cached_property
    def _forces(self) -> FloatArray:
        """The columns that `_joint_forces` writes."""
        spin = self._coordinates.rod_spin
        still = np.zeros_like(spin)
        spins = (still, spin) if self.mechanism.side > 0 else (spin, still)
        out = np.zeros((self.time.size, 7))
        _joint_forces(
            self.eccentricity, self.eccentricity_rate, np.column_stack(spins), self.in_contact,
            self.impact_rate, *self._compiled, out,
        )  # fmt: skip
        return out

    force = _of_forces(slice(2), "The contact force on the bearing in N, Eq 13a, shape (n, 2).")
    normal_force = _of_forces(2, "f_n in N, shape (n,).")
    friction_force = _of_forces(3, "f_t in N along t = [n_y, −n_x], on the bearing, shape (n,).")
    tangential_velocity = _of_forces(4, "v_t = (v_i − v_j)·t in m/s at the contact, shape (n,).")

    @cached_property
    def force_within(self) -> FloatArray:
        """f_n in N in the middle of equal parts of every step, shape (n − 1, PARTS).

        Steps are long against the peaks of the force. The eccentricity is interpolated by Hermite's
        cubic; out of contact the force is 0.
        """
        out = np.zeros((self.time.size - 1, PARTS))
        _force_within(
            self.time, self.eccentricity, self.eccentricity_rate, self.in_contact,
            self.impact_rate, *self._compiled, out,
        )  # fmt: skip
        return out

    @cached_property
    def contacts(self) -> pd.DataFrame:
        """One row for each contact.

        Columns: `onset_s`, `release_s` (NaN while under way), `impact_rate_m_per_s` (δ̇⁽⁻⁾),
        `max_penetration_m` and `max_force_N`.
        """
        import pandas as pd

        begins, ends = changes(self.in_contact)
        last = np.append(ends, self.time.size - 1)[: begins.size]
        spans = [slice(a, b + 1) for a, b in zip(begins, last, strict=True)]
        release = np.full(begins.size, np.nan)
        release[: ends.size] = self.time[ends]
        return pd.DataFrame(
            {
                "onset_s": self.time[begins],
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

    # --- bodies ---

    @property
    def crank_angle(self) -> FloatArray:
        """The crank's angle from the slide in rad, shape (n,)."""
        angle = np.radians(self.mechanism.spec.angle)
        return as_floats(angle + self.mechanism.omega * self.time)

    @cached_property
    def _coordinates(self) -> Motion:
        """The motion without forces, from which the forces follow."""
        E, E_rate = (self.steps.values[:, k] + 1j * self.steps.values[:, k + 1] for k in (0, 2))
        return Motion(self.mechanism, self.crank_angle, E, E_rate)

    @cached_property
    def motion(self) -> Motion:
        """Positions, velocities, accelerations and reactions of the bodies."""
        side, (on_bearing, on_pin) = self.mechanism.side, self._forces[:, 5:].T
        moments = (on_pin, on_bearing) if side > 0 else (on_bearing, on_pin)
        load = side * (self.force[:, 0] + 1j * self.force[:, 1])
        state = self._coordinates
        return Motion(self.mechanism, state.crank_angle, state.E, state.E_rate, load, *moments)

    @cached_property
    def ideal(self) -> Motion:
        """The motion of the ideal mechanism, without clearance and friction, at the same angles."""
        return Motion(self.mechanism, self.crank_angle)

    slider_position = _of_motion("slider_position")
    slider_velocity = _of_motion("slider_velocity")
    slider_acceleration = _of_motion("slider_acceleration")
    crank_moment = _of_motion("crank_moment")

    # --- energies ---

    @property
    def kinetic_energy(self) -> FloatArray:
        """Kinetic energy in J, shape (n,)."""
        return self._coordinates.kinetic_energy

    @property
    def potential_energy(self) -> FloatArray:
        """Potential energy of gravity in J, shape (n,)."""
        return self._coordinates.potential_energy

    @cached_property
    def elastic_energy(self) -> FloatArray:
        """Energy stored in the contact in J, shape (n,)."""
        depth = np.where(self.in_contact, self.penetration, 0.0)
        energy = np.zeros_like(depth)
        _elastic_energy(depth, *self._compiled, energy)
        return energy

    def elastic_forces(self, penetrations: FloatArray) -> FloatArray:
        """Return the forces in N at penetrations in m, without damping."""
        return np.array([_elastic_force(depth, *self._compiled) for depth in penetrations])

    @property
    def drive_work(self) -> FloatArray:
        """Work of the driver since the start in J, shape (n,)."""
        return self.steps.values[:, DRIVE]

    normal_dissipation = _ledger(
        "normal_dissipation", "Energy lost by the normal force in J, (n,)."
    )
    friction_dissipation = _ledger("friction_dissipation", "Energy lost by friction in J, (n,).")

    @cached_property
    def energy(self) -> FloatArray:
        """Energy stored and dissipated minus the driver's work, which is constant, in J, (n,)."""
        stored = self.kinetic_energy + self.potential_energy + self.elastic_energy
        lost = self.normal_dissipation + self.friction_dissipation
        return as_floats(stored + lost - self.drive_work)

    @property
    def energy_error(self) -> FloatArray:
        """`energy` minus its value at the start in J, shape (n,)."""
        return as_floats(self.energy - self.energy[0])

    # --- numbers ---

    def to_frame(self) -> pd.DataFrame:
        """Return a table with one row for each accepted step, units in the names.

        Reactions are those of the ground on the crank at the pivot, of the crank on the rod at the
        crank pin, and of the guide on the slider. The last columns are of the ideal mechanism,
        without clearance and friction.

        Examples
        --------
        >>> from cylcontact.mechanism import read_mechanism, simulate
        >>> run = simulate(read_mechanism("datasets/slider_crank.toml"), revolutions=1)
        >>> print(run.to_frame()["crank_angle_rad"].iloc[-1].round(4))
        -6.2832
        """
        import pandas as pd

        motion, ideal, e = self.motion, self.ideal, self.eccentricity
        return pd.DataFrame(
            {
                "time_s": self.time,
                "crank_angle_rad": self.crank_angle,
                "slider_position_m": motion.slider_position,
                "slider_velocity_m_s": motion.slider_velocity,
                "slider_acceleration_m_s2": motion.slider_acceleration,
                "crank_moment_Nm": motion.crank_moment,
                "eccentricity_x_m": e[:, 0],
                "eccentricity_y_m": e[:, 1],
                "penetration_m": self.penetration,
                "penetration_rate_m_s": self.penetration_rate,
                "normal_force_N": self.normal_force,
                "friction_force_N": self.friction_force,
                "pivot_force_x_N": motion.pivot_force.real,
                "pivot_force_y_N": motion.pivot_force.imag,
                "crank_pin_force_x_N": motion.crank_pin_force.real,
                "crank_pin_force_y_N": motion.crank_pin_force.imag,
                "guide_force_N": motion.guide_force,
                "guide_moment_Nm": motion.guide_moment,
                "ideal_position_m": ideal.slider_position,
                "ideal_velocity_m_s": ideal.slider_velocity,
                "ideal_acceleration_m_s2": ideal.slider_acceleration,
                "ideal_crank_moment_Nm": ideal.crank_moment,
            }
        )

    def plot(self, revolutions: float = 2.0) -> StyledFigure:
        """Draw the last revolutions, and the Poincaré map of the whole run.

        Panels: acceleration of the slider and moment of the crank, with those of the ideal
        mechanism; contact force; path of the journal in its clearance; velocity and acceleration of
        the slider at the end of every revolution.
        """
        from cylcontact.mechanism.drawing import drawn

        return drawn(self, revolutions)

    @cached_property
    def _revolutions(self) -> pd.DataFrame:
        """The rows of `Statistics.revolutions`."""
        import pandas as pd

        count = len(self.steps.counts)
        starts = np.searchsorted(self.steps.revolution, np.arange(count + 1))
        # From the last row of the previous revolution.
        spans = [slice(max(a - 1, 0), b) for a, b in itertools.pairwise(starts.tolist())]
        parts = (
            Trajectory(self.mechanism, self.settings, self.steps.part(span, k))
            for k, span in enumerate(spans)
        )
        records = [numbers_of(part, float(self.energy[0])) for part in parts]
        return pd.DataFrame(records, pd.RangeIndex(count, name="revolution"))

    def statistics(self, first: int = 0) -> Statistics:
        """Return the statistics over the revolutions from `first` (0 is the first) on.

        Examples
        --------
        >>> from cylcontact.mechanism import read_mechanism, simulate
        >>> crank = read_mechanism("datasets/slider_crank.toml", clearance=0.02)
        >>> statistics = simulate(crank, revolutions=2).statistics(first=1)
        >>> print(f"{statistics.mean['contact_fraction']:.3f}")
        1.000
        """
        return Statistics(self._revolutions, self.mechanism, self.settings, first)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings; see `Statistics.warnings`."""
        return self.statistics().warnings

    def __repr__(self) -> str:
        count, end = len(self.steps.counts), self.time[-1]
        return f"Trajectory({self.mechanism.name!r}, {count} revolutions, {end:.6g} s)"

    def _repr_html_(self) -> str:
        rows = {"duration (s)": self.time[-1], **self.statistics().summary}
        return table_html(f"Trajectory of {self.mechanism.name}", rows)


def simulate(
    mechanism: SliderCrank,
    revolutions: int | None = None,
    beyond: Beyond = "stop",
    progress: Progress = silent,
) -> Trajectory:
    """Simulate a slider-crank and keep every step.

    Parameters
    ----------
    mechanism : SliderCrank
        See `read_mechanism`, which takes the tolerance too.
    revolutions : int, optional
        The number of revolutions of the crank; by default that of the file.
    beyond : {"stop", "tangent"}
        At the end of a contact law: stop with an error, or continue along its tangent at nine
        tenths of the largest penetration.
    progress : callable, optional
        Called with a stage, the number of revolutions done and their total.

    Returns
    -------
    Trajectory

    Raises
    ------
    InputError
        If the penetration leaves the domain of its law (`LawDomainError`), the pin leaves its hole,
        or the step size becomes too small (`RunError`).

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism
    >>> run = simulate(read_mechanism("datasets/slider_crank.toml", clearance=0.02), revolutions=1)
    >>> print(f"{run.penetration.max() * 1e6:.1f} µm")
    10.3 µm
    """
    settings = Settings(beyond)
    total = mechanism.spec.revolutions if revolutions is None else revolutions
    parts = list(revolutions_of(mechanism, settings, total, progress))
    return Trajectory(mechanism, settings, concatenate(parts))


# --- numbers of a revolution --------------------------------------------------------------------


def numbers_of(run: Trajectory, origin: float) -> dict[str, Any]:
    """Return the row of `Statistics.revolutions` for one revolution, and the step before it.

    `origin` is the `energy` at the start of the whole run in J.
    """
    touching, dt, values = run.in_contact, np.diff(run.time), run.steps.values
    # A step has the mode of its last row; the second row of an onset has dt = 0.
    inside, moving = touching[1:], dt > 0
    contact_time, flight_time = float(dt[inside].sum()), float(dt[~inside].sum())
    contact_steps = int(np.count_nonzero(inside & moving))
    steps, evaluations, seconds = run.steps.counts[0]
    within = run.force_within
    drive, *spent = (float(number) for number in values[-1, DRIVE:] - values[0, DRIVE:])
    lost, rubbed, depth, impulse = spent
    percentiles = _percentiles(dt[inside], within[inside])
    begins, _ = changes(touching)
    under_way = np.append(0, begins) if touching[0] else begins
    deepest = np.where(touching, run.penetration, -np.inf)
    deepest = np.maximum.reduceat(deepest, under_way) if under_way.size else np.empty(0)
    joint, limit = run._compiled[0], run.mechanism.joint.first_yield
    tangent = run.settings.beyond == "tangent"
    law_end = float(joint["last_penetration"]) * 1e-3 if tangent else np.inf
    loads = run.elastic_forces(deepest)
    end = (*run.eccentricity[-1] * 1e6, *run.eccentricity_rate[-1], bool(touching[-1]))
    return {
        "contact_fraction": contact_time / (contact_time + flight_time),
        "impacts": begins.size,
        "mean_penetration_um": _ratio(depth, contact_time) * 1e6,
        "max_penetration_um": float(run.penetration[touching].max(initial=0.0)) * 1e6,
        "mean_force_N": _ratio(impulse, contact_time),
        **{f"force_p{p}_N": x for p, x in zip(FORCE_PERCENTILES, percentiles, strict=True)},
        "max_force_N": float(max(run.normal_force.max(initial=0.0), within.max(initial=0.0))),
        "normal_dissipation_J": lost,
        "friction_dissipation_J": rubbed,
        "mean_step_contact_us": _ratio(contact_time, contact_steps) * 1e6,
        "mean_step_flight_us": _ratio(flight_time, steps - contact_steps) * 1e6,
        "contact_time_s": contact_time,
        "flight_time_s": flight_time,
        "penetration_integral_um_s": depth * 1e6,
        "impulse_N_s": impulse,
        "contact_steps": contact_steps,
        "impact_rate_m_per_s": float(run.impact_rate[-1]),
        "contacts": under_way.size,
        "above_yield": int(np.count_nonzero(loads > limit)),
        "beyond_law": int(np.count_nonzero(deepest > law_end)),
        "max_load_N_per_mm": float(loads.max(initial=0.0)) / float(joint["length"]),
        **dict(zip(SECTION, end, strict=True)),
        "drive_work_J": drive,
        "steps": int(steps),
        "evaluations": int(evaluations),
        "seconds": float(seconds),
        "kinetic_energy_J": float(run.kinetic_energy.max()),
        "energy_error_J": float(run.energy[-1]) - origin,
    }


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


def changes(in_contact: BoolArray) -> tuple[IndexArray, IndexArray]:
    """Return the rows at which contacts begin and those at which they end."""
    step = np.diff(in_contact.astype(np.int8))
    return np.flatnonzero(step == 1) + 1, np.flatnonzero(step == -1)


# --- compiled, over rows ------------------------------------------------------------------------

_elastic_force = compiled(contact.piece_force)


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
    """Write force on the bearing (x, y), f_n, f_t in N, v_t in m/s, and moments, shape (n, 7).

    The moments in N m are on the bearing and on the pin, about their centres.
    """
    for k in range(e.shape[0]):
        motion = contact.Motion(
            e[k, 0], e[k, 1], e_rate[k, 0], e_rate[k, 1], spins[k, 0], spins[k, 1]
        )
        v_t = contact.relative_motion(motion, joint).v_t
        out[k, 4] = v_t
        if in_contact[k]:
            rate = max(impact_rate[k], joint.rate_floor)
            f = contact.forces(motion, rate, joint, law)
            out[k, 0], out[k, 1], out[k, 2] = f.x, f.y, f.normal
            out[k, 3] = -joint.friction * contact.piece_share(v_t, joint) * f.normal
            out[k, 5], out[k, 6] = f.moment_i, f.moment_j


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
    """Write `Trajectory.force_within`."""
    for k in range(time.size - 1):
        h = time[k + 1] - time[k]
        if not in_contact[k + 1] or h <= 0.0:
            continue
        rate = max(impact_rate[k + 1], joint.rate_floor)
        for part in range(PARTS):
            x = (part + 0.5) / PARTS
            e_x, u_x = _hermite(x, h, e[k, 0], e[k + 1, 0], e_rate[k, 0], e_rate[k + 1, 0])
            e_y, u_y = _hermite(x, h, e[k, 1], e[k + 1, 1], e_rate[k, 1], e_rate[k + 1, 1])
            motion = contact.Motion(e_x, e_y, u_x, u_y, 0.0, 0.0)
            out[k, part] = contact.forces(motion, rate, joint, law).normal


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
