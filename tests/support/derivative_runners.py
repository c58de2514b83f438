"""Derivatives and energy of exported joints in the plane, over rows of motions and directions.

A row is the impact rate, bearing, pin and a direction of both; the answer is the two blocks of the
Jacobian, the derivative of the wrench without its flag, and the energy.
"""

import ctypes

import numpy as np

from tests.support.export_runners import C_FLAGS, FORTRAN_FLAGS, compile_with, run_octave_script
from tests.support.joint_runners import write

RESULTS = 36 + 36 + 12 + 1
C_WRAPPER = """
#include <string.h>
#include "element.h"
void run(int rows, const double *x, double *y);
void run(int rows, const double *x, double *y)
{{
    for (int k = 0; k < rows; k++, x += 25, y += 85) {{
        {name}_state state;
        {name}_jacobian jacobian;
        {name}_wrench derivative;
        state.impact_rate = x[0];
        {name}_evaluate_jacobian(&state, x + 1, x + 7, &jacobian);
        {name}_differentiate(&state, x + 1, x + 7, x + 13, x + 19, &derivative);
        memcpy(y, &jacobian, 72 * sizeof(double));
        memcpy(y + 72, &derivative, 12 * sizeof(double));
        y[84] = {name}_elastic_energy(x + 1, x + 7);
    }}
}}
"""
FORTRAN_WRAPPER = """
subroutine run(rows, x, y) bind(c)
    use, intrinsic :: iso_c_binding, only: c_int, c_double
    use {name}
    implicit none
    integer(c_int), value :: rows
    real(c_double), intent(in) :: x(25, rows)
    real(c_double), intent(out) :: y(85, rows)
    type({name}_state) :: state
    type({name}_jacobian) :: jacobian
    type({name}_wrench) :: w
    integer :: k
    do k = 1, rows
        state%impact_rate = x(1, k)
        call {name}_evaluate_jacobian(state, x(2:7, k), x(8:13, k), jacobian)
        call {name}_differentiate(state, x(2:7, k), x(8:13, k), x(14:19, k), x(20:25, k), w)
        y(1:36, k) = jacobian%by_position
        y(37:72, k) = jacobian%by_velocity
        y(73:84, k) = [w%force_bearing, w%moment_bearing, w%force_pin, w%moment_pin, &
            w%penetration, w%penetration_rate, w%normal_force, w%friction_force, &
            w%tangential_velocity, w%dissipated_power]
        y(85, k) = {name}_elastic_energy(x(2:7, k), x(8:13, k))
    end do
end subroutine run
"""
OCTAVE_SCRIPT = """
1;
addpath('{folder}');
id = fopen('{folder}/in', 'r'); x = fread(id, [25, {rows}], 'double'); fclose(id);
y = zeros(85, {rows});
joint = element();
for k = 1:{rows}
    b = x(2:7, k)'; p = x(8:13, k)';
    j = joint.evaluate_jacobian(x(1, k), b, p);
    w = struct2cell(joint.differentiate(x(1, k), b, p, x(14:19, k)', x(20:25, k)'));
    y(:, k) = [reshape(j.by_position.', 1, []), reshape(j.by_velocity.', 1, []), ...
        w{{1:end - 1}}, joint.elastic_energy(b, p)]';
end
id = fopen('{folder}/out', 'w'); fwrite(id, y, 'double'); fclose(id);
"""


def run_c(joint, rows, folder):
    (folder / "run.c").write_text(C_WRAPPER.format(name=joint.identifier), encoding="ascii")
    library = folder / "run.so"
    source = write(joint, "c", folder)
    compile_with("gcc", *C_FLAGS, source, folder / "run.c", "-o", library, "-lm")
    return _called(library, rows)


def run_fortran(joint, rows, folder):
    text = FORTRAN_WRAPPER.format(name=joint.identifier)
    (folder / "run.f90").write_text(text, encoding="ascii")
    library, source = folder / "run_fortran.so", write(joint, "fortran", folder)
    flags = (*FORTRAN_FLAGS, f"-J{folder}")
    compile_with("gfortran", *flags, source, folder / "run.f90", "-o", library, "-lm")
    return _called(library, rows)


def _called(library, rows):
    x, y = np.ascontiguousarray(rows), np.empty((len(rows), RESULTS))
    pointers = (ctypes.c_void_p(part.ctypes.data) for part in (x, y))
    ctypes.CDLL(str(library)).run(ctypes.c_int(len(rows)), *pointers)
    return y


def run_matlab(joint, rows, folder):
    write(joint, "matlab", folder)
    np.ascontiguousarray(rows).tofile(folder / "in")
    run_octave_script(OCTAVE_SCRIPT.format(folder=folder, rows=len(rows)), folder)
    return np.fromfile(folder / "out").reshape(len(rows), RESULTS)


RUNNERS = {"c": run_c, "fortran": run_fortran, "matlab": run_matlab}
