"""Misprints: each as printed and as we read it, where a computation tells the two apart."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.impact import friction_load
from cylcontact.laws import Enhanced
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, untestable

from .. import paper
from ..finite_elements import STRESS_LOAD, study, table
from ..paper import FIG5_CLEARANCES, STEEL
from ..power_fits import fig2_fit
from ..readings import reading

CLOSE = 1.0  # percent, ours
# Share of the rectangle of peak pressure and width that a pressure of that shape fills.
ELLIPSE, PARABOLA = np.pi / 4, 2 / 3


@claim(
    "{id}",
    "{where} is printed with R_i·R_i; R_i·R_j is meant",
    paper="R_i·R_i",
    rule=f"within {CLOSE:g} % of {{judge}}, our bound",
    misprint=True,
    figures=("fig01",),
    cases=[
        {
            "id": "2-eq2-radii",
            "where": "the root in Eq 2",
            "judge": "Hertz's sphere in a socket, 1/R = 1/R_j − 1/R_i",
            "what": "against Hertz's sphere in a socket the stiffness",
        },
        {
            "id": "3.3-eq7-radii",
            "where": "the R of Eq 7",
            "judge": "the peak pressure of finite elements",
            "what": "against finite elements the peak pressure",
        },
    ],
)
def radii(bench: Bench, id: str, what: str) -> Finding:
    """Return Eq 2's force and Eq 7's pressure with each product of radii, against its judge."""
    dR = FIG5_CLEARANCES[0]
    R_i = study(bench, "recommended").setups["base"].hole_radius
    R_j = R_i - dR
    products = {
        "R_i·R_j": R_i * R_j,
        "R_i·R_i, i the hole": R_i * R_i,
        "R_i·R_i, i the pin": R_j * R_j,
    }
    if id == "2-eq2-radii":
        judge = 1 / (1 / R_j - 1 / R_i)
        off = {name: 100 * (np.sqrt(p / dR / judge) - 1) for name, p in products.items()}
    else:
        rows = table(bench, "recommended")
        (peak,) = rows["peak_pressure_MPa"][_case(rows, dR, STRESS_LOAD)]
        E_star = STEEL.plane_strain_modulus / 2
        off = {
            name: 100 * (np.sqrt(STRESS_LOAD * E_star * dR / (np.pi * p)) / peak - 1)
            for name, p in products.items()
        }
    percents = {name: float(value) for name, value in off.items()}
    (own, percent), *others = percents.items()
    hole, pin = (value for _, value in others)
    return Finding(
        f"{what} is {abs(percent):.2f} % off with R_i·R_j; with R_i·R_i it is {hole:+.1f} % (i the "
        f"hole) or {pin:+.1f} % (i the pin) off",
        holds=abs(percent) < CLOSE,
        choice=f"read as {own}; radii of {R_i:g} and {R_j:g} mm",
        ground="with it alone the formula stays the same if the bodies are exchanged",
        alternatives=[
            reading(
                f"as printed, {name}",
                f"{value:+.1f} %",
                abs(value) < CLOSE,
                f"{abs(value) - CLOSE:.1f} points above {CLOSE:g} %",
            )
            for name, value in others
        ],
        values={f"{name}, percent": value for name, value in percents.items()},
    )


def _case(rows: pd.DataFrame, dR: float, load: float) -> pd.Series[bool]:
    """Return which rows are of that clearance and load."""
    return (rows["dR_mm"] == dR) & (rows["load_N_per_mm"] == load)


@claim(
    "3.1-dR-external",
    "after Eq 6 ΔR = R_i + R_j is given for internal contact; external contact is meant",
    paper="ΔR = R_i + R_j for internal contact",
    rule=f"R_i·R_j/ΔR is within {CLOSE:g} % of Hertz's radius, our bound",
    misprint=True,
    figures=("fig01",),
)
def sum_of_radii() -> Finding:
    """Return R_i·R_j/(R_i + R_j) over Hertz's radius for rollers and for a pin in a hole."""
    R_i = paper.BEARING_RADIUS
    R_j = R_i - paper.JOINT_CLEARANCES[0]
    radius = R_i * R_j / (R_i + R_j)
    rollers, pin = radius * (1 / R_i + 1 / R_j), radius * (1 / R_j - 1 / R_i)
    as_hole = CylinderPair.from_dR("internal", R_i + R_j, STEEL)
    defined = np.isfinite(Enhanced().penetration(STRESS_LOAD, as_hole))
    return Finding(
        f"R_i·R_j/(R_i + R_j) is {rollers:.3f} of Hertz's radius in external contact, two rollers; "
        f"it is {pin:.3f} of it in internal contact, the joint of Sect. 4 at "
        f"{paper.JOINT_CLEARANCES[0]:g} mm",
        holds=bool(abs(rollers - 1) < CLOSE / 100),
        choice="read as external the second time",
        ground="the sentence has given ΔR = R_i − R_j for internal contact already",
        alternatives=[
            reading(
                "as printed, internal",
                f"{pin:.3f} of Hertz's radius for the joint of Sect. 4 at 0.5 mm"
                + ("" if defined else f"; its ΔR = {R_i + R_j:g} mm is outside Eq 6d"),
                abs(pin - 1) < CLOSE / 100,
                f"{1 / pin:.0f} times too small",
            )
        ],
        values={"rollers, -": rollers, "pin in a hole, -": pin},
    )


@claim(
    "3.2-dR-sign",
    "in the finite elements R_i is called the inner cylinder's radius; with ΔR = R_i − R_j the "
    "outer one's is meant",
    paper="R_j = 2.245 mm, the outer cylinder",
    rule="the logarithm in Eq 1 has a positive argument",
    misprint=True,
    figures=("fig01",),
)
def sign_of_clearance(bench: Bench) -> Finding:
    """Return the argument of Eq 1's logarithm with i the hole and with i the pin."""
    hole = study(bench, "recommended").setups["base"].hole_radius
    pin = hole - FIG5_CLEARANCES[0]

    def argument(R_i: float, R_j: float) -> float:
        E_star = float(STEEL.plane_strain_modulus) / 2
        return 4 * np.pi * E_star * (R_i - R_j) / STRESS_LOAD

    right, printed = argument(hole, pin), argument(pin, hole)
    return Finding(
        f"at {FIG5_CLEARANCES[0]:g} mm and {STRESS_LOAD:g} N/mm the argument of Eq 1's logarithm "
        f"is {right:.0f} with R_i the outer cylinder's radius; with R_i the inner one's it is "
        f"{printed:.0f}",
        holds=right > 0,
        choice="R_i read as the hole's radius",
        ground="ΔR = R_i − R_j after Eqs 1 and 6, and body i has the bearing in Sect. 4",
        alternatives=[
            reading(
                "as printed, i the inner cylinder",
                f"the argument is {printed:.0f}",
                printed > 0,
                f"{-printed:.0f} below zero",
            ),
            reading("ΔR as a magnitude", f"the argument is {abs(printed):.0f}", abs(printed) > 0),
        ],
        values={"argument, i the hole, -": right, "argument, i the pin, -": printed},
    )


@claim(
    "3.1-fig2-clearance",
    "the text gives ΔR = 50 µm for both fits of Fig 2; for the external one the caption's 140 mm "
    "is meant",
    paper="50 µm for both",
    rule=f"K and n within {CLOSE:g} % of the printed ones for external contact",
    misprint=True,
    figures=("fig02",),
)
def fig2_clearance() -> Finding:
    """Return the departure of K and n from the printed external ones, at 140 mm and at 50 µm."""
    printed = [float(text) for text in paper.FIG2_FITS["external"]]

    def off(contact: Contact) -> tuple[float, float]:
        # Eq 1 knows the contact by ΔR only, so the external fit at 50 µm is the internal one.
        fit = fig2_fit(contact)
        K, n = (100 * (value / p - 1) for value, p in zip((fit.K, fit.n), printed, strict=True))
        return K, n

    caption, text = off("external"), off("internal")
    return Finding(
        f"at 140 mm K is {caption[0]:+.2f} % and n {caption[1]:+.2f} % off the printed external "
        f"ones; at 50 µm they are {text[0]:+.0f} % and {text[1]:+.0f} % off",
        holds=max(map(abs, caption)) < CLOSE,
        choice="external contact at 140 mm; loads 1, 100, 200, …, 10000 N/mm",
        ground="the caption gives 140 mm for the external case",
        alternatives=[
            reading(
                "as printed in the text, 50 µm for both",
                f"K {text[0]:+.0f} %, n {text[1]:+.0f} %",
                max(map(abs, text)) < CLOSE,
                f"{max(map(abs, text)) - CLOSE:.0f} points above {CLOSE:g} %",
            )
        ],
        values={
            "K at 140 mm, percent": caption[0],
            "n at 140 mm, percent": caption[1],
            "K at 50 um, percent": text[0],
            "n at 50 um, percent": text[1],
        },
    )


@claim(
    "3.2-elliptic-stress",
    "the contact stress that confirms Hertz's theory is called parabolic; elliptic is meant",
    paper="parabolic",
    rule="the load fills the rectangle of peak pressure and contact width as that shape does, "
    f"within {CLOSE:g} %",
    misprint=True,
    figures=("fig05",),
)
def elliptic_stress(bench: Bench) -> Finding:
    """Return the load over peak pressure times width, by finite elements."""
    rows = table(bench, "convergence")
    rows = rows[(rows["variant"] == "base") & (rows["load_N_per_mm"] == STRESS_LOAD)]
    shares: Mapping[float, float] = {
        dR: float(
            STRESS_LOAD / (2 * row["half_width_mm"].iloc[0] * row["peak_pressure_MPa"].iloc[0])
        )
        for dR in FIG5_CLEARANCES
        for row in [rows[rows["dR_mm"] == dR]]
    }

    def off(shape: float) -> float:
        return max(100 * abs(share / shape - 1) for share in shares.values())

    text = " and ".join(f"{share:.3f} (at {dR:g} mm)" for dR, share in shares.items())
    return Finding(
        f"by finite elements the load fills {text} of the rectangle of peak pressure and contact "
        f"width; an ellipse fills {ELLIPSE:.3f} of it, a parabola {PARABOLA:.3f}",
        holds=off(ELLIPSE) < CLOSE,
        choice=f"read as elliptic; {STRESS_LOAD:g} N/mm",
        ground="the sentence calls on Hertz's theory, whose pressure is an ellipse",
        alternatives=[
            reading(
                "as printed, a parabola",
                f"{off(PARABOLA):.0f} % more than a parabola fills",
                off(PARABOLA) < CLOSE,
                f"{off(PARABOLA) - CLOSE:.0f} points above {CLOSE:g} %",
            )
        ],
        values={f"share at {dR:g} mm, -": share for dR, share in shares.items()},
    )


@claim(
    "4.1-friction-direction",
    "Eq 14 gives f_t as a vector, v_t over its magnitude, and Eq 13 multiplies it by t once more; "
    "a scalar with the sign of the sliding velocity along t is meant",
    paper="f_t·t with v_t/|v_t| in f_t",
    rule="friction takes up power at every sliding velocity, f_i·v_i + f_j·v_j ≤ 0",
    misprint=True,
)
def friction_direction() -> Finding:
    """Return the largest power of the pair of friction forces by reading, in N·mm/s per newton.

    The bodies' surfaces move along one tangent, each at up to 100 mm/s.
    """
    v_i, v_j = (x.ravel() for x in np.meshgrid(*[np.linspace(-100, 100, 41)] * 2))
    sliding = v_i - v_j
    c_f, v0, v1 = paper.FRICTIONS[1], 1.0, 5.0
    forces = {
        "v_t = (v_i − v_j)·t, with its sign": friction_load(1.0, sliding, c_f, v0, v1),
        "v_t = (v_j − v_i)·t, with its sign": friction_load(1.0, -sliding, c_f, v0, v1),
        "vector over magnitude as the number 1": friction_load(1.0, np.abs(sliding), c_f, v0, v1),
    }
    powers = {name: float(np.max(f * v_i - f * v_j)) for name, f in forces.items()}
    tangent = np.array([0.6, 0.8])
    v_t = sliding[:, None] * tangent
    speed = np.linalg.norm(v_t, axis=1)
    along = v_t / np.where(speed > 0, speed, 1.0)[:, None]
    vectors = friction_load(1.0, speed, c_f, v0, v1)[:, None] * along
    powers["Eq 14 as a vector along v_t, without the tangent"] = float(
        np.max(np.sum(vectors * v_t, axis=1))
    )
    (own, power), *others = powers.items()
    opposite = others[0][1]
    return Finding(
        f"read so, with v_t = (v_i − v_j)·t, friction never adds energy ({1e-3 * power:g} W at "
        "most) for surface speeds up to 100 mm/s; with the opposite sign it adds up to "
        f"{1e-3 * opposite:.3f} W per newton of load",
        holds=power <= 0,
        choice=f"read as a scalar, {own}",
        ground="friction dissipates; Eq 14 is Amontons and Coulomb's law",
        alternatives=[
            reading(
                name,
                f"up to {1e-3 * value:.3f} W",
                value <= 0,
                f"it drives with up to {1e-3 * value:.3f} W per newton of load",
            )
            for name, value in others
        ],
        values={f"{name}, N mm/s": value for name, value in powers.items()},
    )


@claim(
    "4.3-esdu-number",
    "ESDU item 78055 is named for cylinders in contact; 78035 is meant",
    paper="ESDU-78055",
    misprint=True,
)
def esdu_number() -> Finding:
    """Return no value: the number of a document is not computed."""
    return untestable("a document's number cannot be computed; the formula is item 78035's")
