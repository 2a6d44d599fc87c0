"""Links compiled functions that call each other into machine code: each entry once, as a whole.

numba makes machine code of a function before it compiles the caller, links the optimised code into
that, and optimises both anew: what lies ten calls deep is optimised ten times. Here a function that
compiled code calls is a part, which is typed and translated for LLVM, and left so. One that Python
calls is an entry: it is linked with the parts that it reaches, each once, and then optimised. Which
of the two a function is, the caller decides; it may be both.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import cached_property
from typing import Any

from llvmlite.binding import Linkage
from numba.core import dispatcher, types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Flags, compile_extra
from numba.core.environment import lookup_environment
from numba.core.registry import CPUDispatcher

_NumbasLibrary: Any = JITCodeLibrary
_NumbasCompiler: Any = vars(dispatcher)["_FunctionCompiler"]
_NumbasDispatcher: Any = CPUDispatcher

ENVIRONMENT = "_ZN08NumbaEnv"
"""What the names of the globals begin with that hold what a function needs of Python."""

GLOBALS = "numba.dynamic.globals"
"""What the names of the globals begin with that hold addresses of one process."""

Options = Mapping[str, Any]
"""Options of the compiler, as `numba.njit` takes them."""

Change = Callable[[Any], None]
"""What changes flags of the compiler that are no options."""


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
        variables = self._final_module.global_variables
        return any(variable.name.startswith(GLOBALS) for variable in variables)

    def _get_module_for_linking(self) -> Any:
        if self._shared_module is None:
            self._shared_module = self._final_module
            for function in self._final_module.functions:
                if not function.is_declaration and function.linkage == Linkage.external:
                    function.linkage = "linkonce_odr"
        return self._shared_module


class _Entry(_Library):
    def finalize(self) -> None:
        self._linking_libraries = list(_reached(self, {}))
        super().finalize()
        for variable in self._final_module.global_variables:
            if variable.name.startswith(ENVIRONMENT):
                environment = lookup_environment(variable.name)  # type: ignore[no-untyped-call]
                if environment is not None:
                    self._codegen.set_env(variable.name, environment)


def _reached(library: Any, known: dict[Any, None]) -> dict[Any, None]:
    for called in library._linking_libraries:
        if called not in known:
            known[called] = None
            if isinstance(called, _LinkedPart):
                _reached(called, known)
    return known


class _Compiler(_NumbasCompiler):  # type: ignore[misc]
    def __init__(self, of_numba: Any, library: type[_Library], change: Change | None) -> None:
        self.__dict__.update(of_numba.__dict__)
        self._library, self._change = library, change

    def _compile_core(self, args: Any, return_type: Any) -> Any:
        flags: Any = Flags()  # type: ignore[no-untyped-call]
        self.targetdescr.options.parse_as_flags(flags, self.targetoptions)
        flags.no_cfunc_wrapper = True
        flags.no_cpython_wrapper = flags.no_compile = self._library is _LinkedPart
        if self._change is not None:
            self._change(flags)
        typing, target = self.targetdescr.typing_context, self.targetdescr.target_context
        library: Any = self._library(target.codegen(), self.py_func.__qualname__)
        library.enable_object_caching()
        with _without_collecting():
            result: Any = compile_extra(  # type: ignore[no-untyped-call]
                typing, target, self.py_func, args, return_type, flags, self.locals, library,
                self.pipeline_class,
            )  # fmt: skip
        if (
            self._library is _LinkedPart
        ):  # a name by which callers find it, where numba has an address
            result = result._replace(entry_point=object())
            target.insert_user_function(result.entry_point, result.fndesc, [library])
        return result


class _PartDispatcher(_NumbasDispatcher):  # type: ignore[misc]
    _compiler: Any

    def __init__(self, function: Callable[..., Any], options: Options, change: Change | None):
        super().__init__(function, targetoptions=dict(options))
        self._compiler = _Compiler(self._compiler, _LinkedPart, change)

    def add_overload(self, result: Any) -> None:
        self.overloads[tuple(result.signature.args)] = result


class EntryDispatcher(_NumbasDispatcher):  # type: ignore[misc]
    """A function as Python sees it; compiled code is handed its part.

    Parameters
    ----------
    function : callable
    options : mapping
        Options of the compiler, as `numba.njit` takes them.
    cache : callable
        Returns what keeps the code of a function, asked when it is first compiled; None if nothing
        does.
    change : callable, optional
        What changes flags of the compiler that are no options.
    """

    _cache: Any
    _compiler: Any

    def __init__(
        self,
        function: Callable[..., Any],
        options: Options,
        cache: Callable[[Callable[..., Any]], Any],
        change: Change | None = None,
    ) -> None:
        super().__init__(function, targetoptions=dict(options))
        self._compiler = _Compiler(self._compiler, _Entry, change)
        self._of_part = options, change
        self._keeper: Any = cache

    @cached_property
    def _part(self) -> _PartDispatcher:
        return _PartDispatcher(self.py_func, *self._of_part)

    def _compilation_chain_init_hook(self) -> None:
        pass

    def compile(self, signature: Any) -> Any:
        """Compile the function for argument types, or load it from the cache."""
        if self._keeper is not None:
            self._cache, self._keeper = self._keeper(self.py_func) or self._cache, None
        return super().compile(signature)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Return numba's template for typing a call of the function."""
        return self._part.get_call_template(args, kws)

    def get_overload(self, signature: Any) -> Any:
        """Return numba's key for the function's code."""
        return self._part.get_overload(signature)


class Choice:
    """A name for several functions; the type of an argument decides which one compiled code calls.

    Parameters
    ----------
    function : callable
        Declares arguments and result of all of them; called from Python.
    position : int
        Position of the deciding argument, a named tuple.
    ways : mapping
        The compiled function for each type of the argument.
    """

    is_compiling = False

    def __init__(
        self, function: Callable[..., Any], position: int, ways: Mapping[type, Any]
    ) -> None:
        self.py_func, self._position, self._ways = function, position, ways
        self.__name__, self.__doc__ = function.__name__, function.__doc__
        dispatched: Any = types.Dispatcher
        self._numba_type_ = dispatched(self)

    def __call__(self, *arguments: Any) -> Any:
        return self.py_func(*arguments)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Return numba's template for typing a call of the chosen function."""
        return self._way(args).get_call_template(args, kws)

    def get_overload(self, signature: Any) -> Any:
        """Return numba's key for the chosen function's code."""
        return self._way(signature).get_overload(signature)

    def _way(self, types: Any) -> Any:
        return self._ways[types[self._position].instance_class]


@contextmanager
def _without_collecting() -> Iterator[None]:
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()
