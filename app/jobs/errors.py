"""Errors of jobs and their files; `vibrafeed.app.web.problems` says what each is over HTTP."""

from __future__ import annotations

from vibrafeed.core.errors import VibrafeedError


class NotFoundError(VibrafeedError):
    """A resource does not exist; the message says which."""


class QueueFullError(VibrafeedError):
    """No further work is taken for the moment."""


class TooManyJobsError(VibrafeedError):
    """A key has as many jobs as it may."""


class NotOwnerError(VibrafeedError):
    """Only the owner may do that."""


class GoneError(VibrafeedError):
    """The result of a job has made room for others."""


class NoRoomError(VibrafeedError):
    """A result would not fit on the disk, or not in the quota."""


class TornBlockError(VibrafeedError):
    """A block cannot be read; it has been removed, to be computed anew."""


class OtherVersionError(VibrafeedError):
    """A study was posted to another version of vibrafeed."""


class BlindWorkerError(VibrafeedError):
    """A worker does not see the data directory of the service."""


class LostLedgerError(OSError):
    """The database of the ledger cannot be reached; it is not on this machine's disk."""


class DamagedLedgerError(OSError):
    """The database of the ledger does not hold what was written to it."""


class LaterLedgerError(VibrafeedError):
    """The ledger was changed by a later version of vibrafeed."""
