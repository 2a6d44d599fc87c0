"""Compilation of the kernels by numba: how functions of kernel files are compiled.

`vibrafeed.core.linking` says how compiled functions that call each other become machine code, and
`vibrafeed.core.kernel_cache` where that is kept.
"""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from llvmlite import ir
from numba.core import event, types
from numba.extending import intrinsic

from vibrafeed.core.compiling import stopwatch
from vibrafeed.core.kernel_cache import cache_of, loop_name
from vibrafeed.core.linking import Choice, EntryDispatcher

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """Return a function compiled by numba for a kernel; it releases Python's global lock.

    Kernels stay sequential: a pool of threads shares out the cells, so that two requests of one
    process can run at a time, a batch can be stopped between pieces, and results do not depend on
    the number of threads. The machine code is cached in a folder of `NUMBA_CACHE_DIR`; without that
    variable, among the user's caches. A function that stands in no kernel file, or for which no
    folder can be written or read, is compiled once a process.
    """
    return _compiled(function)


def borrowing(function: Function) -> Function:
    """Return a compiled function that neither allocates nor returns arrays.

    It does not count references to its array arguments, which would take half of the time of a
    short kernel.
    """
    return _compiled(function, _nrt=False)


def disjoint(function: Function) -> Function:
    """Return a compiled function that allocates no arrays and whose array arguments do not overlap.

    Like `borrowing`; LLVM is promised the absence of overlap, and vectorises loops without checks.
    """
    return _compiled(function, _without_aliases, _nrt=False)


def _without_aliases(flags: Any) -> None:
    flags.noalias = True  # else each loop begins with a check of every pair of arrays


@functools.cache
def compiled_source(source: str) -> Any:
    """Return the compiled function of a source text that defines exactly one function.

    Chains of equations are written as one loop over cells in such a text. The arrays that the
    function takes may not overlap. It may call `choose` (a selection, never a branch), `binade` and
    `exponent` (powers of two of floats) and `copysign` and `sqrt` of `math`. The machine code is
    cached under a digest of the text.
    """
    file = loop_name(source)
    names: dict[str, Any] = {"choose": _choose, "binade": _binade, "exponent": _exponent}
    names |= {name: getattr(math, name) for name in ("copysign", "inf", "nan", "sqrt")}
    names |= {"__name__": __name__, "__builtins__": __builtins__}
    known = set(names)
    exec(compile(source, file, "exec"), names)  # our own text, from a graph of known steps
    (name,) = names.keys() - known
    return disjoint(names[name])


@intrinsic
def _choose(context: Any, condition: Any, first: Any, second: Any) -> Any:
    del context
    truth = isinstance(first, types.Boolean) and isinstance(second, types.Boolean)
    result = types.boolean if truth else types.float64

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        condition, *values = arguments
        taken = (
            context.cast(builder, value, kind, result)
            for value, kind in zip(values, signature.args[1:], strict=True)
        )
        return builder.select(condition, *taken)

    return result(condition, first, second), generate


@intrinsic
def _binade(context: Any, value: Any) -> Any:
    del context

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.bitcast(_exponent_bits(builder, arguments[0]), arguments[0].type)

    return types.float64(types.float64), generate


@intrinsic
def _exponent(context: Any, value: Any) -> Any:
    del context

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        field = _exponent_bits(builder, arguments[0])
        whole = field.type
        field = builder.or_(builder.lshr(field, whole(52)), whole(0x433 << 52))
        shifted = builder.bitcast(field, arguments[0].type)
        return builder.fsub(shifted, arguments[0].type(2.0**52 + 1023))

    return types.float64(types.float64), generate


def _exponent_bits(builder: Any, value: Any) -> Any:
    whole = ir.IntType(64)
    return builder.and_(builder.bitcast(value, whole), whole(0x7FF << 52))


@intrinsic
def _bits(context: Any, value: Any) -> Any:
    del context

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], context.get_value_type(types.int64))

    return types.int64(types.float64), generate


bits: Any = _bits
"""The bits of a float as an integer, in compiled code."""


@intrinsic
def _raised(context: Any, flag: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        now = builder.load_atomic(array.data, "monotonic", 1)  # no loop keeps what it once read
        return builder.icmp_signed("!=", now, now.type(0))

    return types.boolean(flag), generate


raised: Any = _raised
"""Whether a flag is raised, in compiled code that runs while another thread may raise it."""


def by_type(argument: str, ways: Mapping[type, Any]) -> Callable[[Function], Function]:
    """Return a decorator: compiled code then calls one of several functions by an argument's type.

    A motion kernel is so compiled once for each kind of drive or contact without branches at run
    time. In plain Python, the decorated function itself is called; its signature is that of all.

    Parameters
    ----------
    argument : str
        Name of the argument that decides, a named tuple.
    ways : mapping of type to callable
        The compiled function for each type of this argument.
    """

    def register(function: Function) -> Function:
        place = list(inspect.signature(function).parameters).index(argument)
        chosen: Any = Choice(function, place, ways)
        return chosen

    return register


def _compiled(function: Any, change: Callable[[Any], None] | None = None, **options: bool) -> Any:
    options = {"nopython": True, "nogil": True, **options}
    return EntryDispatcher(function, {"error_model": "numpy", **options}, cache_of, change)


class _CompileTimer(event.Listener):
    def on_start(self, event: event.Event) -> None:
        stopwatch.begin()

    def on_end(self, event: event.Event) -> None:
        stopwatch.end()


register: Any = event.register
register("numba:compile", _CompileTimer())
