"""Replies that clients may keep, ask for again, and resume: ETags, conditions, ranges."""

from __future__ import annotations

import base64
import hashlib
import os
import re
from collections.abc import Callable
from pathlib import Path

from anyio import to_thread
from fastapi import Request
from fastapi.responses import FileResponse, Response

from vibrafeed.app.jobs.errors import NotFoundError
from vibrafeed.app.web.replies import problem_document

# Bytes that are read at a time: as fast as sendfile, where the 64 KiB of FileResponse take three
# times as long.
PIECE = 1 << 20

# The address of what is replied holds the hash of the study and of the version: it never changes.
# Not "public": where keys are asked for, a proxy must not hand it on.
FOR_EVER = "max-age=31536000, immutable"
ASK_AGAIN = "no-cache"

_TAGS = re.compile(r'(W/)?("[^"]*")')


def etag_of(*parts: str) -> str:
    """Return a strong ETag for content that is determined by these words."""
    return f'"{hashlib.sha256(chr(0).join(parts).encode()).hexdigest()}"'


def not_modified(request: Request, etag: str, cache: str) -> Response | None:
    """Return the reply 304 if the client has this content already, by its If-None-Match header.

    None if the content has to be sent. `cache` is the reply's Cache-Control header.
    """
    if not _has_etag(request.headers.getlist("if-none-match"), etag):
        return None
    return Response(status_code=304, headers={"ETag": etag, "Cache-Control": cache})


async def made_document(request: Request, make: Callable[[], bytes]) -> Response:
    """Return a JSON document with its ETag, or 304 if the client has it already.

    `make` returns the bytes. Some take seconds the first time: one is made at a time, so that
    threads remain for other requests.
    """
    content = await to_thread.run_sync(make, limiter=request.app.state.one_document)
    etag = etag_of(content.decode())
    unchanged = not_modified(request, etag, ASK_AGAIN)
    headers = {"ETag": etag, "Cache-Control": ASK_AGAIN}
    return unchanged or Response(content, media_type="application/json", headers=headers)


def file_reply(
    request: Request,
    path: Path,
    *,
    media_type: str,
    filename: str,
    digest: str | None = None,
    etag: str | None = None,
) -> Response:
    """Return a file, or the requested byte ranges of it.

    Conditional requests are answered with 304 or 412.

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

    Raises
    ------
    NotFoundError
        If the file has been removed.
    """
    etag = etag or f'"{digest}"'
    if_match = request.headers.getlist("if-match")
    if if_match and not _has_etag(if_match, etag, strong=True):
        detail = f"The file's ETag is {etag}, which If-Match does not name."
        return problem_document(412, "precondition", "The file has changed", detail)
    unchanged = not_modified(request, etag, ASK_AGAIN)
    if unchanged is not None:
        return unchanged
    headers = {"ETag": etag, "Cache-Control": ASK_AGAIN}
    if digest is not None:
        encoded = base64.b64encode(bytes.fromhex(digest)).decode()
        headers["Repr-Digest"] = f"sha-256=:{encoded}:"
    status = _status_of(path)
    reply = FileResponse(path, 200, headers, media_type, filename=filename, stat_result=status)
    reply.chunk_size = PIECE
    return reply


def _status_of(path: Path) -> os.stat_result:
    """Return the status of a file that can be opened; raise `NotFoundError` if it was removed."""
    try:
        with path.open("rb") as file:
            return os.fstat(file.fileno())
    except FileNotFoundError:
        raise NotFoundError(
            "The result was removed from the service. Post its study again."
        ) from None


def _has_etag(headers: list[str], etag: str, *, strong: bool = False) -> bool:
    """True if the values of an ETag header, such as If-Match, name this ETag or ``*``.

    `headers` are the values of all headers of this name. With `strong`, a weak ETag (``W/"..."``)
    in them does not match.
    """
    if any(header.strip() == "*" for header in headers):
        return True
    tags = _TAGS.findall(",".join(headers))
    return any(tag == etag and not (weak and strong) for weak, tag in tags)
