"""Wanted against achieved restitution: what each hysteresis factor makes of an impact."""

from cylcontact.dissipation import FACTORS, achieved_restitution
from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.restitution import restitution_panels, restitution_table

GROUPS = (
    (
        "published 1975 to 1990",
        ("hunt-crossley", "herbert-mcwhannell", "lee-wang", "lankarani-nikravesh"),
    ),
    ("published 2004 to 2015", ("gonthier", "zhiying-qishao", "flores", "hu-guo")),
)
CAPTION = (
    "Coefficient of restitution (-) that an isolated impact achieves with F = F_el(δ)(1 + χ δ̇/δ̇⁽⁻⁾)"
    " against the wanted one, for the published hysteresis factors χ(e), by year of publication. "
    "It follows in closed form from χ alone, for every elastic law, mass and speed (derived here). "
    "Markers: the table's values, 0.1, 0.2, … 1. Grey band: the exact factor, the root χ of "
    "χ(1 + e) = ln[(1 + χ)/(1 − χe)], which achieves what is wanted. Dotted: 0.9, the value of the "
    "paper's mechanism. Mind the two scales of the errors below."
)


def draw(_bench: Bench) -> Drawing:
    table = restitution_table(list(FACTORS))
    rows = table.set_index(["factor", "wanted_restitution"])
    paper = "lankarani-nikravesh"
    headline = {
        f"{paper}, 0.9 wanted: achieved": rows.loc[(paper, 0.9), "achieved_restitution"],
        # Its factor is largest at e = 0, where it is 3/4.
        f"{paper}: least that it can achieve": float(achieved_restitution(0.75)),
        "exact, 0.9 wanted: factor": rows.loc[("exact", 0.9), "chi"],
    }
    for name, errors in table[table["factor"] != "exact"].groupby("factor", sort=False)["error"]:
        headline[f"{name}: largest error from 0.1 to 1"] = errors.abs().max()
    return Drawing(restitution_panels(GROUPS), table, headline, CAPTION)
