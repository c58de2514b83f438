"""What the options' help offers is what the package knows."""

import pytest

from cylcontact.cli import options
from cylcontact.fitting.measured import LOSSES
from cylcontact.fitting.noise import NOISES
from cylcontact.fitting.optimizers import OPTIMIZERS
from cylcontact.plots import style


@pytest.mark.parametrize(
    ("offered", "known"),
    [
        (options.LOSSES, LOSSES),
        (options.NOISES, NOISES),
        (options.OPTIMIZERS, OPTIMIZERS),
        (options.STYLES, style.STYLES),
    ],
)
def test_help_offers_what_there_is(offered, known):
    assert offered == tuple(known)
