"""What all laws do alike: no contact, first touch, limits, arrays, single numbers, refusals."""

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, laws
from tests.strategies import NOT_TOUCHING

METHODS = ("load", "penetration", "stiffness")
INTERNAL = {name: law() for name, law in laws.LAWS.items()} | {
    "power, K": laws.PowerLaw(n=1.237, K=312148.0),
    "power, K_star": laws.PowerLaw(n=1.094, K_star=0.9),
    "power, C": laws.PowerLaw(n=1.0848, C=0.58),
    "lankarani-nikravesh, n = 1.2": laws.LankaraniNikravesh(n=1.2),
    "winkler, h = R": laws.Winkler(depth=1.0),
}
EXTERNAL = {name: laws.LAWS[name]() for name in ("johnson", "enhanced", "explicit")}


@pytest.fixture(params=[*INTERNAL, *(f"{name}, rollers" for name in EXTERNAL)])
def case(request, steel, pair, pairs):
    """A law, a pair, and three pairs as a column of which the second is given alone as well."""
    if request.param in INTERNAL:
        second = CylinderPair.internal(R_i=10.0, R_j=9.9, material=steel, length=12.0)
        return INTERNAL[request.param], pair, pairs, second
    column = CylinderPair.from_dR("external", [[5.0], [20.0], [500.0]], steel)
    one = CylinderPair.from_dR("external", 20.0, steel)
    return EXTERNAL[request.param.removesuffix(", rollers")], one, column, one


@pytest.mark.parametrize("method", METHODS)
def test_without_contact_there_is_no_answer_and_at_first_touch_nothing(case, method):
    law, pair, *_ = case
    assert np.isnan(getattr(law, method)(NOT_TOUCHING, pair)).all()
    assert [np.isnan(getattr(law, method)(value, pair)) for value in NOT_TOUCHING] == [True] * 4
    assert getattr(law, method)(0.0, pair) == 0.0


def test_limits_have_the_shape_of_the_pairs_and_only_logarithms_have_any(case):
    law, _, pairs, _ = case
    for limit in (law.max_load(pairs), law.max_penetration(pairs)):
        assert limit.shape == (3, 1)
        assert (np.isfinite(limit) == isinstance(law, laws.LogarithmicLaw)).all()


@pytest.mark.parametrize("method", METHODS)
def test_values_broadcast_against_pairs(case, method):
    law, _, pairs, second = case
    values = np.array([-1.0, 1e-4, 2e-4, np.nan])
    answers = getattr(law, method)(values, pairs)
    np.testing.assert_array_equal(np.isnan(answers), [[True, False, False, True]] * 3)
    np.testing.assert_allclose(answers[1], getattr(law, method)(values, second), rtol=1e-14)


def test_single_numbers_give_numpy_scalars_and_arrays_stay_arrays(case):
    law, pair, *_ = case
    answers = [getattr(law, method)(np.array(1e-3), pair) for method in METHODS]
    answers += [law.max_load(pair), law.max_penetration(pair)]
    answers += [getattr(law, name)(pair) for name in ("factor", "exponent") if hasattr(law, name)]
    assert {type(answer) for answer in answers} == {np.float64}
    for method in METHODS:
        for shape in ((0,), (1,), (2, 0)):
            assert getattr(law, method)(np.full(shape, 1e-3), pair).shape == shape


STEEL, BRASS = Material("steel", E=207e3, nu=0.3), Material("brass", E=100e3, nu=0.34)
ROLLERS = CylinderPair.external(R_i=10.0, R_j=9.0, material=STEEL, length=12.0)
HOLE = CylinderPair.internal(R_i=10.0, R_j=9.5, material=STEEL, length=12.0)
NO_RADII = CylinderPair.from_dR("internal", 0.5, STEEL, length=12.0)
NO_LENGTH = CylinderPair.from_dR("internal", 0.5, STEEL, R_i=10.0)
MIXED = CylinderPair.from_dR("internal", 0.5, STEEL, material_j=BRASS)
RADII, LENGTH = "needs both radii", "needs the axial length"
REFUSED = [
    (laws.Enhanced(laws.PUBLISHED["internal"]), ROLLERS, "are for internal contact and the pair"),
    (laws.Enhanced(laws.PUBLISHED["external"]), HOLE, "are for external contact and the pair is"),
    (laws.Liu(), ROLLERS, "pin in a hole"),
    (laws.Winkler(), ROLLERS, "must be internal: the foundation lines a hole"),
    (laws.Persson(), ROLLERS, "pair.contact = 'external': must be internal"),
    (laws.Johnson(), MIXED, RADII),
    (laws.Goldsmith(), NO_RADII, RADII),
    (laws.DubowskyFreudenstein(), NO_RADII, RADII),
    (laws.DubowskyFreudenstein(), NO_LENGTH, LENGTH),
    (laws.LankaraniNikravesh(), NO_RADII, RADII),
    (laws.LankaraniNikravesh(), NO_LENGTH, LENGTH),
]


@pytest.mark.parametrize("method", [*METHODS, "max_load", "max_penetration"])
@pytest.mark.parametrize(
    ("law", "pair", "words"), REFUSED, ids=[f"{law.name}, {words}" for law, _, words in REFUSED]
)
def test_a_pair_that_is_not_of_the_law_is_refused_whatever_is_asked(law, pair, words, method):
    arguments = (pair,) if method.startswith("max") else (1e-3, pair)
    with pytest.raises(InputError, match=words):
        getattr(law, method)(*arguments)
