"""Integrity of files: their digests are compared once, and again after each change."""

from __future__ import annotations

import asyncio
import hashlib
import os
import threading
from collections import OrderedDict
from concurrent.futures import ThreadPoolExecutor
from io import FileIO

PIECE = 1 << 20  # bytes that are read at a time for a digest
# Bytes; larger files are read by a thread of their own, so that small ones, which take some
# milliseconds, do not wait for them.
LARGE = 8 << 20
MAX_KNOWN = 100_000  # files that are remembered as intact


class Integrity:
    """Compares files with their digests, on threads of its own; remembers those that agree.

    Threads may use it at the same time.
    """

    def __init__(self) -> None:
        """Begin without any checked file, with threads of its own."""
        self._lock = threading.Lock()
        self._known: OrderedDict[tuple[int | str, ...], None] = OrderedDict()
        self._small = ThreadPoolExecutor(1, thread_name_prefix="digests")
        self._large = ThreadPoolExecutor(1, thread_name_prefix="large-digests")

    def close(self) -> None:
        """Stop checking files and end the threads."""
        for lane in (self._small, self._large):
            lane.shutdown(wait=False, cancel_futures=True)

    async def is_intact(self, file: FileIO, digest: str) -> bool:
        """True if an open file has the given SHA-256.

        It is read in a thread, without blocking the loop. `digest` is in hexadecimal. A file that
        was intact and has not changed since is not read again.
        """
        status = os.fstat(file.fileno())
        if self._knows(_mark(status, digest)):
            return True
        # A name of the thread's own for the file: whoever asks may be gone before it ends.
        own = FileIO(os.dup(file.fileno()))
        lane = self._large if status.st_size > LARGE else self._small
        looking = lane.submit(self.look, own, digest)
        looking.add_done_callback(lambda _: own.close())
        return await asyncio.wrap_future(looking)

    def look(self, file: FileIO, digest: str) -> bool:
        """True if an open file has the given SHA-256; the file is read in the calling thread.

        `digest` is in hexadecimal. A file that was intact and has not changed since (by inode, size
        and time of change) is not read again.
        """
        mark = _mark(os.fstat(file.fileno()), digest)
        if self._knows(mark):
            return True
        if _digest(file) != digest:
            return False
        # What was changed while it was read is looked at again.
        if _mark(os.fstat(file.fileno()), digest) == mark:
            with self._lock:
                self._known[mark] = None
                while len(self._known) > MAX_KNOWN:
                    self._known.popitem(last=False)
        return True

    def _knows(self, mark: tuple[int | str, ...]) -> bool:
        """True if this version of a file has been read before and agreed with its digest.

        `mark` identifies the version, as `_mark` returns it.
        """
        with self._lock:
            if mark not in self._known:
                return False
            self._known.move_to_end(mark)
            return True


def _digest(file: FileIO) -> str:
    """Return the SHA-256 of an open file, leaving its read position unchanged."""
    found, start = hashlib.sha256(), 0
    while piece := os.pread(file.fileno(), PIECE, start):
        found.update(piece)
        start += len(piece)
    return found.hexdigest()


def _mark(status: os.stat_result, digest: str) -> tuple[int | str, ...]:
    """Return the identity of a file's version: device, inode, size, time of change, digest."""
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns, digest
