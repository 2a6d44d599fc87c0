"""Compilation of the kernels: numba, cached on disk by the content of all kernel files.

numba's own cache watches the one file a function stands in, so that a kernel which calls into
another file would keep the old callee. Here the cached code lies in a folder named after a digest
of everything that it can depend on: of the kernel files of every package, of the flags that they
freeze, of this file, and of the versions and settings of the compiler. A change of any of them
opens a new folder; dates and places of files play no part. numba itself keeps the entries of one
folder apart by argument types and by processor.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import inspect
import math
import os
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import llvmlite
import numba
import numpy as np
from numba.core import caching, event, types
from numba.core.registry import cpu_target
from numba.extending import intrinsic, overload
from numba.misc.appdirs import AppDirs

from core.compiling import stopwatch

Function = TypeVar("Function", bound=Callable[..., Any])

CORE = Path(__file__).resolve().parent

FROZEN = ("compiled.py", "quantities/flags.py", "optimise/codes.py")
"""What kernels may import besides kernel files; the values are frozen into the cached code."""

SETTINGS = (
    "BOUNDSCHECK", "DEBUGINFO_DEFAULT", "DISABLE_INTEL_SVML", "LOOP_VECTORIZE", "OPT",
    "SLP_VECTORIZE",
)  # fmt: skip
"""Settings of numba that change code and that its own cache does not look at."""

LOOP = "loop-"
"""What names the text of a function that stands in no file; a digest of it follows."""

KEPT = 8
"""Folders of other digests that stay, the last used: a branch or two, and versions side by side."""

_settings: Any = numba.config
_user_caches = AppDirs(appname="vibrafeed", appauthor=False)  # type: ignore[no-untyped-call]


def compiled(function: Function) -> Function:
    """Return the function compiled for scalars and arrays; it releases the interpreter's lock.

    Kernels stay sequential: a pool of threads shares out the cells, so that two requests of one
    process can run at a time, a batch can be stopped between pieces, and results do not depend on
    the number of threads.

    The code is cached in a folder of `NUMBA_CACHE_DIR`; without that variable, beside this file or,
    where that cannot be written, among the user's caches. A function that stands in no kernel file,
    or for which no folder can be written or read, is compiled once a process.
    """
    return _compiled(function)


def borrowing(function: Function) -> Function:
    """Return the function compiled as by `compiled`; it may neither allocate nor return an array.

    It takes its arrays on loan, and does not count their users, which takes half of the time of a
    short kernel.
    """
    return _compiled(function, _nrt=False)


def disjoint(function: Function) -> Function:
    """Return the function compiled as by `borrowing`; its arrays may not overlap."""
    dispatcher = _compiled(function, _nrt=False)

    def without_aliases(flags: Any) -> Any:
        flags.noalias = True  # else each loop begins with a check of every pair of arrays
        return flags

    dispatcher._compiler._customize_flags = without_aliases
    return dispatcher


@functools.cache
def compiled_source(source: str) -> Any:
    """Return the function of a source text, the only one in it, compiled as by `borrowing`.

    Its arrays may not overlap. It may call `choose` (a selection, never a branch) and the functions
    of `math`. The code is cached as that of `compiled` is; a name tells the text.
    """
    file = _loop_name(source)
    names: dict[str, Any] = {"choose": _choose}
    names |= {name: getattr(math, name) for name in ("copysign", "inf", "nan", "sqrt")}
    names |= {"__name__": __name__, "__builtins__": __builtins__}
    known = set(names)
    exec(compile(source, file, "exec"), names)  # our own text, from a graph of known steps
    (name,) = names.keys() - known
    return disjoint(names[name])


def is_on_disk(source: str) -> bool:
    """Return whether the code of a source text has been compiled before, and kept."""
    path = folder()
    return path is not None and any(path.glob(f"{_loop_name(source)}.*"))


def _loop_name(source: str) -> str:
    return LOOP + hashlib.sha256(source.encode()).hexdigest()[:32]


@intrinsic
def _choose(context: Any, condition: Any, one: Any, other: Any) -> Any:
    """Return one of two values; both are at hand, so that a row of cells needs no branch."""
    del context
    truth = isinstance(one, types.Boolean) and isinstance(other, types.Boolean)
    result = types.boolean if truth else types.float64

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        condition, *values = arguments
        taken = (
            context.cast(builder, value, kind, result)
            for value, kind in zip(values, signature.args[1:], strict=True)
        )
        return builder.select(condition, *taken)

    return result(condition, one, other), generate


@intrinsic
def _bits(context: Any, value: Any) -> Any:
    """Return the bits of a float as an integer."""
    del context

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], context.get_value_type(types.int64))

    return types.int64(types.float64), generate


bits: Any = _bits
"""The bits of a float as an integer, in compiled code."""


@intrinsic
def _raised(context: Any, flag: Any) -> Any:
    """Return whether the first byte of an array is not 0, as it is now and not as it was."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        now = builder.load_atomic(array.data, "monotonic", 1)  # no loop keeps what it once read
        return builder.icmp_signed("!=", now, now.type(0))

    return types.boolean(flag), generate


raised: Any = _raised
"""Whether a flag is raised, in compiled code that runs while another thread may raise it."""


def by_type(
    argument: str, ways: Mapping[type, Any], *, borrows: bool = True
) -> Callable[[Function], Function]:
    """Return a decorator: compiled code that calls the function calls one of `ways` instead.

    Which one, the type of an argument tells, a named tuple, when the caller is compiled. The
    function itself only says what all of them return; their arguments have its names. All are
    compiled as by `borrowing`, or, where they hand on an array, as by `compiled`.
    """

    def register(function: Function) -> Function:
        signature = inspect.signature(function)
        place = list(signature.parameters).index(argument)

        def choose(*types: Any) -> Any:
            return ways[types[place].instance_class].py_func

        choose.__signature__ = signature  # type: ignore[attr-defined]
        options: Any = {"nogil": True, "error_model": "numpy", "_nrt": not borrows}
        register: Any = overload(function, jit_options=options, strict=False)
        register(choose)
        return function

    return register


def _compiled(function: Callable[..., Any], **options: bool) -> Any:
    jit: Any = numba.njit
    dispatcher = jit(nogil=True, error_model="numpy", **options)(function)
    with contextlib.suppress(RuntimeError):  # no folder for it
        dispatcher._cache = _Cache(function)  # type: ignore[no-untyped-call]
    return dispatcher


@functools.cache
def sources() -> tuple[Path, ...]:
    """Return the files that cached code depends on, in a fixed order."""
    kernels = sorted(CORE.glob("*/kernels/**/*.py"))
    return (*kernels, *(CORE / name for name in FROZEN))


@functools.cache
def digest() -> str:
    """Return the name of all that cached code depends on, 16 hexadecimal digits."""
    settings = {name: str(getattr(_settings, name, None)) for name in SETTINGS}
    versions = (numba.__version__, llvmlite.__version__, np.__version__)
    content = hashlib.sha256(repr((versions, settings)).encode())
    for file in sources():
        content.update(f"\n{file.relative_to(CORE).as_posix()}\n".encode())
        content.update(hashlib.sha256(file.read_bytes()).digest())
    return content.hexdigest()[:16]


@functools.cache
def folder() -> Path | None:
    """Return the folder of the cached code, made if need be.

    The first that can be written, else the first that is there (an image may ship it); else None.
    """
    places = [CORE / "__pycache__", Path(_user_caches.user_cache_dir)]
    if _settings.CACHE_DIR:
        places = [Path(_settings.CACHE_DIR)]
    folders = [place / f"kernels-{digest()}" for place in places]
    for found in folders:
        with contextlib.suppress(OSError):
            found.mkdir(parents=True, exist_ok=True)
            os.utime(found)  # it is in use
            if os.access(found, os.W_OK):
                _forget_old(found)
                return found
    return next((found for found in folders if os.access(found, os.R_OK)), None)


@functools.cache
def processor() -> str:
    """Return the name of what code is compiled for: processor and instructions, 16 digits."""
    target: Any = cpu_target.target_context.codegen()
    return hashlib.sha256(repr(target.magic_tuple()).encode()).hexdigest()[:16]


def _forget_old(current: Path) -> None:
    """Remove the folders of other digests but the last used."""
    others = set(current.parent.glob("kernels-" + 16 * "[0-9a-f]")) - {current}
    with contextlib.suppress(OSError):  # another process removes the same ones
        for other in sorted(others, key=os.path.getmtime, reverse=True)[KEPT:]:
            shutil.rmtree(other, ignore_errors=True)


class _Place(caching._CacheLocator):
    """Where numba finds the code of one function, and what tells that it is that of its source."""

    def __init__(self, file: str, module: str, line: int, path: Path) -> None:
        self._py_file, self._lineno = file, line
        self._module, self._path = module, path

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> _Place | None:
        """Return the place; None for a function of another file, or if there is no folder."""
        if not file.startswith(LOOP) and Path(file).resolve() not in sources():
            return None
        path = folder()
        line = function.__code__.co_firstlineno
        return None if path is None else cls(file, function.__module__, line, path)

    def get_cache_path(self) -> str:
        return str(self._path)

    def get_source_stamp(self) -> str:
        return digest()

    def get_disambiguator(self) -> str:
        return f"{self._module}-{self._lineno}"  # two kernels may have files of one name

    def ensure_cache_path(self) -> None:
        self._path.mkdir(parents=True, exist_ok=True)


class _Entry(caching.CompileResultCacheImpl):
    """How numba writes compiled code; in our place only."""

    _locator_classes: list[type[object]] = [_Place]  # noqa: RUF012 numba declares it so


class _Cache(caching.FunctionCache):
    """The cached code of one function; what cannot be written is compiled again next time."""

    _impl_class = _Entry

    def save_overload(self, signature: Any, data: Any) -> None:
        with contextlib.suppress(OSError):
            super().save_overload(signature, data)  # type: ignore[no-untyped-call]


class _Told(event.Listener):
    """Has the stopwatch run while numba compiles what it did not find on the disk."""

    def on_start(self, event: event.Event) -> None:
        stopwatch.begin()

    def on_end(self, event: event.Event) -> None:
        stopwatch.end()


register: Any = event.register
register("numba:compile", _Told())
