"""One JSON line for each request and each event, on the error stream.

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
    """Give every line until the end of a request these fields; yield them, with what is bound."""
    token = _request.set(fields)
    try:
        yield fields
    finally:
        _request.reset(token)


def bind(**fields: object) -> None:
    """Add fields, such as ``job_id``, to the lines of the request under way, if there is one."""
    current = _request.get()
    if current is not None:
        current.update(fields)


def configure(stream: TextIO | None = None) -> None:
    """Send every line of every logger to a stream as JSON; the error stream if left out."""
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
    # Libraries tell of their doings at will, addresses among it; these two are known.
    root.setLevel(logging.WARNING)
    for name in ("vibrafeed", "uvicorn", "uvicorn.error"):
        logger = logging.getLogger(name)
        logger.handlers, logger.propagate = [], True
        logger.setLevel(logging.INFO)


def _merge_request(logger: WrappedLogger, name: str, event: EventDict) -> EventDict:
    return {**(_request.get() or {}), **event}


def _drop_colours(logger: WrappedLogger, name: str, event: EventDict) -> EventDict:
    event.pop("color_message", None)  # uvicorn's second copy of the message, for terminals
    return event
