"""Studies on disk, addressed by content: equal studies share one folder."""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import threading
import time
from collections import OrderedDict
from pathlib import Path

from vibrafeed.app.jobs.errors import NotFoundError, OtherVersionError
from vibrafeed.core.code_version import code_version
from vibrafeed.core.dataset.files import whole
from vibrafeed.core.errors import StudyError, VibrafeedError
from vibrafeed.core.intake import prepare_content, read_json
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.study.grid_study import Study

IDENTIFIER = re.compile(r"[0-9a-f]{64}")
USED_EVERY = 3600.0  # s; a study's time of last use is written at most once in this time
MAX_CACHED = 64  # studies that are kept in memory
MAX_CACHED_BYTES = 8_000_000  # of their texts; values take three times that in memory


def identifier(study: Study, process: str | None = None) -> str:
    """Return the identifier of a study: a SHA-256 of its text and of the code that computes.

    `process` is what is carried out; a process other than the study's own kind, such as `accuracy`,
    is part of what is hashed. Equal studies have equal identifiers and share one result.
    """
    words = [code_version(), study.canonical()]
    if process not in (None, study.kind):
        words.insert(0, str(process))
    return hashlib.sha256(" ".join(words).encode()).hexdigest()


class Studies:
    """Keeps studies below one directory, each in a folder named by its identifier.

    Threads and processes may use it at the same time.
    """

    def __init__(self, directory: Path):
        """Use the folder `studies` of a data directory; none is read yet."""
        self.directory = directory / "studies"
        self._lock = threading.Lock()
        # The studies used last, each with True if the identifier is the one that this version gives
        # it, and with the bytes of its text.
        self._cached: OrderedDict[str, tuple[Prepared, bool, int]] = OrderedDict()

    def add(self, study: Study, process: str | None = None) -> tuple[str, bool]:
        """Store a study in the folder of its identifier.

        Return the identifier, and True if it is new. `process` is what is carried out, by default
        the study's own kind.
        """
        key = identifier(study, process)
        return key, self.put(key, study.canonical())

    def put(self, key: str, text: str) -> bool:
        """Store the canonical text of a study under its identifier; return True if it is new."""
        path = self.directory / key / "study.json"
        if path.exists():
            self.note_use(key)
            return False
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole(path) as temporary:
            temporary.write_text(text, encoding="utf-8")
        return True

    def get(self, key: str) -> Prepared:
        """Return the study with an identifier; raise `NotFoundError` if there is none."""
        return self._get(key)[0]

    def sweep(self, key: str) -> Prepared:
        """Return a stored sweep, ready to be evaluated on demand in slices.

        `key` is its identifier, a digest of its content and of the version of vibrafeed.

        Raises
        ------
        NotFoundError
            If no study has this identifier, or if it cannot be evaluated in slices.
        OtherVersionError
            If it was posted to another version of vibrafeed, whose results would differ.
        """
        try:
            prepared, is_own = self._get(key)
        except StudyError:  # it was sound when it was posted
            raise _no_sweep_error(key, None) from None
        if is_sweep(prepared) and is_own:
            return prepared
        raise _no_sweep_error(key, prepared)

    def _get(self, key: str) -> tuple[Prepared, bool]:
        """Return a stored study, and True if its identifier is that which this version gives to it.

        `key` is the identifier under which it was posted; another version of vibrafeed gives
        another one. The studies used last are kept in memory.

        Raises
        ------
        NotFoundError
            If no study has this identifier.
        StudyError
            If the stored file has problems.
        """
        path = self.folder(key) / "study.json"
        with self._lock:
            cached = self._cached.get(key)
            if cached is not None and path.exists():  # it may have been removed
                self._cached.move_to_end(key)
                self.note_use(key)
                return cached[:2]
        try:
            content = path.read_bytes()
        except FileNotFoundError:
            raise unknown(key) from None
        self.note_use(key)
        prepared = prepare_content(read_json(content))
        is_own = identifier(prepared.study) == key
        with self._lock:
            self._cached[key] = prepared, is_own, len(content)
            self._cached.move_to_end(key)
            while (
                len(self._cached) > MAX_CACHED
                or sum(size for *_, size in self._cached.values()) > MAX_CACHED_BYTES
            ):
                self._cached.popitem(last=False)
        return prepared, is_own

    def folder(self, key: str) -> Path:
        """Return the folder of a study; raise `NotFoundError` if the identifier is malformed."""
        # Only what looks like an identifier reaches the file system.
        if not IDENTIFIER.fullmatch(key):
            raise unknown(key)
        return self.directory / key

    def studies(self) -> list[str]:
        """Return the identifiers of all stored studies, least recently used first.

        Studies that make room for others are removed in this order.
        """
        uses = []
        with contextlib.suppress(FileNotFoundError):
            for folder in self.directory.iterdir():
                if IDENTIFIER.fullmatch(folder.name):
                    uses.append((self.last_use(folder.name), folder.name))
        return [key for _, key in sorted(uses)]

    def last_use(self, key: str) -> float:
        """Return the time of a study's last use [s since the epoch], to an hour; 0 if it is gone.

        `key` is the study's identifier.
        """
        folder = self.folder(key)
        # A study that is just being added has its folder only: it is in use, too.
        for path in (folder / "study.json", folder):
            with contextlib.suppress(FileNotFoundError):
                return path.stat().st_mtime
        return 0.0

    def note_use(self, key: str) -> None:
        """Set the time of last use of a study to now, so that it is not removed soon.

        `key` is the study's identifier. The time is written at most once an hour.
        """
        path = self.folder(key) / "study.json"
        with contextlib.suppress(OSError):  # a directory that is read-only can be read
            if time.time() - path.stat().st_mtime > USED_EVERY:
                os.utime(path)


def is_sweep(prepared: Prepared) -> bool:
    """True for a sweep of closed forms whose cells are computed one by one."""
    return prepared.study.kind == "sweep" and prepared.not_lazy is None


def _no_sweep_error(key: str, prepared: Prepared | None) -> VibrafeedError:
    """Return the error for a stored study that is not a sweep of this version.

    `key` is the identifier that a client asks for; `prepared` is the stored study, None if this
    version cannot read it. It is a `NotFoundError` if the study was never a sweep, else an
    `OtherVersionError`.
    """
    if prepared is not None:
        of_another_process = identifier(prepared.study, "accuracy") == key
        if not is_sweep(prepared) or of_another_process:
            return unknown(key)
    return OtherVersionError(
        f"The sweep '{key[:12]}...' was posted to another version of vibrafeed; this one is "
        f"{code_version()} and uses other identifiers. POST the study to /sweeps again."
    )


def unknown(key: str) -> NotFoundError:
    """Return the error for an unknown study."""
    return NotFoundError(f"There is no study '{key[:80]}'. POST the study to /sweeps first.")
