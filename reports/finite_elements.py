"""The committed tables of finite elements, and the laws at the same clearances and loads."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CylinderPair
from cylcontact.datasets.finite_element import Study, read_study, read_table
from cylcontact.laws import LAWS
from cylcontact.reports.bench import Bench
from cylcontact.support.errors import InputError

# Set-ups and tables of a bench.
FOLDER = Path("datasets", "finite_element")
# The models compared with finite elements, by their names in the package.
LAWS_COMPARED = ("johnson", "enhanced", "explicit", "persson")
CHOICES = (
    "Set-up: plane strain, with the load spread over the pin's section and the upper half of the "
    "plate's outer boundary held. The radius of that boundary, {ratio:g} hole radii, is fitted to "
    "Johnson's law outside the conformal range, so their agreement there is in part by "
    "construction. All but the held boundary is our choice: in plane strain the penetration "
    "depends on the size of the plate, and the paper does not state it."
)
# Load at which the statements on the contact stress are checked, in N/mm.
STRESS_LOAD = 20.0


def study(bench: Bench, name: str) -> Study:
    """Read the set-up file `NAME.toml` of the bench."""
    rule, remedy = "this set-up does not exist", "cylcontact init lays out a bench that has it"
    return read_study(bench.required(FOLDER / f"{name}.toml", rule, remedy))


def table(bench: Bench, name: str, solver: str = "embedded") -> pd.DataFrame:
    """Return the cases of `NAME-SOLVER.csv`, after checking that `NAME.toml` made them."""
    setups = study(bench, name)
    path = bench.input(FOLDER / f"{name}-{solver}.csv")
    cases = read_table(path)
    if cases.header["set-up"] != setups.key:
        raise InputError(
            str(path),
            "set-up",
            cases.header["set-up"],
            f"is not that of {setups.source}, which has {setups.key}",
            "make finite-element brings the table up to date",
        )
    return cases.rows


def choices(bench: Bench, name: str = "recommended") -> str:
    """Return the sentences on the set-up that end every caption."""
    return CHOICES.format(ratio=study(bench, name).setups["base"].outer_ratio)


def penetrations(rows: pd.DataFrame) -> pd.DataFrame:
    """Return clearance, load and every model's penetration in mm, for the rows of a table."""
    material = Material("steel", rows["E_GPa"].to_numpy() * 1e3, rows["nu"].to_numpy())
    pair = CylinderPair.from_dR("internal", rows["dR_mm"].to_numpy(), material)
    load = rows["load_N_per_mm"].to_numpy()
    columns = {f"{name}_mm": LAWS[name]().penetration(load, pair) for name in LAWS_COMPARED}
    return pd.DataFrame(
        {
            "dR_mm": rows["dR_mm"].to_numpy(),
            "load_N_per_mm": load,
            "fe_mm": rows["penetration_mm"].to_numpy(),
            **columns,
        }
    )


def sensitivity_table(rows: pd.DataFrame) -> pd.DataFrame:
    """Return each variant's change of the penetration (%) and of the additive constant, by case."""
    keys = ["dR_mm", "load_N_per_mm"]
    base = rows[rows["variant"] == "base"][[*keys, "penetration_mm"]]
    others = rows[rows["variant"] != "base"]
    before = others[keys].merge(base, how="left", on=keys)["penetration_mm"].to_numpy()
    change = others["penetration_mm"].to_numpy() - before
    material = Material("steel", 1e3 * others["E_GPa"].to_numpy(), others["nu"].to_numpy())
    E_star = material.plane_strain_modulus / 2
    return others[["variant", *keys]].assign(
        change_percent=100 * change / before,
        constant=np.pi * E_star * change / others["load_N_per_mm"].to_numpy(),
    )
