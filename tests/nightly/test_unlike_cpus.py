"""Unlike processors agree closely: the same work with the instructions of older ones.

numpy, OpenBLAS, numba and the C library each choose their code by the instructions that the
processor has, and each can be told to do without some.
"""

import json
import os
import platform
import subprocess
import sys

import numpy as np
import pytest

from tests.support.spec_files import write_bench

WORK = """
import json, sys
from cylcontact.fitting import calibrate, Campaign
from numpy._core._multiarray_umath import __cpu_features__

result = calibrate(Campaign.read(sys.argv[1]))
print(json.dumps({
    "coefficients": list(result.coefficients.values()),
    "objective": [result.objective.value],
    "features": [name for name, has in __cpu_features__.items() if has],
}))
"""


def without(features, processor, hwcaps):
    return {
        "NPY_DISABLE_CPU_FEATURES": " ".join(features),
        "OPENBLAS_CORETYPE": processor,
        "NUMBA_CPU_NAME": processor.lower(),
        "NUMBA_CPU_FEATURES": "",
        "GLIBC_TUNABLES": f"glibc.cpu.hwcaps={hwcaps}",
    }


def older_processors():
    """Return the environments that stand for older processors than this one."""
    from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

    has = [name for name in __cpu_dispatch__ if __cpu_features__.get(name)]
    beyond = [name for name in has if "512" in name or name == "X86_V4"]
    if platform.machine() == "x86_64" and beyond and beyond != has:
        yield without(beyond, "Haswell", "-AVX512F,-AVX512VL,-AVX512BW,-AVX512DQ")
    if platform.machine() == "x86_64" and has:
        yield without(has, "Nehalem", "-AVX512F,-AVX512VL,-AVX2,-AVX,-FMA")


@pytest.mark.slow
def test_the_instructions_of_an_older_processor_give_nearly_the_same(tmp_path):
    older = list(older_processors())
    if not older:
        pytest.skip("this processor has no instructions that numpy could do without")
    campaign, found = str(write_bench(tmp_path)), []
    for number, variables in enumerate([{}, *older]):
        cache = {"OPENBLAS_NUM_THREADS": "1", "NUMBA_CACHE_DIR": str(tmp_path / str(number))}
        command = [sys.executable, "-c", WORK, campaign]
        env = {**os.environ, **cache, **variables}
        done = subprocess.run(command, env=env, capture_output=True, text=True, check=True)
        found.append(json.loads(done.stdout))
    own, *others = found
    for other in others:
        assert set(other["features"]) < set(own["features"])
        assert other["objective"] == pytest.approx(own["objective"], rel=1e-9)
        largest = np.abs(own["coefficients"]).max()
        assert other["coefficients"] == pytest.approx(own["coefficients"], abs=1e-6 * largest)
