"""Integrity of files: their digests are compared once, and again after each change."""

from __future__ import annotations

import hashlib
import os
from io import FileIO

from anyio import CapacityLimiter
from anyio.to_thread import run_sync

# Bytes; larger files are read one at a time, so that small ones, which take some milliseconds, do
# not wait for them.
LARGE = 8 << 20
MAX_KNOWN = 100_000  # files that are remembered as intact


class Integrity:
    """Compares files with their digests; remembers those that agree.

    Threads may use it at the same time.
    """

    def __init__(self) -> None:
        """Begin without any checked file."""
        self._known: set[tuple[int | str, ...]] = set()
        self._one_small, self._one_large = CapacityLimiter(1), CapacityLimiter(1)

    async def is_intact(self, file: FileIO, digest: str) -> bool:
        """True if an open file has the given SHA-256, as `matches` finds in a thread."""
        is_large = os.fstat(file.fileno()).st_size > LARGE
        limiter = self._one_large if is_large else self._one_small
        return await run_sync(self.matches, file, digest, limiter=limiter)

    def matches(self, file: FileIO, digest: str) -> bool:
        """True if a file that was just opened has the given SHA-256; reads it in this thread.

        `digest` is in hexadecimal. A file that was intact and has not changed since (by inode, size
        and time of change) is not read again.
        """
        state = _state(file, digest)
        if state in self._known:
            return True
        if _digest(file) != digest:
            return False
        if _state(file, digest) == state:  # else it was changed while it was read
            if len(self._known) >= MAX_KNOWN:
                self._known.clear()
            self._known.add(state)
        return True


def _digest(file: FileIO) -> str:
    return hashlib.file_digest(file, "sha256").hexdigest()


def _state(file: FileIO, digest: str) -> tuple[int | str, ...]:
    status = os.fstat(file.fileno())
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns, digest
