"""Files that appear complete or not at all."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

PART = ".part"  # ends the names of files that are being written
PARTIAL = ".partial"  # ends the names of folders with which a stopped run can go on


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Yield a temporary path; the file takes its final name when the block ends without error.

    `path` is the final name. A reader sees either the complete file or none; after an error nothing
    is left behind.

    Raises
    ------
    OSError
        If the file cannot be written, with its final name.
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
    """Move a finished file or folder from a temporary to its final path, flushed to disk."""
    sync(temporary)
    temporary.replace(path)
    sync(path.parent)


def sync(path: Path) -> None:
    """Wait until a file is on disk, so that it survives a power failure.

    For the path of a folder that is the list of its files, which changes with a rename.
    """
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


class Behind:
    """Waits for the disk in a thread, so that the writer need not; for one call at a time."""

    def __init__(self) -> None:
        """Start a thread for waiting; nothing is under way."""
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="sync")
        self._last: Future[None] | None = None

    def start(self, wait: Callable[..., None], *arguments: object) -> None:
        """Start a wait in the background, once the previous one has ended; raise that one's error.

        `wait` is the function to run, with its arguments.
        """
        self.end()
        self._last = self._thread.submit(wait, *arguments)

    def end(self) -> None:
        """Wait until the background wait has ended."""
        last, self._last = self._last, None
        if last is not None:
            last.result()

    def close(self) -> None:
        """Wait until the background wait has ended, and accept no more."""
        self._thread.shutdown()


def partial(path: Path) -> Path:
    """Return the folder for the pieces of an incomplete result."""
    return path.with_name(f".{path.name}{PARTIAL}")
