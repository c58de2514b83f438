"""Trajectories as Parquet files: a column for every state, the rest in the schema's metadata."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from cylcontact.errors import InputError
from cylcontact.files import replacing
from cylcontact.mechanism.model import Mechanism, mechanism_from
from cylcontact.mechanism.step_history import Settings, StepHistory
from cylcontact.provenance import made_with

METADATA = b"cylcontact.trajectory"
LIBRARIES = ("numpy", "numba", "scikit-sundae", "pyarrow")


def save(mechanism: Mechanism, settings: Settings, rows: StepHistory, path: Path | str) -> None:
    """Write a trajectory; see `Trajectory.save`."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns: dict[str, Any] = {
        "time_s": rows.time,
        "in_contact": rows.in_contact,
        "impact_rate_m_per_s": rows.impact_rate,
        "revolution": rows.revolution,
    }
    columns |= {
        f"state_{k}": np.ascontiguousarray(rows.values[:, k]) for k in range(rows.values.shape[1])
    }
    about = {
        "spec": mechanism.data,
        "source": mechanism.source,
        "settings": asdict(settings),
        "counts": rows.counts.tolist(),
        "assumptions": mechanism.assumptions,
        "provenance": made_with(
            Path(mechanism.source).parent, {"mechanism": mechanism.data}, LIBRARIES
        ),
    }
    table = pa.table(columns).replace_schema_metadata({METADATA: json.dumps(about)})
    with replacing(path) as temporary:
        pq.write_table(table, temporary, compression="zstd")


def load(path: Path | str) -> tuple[Mechanism, Settings, StepHistory]:
    """Read a trajectory's parts; see `Trajectory.load`."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        table = pq.read_table(path)
        about = json.loads((table.schema.metadata or {})[METADATA])
    except (OSError, pa.ArrowException) as error:
        reason = getattr(error, "strerror", None) or "not a Parquet file"
        raise InputError(
            str(path), "", None, f"cannot be read ({reason})", "check the path"
        ) from error
    except (KeyError, ValueError) as error:
        raise InputError(
            str(path), "", None, "holds no trajectory", "give what simulate -o has written"
        ) from error
    states = [name for name in table.column_names if name.startswith("state_")]
    rows = StepHistory(
        time=table["time_s"].to_numpy(),
        values=np.column_stack([table[name].to_numpy() for name in states]),
        in_contact=table["in_contact"].to_numpy(),
        impact_rate=table["impact_rate_m_per_s"].to_numpy(),
        revolution=table["revolution"].to_numpy(),
        counts=np.array(about["counts"], dtype=np.float64).reshape(-1, 3),
    )
    mechanism = mechanism_from(about["spec"], about["source"])
    return mechanism, Settings(**about["settings"]), rows
