"""All laws against conformal contact over the whole domain, in the universal variables."""

from dataclasses import asdict

import pandas as pd

from cylcontact.laws.explicit import CALIBRATED
from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.universal import (
    EXTERNAL_PHI,
    PHI_MAX,
    PHI_MIN,
    dimensionless_curves,
    enhanced_curves,
    error_table,
    external_curve,
)
from cylcontact.reports.universal_panels import universal_panels

REFITS = {"enhanced fit conformal": "conformal", "enhanced fit internal": "internal"}
CAPTION = (
    "Contact laws against Persson's conformal solution, internal contact, in φ = f/(E* ΔR) and "
    "δ/ΔR (-). (a) Penetration. (b) Error (%) of the load at given penetration; the axis is linear "
    "between -0.1 and 0.1 % and logarithmic beyond. Persson's datum is matched to Johnson's law at "
    "small loads, our choice. Explicit: {constants}, calibrated here; its "
    "one-line formula gives the penetration from the load and is inverted numerically for (b). "
    "Johnson's law ends at φ = 4π/e² (Eq 8), where its penetration is about half of Persson's. "
    "Winkler: the depth of the foundation is chosen so that it is right for large loads. The "
    "enhanced law (Eqs 5-6) is not dimensionless and holds in mm, N and MPa only: it is drawn for "
    "one steel, E = 207 GPa, ν = 0.3 (our choice), at ΔR = 0.01, 0.05 and 0.5 mm from 1 to 10 000 "
    "N/mm, with the published coefficients and with those of the fit 'conformal' (to Persson, 10 "
    "to 1000 N/mm, 0.0075 to 2 mm). Outside the loads and clearances of its calibration it is "
    "extrapolated: the published coefficients were made for ΔR above 0.05 mm. The table lists "
    "every law's largest and RMS error by decade of φ, the fit 'internal' (to Johnson) and the "
    "explicit law for external contact, judged by Johnson's law, among them."
)


def draw(bench: Bench) -> Drawing:
    laws = dimensionless_curves()
    enhanced = enhanced_curves({label: bench.result(name) for label, name in REFITS.items()})
    rollers = external_curve()
    tables = [
        error_table([*laws, *enhanced], "internal", "persson"),
        error_table([rollers], "external", "johnson"),
    ]
    table = pd.concat(tables, ignore_index=True)
    drawn = [curve for curve in enhanced if "internal" not in curve.law]
    whole = table[(table["range"] == "all") & (table["pair"] == "any")]
    sizes = whole.set_index(["law", "contact", "error_of"])["largest_error_percent"]
    span = f"{PHI_MIN:g} to {PHI_MAX:g}"
    external_span = f"{EXTERNAL_PHI[0]:g} to {EXTERNAL_PHI[1]:g}"
    headline = {
        f"explicit, internal: largest error of the load, φ {span}, %": sizes[
            "explicit", "internal", "load"
        ],
        f"explicit, external: largest error of the load, φ {external_span}, %": sizes[
            "explicit", "external", "load"
        ],
        "explicit, internal: largest error of the penetration, %": sizes[
            "explicit", "internal", "penetration"
        ],
        "explicit formula: largest error of the penetration, %": sizes[
            laws[1].law, "internal", "penetration"
        ],
    }
    for name in ("johnson", "liu", "winkler"):
        headline[f"{name}: largest error of the load, %"] = sizes[name, "internal", "load"]
    constants = asdict(CALIBRATED["internal"]).items()
    caption = CAPTION.format(
        constants=", ".join(f"{name} = {value:g}" for name, value in constants)
    )
    return Drawing(universal_panels(laws, drawn), table, headline, caption)
