"""Write the golden files of tests/package anew: python -m tests.support.write_golden.

Options are pytest's: `-k "commands and fit"`.
"""

import os
import sys
from pathlib import Path

import pytest

if __name__ == "__main__":
    os.environ["WRITE_GOLDEN"] = "1"
    tests = Path(__file__).parents[1]
    files = [str(tests / "package/test_golden.py")]
    files.append(f"{tests / 'reports/test_figures.py'}::test_numbers_behind_a_figure")
    sys.exit(pytest.main([*files, "-m", "slow or not slow", "-q", *sys.argv[1:]]))
