"""The paper's constants and printed values, and the domains that it names without bounds.

C. Pereira, A. Ramalho and J. Ambrósio, An enhanced cylindrical contact force model, Multibody
System Dynamics (2015). It judges its law over "practical" conditions and "moderate" loads without
giving numbers. Ours are here; every claim that rests on them says so and reports the results for
other bounds.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from cylcontact import limits
from cylcontact.bodies.material import Material, MaterialRow
from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.laws import Enhanced, Johnson, difference_percent
from cylcontact.laws.enhanced import PUBLISHED_DR
from cylcontact.reports.bench import Bench
from cylcontact.reports.paper import Paper
from cylcontact.support.arrays import FloatArray, as_floats

Interval = tuple[float, float]

# Sects 3.4 and 5: where the two laws are compared (Figs 10–14).
LOADS: Interval = (10.0, 1000.0)  # N/mm
COMPARED_CLEARANCES: Interval = (0.0075, 2.0)  # mm
FIG5_CLEARANCES = (1.0, 0.01)  # mm, of the contact stress
FIG6_WIDE = 0.445  # mm, from where on the paper states 3 %
FIG7_CLEARANCES: Interval = (0.001, 2.0)  # mm, Figs 7–9
Y_SWITCH = "0.34954"  # mm, as printed in Eq 6d
RADII = (100.0, 10.0, 5.0)  # mm, the R_i of Figs 7 and 9
# The middle half of the logarithmic load axis of Figs 10–14; the paper gives no bounds.
MODERATE_LOADS: Interval = (10**1.5, 10**2.5)

# Sects 3.1 and 3.2: the case of Fig 2, and what the laws are fitted over.
E_REFERENCE = 207e3  # MPa, Fig 2
NU_REFERENCE = 0.3
STEEL = Material("steel of Fig 2", E_REFERENCE, NU_REFERENCE)
FIG2_DR: Mapping[Contact, float] = {"internal": 0.05, "external": 140.0}  # mm
# Its K in N/mm per mmⁿ and its n, as printed.
FIG2_FITS: Mapping[Contact, tuple[str, str]] = {
    "internal": ("312148", "1.2370"),
    "external": ("44935", "1.0935"),
}
GOOD_CORRELATION = 0.998  # R², Sect. 3.1
TRAINING_DR: Mapping[Contact, Interval] = PUBLISHED_DR  # mm
TRAINING_E = (20.7e3, 10000e3)  # MPa
# Sect. 3.1 fits over 10 to 1000 N/mm and does not say how the loads are spaced.
TRAINING_LOADS = np.geomspace(10.0, 1000.0, 41)

# Johnson's limit in N/mm as Sect. 3.4 prints it, by material and ΔR in mm.
JOHNSON_LIMITS = {
    ("aluminium alloy", 0.0075): "494",
    ("aluminium alloy", 0.010): "658",
    ("titanium alloy", 0.0075): "865",
}

# Sect. 4: the joint of the slider-crank, its laws and cases.
BEARING_RADIUS = BEARING_LENGTH = 10.0  # mm
JOINT_LAWS: Mapping[str, str] = {
    "lankarani-nikravesh": "Lankarani–Nikravesh",
    "johnson": "Johnson",
    "enhanced": "enhanced",
}
JOINT_CLEARANCES = (0.5, 0.02)  # mm
RESTITUTIONS = (1.0, 0.9)
FRICTIONS = (0.0, 0.1)

# The materials of Figs 10–14, in the order of the figures.
MATERIALS = (
    "ceramics",
    "high-strength steel",
    "low-carbon steel",
    "titanium alloy",
    "aluminium alloy",
)
Table = Mapping[str, MaterialRow]
ELASTIC, YIELD = ("E_GPa", "nu"), ("yield_stress_MPa",)
SYMBOLS = {"E_GPa": "E", "nu": "ν", "yield_stress_MPa": "yield stress"}


@dataclass(frozen=True)
class Domain:
    """A region of the clearance–load plane for one kind of contact."""

    label: str
    R_i: float | None  # in mm; without it yield is left out
    loads: Interval = LOADS
    clearances: Interval = COMPARED_CLEARANCES

    def top_load(self, dR: ArrayLike, material: Material) -> FloatArray:
        """Return the highest load in N/mm at ΔR: the range's end, Johnson's limit or yield."""
        pair = CylinderPair.from_dR("internal", as_floats(dR), material, R_i=self.R_i)
        top = np.minimum(self.loads[1], limits.johnson_limit_load(pair))
        return top if self.R_i is None else np.minimum(top, limits.yield_load(pair, "Hertz"))

    def point(
        self, u: ArrayLike, v: ArrayLike, material: Material
    ) -> tuple[FloatArray, FloatArray]:
        """Map the unit square to (ΔR in mm, load in N/mm), both logarithmically.

        u runs over the clearances, v from the lowest load to the highest one at that ΔR;
        the load is NaN at clearances where the highest lies below the lowest.
        """
        dR = _between(self.clearances, as_floats(u))
        low, top = self.loads[0], self.top_load(dR, material)
        top = np.where(top >= low, top, np.nan)
        # The bound itself, not a rounding error beyond it: Johnson's law ends there.
        return dR, np.minimum(low * (top / low) ** as_floats(v), top)


def _between(ends: Interval, u: FloatArray) -> FloatArray:
    """Return the point at the fraction `u` of the way between `ends` on a logarithmic axis."""
    return as_floats(np.clip(ends[0] * (ends[1] / ends[0]) ** u, *ends))


HOLE_RADIUS = 10.0  # mm, our choice
PRACTICAL = Domain("practical domain", R_i=HOLE_RADIUS)
MODERATE = replace(PRACTICAL, label="moderate loads", loads=MODERATE_LOADS)
JOHNSON_ONLY = Domain("up to Johnson's limit, yield ignored", R_i=None)

# Inputs that the paper's text lacks.
TABLE_1, TABLE_2, WINDOW, DATUM = "Table 1", "Table 2", "the window", "the datum"
INTEGRATOR = "the integrator"

DEFINITIONS: Mapping[str, str] = {
    "practical domain": (
        "internal contact, "
        f"{COMPARED_CLEARANCES[0]:g} mm ≤ ΔR ≤ {COMPARED_CLEARANCES[1]:g} mm, and from "
        f"{LOADS[0]:g} N/mm up to the lowest of {LOADS[1]:g} N/mm, the load at which Hertz's peak "
        f"pressure (Eq 7) reaches the yield stress with R_i = {PRACTICAL.R_i:g} mm, and Johnson's "
        "limit (Eq 8). The ranges are those of Sect. 3.4; R_i and the yield stresses are assumed "
        "(ours), since the paper's table of materials is missing."
    ),
    "moderate loads": (
        f"{MODERATE_LOADS[0]:.1f} to {MODERATE_LOADS[1]:.0f} N/mm inside the practical domain: the "
        "middle half of the load axis of Figs 10–14, which is logarithmic. The paper gives no "
        "bounds; these are ours."
    ),
    "difference": (
        "Eq 9, 100·(δ_enhanced − δ_Johnson)/δ_Johnson at equal load, with the published "
        "coefficients. 'Largest' means largest in magnitude, printed with its sign."
    ),
    "share": "a part of the domain is measured by area on logarithmic axes of ΔR and load.",
    "agreement": (
        "a printed number is met if ours rounds to it at its last printed digit; an inequality, if "
        "it holds everywhere in the domain."
    ),
    "derived, assumed": (
        "numbers that the text does not state: worked out from other numbers in it, or ours."
    ),
    "ours": "a bound or a value that we chose, since the paper gives none.",
    "losses": "the restitution c_e, 1 or 0.9, and the friction c_f, 0 or 0.1, of the joint.",
    "the sphere": "the law of Lankarani and Nikravesh (Eq 2), which is that of a sphere.",
    "comparison": "two runs of the slider-crank that differ in one condition only.",
    "interval, scatter of batches": (
        "half-widths at 95 % from the means of 20 batches of revolutions. Without losses there is "
        "no steady state, and they tell the scatter over the revolutions that count."
    ),
    "conformal contact": (
        "Persson's solution for a pin and a hole of one material; its penetration has a free "
        "additive constant, the datum, here such that it meets Johnson's law at small loads."
    ),
    "reading": (
        "a reasonable way to understand a statement and to fill in what the paper does not say. "
        "The first one counts, another only with a ground of its own in the text or in place of a "
        "missing input; the verdict follows from those."
    ),
    "missing inputs": (
        "what the paper's text lacks and some claims hang on, "
        f"{TABLE_1} (materials), {TABLE_2} (slider-crank), {WINDOW} (loads, clearances, moduli, "
        "penetrations or revolutions that a number was taken over), "
        f"{DATUM} (where a penetration counts from) and {INTEGRATOR} (its tolerance and allowed "
        "penetration) among them."
    ),
}


# Works that claims cite where a result is not new.
REFERENCES: Mapping[str, str] = {
    "Corless et al. 1996": (
        "R. M. Corless, G. H. Gonnet, D. E. G. Hare, D. J. Jeffrey and D. E. Knuth, On the Lambert "
        "W function, Advances in Computational Mathematics 5 (1996) 329–359, "
        "doi:10.1007/BF02124750"
    ),
    "Carvalho and Martins 2019": (
        "A. S. Carvalho and J. M. Martins, Exact restitution and generalizations for the "
        "Hunt–Crossley contact model, Mechanism and Machine Theory 139 (2019) 174–194, "
        "doi:10.1016/j.mechmachtheory.2019.03.028"
    ),
    "Persson 1964": (
        "A. Persson, On the stress distribution of cylindrical elastic bodies in contact, "
        "dissertation, Chalmers Tekniska Högskola, Göteborg (1964)"
    ),
    "Ciavarella and Decuzzi 2001": (
        "M. Ciavarella and P. Decuzzi, The state of stress induced by the plane frictionless "
        "cylindrical contact, parts I and II, International Journal of Solids and Structures 38 "
        "(2001) 4507–4523 and 4525–4533, doi:10.1016/S0020-7683(00)00289-4"
    ),
}


# Of the report's pages.

FIGURE_TITLES: Mapping[int, str] = {
    1: "Geometry and symbols",
    2: "Power laws fitted to Johnson's law",
    3: "The exponent over clearance and material",
    4: "Finite element mesh",
    5: "Contact stress by finite elements",
    6: "Penetration by finite elements and by the laws",
    7: "Load at yield",
    8: "Largest load of Johnson's law",
    9: "Peak pressure at Johnson's largest load",
    10: "Enhanced against Johnson: ceramics",
    11: "Enhanced against Johnson: high-strength steel",
    12: "Enhanced against Johnson: low-carbon steel",
    13: "Enhanced against Johnson: titanium alloy",
    14: "Enhanced against Johnson: aluminium alloy",
    15: "Revolute joint with clearance",
    16: "Slider-crank mechanism",
    17: "Force over penetration with dissipation",
    18: "Path of the journal at 0.5 mm clearance",
    19: "Path of the journal at 0.02 mm clearance",
}
EQUATION = """
<math displaystyle="true" aria-label="f equals open bracket a Delta R plus b close bracket
 times E star over Delta R times delta to the power n">
<mi>f</mi><mo>=</mo><mo stretchy="false">(</mo><mi>a</mi><mspace width="0.15em"/>
<mi mathvariant="normal">Δ</mi><mi>R</mi><mo>+</mo><mi>b</mi><mo stretchy="false">)</mo>
<mfrac><msup><mi>E</mi><mo>*</mo></msup>
<mrow><mi mathvariant="normal">Δ</mi><mi>R</mi></mrow></mfrac>
<msup><mi>δ</mi><mi>n</mi></msup>
</math>
"""
PAPER = Paper(
    title="Enhanced cylindrical contact, recomputed",
    lead=(
        "Which contact law to use for a pin in a hole or for two rollers, and how far it is off. "
        "The explicit force–penetration law of Pereira, Ramalho and Ambrósio is fitted again to "
        "Johnson's law, and the paper's numbers are compared with ours."
    ),
    equation=EQUATION,
    citation=(
        "The law is from C. Pereira, A. Ramalho and J. Ambrósio, An enhanced cylindrical contact "
        "force model, Multibody System Dynamics (2015)."
    ),
    figures=FIGURE_TITLES,
    fits=("recovered-internal", "recovered-external", "internal", "external"),
    fits_note=(
        "Fitted to Johnson's law by a genetic search and a local one after it. Recovered: some "
        "coefficients fixed or tied, and the samples chosen so that the published values come "
        "out, different ones for each contact. Refit: all coefficients free, on the ranges of "
        "the paper. The objective is the root mean square of ln(δ/δ_Johnson). For a pin in a hole "
        "n = Y·ΔR^n_exponent, where Y is the larger of Y_log_scale·ln(1000 ΔR)^Y_log_exponent "
        "and Y_slope·ΔR + Y_offset, ΔR in mm (Eq 6)."
    ),
    definitions=DEFINITIONS,
    references=REFERENCES,
)


def material_rows(bench: Bench) -> dict[str, MaterialRow]:
    """Return the materials of Figs 10–14 with the provenance of their numbers."""
    return {name: bench.material(name) for name in MATERIALS}


def five_materials(bench: Bench) -> dict[str, Material]:
    """Return the materials of Figs 10–14; each has a yield stress."""
    return {name: row.material for name, row in material_rows(bench).items()}


def strength(material: Material) -> float:
    """Return the yield stress in MPa of a material that has one, as the five do."""
    return float(material.yield_stress or np.nan)


def clearance_pair(dR: ArrayLike, material: Material, R_i: float | None = None) -> CylinderPair:
    """Return a pin in a hole with radial clearance `dR` in mm."""
    return CylinderPair.from_dR("internal", as_floats(dR), material, R_i=R_i)


def difference(dR: ArrayLike, load: ArrayLike, material: Material) -> FloatArray:
    """Return Eq 9 in percent, published enhanced law against Johnson's, internal contact."""
    return difference_percent(Enhanced(), Johnson(), load, clearance_pair(dR, material))


def eq1_penetration(load: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return δ in mm by Johnson's Eq 1, taken literally at any load in N/mm.

    Beyond Eq 8's load the law is meaningless; the claims about Eq 1 beyond it need the values.
    """
    f, dR = as_floats(load), as_floats(pair.dR)
    return as_floats(f / (np.pi * pair.E_star) * (np.log(4 * np.pi * pair.E_star * dR / f) - 1))


def origins(rows: Table, names: Collection[str], *groups: tuple[str, ...]) -> str:
    """Return which of the materials' numbers are not the paper's own; empty if all are.

    Examples
    --------
    >>> steel = MaterialRow(Material("steel", 207e3, 0.3), {"E_GPa": "assumed"}, "")
    >>> origins({"steel": steel}, ("steel",), ("E_GPa",))
    'assumed: E of steel'
    """
    parts = []
    for origin in ("derived", "assumed"):
        texts = [text for group in groups for text in _owned(rows, names, group, origin)]
        if texts:
            parts.append(f"{origin}: {', '.join(texts)}")
    return "; ".join(parts)


def _owned(rows: Table, names: Collection[str], columns: tuple[str, ...], origin: str) -> list[str]:
    """Return "symbols of names" for the columns of that origin, once for equal symbols."""
    by_name = {
        name: " and ".join(SYMBOLS[c] for c in columns if rows[name].provenance[c] == origin)
        for name in names
    }
    texts = []
    for symbols in dict.fromkeys(filter(None, by_name.values())):
        owners = [name for name in names if by_name[name] == symbols]
        everyone = 1 < len(owners) == len(names)
        texts.append(f"{symbols} of {'all' if everyone else ', '.join(owners)}")
    return texts
