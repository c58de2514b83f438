"""An element with several contacts in every language: its states, results and events are arrays.

The joint in the plane, with contacts at twice, three and four times its penetration besides.
"""

import ctypes
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cylcontact.export import element, fmu
from cylcontact.export.joint import element_of
from cylcontact.laws.formula import steps_of
from cylcontact.mechanism import read_joint
from tests.support.export_runners import (
    C_FLAGS,
    CPP_FLAGS,
    FORTRAN_FLAGS,
    compile_with,
    run_program,
)
from tests.support.fmu_masters import started
from tests.support.joint_runners import run_octave
from tests.support.programs import require_package, require_program

BEARING, PIN = [0.0] * 6, [51e-6, 0.0, 0.0, 0.02, 0.0, 0.0]
# The impact rates at first touch, and the penetrations.
WANTED = [*(0.02 * k for k in range(1, 5)), *(1e-6 * k for k in range(1, 5))]
C = """
#include "four.{suffix}"
{linkage} void run(const double *pin, double *y);
void run(const double *pin, double *y)
{{
    const double bearing[6] = {{0.0, 0.0, 0.0, 0.0, 0.0, 0.0}};
    {run}
    for (int k = 0; k < 4; k++) {{
        y[k] = r[k];
        y[k + 4] = w.penetration[k];
    }}
}}
"""
IN_C = """four_state s; four_wrench w; const double *r = s.impact_rate;
    four_start(&s); four_accept(&s, bearing, pin); four_evaluate(&s, bearing, pin, &w);"""
IN_CPP = """four joint; joint.accept(bearing, pin); const double *r = joint.state();
    const four::wrench w = joint.evaluate(bearing, pin);"""
FORTRAN = """
program main
    use four
    use, intrinsic :: iso_fortran_env, only: wp => real64
    type(four_state) :: state
    type(four_wrench) :: w
    real(wp) :: bearing(6) = 0.0_wp, pin(6) = [51e-6_wp, 0.0_wp, 0.0_wp, 0.02_wp, 0.0_wp, 0.0_wp]
    call four_start(state)
    call four_accept(state, bearing, pin)
    call four_evaluate(state, bearing, pin, w)
    print *, state%impact_rate, w%penetration
end program main
"""
OCTAVE = """
addpath('{folder}'); joint = four(); bearing = zeros(1, 6); pin = [51e-6 0 0 0.02 0 0];
rates = joint.accept(joint.start(), bearing, pin);
w = joint.evaluate(rates, bearing, pin);
printf('%.17g ', [rates, w.penetration]);
"""


@pytest.fixture(scope="module")
def four():
    one = element_of(read_joint(Path(__file__).parents[2] / "datasets/joint.toml"))
    text = "\n".join(step.text for step in one.steps)
    text = text.replace("impact_rate", "impact_rate_1").replace("next_rate", "next_rate_1") + "\n"
    for k in (2, 3, 4):
        text += (
            f"delta_{k} = {k}*delta\nrate_{k} = {k}*rate\n"
            f"first_{k} = impact_rate_{k} if impact_rate_{k} > 0 else max(rate_{k}, rate_floor)\n"
            f"next_rate_{k} = 0 if delta_{k} <= 0 else first_{k}\n"
        )
    several = {
        "penetration": ("delta", "delta_2", "delta_3", "delta_4"),
        "penetration_rate": ("rate", "rate_2", "rate_3", "rate_4"),
    }
    results = (each._replace(values=several.get(each.name, each.values)) for each in one.results)
    return replace(
        one, name="four", contacts=4, results=tuple(results), steps=steps_of(text), checks=()
    )


def run_c(folder, compiler, flags, suffix, *sources, **parts):
    (folder / "run.c").write_text(C.format(suffix=suffix, **parts))
    compile_with(compiler, *flags, *sources, folder / "run.c", "-o", folder / "run.so", "-lm")
    pin, y = np.array(PIN), np.empty(8)
    ctypes.CDLL(str(folder / "run.so")).run(*(x.ctypes.data_as(ctypes.c_void_p) for x in (pin, y)))
    return y


def run_in(language, folder):
    if language == "c":
        return run_c(folder, "gcc", C_FLAGS, "h", folder / "four.c", linkage="", run=IN_C)
    if language == "cpp":
        flags = ("-x", "c++", *CPP_FLAGS)
        return run_c(folder, "g++", flags, "hpp", linkage='extern "C"', run=IN_CPP)
    if language == "fortran":
        (folder / "run.f90").write_text(FORTRAN)
        flags = [flag for flag in FORTRAN_FLAGS if flag not in ("-shared", "-fPIC")]
        sources = (folder / "four.f90", folder / "run.f90")
        compile_with("gfortran", *flags, f"-J{folder}", *sources, "-o", folder / "run")
        return run_program(folder / "run").split()
    if language == "matlab":
        return run_octave("1;" + OCTAVE.format(folder=folder), folder).split()
    names = {}
    exec((folder / "four.py").read_text(), names)
    rates = names["accept"](names["start"](), BEARING, PIN)
    return [*rates, *names["evaluate"](rates, BEARING, PIN).penetration]


@pytest.mark.parametrize("language", ["c", "cpp", "fortran", "matlab", "python"])
def test_each_contact_has_a_state_and_a_penetration(four, language, tmp_path):
    for name, text in element.source(four, language, "").items():
        (tmp_path / name).write_text(text, encoding="ascii")
    answers = np.array(run_in(language, tmp_path), dtype=float)
    np.testing.assert_allclose(answers, WANTED, rtol=1e-9)


def test_the_fmu_has_an_event_for_each_contact(four, tmp_path):
    fmpy = require_package("fmpy")
    require_program("gcc")
    ((name, content),) = fmu.joint_source(four, "").items()
    path = tmp_path / name
    path.write_bytes(content)
    description = fmpy.read_model_description(path, validate=True)
    assert description.numberOfEventIndicators == 4
    references = {v.name: v.valueReference for v in description.modelVariables}
    model = started(path, tmp_path / "unpacked", inputs=[*BEARING, *PIN])
    names = [f"{name}_{k}" for name in ("impact_rate", "penetration") for k in range(1, 5)]
    answers = model.getReal([references[name] for name in names])
    np.testing.assert_allclose(answers, WANTED, rtol=1e-9)
    indicators = (ctypes.c_double * 4)()
    model.getEventIndicators(indicators, 4)
    assert list(indicators) == answers[4:]
