"""Unlike processors agree closely: the same work with the instructions of older ones."""

import sys

import pytest

from benchmarks.cpus import difference, in_process, instruction_sets
from tests.support.spec_files import write_bench

WORK = """
import json, sys
from cylcontact.fitting import calibrate, read_campaign
from numpy._core._multiarray_umath import __cpu_features__

result = calibrate(read_campaign(sys.argv[1]))
print(json.dumps({
    "coefficients": list(result.coefficients.values()),
    "objective": [result.objective.value],
    "features": sorted(name for name, has in __cpu_features__.items() if has),
}))
"""


@pytest.mark.slow
def test_the_instructions_of_an_older_processor_give_nearly_the_same(tmp_path):
    sets = instruction_sets()
    if len(sets) == 1:
        pytest.skip("this processor has no instructions that numpy could do without")
    command = [sys.executable, "-c", WORK, str(write_bench(tmp_path))]
    own, *others = [in_process(command, variables) for variables in sets.values()]
    for other in others:
        assert set(other["features"]) < set(own["features"])
        assert difference(own["objective"], other["objective"]) < 1e-9
        assert difference(own["coefficients"], other["coefficients"]) < 1e-6
