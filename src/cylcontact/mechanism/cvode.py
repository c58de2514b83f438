"""SUNDIALS CVODE from scikit-sundae, called with compiled functions.

scikit-sundae's own interface calls Python for every right-hand side. Each call costs about eight
microseconds, and a revolution of the crank takes five to fifty thousand of them. CVODE itself takes
the address of a C function. This module uses the library that scikit-sundae has loaded: a symbol
lookup in the extension module also searches its linked libraries, so no file name is guessed. The
callbacks are C functions from numba and receive the parameter block as user data.

The method is Adams' with variable step and order and functional iteration: no Jacobian, no linear
algebra, the predictor–corrector of the paper.
"""

from __future__ import annotations

import ctypes
import weakref
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

from cylcontact.arrays import FloatArray
from cylcontact.errors import InputError
from cylcontact.mechanism import contact, events
from cylcontact.numba_cache import compiled

__all__ = [
    "RHS_SIGNATURE",
    "ROOTS_SIGNATURE",
    "Integrator",
    "Library",
    "Stretch",
    "block",
    "library",
    "values",
]

# The symbols used, with their arguments; pointers are passed as integers of their size.
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
    """The loaded library: its functions, and the offset of the data in an N_Vector in words."""

    functions: dict[str, Any]
    data_words: int

    def __getattr__(self, name: str) -> Any:
        return self.functions[name]

    def address(self, name: str) -> int:
        """Return the address of a function."""
        return int(ctypes.cast(self.functions[name], ctypes.c_void_p).value or 0)


@cache
def library() -> Library:
    """Return SUNDIALS as loaded by scikit-sundae.

    Raises
    ------
    InputError
        If this build of scikit-sundae cannot be called with compiled functions.
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


_types: Any = numba_types
_VECTOR_POINTER, _DOUBLES = _types.CPointer(_types.intp), _types.CPointer(_types.float64)
# The callbacks get the addresses of two N_Vectors, or of one N_Vector and the roots.
RHS_SIGNATURE = _types.int32(_types.float64, _VECTOR_POINTER, _VECTOR_POINTER, _DOUBLES)
ROOTS_SIGNATURE = _types.int32(_types.float64, _VECTOR_POINTER, _DOUBLES, _DOUBLES)


def _pointer_to(kind: Any) -> Any:
    """Return an intrinsic that turns an address into a pointer of a kind."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], context.get_value_type(signature.return_type))

    def declare(typing_context: Any, address: Any) -> Any:  # noqa: ARG001 - numba's signature
        return kind(_types.intp), generate

    return intrinsic(declare)


_pointer_to_words, _pointer_to_doubles = _pointer_to(_VECTOR_POINTER), _pointer_to(_DOUBLES)


def _function_at(result: Any, *arguments: Any) -> Any:
    """Return an intrinsic that calls the C function at an address.

    The address is an argument, not a constant, so that the compiled code can be cached on disk.
    """

    def generate(context: Any, builder: Any, signature: Any, passed: Any) -> Any:
        kinds = [context.get_value_type(kind) for kind in arguments]
        function = ir.FunctionType(context.get_value_type(result), kinds)
        values = [
            context.cast(builder, builder.extract_value(passed[1], k), signature.args[1][k], kind)
            for k, kind in enumerate(arguments)
        ]
        return builder.call(builder.inttoptr(passed[0], function.as_pointer()), values)

    def declare(typing_context: Any, address: Any, values: Any) -> Any:  # noqa: ARG001
        return result(_types.intp, values), generate

    return intrinsic(declare)


_word, _double, _int = _types.intp, _types.float64, _types.int32
# int CVode(memory, end, vector, &time, task), and so on: called as cvode(address, (…)).
_call_step = _function_at(_int, _word, _double, _word, _word, _int)
_call_interpolate = _function_at(_int, _word, _double, _int, _word)
_call_two = _function_at(_int, _word, _word)
_call_roots = _function_at(_int, _double, _word, _word, _word)


@compiled
def block(data: Any) -> NDArray[np.float64]:
    """Return the parameter block from the user data of a callback."""
    return carray(data, (int(carray(data, (1,))[contact.SIZE]),))


@compiled
def values(vector: Any, p: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the data of a serial N_Vector as an array."""
    content = carray(_pointer_to_words(carray(vector, (1,))[0]), (3,))
    data = content[int(p[contact.LAYOUT])]
    return carray(_pointer_to_doubles(data), (int(p[contact.STATES]),))


_ONE_STEP = 2
_ROOT_RETURN = 2
_BISECTIONS = 60

# Positions in the array of addresses: CVODE's functions, the model's roots, CVODE's memory, the two
# N_Vectors, the time, the flags of the roots, the values of the roots, and the parameter block.
_CVODE, _INTERPOLATE, _WHICH, _CURRENT_TIME, _ROOTS = 0, 1, 2, 3, 4
_MEMORY, _VECTOR, _OTHER, _CLOCK, _FLAGS, _SCRATCH, _BLOCK = 5, 6, 7, 8, 9, 10, 11
_ADDRESSES = 12


@compiled
def _step(
    at: NDArray[np.intp],
    y: FloatArray,
    other: FloatArray,
    now: FloatArray,
    flags: NDArray[np.int32],
    scratch: FloatArray,
    p: FloatArray,
    end: float,
    buffers: tuple[FloatArray, FloatArray],
) -> tuple[int, int]:
    """Step until the buffers are full, the time `end` is reached or an event occurs.

    Parameters
    ----------
    at : array of int
        The addresses.
    y, other, now, flags, scratch : array
        The arrays at `_VECTOR`, `_OTHER`, `_CLOCK`, `_FLAGS` and `_SCRATCH`.
    p : array of float
        The parameter block.
    end : float
        In s.
    buffers : pair of array
        Output: the time and the state after each step.

    Returns
    -------
    rows, flag : int
        Rows filled and CVODE's flag; an event is in `flags`, by the numbers in `events`.
    """
    times, states = buffers
    in_contact = p[contact.MODE] == contact.CONTACT
    for n in range(times.size):
        before = now[0]
        flag = _call_step(at[_CVODE], (at[_MEMORY], end, at[_VECTOR], at[_CLOCK], _ONE_STEP))
        times[n], states[n] = now[0], y
        if flag == _ROOT_RETURN:
            _call_two(at[_WHICH], (at[_MEMORY], at[_FLAGS]))
            if flags[events.CROSSING] != 0:
                if p[contact.ALLOWED_PENETRATION] > 0.0 and not in_contact:
                    times[n] = _onset_in_step(at, now, scratch, p, before)
                    states[n] = other
            elif flags[events.TURNING] != 0:
                delta = _gap(at, now[0], at[_VECTOR], scratch)
                if (delta > 0.0) != in_contact:
                    # On the wrong side of the circle: the step has skipped a crossing.
                    times[n] = _bisect(at, scratch, p, before, now[0], 0.0)
                    states[n], flags[events.CROSSING] = other, 1
            if flags[events.CROSSING] != 0 or flags[events.LIMIT] != 0:
                return n + 1, flag
        elif flag != 0:
            return n + 1, flag
    return times.size, 0


@compiled
def _gap(at: NDArray[np.intp], t: float, vector: int, scratch: FloatArray) -> Any:
    """Return δ of the state in an N_Vector."""
    _call_roots(at[_ROOTS], (t, vector, at[_SCRATCH], at[_BLOCK]))
    return scratch[events.CROSSING]


@compiled
def _inside(at: NDArray[np.intp], t: float, scratch: FloatArray) -> Any:
    """Put the state at a time inside the last step into `_OTHER` and return its δ."""
    _call_interpolate(at[_INTERPOLATE], (at[_MEMORY], t, 0, at[_OTHER]))
    return _gap(at, t, at[_OTHER], scratch)


@compiled
def _bisect(
    at: NDArray[np.intp],
    scratch: FloatArray,
    p: FloatArray,
    before: float,
    after: float,
    high: float,
) -> float:
    """Return a time with 0 ≤ δ ≤ high; δ increases in flight and decreases in contact."""
    rising = p[contact.MODE] == contact.FREE
    for _ in range(_BISECTIONS):
        middle = 0.5 * (before + after)
        delta = _inside(at, middle, scratch)
        if 0.0 <= delta <= high:
            return middle
        if (delta > high) == rising:
            after = middle
        else:
            before = middle
    _inside(at, after, scratch)
    return after


@compiled
def _onset_in_step(
    at: NDArray[np.intp], now: FloatArray, scratch: FloatArray, p: FloatArray, before: float
) -> float:
    """Return the onset of contact with the paper's control: halve the step until it is shallow."""
    _call_two(at[_CURRENT_TIME], (at[_MEMORY], at[_CLOCK]))
    allowed = p[contact.ALLOWED_PENETRATION]
    if _inside(at, now[0], scratch) > allowed:
        return _bisect(at, scratch, p, before, now[0], allowed)
    return float(now[0])


_ADAMS = 1
# The functions that the compiled loop calls, in the order of their addresses.
_STEPPING = ("CVode", "CVodeGetDky", "CVodeGetRootInfo", "CVodeGetCurrentTime")
# Steps between two checks for Ctrl-C.
_BUFFER = 4096
# CVODE limits the number of steps to one output, which may be far away here.
_MAX_STEPS = 10_000_000


@dataclass(frozen=True)
class Stretch:
    """The accepted steps of one call, and why it ended.

    `event` is `events.CROSSING`, `events.LIMIT`, or None at the end of the interval.
    """

    times: FloatArray
    states: FloatArray
    event: int | None
    flag: int


class Integrator:
    """CVODE's memory for one model; freed with the object.

    Parameters
    ----------
    model : module
        `minimal_coordinates` or `augmented`: the callbacks and the eccentricity.
    p : array of float
        The parameter block; the callbacks read it at every evaluation.
    rtol : float
        Relative tolerance.
    atol : array of float
        Absolute tolerance of each state.
    max_step, first_step : float
        In s; a first step of 0 leaves the choice to CVODE.
    """

    def __init__(
        self,
        model: Any,
        p: FloatArray,
        rtol: float,
        atol: FloatArray,
        max_step: float,
        first_step: float,
    ) -> None:
        self.p = p
        size = atol.size
        self._y, self._other, self._atol = np.zeros(size), np.zeros(size), atol.copy()
        self._now, self._scratch = np.zeros(1), np.zeros(events.EVENTS)
        self._flags = np.zeros(events.EVENTS, dtype=np.int32)
        self._direction = events.directions(in_contact=False)
        self._buffers = np.empty(_BUFFER), np.empty((_BUFFER, size))
        self._create(model, rtol, max_step, first_step)

    def _create(self, model: Any, rtol: float, max_step: float, first_step: float) -> None:
        lib, size = library(), self._y.size
        context = np.zeros(1, dtype=np.intp)
        lib.SUNContext_Create(0, context.ctypes.data)
        ctx = int(context[0])
        lib.SUNContext_ClearErrHandlers(ctx)
        vectors = [
            lib.N_VMake_Serial(size, array.ctypes.data, ctx)
            for array in (self._y, self._other, self._atol)
        ]
        memory = lib.CVodeCreate(_ADAMS, ctx)
        solver = lib.SUNNonlinSol_FixedPoint(vectors[0], 0, ctx)
        self._memory, self._vector = memory, vectors[0]
        self._at = np.zeros(_ADDRESSES, dtype=np.intp)
        self._at[:_ROOTS] = [lib.address(name) for name in _STEPPING]
        self._at[_ROOTS], self._at[_MEMORY] = model.roots.address, memory
        self._at[_VECTOR], self._at[_OTHER] = vectors[:2]
        self._at[_CLOCK:] = [
            array.ctypes.data for array in (self._now, self._flags, self._scratch, self.p)
        ]
        lib.CVodeInit(memory, model.rhs.address, 0.0, vectors[0])
        lib.CVodeSVtolerances(memory, rtol, vectors[2])
        lib.CVodeSetUserData(memory, self.p.ctypes.data)
        lib.CVodeSetNonlinearSolver(memory, solver)
        if np.isfinite(self.p[contact.CLEARANCE]):  # an ideal joint has no events
            lib.CVodeRootInit(memory, events.EVENTS, model.roots.address)
        lib.CVodeSetNoInactiveRootWarn(memory)
        lib.CVodeSetMaxStep(memory, max_step)
        lib.CVodeSetInitStep(memory, first_step)
        lib.CVodeSetMaxNumSteps(memory, _MAX_STEPS)
        weakref.finalize(self, _free, memory, solver, vectors, ctx)

    def restart(self, t: float, y: FloatArray) -> None:
        """Restart from a state, in the mode of the parameter block."""
        lib = library()
        self._y[:] = y
        self._now[0] = t
        self._direction[:] = events.directions(self.p[contact.MODE] == contact.CONTACT)
        lib.CVodeReInit(self._memory, t, self._vector)
        lib.CVodeSetRootDirection(self._memory, self._direction.ctypes.data)

    def advance(self, end: float) -> Stretch:
        """Step to `end` in s or to an event, whichever comes first."""
        library().CVodeSetStopTime(self._memory, end)
        times, states, flag = [], [], 0
        while flag == 0:
            self._flags[:] = 0
            count, flag = _step(
                self._at, self._y, self._other, self._now, self._flags, self._scratch,
                self.p, end, self._buffers,
            )  # fmt: skip
            times.append(self._buffers[0][:count].copy())
            states.append(self._buffers[1][:count].copy())
        event = None
        if flag == _ROOT_RETURN:
            event = events.LIMIT if self._flags[events.LIMIT] else events.CROSSING
        return Stretch(np.concatenate(times), np.concatenate(states), event, flag)

    @property
    def evaluations(self) -> int:
        """Evaluations of the right-hand side since the last restart."""
        count = np.zeros(1, dtype=np.int_)
        library().CVodeGetNumRhsEvals(self._memory, count.ctypes.data)
        return int(count[0])


def _free(memory: int, solver: int, vectors: list[int], context: int) -> None:
    """Free CVODE's memory, in the order that SUNDIALS requires."""
    lib = library()
    lib.CVodeFree(np.array([memory], dtype=np.intp).ctypes.data)
    lib.SUNNonlinSolFree(solver)
    for vector in vectors:
        lib.N_VDestroy(vector)
    lib.SUNContext_Free(np.array([context], dtype=np.intp).ctypes.data)
