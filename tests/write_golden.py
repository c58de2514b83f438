"""Write the files of tests/test_golden.py anew, a minute or two: python -m tests.write_golden.

Options are pytest's: `-k laws`, `-k "public or results"`, `-k "commands and fit"`.
"""

import os
import sys
from pathlib import Path

import pytest

if __name__ == "__main__":
    os.environ["WRITE_GOLDEN"] = "1"
    tests = Path(__file__).parent / "test_golden.py"
    sys.exit(pytest.main([str(tests), "-m", "slow or not slow", "-q", *sys.argv[1:]]))
