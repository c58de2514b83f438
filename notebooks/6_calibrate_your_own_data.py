# ---
# jupyter:
#   jupytext:
#     formats: ipynb,py:percent
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: cylcontact
#     language: python
#     name: cylcontact
# ---

# %% [markdown]
# # Calibrate your own data
#
# From a CSV file to a C function: read measurements, fit laws, see which of them has the right
# shape and how uncertain its constants are, and export it. Replace the table with yours.

# %%
import shutil
import subprocess
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
import pandas as pd

from cylcontact import CylinderPair, Material
from cylcontact.export import export
from cylcontact.export.named import find_law
from cylcontact.fitting.calibration import calibrate
from cylcontact.fitting.campaign import campaign_of_table
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.style import figure_style
from cylcontact.reports.notebook import live_progress

folder = Path(mkdtemp())

# %% [markdown]
# ## The table
#
# Columns carry their units. These numbers are **synthetic**: conformal contact with 2 % of noise.

# %%
table = folder / "mine.csv"
table.write_text("""\
load_kN,penetration_um
0.2,0.206
0.5,0.454
1,0.803
2,1.398
3,1.952
5,2.886
8,4.228
12,5.886
16,7.024
20,8.255
25,9.939
30,11.324
""")
measured = pd.read_csv(table)
measured.T

# %% [markdown]
# The values common to all rows: the material, the radii and the length.

# %%
constants = {"E_GPa": 207, "nu": 0.3, "R_i_mm": 10.0, "R_j_mm": 9.97, "length_mm": 20.0}

# %% [markdown]
# ## Fit three laws
#
# Johnson's with the constant that a measurement of an approach leaves open, a power law, and the
# explicit law, whose shape is known and only the constant c free.

# %%
explicit_fixed = {
    name: {"value": value, "fixed": True} for name, value in (("A", 0.3602), ("B", 3.84))
}
johnson_fixed = {"kappa": {"value": 1.0, "fixed": True}}
parameters_of = {"johnson": johnson_fixed, "power": {}, "explicit": explicit_fixed}
results = {}
with live_progress() as progress:
    for law, parameters in parameters_of.items():
        campaign = campaign_of_table(table, law, "internal", constants, parameters=parameters)
        results[law] = calibrate(campaign, progress=progress)
pd.Series(
    {law: 100 * result.objective.value for law, result in results.items()},
    name="root mean square of the residuals, %",
).round(2).to_frame()

# %% [markdown]
# The report of the best one: values, standard errors, intervals, and warnings.

# %%
results["explicit"]

# %% [markdown]
# The power law has two free constants and does worse with both: one line in ln f and ln δ is not
# the shape of these data, which the residuals below show as a bend.

# %%
print(results["power"])

# %% [markdown]
# ## Residuals

# %%
steel = Material("steel", E=207e3, nu=0.3)
pair = CylinderPair.internal(R_i=10.0, R_j=9.97, material=steel, length=20.0)
load = 1e3 * measured["load_kN"].to_numpy() / pair.length
penetration = 1e-3 * measured["penetration_um"].to_numpy()


def fitted(law):
    """Return a law with its fitted constants, from its saved result."""
    path = folder / f"{law}.json"
    results[law].save(path)
    return find_law(str(path), None).law


def residuals():
    """Draw the differences of the fitted laws from the measurements."""
    rows = pd.DataFrame({"load_N_per_mm": load})
    with figure_style():
        figure = new_figure("middle", 70.0)
        axes = figure.subplots()
        for law in results:
            rows[f"{law}_percent"] = 100 * (fitted(law).penetration(load, pair) / penetration - 1)
            axes.plot(load, rows[f"{law}_percent"], label=law)
        axes.axhline(0.0, color="0.6", linewidth=0.6, marker="")
        axes.set(xscale="log", xlabel="load (N/mm)", ylabel="fitted less measured (%)")
        axes.legend()
    worst = {law: float(np.abs(rows[f"{law}_percent"]).max()) for law in results}
    return Drawing(figure, rows, worst, "Penetration of the fitted laws less the measured one.")


residuals()

# %% [markdown]
# ## Export
#
# A self-contained C function of load and stiffness, with the fitted constants.

# %%
source = export(fitted("explicit"), "internal", "c", origin="fitted to mine.csv")
print("\n".join(source.splitlines()[:24]))

# %% [markdown]
# Compiled and called, if there is a compiler, it gives what Python gives.

# %%
program = """
#include <stdio.h>
double cylcontact_explicit_internal_load(double penetration, double E_star, double dR);
int main(void) { printf("%.6f", cylcontact_explicit_internal_load(5e-3, ESTAR, 0.03)); return 0; }
"""
print(f"Python {fitted('explicit').load(5e-3, pair):.6f} N/mm")
if shutil.which("gcc"):
    (folder / "law.c").write_text(source)
    (folder / "main.c").write_text(program.replace("ESTAR", repr(float(pair.E_star))))
    subprocess.run(["gcc", "main.c", "law.c", "-lm", "-o", "run"], cwd=folder, check=True)
    answer = subprocess.run([folder / "run"], capture_output=True, text=True, check=True).stdout
    print(f"C      {answer} N/mm")
