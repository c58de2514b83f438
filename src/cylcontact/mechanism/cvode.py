"""One stretch of integration: CVODE steps until an event, all steps kept."""

from __future__ import annotations

import weakref
from dataclasses import dataclass
from typing import Any

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.mechanism import contact, events, stepping
from cylcontact.mechanism.sundials import library

ADAMS = 1
# What the compiled loop calls, in the order of its addresses.
STEPPING = ("CVode", "CVodeGetDky", "CVodeGetRootInfo", "CVodeGetCurrentTime")
# Steps that are taken between two looks at the keyboard.
BUFFER = 4096
# CVODE counts the steps towards one output; ours may be far away.
MAX_STEPS = 10_000_000


@dataclass(frozen=True)
class Stretch:
    """What one call gave: the accepted steps, and why it ended.

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
        `minimal` or `multiplier`: the callbacks and the eccentricity.
    p : array of float
        The parameter block, read by the callbacks at every evaluation.
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
        self._found = np.zeros(events.EVENTS, dtype=np.int32)
        self._direction = events.directions(in_contact=False)
        self._buffers = np.empty(BUFFER), np.empty((BUFFER, size))
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
        memory = lib.CVodeCreate(ADAMS, ctx)
        solver = lib.SUNNonlinSol_FixedPoint(vectors[0], 0, ctx)
        self._memory, self._vector = memory, vectors[0]
        self._at = np.zeros(stepping.ADDRESSES, dtype=np.intp)
        self._at[: stepping.ROOTS] = [lib.address(name) for name in STEPPING]
        self._at[stepping.ROOTS], self._at[stepping.MEMORY] = model.roots.address, memory
        self._at[stepping.VECTOR], self._at[stepping.OTHER] = vectors[:2]
        self._at[stepping.CLOCK :] = [
            array.ctypes.data for array in (self._now, self._found, self._scratch, self.p)
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
        lib.CVodeSetMaxNumSteps(memory, MAX_STEPS)
        weakref.finalize(self, _free, memory, solver, vectors, ctx)

    def restart(self, t: float, y: FloatArray) -> None:
        """Start anew from a state, in the mode that the parameter block says."""
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
        buffer_t, buffer_y = self._buffers
        while flag == 0:
            self._found[:] = 0
            count, flag = stepping.step(
                self._at, self._y, self._other, self._now, self._found, self._scratch,
                self.p, end, buffer_t, buffer_y,
            )  # fmt: skip
            times.append(buffer_t[:count].copy())
            states.append(buffer_y[:count].copy())
        event = None
        if flag == stepping.ROOT_RETURN:
            event = events.LIMIT if self._found[events.LIMIT] else events.CROSSING
        return Stretch(np.concatenate(times), np.concatenate(states), event, flag)

    @property
    def evaluations(self) -> int:
        """Evaluations of the right-hand side since the last restart."""
        count = np.zeros(1, dtype=np.int_)
        library().CVodeGetNumRhsEvals(self._memory, count.ctypes.data)
        return int(count[0])


def _free(memory: int, solver: int, vectors: list[int], context: int) -> None:
    """Give CVODE's memory back, in the order that SUNDIALS wants."""
    lib = library()
    lib.CVodeFree(np.array([memory], dtype=np.intp).ctypes.data)
    lib.SUNNonlinSolFree(solver)
    for vector in vectors:
        lib.N_VDestroy(vector)
    lib.SUNContext_Free(np.array([context], dtype=np.intp).ctypes.data)
