"""Exported joints run in their own languages, each over rows of states.

A row is the impact rate and the motion of bearing and pin; the answer is the wrench, the force on
the pin and the accepted impact rate.
"""

import ctypes

import numpy as np

from cylcontact.export import JOINT_TARGETS, export_joint
from tests.support.export_runners import C_FLAGS, FORTRAN_FLAGS, LIBRARY, compile_with, run_program
from tests.support.programs import require_program

CPP_FLAGS = ("-std=c++11", *LIBRARY, "-pedantic", "-Wconversion", "-Wshadow")
GIVEN, ANSWERED = 13, 14

C_WRAPPER = """
#include "{stem}.h"
void run(int rows, const double *x, double *y);
void run(int rows, const double *x, double *y)
{{
    for (int k = 0; k < rows; k++, x += 13, y += 14) {{
        {name}_state state = {{x[0]}};
        {name}_wrench w;
        {name}_evaluate(&state, x + 1, x + 7, &w);
        {answer}
        {name}_accept(&state, x + 1, x + 7);
        y[13] = state.impact_rate;
    }}
}}
"""
CPP_WRAPPER = """
#include "{stem}.hpp"
extern "C" void run(int rows, const double *x, double *y)
{{
    for (int k = 0; k < rows; k++, x += 13, y += 14) {{
        {name} joint(x[0]);
        const {name}::wrench w = joint.evaluate(x + 1, x + 7);
        {answer}
        joint.accept(x + 1, x + 7);
        y[13] = joint.state();
    }}
}}
"""
ANSWER = """\
y[0] = w.force_bearing[0]; y[1] = w.force_bearing[1]; y[2] = w.moment_bearing;
        y[3] = w.moment_pin; y[4] = w.penetration; y[5] = w.penetration_rate;
        y[6] = w.normal_force; y[7] = w.friction_force; y[8] = w.tangential_velocity;
        y[9] = w.dissipated_power; y[10] = w.flag; y[11] = w.force_pin[0]; y[12] = w.force_pin[1];\
"""
FORTRAN_WRAPPER = """
subroutine run(rows, x, y) bind(c)
    use, intrinsic :: iso_c_binding, only: c_int, c_double
    use {name}
    implicit none
    integer(c_int), value :: rows
    real(c_double), intent(in) :: x(13, rows)
    real(c_double), intent(out) :: y(14, rows)
    type({name}_state) :: state
    type({name}_wrench) :: w
    integer :: k
    do k = 1, rows
        call {name}_start(state)
        state%impact_rate = x(1, k)
        call {name}_evaluate(state, x(2:7, k), x(8:13, k), w)
        y(1:2, k) = w%force_bearing
        y(3:4, k) = [w%moment_bearing, w%moment_pin]
        y(5:6, k) = [w%penetration, w%penetration_rate]
        y(7:9, k) = [w%normal_force, w%friction_force, w%tangential_velocity]
        y(10:11, k) = [w%dissipated_power, real(w%flag, c_double)]
        y(12:13, k) = w%force_pin
        call {name}_accept(state, x(2:7, k), x(8:13, k))
        y(14, k) = state%impact_rate
    end do
end subroutine run
"""
OCTAVE_SCRIPT = """
1;
addpath('{folder}');
id = fopen('{folder}/in', 'r'); x = fread(id, [13, {rows}], 'double'); fclose(id);
y = zeros(14, {rows});
joint = {stem}();
for k = 1:{rows}
    b = x(2:7, k)'; p = x(8:13, k)';
    w = joint.evaluate(x(1, k), b, p);
    y(:, k) = [w.force_bearing, w.moment_bearing, w.moment_pin, w.penetration, ...
        w.penetration_rate, w.normal_force, w.friction_force, w.tangential_velocity, ...
        w.dissipated_power, w.flag, w.force_pin, joint.accept(x(1, k), b, p)]';
end
id = fopen('{folder}/out', 'w'); fwrite(id, y, 'double'); fclose(id);
"""


def write(joint, target, folder, stem="element"):
    """Write the files of an exported joint; return the path of the first."""
    texts = export_joint(joint, target, stem)
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="ascii")
    return folder / f"{stem}{JOINT_TARGETS[target]}"


def run_library(joint, rows):
    """Return the answers of the library's own joint."""
    from cylcontact.mechanism import JointState

    state, bearing, pin = JointState(rows[:, 0]), rows[:, 1:7], rows[:, 7:]
    w = joint.evaluate(state, bearing, pin)
    accepted = joint.accept(state, bearing, pin).impact_rate
    return np.column_stack(
        [w.force_bearing, w.moment_bearing, w.moment_pin, *w[4:], w.force_pin, accepted]
    )


def run_c(joint, rows, folder):
    source = write(joint, "c", folder)
    return _compiled("gcc", C_FLAGS, C_WRAPPER, "run.c", joint, rows, folder, source)


def run_cpp(joint, rows, folder):
    write(joint, "cpp", folder)
    return _compiled("g++", CPP_FLAGS, CPP_WRAPPER, "run.cpp", joint, rows, folder)


def run_fortran(joint, rows, folder):
    source = write(joint, "fortran", folder)
    flags = (*FORTRAN_FLAGS, f"-J{folder}")
    return _compiled("gfortran", flags, FORTRAN_WRAPPER, "run.f90", joint, rows, folder, source)


def run_matlab(joint, rows, folder):
    require_program("octave-cli")
    write(joint, "matlab", folder)
    rows.tofile(folder / "in")
    text = OCTAVE_SCRIPT.format(folder=folder, rows=len(rows), stem="element")
    run_octave(text, folder)
    return np.fromfile(folder / "out").reshape(-1, ANSWERED)


def run_octave(text, folder):
    """Run a script in Octave; return what it printed."""
    require_program("octave-cli")
    script = folder / "script.m"
    script.write_text(text, encoding="ascii")
    return run_program("octave-cli", "--no-gui", "--norc", "--quiet", script)


def run_python(joint, rows, folder):
    names = {}
    exec(write(joint, "python", folder).read_text(encoding="ascii"), names)
    answers = []
    for rate, *motion in rows.tolist():
        bearing, pin = motion[:6], motion[6:]
        w = names["evaluate"](rate, bearing, pin)
        parts = (*w.force_bearing, w.moment_bearing, w.moment_pin, *w[4:], *w.force_pin)
        answers.append((*parts, names["accept"](rate, bearing, pin)))
    return np.array(answers)


RUNNERS = {
    "c": run_c, "cpp": run_cpp, "fortran": run_fortran, "matlab": run_matlab,
    "python": run_python,
}  # fmt: skip


def _compiled(compiler, flags, wrapper, name, joint, rows, folder, *sources):
    """Compile an export with a loop over rows around it, and run that."""
    driver, library = folder / name, folder / f"{name}.so"
    text = wrapper.format(name=joint.identifier, stem="element", answer=ANSWER)
    driver.write_text(text, encoding="ascii")
    compile_with(compiler, *flags, *sources, driver, "-o", library, "-lm")
    given, answers = np.ascontiguousarray(rows), np.empty((len(rows), ANSWERED))
    pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (given, answers)]
    ctypes.CDLL(str(library)).run(ctypes.c_int(len(rows)), *pointers)
    return answers
