"""Fig 15: the joint with clearance, drawn to its definition from a step of a simulation."""

from cylcontact.mechanism import simulate
from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.mechanism.disclosure import assumed
from cylcontact.reports.mechanism.joint import configuration, draw_joint
from cylcontact.reports.mechanism.runs import mechanism

REVOLUTION = 1.1
CAPTION = (
    "The joint with clearance (Eqs 11 to 14). Body i has the bearing, of radius R_i = {R_i:g} mm, "
    "body j the journal, R_j = {R_j:g} mm. The eccentricity e = r_i - r_j points from the "
    "journal's centre to the bearing's; contact begins where it leaves the dashed circle of radius "
    "c = R_i - R_j = {c:g} mm, and the penetration is δ = |e| - c = {delta:.3g} µm. At the contact "
    "n = e/|e| and t = [n_y, -n_x]; orange, what acts on the bearing, f_i = -f_n n + f_t t, with "
    "f_n = {f_n:.0f} N and f_t = {f_t:.0f} N; the journal takes the opposite. Directions are "
    "those of the slider-crank (enhanced law) {revolution:.2f} revolutions after the start. Not "
    "to scale: the clearance is magnified {scale:g} times against the radius, the "
    "penetration {depth:.0f} times. {assumed}"
)


def draw(bench: Bench) -> Drawing:
    one = mechanism(bench)
    shown = configuration(simulate(one, revolutions=2), REVOLUTION)
    figure, table = draw_joint(shown)
    lengths = table.set_index("symbol")
    scale = lengths["drawn_mm"] / lengths["value_mm"]
    headline = {
        "eccentricity, mm": shown.eccentricity,
        "penetration, um": 1e3 * shown.penetration,
        "normal force, N": shown.normal_force,
        "friction force, N": shown.friction_force,
        "tangential velocity, m/s": shown.tangential_velocity,
    }
    caption = CAPTION.format(
        R_i=shown.R_i,
        R_j=shown.R_j,
        c=shown.clearance,
        delta=1e3 * shown.penetration,
        f_n=shown.normal_force,
        f_t=shown.friction_force,
        revolution=shown.revolution,
        scale=scale["c"],
        depth=scale["delta"],
        assumed=assumed(one),
    )
    return Drawing(figure, table, headline, caption)
