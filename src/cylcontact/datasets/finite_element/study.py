"""Files of set-ups, their solutions in parallel, and the tables of these.

A table is CSV below lines "# KEY: VALUE" with the version of the format, the study, a hash of its
set-up file, what solved it, the calibrated constant, and a hash of the rows, which a table edited
by hand does not match.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field, model_validator

from cylcontact.bodies.material_spec import Modulus
from cylcontact.datasets.finite_element.mesh import Setup, SetupKeys
from cylcontact.datasets.finite_element.solver import solve
from cylcontact.files.journal import Journal, run_recorded
from cylcontact.files.provenance import spec_hash
from cylcontact.files.reading import marked, read_text, unmarked
from cylcontact.files.spec import broken, parse_spec, read_toml
from cylcontact.files.writing import replacing
from cylcontact.laws import Johnson
from cylcontact.support.arrays import on_one_thread, require
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import call
from cylcontact.support.progress import Progress, silent

if TYPE_CHECKING:
    import pandas as pd

Origin = Literal["paper", "derived", "assumed"]
# A case in its study: variant, clearance in mm and load in N/mm. Its row, or why there is none.
_Case = tuple[str, float, float]
_Result = dict[str, str | float] | str

COLUMNS = (
    *("variant", "E_GPa", "nu", "dR_mm", "load_N_per_mm", "penetration_mm", "half_width_mm"),
    *("peak_pressure_MPa", "hole_radius_mm", "outer_radius_mm", "cells"),
)
# After these, in tables of studies in which a pin has its own material.
PIN_COLUMNS = ("pin_E_GPa", "pin_nu")
_ALL_COLUMNS = (*COLUMNS, *PIN_COLUMNS)
_KEYS = ("study", "set-up", "engine", "calibrated", "sha256")


# --- files of set-ups ----------------------------------------------------------------------------


class StudySpec(SetupKeys):
    """A set-up file: one set-up, its clearances and loads, and variants of it."""

    E: Modulus = Field(gt=0, description='Young\'s modulus in GPa, or with its unit, "207 GPa"')
    pin_E: Modulus | None = Field(None, gt=0, description="the pin's Young's modulus, as E")
    dR: tuple[float, ...] = Field(strict=False, description="a list of clearances in mm")
    load: tuple[float, ...] = Field(strict=False, description="a list of loads in N/mm")
    origin: dict[str, Origin] = Field(
        description='a table [origin] that calls each key "paper", "derived" or "assumed"'
    )
    variants: tuple[dict[str, Any], ...] = Field(
        (), strict=False, description="tables [[variants]], each with name and the changed keys"
    )

    @model_validator(mode="after")
    def _check(self) -> StudySpec:
        for key in ("dR", "load"):
            values = getattr(self, key)
            if not values or min(values) <= 0 or any(b <= a for a, b in pairwise(values)):
                raise broken(
                    key, list(values), "must be positive and increasing", "sort it, drop repeats"
                )
        given = self.model_fields_set - {"origin", "variants"}
        for key in sorted(given ^ self.origin.keys()):
            rule = "is required" if key in given else "is not a key of this file"
            raise broken(f"origin.{key}", None, rule, "mark each key as paper, derived or assumed")
        try:
            self.setup().require_room(self.dR[-1])
        except InputError as error:
            raise broken(error.key, error.value, error.rule, error.remedy) from None
        return self

    def setup(self) -> Setup:
        """Return the set-up, without its variants."""
        keys = {name: getattr(self, name) for name in SetupKeys.model_fields}
        moduli = {key: f"{keys[key]!r} GPa" for key in ("E", "pin_E") if keys[key] is not None}
        return Setup(**keys | moduli)


@dataclass(frozen=True)
class Study:
    """A set-up with its variants, clearances and loads.

    Attributes
    ----------
    name : str
        The file's name without suffix.
    setups : dict
        Set-ups by the name of the variant; the set-up itself is "base".
    dR, load : tuple of float
        Clearances in mm and loads in N/mm.
    origin : dict
        "paper", "derived" or "assumed" for each key of the file.
    key : str
        A hash of the file's contents.
    source : str
        Its name in errors.
    """

    name: str
    setups: dict[str, Setup]
    dR: tuple[float, ...]
    load: tuple[float, ...]
    origin: dict[str, Origin]
    key: str
    source: str


def read_study(path: Path | str) -> Study:
    """Read a set-up file.

    Parameters
    ----------
    path : path
        A TOML file: the keys of `Setup`, E and pin_E in GPa, dR (mm), load (N/mm), a table origin,
        and tables variants.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        If the file is not a set-up.
    """
    return study_from(read_toml(path), Path(path).stem, str(path))


def study_from(data: dict[str, Any], name: str, source: str) -> Study:
    """Return the study described by the contents of a set-up file."""
    spec = parse_spec(StudySpec, data, source)
    setups = {"base": spec.setup()}
    for number, variant in enumerate(spec.variants):
        where, changes = f"{source}, variants.{number}", dict(variant)
        label = changes.pop("name", None)
        if not isinstance(label, str) or not label:
            raise InputError(where, "name", label, "is required", "give the variant a name")
        plain = label.isprintable() and not set(label) & set(',"#')
        rule = "must not contain commas, quotes or #"
        require(plain, where, "name", label, rule, "rename it")
        require(label not in setups, where, "name", label, "is used twice", "rename it")
        for key in [key for key in ("dR", "load", "origin", "variants") if key in changes]:
            raise InputError(where, key, changes[key], "cannot vary", "use a separate file")
        # The changes are our assumptions, even where the set-up has the paper's numbers.
        origin = data["origin"] | dict.fromkeys(changes, "assumed")
        whole = {**data, **changes, "variants": [], "origin": origin}
        setups[label] = parse_spec(StudySpec, whole, where).setup()
    return Study(name, setups, spec.dR, spec.load, dict(spec.origin), spec_hash(data), source)


# --- their solutions -----------------------------------------------------------------------------


def solver_name() -> str:
    """Return the solver with its version, as tables record it."""
    return f"embedded (scikit-fem {version('scikit-fem')})"


def run_study(
    study: Study,
    jobs: int = 1,
    progress: Progress = silent,
    checkpoint: Path | None = None,
    resume: bool = False,
) -> tuple[pd.DataFrame, list[str]]:
    """Solve every case of a study.

    Parameters
    ----------
    study : Study
        From `read_study`.
    jobs : int
        Worker processes; the result does not depend on it.
    progress : callable, optional
        Called with the stage, the number of cases done and their total.
    checkpoint : path, optional
        The journal of solved cases; the caller removes it once the table is saved.
    resume : bool
        Whether to take the cases already in `checkpoint` from there.

    Returns
    -------
    rows : pandas.DataFrame
        The solved cases, in the order of variants, clearances and loads, with the columns of a
        table and those of the pin's material.
    failures : list of str
        What is wrong with the others, a line for each clearance of a variant.

    Raises
    ------
    InputError
        If `checkpoint` belongs to another study.
    """
    import pandas as pd

    calls = {
        tuple((variant, dR, load) for load in study.load): call(
            _solve, variant, setup, dR, study.load
        )
        for variant, setup in study.setups.items()
        for dR in study.dR
    }

    def entry(_: _Case, result: _Result) -> dict[str, str | float] | None:
        return result if isinstance(result, dict) else None

    key = f"{study.key} {solver_name()}"
    journal = Journal(checkpoint, "study", key) if checkpoint else None
    stage = partial(progress, "solving")
    solved = run_recorded(calls, journal, _case_from, entry, resume, jobs, stage).values()
    rows = [result for result in solved if isinstance(result, dict)]
    failures = dict.fromkeys(result for result in solved if isinstance(result, str))
    return pd.DataFrame(rows, columns=list(_ALL_COLUMNS)), list(failures)


def _solve(variant: str, setup: Setup, dR: float, loads: tuple[float, ...]) -> dict[_Case, _Result]:
    """Solve one clearance of a variant in a worker."""
    try:
        with on_one_thread():
            solutions = solve(setup, dR, loads)
    except InputError as error:
        cases = f"{variant}, ΔR = {dR:g} mm, {', '.join(f'{load:g}' for load in loads)} N/mm"
        failure = f"{cases}: {error.rule}; {error.remedy}"
        return dict.fromkeys([(variant, dR, load) for load in loads], failure)
    plate, pin = setup.material("plate"), setup.material("pin")
    rows = [
        (
            *(variant, float(plate.E) / 1e3, plate.nu, dR, case.load, case.penetration),
            *(case.half_width, case.peak_pressure, setup.hole_radius, setup.outer_radius),
            *(case.mesh.cells, float(pin.E) / 1e3, pin.nu),
        )
        for case in solutions
    ]
    return dict(_case_from(dict(zip(_ALL_COLUMNS, row, strict=True))) for row in rows)


def _case_from(entry: Any) -> tuple[_Case, _Result]:
    """Return the case and the row that an entry of the journal holds."""
    row = {column: entry[column] for column in _ALL_COLUMNS}
    return (row["variant"], row["dR_mm"], row["load_N_per_mm"]), row


def outer_ratio_like_johnson(
    setup: Setup, dR: Sequence[float] = (1.0,), loads: Sequence[float] = (20.0, 40.0, 100.0)
) -> float:
    """Return the outer ratio at which finite elements agree with Johnson's law on average.

    The outer radius sets the additive constant of the penetration, −c·f/(πE*), because a plane body
    has no absolute approach. That of `recommended.toml` is from here.

    Parameters
    ----------
    setup : Setup
        The set-up; its `outer_ratio` is not used.
    dR, loads : sequence of float
        In mm and N/mm, outside the conformal range: f/(E*ΔR) of 0.01 or less.

    Returns
    -------
    float
        Outer radius over the hole's radius, to 0.2 %.

    Raises
    ------
    InputError
        If no ratio between 2 and 10 makes them agree.

    Examples
    --------
    >>> setup = Setup(hole_radius=2.245, outer_ratio=5.0, E=207e3, nu=0.3, cells=6)
    >>> print(f"{outer_ratio_like_johnson(setup, [1.0], [40.0]):.1f}")
    3.4
    """
    from scipy.optimize import brentq

    def mean_offset(log_ratio: float) -> float:
        """Return the mean of (δ − δ_Johnson)·πE*/f, nearly linear in the ratio's logarithm."""
        sized = Setup(**{**dict(setup), "outer_ratio": float(np.exp(log_ratio))})
        offsets = []
        for clearance in dR:
            pair = sized.pair(clearance)
            for case in solve(sized, clearance, loads):
                above = case.penetration - float(Johnson().penetration(case.load, pair))
                offsets.append(above * np.pi * float(pair.E_star) / case.load)
        return float(np.mean(offsets))

    try:
        return float(np.exp(brentq(mean_offset, np.log(2.0), np.log(10.0), xtol=2e-3)))
    except ValueError as error:
        rule = "between 2 and 10 never gives Johnson's penetration"
        remedy = "choose clearances and loads outside the conformal range, the load on the pin"
        raise InputError("finite elements", "outer_ratio", None, rule, remedy) from error


# --- tables --------------------------------------------------------------------------------------


class FiniteElementTable(NamedTuple):
    """A table of solved cases.

    Attributes
    ----------
    rows : pandas.DataFrame
        A row for each case, and columns for the pin's material if it has its own.
    header : dict
        study, set-up, engine, calibrated and sha256: what the rows came from.
    """

    rows: pd.DataFrame
    header: dict[str, str]


def write_table(path: Path | str, study: Study, solver: str, rows: pd.DataFrame) -> None:
    """Write solved cases to a table.

    Parameters
    ----------
    path : path
        A CSV file.
    study : Study
        The study.
    solver : str
        What solved the cases, with its version.
    rows : pandas.DataFrame
        The solved cases, from `run_study`.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    other_pin = any(setup.pin_E or setup.pin_nu is not None for setup in study.setups.values())
    columns = [*COLUMNS, *(PIN_COLUMNS if other_pin else ())]
    # More digits than the error of the solver, fewer than the rounding of different processors.
    body = rows[columns].to_csv(index=False, float_format="%.7g", lineterminator="\n")
    base = study.setups["base"]
    calibrated = (
        f"outer_radius_mm = {base.outer_radius:g} ({base.outer_ratio:g} hole radii, "
        f"{study.origin['outer_ratio']}); it sets the additive constant of the penetration"
    )
    values = (study.name, study.key, solver, calibrated, _hash(body))
    contents = marked(dict(zip(_KEYS, values, strict=True)))
    header = "".join(f"# {key}: {value}\n" for key, value in contents.items())
    with replacing(path) as temporary:
        temporary.write_text(header + body, encoding="utf-8", newline="\n")


def read_table(path: Path | str) -> FiniteElementTable:
    """Read a table.

    Parameters
    ----------
    path : path
        A file from `write_table`.

    Returns
    -------
    FiniteElementTable

    Raises
    ------
    InputError
        If the file cannot be read, is not such a table, or was edited by hand.
    """
    import io

    import pandas as pd

    remedy = "cylcontact finite-element STUDY.toml -o FILE writes it"
    lines = read_text(path, remedy, remedy).splitlines(keepends=True)
    head = [line for line in lines if line.startswith("# ")]
    contents: dict[str, Any] = dict(line[2:].rstrip().partition(": ")[::2] for line in head)
    with suppress(KeyError, ValueError):
        contents["format"] = int(contents["format"])
    header = unmarked(contents, str(path))
    body = "".join(lines[len(head) :])
    columns = tuple(body.partition("\n")[0].split(","))
    known = tuple(header) == _KEYS and columns in (COLUMNS, _ALL_COLUMNS)
    rule, remedy = "is not a table of finite elements", "name one that finite-element has written"
    require(known, str(path), "", None, rule, remedy)
    rule = f"does not match the rows, whose hash is {_hash(body)}: the table was edited by hand"
    remedy = "restore it, or compute it again with cylcontact finite-element"
    require(_hash(body) == header["sha256"], str(path), "sha256", header["sha256"], rule, remedy)
    return FiniteElementTable(pd.read_csv(io.StringIO(body)), header)


def require_same_inputs(path: Path, study: Study) -> None:
    """Raise `InputError` if a file is not a table of this study's set-up; it may be missing."""
    if not path.exists():
        return
    remedy = "write elsewhere with -o, or add --force to replace it"
    try:
        before = read_table(path).header
    except InputError as error:
        rule = "exists and is not a readable table of finite elements"
        raise InputError(str(path), "", None, rule, remedy) from error
    rule = f"holds a table that came from another set-up, not from {study.source} as it is now"
    same = before["set-up"] == study.key
    require(same, str(path), "set-up", before["set-up"], rule, remedy)


def _hash(body: str) -> str:
    """Return the hash of a table's rows."""
    return hashlib.sha256(body.encode()).hexdigest()[:16]
