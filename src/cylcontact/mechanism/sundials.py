"""SUNDIALS CVODE as scikit-sundae ships it, called with compiled functions.

scikit-sundae's own interface calls Python for every right-hand side, which costs some eight
microseconds, and a revolution of the crank takes five to fifty thousand of them. CVODE itself
takes the address of a C function. The library is the one that scikit-sundae has loaded: looking a
symbol up in its extension module searches what that module is linked to, so no file name is
guessed. The callbacks are numba's C functions; the parameter block goes to them as user data.

Adams' formulas of variable step and order with functional iteration: no Jacobian, no linear
algebra, the predictor–corrector of the paper.
"""

from __future__ import annotations

import ctypes
from ctypes import c_double, c_int, c_long, c_ssize_t
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types as numba_types
from numba.extending import intrinsic
from numba.np.numpy_support import carray
from numpy.typing import NDArray

from cylcontact.compiled import compiled
from cylcontact.errors import InputError
from cylcontact.mechanism import contact

# Symbols used, with their arguments; pointers travel as integers of their size.
_SIGNATURES: dict[str, tuple[Any, ...]] = {
    "SUNContext_Create": (c_int, c_ssize_t),
    "SUNContext_Free": (c_ssize_t,),
    "SUNContext_ClearErrHandlers": (c_ssize_t,),
    "N_VDestroy": (c_ssize_t,),
    "CVodeCreate": (c_int, c_ssize_t),
    "CVodeInit": (c_ssize_t, c_ssize_t, c_double, c_ssize_t),
    "CVodeReInit": (c_ssize_t, c_double, c_ssize_t),
    "CVodeSVtolerances": (c_ssize_t, c_double, c_ssize_t),
    "CVodeSetUserData": (c_ssize_t, c_ssize_t),
    "CVodeSetMaxStep": (c_ssize_t, c_double),
    "CVodeSetInitStep": (c_ssize_t, c_double),
    "CVodeSetStopTime": (c_ssize_t, c_double),
    "CVodeSetMaxNumSteps": (c_ssize_t, c_long),
    "CVodeSetNonlinearSolver": (c_ssize_t, c_ssize_t),
    "CVodeRootInit": (c_ssize_t, c_int, c_ssize_t),
    "CVodeSetRootDirection": (c_ssize_t, c_ssize_t),
    "CVodeSetNoInactiveRootWarn": (c_ssize_t,),
    "CVodeGetRootInfo": (c_ssize_t, c_ssize_t),
    "CVodeGetDky": (c_ssize_t, c_double, c_int, c_ssize_t),
    "CVodeGetCurrentTime": (c_ssize_t, c_ssize_t),
    "CVodeGetNumRhsEvals": (c_ssize_t, c_ssize_t),
    "CVode": (c_ssize_t, c_double, c_ssize_t, c_ssize_t, c_int),
    "CVodeFree": (c_ssize_t,),
    "SUNNonlinSol_FixedPoint": (c_ssize_t, c_int, c_ssize_t),
    "SUNNonlinSolFree": (c_ssize_t,),
}
_RETURNING_POINTERS = ("CVodeCreate", "SUNNonlinSol_FixedPoint", "N_VMake_Serial")


@dataclass(frozen=True)
class Library:
    """The loaded library: its functions, and where an N_Vector keeps its data."""

    functions: dict[str, Any]
    data_words: int

    def __getattr__(self, name: str) -> Any:
        return self.functions[name]

    def address(self, name: str) -> int:
        """Return where a function is."""
        return int(ctypes.cast(self.functions[name], ctypes.c_void_p).value or 0)


@cache
def library() -> Library:
    """Find SUNDIALS in what scikit-sundae has loaded.

    Raises
    ------
    InputError
        If this build of scikit-sundae cannot be called in this way.
    """
    from sksundae import _cy_cvode
    from sksundae._cy_common import config

    index = {"int": c_int, "long int": c_long}.get(config["SUNDIALS_INT_TYPE"])
    shared = ctypes.CDLL(_cy_cvode.__file__)
    signatures = _SIGNATURES | {"N_VMake_Serial": (index, c_ssize_t, c_ssize_t)}
    try:
        if index is None or config["SUNDIALS_FLOAT_TYPE"] != "double":
            raise AttributeError(f"its numbers are {config['SUNDIALS_FLOAT_TYPE']}")
        functions = {name: getattr(shared, name) for name in signatures}
    except AttributeError as error:
        raise InputError(
            "scikit-sundae", "", None, f"cannot be called with compiled functions ({error})",
            "install the wheel of the lock file, make env",
        ) from error  # fmt: skip
    for name, arguments in signatures.items():
        functions[name].argtypes = arguments
        functions[name].restype = c_ssize_t if name in _RETURNING_POINTERS else c_int
    # struct {index length; int own_data; double *data;}
    words = (ctypes.sizeof(index) + ctypes.sizeof(c_int) + 7) // 8
    return Library(functions, words)


types: Any = numba_types
VECTOR, DOUBLES = types.CPointer(types.intp), types.CPointer(types.float64)
# A C function of CVODE's gets the addresses of two N_Vectors, or of one and of the roots.
RHS = types.int32(types.float64, VECTOR, VECTOR, DOUBLES)
ROOTS = types.int32(types.float64, VECTOR, DOUBLES, DOUBLES)


def _pointer_to(kind: Any) -> Any:
    """Return an intrinsic that turns an address into a pointer of a kind."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], context.get_value_type(signature.return_type))

    def declare(typing_context: Any, address: Any) -> Any:  # noqa: ARG001 - numba's signature
        return kind(types.intp), generate

    return intrinsic(declare)


_pointer_to_words, _pointer_to_doubles = _pointer_to(VECTOR), _pointer_to(DOUBLES)


def _function_at(result: Any, *arguments: Any) -> Any:
    """Return an intrinsic that calls the C function at an address.

    The address is an argument and no constant, so that what is compiled can be kept on disk.
    """

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        kinds = [context.get_value_type(kind) for kind in arguments]
        function = ir.FunctionType(context.get_value_type(result), kinds)
        values = [
            context.cast(builder, builder.extract_value(given[1], k), signature.args[1][k], kind)
            for k, kind in enumerate(arguments)
        ]
        return builder.call(builder.inttoptr(given[0], function.as_pointer()), values)

    def declare(typing_context: Any, address: Any, values: Any) -> Any:  # noqa: ARG001
        return result(types.intp, values), generate

    return intrinsic(declare)


_word, _double, _int = types.intp, types.float64, types.int32
# int CVode(memory, end, vector, &time, task), and so on: called as cvode(address, (…)).
call_step = _function_at(_int, _word, _double, _word, _word, _int)
call_interpolate = _function_at(_int, _word, _double, _int, _word)
call_two = _function_at(_int, _word, _word)
call_roots = _function_at(_int, _double, _word, _word, _word)


@compiled
def block(data: Any) -> NDArray[np.float64]:
    """Return the parameter block that a callback's user data point to."""
    return carray(data, (int(carray(data, (1,))[contact.SIZE]),))


@compiled
def values(vector: Any, p: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the data of a serial N_Vector as an array."""
    content = carray(_pointer_to_words(carray(vector, (1,))[0]), (3,))
    data = content[int(p[contact.LAYOUT])]
    return carray(_pointer_to_doubles(data), (int(p[contact.STATES]),))
