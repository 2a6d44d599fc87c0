"""Replies of text, compressed for clients that take gzip.

Starlette's layer compresses, large bodies in threads of its own. It knows neither weights, nor that
what is compressed is no longer the content that a strong ETag or a digest names: that is seen to
here.
"""

from __future__ import annotations

from starlette.datastructures import Headers, MutableHeaders
from starlette.middleware.gzip import DEFAULT_EXCLUDED_CONTENT_TYPES, GZipMiddleware
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from vibrafeed.app.web.accept import takes_gzip
from vibrafeed.app.web.documents import NETCDF_TYPE
from vibrafeed.app.web.tables import PACKED

SMALL = 1400  # bytes: with its head, such a reply fills one packet
LEVEL = 1  # digits hardly compress further at higher ones, which take several times as long
# Numbers as they are in memory hardly compress, files do so by themselves, and both are resumed.
PLAIN = (
    *DEFAULT_EXCLUDED_CONTENT_TYPES,
    "application/octet-stream",
    NETCDF_TYPE,
    *PACKED,
)


class Compress:
    """Compresses JSON, CSV and other texts where a client takes gzip."""

    def __init__(self, app: ASGIApp):
        """Wrap an application in gzip compression."""
        self.app = GZipMiddleware(app, SMALL, LEVEL, exclude_content_types=PLAIN)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request; compress its reply with gzip if the client accepts it.

        Byte ranges and files of Zarr groups are sent as they are. The arguments are those of ASGI.
        """
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        # A part of a file is a part of it as it is, and a Zarr group is files with digests.
        headers = Headers(scope=scope)
        is_file = "range" in headers or "/zarr/" in scope["path"]
        is_taken = takes_gzip(",".join(headers.getlist("accept-encoding")))
        named = b"gzip" if is_taken and not is_file else b"identity"
        others = [pair for pair in scope["headers"] if pair[0] != b"accept-encoding"]
        scope["headers"] = [*others, (b"accept-encoding", named)]
        await self.app(scope, receive, _weaken_etag(send))


def _weaken_etag(send: Send) -> Send:
    """Return a `send` that adapts the headers of a reply that was compressed on its way.

    The compressed bytes are not those of the ETag and digest: the ETag becomes a weak one, and byte
    ranges and digest are no longer offered. Argument and result are `send` functions of ASGI.
    """

    async def weakened(message: Message) -> None:
        """Send a message, adapting the headers of a compressed reply."""
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            if headers.get("content-encoding") == "gzip":
                etag = headers.get("etag", "")
                if etag.startswith('"'):
                    headers["etag"] = f"W/{etag}"
                for name in ("accept-ranges", "repr-digest"):
                    del headers[name]
        await send(message)

    return weakened
