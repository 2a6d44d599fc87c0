"""Differences of operating systems: memory, cores, priority, files, output streams, installing.

Windows opens no folder, flushes no file that is open for reading only, and neither replaces nor
removes a file that any program holds open.
"""

import io
import os
import re
import sys
import threading
import time
from importlib.metadata import PackageNotFoundError, requires
from pathlib import Path
from typing import Any, Final

ROOT = Path(__file__).resolve().parents[1]
"""Where the program lies: a clone of the repository, or the packages of an environment."""
WINDOWS: Final = hasattr(os, "O_BINARY")  # no other system tells texts from binary files
PATIENCE: Final = 2.0  # s: virus scanners and indexers let go of a file sooner, Excel does not
LOOK: Final = 0.05  # s between two trials
SHEETS: Final = (".csv", ".xlsx")  # opened in Excel, which holds them


def memory() -> int:
    """Return the memory of this machine in bytes."""
    return int(_psutil().virtual_memory().total)


def cores() -> int:
    """Return the number of cores that this process may use; on a cluster a share of the machine."""
    affinity = getattr(_psutil().Process(), "cpu_affinity", None)  # macOS has none
    return len(affinity()) if affinity else os.cpu_count() or 1


def lower_priority(by: int) -> None:
    """Let other processes go first: add to the niceness, or "below normal" on Windows."""
    psutil = _psutil()
    process = psutil.Process()
    below_normal = getattr(psutil, "BELOW_NORMAL_PRIORITY_CLASS", None)
    process.nice(min(19, process.nice() + by) if below_normal is None else below_normal)


def end_with_parent() -> None:
    """End this process when the one that started it has ended, also by a signal.

    Else it would compute to the end and then wait for work for ever.
    """
    import multiprocessing  # for processes that were started, only

    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def sync(path: Path) -> None:
    """Wait until a file is on disk, so that it survives a power failure.

    For a folder that is the list of its files, which changes with a rename; Windows lacks that.
    """
    if not path.is_dir():
        with path.open("r+b") as file:
            os.fsync(file.fileno())
    elif not WINDOWS:
        descriptor = os.open(path, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def replace(source: Path, target: Path) -> None:
    """Give a file or folder its final name, where another file may be, which is replaced.

    Raises `PermissionError` if another program still holds one of them after two seconds, as Excel
    does on Windows: both stay as they are.
    """
    waited = 0.0
    while True:
        try:
            source.replace(target)
        except PermissionError as error:
            if not WINDOWS:
                raise
            if waited >= PATIENCE:
                if target.suffix.lower() in SHEETS and target.exists():
                    error.strerror = f"{error.strerror}. Close it in Excel"
                raise
            time.sleep(LOOK)
            waited += LOOK
        else:
            return


def write_utf8() -> None:
    """Let standard output and error take every character, whatever the system's code page.

    Into files and pipes they write UTF-8; a terminal shows a question mark for what it lacks.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            if stream.isatty():
                stream.reconfigure(errors="replace")
            else:
                stream.reconfigure(encoding="utf-8", errors=stream.errors)


def _psutil() -> Any:
    import psutil

    return psutil


def installing(package: str = "", extra: str | None = None) -> str:
    """Return the command that installs a package, or all of an extra of vibrafeed.

    In a clone the command is to be typed in its folder, and keeps to the versions that the tests
    pass with. Elsewhere it names the package itself: no index need know vibrafeed.
    """
    if not (ROOT / "constraints.txt").is_file():
        return f"pip install {package or ' '.join(_packages(extra))}"
    pip = "pip"
    if Path(sys.prefix) == ROOT / ".venv":
        pip = r".venv\Scripts\pip" if WINDOWS else ".venv/bin/pip"
    target = f"'.[{extra}]'" if extra else "."
    if WINDOWS:
        target = target.strip("'")  # cmd.exe would keep the quotes
    return f"{pip} install --constraint constraints.txt -e {target}"


def _packages(extra: str | None) -> list[str]:
    try:
        requirements = requires("vibrafeed") or []
    except PackageNotFoundError:
        return []
    extra_marker = re.compile(rf"""extra == ['"]{extra}['"]""")
    return [
        match[0]
        for requirement in requirements
        if extra_marker.search(requirement) and (match := re.match(r"[\w.-]+", requirement))
    ]
