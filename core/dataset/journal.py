"""A journal of what has been done: lines that are whole or do not count."""

from __future__ import annotations

import errno
import json
import os
import zlib
from pathlib import Path
from typing import Any


class Journal:
    """A file of records, one a line with a checksum each; a damaged end is cut off.

    Only one process may have it open.

    Parameters
    ----------
    path : Path
        The file; it is made if there is none.

    Attributes
    ----------
    records : list of dict
        The intact records, from the first on.

    Raises
    ------
    BlockingIOError
        If another process has it open.
    """

    def __init__(self, path: Path):
        """Open and lock a journal; read its valid records and cut off a damaged end."""
        from filelock import FileLock, Timeout  # most runs keep no journal

        self._lock = FileLock(path.with_name(f"{path.name}.lock"), timeout=0, thread_local=False)
        try:
            self._lock.acquire()
        except Timeout:
            raise BlockingIOError(errno.EAGAIN, "another process has it open", str(path)) from None
        self._file = path.open("a+b")
        self._file.seek(0)
        self.records: list[dict[str, Any]] = []
        self._ends = [0]
        for line in self._file:
            record = _record(line)
            if record is None:
                break
            self.records.append(record)
            self._ends.append(self._ends[-1] + len(line))
        self.keep(len(self.records))

    def keep(self, count: int) -> None:
        """Remove all records but the first `count`."""
        del self.records[count:], self._ends[count + 1 :]
        self._file.truncate(self._ends[-1])

    def add(self, record: dict[str, Any]) -> None:
        """Append a record; it is safely on disk only after `sync`."""
        text = json.dumps(record).encode()
        self._file.write(b"%08x %s\n" % (zlib.crc32(text), text))
        self._file.flush()

    def sync(self) -> None:
        """Wait until all records are on the disk."""
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Close the file and release its lock."""
        self._file.close()
        self._lock.release()


def _record(line: bytes) -> dict[str, Any] | None:
    """Return the record in a line of a journal; None if the line is damaged, as after a crash.

    A valid `line` is the CRC-32 of the text in eight hexadecimal digits, a blank, the record as
    JSON text, and a line feed.
    """
    checksum, _, text = line.rstrip(b"\n").partition(b" ")
    if not line.endswith(b"\n") or checksum != b"%08x" % zlib.crc32(text):
        return None
    record: dict[str, Any] = json.loads(text)
    return record
