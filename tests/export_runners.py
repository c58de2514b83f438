"""Exported laws run in their own languages, each over columns of arguments."""

import ctypes
import subprocess

import numpy as np

from cylcontact.export import export
from tests.programs import require_program

LIBRARY = ("-Wall", "-Wextra", "-Werror", "-O2", "-fPIC", "-shared")
STRICT = ("-pedantic", "-Wconversion", "-Wshadow", "-Wmissing-prototypes", "-Wdouble-promotion")
C_FLAGS = ("-std=c99", *LIBRARY, *STRICT)
FORTRAN_FLAGS = ("-std=f2008", "-pedantic", *LIBRARY)

# Names that C can find, and arrays instead of scalars.
FORTRAN_WRAPPER = """
subroutine run(m, {names}, load, stiffness, f, k) bind(c)
    use, intrinsic :: iso_c_binding, only: c_int, c_double
    use {function}_law, only: both => {function}
    use {function}_law, only: only_load => {function}_load
    use {function}_law, only: only_stiffness => {function}_stiffness
    implicit none
    integer(c_int), value :: m
    real(c_double), intent(in) :: {shaped}
    real(c_double), intent(out) :: load(m), stiffness(m), f(m), k(m)
    call both({names}, load, stiffness)
    f = only_load({names})
    k = only_stiffness({names})
end subroutine run
"""

# Every case in one Octave: columns in, columns out.
OCTAVE_CASE = """
addpath('{folder}');
id = fopen('{folder}/in', 'r'); x = fread(id, [{rows}, {columns}], 'double'); fclose(id);
x = num2cell(x, 1);
[f, k] = {function}(x{{:}});
id = fopen('{folder}/out', 'w'); fwrite(id, [f, k], 'double'); fclose(id);
rmpath('{folder}');
"""


def run_c(case, folder):
    """Compile the C export and return load and stiffness of every row."""
    source, library = folder / "law.c", folder / "law_c.so"
    source.write_text(export(case.law, case.contact, "c"), encoding="ascii")
    compile_with("gcc", *C_FLAGS, source, "-o", library, "-lm")
    loaded = ctypes.CDLL(str(library))
    columns = [column.tolist() for column in case.arguments.values()]
    answers = []
    for which in ("load", "stiffness"):
        function = loaded[f"{case.function}_{which}"]
        function.argtypes, function.restype = [ctypes.c_double] * len(columns), ctypes.c_double
        answers.append(np.array(list(map(function, *columns))))
    return answers


def run_fortran(case, folder):
    """Compile the Fortran export and return load and stiffness, by subroutine and functions."""
    names = [f"x{i}" for i in range(len(case.arguments))]
    wrapper = FORTRAN_WRAPPER.format(
        function=case.function,
        names=", ".join(names),
        shaped=", ".join(f"{name}(m)" for name in names),
    )
    source, driver, library = folder / "law.f90", folder / "run.f90", folder / "law_f.so"
    source.write_text(export(case.law, case.contact, "fortran"), encoding="ascii")
    driver.write_text(wrapper, encoding="ascii")
    compile_with("gfortran", *FORTRAN_FLAGS, f"-J{folder}", source, driver, "-o", library)
    columns = [np.ascontiguousarray(column) for column in case.arguments.values()]
    answers = [np.empty(case.rows) for _ in range(4)]
    pointers = [column.ctypes.data_as(ctypes.c_void_p) for column in (*columns, *answers)]
    ctypes.CDLL(str(library)).run(ctypes.c_int(case.rows), *pointers)
    return answers


def run_octave(cases, folder, more=""):
    """Run the MATLAB exports of all cases, and `more`, in one Octave."""
    require_program("octave-cli")
    script = []
    for name, case in cases.items():
        place = folder / name
        place.mkdir()
        text = export(case.law, case.contact, "matlab")
        (place / f"{case.function}.m").write_text(text, encoding="ascii")
        np.column_stack(list(case.arguments.values())).T.tofile(place / "in")
        shape = {"rows": case.rows, "columns": len(case.arguments)}
        script.append(OCTAVE_CASE.format(folder=place, function=case.function, **shape))
    (folder / "all.m").write_text("1;\n" + "".join(script) + more, encoding="ascii")
    run_program("octave-cli", "--no-gui", "--norc", "--quiet", folder / "all.m")
    return {name: np.fromfile(folder / name / "out").reshape(2, -1) for name in cases}


def compile_with(compiler, *arguments):
    require_program(compiler)
    run_program(compiler, *arguments)


def run_program(*command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    # Octave 7 ends every script, good or bad, with a message about its own exit.
    assert done.returncode == 0, done.stderr
    assert "warning" not in done.stderr, done.stderr
    return done.stdout
