"""What the processes of tests/support/killable.py have imported before they start."""

import cylcontact.cli
import cylcontact.cli.app
import cylcontact.datasets.finite_element
import cylcontact.fitting
import cylcontact.fitting.profiles
import cylcontact.mechanism  # noqa: F401
