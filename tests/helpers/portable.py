"""Windows, as far as a program in Python can tell, for child processes on Linux.

What Windows refuses of files is refused to the whole process, before the system is asked, and each
refusal is a line in a log. Which names Windows lacks is told by mypy's stubs.

Not imitated: drive letters, code pages of files, text mode (an `os.open` without O_BINARY is in the
log), ways to start processes.
"""

import ast
import contextlib
import errno
import fcntl
import functools
import os
import re
import sys
import types
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, NoReturn

LINUX, WINDOWS, MACOS = "linux", "win32", "darwin"  # as `sys.platform` calls them
O_BINARY = 0o100000  # Linux has O_LARGEFILE there, which changes nothing
FORBIDDEN = re.compile(r'[<>:"|?*\\\x00-\x1f]|[. ]$')
RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\.|$)", re.IGNORECASE)


# --- in the test


@functools.cache
def lacking(system: str) -> Mapping[str, set[str]]:
    """Return modules of which a system lacks names that Linux has, with these names."""
    import mypy

    stubs = Path(mypy.__file__).parent / "typeshed" / "stdlib"
    found = {}
    for stub in (*stubs.glob("*.pyi"), stubs / "os" / "__init__.pyi"):
        text = stub.read_text()
        if "sys.platform" in text:
            here, there = (set(_public(ast.parse(text).body, one)) for one in (LINUX, system))
            found[stub.parent.name if stub.stem == "__init__" else stub.stem] = here - there
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
        elif isinstance(node, ast.Assign):
            names = [getattr(target, "id", None) for target in node.targets]
        elif isinstance(node, ast.AnnAssign):
            names = [getattr(node.target, "id", None)]
        elif isinstance(node, ast.ImportFrom):
            names = [one.asname for one in node.names]  # `import x as x` hands x on
        yield from (name for name in names if name and not name.startswith("_"))


# --- in the processes

_root = _log = ""


def install(root: str, log: str) -> None:
    """Go the ways of Windows, and refuse what Windows refuses of files."""
    import shutil
    import tempfile

    global _root, _log
    _root, _log = root, log
    fsync, rename = os.fsync, os.rename

    def fsync_of_written(file: Any) -> None:
        number = file if isinstance(file, int) else file.fileno()
        if not fcntl.fcntl(number, fcntl.F_GETFL) & (os.O_WRONLY | os.O_RDWR):
            _refuse(errno.EBADF, "", "fsync of a file open for reading")
        fsync(number)

    def rename_to_new(source: Any, target: Any, **options: Any) -> None:
        if os.path.lexists(target):
            _refuse(errno.EEXIST, target, "rename to what exists")
        rename(source, target, **options)

    os.fsync, os.rename, os.O_BINARY = fsync_of_written, rename_to_new, O_BINARY
    shutil._use_fd_functions = False
    tempfile.TemporaryFile = tempfile.NamedTemporaryFile
    sys.addaudithook(_look)


def _look(event: str, arguments: tuple[Any, ...]) -> None:
    """Refuse what Windows refuses, of the events that Python tells."""
    check = _CHECKS.get(event)
    if check is not None:
        check(*arguments)


def _tell(what: str) -> None:
    with Path(_log).open("a") as file:
        file.write(f"{what}\n")


def _refuse(number: int, path: Any, what: str) -> NoReturn:
    _tell(what)
    raise OSError(number, os.strerror(number), str(path))


def _on_open(path: Any, mode: str | None, flags: int) -> None:
    if isinstance(path, int) or str(path).startswith(("/proc", "/dev", "/sys")):
        return
    if mode is None and Path(path).is_dir():
        _refuse(errno.EACCES, path, "open of a folder")
    caller = sys._getframe(2).f_code.co_filename
    if mode is None and not flags & O_BINARY and caller.startswith(_root):
        _tell("os.open without O_BINARY")  # it goes on there, and spoils what is written
    if flags & os.O_CREAT:
        _on_name(path)


def _on_name(path: Any, *_: Any) -> None:
    name = Path(os.fsdecode(path)).name
    if name != ".." and (FORBIDDEN.search(name) or RESERVED.match(name)):
        _refuse(errno.EINVAL, path, f"the name {name!r}")


def _on_remove(path: Any, folder: int = -1) -> None:
    if folder == -1 and _is_held(path):
        _refuse(errno.EACCES, path, "removal of an open file")


def _on_rename(source: Any, target: Any, *_: Any) -> None:
    for path in (source, target):
        if _is_held(path):
            _refuse(errno.EACCES, path, "rename of an open file")
    if Path(target).is_dir():
        _refuse(errno.EACCES, target, "rename to a folder")
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
