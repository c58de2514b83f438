"""The finite elements of a pin that tilts, against series, and the joint against their table."""

from functools import cache

import numpy as np
import pandas as pd
import pytest

from benchmarks import tilted_pin
from benchmarks.tilted_pin import mesh_change
from cylcontact.files.spec import read_toml
from cylcontact.joint.spatial import EDGES, SpatialJoint

NU = tilted_pin.NU
WHOLE = np.array([0.0, 1.0])


@pytest.fixture(scope="module")
def table():
    return pd.read_csv(tilted_pin.FILE)


def michell(m, outer):
    """u_r at r = 1 under a pressure cos mφ, E = 1: a disc, or a ring held at its outer radius."""
    kappa = 3 - 4 * NU
    # For stress functions r^m, r^(m+2), r^−m, r^(2−m): σ_r, τ, and 2μu_r, 2μu_φ with their power.
    terms = np.array([
        [m * (1 - m), m * (m - 1), -m, m, m - 1],
        [-(m + 1) * (m - 2), m * (m + 1), kappa - m - 1, kappa + m + 1, m + 1],
        [-m * (m + 1), -m * (m + 1), m, m, -m - 1],
        [-(m + 2) * (m - 1), -m * (m - 1), kappa + m - 1, -(kappa - m + 1), 1 - m],
    ]).T  # fmt: skip
    if outer is None:
        terms = terms[:, :2]
        amounts = np.linalg.solve(terms[:2], [-1, 0])
    else:
        held = terms[2:4] * outer ** terms[4]
        amounts = np.linalg.solve(np.vstack([terms[:2], held]), [-1, 0, 0, 0])
    return abs((1 + NU) * terms[2] @ amounts)


@pytest.mark.parametrize("outer", [None, tilted_pin.OUTER])
def test_the_harmonics_in_plane_strain_are_those_of_the_series(outer):
    if outer is None:
        r = 1 - tilted_pin.graded(1, 0.003)[::-1]
        r[0] = 0
    else:
        r = 1 + tilted_pin.graded(outer - 1, 0.003)
    found = tilted_pin.compliances(r, WHOLE, 1, plane=True)[0, :, 0, 0]
    for m in (2, 3, 8, 50):
        assert found[tilted_pin.HARMONICS.index(m)] == pytest.approx(michell(m, outer), rel=1e-4)


def test_the_mesh_has_converged(table):
    assert mesh_change(table) < 0.7


@pytest.mark.slow
@pytest.mark.parametrize(("depth", "share"), [(0.1, np.inf), (0.03, 0.25), (0.1, 0.1 / 2.2)])
def test_a_coarse_mesh_and_cells_give_the_committed_forces(table, depth, share):
    row = table[(table["length"] == 1) & (table["ends"] == "flush")]
    row = row[(row["depth"] == depth) & np.isclose(row["share"], share)].iloc[0]
    contact = coarse_contact()
    place = tilted_pin.Place(1.0, depth, share)
    force, moment = contact.resultant(place.centre, place.tilt)
    assert force == pytest.approx(row["force"], rel=0.02)
    assert moment == pytest.approx(row["moment"], abs=0.01 * row["force"])
    # Nowhere a tension.
    assert contact.pressures(place.centre, place.tilt)[1].min() >= 0


@cache
def coarse_contact():
    first, half = 0.01, 0.5
    hole = 1 + tilted_pin.graded(tilted_pin.OUTER - 1, first)
    pin = 1 - tilted_pin.graded(1, first)[::-1]
    pin[0] = 0
    edges = half - tilted_pin.graded(half, first)[::-1]
    edges[0] = 0
    S = sum(tilted_pin.compliances(r, edges, half) for r in (hole, pin)) / (2 * (1 - NU**2))
    return tilted_pin.Contact.of(edges, S, 100)


@pytest.mark.parametrize("ends", ["flush", "overhang"])
def test_the_joint_is_near_the_elements(table, ends):
    chosen = alike(table, ends)
    force, moment = tilted_pin.with_rim(chosen, *EDGES[ends])
    errors = force / chosen["force"].to_numpy() - 1
    assert errors.min() > -0.07
    assert errors.max() < 0.25
    assert np.sqrt((errors**2).mean()) < 0.07
    arms = (moment / force - chosen["moment"] / chosen["force"]) / (0.5 * chosen["length"])
    assert abs(arms).max() < 0.04
    # Slices alone miss more than nine tenths of it.
    assert (chosen["force"] / chosen["lamina_force"]).max() > 10
    c, b = tilted_pin.constants(chosen)
    assert (c, b) == pytest.approx(EDGES[ends], rel=0.25)


def alike(table, ends):
    chosen = table[(table["first_element"] == tilted_pin.FIRST) & (table["ends"] == ends)]
    return chosen[(chosen["materials"] == "alike") & np.isfinite(chosen["share"])]


def test_unlike_materials_need_constants_of_their_own(table):
    chosen = table[(table["materials"] == "soft hole") & (table["ends"] == "overhang")]
    chosen = chosen[np.isfinite(chosen["share"])]
    force, _ = tilted_pin.with_rim(chosen, *EDGES["overhang"])
    assert (force / chosen["force"]).max() > 1.5
    c, b = tilted_pin.constants(chosen)
    force, _ = tilted_pin.with_rim(chosen, c, b)
    assert abs(force / chosen["force"] - 1).max() < 0.07
    # A rim of a soft hole does not feel whether the hard pin goes on.
    flush = table[(table["materials"] == "soft hole") & (table["ends"] == "flush")]
    assert tilted_pin.constants(flush[np.isfinite(flush["share"])]) == pytest.approx(
        (c, b), rel=0.05
    )


def test_the_joint_has_the_term_that_the_table_is_held_against():
    data = read_toml("datasets/spatial_joint.toml") | {"units": "mm"}
    data["friction"] = {"coefficient": 0.0, "v0": 1.0, "v1": 10.0}
    joints = [
        SpatialJoint.from_data(data | {"edge": {"kind": kind}}) for kind in ("overhang", "none")
    ]
    R, gap, length = 10.0, data["clearance"], data["length"]
    place = tilted_pin.Place(length / R, 0.1, 0.25)
    slope, shift = place.tilt * gap / R, place.centre * gap
    half = 0.5 * np.arctan(slope)
    pin = [shift, 0, 0, np.cos(half), 0, np.sin(half), 0, *[0] * 6]
    still = [0, 0, 0, 1, 0, 0, 0, *[0] * 6]
    with_it, without = (joint.evaluate(joint.start(), still, pin) for joint in joints)
    E_star = float(joints[0].planar.pair.E_star)
    added = abs(with_it.force_pin[0] - without.force_pin[0])
    force, _ = tilted_pin.rim_term(place, *EDGES["overhang"])
    # The joint's ellipse of the section makes the rim a little deeper, by R_j·ψ²/2.
    assert added == pytest.approx(force * E_star * gap * R, rel=2e-3)
