"""Exported laws run in their own languages, each over columns of arguments.

Each runner takes all cases at once, and returns load and stiffness of every row by name.
"""

import ctypes
import re
import subprocess

import numpy as np

from tests.support.programs import require_program

LIBRARY = ("-Wall", "-Wextra", "-Werror", "-O2", "-fPIC", "-shared")
STRICT = ("-pedantic", "-Wconversion", "-Wshadow", "-Wdouble-promotion")
C_FLAGS = ("-std=c99", *LIBRARY, *STRICT, "-Wmissing-prototypes")
CPP_FLAGS = ("-x", "c++", "-std=c++11", "-Wall", "-Wextra", "-Wconversion", "-Werror")
FORTRAN_FLAGS = ("-std=f2008", "-pedantic", *LIBRARY)
SECONDS = 300  # of any program

# Each law under a name of its own; what its file has beside is renamed by macros.
C_CASE = """
{renamed}
#include "{name}.c"
{restored}
#include "{name}.h"
void run_{k}(int rows, const double *x, double *y);
void run_{k}(int rows, const double *x, double *y)
{{
    for (int k = 0; k < rows; k++, x += {columns}, y += 2) {{
        y[0] = {name}_load({given});
        y[1] = {name}_stiffness({given});
    }}
}}
"""
LOCAL = re.compile(r"^static .*?(\w+)(?: =|\(|\[)|^\} (\w+);", re.MULTILINE)
FORTRAN_CASE = """{source}
subroutine run_{k}(rows, x, y) bind(c)
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
end subroutine run_{k}
"""
OCTAVE_CASE = """
addpath('{folder}');
id = fopen('{folder}/in', 'r'); x = fread(id, [{rows}, {columns}], 'double'); fclose(id);
x = num2cell(x, 1);
[f, k] = {name}(x{{:}});
id = fopen('{folder}/out', 'w'); fwrite(id, [f, k], 'double'); fclose(id);
rmpath('{folder}');
"""


def run_c(cases, folder):
    """Compile the C exports of all cases as one file, as C and as C++; run them."""
    require_program("gcc")
    require_program("g++")
    text, headers = ["#include <math.h>\n#include <stdbool.h>\n#include <stdlib.h>"], []
    for k, case in enumerate(cases.values()):
        name = f"{case.name}_{k}"
        source, header = (
            part.replace(case.name, name) for part in (case.source("c"), case.header())
        )
        (folder / f"{name}.c").write_text(source, encoding="ascii")
        header = header.replace(case.name.upper(), name.upper())
        (folder / f"{name}.h").write_text(header, encoding="ascii")
        headers.append(f'#include "{name}.h"')
        local = sorted({"".join(found) for found in LOCAL.findall(source)})
        shape = {"columns": len(case.arguments), "given": _given("x[{}]", case, 0)}
        renamed = "\n".join(f"#define {one} {one}_{k}" for one in local)
        restored = "\n".join(f"#undef {one}" for one in local)
        text.append(C_CASE.format(name=name, k=k, renamed=renamed, restored=restored, **shape))
    (folder / "run.c").write_text("\n".join(text), encoding="ascii")
    (folder / "headers.h").write_text("\n".join(headers), encoding="ascii")
    without = re.sub(r'#include ".*\.h"', "", "\n".join(text))
    (folder / "plain.c").write_text(without, encoding="ascii")
    compile_with("g++", *CPP_FLAGS, "-fsyntax-only", folder / "plain.c", folder / "headers.h")
    compile_with("gcc", *C_FLAGS, folder / "run.c", "-o", folder / "run.so", "-lm")
    return _called(folder / "run.so", cases)


def run_fortran(cases, folder):
    """Compile the Fortran exports of all cases as one file; run them."""
    require_program("gfortran")
    text = []
    for k, case in enumerate(cases.values()):
        name = f"{case.name}_{k}"
        source = case.source("fortran").replace(case.name, name)
        shape = {"columns": len(case.arguments), "given": _given("x({}, :)", case, 1)}
        text.append(FORTRAN_CASE.format(source=source, name=name, k=k, **shape))
    (folder / "run.f90").write_text("\n".join(text), encoding="ascii")
    flags = (*FORTRAN_FLAGS, f"-J{folder}", folder / "run.f90")
    compile_with("gfortran", *flags, "-o", folder / "run.so", "-lm")
    return _called(folder / "run.so", cases)


def _given(form, case, first):
    return ", ".join(form.format(k + first) for k in range(len(case.arguments)))


def _called(library, cases):
    library, answers = ctypes.CDLL(str(library)), {}
    for k, (name, case) in enumerate(cases.items()):
        x, y = np.column_stack(list(case.arguments.values())), np.empty((case.rows, 2))
        pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (np.ascontiguousarray(x), y)]
        library[f"run_{k}"](ctypes.c_int(case.rows), *pointers)
        answers[name] = y.T
    return answers


def run_octave(cases, folder, more=""):
    """Run the MATLAB exports of all cases, and `more`, in one Octave."""
    require_program("octave-cli")
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


RUNNERS = {"c": run_c, "fortran": run_fortran, "matlab": run_octave}


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
