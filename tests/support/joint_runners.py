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
from tests.support.export_runners import C_FLAGS, FORTRAN_FLAGS, compile_with, run_octave_script

# The functions as C has them, in Fortran.
FORTRAN_WRAPPER = """
subroutine run_evaluate(rates, bearing, pin, y) bind(c, name="{name}_evaluate")
    use, intrinsic :: iso_c_binding, only: c_double
    use {name}
    implicit none
    real(c_double), intent(in) :: rates({n}), bearing({size}), pin({size})
    real(c_double), intent(out) :: y({count})
    type({name}_state) :: state
    type({name}_wrench) :: w
    call {name}_start(state)
    state%impact_rate = rates{all}
    call {name}_evaluate(state, bearing, pin, w)
    y = [ &
        {results}]
end subroutine run_evaluate
subroutine run_accept(rates, bearing, pin) bind(c, name="{name}_accept")
    use, intrinsic :: iso_c_binding, only: c_double
    use {name}
    implicit none
    real(c_double), intent(in) :: bearing({size}), pin({size})
    real(c_double), intent(inout) :: rates({n})
    type({name}_state) :: state
    state%impact_rate = rates{all}
    call {name}_accept(state, bearing, pin)
    rates = state%impact_rate
end subroutine run_accept
"""
OCTAVE_SCRIPT = """
1;
addpath('{folder}');
id = fopen('{folder}/in', 'r'); x = fread(id, [{given}, {rows}], 'double'); fclose(id);
y = zeros({answered}, {rows});
joint = element();
for k = 1:{rows}
    rates = x(1:{n}, k)'; b = x({n}+1:{n}+{size}, k)'; p = x({n}+{size}+1:end, k)';
    w = joint.evaluate(rates, b, p);
    y(:, k) = [struct2cell(w){{:}}, joint.accept(rates, b, p)]';
end
id = fopen('{folder}/out', 'w'); fwrite(id, y, 'double'); fclose(id);
"""


def shape_of(one):
    """Return a joint's name, how many contacts, numbers of a body and results it has, by name."""
    element = Element(one)
    fields = fields_of(element.module.WRENCH)
    count = sum(kind.size if isinstance(kind, Vector) else 1 for kind in fields.values())
    sizes = {"n": element.contacts, "size": element.size, "count": count}
    return {"name": element.planar.identifier, **sizes}, fields


def write(one, target, folder, stem="element"):
    """Write the files of an exported joint; return the path of the first."""
    for name, text in export_joint(one, target, stem).items():
        (folder / name).write_text(text, encoding="ascii")
    return folder / f"{stem}{JOINT_TARGETS[target]}"


def run_library(joint, rows):
    """Return the answers of the library's own joint in the plane."""
    state, bearing, pin = JointState(rows[:, 0]), rows[:, 1:7], rows[:, 7:]
    accepted = joint.accept(state, bearing, pin).impact_rate
    return np.column_stack([*joint.evaluate(state, bearing, pin), accepted])


def run_c(one, rows, folder):
    library = folder / "element.so"
    compile_with("gcc", *C_FLAGS, write(one, "c", folder), "-o", library, "-lm")
    answers = _called(library, one, rows)
    flag = shape_of(one)[0]["count"] - 1
    answers[:, flag] = answers[:, flag].copy().view(np.int32)[::2]  # an int behind the numbers
    return answers


def run_fortran(one, rows, folder):
    shape, fields = shape_of(one)
    results = [f"real(w%{key}, c_double)" for key in fields]
    text = FORTRAN_WRAPPER.format(
        **shape, results=", &\n        ".join(results), all="(1)" if shape["n"] == 1 else ""
    )
    driver, library = folder / "run.f90", folder / "run_fortran.so"
    driver.write_text(text, encoding="ascii")
    source = write(one, "fortran", folder)
    compile_with("gfortran", *FORTRAN_FLAGS, f"-J{folder}", source, driver, "-o", library, "-lm")
    return _called(library, one, rows)


def _called(library, one, rows):
    """Call the two functions of a library over rows."""
    shape, _ = shape_of(one)
    n, size, count = shape["n"], shape["size"], shape["count"]
    library = ctypes.CDLL(str(library))
    evaluate, accept = (library[f"{shape['name']}_{what}"] for what in ("evaluate", "accept"))
    pointer = lambda part: ctypes.c_void_p(part.ctypes.data)  # noqa: E731
    answers = np.zeros((len(rows), count + n))
    for row, answer in zip(np.ascontiguousarray(rows), answers, strict=True):
        answer[count:] = row[:n]
        given = pointer(answer[count:]), pointer(row[n:]), pointer(row[n + size :])
        evaluate(*given, pointer(answer))
        accept(*given)
    return answers


def run_matlab(one, rows, folder):
    write(one, "matlab", folder)
    rows.tofile(folder / "in")
    shape, _ = shape_of(one)
    numbers = {"rows": len(rows), "given": rows.shape[1], "answered": shape["count"] + shape["n"]}
    run_octave_script(OCTAVE_SCRIPT.format(folder=folder, **numbers, **shape), folder)
    return np.fromfile(folder / "out").reshape(len(rows), -1)


RUNNERS = {"c": run_c, "fortran": run_fortran, "matlab": run_matlab}
