"""Files that appear complete or not at all."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

PART = ".part"  # ends the names of what is being written
PARTIAL = ".partial"  # ends those of what a run that was stopped can go on with


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Yield a temporary name; what stands there takes its place when the block ends well.

    Raises
    ------
    OSError
        If it cannot be written, with the name of the file itself; nothing is left behind.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.{time.monotonic_ns()}{PART}")
    try:
        # The system says why nothing can be written here; some libraries only that it failed.
        temporary.touch(exist_ok=True)
        yield temporary
        settle(temporary, path)
    except OSError as error:
        if error.errno is None:
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        temporary.unlink(missing_ok=True)


def settle(temporary: Path, path: Path) -> None:
    """Give a finished file or folder its name, once it is on the disk."""
    sync(temporary)
    temporary.replace(path)
    sync(path.parent)


def sync(path: Path) -> None:
    """Wait until a file, or the list of a folder, is on the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


class Behind:
    """Waits for the disk behind the back of who writes; for one thing at a time."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="sync")
        self._last: Future[None] | None = None

    def start(self, wait: Callable[..., None], *arguments: object) -> None:
        """Begin to wait, once the wait before has ended; raises what that one raised."""
        self.end()
        self._last = self._thread.submit(wait, *arguments)

    def end(self) -> None:
        """Wait until nothing is left to do."""
        last, self._last = self._last, None
        if last is not None:
            last.result()

    def close(self) -> None:
        """Wait until nothing is left to do, and take no more."""
        self._thread.shutdown()


def partial(path: Path) -> Path:
    """Return the folder of what is there of a result before it is complete."""
    return path.with_name(f".{path.name}{PARTIAL}")
