"""What users see, as plain values for tests/golden: files, results, figures, loads of laws."""

import json
import operator
import os
from pathlib import Path

import numpy as np
import pandas as pd

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.bodies.pair import CONTACTS

ROOT = Path(__file__).parents[2]
FOLDER = Path(__file__).parents[1] / "golden"
COUNT, SEED, SHARES = 3, 2015, (1e-5, 0.01, 0.5)
# Laws with coefficients of one's own, beside those that have a name.
OWN = {
    "power K": laws.PowerLaw(n=1.2, K=3e5),
    "power K_star": laws.PowerLaw(n=0.9, K_star=0.3),
    "power C": laws.PowerLaw(n=1.0848, C=0.58),
    "power by clearance": laws.PowerClearance(0.88, 0.72, 1.13, -0.02, 0.01, 0.001),
    "enhanced refitted": laws.Enhanced({"a": 0.4, "b": 1.05, "n": 1.09}),
    "explicit own": laws.Explicit({"c": 1.4, "A": 0.36, "B": 3.0}),
    "conformal clamped": laws.Conformal(laws.Housing(R_o=500.0)),
}


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


def committed_results():
    """Return coefficients and objectives of the committed results."""
    digest = {}
    for path in sorted((ROOT / "fitting/results").glob("*.json")):
        result = json.loads(path.read_text("utf-8"))
        numbers = {name: each["value"] for name, each in result["estimates"].items()} | {
            result["objective"]["name"]: result["objective"]["value"],
            "bound": result.get("bound"),
            "samples": result["counts"]["samples"],
        }
        digest |= {f"{path.stem}: {name}": number for name, number in numbers.items()}
    return digest


def summary(table):
    """Return rows, and of each column smallest, largest and mean, or its words."""
    columns = {
        name: [float(f"{value:.6g}") for value in (column.min(), column.max(), column.mean())]
        if pd.api.types.is_numeric_dtype(column) and column.dtype != bool
        else sorted({str(word) for word in column})[:20]
        for name, column in table.items()
    }
    return {"rows": len(table), **columns}


# --- laws ---------------------------------------------------------------------------------------


def named_laws():
    """Return every law with a name, and those of one's own."""
    return {name: law() for name, law in laws.LAWS.items()} | OWN


def law_pairs(contact):
    """Yield seeded pairs; to six digits, the same on every machine. The last has unlike bodies."""
    rng = np.random.default_rng(SEED)
    for i in range(COUNT):
        E, nu, R, R_j, gap = rng.uniform([2e3, 0.2, 5, 5, 1e-4], [6e5, 0.48, 50, 50, 0.3])
        E, nu, R, R_j, inner = (float(f"{x:.6g}") for x in (E, nu, R, R_j, R * (1 - gap)))
        body, plane = Material("i", E=E, nu=nu), "stress" if i == 1 else "strain"
        other = Material("j", E=207e3, nu=0.3) if i == COUNT - 1 else body
        if contact == "internal":
            yield CylinderPair.internal(R, inner, body, 20.0, other, plane=plane)
        else:
            yield CylinderPair.external(R, R_j, body, 20.0, other, plane=plane)


def law_values(name):
    """Return the loads of a law, to nine digits, at shares of its largest penetration."""
    law, every = named_laws()[name], {}
    for contact in CONTACTS:
        cases = zip(law_pairs(contact), SHARES, strict=True)
        loads = [_load(law, pair, share) for pair, share in cases]
        every[f"{name}, {contact}"] = loads
    return every


def _load(law, pair, share):
    try:
        depth = float(f"{share * min(float(law.max_penetration(pair)), float(pair.dR)):.6g}")
        return float(f"{law.load(depth, pair):.9g}")
    except InputError:
        return "refused"
