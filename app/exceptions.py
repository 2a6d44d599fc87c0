"""What can go wrong in the service; `app.errors` says what each is over HTTP.

Workers import these, and nothing of HTTP.
"""

from __future__ import annotations

from core.errors import VibrafeedError


class NotFoundError(VibrafeedError):
    """A resource does not exist; the message says which."""


class NoSuchProcessError(NotFoundError):
    """There is no such process."""


class NoSuchJobError(NotFoundError):
    """There is no such job."""


class NotReadyError(NotFoundError):
    """The results of a job are not there yet."""


class TooLargeError(VibrafeedError):
    """The body of a request is larger than the limit, which the message names."""

    def __init__(self, most: int):
        super().__init__(f"A body may hold {most:,} bytes; this one holds more.")


class QueueFullError(VibrafeedError):
    """No further work is taken for the moment."""


class NoRoomError(VibrafeedError):
    """A result would not fit on the disk, or not in the quota."""


class TornBlockError(VibrafeedError):
    """A block cannot be read; it has been removed, to be computed anew."""


class OtherVersionError(VibrafeedError):
    """A study was posted to another version of vibrafeed."""
