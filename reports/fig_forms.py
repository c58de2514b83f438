"""The search for the explicit law: the forms tried, each fitted, and what they cost."""

from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.reports.bench import Bench
from cylcontact.reports.forms import CHOSEN, SIMPLEST, draw_forms, forms_table
from cylcontact.reports.universal import PHI_MAX, PHI_MIN

CAPTION = (
    "Largest error (%) of explicit forms of L in δ/ΔR = (φ/π) L, φ = f/(E* ΔR), d = δ/ΔR, each "
    "fitted minimax to Persson's conformal solution for 1e-6 ≤ φ ≤ 60 (internal contact, δ and "
    "ΔR in mm, its datum matched to Johnson's law at small loads). A/d ln x is (A/d)·ln x. Plain "
    "bars: L from d, so the load is explicit and the error is the load's at given penetration. "
    "Hatched: L from φ, so the penetration is explicit and the error is its own at given load. "
    "Every fit is made anew when this is drawn, from stored starting points; another local "
    "optimum is not excluded. Bold: the two forms that the package has, there with rounded "
    "constants, which costs a little. The forms tried are our choice; each has at most four "
    "constants."
)


def draw(_bench: Bench) -> Drawing:
    table = forms_table()
    figure = new_figure("full", 112.0, wide=True)
    axes = figure.subplots()
    draw_forms(axes, table)
    axes.set(xlim=(1e-3, 60))
    span = rf"{PHI_MIN:g} $\leq \varphi \leq$ {PHI_MAX:g}"
    axes.set_xlabel(f"largest error for {span}, constants unrounded (%)")
    errors = table.set_index("form")["largest_error_percent"]
    of_penetration = errors[(table["given"] == "load").to_numpy()]
    headline = {
        f"load explicit, chosen form: largest error from {PHI_MIN:g} to {PHI_MAX:g}, %": errors[
            CHOSEN
        ],
        "penetration explicit, simplest form: largest error, %": errors[SIMPLEST],
        "penetration explicit, best form: largest error, %": of_penetration.min(),
        "forms": float(len(table)),
    }
    return Drawing(figure, table, headline, CAPTION)
