"""The JAX target: a module of `jax.numpy` functions that differentiate."""

from __future__ import annotations

import ast

from cylcontact.export.exported_law import ExportedLaw
from cylcontact.export.render import Dialect

_LAMBERT = '''
@jax.custom_jvp
def branch_distance(p):
    """Return w = -1 - W(-p/e), W the lower branch of Lambert's function."""
    $steps
    return $w


@branch_distance.defjvp
def _(primals, tangents):
    (p,), (slope,) = primals, tangents
    w = branch_distance(p)
    return w, -(1.0 + w) / (p * w) * slope

'''

_DIALECT = Dialect(
    comment="#",
    number=repr,
    power="{x} ** {y}",
    assignment="{name} = {value}",
    choice="jnp.where({test}, {yes}, {no})",
    loop="for {name} in range({first}, {stop}, {step}):\n{body}",
    continued=" \\",
    names={
        **{
            n: f"jnp.{n}" for n in ("log", "log1p", "exp", "sqrt", "sin", "cos", "pi", "nan", "inf")
        },
        "atan": "jnp.arctan",
        "max": "jnp.maximum",
    },
    symbols={ast.And: "&", ast.Or: "|"},
    lambert=_LAMBERT,
)

_FRAME = '''\
$comment
#
# JAX: load and penetration work under jit, grad and vmap, and broadcast. The stiffness is
# jax.grad(load). Without contact, and at first touch, load and derivatives are 0.
# jax.config.update("jax_enable_x64", True) gives all digits.

import jax
import jax.numpy as jnp

$helpers
def load($arguments):
    """Return the load in N/mm at a penetration in mm."""
    return _load(*_numbers($arguments))


def penetration(load, $pair):
    """Return the penetration in mm under a load in N/mm, NaN outside the domain."""
    return _penetration(*_numbers(load, $pair))


def _numbers(*values):
    kind = jnp.result_type(float)
    return jnp.broadcast_arrays(*(jnp.asarray(value, kind) for value in values))


def _evaluate($arguments):
    """Return load and stiffness."""
    $constants
    outside = ~($domain)
    $at_pair
    $last
    still = (penetration < 0.0) | (penetration == 0.0) & ~outside
    penetration = jnp.where(still | outside, 0.5 * $least, penetration)
    $at_depth
    f, k = (jnp.where(outside, jnp.nan, x) for x in (f, k))
    return jnp.where(still, 0.0, f), jnp.where(still, 0.0, k)


@jax.custom_jvp
def _load($arguments):
    return _evaluate($arguments)[0]


@_load.defjvp
def _(primals, tangents):
    depth, pair = primals[0], primals[1:]
    f, k = _evaluate(depth, *pair)
    _, by_pair = jax.jvp(lambda *pair: _evaluate(depth, *pair)[0], pair, tangents[1:])
    return f, k * tangents[0] + by_pair


@jax.custom_jvp
def _penetration(load, $pair):
    """Solve for the logarithm of the penetration, by Newton's method within a bracket."""
    share = load / E_star
    x = jnp.log(share / jnp.pi * (1.4232 + jnp.log1p(1.0942 * dR / share)))
    zero = jnp.zeros_like(x)
    narrow = jnp.sqrt(jnp.finfo(x.dtype).eps)

    def turn(state):
        count, x, low, high, _ = state
        depth = jnp.exp(x)
        f, k = _evaluate(depth, $pair)
        low, high = jnp.where(f < load, x, low), jnp.where(f < load, high, x)
        miss = jnp.log(load) - jnp.log(f)
        new = x + miss * f / (k * depth)
        solved = (jnp.abs(miss) <= narrow) & (jnp.abs(new - x) <= narrow)
        inside = solved | (new >= low) & (new <= high)
        return count + 1, jnp.where(inside, new, (low + high) / 2.0), low, high, solved

    def is_going_on(state):
        return (state[0] < 200) & ~jnp.all(state[-1] | ~(load > 0.0))

    start = 0, x, zero - 700.0, zero + 700.0, zero > 0.0
    _, x, _, _, solved = jax.lax.while_loop(is_going_on, turn, start)
    return jnp.where(solved, jnp.exp(x), jnp.where(load == 0.0, 0.0, jnp.nan))


@_penetration.defjvp
def _(primals, tangents):
    depth, pair = _penetration(*primals), primals[1:]
    _, k = _evaluate(depth, *pair)
    _, by_pair = jax.jvp(lambda *pair: _evaluate(depth, *pair)[0], pair, tangents[1:])
    return depth, (tangents[0] - by_pair) / jnp.where(k == 0.0, jnp.inf, k)
'''


def source(law: ExportedLaw) -> str:
    """Return the JAX module of a law."""
    return law.source(
        _DIALECT,
        _FRAME,
        last="outside = outside | ~($ends)" if law.ends else "",
        least="jnp.minimum(dR, last)" if law.ends else "dR",
    )
