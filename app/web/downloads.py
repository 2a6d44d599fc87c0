"""Replies that clients may keep, ask for again, and resume: ETags, conditions, ranges."""

from __future__ import annotations

import asyncio
import base64
import hashlib
import os
import re
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import FileIO
from pathlib import Path

from fastapi import Request
from fastapi.responses import Response, StreamingResponse
from starlette.types import Receive, Scope, Send

from vibrafeed.app.jobs.errors import NotFoundError
from vibrafeed.app.jobs.integrity import Integrity
from vibrafeed.app.web.replies import problem_document

# Bytes that are read at a time: as fast as sendfile, where the 64 KiB of FileResponse take three
# times as long.
PIECE = 1 << 20

# The address of what is replied holds the hash of the study and of the version: it never changes.
# Not "public": where keys are asked for, a proxy must not hand it on.
FOR_EVER = "max-age=31536000, immutable"
ASK_AGAIN = "no-cache"

_TAGS = re.compile(r'(W/)?("[^"]*")')
_RANGE = re.compile(r"bytes=([0-9]{0,19})-([0-9]{0,19})", re.IGNORECASE)


def etag_of(*parts: str) -> str:
    """Return a strong ETag for content that is determined by these words."""
    return f'"{hashlib.sha256(chr(0).join(parts).encode()).hexdigest()}"'


def not_modified(request: Request, etag: str, cache: str) -> Response | None:
    """Return the reply 304 if the client has this content already, by its If-None-Match header.

    None if the content has to be sent. `cache` is the reply's Cache-Control header.
    """
    if not _names(request.headers.getlist("if-none-match"), etag):
        return None
    return Response(status_code=304, headers={"ETag": etag, "Cache-Control": cache})


def document_reply(request: Request, content: bytes, etag: str) -> Response:
    """Return a JSON document with its ETag, or 304 if the client has it already."""
    there = not_modified(request, etag, ASK_AGAIN)
    headers = {"ETag": etag, "Cache-Control": ASK_AGAIN}
    return there or Response(content, media_type="application/json", headers=headers)


def content_reply(content: bytes, *, etag: str, media_type: str) -> Response:
    """Return a reply whose content never changes at its address, to be cached for a year.

    `media_type` is the Content-Type, `etag` the ETag of the content.
    """
    headers = {"ETag": etag, "Cache-Control": FOR_EVER}
    return Response(content, headers=headers, media_type=media_type)


def file_reply(
    request: Request,
    path: Path,
    *,
    media_type: str,
    filename: str,
    digest: str | None = None,
    etag: str | None = None,
    check: Check | None = None,
) -> Response:
    """Return a file, or the requested byte range of it, in pieces read by a thread.

    Conditional requests are answered with 304 or 412, and ranges beyond the file with 416.

    Parameters
    ----------
    request : Request
        The request with its conditions and range.
    path, media_type, filename : Path, str, str
        The file, its Content-Type, and the name under which the client is to save it.
    digest : str, optional
        SHA-256 of the content, which is also the ETag: a part may then be joined to one from
        another server.
    etag : str, optional
        The ETag where the content follows from its address.
    check : Check, optional
        Compares the content with `digest` before the reply begins.

    Raises
    ------
    NotFoundError
        If the file has been removed; the reply raises it too, as long as it has not begun.
    """
    with _there():
        size = path.stat().st_size
    etag = etag or f'"{digest}"'
    wanted = request.headers.getlist("if-match")
    if wanted and not _names(wanted, etag, strong=True):
        detail = f"The file's ETag is {etag}, which If-Match does not name."
        return problem_document(412, "precondition", "The file has changed", detail)
    known = not_modified(request, etag, ASK_AGAIN)
    if known is not None:
        return known
    headers = {
        "ETag": etag,
        "Cache-Control": ASK_AGAIN,
        "Accept-Ranges": "bytes",
        "Content-Disposition": f'attachment; filename="{filename}"',
    }
    if digest is not None:
        encoded = base64.b64encode(bytes.fromhex(digest)).decode()
        headers["Repr-Digest"] = f"sha-256=:{encoded}:"
    part = _part(request, etag, size)
    if part is None:
        start, stop, status = 0, size, 200
    else:
        (start, stop), status = part, 206
        if start >= stop:
            detail = f"The file has {size:,} bytes; the range asked for has none of them."
            reply = problem_document(416, "range", "The range cannot be satisfied", detail)
            reply.headers["Content-Range"] = f"bytes */{size}"
            return reply
        headers["Content-Range"] = f"bytes {start}-{stop - 1}/{size}"
    headers["Content-Length"] = str(stop - start)
    if request.method == "HEAD":
        stop = start
    checked = None if check is None or digest is None else (check, digest)
    return _FileResponse(path, start, stop, status, headers, media_type, checked)


@dataclass(frozen=True)
class Check:
    """The check of a file against its digest, and the reaction if it differs.

    Attributes
    ----------
    integrity : Integrity
        Compares the file, unless it has done so already.
    broken : callable
        Removes a damaged file, given its `stat` result, and returns the error for the client.
    """

    integrity: Integrity
    broken: Callable[[os.stat_result], Exception]

    def look(self, path: Path, digest: str) -> None:
        """Raise the error for the client if a file is damaged; may take long, as the file is read.

        `digest` is the SHA-256 that it should have. Raises `NotFoundError` if the file is gone.
        """
        with _there():
            file = path.open("rb", buffering=0)
        with file:
            if not self.integrity.look(file, digest):
                raise self.broken(os.fstat(file.fileno()))


class _FileResponse(StreamingResponse):
    """Opens the file before it sends a header, and holds it until it has ended in any way.

    Threads of the event loop's own pool open and read it, which wait for no computing.
    """

    def __init__(
        self,
        path: Path,
        start: int,
        stop: int,
        status: int,
        headers: dict[str, str],
        media_type: str,
        checked: tuple[Check, str] | None,
    ):
        """Prepare the reply with the bytes from `start` to `stop` of a file."""
        super().__init__((), status, headers, media_type)
        self._path, self._start, self._stop, self._checked = path, start, stop, checked

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Open the file, then send headers and content; close it in any case.

        Before that compare it with its digest, if that is asked for. The arguments are those of
        ASGI.
        """
        with _there():
            file = await asyncio.to_thread(self._path.open, "rb", buffering=0)
        with file:
            if self._checked is not None:
                check, digest = self._checked
                if not await check.integrity.is_intact(file, digest):
                    raise await asyncio.to_thread(check.broken, os.fstat(file.fileno()))
            self.body_iterator = _pieces(file, self._start, self._stop)
            await super().__call__(scope, receive, send)


async def _pieces(file: FileIO, start: int, stop: int) -> AsyncIterator[bytes]:
    """Yield the bytes of a file from position `start` to `stop`, in pieces of 1 MiB."""
    while start < stop:
        # By its place: a read that outlives its cancelled reply moves nobody's position.
        piece = await asyncio.to_thread(os.pread, file.fileno(), min(PIECE, stop - start), start)
        if not piece:
            raise EOFError(f"the file {file.name!r} became shorter while it was being sent")
        start += len(piece)
        yield piece


@contextmanager
def _there() -> Iterator[None]:
    """Turn the error of a file that was just removed, raised in the block, into `NotFoundError`."""
    try:
        yield
    except FileNotFoundError:
        raise NotFoundError(
            "The result was removed from the service. Post its study again."
        ) from None


def _names(headers: list[str], etag: str, *, strong: bool = False) -> bool:
    """True if the values of an ETag header, such as If-Match, name this ETag or ``*``.

    `headers` are the values of all headers of this name. With `strong`, a weak ETag (``W/"..."``)
    in them does not match.
    """
    if any(header.strip() == "*" for header in headers):
        return True
    found = _TAGS.findall(",".join(headers))
    return any(tag == etag and not (weak and strong) for weak, tag in found)


def _part(request: Request, etag: str, size: int) -> tuple[int, int] | None:
    """Return start and stop of the byte range that a request asks for; None for the whole file.

    The whole is sent, as the standard allows, if the range is malformed, if there are several, or
    if If-Range names another ETag. A range beyond the file gives stop <= start. `request` has the
    headers, `etag` is the file's ETag and `size` its size [bytes].
    """
    condition = request.headers.get("if-range")
    found = _RANGE.fullmatch(request.headers.get("range", "").strip())
    if request.method != "GET" or found is None or condition not in (None, etag):
        return None
    first, last = found[1], found[2]
    if first == "":
        return (max(0, size - int(last)), size) if last else None
    if last == "":
        return int(first), size
    if int(last) < int(first):
        return None
    return int(first), min(int(last) + 1, size)
