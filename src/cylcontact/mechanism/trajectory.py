"""Trajectories: the accepted steps of a simulation, derived quantities, Parquet files and text."""

from __future__ import annotations

import itertools
import json
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.files.provenance import made_with
from cylcontact.files.reading import marked, require_file, unmarked
from cylcontact.files.writing import replacing, require_parquet
from cylcontact.mechanism.joint_motion import JointMotion, Motion, numbers_of
from cylcontact.mechanism.linkage import largest_gaps, linkage_of
from cylcontact.mechanism.model import Mechanism, Spring, mechanism_from
from cylcontact.mechanism.run import (
    LEDGERS,
    Run,
    RunError,
    Settings,
    State,
    StepHistory,
    concatenate,
    settings_for,
)
from cylcontact.mechanism.statistics import Statistics, described
from cylcontact.support.arrays import FloatArray, as_floats
from cylcontact.support.choices import Beyond, Method
from cylcontact.support.errors import InputError
from cylcontact.support.html_repr import table_html
from cylcontact.support.progress import Progress, silent

if TYPE_CHECKING:
    import pandas as pd

    from cylcontact.plots import Drawing

# The key of the schema's metadata with everything but the states.
_METADATA = b"cylcontact.trajectory"
_LIBRARIES = ("numpy", "numba", "pyarrow")


def _of_the_joint(name: str) -> Any:
    """Return a property of the one joint with clearance."""
    return property(lambda run: getattr(run.joint, name), doc=getattr(JointMotion, name).__doc__)


def _over_joints(name: str, about: str) -> Any:
    """Return a property that is the sum of those of the joints."""

    def total(run: Trajectory) -> FloatArray:
        parts = [getattr(joint, name) for joint in run.joints.values()]
        return as_floats(sum(parts, np.zeros_like(run.time)))

    return property(total, doc=about)


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory(Motion):
    """The motion of a mechanism over whole revolutions.

    Every array has one element or row for each of the n accepted steps of the integrator, in SI
    units: m, s, rad, N, J. An onset or release of contact has two rows at the same time, one in
    each mode. `joints` has what concerns each joint with clearance, by its name; of a mechanism
    with one, the run itself has the same under the same names.

    Parameters
    ----------
    mechanism : Mechanism
        The mechanism.
    settings : Settings
        Method, tolerance, longest step in s, and continuation beyond the law's domain.
    rows : StepHistory
        The steps as returned by the integrator.
    """

    @cached_property
    def joints(self) -> dict[str, JointMotion]:
        """The joints with clearance, by name."""
        # Not of this run itself: in a circle with its joints, it would outlive its use.
        motion = Motion(self.mechanism, self.settings, self.rows)
        motion.__dict__["_motion"] = self._motion
        joints = enumerate(self.mechanism.clearances)
        return {joint.name: JointMotion(motion, number, joint) for number, joint in joints}

    @property
    def joint(self) -> JointMotion:
        """The one joint with clearance; an `InputError` unless there is one."""
        return self.joints[self.mechanism.clearance.name]

    in_contact = _of_the_joint("in_contact")
    impact_rate = _of_the_joint("impact_rate")
    eccentricity = _of_the_joint("eccentricity")
    eccentricity_rate = _of_the_joint("eccentricity_rate")
    penetration = _of_the_joint("penetration")
    penetration_rate = _of_the_joint("penetration_rate")
    force = _of_the_joint("force")
    normal_force = _of_the_joint("normal_force")
    friction_force = _of_the_joint("friction_force")
    tangential_velocity = _of_the_joint("tangential_velocity")
    flag = _of_the_joint("flag")
    contacts = _of_the_joint("contacts")
    max_elastic_load = _of_the_joint("max_elastic_load")
    limits = _of_the_joint("limits")

    @property
    def revolutions(self) -> int:
        """The number of complete revolutions."""
        return int(self.rows.counts.shape[0])

    @property
    def end(self) -> State:
        """The last state, from which a run can be resumed."""
        return self.rows.end

    @property
    def drive_work(self) -> FloatArray:
        """Work of the drivers since the start in J, shape (n,)."""
        return self.rows.ledgers[:, LEDGERS.index("drive_work")]

    @property
    def damping(self) -> FloatArray:
        """Energy dissipated by dampers since the start in J, shape (n,)."""
        return self.rows.ledgers[:, LEDGERS.index("damping")]

    normal_dissipation = _over_joints(
        "normal_dissipation", "Energy dissipated by the normal forces since the start in J, (n,)."
    )
    friction_dissipation = _over_joints(
        "friction_dissipation",
        "Energy dissipated by all friction since the start in J, shape (n,).",
    )
    elastic_energy = _over_joints(
        "elastic_energy", "Energy stored in the contacts of all joints in J, shape (n,)."
    )

    @cached_property
    def kinetic_energy(self) -> FloatArray:
        """Kinetic energy of all bodies in J, shape (n,)."""
        mass = np.array([[b.mass, b.mass, b.inertia] for b in self.mechanism.bodies]).ravel()
        return as_floats(0.5 * (self._motion[1] ** 2) @ mass)

    @cached_property
    def potential_energy(self) -> FloatArray:
        """Potential energy of gravity, constant loads and springs in J, shape (n,)."""
        q, gravity = self._motion[0], self.mechanism.gravity
        weight = np.array([b.mass * g for b in self.mechanism.bodies for g in (*gravity, 0.0)])
        energy = -q @ weight
        for load in self.mechanism.loads:
            at = self.point(load.body, load.point)[0]
            angle = q[:, 3 * load.body + 2] if load.body >= 0 else 0.0
            energy = energy - at @ load.force - load.moment * angle
        for spring in self.mechanism.springs:
            energy = energy + 0.5 * spring.stiffness * self._stretch(spring) ** 2
        return as_floats(energy)

    def _stretch(self, spring: Spring) -> FloatArray:
        """Return how far a spring is from where it has no force, in m or rad."""
        if spring.turning:
            angle = np.column_stack((self.coordinates[:, :, 2], np.zeros_like(self.time)))
            return as_floats(angle[:, spring.j] - angle[:, spring.i] - spring.rest)
        ends = self.point(spring.i, spring.point_i)[0], self.point(spring.j, spring.point_j)[0]
        return as_floats(np.hypot(*(ends[1] - ends[0]).T) - spring.rest)

    @cached_property
    def energy(self) -> FloatArray:
        """Energy stored and dissipated minus the drivers' work, which is constant, in J, (n,)."""
        stored = self.kinetic_energy + self.potential_energy + self.elastic_energy
        lost = self.normal_dissipation + self.friction_dissipation + self.damping
        return as_floats(stored + lost - self.drive_work)

    @property
    def energy_error(self) -> FloatArray:
        """`energy` minus its value at the start in J, shape (n,)."""
        return as_floats(self.energy - self.energy[0])

    @cached_property
    def drift(self) -> FloatArray:
        """The largest |Φ| (m, rad) and |dΦ/dt| of the joints' constraints, shape (n, 2)."""
        q, v = map(np.ascontiguousarray, self._motion)
        gaps = np.zeros((self.time.size, 2))
        largest_gaps(self.time, q, v, linkage_of(self.mechanism), gaps)
        return gaps

    @property
    def counts(self) -> pd.DataFrame:
        """Accepted steps, evaluations and seconds (NaN from a file), a row for each revolution."""
        import pandas as pd

        table = pd.DataFrame(self.rows.counts, columns=["steps", "evaluations", "seconds"])
        return table.astype({"steps": int, "evaluations": int})

    @property
    def warnings(self) -> tuple[str, ...]:
        """A sentence for each thing to be wary of; see `Statistics.warnings`."""
        return self.statistics().warnings

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What is assumed, with the continuation of a law if there was one."""
        return self.statistics().assumptions

    def taken(self, rows: slice, index: int) -> Trajectory:
        """Return some rows and the counts of a revolution, as a trajectory."""
        return replace(self, rows=self.rows.taken(rows, index))

    @cached_property
    def _revolutions(self) -> pd.DataFrame:
        """The rows of `Statistics.revolutions`."""
        import pandas as pd

        starts = np.searchsorted(self.rows.revolution, np.arange(self.revolutions + 1))
        origin = float(self.taken(slice(1), 0).energy[0])
        # From the last row of the previous revolution.
        spans = [slice(max(a - 1, 0), b) for a, b in itertools.pairwise(starts.tolist())]
        records = [reduced(self.taken(span, k), origin) for k, span in enumerate(spans)]
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
        limits = {name: joint.limits for name, joint in self.joints.items()}
        return Statistics(self._revolutions, self.mechanism, self.settings, self.end, limits, first)

    def save(self, path: Path | str) -> None:
        """Write to a Parquet file, with the spec, the settings and the provenance.

        One column for each state, and for the contact and δ̇⁽⁻⁾ of each joint under its name; the
        rest is in the schema's metadata. The same run gives the same bytes.
        """
        pa = require_parquet(path)
        rows, mechanism = self.rows, self.mechanism
        columns: dict[str, Any] = {"time_s": rows.time, "revolution": rows.revolution}
        for name, joint in self.joints.items():
            columns[f"{name}.in_contact"] = joint.in_contact
            columns[f"{name}.impact_rate_m_per_s"] = joint.impact_rate
        columns |= {f"state_{k}": column.copy() for k, column in enumerate(rows.values.T)}
        origin = Path(mechanism.source).parent
        metadata = {
            "spec": mechanism.data,
            "source": mechanism.source,
            "settings": asdict(self.settings),
            "counts": rows.counts[:, :2].tolist(),  # times would differ from run to run
            "assumptions": mechanism.assumptions,
            "provenance": made_with(origin, {"mechanism": mechanism.data}, _LIBRARIES),
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
            table = pa.parquet.ParquetFile(path).read()
            metadata = dict(json.loads((table.schema.metadata or {})[_METADATA]))
            metadata = unmarked(metadata, str(path))
            settings = Settings(**metadata["settings"])
            mechanism = mechanism_from(metadata["spec"], str(metadata["source"]))
            names = [joint.name for joint in mechanism.clearances]
            return cls(mechanism, settings, _rows_of(table, metadata["counts"], names))
        except InputError:
            raise
        except (OSError, pa.ArrowInvalid) as error:
            reason = getattr(error, "strerror", None) or "not a Parquet file"
            rule, remedy = f"cannot be read ({reason})", "check the path"
        except (KeyError, ValueError, TypeError, AttributeError, pa.ArrowException):
            rule, remedy = "holds no trajectory", "give what simulate -o has written"
        raise InputError(str(path), "", None, rule, remedy)

    def plot(self, revolutions: float = 2.0, joint: str | None = None) -> Drawing:
        """Draw the path of a pin's centre in its bearing, and the force in the joint.

        Parameters
        ----------
        revolutions : float, optional
            How many are drawn, from the end.
        joint : str, optional
            Its name, where several have a clearance.

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

        return joint_drawing(self.joint if joint is None else self.joints[joint], revolutions)

    def __str__(self) -> str:
        return described(f"Trajectory of {self.mechanism.name!r}", self.statistics().summary)

    def __repr__(self) -> str:
        return (
            f"Trajectory({self.mechanism.name!r}, revolutions={self.revolutions}, "
            f"rows={self.time.size}, end={self.time[-1]:.6g} s)"
        )

    def _repr_html_(self) -> str:
        rows = {"duration (s)": self.time[-1] - self.time[0], **self.statistics().summary}
        pictures = [self.plot(joint=name)._repr_html_() for name in self.joints]
        return table_html(f"Trajectory of {self.mechanism.name}", rows) + "".join(pictures)


def reduced(run: Trajectory, origin: float) -> dict[str, Any]:
    """Return the row of `Statistics.revolutions` for one revolution, and the step before it.

    `origin` is the `energy` at the start of the whole run in J.
    """
    row: dict[str, Any] = {}
    for name, joint in run.joints.items():
        prefix = f"{name}." if len(run.joints) > 1 else ""
        row |= {f"{prefix}{key}": value for key, value in numbers_of(joint).items()}
    end = run.taken(slice(-1, None), 0)
    steps, evaluations, seconds = run.rows.counts[0]
    row["drive_work_J"] = float(run.drive_work[-1] - run.drive_work[0])
    if run.mechanism.springs:
        row["damping_J"] = float(run.damping[-1] - run.damping[0])
    return row | {
        "steps": int(steps),
        "evaluations": int(evaluations),
        "seconds": float(seconds),
        "kinetic_energy_J": float(run.kinetic_energy.max()),
        "energy_error_J": float(end.energy[0]) - origin,
        "drift": np.nan if run.settings.method == "minimal" else float(end.drift[0, 0]),
    }


def _rows_of(table: Any, counts: Any, joints: list[str]) -> StepHistory:
    """Return the rows that a table holds; an error of Python's if a column is missing or odd."""
    names = [name for name in table.column_names if name.startswith("state_")]
    time, *states = (np.asarray(table[name].to_numpy(), float) for name in ("time_s", *names))
    values, revolution = np.column_stack(states), table["revolution"].to_numpy()
    if not values.size or not (np.isfinite(values).all() and np.isfinite(time).all()):
        raise ValueError("the states are no finite numbers")

    def of_joints(column: str, kind: type) -> Any:
        parts = [table[f"{name}.{column}"].to_numpy() for name in joints]
        return np.array(parts, kind).T.reshape(time.size, len(joints)).copy()

    known = np.array([row[:2] for row in counts], dtype=np.float64).reshape(-1, 2)
    touching, rates = of_joints("in_contact", bool), of_joints("impact_rate_m_per_s", float)
    known = np.insert(known, 2, np.nan, axis=1)
    return StepHistory(time, values, touching, rates, revolution.astype(np.int32), known)


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run, with what the complete revolutions give; None before the first one.

    `simulate` leaves a `trajectory`, `long_run` leaves `statistics`.
    """

    def __init__(
        self, trajectory: Trajectory | None = None, statistics: Statistics | None = None
    ) -> None:
        super().__init__()
        self.trajectory = trajectory
        self.statistics = statistics


def simulate(
    mechanism: Mechanism,
    method: Method | None = None,
    revolutions: int | None = None,
    tolerance: float | None = None,
    beyond: Beyond = "stop",
    progress: Progress = silent,
    resume: Trajectory | None = None,
    allowed_penetration: float | None = None,
) -> Trajectory:
    """Simulate a mechanism.

    Parameters
    ----------
    mechanism : Mechanism
        The mechanism; see `read_mechanism`.
    method : {"minimal", "multiplier"}, optional
        The equations of motion: minimal coordinates, for a slider-crank at constant speed with a
        clearance between rod and slider, and none or one between crank and rod; or multipliers,
        for any mechanism. By default minimal coordinates if they apply.
    revolutions : int, optional
        Total number of revolutions of the driver; by default that of the spec.
    tolerance : float, optional
        By default that of the spec.
    beyond : {"stop", "tangent"}
        What to do at the end of a contact law: stop with an error, or continue along the
        tangent at nine tenths of the law's largest penetration. The trajectory records which.
    progress : callable, optional
        Called with a stage, the number of revolutions done and their total.
    resume : Trajectory, optional
        An earlier trajectory to continue. Its mechanism and settings are used, and of the other
        arguments only `revolutions` and `progress`. The result equals that of an uninterrupted
        run to the bit.
    allowed_penetration : float, optional
        The paper's step control, for comparison: instead of locating the onset of a contact, the
        step is halved until the penetration at the onset is at most this, in m.

    Returns
    -------
    Trajectory
        Whole revolutions.

    Raises
    ------
    InputError
        If the mechanism cannot be assembled, a law is undefined for its joint, a penetration
        leaves the domain of its law (`LawDomainError`, with time, penetration and limit) or the
        steps collapse. The last two are a `RunError`, with the complete revolutions.
    Interrupted
        After Ctrl-C, with the complete revolutions.

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism
    >>> mechanism = read_mechanism("datasets/slider_crank.toml", clearance=0.02)
    >>> run = simulate(mechanism, revolutions=1)
    >>> print(f"{run.penetration.max() * 1e6:.1f} µm")
    10.3 µm
    """
    if resume is None:
        settings = settings_for(mechanism, method, tolerance, beyond, allowed_penetration)
        run, first = Run.start(mechanism, settings), 0
        parts = [StepHistory.of(run.state)]
    else:
        mechanism, settings, first = resume.mechanism, resume.settings, resume.revolutions
        run, parts = Run.start(mechanism, settings, resume.end), [resume.rows]
    total = mechanism.integration.revolutions if revolutions is None else revolutions
    try:
        for rows in run.revolutions(total, progress, first):
            parts.append(rows)
    except (KeyboardInterrupt, RunError) as error:
        done = concatenate(parts)
        complete = Trajectory(mechanism, settings, done) if done.counts.size else None
        if isinstance(error, RunError):
            error.trajectory = complete
            raise
        raise Interrupted(complete) from None
    return Trajectory(mechanism, settings, concatenate(parts))
