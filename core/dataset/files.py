"""Files that appear complete or not at all."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

PART = ".part"  # ends the names of what is being written


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
        with temporary.open("rb") as file:
            os.fsync(file.fileno())
        temporary.replace(path)
    except OSError as error:
        if error.errno is None:
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        temporary.unlink(missing_ok=True)
