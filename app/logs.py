"""JSON lines on requests and events, on the error stream.

Lines hold no headers, query strings, bodies or keys. Modules log through `logging`, as ever;
`configure`, which only `vibrafeed serve` calls, decides how lines look.
"""

from __future__ import annotations

import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TextIO

import structlog
from structlog.typing import EventDict, WrappedLogger

# What the request line tells beside itself. One dict a request, shared by its copied contexts, so
# that what a thread of the pool binds is seen by the event loop too.
_request: ContextVar[dict[str, object] | None] = ContextVar("vibrafeed_request", default=None)


@contextmanager
def request(**fields: object) -> Iterator[dict[str, object]]:
    """Add fields to every log line that is written inside the block, which handles one request.

    Yield the dict of these fields, to which `bind` adds more.
    """
    token = _request.set(fields)
    try:
        yield fields
    finally:
        _request.reset(token)


def bind(**fields: object) -> None:
    """Add fields, such as ``job_id``, to the log lines of the current request, if there is one."""
    current = _request.get()
    if current is not None:
        current.update(fields)


def configure(stream: TextIO | None = None) -> None:
    """Write all log lines of all loggers as JSON to a stream, by default the error stream.

    Loggers of other libraries write warnings and errors only; those of vibrafeed and uvicorn also
    information.
    """
    shared: list[structlog.typing.Processor] = [
        structlog.contextvars.merge_contextvars,
        _merge_request,
        structlog.stdlib.add_log_level,
        structlog.stdlib.add_logger_name,
        structlog.stdlib.ExtraAdder(),
        structlog.processors.TimeStamper(fmt="iso", utc=True),
        _drop_colours,
    ]
    handler = logging.StreamHandler(stream or sys.stderr)
    handler.setFormatter(
        structlog.stdlib.ProcessorFormatter(
            foreign_pre_chain=shared,
            processors=[
                structlog.stdlib.ProcessorFormatter.remove_processors_meta,
                structlog.processors.format_exc_info,
                structlog.processors.JSONRenderer(),
            ],
        )
    )
    root = logging.getLogger()
    root.handlers = [handler]
    # What other libraries log may hold addresses; vibrafeed and uvicorn write none.
    root.setLevel(logging.WARNING)
    for name in ("vibrafeed", "uvicorn", "uvicorn.error"):
        own_logger = logging.getLogger(name)
        own_logger.handlers, own_logger.propagate = [], True
        own_logger.setLevel(logging.INFO)


def _merge_request(logger: WrappedLogger, name: str, event: EventDict) -> EventDict:
    """Return the fields of a log line with those of the current request; its own go first."""
    return {**(_request.get() or {}), **event}


def _drop_colours(logger: WrappedLogger, name: str, event: EventDict) -> EventDict:
    """Return the fields of a log line without uvicorn's coloured copy of the message."""
    event.pop("color_message", None)
    return event
