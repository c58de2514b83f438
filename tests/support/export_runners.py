"""Exported laws run in their own languages, each over columns of arguments.

Each runner returns load and stiffness of every row.
"""

import ctypes
import subprocess

import numpy as np

from cylcontact.export import export
from tests.support.programs import require_package, require_program

LIBRARY = ("-Wall", "-Wextra", "-Werror", "-O2", "-fPIC", "-shared")
STRICT = ("-pedantic", "-Wconversion", "-Wshadow", "-Wdouble-promotion")
C_FLAGS = ("-std=c99", *LIBRARY, *STRICT, "-Wmissing-prototypes")
CPP_FLAGS = ("-std=c++11", *LIBRARY, *STRICT)
FORTRAN_FLAGS = ("-std=f2008", "-pedantic", *LIBRARY)

C_WRAPPER = """
{include}
{linkage} void run(int rows, const double *x, double *y);
void run(int rows, const double *x, double *y)
{{
    for (int k = 0; k < rows; k++, x += {columns}, y += 4) {{
        {both}({given}, y, y + 1);
        y[2] = {load}({given});
        y[3] = {stiffness}({given});
    }}
}}
"""
FORTRAN_WRAPPER = """
subroutine run(rows, x, y) bind(c)
    use, intrinsic :: iso_c_binding, only: c_int, c_double
    use {name}_law, only: {name}
    use {name}_law, only: {name}_load
    use {name}_law, only: {name}_stiffness
    implicit none
    integer(c_int), value :: rows
    real(c_double), intent(in) :: x({columns}, rows)
    real(c_double), intent(out) :: y(4, rows)
    call {name}( &
        {given}, y(1, :), y(2, :))
    y(3, :) = {name}_load( &
        {given})
    y(4, :) = {name}_stiffness( &
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


def write(case, target, folder, file):
    """Write an export; return its path."""
    path = folder / file
    path.write_text(export(case.law, case.contact, target), encoding="ascii")
    return path


def run_c(case, folder):
    law = write(case, "c", folder, "law.c")
    include = f'#include "{law}"'
    names = {"both": case.name, "load": f"{case.name}_load", "stiffness": f"{case.name}_stiffness"}
    return _compiled("gcc", C_FLAGS, "run.c", C_WRAPPER, case, folder, include, "", **names)


def run_cpp(case, folder):
    law = write(case, "cpp", folder, "law.hpp")
    names = {what: f"{case.name}::{what}" for what in ("load", "stiffness")}
    names["both"] = f"{case.name}::evaluate"
    include, linkage = f'#include "{law}"', 'extern "C"'
    return _compiled(
        "g++", CPP_FLAGS, "run.cpp", C_WRAPPER, case, folder, include, linkage, **names
    )


def run_fortran(case, folder):
    law = write(case, "fortran", folder, "law.f90")
    flags = (*FORTRAN_FLAGS, f"-J{folder}", law)
    return _compiled("gfortran", flags, "run.f90", FORTRAN_WRAPPER, case, folder)


def _compiled(compiler, flags, file, wrapper, case, folder, include="", linkage="", **names):
    """Compile an export with a loop over rows around it, and run that."""
    columns = len(case.arguments)
    first, form = (1, "x({}, :)") if compiler == "gfortran" else (0, "x[{}]")
    given = ", ".join(form.format(k + first) for k in range(columns))
    text = wrapper.format(
        include=include, linkage=linkage, name=case.name, columns=columns, given=given, **names
    )
    driver, library = folder / file, folder / f"{file}.so"
    driver.write_text(text, encoding="ascii")
    compile_with(compiler, *flags, driver, "-o", library, "-lm")
    x, y = np.column_stack(list(case.arguments.values())), np.empty((case.rows, 4))
    pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (np.ascontiguousarray(x), y)]
    ctypes.CDLL(str(library)).run(ctypes.c_int(case.rows), *pointers)
    np.testing.assert_array_equal(y[:, :2], y[:, 2:])
    return y[:, 0], y[:, 1]


def run_octave(cases, folder, more=""):
    """Run the MATLAB exports of all cases, and `more`, in one Octave."""
    require_program("octave-cli")
    script = []
    for name, case in cases.items():
        place = folder / name
        place.mkdir()
        write(case, "matlab", place, f"{case.name}.m")
        np.column_stack(list(case.arguments.values())).T.tofile(place / "in")
        shape = {"rows": case.rows, "columns": len(case.arguments)}
        script.append(OCTAVE_CASE.format(folder=place, name=case.name, **shape))
    (folder / "all.m").write_text("1;\n" + "".join(script) + more, encoding="ascii")
    run_program("octave-cli", "--no-gui", "--norc", "--quiet", folder / "all.m")
    return {name: np.fromfile(folder / name / "out").reshape(2, -1) for name in cases}


def module_of(case, target):
    """Return the names of a Python module."""
    names = {}
    exec(export(case.law, case.contact, target), names)
    return names


def run_python(case, _folder):
    evaluate = module_of(case, "python")["evaluate"]
    return np.array([evaluate(*row) for row in case.each_row()]).T


def run_jax(case, _folder):
    """Load and stiffness under jit, grad and vmap."""
    jax = require_jax()
    both = jax.jit(jax.vmap(jax.value_and_grad(module_of(case, "jax")["load"])))
    return [np.asarray(answer) for answer in both(*case.arguments.values())]


def require_jax():
    """Return JAX in double precision; skip without it."""
    jax = require_package("jax")
    jax.config.update("jax_enable_x64", True)
    return jax


RUNNERS = {
    "c": run_c, "cpp": run_cpp, "fortran": run_fortran, "python": run_python, "jax": run_jax,
}  # fmt: skip


def compile_with(compiler, *arguments):
    require_program(compiler)
    run_program(compiler, *arguments)


def run_program(*command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    # Octave 7 ends every script, good or bad, with a message about its own exit.
    assert done.returncode == 0, done.stderr
    assert "warning" not in done.stderr, done.stderr
    return done.stdout
