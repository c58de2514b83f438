"""What the options' help offers is what the package knows."""

import pytest

from cylcontact import pair
from cylcontact.cli import choices
from cylcontact.datasets.finite_element import ENGINES
from cylcontact.export import TARGETS
from cylcontact.fitting.loss import LOSSES
from cylcontact.fitting.optimizers import OPTIMIZERS
from cylcontact.mechanism import step_history, system
from cylcontact.plots import style
from cylcontact.reports import tables


@pytest.mark.parametrize(
    ("offered", "known"),
    [
        (choices.METHODS, system.METHODS),
        (choices.BEYOND, system.BEYOND),
        (choices.ENGINES, ENGINES),
        (choices.CONTACTS, pair.CONTACTS),
        (choices.OPTIMIZERS, OPTIMIZERS),
        (choices.LOSSES, LOSSES),
        (choices.STYLES, style.STYLES),
        (choices.FORMATS, style.FORMATS),
        (choices.TABLES, tables.KINDS),
        (choices.TARGETS, TARGETS),
    ],
)
def test_help_offers_what_there_is(offered, known):
    assert offered == tuple(known)


def test_types_are_those_of_the_mechanism():
    assert (choices.Method, choices.Beyond) == (step_history.Method, step_history.Beyond)
