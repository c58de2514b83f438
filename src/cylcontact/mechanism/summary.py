"""A run in a few lines, and its contacts one by one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.mechanism.derived import changes

if TYPE_CHECKING:
    import pandas as pd

    from cylcontact.mechanism.trajectory import Trajectory


def entries(run: Trajectory) -> dict[str, Any]:
    """Return what a run shows of itself, by name."""
    clearance = run.mechanism.data["clearance"]
    begins, _ = changes(run.in_contact)
    return {
        "law": clearance["law"],
        "clearance (mm)": clearance["radial"],
        "restitution": clearance["restitution"],
        "friction": clearance["friction"],
        "method": run.settings.method,
        "tolerance": run.settings.tolerance,
        "revolutions": run.revolutions,
        "steps": run.time.size,
        "contacts": begins.size,
        "max penetration (µm)": round(float(run.penetration.max()) * 1e6, 3),
        "energy error (J)": float(f"{np.abs(run.energy_error).max():.3g}"),
        "drift (m, rad)": float(f"{run.drift[:, 0].max():.3g}"),
        **({"beyond the law": run.settings.beyond} if run.continuation else {}),
    }


def counts(run: Trajectory) -> pd.DataFrame:
    """Return the counters by revolution; see `Trajectory.counts`."""
    import pandas as pd

    table = pd.DataFrame(run.rows.counts, columns=["steps", "evaluations", "seconds"])
    return table.astype({"steps": int, "evaluations": int})


def contacts(run: Trajectory) -> pd.DataFrame:
    """Return one row for each contact; see `Trajectory.contacts`."""
    import pandas as pd

    begins, ends = changes(run.in_contact)
    last = np.append(ends, run.time.size - 1)[: begins.size]
    spans = [slice(a, b + 1) for a, b in zip(begins, last, strict=True)]
    release = np.full(begins.size, np.nan)
    release[: ends.size] = run.time[ends]
    return pd.DataFrame(
        {
            "onset_s": run.time[begins],
            "release_s": release,
            "impact_rate_m_per_s": run.rows.impact_rate[begins],
            "max_penetration_m": [run.penetration[span].max() for span in spans],
            "max_force_N": [run.normal_force[span].max() for span in spans],
        }
    )


def continuation(run: Trajectory, limit: float) -> tuple[str, ...]:
    """Say how the law went on beyond a penetration in m; nothing where it did not have to."""
    if run.settings.beyond == "stop" or not np.isfinite(limit) or not run.in_contact.any():
        return ()
    deepest = float(run.penetration[run.in_contact].max())
    if deepest <= limit:
        return ()
    share = float(np.mean(run.penetration[run.in_contact] > limit))
    return (
        f"beyond {limit * 1e6:.4g} µm the law goes on along its tangent, up to "
        f"{deepest * 1e6:.4g} µm and in {share:.2%} of the steps in contact",
    )
