"""Fig 16: the slider-crank, drawn from its spec in a configuration that a simulation gives."""

from cylcontact.mechanism import simulate
from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.mechanism.disclosure import assumed
from cylcontact.reports.mechanism.overview import draw_overview, point_table
from cylcontact.reports.mechanism.runs import mechanism

REVOLUTION = 1.15
CAPTION = (
    "The mechanism of datasets/slider_crank.toml, to scale in mm, {revolution:g} revolutions after "
    "the start: {bodies}; the crank turns at {speed:.0f} rpm, {sense}. Names are the spec's, "
    "dots are centres of mass, the dashed circle is the crank pin's. All joints are ideal but "
    "the one in orange, between {bearing} (with the bearing) and {journal} (with the journal): on "
    "the right with its clearance of {c:g} mm magnified {scale:g} times against the bearing's "
    "radius of {R_i:g} mm. {assumed}"
)


def draw(bench: Bench) -> Drawing:
    one = mechanism(bench)
    run = simulate(one, revolutions=2)
    figure, pose, joint = draw_overview(run, REVOLUTION)
    table = point_table(pose)
    crank = table[table["body"] == "crank"].set_index("point")
    reach = crank.loc["pin", ["x_mm", "y_mm"]].astype(float)
    headline = {
        "radius of the crank circle, mm": float((reach**2).sum() ** 0.5),
        "eccentricity, mm": float((pose.eccentricity[0] ** 2 + pose.eccentricity[1] ** 2) ** 0.5),
        "magnification of the clearance, -": joint.factor,
    }
    caption = CAPTION.format(
        revolution=REVOLUTION,
        bodies=", ".join(body.name for body in one.bodies),
        speed=60 / one.period,
        sense="clockwise" if one.driver.speed < 0 else "anticlockwise",
        bearing=one.bodies[one.clearance.i].name,
        journal=one.bodies[one.clearance.j].name,
        c=joint.radial,
        scale=joint.factor,
        R_i=joint.R_bearing,
        assumed=assumed(one),
    )
    return Drawing(figure, table, headline, caption)
