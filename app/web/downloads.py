"""Replies that clients may keep, ask for again, and resume: ETags, conditions, ranges."""

from __future__ import annotations

import asyncio
import base64
import hashlib
import os
import re
from collections.abc import Callable
from dataclasses import dataclass
from io import FileIO
from pathlib import Path

from anyio import to_thread
from fastapi import Request
from fastapi.responses import FileResponse, Response
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


async def made_document(request: Request, make: Callable[[], bytes]) -> Response:
    """Return a JSON document with its ETag, or 304 if the client has it already.

    `make` returns the bytes. Some take seconds the first time: one is made at a time, so that
    threads remain for other requests.
    """
    content = await to_thread.run_sync(make, limiter=request.app.state.one_document)
    etag = etag_of(content.decode())
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
    check : Check, optional
        Compares the content with `digest` before the reply begins.

    Raises
    ------
    NotFoundError
        If the file has been removed; the reply raises it too, as long as it has not begun.
    """
    etag = etag or f'"{digest}"'
    wanted = request.headers.getlist("if-match")
    if wanted and not _names(wanted, etag, strong=True):
        detail = f"The file's ETag is {etag}, which If-Match does not name."
        return problem_document(412, "precondition", "The file has changed", detail)
    known = not_modified(request, etag, ASK_AGAIN)
    if known is not None:
        return known
    headers = {"ETag": etag, "Cache-Control": ASK_AGAIN}
    if digest is not None:
        encoded = base64.b64encode(bytes.fromhex(digest)).decode()
        headers["Repr-Digest"] = f"sha-256=:{encoded}:"
    checked = None if check is None or digest is None else (check, digest)
    return _FileResponse(path, headers, media_type, filename, checked)


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

    def look(self, file: FileIO, digest: str) -> None:
        """Raise the error for the client if a file does not have this SHA-256; reads the file."""
        if not self.integrity.look(file, digest):
            raise self.broken(os.fstat(file.fileno()))


class _FileResponse(FileResponse):
    """A file that is opened, and compared with its digest, before a header is sent."""

    chunk_size = PIECE

    def __init__(
        self,
        path: Path,
        headers: dict[str, str],
        media_type: str,
        filename: str,
        checked: tuple[Check, str] | None,
    ):
        super().__init__(path, headers=headers, media_type=media_type, filename=filename)
        self._path, self._checked = path, checked

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        await asyncio.to_thread(self._look)
        await super().__call__(scope, receive, send)

    def _look(self) -> None:
        with opened(self._path) as file:
            self.stat_result = os.fstat(file.fileno())
            self.set_stat_headers(self.stat_result)
            if self._checked is not None:
                check, digest = self._checked
                check.look(file, digest)


def opened(path: Path) -> FileIO:
    """Open a file of a result; raise `NotFoundError` if it was removed."""
    try:
        return path.open("rb", buffering=0)
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
