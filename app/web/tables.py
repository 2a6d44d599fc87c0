"""Results as CSV and Parquet, sent in pieces as they are written."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator
from importlib.metadata import version
from importlib.util import find_spec
from typing import Final

from anyio import CapacityLimiter, to_thread
from fastapi import Request
from fastapi.responses import Response, StreamingResponse

from app.web.outgoing import expect
from core.dataset.frame import EXTRA, FORMS, Frame, pyarrow

NOTE: Final = "Vibrafeed-Note"
TABLES: Final = {"csv": "text/csv", "parquet": "application/vnd.apache.parquet"}
IN_WORK: Final = 16_000_000  # bytes of the pieces that are written while others are sent


def tables_there() -> dict[str, str]:
    """Return the media types of the forms that this service can write."""
    return TABLES if find_spec("pyarrow") else {"csv": TABLES["csv"]}


def missing() -> str:
    """Return what is told of forms that this service cannot write."""
    return "" if find_spec("pyarrow") else f"Parquet takes pyarrow: {EXTRA}."


def written_by(form: str) -> str:
    """Return what else the bytes of a table follow from, for its ETag."""
    if form != "parquet":
        return form
    pyarrow()
    return f"parquet {version('pyarrow')}"


async def table_reply(
    request: Request, frame: Frame, form: str, *, lane: CapacityLimiter | None
) -> Response:
    """Return a table in a form, in pieces; each is written in a thread of a lane."""
    values = [one.values for one in frame.table.variables.values()]
    expect(request, sum(array.nbytes for array in values) + min(IN_WORK, 500 * frame.rows))
    pieces = FORMS[f".{form}"](frame)
    note = frame.note
    reply = StreamingResponse(_written(pieces, lane), media_type=TABLES[form])
    if note:
        reply.headers[NOTE] = note
    return reply


async def _written(pieces: Iterator[bytes], lane: CapacityLimiter | None) -> AsyncIterator[bytes]:
    while piece := await to_thread.run_sync(next, pieces, b"", limiter=lane):
        yield piece
