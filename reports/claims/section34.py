"""Section 3.4: where Johnson's law ends, and where the materials yield."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from cylcontact import limits
from cylcontact.materials import Material
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import (
    Alternative,
    Finding,
    agrees_as_printed,
    claim,
    listed,
    untestable,
    with_unit,
)

from .. import paper
from ..readings import found

SMALLEST, LARGEST = paper.COMPARED_CLEARANCES
LOWEST, HIGHEST = paper.LOADS
ALUMINIUM = "aluminium alloy"

# E in GPa and ν in place of Table 1: the next ν of two digits, and common alloys by tables.
OTHER_ELASTIC = {
    ALUMINIUM: [("", 69.0, 0.32), ("", 69.0, 0.34)],
    "titanium alloy": [("Ti-6Al-4V, ", 113.8, 0.34), ("Ti-5Al-2.5Sn, ", 110.0, 0.31)],
}
# Assumed plastics, E in GPa and ν.
PLASTICS = {
    "unfilled plastic": (3.0, 0.4),
    "glass-filled plastic": (10.0, 0.35),
    "the paper's lowest E": (paper.TRAINING_E[0] / 1e3, 0.4),
}


def elastic(E_GPa: float, nu: float) -> Material:
    """Return a material without a name or a yield stress."""
    return Material("", 1e3 * E_GPa, nu)


def limit(material: Material, dR: float) -> float:
    """Return Johnson's limit in N/mm."""
    return float(limits.johnson_limit_load(paper.clearance_pair(dR, material)))


def yield_load(material: Material, dR: float, R_i: float = paper.HOLE_RADIUS) -> float:
    """Return the load at yield in N/mm."""
    return float(limits.yield_load(paper.clearance_pair(dR, material, R_i), "Hertz"))


def unless(met: bool, miss: str) -> str:
    """Return by how much a rule is missed; nothing where it is met."""
    return "" if met else miss


@claim(
    "3.4-limit-{short}-{dR_um:g}um",
    "Johnson's law carries the {name} up to this load at ΔR = {dR_um:g} µm",
    paper="{printed} N/mm",
    rule="agreement to the printed digit",
    figures=("fig08",),
    against="{against}",
    cases=[
        {
            "short": name.split()[0],
            "name": name,
            "dR_um": 1e3 * dR,
            "dR": dR,
            "printed": printed,
            "against": "Not reproduced: E was chosen with the printed load in view, and tables "
            "give titanium alloys less."
            if name != ALUMINIUM
            else "Reproduced: 69 GPa is the lower end of the paper's E, tables give aluminium "
            "alloys ν = 0.33, and these two give both printed loads.",
        }
        for (name, dR), printed in paper.JOHNSON_LIMITS.items()
    ],
)
def johnson_limit(bench: Bench, name: str, dR: float, printed: str) -> Finding:
    """Return Johnson's limit load in N/mm of one material at one clearance."""
    row = bench.material(name)

    def reading(label: str, material: Material) -> Alternative:
        load = limit(material, dR)
        met = agrees_as_printed(load, printed)
        miss = unless(met, f"{load - float(printed):+.1f} N/mm")
        choice = f"{label}{material.E / 1e3:g} GPa, ν = {material.nu:g}"
        return Alternative(choice, f"{load:.1f} N/mm", met, paper.TABLE_1, miss)

    own = reading("", row.material)
    values = {"load, N/mm": limit(row.material, dR)}
    if not paper.origins({name: row}, (name,), paper.ELASTIC):
        return Finding(own.ours, own.holds, miss=own.miss, values=values)
    return found(
        [own, *([reading(label, elastic(*numbers)) for label, *numbers in OTHER_ELASTIC[name]])],
        values=values,
    )


@claim(
    "3.4-limits-in-proportion",
    "the aluminium alloy's two limits grow with the clearance as Eq 8 has it",
    paper="494 N/mm at 7.5 µm, 658 N/mm at 10 µm",
    rule="one E* gives both loads as printed",
    figures=("fig08",),
)
def limits_in_proportion() -> Finding:
    """Return the interval of E* in GPa that Eq 8 leaves for the two printed loads."""
    ends = [
        [(float(printed) + half) * math.e**2 / (4e3 * math.pi * dR) for half in (-0.5, 0.5)]
        for (name, dR), printed in paper.JOHNSON_LIMITS.items()
        if name == ALUMINIUM
    ]
    least, most = max(low for low, _ in ends), min(high for _, high in ends)
    return Finding(
        f"every E* from {least:.2f} to {most:.2f} GPa gives both",
        holds=least < most,
        values={"least E*, GPa": least, "largest E*, GPa": most},
    )


@claim(
    "3.4-valid-at-1000",
    "at 7.5 µm Johnson's law holds up to 1000 N/mm for all but the aluminium and titanium alloys",
    paper="ceramics and both steels valid, aluminium and titanium alloys not",
    rule="exactly the three named materials have their limit at or above 1000 N/mm",
    figures=("fig08",),
    against="Depends on Table 1: E and ν of the ceramics and of one steel stand in for it.",
)
def valid_at_1000(bench: Bench) -> Finding:
    """Return Johnson's limit at 7.5 µm in N/mm of every material."""
    materials = paper.five_materials(bench)
    stiff = set(paper.MATERIALS[:3])

    def reading(choice: str, materials: dict[str, Material]) -> Alternative:
        loads = {name: limit(m, SMALLEST) for name, m in materials.items()}
        wrong = [name for name in loads if (loads[name] >= HIGHEST) != (name in stiff)]
        least, most = (
            pick(load for name, load in loads.items() if (name in stiff) == inside)
            for pick, inside in ((min, True), (max, False))
        )
        text = (
            f"ceramics and the two steels carry {least:.0f} N/mm or more, the two alloys "
            f"{most:.0f} N/mm or less"
        )
        missing = paper.TABLE_1 if choice else ""
        miss = f"{len(wrong)} on the wrong side: {', '.join(wrong)}"
        return Alternative(choice, text, not wrong, missing, unless(not wrong, miss))

    soft = dict(zip(paper.MATERIALS, [(300, 0.22), (190, 0.27), (190, 0.27)], strict=False))
    softer = materials | {name: elastic(*numbers) for name, numbers in soft.items()}
    sources = paper.material_origins(bench, paper.ELASTIC)
    return found(
        [
            reading("our E and ν" if sources else "", materials),
            *([reading("ceramics of 300 GPa and steels of 190 GPa", softer)] if sources else []),
        ],
        values=with_unit({name: limit(m, SMALLEST) for name, m in materials.items()}, "N/mm"),
    )


@claim(
    "3.4-largest-valid-load",
    "1000 N/mm is the largest load for which Johnson's law is valid for most materials at 7.5 µm",
    paper="1000 N/mm",
    rule="the largest load that three of the five materials carry is 1000 N/mm",
    figures=("fig08",),
    paper_values={"load, N/mm": HIGHEST},
    against=(
        "Not reproduced: read as it stands the clause gives the largest load, and most materials "
        "carry more."
    ),
)
def largest_valid_load(bench: Bench) -> Finding:
    """Return the largest load in N/mm that most materials carry at 7.5 µm."""
    loads = sorted(limit(m, SMALLEST) for m in paper.five_materials(bench).values())
    most = loads[2]
    valid = most >= HIGHEST
    return Finding(
        f"three of the five carry {most:.0f} N/mm",
        holds=round(most) == HIGHEST,
        choice="the largest load at which the law is valid",
        miss=f"{most - HIGHEST:+.0f} N/mm",
        alternatives=[
            Alternative(
                "a remark: the law is still valid at 1000 N/mm, the largest load of the study",
                f"three carry {most:.0f} N/mm",
                valid,
                miss=unless(valid, f"{most - HIGHEST:+.0f} N/mm"),
            )
        ],
        values={"load, N/mm": most},
    )


@claim(
    "3.4-penetration-falls",
    "beyond those limits the penetration falls as the load grows",
    paper="falls",
    rule="the ratio is below 1",
)
def penetration_falls() -> Finding:
    """Return Eq 1's penetration at 1000 N/mm over that at each printed limit."""
    # With f_lim of Eq 8, Eq 1 reads δ ∝ f·(1 − ln(f/f_lim)).
    past = {
        f"{name} at {1e3 * dR:g} µm": HIGHEST / float(printed)
        for (name, dR), printed in paper.JOHNSON_LIMITS.items()
    }
    ratios = {name: x * (1 - math.log(x)) for name, x in past.items()}
    return Finding(
        "Eq 1's penetration at 1000 N/mm over that at the limit: " + listed(ratios, "{:.3f}"),
        holds=all(ratio < 1 for ratio in ratios.values()),
        values=with_unit(ratios, "-"),
    )


@claim(
    "3.4-plastics",
    "for plastics Johnson's domain is too small for a comparison",
    paper="comparison makes no sense",
    rule="at most clearances the law ends below 1000 N/mm (ours)",
    figures=("fig08",),
    against="Not reproduced: most pairs of clearance and load are inside Johnson's domain even for "
    "a soft plastic.",
)
def plastics() -> Finding:
    """Return the percentage of the clearances at which Johnson's law ends below 1000 N/mm."""
    dR = np.geomspace(SMALLEST, LARGEST, 2001)
    shares, inside = {}, {}
    for name, (E_GPa, nu) in PLASTICS.items():
        # Johnson's limit is proportional to ΔR.
        loads = limit(elastic(E_GPa, nu), 1.0) * dR
        shares[name] = 100 * float(np.mean(loads < HIGHEST))
        decades = np.log(np.clip(loads, LOWEST, HIGHEST) / LOWEST) / np.log(HIGHEST / LOWEST)
        inside[name] = 100 * float(decades.mean())
    soft, *stiffer = (f"{name}, {E:g} GPa" for name, (E, _) in PLASTICS.items())
    soft_share, *stiffer_shares = shares.values()
    end = HIGHEST / limit(elastic(*PLASTICS["unfilled plastic"]), 1.0)
    linear = 100 * (end - SMALLEST) / (LARGEST - SMALLEST)

    def reading(
        choice: str, share: float, text: str = "at {:.0f} % of the clearances"
    ) -> Alternative:
        miss = unless(share > 50, f"{50 - share:.0f} points below half")
        return Alternative(choice, text.format(share), share > 50, miss=miss)

    E_GPa, _ = PLASTICS["unfilled plastic"]
    told = (
        f"for an unfilled plastic of {E_GPa:g} GPa Johnson's law ends below {HIGHEST:g} N/mm at "
        "{:.0f} % of the clearances (logarithmic axis)"
    )
    return found(
        [
            reading(f"{soft}, logarithmic axes", soft_share, told),
            *map(reading, stiffer, stiffer_shares),
            reading(f"{soft}, linear axis of ΔR", linear),
            reading(
                f"{soft}, most of the plane of ΔR and load outside",
                100 - inside["unfilled plastic"],
                "{:.0f} % of it is outside",
            ),
        ],
        values={"limit at 7.5 um, N/mm": limit(elastic(*PLASTICS["unfilled plastic"]), SMALLEST)}
        | with_unit(shares, "clearances, percent")
        | with_unit(inside, "inside, percent")
        | {"unfilled plastic, linear axis, percent": linear},
    )


def yield_exponent(E: float = 1.0, stress: float = 1.0, dR: float = 1.0) -> float:
    """Return log2 of the change of the yield load when E, σ_Y or ΔR are multiplied as given."""
    changed, steel = (
        yield_load(Material("", 200e3 * x, 0.3, 250.0 * y), 0.05 * z)
        for x, y, z in ((E, stress, dR), (1.0, 1.0, 1.0))
    )
    return float(np.log2(changed / steel))


@claim(
    "3.4-allowable-load-against-strength",
    "the largest allowable load grows with the yield strength",
    paper="grows",
    rule="positive exponent",
    figures=("fig07",),
)
def allowable_load_against_strength() -> Finding:
    """Return the exponent of the yield stress in the load at yield."""
    exponent = yield_exponent(stress=2)
    return Finding(
        f"the load at yield (Eq 7) goes as σ_Y to the power of {exponent:.2f}",
        holds=exponent > 0,
        values={"exponent, -": exponent},
    )


@claim(
    "3.4-allowable-load-against-modulus",
    "the largest allowable load grows with the composite modulus",
    paper="grows",
    rule="positive exponent",
    figures=("fig07", "fig08"),
    against="Reproduced: Sect. 3.3 gives the name of maximum allowable load to Eq 8's, which grows "
    "with E*, though not with the yield strength, as the same sentence has it.",
)
def allowable_load_against_modulus() -> Finding:
    """Return the exponent of the modulus in the load at yield, and in Johnson's limit."""
    exponent = yield_exponent(E=2)
    johnson = float(np.log2(limit(elastic(400, 0.3), 0.05) / limit(elastic(200, 0.3), 0.05)))
    return Finding(
        f"the load at yield (Eq 7) goes as E* to the power of {exponent:.2f}",
        holds=exponent > 0,
        choice="Eq 7's load, which also grows with the strength",
        miss=f"exponent {exponent:.0f}, the reverse",
        values={"exponent of f_Y, -": exponent, "exponent of Johnson's limit, -": johnson},
    )


@claim(
    "3.4-limit-load-against-clearance",
    "the load that can be carried without yielding falls as the clearance grows",
    paper="falls",
    rule="falls at every step from 7.5 µm to 2 mm, for every material and R_i of 5, 10 and 100 mm",
    figures=("fig07",),
)
def limit_load_against_clearance(bench: Bench) -> Finding:
    """Return the exponent of the clearance in the load at yield."""
    exponent = yield_exponent(dR=2)
    clearances = np.geomspace(SMALLEST, LARGEST, 101)
    # The materials differ by a factor only.
    falls = all(
        np.all(np.diff([yield_load(m, float(dR), R_i) for dR in clearances]) < 0)
        for m in paper.five_materials(bench).values()
        for R_i in paper.RADII
    )
    return Finding(
        f"by Eq 7 it goes as ΔR to the power of {exponent:.2f} near 50 µm",
        holds=falls,
        values={"exponent, -": exponent},
    )


@claim(
    "3.4-limit-load-against-young",
    "the load that can be carried without yielding falls as Young's modulus falls",
    paper="falls",
    rule="positive exponent of E",
    figures=("fig07",),
    against="Reproduced: Eq 8's limit load does fall with E, though it knows no plastic "
    "deformation and grows with the clearance, of which the same sentence says the opposite.",
)
def limit_load_against_young(bench: Bench) -> Finding:
    """Return the exponent of the modulus in the load at yield, alone and among the materials."""
    exponent = yield_exponent(E=2)
    materials = paper.five_materials(bench).values()
    logarithms = np.log(
        [
            (float(m.plane_strain_modulus), yield_load(m, paper.FIG2_DR["internal"]))
            for m in materials
        ]
    )
    among = float(np.polyfit(logarithms[:, 0], logarithms[:, 1], 1)[0])
    return Finding(
        f"by Eq 7 it goes as E to the power of {exponent:.2f}: a softer pair carries more",
        holds=exponent > 0,
        choice="equal yield stress",
        miss=f"exponent {exponent:.0f}, the reverse",
        alternatives=[
            Alternative(
                "the five materials, each with its own yield stress",
                f"as E to the power of {among:.2f} (least squares of the logarithms)",
                among > 0,
                paper.TABLE_1,
                f"exponent {among:.2f}, the reverse",
            )
        ],
        values={"exponent, -": exponent, "exponent among the materials, -": among},
    )


@claim(
    "3.4-low-clearance-low-load",
    "(i) very small clearances with low loads have no practical application",
    paper="no application",
    against="Not reproduced: the paper's own comparison takes in such contacts, from 7.5 µm and "
    "10 N/mm on.",
)
def low_clearance_low_load() -> Finding:
    """Return no value: there is no criterion for practical application."""
    return untestable("the paper gives no measure of practical application; stress is lowest there")


@claim(
    "3.4-high-clearance-high-load",
    "(ii) large clearances with high loads lie beyond yield",
    paper="yield is quickly reached",
    rule="every material yields below 1000 N/mm at 2 mm",
    figures=("fig07",),
    against="Reproduced: at the smallest of the paper's radii all five yield there, and the others "
    "of its figures need not be meant.",
)
def high_clearance_high_load(bench: Bench) -> Finding:
    """Return the load at yield in N/mm at the largest clearance."""
    materials = paper.five_materials(bench)

    def reading(choice: str, R_i: float, strength: float = 1.0, missing: str = "") -> Alternative:
        loads = {name: strength**2 * yield_load(m, LARGEST, R_i) for name, m in materials.items()}
        last = max(loads, key=loads.__getitem__)
        return Alternative(
            choice,
            f"the last to yield is the {last}, at {loads[last]:.0f} N/mm",
            loads[last] < HIGHEST,
            missing,
            unless(loads[last] < HIGHEST, f"{loads[last] - HIGHEST:.0f} N/mm above 1000 N/mm"),
        )

    loads = {name: yield_load(m, LARGEST) for name, m in materials.items()}
    late = {name: load for name, load in loads.items() if load >= HIGHEST}
    early = max((load for load in loads.values() if load < HIGHEST), default=math.nan)
    own = reading("R_i = 10 mm, our yield stresses", paper.HOLE_RADIUS, missing=paper.TABLE_1)
    told = (
        f"at {LARGEST:g} mm and R_i = {paper.HOLE_RADIUS:g} mm "
        f"{listed(late, '({:.0f} N/mm)', ' and ')} do not yield below {HIGHEST:g} N/mm; the others "
        f"do, at {early:.0f} N/mm or less"
    )
    return found(
        [
            replace(own, ours=told) if late else own,
            reading("R_i = 10 mm, yield stresses a fifth lower", 10.0, 0.8, paper.TABLE_1),
            reading("R_i = 5 mm", 5.0),
            reading("R_i = 100 mm", 100.0),
        ],
        values=with_unit(loads, "N/mm"),
    )


def at_largest_clearance(
    choice: str,
    material: Material,
    load: float,
    R_i: float,
    missing: str = "",
    of: str = "yield stress",
) -> Alternative:
    """Return whether a load makes a material yield at 2 mm, where the stress is largest."""
    ratio = stress_ratio(material, load, R_i)
    text = f"{100 * ratio:.0f} % of the {of} under {load:g} N/mm at 2 mm"
    miss = unless(ratio >= 1, f"{100 * (1 - ratio):.0f} points short")
    return Alternative(choice, text, ratio >= 1, missing, miss)


def with_place(own: Alternative, material: Material, load: float, of: str) -> Alternative:
    """Return the reading by which a load makes a material yield, told in full."""
    percent = 100 * stress_ratio(material, load)
    return replace(
        own,
        ours=f"in a {paper.HOLE_RADIUS:g} mm hole at {LARGEST:g} mm Hertz's peak pressure under "
        f"{load:g} N/mm is {percent:.0f} % of the {of}",
    )


def stress_ratio(material: Material, load: float, R_i: float = paper.HOLE_RADIUS) -> float:
    """Return Hertz's stress over the yield stress at the largest clearance, where it is largest."""
    return math.sqrt(load / yield_load(material, LARGEST, R_i))


@claim(
    "3.4-hard-material-small-load",
    "(iii) very hard materials reach their elastic limit even under very small loads",
    paper="limit quickly reached",
    rule="the tensile strength is reached somewhere in 7.5 µm ≤ ΔR ≤ 2 mm",
    figures=("fig07", "fig10"),
    against="Not reproduced: the limit is reached only in the smallest hole at nearly the largest "
    "clearance, which is not quickly.",
)
def hard_material_small_load(bench: Bench) -> Finding:
    """Return the stress over the strength of the hardest material under the smallest load."""
    ceramics = bench.material("ceramics").material
    stronger = replace(ceramics, yield_stress=500.0)

    def reading(material: Material, R_i: float, missing: str = "") -> Alternative:
        choice = f"R_i = {R_i:g} mm, {material.yield_stress:g} MPa"
        return at_largest_clearance(choice, material, LOWEST, R_i, missing, "strength")

    return found(
        [
            with_place(
                reading(ceramics, paper.HOLE_RADIUS, paper.TABLE_1),
                ceramics,
                LOWEST,
                f"ceramics' strength of {ceramics.yield_stress:g} MPa",
            ),
            reading(ceramics, 5.0),
            reading(stronger, 5.0, paper.TABLE_1),
            reading(ceramics, 100.0),
        ],
        values={"stress over strength, -": stress_ratio(ceramics, LOWEST)},
    )


@claim(
    "3.4-soft-material-high-load",
    "(iv) weak materials such as aluminium alloys reach yield under very high loads",
    paper="limit quickly reached",
    rule="yield is reached somewhere in 7.5 µm ≤ ΔR ≤ 2 mm",
    figures=("fig07", "fig14"),
    against="Reproduced: the loads are called extremely high without a bound, and high enough ones "
    "reach yield at any radius.",
)
def soft_material_high_load(bench: Bench) -> Finding:
    """Return the stress over the yield stress of the aluminium alloy under the highest load."""
    material = bench.material(ALUMINIUM).material
    return found(
        [
            with_place(
                at_largest_clearance("R_i = 10 mm", material, HIGHEST, 10.0),
                material,
                HIGHEST,
                f"{ALUMINIUM}'s yield stress",
            ),
            *(
                [
                    at_largest_clearance(f"R_i = {R_i:g} mm", material, HIGHEST, R_i)
                    for R_i in (5.0, 100.0)
                ]
            ),
        ],
        values={"stress over yield stress, -": stress_ratio(material, HIGHEST)},
    )
