"""Trajectories: the accepted steps of a simulation, derived quantities, Parquet files and text."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.arrays import BoolArray, FloatArray, as_floats
from cylcontact.errors import InputError
from cylcontact.files import replacing, require_parquet
from cylcontact.html_repr import table_html
from cylcontact.limits import yield_load
from cylcontact.mechanism import contact, derived
from cylcontact.mechanism.model import Mechanism, mechanism_from
from cylcontact.mechanism.revolution import Limits, reduce_revolution
from cylcontact.mechanism.slider_crank import motion, recognise
from cylcontact.mechanism.statistics import SECTION, Statistics, described
from cylcontact.mechanism.step_history import LEDGERS, Settings, State, StepHistory
from cylcontact.mechanism.system import build
from cylcontact.provenance import made_with
from cylcontact.reading import marked, require_file, unmarked

if TYPE_CHECKING:
    import pandas as pd

    from cylcontact.plots import Drawing

__all__ = ["Trajectory"]

# The key of the schema's metadata with everything but the states.
_METADATA = b"cylcontact.trajectory"
_LIBRARIES = ("numpy", "numba", "pyarrow")


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory:
    """The motion of a mechanism with a clearance joint, over whole revolutions.

    Every array has one element or row for each of the n accepted steps of the integrator, in SI
    units: m, s, rad, N, J. An onset or release of contact has two rows at the same time, one in
    each mode.

    Parameters
    ----------
    mechanism : Mechanism
        The mechanism.
    settings : Settings
        Method, tolerance, longest step in s, and continuation beyond the law's domain.
    rows : StepHistory
        The steps as returned by the integrator.
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
        """The last state, from which a run can be resumed."""
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
        """e and its rate in global axes; minimal coordinates give them without cancellation."""
        if self.settings.method == "minimal":
            shape, values = recognise(self.mechanism), self.rows.values
            turn = shape.side * np.exp(1j * shape.slide)
            e = turn * (values[:, 0] + 1j * values[:, 1])
            rate = turn * (values[:, 2] + 1j * values[:, 3])
            return np.column_stack((e.real, e.imag)), np.column_stack((rate.real, rate.imag))
        joint = self.mechanism.clearance
        i, j = self.point(joint.i, joint.point_i), self.point(joint.j, joint.point_j)
        return i[0] - j[0], i[1] - j[1]

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
        forces: FloatArray = derived.joint_forces(
            np.ascontiguousarray(self.eccentricity),
            np.ascontiguousarray(self.eccentricity_rate),
            spins,
            self.in_contact,
            self.rows.impact_rate,
            joint.rate_floor,
            self.block,
        )
        return forces

    @cached_property
    def _force_within(self) -> FloatArray:
        """f_n in N within the steps; see `derived.force_within`."""
        forces: FloatArray = derived.force_within(
            self.time,
            np.ascontiguousarray(self.eccentricity),
            np.ascontiguousarray(self.eccentricity_rate),
            self.in_contact,
            self.rows.impact_rate,
            self.mechanism.clearance.rate_floor,
            self.block,
        )
        return forces

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
        return self.rows.values[:, LEDGERS["drive_work"]]

    @property
    def normal_dissipation(self) -> FloatArray:
        """Energy dissipated by the normal force since the start in J, shape (n,)."""
        return self.rows.values[:, LEDGERS["normal_dissipation"]]

    @property
    def friction_dissipation(self) -> FloatArray:
        """Energy dissipated by friction since the start in J, shape (n,)."""
        return self.rows.values[:, LEDGERS["friction_dissipation"]]

    @cached_property
    def kinetic_energy(self) -> FloatArray:
        """Kinetic energy of all bodies in J, shape (n,)."""
        return derived.kinetic_and_potential(self.mechanism, *self._motion)[0]

    @cached_property
    def potential_energy(self) -> FloatArray:
        """Potential energy in J, 0 without gravity, shape (n,)."""
        return derived.kinetic_and_potential(self.mechanism, *self._motion)[1]

    @cached_property
    def elastic_energy(self) -> FloatArray:
        """Energy stored in the contact in J, shape (n,)."""
        if self.mechanism.ideal:
            return np.zeros_like(self.time)
        energy: FloatArray = derived.elastic_energy(
            np.where(self.in_contact, self.penetration, 0.0), self.block
        )
        return energy

    @cached_property
    def energy(self) -> FloatArray:
        """Energy stored and dissipated minus the drive's work, which is constant, in J, (n,)."""
        stored = self.kinetic_energy + self.potential_energy + self.elastic_energy
        lost = self.normal_dissipation + self.friction_dissipation
        return as_floats(stored + lost - self.drive_work)

    @property
    def energy_error(self) -> FloatArray:
        """`energy` minus its value at the start in J, shape (n,)."""
        return as_floats(self.energy - self.energy[0])

    @cached_property
    def drift(self) -> FloatArray:
        """The largest |Φ| (m, rad) and |dΦ/dt| of the joints' constraints, shape (n, 2)."""
        return derived.drift(self.mechanism, self.time, *map(np.ascontiguousarray, self._motion))

    @property
    def counts(self) -> pd.DataFrame:
        """Accepted steps, evaluations and seconds (NaN from a file), a row for each revolution."""
        import pandas as pd

        table = pd.DataFrame(self.rows.counts, columns=["steps", "evaluations", "seconds"])
        return table.astype({"steps": int, "evaluations": int})

    @cached_property
    def contacts(self) -> pd.DataFrame:
        """One row for each contact.

        Columns: `onset_s`, `release_s` (NaN while under way), `impact_rate_m_per_s` (δ̇⁽⁻⁾),
        `max_penetration_m` and `max_force_N`.
        """
        import pandas as pd

        begins, ends = derived.changes(self.in_contact)
        last = np.append(ends, self.time.size - 1)[: begins.size]
        spans = [slice(a, b + 1) for a, b in zip(begins, last, strict=True)]
        release = np.full(begins.size, np.nan)
        release[: ends.size] = self.time[ends]
        return pd.DataFrame(
            {
                "onset_s": self.time[begins],
                "release_s": release,
                "impact_rate_m_per_s": self.rows.impact_rate[begins],
                "max_penetration_m": [self.penetration[span].max() for span in spans],
                "max_force_N": [self._peak(span) for span in spans],
            }
        )

    def _peak(self, span: slice) -> float:
        """Return the largest f_n in N in some rows and within the steps between them."""
        within = self._force_within[span.start : span.stop - 1]
        return float(max(self.normal_force[span].max(), within.max(initial=0.0)))

    @cached_property
    def max_elastic_load(self) -> float:
        """The law's load per unit length at the deepest penetration in N/mm, without damping."""
        if self.mechanism.ideal:
            return float("nan")
        deepest = float(self.penetration[self.in_contact].max(initial=0.0))
        return float(contact.elastic_force(deepest, self.block)) / self.mechanism.clearance.length

    @property
    def warnings(self) -> tuple[str, ...]:
        """A sentence for each thing to be wary of; see `Statistics.warnings`."""
        return self.statistics().warnings

    @property
    def assumptions(self) -> tuple[str, ...]:
        """Every assumption as "key = value", with the continuation of the law if there was one."""
        return self.statistics().assumptions

    @cached_property
    def limits(self) -> Limits:
        """What contacts are held against: first yield, the law's tangent, the slowest impact."""
        tangent = self.settings.beyond == "tangent"
        return Limits(
            self._yield_penetration(),
            float(self.block[contact.LAST_PENETRATION]) * 1e-3 if tangent else np.inf,
            self.mechanism.clearance.rate_floor,
        )

    def _yield_penetration(self) -> float:
        """Return the penetration in m at first yield; inf if the law has no such load."""
        from scipy.optimize import brentq

        joint = self.mechanism.clearance
        bodies = () if joint.pair is None else (joint.pair.material_i, joint.pair.material_j)
        if joint.pair is None or any(body.yield_stress is None for body in bodies):
            return float("nan")
        load = float(yield_load(joint.pair)) * joint.length

        def excess(penetration: float) -> float:
            return float(contact.elastic_force(penetration, self.block)) - load

        if excess(joint.R_bearing) <= 0:
            return float("inf")
        return float(brentq(excess, 0.0, joint.R_bearing, xtol=1e-15))

    def reduced(self, origin: float, limits: Limits) -> dict[str, Any]:
        """Return the row of `Statistics.revolutions` for the one revolution of these steps.

        Parameters
        ----------
        origin : float
            The `energy` at the start of the whole run in J.
        limits : Limits
            What contacts are held against.
        """
        end = self._taken(slice(-1, None), 0)
        place, rate = end.eccentricity[0], end.eccentricity_rate[0]
        section = (*place * 1e6, *rate, bool(end.in_contact[0]))
        return {
            **reduce_revolution(
                self.rows, self.penetration, self.normal_force, self._force_within, limits
            ),
            "max_load_N_per_mm": self.max_elastic_load,
            "kinetic_energy_J": float(self.kinetic_energy.max()),
            "energy_error_J": float(end.energy[0]) - origin,
            "drift": np.nan if self.settings.method == "minimal" else float(end.drift[0, 0]),
            **dict(zip(SECTION, section, strict=True)),
        }

    def _taken(self, rows: slice, index: int) -> Trajectory:
        """Return some rows and the counts of a revolution, as a trajectory."""
        return replace(self, rows=self.rows.taken(rows, index))

    @cached_property
    def _revolutions(self) -> pd.DataFrame:
        """The rows of `Statistics.revolutions`."""
        import pandas as pd

        starts = np.searchsorted(self.rows.revolution, np.arange(self.revolutions + 1))
        origin = float(self._taken(slice(1), 0).energy[0])
        records = [
            # From the last row of the previous revolution.
            self._taken(slice(max(int(starts[k]) - 1, 0), int(starts[k + 1])), k).reduced(
                origin, self.limits
            )
            for k in range(self.revolutions)
        ]
        return pd.DataFrame(records, pd.RangeIndex(self.revolutions, name="revolution"))

    def statistics(self, first: int = 0) -> Statistics:
        """Return the statistics over the revolutions from `first` (0 is the first) on.

        Raises
        ------
        InputError
            If no revolution is left.

        Examples
        --------
        >>> from cylcontact.mechanism import read_mechanism, simulate
        >>> mechanism = read_mechanism("datasets/slider_crank.toml", clearance=0.02)
        >>> statistics = simulate(mechanism, revolutions=2).statistics(first=1)
        >>> print(f"{statistics.mean['contact_fraction']:.3f}")
        1.000
        """
        return Statistics(
            self._revolutions, self.mechanism, self.settings, self.end, self.limits, first
        )

    def save(self, path: Path | str) -> None:
        """Write to a Parquet file, with the spec, the settings and the provenance.

        One column for each state; the rest is in the schema's metadata. The same run gives the
        same bytes.
        """
        pa = require_parquet(path)
        rows, mechanism = self.rows, self.mechanism
        columns: dict[str, Any] = {
            "time_s": rows.time,
            "in_contact": rows.in_contact,
            "impact_rate_m_per_s": rows.impact_rate,
            "revolution": rows.revolution,
        }
        columns |= {
            f"state_{k}": np.ascontiguousarray(rows.values[:, k])
            for k in range(rows.values.shape[1])
        }
        metadata = {
            "spec": mechanism.data,
            "source": mechanism.source,
            "settings": asdict(self.settings),
            "counts": rows.counts[:, :2].tolist(),  # times would differ from run to run
            "assumptions": mechanism.assumptions,
            "provenance": made_with(
                Path(mechanism.source).parent, {"mechanism": mechanism.data}, _LIBRARIES
            ),
        }
        text = json.dumps(marked(metadata))
        table = pa.table(columns).replace_schema_metadata({_METADATA: text})
        with replacing(path) as temporary:
            pa.parquet.write_table(table, temporary, compression="zstd")

    @classmethod
    def load(cls, path: Path | str) -> Trajectory:
        """Read a trajectory that `save` has written.

        Raises
        ------
        InputError
            If the file cannot be read, holds no trajectory, or one of a newer format.
        """
        require_file(path)
        pa = require_parquet(path)
        try:
            file = pa.parquet.ParquetFile(path)
            table = file.read()
            metadata = dict(json.loads((table.schema.metadata or {})[_METADATA]))
            metadata = unmarked(metadata, str(path))
            rows = _rows_of(table, metadata["counts"])
            spec, source = metadata["spec"], str(metadata["source"])
            settings = Settings(**metadata["settings"])
        except InputError:
            raise
        except (OSError, pa.ArrowInvalid) as error:
            reason = getattr(error, "strerror", None) or "not a Parquet file"
            raise InputError(
                str(path), "", None, f"cannot be read ({reason})", "check the path"
            ) from error
        except (KeyError, ValueError, TypeError, AttributeError, pa.ArrowException) as error:
            raise InputError(
                str(path), "", None, "holds no trajectory", "give what simulate -o has written"
            ) from error
        mechanism = mechanism_from(spec, source)
        system = build(mechanism, settings.method, settings.beyond)
        if rows.values.shape[1] != system.start.size:
            states = rows.values.shape[1]
            rule = f"has {states} states where its mechanism has {system.start.size}"
            remedy = "an older version of cylcontact wrote it, or another program: simulate anew"
            raise InputError(str(path), "", None, rule, remedy)
        return cls(mechanism, settings, rows, system.block)

    def plot(self, revolutions: float = 2.0) -> Drawing:
        """Draw the path of the journal's centre in the bearing, and the force in the joint.

        Parameters
        ----------
        revolutions : float, optional
            How many are drawn, from the end.

        Returns
        -------
        Drawing
            Its table has one row for each step, its headline the largest force in N.

        Raises
        ------
        InputError
            If `revolutions` is not positive.
        """
        from cylcontact.mechanism.drawing import joint_drawing

        return joint_drawing(self, revolutions)

    def __str__(self) -> str:
        return described(f"Trajectory of {self.mechanism.name!r}", self.statistics().summary)

    def __repr__(self) -> str:
        return (
            f"Trajectory({self.mechanism.name!r}, revolutions={self.revolutions}, "
            f"rows={self.time.size}, end={self.time[-1]:.6g} s)"
        )

    def _repr_html_(self) -> str:
        rows = {"duration (s)": self.time[-1] - self.time[0], **self.statistics().summary}
        picture = "" if self.mechanism.ideal else self.plot()._repr_html_()
        return table_html(f"Trajectory of {self.mechanism.name}", rows) + picture


def _rows_of(table: Any, counts: Any) -> StepHistory:
    """Return the rows that a table holds.

    Raises
    ------
    KeyError, ValueError, TypeError
        If a column is missing or holds no finite numbers, or if there are no rows.
    """
    names = [name for name in table.column_names if name.startswith("state_")]
    columns = [np.asarray(table[name].to_numpy(), float) for name in ("time_s", *names)]
    values = np.column_stack(columns)
    if not values.size or not np.isfinite(values).all():
        raise ValueError("the states are no finite numbers")
    revolution = table["revolution"].to_numpy()
    if revolution.dtype.kind != "i":  # an empty cell makes them floats
        raise ValueError("the revolutions are no integers")
    # Earlier files have the seconds of each revolution too.
    known = np.array([row[:2] for row in counts], dtype=np.float64).reshape(-1, 2)
    return StepHistory(
        time=columns[0],
        values=values[:, 1:],
        in_contact=np.asarray(table["in_contact"].to_numpy(), bool),
        impact_rate=np.asarray(table["impact_rate_m_per_s"].to_numpy(), float),
        revolution=revolution.astype(np.int32),
        counts=np.insert(known, 2, np.nan, axis=1),
    )
