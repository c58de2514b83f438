"""The C++ target: the C in one header, as inline functions in a namespace."""

from __future__ import annotations

from cylcontact.export import c
from cylcontact.export.exported_law import ExportedLaw

_FRAME = """\
$comment
//
// C++11: load, stiffness, and both by evaluate, in the namespace of this name.

#ifndef ${guard}_HPP
#define ${guard}_HPP

#include <math.h>

namespace $name {
$helpers

inline void evaluate(
    $parameters,
    double *load, double *stiffness)
{
    $body
}

inline double load(
    $parameters)
{
    double f, k;
    evaluate($arguments, &f, &k);
    return f;
}

inline double stiffness(
    $parameters)
{
    double f, k;
    evaluate($arguments, &f, &k);
    return k;
}

} // namespace $name

#endif
"""


def source(law: ExportedLaw) -> str:
    """Return the header of a law."""
    guard = law.name.upper()
    return c.source(law, _FRAME.replace("${guard}", guard)).replace("\nstatic ", "\ninline ")
