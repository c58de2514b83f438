"""Exported joints run in their own languages, each over rows of states.

A row is the impact rates and the motion of bearing and pin; the answer is the wrench, in the order
of its results, and the accepted impact rates.
"""

import ctypes

import numpy as np

from cylcontact.export import JOINT_TARGETS, export_joint
from cylcontact.export.joint import Element
from cylcontact.export.plain import Vector, fields_of
from cylcontact.mechanism import JointState
from tests.support.export_runners import (
    C_FLAGS,
    FORTRAN_FLAGS,
    compile_with,
    run_program,
)
from tests.support.programs import require_program

C_WRAPPER = """
#include "element.h"
void run(int rows, const double *x, double *y);
void run(int rows, const double *x, double *y)
{{
    for (int k = 0; k < rows; k++, x += {given}, y += {answered}) {{
        {evaluated}
        {results}
        {accepted};
        {rates}
    }}
}}
"""
FORTRAN_WRAPPER = """
subroutine run(rows, x, y) bind(c)
    use, intrinsic :: iso_c_binding, only: c_int, c_double
    use {name}
    implicit none
    integer(c_int), value :: rows
    real(c_double), intent(in) :: x({given}, rows)
    real(c_double), intent(out) :: y({answered}, rows)
    type({name}_state) :: state
    type({name}_wrench) :: w
    integer :: k
    do k = 1, rows
        call {name}_start(state)
        state%impact_rate = x({rates}, k)
        call {name}_evaluate(state, x({bearing}, k), x({pin}, k), w)
        {results}
        call {name}_accept(state, x({bearing}, k), x({pin}, k))
        y({last}:, k) = state%impact_rate
    end do
end subroutine run
"""
OCTAVE_SCRIPT = """
1;
addpath('{folder}');
id = fopen('{folder}/in', 'r'); x = fread(id, [{given}, {rows}], 'double'); fclose(id);
y = zeros({answered}, {rows});
joint = element();
for k = 1:{rows}
    rates = x({rates}, k)'; b = x({bearing}, k)'; p = x({pin}, k)';
    w = joint.evaluate(rates, b, p);
    y(:, k) = [struct2cell(w){{:}}, joint.accept(rates, b, p)]';
end
id = fopen('{folder}/out', 'w'); fwrite(id, y, 'double'); fclose(id);
"""


def element_of(one):
    """Return a joint's element, the count of numbers given, and that of each result's."""
    element = Element(one)
    sizes = {
        name: kind.size if isinstance(kind, Vector) else 1
        for name, kind in fields_of(element.module.WRENCH).items()
    }
    return element, element.contacts + 2 * element.size, sizes


def write(one, target, folder, stem="element"):
    """Write the files of an exported joint; return the path of the first."""
    texts = export_joint(one, target, stem)
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="ascii")
    return folder / f"{stem}{JOINT_TARGETS[target]}"


def run_library(joint, rows):
    """Return the answers of the library's own joint in the plane."""
    state, bearing, pin = JointState(rows[:, 0]), rows[:, 1:7], rows[:, 7:]
    w = joint.evaluate(state, bearing, pin)
    accepted = joint.accept(state, bearing, pin).impact_rate
    return np.column_stack([*w, accepted])


def run_c(one, rows, folder):
    """Compile in C a loop over rows around the joint, and run that."""
    source = write(one, "c", folder)
    element, given, sizes = element_of(one)
    n, name, size = element.contacts, element.planar.identifier, element.size
    parts = [f"[{k}]" for k in range(n)] if n > 1 else [""]
    items = [
        f"w.{key}[{k}]" if count > 1 else f"w.{key}"
        for key, count in sizes.items() for k in range(count)
    ]  # fmt: skip
    bodies = f"x + {n}, x + {n + size}"
    rates = "".join(f" state.impact_rate{part} = x[{k}];" for k, part in enumerate(parts))
    answers = [*items, *(f"state.impact_rate{part}" for part in parts)]
    lines = [f"y[{k}] = {item};" for k, item in enumerate(answers)]
    driver, library = folder / "run.c", folder / "run_c.so"
    text = C_WRAPPER.format(
        given=given, answered=len(answers), accepted=f"{name}_accept(&state, {bodies})",
        evaluated=f"{name}_state state;{rates} {name}_wrench w; "
        f"{name}_evaluate(&state, {bodies}, &w);",
        results=" ".join(lines[:-n]), rates=" ".join(lines[-n:]),
    )  # fmt: skip
    driver.write_text(text, encoding="ascii")
    compile_with("gcc", *C_FLAGS, source, driver, "-o", library, "-lm")
    return _called(library, rows, len(answers))


def slices(element):
    """Return where rates, bearing and pin are in a row, from 1."""
    n, size = element.contacts, element.size
    spans = {"bearing": f"{n + 1}:{n + size}", "pin": f"{n + size + 1}:{n + 2 * size}"}
    return {"rates": "1" if n == 1 else f"1:{n}", **spans}


def run_fortran(one, rows, folder):
    source = write(one, "fortran", folder)
    element, given, sizes = element_of(one)
    lines, at = [], 1
    for key, count in sizes.items():
        item = f"real(w%{key}, c_double)" if key == "flag" else f"w%{key}"
        lines.append(f"y({at}:{at + count - 1}, k) = {item}")
        at += count
    driver, library = folder / "run.f90", folder / "run_fortran.so"
    text = FORTRAN_WRAPPER.format(
        name=element.planar.identifier, given=given, answered=at + element.contacts - 1, last=at,
        results="\n        ".join(lines), **slices(element),
    )  # fmt: skip
    if element.contacts == 1:
        text = text.replace(f"y({at}:, k)", f"y({at}, k)")
    driver.write_text(text, encoding="ascii")
    flags = (*FORTRAN_FLAGS, f"-J{folder}")
    compile_with("gfortran", *flags, source, driver, "-o", library, "-lm")
    return _called(library, rows, at + element.contacts - 1)


def _called(library, rows, count):
    given, answers = np.ascontiguousarray(rows), np.empty((len(rows), count))
    pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (given, answers)]
    ctypes.CDLL(str(library)).run(ctypes.c_int(len(rows)), *pointers)
    return answers


def run_matlab(one, rows, folder):
    write(one, "matlab", folder)
    rows.tofile(folder / "in")
    element, given, sizes = element_of(one)
    count = sum(sizes.values()) + element.contacts
    shape = {"rows": len(rows), "given": given, "answered": count}
    text = OCTAVE_SCRIPT.replace("{rates}", slices(element)["rates"])
    spans = {key: span for key, span in slices(element).items() if key != "rates"}
    run_octave(text.format(folder=folder, **shape, **spans), folder)
    return np.fromfile(folder / "out").reshape(-1, count)


def run_octave(text, folder):
    """Run a script in Octave; return what it printed."""
    require_program("octave-cli")
    script = folder / "script.m"
    script.write_text(text, encoding="ascii")
    return run_program("octave-cli", "--no-gui", "--norc", "--quiet", script)


RUNNERS = {"c": run_c, "fortran": run_fortran, "matlab": run_matlab}
