"""The FMU target: FMI 2.0, model exchange and co-simulation, around the C target."""

from __future__ import annotations

from cylcontact.export import c
from cylcontact.export.exported_law import MEANINGS, RESULTS, ExportedLaw
from cylcontact.export.fmi import Model, Variable, fmu
from cylcontact.plain_text import comment

# Where nothing else is given, a steel pin in a hole of 10 mm.
_START = {
    "penetration": 0.0, "E_star": 113736.26, "dR": 0.05, "R_i": 10.0, "R_j": 9.95, "length": 10.0,
}  # fmt: skip
_UNITS = {
    "mm": {"m": 1, "factor": 1e-3},
    "MPa": {"kg": 1, "m": -1, "s": -2, "factor": 1e6},
    "N/mm": {"kg": 1, "s": -2, "factor": 1e3},
    "N/mm2": {"kg": 1, "m": -1, "s": -2, "factor": 1e6},
}
_DEFINITIONS = """\
#define GUID "$guid"

"""
_HOOKS = """\
/* The law for fmi2.c: its arguments, then load and stiffness. */
#include <string.h>

void {name}({parameters}, double *load, double *stiffness);

enum {{ INPUTS = {count}, REALS = {count} + 2, INDICATORS = 0 }};

typedef struct {{
    double input[INPUTS], ahead;
}} Memory;

static void start(Memory *memory)
{{
    const double first[INPUTS] = {{{first}}};
    memcpy(memory->input, first, sizeof first);
    memory->ahead = 0.0;
}}

static int settle(Memory *memory, int at_event)
{{
    (void)memory, (void)at_event;
    return 0;
}}

static void reals_of(const Memory *memory, double all[REALS])
{{
    memcpy(all, memory->input, sizeof memory->input);
    {name}({given}, &all[INPUTS], &all[INPUTS + 1]);
}}

static int integer_of(const Memory *memory, unsigned int which, int *value)
{{
    (void)memory, (void)which, (void)value;
    return 0;
}}

static void indicators_of(const Memory *memory, double *indicators)
{{
    (void)memory, (void)indicators;
}}

"""


def source(law: ExportedLaw) -> bytes:
    """Return the FMU: the penetration is its input, the pair's arguments are its parameters.

    Raises `InputError` if there is no C compiler, or it fails.
    """
    start = {name: _START.get(name, 0.0) for name in law.arguments}
    kinds = ("input", *("parameter" for _ in law.arguments[1:]))
    rows = {**{name: MEANINGS[name] for name in law.arguments}, **RESULTS}
    variables = (
        Variable(name, unit.replace("^", ""), kind, meaning, start.get(name, 0.0))
        for (name, (unit, meaning)), kind in zip(
            rows.items(), (*kinds, "output", "output"), strict=True
        )
    )
    hooks = _HOOKS.format(
        name=law.name,
        parameters=", ".join(f"double {name}" for name in law.arguments),
        count=len(start),
        first=", ".join(map(repr, start.values())),
        given=", ".join(f"all[{k}]" for k in range(len(start))),
    )
    text = f"The contact law '{comment(law.law.name)}': load and stiffness per unit of length"
    model = Model(law.name, law.name, text, tuple(variables), _UNITS)
    return fmu(model, {f"{law.name}.c": c.source(law)}, _DEFINITIONS, hooks)
