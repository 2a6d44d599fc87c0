"""Documents that are made once and kept, each by whoever asks for it first.

Some take seconds of the interpreter. Were each thread to make one, or to wait for one that another
makes, there would be no thread left for anybody else.
"""

from __future__ import annotations

import asyncio
import hashlib
from collections.abc import Callable, Hashable
from typing import cast

from fastapi import Request
from fastapi.responses import Response

from vibrafeed.app.web.downloads import document_reply, etag_of


class MadeOnce:
    """A cache of documents, each made in a thread, one at a time."""

    def __init__(self) -> None:
        """Begin with an empty cache."""
        self._kept: dict[Hashable, tuple[bytes, str]] = {}
        self._lock = asyncio.Lock()

    async def __call__(self, name: Hashable, make: Callable[[], bytes]) -> tuple[bytes, str]:
        """Return a cached document and its ETag; if the document is missing, make it in a thread.

        `name` is its key in the cache; `make` is called without arguments and returns the bytes.
        """
        if name not in self._kept:
            async with self._lock:
                if name not in self._kept:  # nobody has made it meanwhile
                    content = await asyncio.to_thread(make)
                    self._kept[name] = content, etag_of(hashlib.sha256(content).hexdigest())
        return self._kept[name]


async def made_once(request: Request, name: Hashable, make: Callable[[], bytes]) -> Response:
    """Return a cached JSON document as a reply; `make` is called if it is missing.

    `name` is its key in the cache. Names have to be few, since nothing is ever removed: none may
    contain a text that a client chooses freely.
    """
    content, etag = await cast(MadeOnce, request.app.state.made_once)(name, make)
    return document_reply(request, content, etag)
