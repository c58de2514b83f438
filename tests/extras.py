"""Tests that need an extra skip where it is absent, except in continuous integration."""

import importlib.util
import os

import pytest


def require_extra(module, extra):
    """Skip unless a module of an extra is installed; fail where CI is set, which must have it."""
    if importlib.util.find_spec(module) is None:
        absent = f"{module} is not installed (make extras, or pip install cylcontact[{extra}])"
        if os.environ.get("CI"):
            pytest.fail(absent)
        pytest.skip(absent)
