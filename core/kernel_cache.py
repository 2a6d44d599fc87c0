"""The cache of compiled kernels: a folder a package, named after what its code depends on.

numba's own cache watches the one file a function stands in, so that a kernel which calls into
another file would keep the old callee. Here the folder of a package is named after a digest of its
files and of all that they import, and of versions and settings of the compiler; dates and places of
files play no part. numba itself keeps its entries apart by argument types and by processor.
"""

import contextlib
import functools
import hashlib
import os
import re
import shutil
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import llvmlite
import numba
import numpy as np
from numba.core import caching
from numba.core.registry import cpu_target
from numba.core.runtime.nrt import rtsys
from numba.misc.appdirs import AppDirs

CORE = Path(__file__).resolve().parent

COMPILERS = ("compiled.py",)
"""The file that says how functions are compiled: all cached code depends on it."""

NEUTRAL = ("compiling.py", "kernel_cache.py")
"""What that imports, and no code depends on."""

SETTINGS = (
    "BOUNDSCHECK", "DEBUGINFO_DEFAULT", "DISABLE_INTEL_SVML", "LOOP_VECTORIZE", "OPT",
    "SLP_VECTORIZE",
)  # fmt: skip
"""Settings of numba that change code and that its own cache does not look at."""

LOOPS = "loops"
"""The package of functions that stand in no file; a digest of the text names each."""

KEPT = 8
"""Folders of a package that stay, the last used: a branch or two, and versions side by side."""

IMPORT = re.compile(
    r"^[ \t]*from[ \t]+vibrafeed\.(core[\w.]*)[ \t]+import[ \t]+(\([^)]*\)|.*)"
    r"|^[ \t]*import[ \t]+vibrafeed\.(core[\w.]*)",
    re.MULTILINE,
)
"""An import of ours.

A parser finds the same in fifty times the time, at every start: a test compares them."""

_settings: Any = numba.config


@functools.cache
def packages() -> dict[str, Path]:
    """Return the folders of all kernel packages, by name."""
    files = sorted(CORE.glob("*/kernels/**/*.py"))
    return {package_of(file): file.parent for file in files}


def package_of(file: Path) -> str:
    """Return the name of the package of a kernel's file, from its folder, as in `motion-planar`."""
    return "-".join(part for part in file.parent.relative_to(CORE).parts if part != "kernels")


@functools.cache
def sources(package: str) -> tuple[Path, ...]:
    """Return all source files that compiled code of a kernel package depends on, in fixed order."""
    without_code = {CORE / name for name in NEUTRAL}
    visited = without_code | {CORE / name for name in COMPILERS}
    to_visit = [] if package == LOOPS else sorted(packages()[package].glob("*.py"))
    while to_visit:
        file = to_visit.pop()
        if file not in visited:
            visited.add(file)
            to_visit += imported(file.read_text(encoding="utf-8"))
    return tuple(sorted(visited - without_code))


def imported(text: str) -> Iterator[Path]:
    """Yield the paths of the modules of this project that a module's source imports."""
    for module, names, module_alone in IMPORT.findall(text):
        file = _file_of(module or module_alone)
        is_module = file is not None and file.name != "__init__.py"  # its names are no files
        names_imported = [] if is_module else re.findall(r"\w+", names)
        yield from filter(None, (file, *(_file_of(f"{module}.{name}") for name in names_imported)))


@functools.cache
def _file_of(dotted: str) -> Path | None:
    path = CORE.parent.joinpath(*dotted.split("."))
    files = (path.with_suffix(".py"), path / "__init__.py")
    return next(filter(Path.is_file, files), None)


@functools.cache
def digest(package: str) -> str:
    """Return a digest of all that compiled code of a package depends on, 16 hexadecimal digits."""
    settings = {name: str(getattr(_settings, name, None)) for name in SETTINGS}
    versions = (numba.__version__, llvmlite.__version__, np.__version__)
    content = hashlib.sha256(repr((versions, settings)).encode())
    for file in sources(package):
        content.update(f"\n{file.relative_to(CORE).as_posix()}\n".encode())
        content.update(hashlib.sha256(file.read_bytes()).digest())
    return content.hexdigest()[:16]


@functools.cache
def root() -> Path:
    """Return the folder of the kernel cache: `NUMBA_CACHE_DIR`, or in the user's cache."""
    folders = AppDirs(appname="vibrafeed", appauthor=False)  # type: ignore[no-untyped-call]
    return Path(_settings.CACHE_DIR or folders.user_cache_dir)


@functools.cache
def folder(package: str) -> Path | None:
    """Return the folder, made if necessary, in which compiled code of a package is cached.

    One that cannot be written is used for reading, as an image may ship one; None if there is none.
    Of outdated folders the eight used last stay.
    """
    path = root() / f"{package}-{digest(package)}"
    with contextlib.suppress(OSError):
        path.mkdir(parents=True, exist_ok=True)
        os.utime(path)  # the time of its last use
        if os.access(path, os.W_OK):
            # Another process may remove the same ones: errors are ignored.
            other_folders = set(path.parent.glob(f"{package}-" + 16 * "[0-9a-f]")) - {path}
            for outdated in sorted(other_folders, key=os.path.getmtime, reverse=True)[KEPT:]:
                shutil.rmtree(outdated, ignore_errors=True)
            return path
    return path if os.access(path, os.R_OK) else None


@functools.cache
def processor() -> str:
    """Return a digest of the processor and its instructions, 16 hexadecimal digits."""
    target: Any = cpu_target.target_context.codegen()
    return hashlib.sha256(repr(target.magic_tuple()).encode()).hexdigest()[:16]


def loop_name(source: str) -> str:
    """Return the file name under which a generated function is cached."""
    return f"{LOOPS}-{hashlib.sha256(source.encode()).hexdigest()[:32]}"


def is_on_disk(source: str) -> bool:
    """True if the code of a source text is in the cache."""
    path = folder(LOOPS)
    return path is not None and any(path.glob(f"{loop_name(source)}.*"))


def mark_of(package: str) -> Path | None:
    """Return the file that says that all of a package is compiled for this processor, or None."""
    place = folder(package)
    return None if place is None else place / f"warm-{processor()}"


def are_kept(names: Iterable[str]) -> bool:
    """True if all of some packages has been compiled for this processor, and kept."""
    marks = [mark_of(name) for name in names]
    return all(mark is not None and mark.exists() for mark in marks)


class _CacheFolder(caching._CacheLocator):
    def __init__(self, package: str, function: Callable[..., Any], file: str, path: Path) -> None:
        self._py_file, self._lineno = file, function.__code__.co_firstlineno
        self._package, self._module, self._path = package, function.__module__, path

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> "_CacheFolder | None":
        package = LOOPS
        if not file.startswith(LOOPS):
            path = Path(file).resolve()
            if not path.is_relative_to(CORE) or "kernels" not in path.parent.parts:
                return None
            package = package_of(path)
        cache_folder = folder(package)
        return None if cache_folder is None else cls(package, function, file, cache_folder)

    def get_cache_path(self) -> str:
        return str(self._path)

    def get_source_stamp(self) -> str:
        return digest(self._package)

    def get_disambiguator(self) -> str:
        return f"{self._module}-{self._lineno}"  # two kernels may have files of one name

    def ensure_cache_path(self) -> None:
        self._path.mkdir(parents=True, exist_ok=True)


class _Results(caching.CompileResultCacheImpl):
    _locator_classes: list[type[object]] = [_CacheFolder]  # noqa: RUF012 numba declares it so


class _Cache(caching.FunctionCache):
    _impl_class = _Results

    def load_overload(self, signature: Any, target_context: Any) -> Any:
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            return self._load_overload(signature, target_context)  # type: ignore[no-untyped-call]

    def save_overload(self, signature: Any, data: Any) -> None:
        with contextlib.suppress(OSError):
            super().save_overload(signature, data)  # type: ignore[no-untyped-call]


def cache_of(function: Callable[..., Any]) -> Any:
    """Return numba's cache for a function; None if the function has no cache folder."""
    try:
        return _Cache(function)  # type: ignore[no-untyped-call]
    except RuntimeError:
        return None
