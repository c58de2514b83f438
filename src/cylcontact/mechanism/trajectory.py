"""What a simulation gives: every accepted step, and what follows from it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from cylcontact.arrays import BoolArray, FloatArray, as_floats
from cylcontact.mechanism import contact, derived, storage, summary
from cylcontact.mechanism.model import Mechanism
from cylcontact.mechanism.slider_crank import motion, recognise
from cylcontact.mechanism.step_history import Settings, State, StepHistory

if TYPE_CHECKING:
    import pandas as pd

    from cylcontact.mechanism.statistics import Statistics


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory:
    """The motion of a mechanism with a clearance joint, over whole revolutions.

    Every array has one element, or one row, for every accepted step of the integrator (n
    of them), in SI units: m, s, rad, N, J. An onset or a release of contact has two rows at the
    same time, one in either mode.

    Parameters
    ----------
    mechanism : Mechanism
        What was simulated.
    settings : Settings
        How: method, tolerance, largest step in s, what was done beyond the law's domain.
    rows : StepHistory
        The steps as the integrator gave them.
    block : array of float
        The parameter block of the compiled model.
    """

    mechanism: Mechanism
    settings: Settings
    rows: StepHistory
    block: FloatArray

    @property
    def time(self) -> FloatArray:
        """Times in s, shape (n,)."""
        return self.rows.time

    @property
    def revolution(self) -> FloatArray:
        """Time in revolutions of the driver, shape (n,)."""
        return self.rows.time / self.mechanism.period

    @property
    def in_contact(self) -> BoolArray:
        """Whether the row belongs to the contact mode, shape (n,)."""
        return self.rows.in_contact

    @property
    def revolutions(self) -> int:
        """The number of complete revolutions."""
        return int(self.rows.counts.shape[0])

    @property
    def end(self) -> State:
        """The last state: all that the rest of a run depends on."""
        r = self.rows
        return State(
            float(r.time[-1]), r.values[-1], bool(r.in_contact[-1]), float(r.impact_rate[-1])
        )

    @cached_property
    def _motion(self) -> tuple[FloatArray, FloatArray]:
        values = self.rows.values
        if self.settings.method == "minimal":
            shape = recognise(self.mechanism)
            return motion(shape, self.time, values[:, 0:2], values[:, 2:4])
        size = 3 * len(self.mechanism.bodies)
        return values[:, :size], values[:, size : 2 * size]

    @property
    def coordinates(self) -> FloatArray:
        """x, y in m and θ in rad of every body's centre of mass, shape (n, bodies, 3)."""
        return self._motion[0].reshape(self.time.size, -1, 3)

    @property
    def velocities(self) -> FloatArray:
        """The rates of `coordinates`, shape (n, bodies, 3)."""
        return self._motion[1].reshape(self.time.size, -1, 3)

    @cached_property
    def _eccentricity(self) -> tuple[FloatArray, FloatArray]:
        """e and its rate in global axes; from minimal coordinates without loss of digits."""
        if self.settings.method == "minimal":
            shape, values = recognise(self.mechanism), self.rows.values
            turn = shape.side * np.exp(1j * shape.slide)
            e = turn * (values[:, 0] + 1j * values[:, 1])
            rate = turn * (values[:, 2] + 1j * values[:, 3])
            return np.column_stack((e.real, e.imag)), np.column_stack((rate.real, rate.imag))
        joint = self.mechanism.clearance
        i, j = self.point(joint.i, joint.point_i), self.point(joint.j, joint.point_j)
        return i[0] - j[0], i[1] - j[1]

    def point(self, body: int, place: tuple[float, float]) -> tuple[FloatArray, FloatArray]:
        """Return position and velocity of a body's point, each of shape (n, 2).

        Parameters
        ----------
        body : int
            Its index; −1 is the ground.
        place : pair of float
            In m, in the body's own axes from its centre of mass.
        """
        if body < 0:
            return np.tile(place, (self.time.size, 1)), np.zeros((self.time.size, 2))
        q, v = self.coordinates[:, body], self.velocities[:, body]
        arm = np.exp(1j * q[:, 2]) * complex(*place)
        rate = 1j * v[:, 2] * arm
        return (
            q[:, :2] + np.column_stack((arm.real, arm.imag)),
            v[:, :2] + np.column_stack((rate.real, rate.imag)),
        )

    @property
    def eccentricity(self) -> FloatArray:
        """e = r_i − r_j in m, from the journal's centre to the bearing's, shape (n, 2)."""
        return self._eccentricity[0]

    @property
    def eccentricity_rate(self) -> FloatArray:
        """The rate of `eccentricity` in m/s, shape (n, 2)."""
        return self._eccentricity[1]

    @cached_property
    def penetration(self) -> FloatArray:
        """δ = |e| − c in m, negative out of contact, shape (n,)."""
        return as_floats(np.hypot(*self.eccentricity.T) - self.mechanism.clearance.radial)

    @cached_property
    def penetration_rate(self) -> FloatArray:
        """δ̇ in m/s, shape (n,)."""
        distance = np.hypot(*self.eccentricity.T)
        along = (self.eccentricity * self.eccentricity_rate).sum(axis=1)
        return as_floats(along / np.where(distance > 0, distance, 1.0))

    @cached_property
    def _forces(self) -> FloatArray:
        joint = self.mechanism.clearance
        if self.mechanism.ideal:
            return np.full((self.time.size, 5), np.nan)
        spins = np.zeros((self.time.size, 2))
        for column, body in enumerate((joint.i, joint.j)):
            if body >= 0:
                spins[:, column] = self.velocities[:, body, 2]
        found: FloatArray = derived.joint_forces(
            np.ascontiguousarray(self.eccentricity),
            np.ascontiguousarray(self.eccentricity_rate),
            spins,
            self.in_contact,
            self.rows.impact_rate,
            joint.rate_floor,
            self.block.copy(),
        )
        return found

    @property
    def force(self) -> FloatArray:
        """The contact force on the bearing in N, Eq 13a, shape (n, 2)."""
        return self._forces[:, 0:2]

    @property
    def normal_force(self) -> FloatArray:
        """f_n in N, shape (n,)."""
        return self._forces[:, 2]

    @property
    def friction_force(self) -> FloatArray:
        """f_t in N along t = [n_y, −n_x], on the bearing, shape (n,)."""
        return self._forces[:, 3]

    @property
    def tangential_velocity(self) -> FloatArray:
        """v_t = (v_i − v_j)·t in m/s at the contact point, shape (n,)."""
        return self._forces[:, 4]

    @property
    def drive_work(self) -> FloatArray:
        """Work of the drive since the start in J, shape (n,)."""
        return self.rows.values[:, -3]

    @property
    def normal_dissipation(self) -> FloatArray:
        """Energy dissipated by the normal force since the start in J, shape (n,)."""
        return self.rows.values[:, -2]

    @property
    def friction_dissipation(self) -> FloatArray:
        """Energy dissipated by friction since the start in J, shape (n,)."""
        return self.rows.values[:, -1]

    @cached_property
    def kinetic_energy(self) -> FloatArray:
        """Kinetic energy of all bodies in J, shape (n,)."""
        return derived.kinetic_and_potential(self.mechanism, *self._motion)[0]

    @cached_property
    def potential_energy(self) -> FloatArray:
        """Energy of position in J, 0 without gravity, shape (n,)."""
        return derived.kinetic_and_potential(self.mechanism, *self._motion)[1]

    @cached_property
    def elastic_energy(self) -> FloatArray:
        """Energy stored in the contact in J, a quadrature of the law itself, shape (n,)."""
        if self.mechanism.ideal:
            return np.zeros_like(self.time)
        found: FloatArray = derived.elastic_energy(
            np.where(self.in_contact, self.penetration, 0.0),
            derived.NODES,
            derived.WEIGHTS,
            self.block,
        )
        return found

    @cached_property
    def energy_error(self) -> FloatArray:
        """Energy stored and dissipated less the drive's work, since the start, in J, shape (n,)."""
        stored = self.kinetic_energy + self.potential_energy + self.elastic_energy
        total = stored + self.normal_dissipation + self.friction_dissipation - self.drive_work
        return as_floats(total - total[0])

    @cached_property
    def drift(self) -> FloatArray:
        """The largest |Φ| (m, rad) and |dΦ/dt| of the joints' constraints, shape (n, 2)."""
        return derived.drift(self.mechanism, self.time, *map(np.ascontiguousarray, self._motion))

    @property
    def counts(self) -> pd.DataFrame:
        """Accepted steps, evaluations and seconds, one row for each revolution."""
        return summary.counts(self)

    @cached_property
    def contacts(self) -> pd.DataFrame:
        """One row for each contact.

        Columns: `onset_s`, `release_s` (NaN while under way), `impact_rate_m_per_s` (δ̇⁽⁻⁾),
        `max_penetration_m` and `max_force_N`.
        """
        return summary.contacts(self)

    @property
    def assumptions(self) -> tuple[str, ...]:
        """Everything that was assumed, as "key = value", and how the law went on if it did."""
        return (*self.mechanism.assumptions, *self.continuation)

    @property
    def continuation(self) -> tuple[str, ...]:
        """How the law went on beyond its domain, with the share of contact time; often nothing."""
        limit = float(self.block[contact.LAST_PENETRATION]) * 1e-3
        return summary.continuation(self, limit)

    def statistics(self, first: int = 0) -> Statistics:
        """Return means and scatter over the revolutions from `first` (0 is the first) on."""
        from cylcontact.mechanism.statistics import statistics

        return statistics(self, first)

    def save(self, path: Path | str) -> None:
        """Write to a Parquet file, with the spec, the settings and the provenance."""
        storage.save(self.mechanism, self.settings, self.rows, path)

    @classmethod
    def load(cls, path: Path | str) -> Trajectory:
        """Read what `save` has written.

        Raises
        ------
        InputError
            If the file cannot be read or holds no trajectory.
        """
        from cylcontact.mechanism.system import build

        mechanism, settings, rows = storage.load(path)
        system = build(mechanism, settings.method, settings.beyond)
        return cls(mechanism, settings, rows, system.block)

    def __repr__(self) -> str:
        rows = "\n".join(f"  {key:>22}: {value}" for key, value in summary.entries(self).items())
        return f"Trajectory of {self.mechanism.name!r}\n{rows}"

    def _repr_html_(self) -> str:
        from cylcontact.html_repr import table_html

        return table_html(f"Trajectory of {self.mechanism.name}", summary.entries(self))
