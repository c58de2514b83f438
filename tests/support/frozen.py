"""What users see, as plain values for tests/golden: files and figures."""

import json
import operator
import os
from pathlib import Path

import pandas as pd

ROOT = Path(__file__).parents[2]
FOLDER = Path(__file__).parents[1] / "golden"


# --- files --------------------------------------------------------------------------------------


def frozen(name):
    """Return what a golden file holds."""
    path = FOLDER / f"{name}.json"
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def close(tolerance):
    """Return a comparison of nested numbers and words, up to a relative difference."""

    def same(was, now):
        if isinstance(was, dict):
            return was.keys() == now.keys() and all(same(was[key], now[key]) for key in was)
        if isinstance(was, list | tuple) and len(was) == len(now):
            return all(same(one, other) for one, other in zip(was, now, strict=True))
        if str in (type(was), type(now)) or None in (was, now):
            return was == now
        return abs(now - was) <= tolerance * abs(was)

    return same


def hold(name, now, same=operator.eq, part=bool):
    """Hold values against the entries of a golden file, those whose keys `part` takes.

    With WRITE_GOLDEN in the environment they are written anew.
    """
    every = frozen(name)
    was = {key: value for key, value in every.items() if part(key)}
    if os.environ.get("WRITE_GOLDEN"):
        kept = {key: value for key, value in every.items() if key not in was}
        text = _text(dict(sorted({**kept, **now}.items()))) + "\n"
        FOLDER.joinpath(f"{name}.json").write_text(text, encoding="utf-8")
        return
    changed = [
        f"{key}: {was.get(key, 'absent')} -> {now.get(key, 'absent')}"
        for key in sorted(was.keys() | now.keys())
        if key not in was or key not in now or not same(was[key], now[key])
    ]
    assert not changed, "\n".join([f"{name}.json", *changed])


def _text(entries):
    """Return JSON with a line for each entry."""
    lines = (f" {json.dumps(k)}: {json.dumps(v, ensure_ascii=False)}" for k, v in entries.items())
    return "{\n" + ",\n".join(lines) + "\n}"


# --- files that commands write ------------------------------------------------------------------


def outline(path):
    """Return the columns of a table, the top keys of a JSON file, or nothing, in one line."""
    if path.suffix == ".json":
        return " ".join(sorted(json.loads(path.read_text("utf-8"))))
    if path.suffix == ".parquet":
        return " ".join(pd.read_parquet(path).columns)
    return " ".join(pd.read_csv(path, comment="#").columns) if path.suffix == ".csv" else ""


def summary(table):
    """Return rows, and of each column smallest, largest and mean, or its words."""
    columns = {
        name: [float(f"{value:.6g}") for value in (column.min(), column.max(), column.mean())]
        if pd.api.types.is_numeric_dtype(column) and column.dtype != bool
        else sorted({str(word) for word in column})[:20]
        for name, column in table.items()
    }
    return {"rows": len(table), **columns}
