"""What users see, as plain values for tests/golden: names, keys, columns, numbers of laws."""

import importlib
import inspect
import json
import operator
import os
import re
from pathlib import Path

import numpy as np
import pandas as pd

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.bodies.pair import CONTACTS

ROOT = Path(__file__).parents[2]
FOLDER = Path(__file__).parents[1] / "golden"
COUNT, SEED = 40, 2015
COLUMNS = ("depth", "load", "stiffness", "penetration")
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


def _text(value, indent=0):
    """Return JSON, a line for each entry, and for each text of a list that is long."""
    pad, end = " " * (indent + 1), " " * indent
    line = json.dumps(value, ensure_ascii=False)
    if isinstance(value, dict) and len(line) > 100:
        lines = [f"{pad}{_text(key)}: {_text(item, indent + 1)}" for key, item in value.items()]
        return "{\n" + ",\n".join(lines) + f"\n{end}}}"
    if isinstance(value, list) and len(line) > 100 and {type(item) for item in value} == {str}:
        lines = [pad + _text(item) for item in value]
        return "[\n" + ",\n".join(lines) + f"\n{end}]"
    return line


# --- names --------------------------------------------------------------------------------------


def public_face():
    """Return each public name with its signature, or what it is."""
    faces = ["cylcontact"]
    for face in faces:
        module = _thing(face)
        faces += [f"{face}.{n}" for n in _names(module) if inspect.ismodule(getattr(module, n))]
    pages = sorted((ROOT / "docs/reference").glob("*.md"))
    documented = re.findall(r"^::: (\S+)", "".join(p.read_text("utf-8") for p in pages), re.M)
    names, met, modules = {}, {}, []
    for path in dict.fromkeys([*faces, *sorted(documented)]):
        thing = _thing(path)
        if not inspect.ismodule(thing):
            _describe(path, thing, names, met)
            continue
        modules.append(thing)  # which may have been met under another name
        for name in _names(thing) if modules.count(thing) == 1 else ():
            _describe(f"{path}.{name}", getattr(thing, name), names, met)
    return dict(sorted(names.items()))


def _thing(path):
    """Return the module, or the member of a module, of a dotted path."""
    try:
        return importlib.import_module(path)
    except ModuleNotFoundError:
        module, _, name = path.rpartition(".")
        return getattr(importlib.import_module(module), name)


def _names(module):
    """Return what a module exports, or without `__all__` its classes, functions and constants."""
    homes = {n: getattr(v, "__module__", None) for n, v in vars(module).items() if n[0] != "_"}
    own = [n for n, home in homes.items() if home == (None if n.isupper() else module.__name__)]
    return getattr(module, "__all__", own)


def _describe(path, thing, names, met):
    """Add a name, and if it is a class its members, unless another path has led there."""
    if id(thing) in met and callable(thing):
        names.setdefault(path, f"= {met[id(thing)]}")
        return
    met[id(thing)] = path
    names[path] = _signature(thing) if callable(thing) else type(thing).__name__
    if not inspect.isclass(thing):
        return
    for name in dir(thing):
        homes = [c for c in thing.__mro__ if name in vars(c)]
        if not name.startswith("_") and homes[0].__module__.startswith("cylcontact"):
            member = inspect.getattr_static(thing, name)
            if isinstance(member, staticmethod | classmethod) or inspect.isfunction(member):
                names[f"{path}.{name}"] = _signature(getattr(thing, name))
            else:
                names[f"{path}.{name}"] = "attribute"


def _signature(thing):
    """Return names, kinds and defaults of the arguments; types are for mypy."""
    try:
        signature = inspect.signature(thing)
    except (TypeError, ValueError):
        return "callable"
    bare = [p.replace(annotation=p.empty) for p in signature.parameters.values()]
    text = str(signature.replace(parameters=bare, return_annotation=signature.empty))
    return re.sub(r" at 0x[0-9a-f]+", "", text).replace(str(ROOT), "")


# --- files that commands write ------------------------------------------------------------------


def outline(path):
    """Return the nested keys of a JSON file, the columns of a table, or None."""
    if path.suffix == ".json":
        document = json.loads(path.read_text("utf-8"))
        return sorted(set(_keys(document, set(document.get("coefficients", ())))))
    if path.suffix in {".csv", ".parquet"}:
        csv = path.suffix == ".csv"
        return list((pd.read_csv(path, comment="#") if csv else pd.read_parquet(path)).columns)
    return None


def _keys(value, coefficients, path=""):
    """Yield the path of every key, with [] for elements and * for names of coefficients."""
    if isinstance(value, dict):
        for key, inner in value.items():
            here = f"{path}.{'*' if key in coefficients else key}".lstrip(".")
            yield here
            yield from _keys(inner, coefficients, here)
    elif isinstance(value, list):
        for inner in value:
            yield from _keys(inner, coefficients, f"{path}[]")


def committed_results():
    """Return coefficients and objectives of the committed results."""
    digest = {}
    for path in sorted((ROOT / "fitting/results").glob("*.json")):
        result = json.loads(path.read_text("utf-8"))
        numbers = result["coefficients"] | {
            result["objective"]["name"]: result["objective"]["value"],
            "bound": result.get("bound"),
            "samples": result["counts"]["samples"],
        }
        digest |= {f"{path.stem}: {name}": number for name, number in numbers.items()}
    return digest


def keys_of_results():
    """Return the nested keys of the committed results, and which results have a key."""
    outlines = {p.stem: outline(p) for p in sorted((ROOT / "fitting/results").glob("*.json"))}
    having = {key: set() for keys in outlines.values() for key in keys}
    for name, keys in outlines.items():
        for key in keys:
            having[key].add(name)
    return {key: _which(names, set(outlines)) for key, names in sorted(having.items())}


def _which(names, every):
    """Return which names they are of all, as shortly as may be."""
    without = f"all but {' '.join(sorted(every - names))}" if every - names else "all"
    return min(without, " ".join(sorted(names)), key=len)


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
    """Return seeded pairs; to six digits, the same on every machine."""
    rng = np.random.default_rng(SEED)
    for i in range(COUNT):
        E, other_E = np.exp(rng.uniform(np.log(2e3), np.log(6e5), 2))
        nu, other_nu = rng.uniform(0.2, 0.48, 2)
        R, other_R, length = rng.uniform([5, 5, 1], [50, 50, 30])
        gap = np.exp(rng.uniform(np.log(1e-4), np.log(0.3)))
        inner = R * (1 - gap)
        R, inner, other_R, length = (float(f"{x:.6g}") for x in (R, inner, other_R, length))
        body = Material("i", E=float(f"{E:.6g}"), nu=float(f"{nu:.6g}"))
        other = Material("j", E=float(f"{other_E:.6g}"), nu=float(f"{other_nu:.6g}"))
        second = other if i % 4 == 3 else body  # a quarter of unlike bodies
        plane = "stress" if i % 5 == 4 else "strain"
        if contact == "internal":
            yield CylinderPair.internal(R, inner, body, length, second, plane=plane)
        else:
            yield CylinderPair.external(R, other_R, body, length, second, plane=plane)


def law_values(name):
    """Return penetrations inside a law's domain, load, stiffness and the penetration back."""
    law, every = named_laws()[name], {}
    rng = np.random.default_rng(SEED + 1)
    shares = np.exp(rng.uniform(np.log(1e-6), np.log(0.9), COUNT))
    for contact in CONTACTS:
        rows = [_row(law, *each) for each in zip(law_pairs(contact), shares, strict=True)]
        columns = dict(zip(COLUMNS, map(list, zip(*rows, strict=True)), strict=True))
        refused = set(columns["load"]) == {"refused"}
        every[f"{name}, {contact}"] = "refused" if refused else columns
    return every


def _row(law, pair, share):
    """Return the values at a share of the law's reach, as words where there are none."""
    try:
        depth = float(f"{share * min(float(law.max_penetration(pair)), float(pair.dR)):.6g}")
        load = law.load(depth, pair)
        values = depth, load, law.stiffness(depth, pair), law.penetration(load, pair)
    except InputError:
        return ["refused"] * 4
    return [float(value) if np.isfinite(value) else str(value) for value in values]
