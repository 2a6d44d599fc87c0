"""Messages for a disk that fails: of files and of the ledger alike."""

from __future__ import annotations

import errno
import sqlite3
from typing import Any

from vibrafeed.app.jobs.errors import DamagedLedgerError, LostLedgerError

FILES = "The service has reached its limit of open files"
HELD = "Another process holds the ledger"
LOST = "The database of the ledger cannot be reached"
DAMAGED = "The ledger is damaged"
TEMPORARY = (FILES, HELD, LOST, DAMAGED)  # soon and by themselves, or with the backup of the ledger


# Why it cannot take more.
STORAGE = {
    errno.ENOSPC: "The disk is full",
    errno.EDQUOT: "The disk quota is exhausted",
    errno.EROFS: "The data directory is read-only",
    errno.EACCES: "The data directory may not be written",
    errno.EPERM: "The data directory may not be written",
    errno.EMFILE: FILES,
    errno.ENFILE: FILES,
    errno.EAGAIN: HELD,
}
SQLITE = {
    "full": "The disk is full",
    "readonly": "The data directory is read-only",
    "locked": HELD,
    "I/O": "The disk reports errors",
    "unable to open": "The data directory cannot be written",
}


def is_temporary(error: OSError | sqlite3.OperationalError) -> bool:
    """True if a storage error says nothing of a study, which is tried again when it has passed."""
    return cause_of(error) in TEMPORARY


def problem(error: OSError | sqlite3.OperationalError) -> dict[str, Any]:
    """Return the arguments of the problem document for a file that cannot be written.

    They are those of `vibrafeed.app.web.replies.problem_document`: status 507, kind, title, and a
    detail with the cause.
    """
    return {
        "status": 507,
        "kind": "storage",
        "title": "The service cannot store data",
        "detail": f"{cause_of(error)}. What was there is not touched. Ask again when that is "
        "fixed: a job goes on where it was.",
    }


def cause_of(error: OSError | sqlite3.Error) -> str:
    """Return the cause of a storage error in a few words for clients, without any path."""
    if isinstance(error, LostLedgerError):
        return LOST
    if isinstance(error, DamagedLedgerError):
        return DAMAGED
    if isinstance(error, OSError):
        return STORAGE.get(error.errno or 0, "A file cannot be written")
    return next(
        (text for word, text in SQLITE.items() if word in str(error)), "The ledger reports errors"
    )
