"""Compilation by numba: how functions of kernel files are compiled, and linked into machine code.

numba makes machine code of a function before it compiles the caller, links the optimised code into
that, and optimises both anew: what lies ten calls deep is optimised ten times. Here a function that
compiled code calls is a part, which is typed and translated for LLVM, and left so. One that Python
calls is an entry: it is linked with the parts that it reaches, each once, and then optimised. Which
of the two a function is, the caller decides; it may be both.

`vibrafeed.core.kernel_cache` says where machine code is kept.
"""

import gc
import inspect
import math
from collections.abc import Callable, Mapping
from functools import cache, cached_property
from typing import Any, TypeVar

from llvmlite import ir
from llvmlite.binding import Linkage
from numba.core import dispatcher, event, types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Flags, compile_extra
from numba.core.environment import lookup_environment
from numba.core.registry import CPUDispatcher
from numba.extending import intrinsic

from vibrafeed.core.compiling import stopwatch
from vibrafeed.core.kernel_cache import cache_of, loop_name

Function = TypeVar("Function", bound=Callable[..., Any])

_NumbasLibrary: Any = JITCodeLibrary
_NumbasCompiler: Any = vars(dispatcher)["_FunctionCompiler"]
_NumbasDispatcher: Any = CPUDispatcher


def compiled(function: Function) -> Function:
    """Return a function compiled by numba for a kernel; it releases Python's global lock.

    Kernels stay sequential: a pool of threads shares out the cells, so that two requests of one
    process can run at a time, a batch can be stopped between pieces, and results do not depend on
    the number of threads. A function that stands in no kernel file, or for which no cache folder
    can be written or read, is compiled once a process.
    """
    return _EntryDispatcher(function, {})


def borrowing(function: Function) -> Function:
    """Return a compiled function that neither allocates nor returns arrays.

    References to array arguments are not counted, which would take half of the time of a short
    kernel.
    """
    return _EntryDispatcher(function, {"_nrt": False})


def disjoint(function: Function) -> Function:
    """Return one like `borrowing` whose array arguments do not overlap: no loop checks that."""
    return _EntryDispatcher(function, {"_nrt": False}, apart=True)


@cache
def compiled_source(source: str) -> Any:
    """Return the compiled function of a source text that defines exactly one function.

    Its arrays may not overlap. It may call `choose` (a selection, never a branch), `binade` and
    `exponent` (powers of two of floats) and `copysign` and `sqrt` of `math`. The machine code is
    cached under a digest of the text.
    """
    file = loop_name(source)
    names: dict[str, Any] = {"choose": _choose, "binade": _binade, "exponent": _exponent}
    names |= {name: getattr(math, name) for name in ("copysign", "inf", "nan", "sqrt")}
    names |= {"__name__": __name__, "__builtins__": __builtins__}
    names_before = set(names)
    exec(compile(source, file, "exec"), names)  # a text written by core/plan, never by a user
    (name,) = names.keys() - names_before
    return disjoint(names[name])


@intrinsic
def _choose(context: Any, condition: Any, first: Any, second: Any) -> Any:
    """Return `first` if the condition holds, else `second`, without a branch."""
    del context
    is_boolean = isinstance(first, types.Boolean) and isinstance(second, types.Boolean)
    result = types.boolean if is_boolean else types.float64

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        condition, *values = arguments
        cast_values = (
            context.cast(builder, value, value_type, result)
            for value, value_type in zip(values, signature.args[1:], strict=True)
        )
        return builder.select(condition, *cast_values)

    return result(condition, first, second), generate


@intrinsic
def _binade(context: Any, value: Any) -> Any:
    """Return the largest power of 2 that is not above |value|."""
    del context

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.bitcast(_exponent_bits(builder, arguments[0]), arguments[0].type)

    return types.float64(types.float64), generate


@intrinsic
def _exponent(context: Any, value: Any) -> Any:
    """Return the exponent of the largest power of 2 that is not above |value|, as a float.

    The exponent's bits, put into the last bits of the float 2^52, make 2^52 + exponent + 1023.
    """
    del context

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        exponent_bits = _exponent_bits(builder, arguments[0])
        integer = exponent_bits.type
        exponent_bits = builder.or_(builder.lshr(exponent_bits, integer(52)), integer(0x433 << 52))
        shifted = builder.bitcast(exponent_bits, arguments[0].type)
        return builder.fsub(shifted, arguments[0].type(2.0**52 + 1023))

    return types.float64(types.float64), generate


def _exponent_bits(builder: Any, value: Any) -> Any:
    integer = ir.IntType(64)
    return builder.and_(builder.bitcast(value, integer), integer(0x7FF << 52))


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


def by_type(argument: str, functions: Mapping[type, Any]) -> Callable[[Function], Function]:
    """Return a decorator: compiled code then calls one of several functions by an argument's type.

    The argument is a named tuple. A motion kernel is so compiled once for each kind of drive or
    contact, without branches at run time. Python calls the decorated function itself; its signature
    is that of all.
    """

    def register(function: Function) -> Function:
        position = list(inspect.signature(function).parameters).index(argument)
        return Choice(function, position, functions)  # type: ignore[return-value]

    return register


class _Library(_NumbasLibrary):  # type: ignore[misc]
    def _optimize_functions(self, module: Any) -> None:
        module.data_layout = self._codegen._data_layout

    def add_linking_library(self, library: Any) -> None:
        if not isinstance(library, _LinkedPart):
            library._ensure_finalized()
        self._linking_libraries.append(library)


class _LinkedPart(_Library):
    _shared_module: Any

    @property
    def has_dynamic_globals(self) -> bool:
        names = (variable.name for variable in self._final_module.global_variables)
        return any(name.startswith("numba.dynamic.globals") for name in names)

    def _get_module_for_linking(self) -> Any:
        # As linkonce_odr, copies of one function in a program are merged, and unused ones removed.
        if self._shared_module is None:
            self._shared_module = self._final_module
            for function in self._final_module.functions:
                if not function.is_declaration and function.linkage == Linkage.external:
                    function.linkage = "linkonce_odr"
        return self._shared_module


class _Entry(_Library):
    def finalize(self) -> None:
        # Links every part that this function reaches, each once, and optimises all of it together;
        # then gives the machine code the Python objects that its functions need.
        self._linking_libraries = list(_linked_by(self, {}))
        super().finalize()
        for variable in self._final_module.global_variables:
            if variable.name.startswith("_ZN08NumbaEnv"):  # numba's name of such a place
                environment = lookup_environment(variable.name)  # type: ignore[no-untyped-call]
                if environment is not None:
                    self._codegen.set_env(variable.name, environment)


def _linked_by(library: Any, linked: dict[Any, None]) -> dict[Any, None]:
    # All libraries that one calls, and that parts among these call: a set, in order of discovery.
    for called in library._linking_libraries:
        if called not in linked:
            linked[called] = None
            if isinstance(called, _LinkedPart):
                _linked_by(called, linked)
    return linked


class _Compiler(_NumbasCompiler):  # type: ignore[misc]
    """Compiles a function into a library of ours; `apart`: its array arguments do not overlap."""

    def __init__(self, of_numba: Any, library: type[_Library], apart: bool) -> None:
        self.__dict__.update(of_numba.__dict__)
        self._library, self._apart = library, apart

    def _compile_core(self, args: Any, return_type: Any) -> Any:
        flags: Any = Flags()  # type: ignore[no-untyped-call]
        self.targetdescr.options.parse_as_flags(flags, self.targetoptions)
        flags.no_cfunc_wrapper = True
        flags.no_cpython_wrapper = flags.no_compile = self._library is _LinkedPart
        if self._apart:
            flags.noalias = True  # else each loop starts by checking every pair of arrays
        typing, target = self.targetdescr.typing_context, self.targetdescr.target_context
        library: Any = self._library(target.codegen(), self.py_func.__qualname__)
        library.enable_object_caching()
        # Garbage collection takes a fifth of compile time. Not gc.disable(): dask keeps what
        # gc.isenabled() returns at its import, and another thread may import it meanwhile.
        thresholds = gc.get_threshold()
        gc.set_threshold(0)
        try:
            result: Any = compile_extra(  # type: ignore[no-untyped-call]
                typing, target, self.py_func, args, return_type, flags, self.locals, library,
                self.pipeline_class,
            )  # fmt: skip
        finally:
            gc.set_threshold(*thresholds)
        if self._library is _LinkedPart:
            # A key by which callers find the library, in place of numba's address.
            result = result._replace(entry_point=object())
            target.insert_user_function(result.entry_point, result.fndesc, [library])
        return result


class _PartDispatcher(_NumbasDispatcher):  # type: ignore[misc]
    """A function as compiled code sees it."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any], apart: bool):
        super().__init__(function, targetoptions=dict(options))
        self._compiler: Any = _Compiler(self._compiler, _LinkedPart, apart)

    def add_overload(self, result: Any) -> None:
        self.overloads[tuple(result.signature.args)] = result  # Python never calls it


class _EntryDispatcher(_NumbasDispatcher):  # type: ignore[misc]
    """A function as Python sees it; compiled code is handed its part."""

    _cache: Any

    def __init__(
        self, function: Callable[..., Any], options: dict[str, Any], apart: bool = False
    ) -> None:
        options = {"error_model": "numpy", "nopython": True, "nogil": True, **options}
        super().__init__(function, targetoptions=options)
        self._compiler: Any = _Compiler(self._compiler, _Entry, apart)
        self._of_part, self._asks_cache = (options, apart), True

    @cached_property
    def _part(self) -> _PartDispatcher:
        return _PartDispatcher(self.py_func, *self._of_part)  # code from the cache needs none

    def _compilation_chain_init_hook(self) -> None:
        pass  # no extensions of numba: kernels take arrays and numbers, and the search is slow

    def compile(self, signature: Any) -> Any:
        """Compile the function for argument types, or load it from the cache."""
        if self._asks_cache:
            self._cache, self._asks_cache = cache_of(self.py_func) or self._cache, False
        return super().compile(signature)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Return numba's template for typing a call of the function."""
        return self._part.get_call_template(args, kws)

    def get_overload(self, signature: Any) -> Any:
        """Return numba's key for the function's code."""
        return self._part.get_overload(signature)


class Choice:
    """A name for several functions, of which compiled code calls one by the type of an argument."""

    is_compiling = False

    def __init__(
        self, function: Callable[..., Any], position: int, ways: Mapping[type, Any]
    ) -> None:
        self.py_func, self._position, self._ways = function, position, ways
        self.__name__, self.__doc__ = function.__name__, function.__doc__
        self._numba_type_ = types.Dispatcher(self)  # type: ignore[type-var]

    def __call__(self, *arguments: Any) -> Any:
        """Call the function itself."""
        return self.py_func(*arguments)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Return numba's template for typing a call of the chosen function."""
        return self._way(args).get_call_template(args, kws)

    def get_overload(self, signature: Any) -> Any:
        """Return numba's key for the chosen function's code."""
        return self._way(signature).get_overload(signature)

    def _way(self, types: Any) -> Any:
        return self._ways[types[self._position].instance_class]


class _CompileTimer(event.Listener):
    def on_start(self, event: event.Event) -> None:
        stopwatch.begin()

    def on_end(self, event: event.Event) -> None:
        stopwatch.end()


event.register("numba:compile", _CompileTimer())  # type: ignore[no-untyped-call]
