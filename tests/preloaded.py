"""What the processes of tests/killable.py have imported before they start."""

import filelock  # noqa: F401

import cylcontact.cli
import cylcontact.cli.app
import cylcontact.fitting
import cylcontact.fitting.profile  # noqa: F401
