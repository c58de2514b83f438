"""The Python target: a module that needs the standard library only."""

from __future__ import annotations

from cylcontact.export.exported_law import ExportedLaw
from cylcontact.export.render import Dialect

_POWER = """
def power(x, y):
    \"\"\"Return x**y, as C has it.\"\"\"
    try:
        return math.pow(x, y)
    except ValueError:
        return math.inf if x == 0 else math.nan
    except OverflowError:
        return math.inf

"""
# Lambert's w = -1 - W(-p/e), W the lower branch: a start in closed form and one step.
_LAMBERT = '''
def branch_distance(p):
    """Return w = -1 - W(-p/e), W the lower branch of Lambert's function."""
    $steps
    return $w

'''

DIALECT = Dialect(
    comment="#",
    number=repr,
    power="power({x}, {y})",
    assignment="{name} = {value}",
    choice="{yes} if {test} else {no}",
    loop="for {name} in range({first}, {stop}, {step}):\n{body}",
    continued=" \\",
    names={
        name: f"math.{name}"
        for name in (
            "log",
            "log1p",
            "exp",
            "sqrt",
            "sin",
            "cos",
            "atan",
            "hypot",
            "pi",
            "nan",
            "inf",
        )
    },
    helpers={"power": _POWER},
    lambert=_LAMBERT,
)

_FRAME = '''\
$comment
#
# Python 3; needs the standard library only.

import math

$helpers
def load($arguments):
    """Return the load in N/mm."""
    return evaluate($arguments)[0]


def stiffness($arguments):
    """Return the stiffness in N/mm^2."""
    return evaluate($arguments)[1]


def evaluate($arguments):
    """Return load and stiffness."""
    if penetration < 0:
        return 0.0, 0.0
    f = k = math.nan
    $check
        return f, k
    $constants
    try:
        $at_pair
        $last
        $at_depth
    except ZeroDivisionError:  # infinite, if the load is known
        k = math.inf if f > 0 else math.nan
    except (ValueError, OverflowError):  # no value
        pass
    if penetration == 0:  # at first touch the steps may have no value, as ln 0
        f, k = (0.0 if math.isnan(x) else x for x in (f, k))
    return f, k
'''
_LAST = """\
if not $ends:
    return f, k"""


def source(law: ExportedLaw) -> str:
    """Return the Python module of a law."""
    check = DIALECT.wrapped(f"if not ({DIALECT.render(law.domain)}):")
    return law.source(DIALECT, _FRAME, check=check, last=_LAST if law.ends else "")
