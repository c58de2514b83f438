"""Tables of measurements made from known laws, and the campaigns on them, for tests."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from cylcontact import CylinderPair, Material
from cylcontact.fitting.campaign import Campaign, read_table
from cylcontact.fitting.law_models import MODELS
from cylcontact.fitting.parameters import Parameter

USER_LAW = """\
import numpy as np

def load(penetration, E_star, dR, K_star, n, offset=0.0):
    return K_star * E_star / dR * penetration**n + offset

def flat(penetration, K):
    return 1.0
"""

STEEL = Material("steel", E=207e3, nu=0.3)
CONSTANTS = {"E_GPa": 207.0, "nu": 0.3, "R_i_mm": 10.0, "length_mm": 12.0}
LOADS = np.geomspace(1.0, 300.0, 12)
# Coefficients that data are made of, away from the nominal ones.
TRUTHS: dict[tuple[str, str], dict[str, float]] = {
    ("power", "internal"): {"K_star": 3.0, "n": 1.1},
    ("power-one-pair", "internal"): {"K": 312148.0, "n": 1.237},
    ("power-dimensionless", "internal"): {"C": 0.9, "n": 1.14},
    ("power-clearance", "internal"): {
        **{"A": 0.9, "p": 0.7, "n0": 1.13, "n1": -0.02},
        **{"q": 0.0, "n2": 0.0},
    },
    ("enhanced", "external"): {"a": 0.4, "b": 0.9, "n": 1.09},
    ("explicit", "internal"): {"c": 1.5, "A": 0.4, "B": 3.0},
    ("persson", "internal"): {"stiffness_factor": 1.1, "clearance_factor": 1.0},
    ("liu", "internal"): {"stiffness_factor": 1.8, "clearance_factor": 1.0},
    ("lankarani-nikravesh", "internal"): {"n": 1.4},
}


def truth_of(parameter: Parameter) -> float:
    """Return a value of a parameter that is not its nominal one."""
    if parameter.value is not None:
        return parameter.value
    if parameter.nominal is None:
        return float(np.sqrt(parameter.low * parameter.high))
    if parameter.shift:
        return parameter.nominal + 0.03 * (parameter.high - parameter.low)
    return 1.1 * parameter.nominal


# The others, for internal contact.
for (_law, _contact), _model in MODELS.items():
    if _contact == "internal" and _law not in {law for law, _ in TRUTHS}:
        TRUTHS[_law, _contact] = {p.name: truth_of(p) for p in _model.parameters}


# What a fit may free of the rig by default, as it is in data without the errors of one.
RIG = {"stiffness_factor": 1.0, "offset": 0.0}


def all_free(
    law: str,
    contact: str,
    bounds: Mapping[str, list[float]] | None = None,
    fixed: Mapping[str, float] | None = None,
) -> dict[str, Any]:
    """Return the settings that search all constants of a law, and nothing of the rig.

    What has bounds or a value takes precedence.
    """
    own, bounds, fixed = MODELS[law, contact].parameters, dict(bounds or {}), dict(fixed or {})
    if any(p.nominal is None for p in own):  # free by default, and without a rig
        return {"bounds": bounds, "fixed": fixed}
    usual = RIG if not any(p.stiffness for p in own) else {"offset": 0.0}
    fixed |= {k: v for k, v in usual.items() if k not in bounds and k not in fixed}
    free = [p.name for p in own if p.value is None and p.name not in {*bounds, *fixed}]
    return {"free": free, "bounds": bounds, "fixed": fixed}


def whole_truth(law: str, contact: str, names: Iterable[str]) -> dict[str, float]:
    """Return the coefficients that data are made of, with those of the rig among the names."""
    return {**{n: v for n, v in RIG.items() if n in names}, **TRUTHS[law, contact]}


def clearances(law: str, contact: str) -> tuple[float, ...]:
    """Return ΔR in mm that a law is tried at."""
    if contact == "external":
        return (12.0, 20.0, 40.0)
    if law == "power-one-pair":
        return (0.05,)
    return (0.01, 0.1, 0.5) if law == "explicit" else (0.1, 0.3, 1.0)


def write_measured(path: Path, law: str, contact: str, noise: float = 0.0, seed: int = 1) -> Path:
    """Write points of a law with its truth's coefficients, with or without noise."""
    built = MODELS[law, contact].build(TRUTHS[law, contact])
    rng = np.random.default_rng(seed)
    lines = ["dR_um,load_N_per_mm,penetration_um"]
    for dR in clearances(law, contact):
        pair = CylinderPair.from_dR(contact, dR, STEEL, length=12.0, R_i=10.0)
        depth = built.penetration(LOADS, pair) * np.exp(noise * rng.normal(size=LOADS.size))
        lines += [
            f"{1e3 * dR!r},{f!r},{1e3 * d!r}"
            for f, d in zip(LOADS.tolist(), depth.tolist(), strict=True)
        ]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def campaign_of_table(table, law, contact, constants, **settings) -> Campaign:
    """Return the campaign of a law on a table, with the keys of a campaign file as settings."""
    return read_table(table, law, None, contact, constants, **settings).campaign(law)


def measured_campaign(
    folder: Path,
    law: str = "johnson",
    contact: str = "internal",
    noise: float = 0.0,
    seed: int = 1,
    bounds: Mapping[str, list[float]] | None = None,
    fixed: Mapping[str, float] | None = None,
    **settings: Any,
) -> Campaign:
    """Return a campaign on points of a law that searches all its constants."""
    table = write_measured(folder / "measured.csv", law, contact, noise, seed)
    searched = all_free(law, contact, bounds, fixed)
    return campaign_of_table(table, law, contact, CONSTANTS, **searched, **settings)


def user_campaign(folder: Path) -> Campaign:
    """Return a campaign on points of a power law for a function of the user's own."""
    (folder / "mine.py").write_text(USER_LAW)
    table = write_measured(folder / "measured.csv", "power", "internal")
    return campaign_of_table(
        *(table, "mine:load", "internal", CONSTANTS),
        bounds={"K_star": [0.5, 10.0], "n": [1.0, 1.5]},
        starts=3,
    )


def with_columns(data, **columns):
    """Return measurements with other loads, penetrations or deviations."""
    return replace(data, columns=data.columns | columns)


def write_table(path: Path, columns: Mapping[str, list[Any]]) -> Path:
    """Write columns as CSV."""
    rows = [
        ",".join(columns),
        *(",".join(map(str, row)) for row in zip(*columns.values(), strict=True)),
    ]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path
