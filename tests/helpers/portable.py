"""Windows or macOS, as far as a program in Python can tell, for child processes on Linux.

What the other system lacks is hidden from the project's own modules, after mypy's stubs of the
standard library; libraries keep it, since they have ways of their own there. What Windows refuses
of files is refused to the whole process, before the system is asked. Each refusal is a line in a
log, and so is each look for a name that is hidden.

Not imitated: drive letters, code pages of files, text mode (an `os.open` without O_BINARY is in the
log), names reached by `importlib.import_module` or through another module, attributes of objects.
"""

from __future__ import annotations

import ast
import builtins
import contextlib
import errno
import fcntl
import functools
import os
import re
import sys
import threading
import types
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

HERE = Path(__file__).resolve()
LINUX, WINDOWS, MACOS = "linux", "win32", "darwin"  # as `sys.platform` calls them
O_BINARY = 0o100000  # Linux has O_LARGEFILE there, which changes nothing
FORBIDDEN = re.compile(r'[<>:"|?*\\\x00-\x1f]|[. ]$')
RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\.|$)", re.IGNORECASE)


# --- in the test


def environment(folder: Path, system: str, roots: Sequence[Path]) -> dict[str, str]:
    """Return the environment of processes that are to find themselves on another system.

    `roots` are the folders of the project's modules. `folder` takes what the processes need, and
    the log.
    """
    hidden = {module: sorted(names) for module, names in lacking(system).items()}
    told = [[f"{root}/" for root in roots], str(folder / "log"), hidden, system == WINDOWS]
    (folder / "sitecustomize.py").write_text(f"import portable\nportable.install(*{told!r})\n")
    path = os.pathsep.join(map(str, (folder, HERE.parent, HERE.parents[2])))
    return {**os.environ, "PYTHONPATH": path}


def refusals(folder: Path) -> list[str]:
    """Return the lines of the log: what was refused, and the file of whoever asked."""
    log = folder / "log"
    return sorted(set(log.read_text().splitlines())) if log.exists() else []


@functools.cache
def lacking(system: str) -> Mapping[str, set[str]]:
    """Return modules of which a system lacks names that Linux has, with these names; * is all."""
    import mypy

    stubs = Path(mypy.__file__).parent / "typeshed" / "stdlib"
    found = {}
    for stub in (*stubs.glob("*.pyi"), stubs / "os" / "__init__.pyi"):
        text = stub.read_text()
        if "sys.platform" in text:
            here, there = (set(_public(ast.parse(text).body, one)) for one in (LINUX, system))
            if here - there:
                name = stub.parent.name if stub.stem == "__init__" else stub.stem
                found[name] = here - there if there else {"*"}
    return found


def _public(body: list[ast.stmt], system: str) -> Iterator[str]:
    """Yield the public names that the statements of a stub define on a system."""
    for node in body:
        names: list[str | None] = []
        if isinstance(node, ast.If):
            facts = types.SimpleNamespace(platform=system, version_info=sys.version_info)
            test = compile(ast.Expression(node.test), "", "eval")
            is_true = eval(test, {"sys": facts, "TYPE_CHECKING": True})
            yield from _public(node.body if is_true else node.orelse, system)
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            names = [node.name]
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names = [getattr(target, "id", None) for target in targets]
        elif isinstance(node, ast.ImportFrom):
            names = [one.asname for one in node.names]  # `import x as x` hands x on
        yield from (name for name in names if name and not name.startswith("_"))


# --- in the processes

_roots: tuple[str, ...] = ()
_log = ""
_aside = threading.local()  # what is done to find something out is not looked at itself


def install(
    roots: Sequence[str], log: str, hidden: Mapping[str, Sequence[str]], on_windows: bool
) -> None:
    """Hide names from the modules below some folders; refuse what Windows refuses of files."""
    global _roots, _log
    _roots, _log = tuple(roots), log
    _hide(hidden, {"os": {"O_BINARY": O_BINARY}} if on_windows else {})
    if on_windows:
        _take_ways_of_windows()
        sys.addaudithook(_look)


def _place() -> str:
    """Return the file of the project's innermost function that is under way; empty if none is."""
    frame = sys._getframe(1)
    while frame is not None:
        file = frame.f_code.co_filename
        for root in _roots:
            if file.startswith(root):
                return f"{Path(root).name}/{file.removeprefix(root)}"
        frame = frame.f_back
    return ""


def _tell(what: str) -> None:
    with _not_looked_at(), Path(_log).open("a") as file:
        file.write(f"{what}: {_place()}\n")


@contextlib.contextmanager
def _not_looked_at() -> Iterator[None]:
    before, _aside.now = getattr(_aside, "now", False), True
    try:
        yield
    finally:
        _aside.now = before


def _refuse(error: type[Exception], number: int, path: str, what: str) -> NoReturn:
    _tell(what)
    raise error(number, os.strerror(number), path)


# Modules of the project see less.


class _Fewer(types.ModuleType):
    """A module without the names that the other system lacks."""

    def __init__(self, whole: types.ModuleType, hidden: set[str], more: Mapping[str, Any]) -> None:
        super().__init__(whole.__name__)
        self.__dict__.update(more, _whole=whole, _hidden=hidden)

    def __getattr__(self, name: str) -> Any:
        if name in self._hidden and hasattr(self._whole, name):
            _tell(f"{self.__name__}.{name}")
            raise AttributeError(f"module '{self.__name__}' has no attribute '{name}'")
        return getattr(self._whole, name)

    def __setattr__(self, name: str, value: Any) -> None:
        setattr(self._whole, name, value)


def _hide(hidden: Mapping[str, Sequence[str]], more: Mapping[str, Mapping[str, Any]]) -> None:
    """Give the project's modules less when they import."""
    plain, fewer = builtins.__import__, dict[str, types.ModuleType]()

    def importing(name: str, globals: Any = None, *others: Any, **options: Any) -> Any:
        file = (globals or {}).get("__file__") or ""
        if not file.startswith(_roots):
            return plain(name, globals, *others, **options)
        if "*" in hidden.get(name.partition(".")[0], ()):
            _tell(f"import {name}")
            raise ModuleNotFoundError(f"No module named '{name}'", name=name)
        found = plain(name, globals, *others, **options)
        key = found.__name__
        if key in hidden and key not in fewer:
            fewer[key] = _Fewer(found, set(hidden[key]), more.get(key, {}))
        return fewer.get(key, found)

    builtins.__import__ = importing


# Files are held by those who have them open.


def _take_ways_of_windows() -> None:
    """Let the standard library go its ways for Windows, and refuse what can be refused there."""
    import multiprocessing.context
    import shutil
    import signal
    import tempfile

    shutil._use_fd_functions = False
    tempfile.TemporaryFile = tempfile.NamedTemporaryFile
    spawn = multiprocessing.context.SpawnContext()
    multiprocessing.context._concrete_contexts = {"spawn": spawn}
    multiprocessing.context._default_context._default_context = spawn
    fsync, rename, wake_by = os.fsync, os.rename, signal.set_wakeup_fd

    def fsync_of_written(file: Any) -> None:
        number = file if isinstance(file, int) else file.fileno()
        if not fcntl.fcntl(number, fcntl.F_GETFL) & (os.O_WRONLY | os.O_RDWR):
            _refuse(OSError, errno.EBADF, "", "fsync of a file open for reading")
        fsync(number)

    def rename_to_new(source: Any, target: Any, **options: Any) -> None:
        if os.path.lexists(target):
            _refuse(FileExistsError, errno.EEXIST, str(target), "rename to what exists")
        rename(source, target, **options)

    def wake_by_any_pipe(number: int, **options: Any) -> int:
        if number >= 0:
            os.set_blocking(number, False)
        return wake_by(number, **options)

    os.fsync, os.rename = fsync_of_written, rename_to_new
    signal.set_wakeup_fd = wake_by_any_pipe


def _look(event: str, arguments: tuple[Any, ...]) -> None:
    """Refuse what Windows refuses, of the events that Python tells."""
    check = _CHECKS.get(event)
    if check is not None and not getattr(_aside, "now", False):
        with _not_looked_at():
            check(*arguments)


def _on_open(path: Any, mode: str | None, flags: int) -> None:
    if isinstance(path, int) or str(path).startswith(("/proc", "/dev", "/sys")):
        return
    if mode is None and Path(path).is_dir():
        _refuse(PermissionError, errno.EACCES, str(path), "open of a folder")
    caller = sys._getframe(2).f_code.co_filename
    if mode is None and not flags & O_BINARY and caller.startswith(_roots):
        _tell("os.open without O_BINARY")  # it goes on there, and spoils what is written
    if flags & os.O_CREAT:
        _on_name(path)


def _on_name(path: Any, *_: Any) -> None:
    name = Path(os.fsdecode(path)).name
    if name != ".." and (FORBIDDEN.search(name) or RESERVED.match(name)):
        _refuse(OSError, errno.EINVAL, name, f"the name {name!r}")


def _on_remove(path: Any, folder: int = -1) -> None:
    if folder == -1 and _is_held(path):
        _refuse(PermissionError, errno.EACCES, str(path), "removal of an open file")


def _on_rename(source: Any, target: Any, *_: Any) -> None:
    for path in (source, target):
        if _is_held(path):
            _refuse(PermissionError, errno.EACCES, str(path), "rename of an open file")
    if Path(target).is_dir():
        _refuse(PermissionError, errno.EACCES, str(target), "rename to a folder")
    _on_name(target)


def _is_held(path: Any) -> bool:
    """True if this process has a file, or one below a folder, open or in its memory."""
    real = os.path.realpath(path)
    held = []
    for number in Path("/proc/self/fd").iterdir():
        with contextlib.suppress(OSError):  # the folder's own is closed
            held.append(str(number.readlink()))
    for line in Path("/proc/self/maps").read_text().splitlines():
        held.append(f"/{line.partition('/')[2]}")
    return any(one == real or one.startswith(f"{real}/") for one in held)


_CHECKS: Mapping[str, Callable[..., None]] = {
    "open": _on_open,
    "os.mkdir": _on_name,
    "os.remove": _on_remove,
    "os.rmdir": _on_remove,
    "os.rename": _on_rename,
}
