"""Exported laws run in their own languages, each over columns of arguments.

Each runner returns load and stiffness of every row.
"""

import ctypes
import subprocess

import numpy as np

from tests.support.programs import require_program

LIBRARY = ("-Wall", "-Wextra", "-Werror", "-O2", "-fPIC", "-shared")
STRICT = ("-pedantic", "-Wconversion", "-Wshadow", "-Wdouble-promotion")
C_FLAGS = ("-std=c99", *LIBRARY, *STRICT, "-Wmissing-prototypes")
CPP_FLAGS = ("-x", "c++", "-std=c++11", "-Wall", "-Wextra", "-Wconversion", "-Werror")
FORTRAN_FLAGS = ("-std=f2008", "-pedantic", *LIBRARY)
SECONDS = 300  # of any program

C_WRAPPER = """
#include "law.c"
#include "law.h"
void run(int rows, const double *x, double *y);
void run(int rows, const double *x, double *y)
{{
    for (int k = 0; k < rows; k++, x += {columns}, y += 2) {{
        y[0] = {name}_load({given});
        y[1] = {name}_stiffness({given});
    }}
}}
"""
FORTRAN_WRAPPER = """
subroutine run(rows, x, y) bind(c)
    use, intrinsic :: iso_c_binding, only: c_int, c_double
    use {name}_law
    implicit none
    integer(c_int), value :: rows
    real(c_double), intent(in) :: x({columns}, rows)
    real(c_double), intent(out) :: y(2, rows)
    y(1, :) = {name}_load( &
        {given})
    y(2, :) = {name}_stiffness( &
        {given})
end subroutine run
"""
OCTAVE_CASE = """
addpath('{folder}');
id = fopen('{folder}/in', 'r'); x = fread(id, [{rows}, {columns}], 'double'); fclose(id);
x = num2cell(x, 1);
[f, k] = {name}(x{{:}});
id = fopen('{folder}/out', 'w'); fwrite(id, [f, k], 'double'); fclose(id);
rmpath('{folder}');
"""


def run_c(case, folder):
    (folder / "law.c").write_text(case.source("c"), encoding="ascii")
    (folder / "law.h").write_text(case.header(), encoding="ascii")
    compile_with("g++", *CPP_FLAGS, "-fsyntax-only", folder / "law.c", folder / "law.h")
    return _compiled("gcc", C_FLAGS, "run.c", C_WRAPPER, case, folder)


def run_fortran(case, folder):
    (folder / "law.f90").write_text(case.source("fortran"), encoding="ascii")
    flags = (*FORTRAN_FLAGS, f"-J{folder}", folder / "law.f90")
    return _compiled("gfortran", flags, "run.f90", FORTRAN_WRAPPER, case, folder)


RUNNERS = {"c": run_c, "fortran": run_fortran}


def _compiled(compiler, flags, file, wrapper, case, folder):
    """Compile an export with a loop over rows around it, and run that."""
    columns = len(case.arguments)
    first, form = (1, "x({}, :)") if compiler == "gfortran" else (0, "x[{}]")
    given = ", ".join(form.format(k + first) for k in range(columns))
    driver, library = folder / file, folder / f"{file}.so"
    text = wrapper.format(name=case.name, columns=columns, given=given)
    driver.write_text(text, encoding="ascii")
    compile_with(compiler, *flags, driver, "-o", library, "-lm")
    x, y = np.column_stack(list(case.arguments.values())), np.empty((case.rows, 2))
    pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (np.ascontiguousarray(x), y)]
    ctypes.CDLL(str(library)).run(ctypes.c_int(case.rows), *pointers)
    return y.T


def run_octave(cases, folder, more=""):
    """Run the MATLAB exports of all cases, and `more`, in one Octave."""
    script = []
    for name, case in cases.items():
        place = folder / name
        place.mkdir()
        (place / f"{case.name}.m").write_text(case.source("matlab"), encoding="ascii")
        np.column_stack(list(case.arguments.values())).T.tofile(place / "in")
        shape = {"rows": case.rows, "columns": len(case.arguments)}
        script.append(OCTAVE_CASE.format(folder=place, name=case.name, **shape))
    run_octave_script("1;\n" + "".join(script) + more, folder)
    return {name: np.fromfile(folder / name / "out").reshape(2, -1) for name in cases}


def run_octave_script(text, folder):
    """Run a script; return what it printed."""
    require_program("octave-cli")
    (folder / "script.m").write_text(text, encoding="ascii")
    return run_program("octave-cli", "--no-gui", "--norc", "--quiet", folder / "script.m")


def compile_with(compiler, *arguments):
    require_program(compiler)
    run_program(compiler, *arguments)


def run_program(*command):
    done = subprocess.run(
        list(map(str, command)), capture_output=True, text=True, check=False, timeout=SECONDS
    )
    # Octave 7 ends every script, good or bad, with a message about its own exit.
    assert done.returncode == 0, done.stderr
    assert "warning" not in done.stderr, done.stderr
    return done.stdout
