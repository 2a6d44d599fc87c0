"""Sweeps as Zarr groups: chunks are computed when they are asked for, and nothing is stored."""

from __future__ import annotations

from contextlib import nullcontext
from typing import Annotated

import numpy as np
from fastapi import Path, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import Response

from vibrafeed.app.jobs.errors import NotFoundError
from vibrafeed.app.web.dependencies import SweepKey, ViewsOf
from vibrafeed.app.web.downloads import FOR_EVER, etag_of, not_modified
from vibrafeed.app.web.replies import BINARY, OBJECT, Router, cached_replies, problems
from vibrafeed.app.web.shares import slot_of
from vibrafeed.app.web.zarr_views import ZarrViews

router = Router(prefix="/sweeps", tags=["sweeps"])

ZarrKey = Annotated[
    str,
    Path(
        description="Key within the Zarr group: `zarr.json`, `{array}/zarr.json`, or "
        "`{array}/c/i/j/...` with the indices of a chunk. The arrays are the "
        "axes, the outputs and `regime`.",
        max_length=300,
        examples=["zarr.json"],
    ),
]


@router.get(
    "/{key}/zarr/{path:path}",
    summary="Read a sweep as a Zarr group",
    response_class=Response,
    responses={
        # Bytes first: generated clients take the first for all.
        **cached_replies(
            "A document, or the values of a chunk, little-endian, not compressed",
            {"application/octet-stream": BINARY, "application/json": OBJECT},
        ),
        **problems(
            s404="No such sweep, or no such key",
            s409="The sweep is another version's: post it again",
            s422="The key is too long",
        ),
    },
)
async def get_zarr(
    request: Request,
    key: SweepKey,
    path: ZarrKey,
    views: ViewsOf,
) -> Response:
    """Return a key of the read-only Zarr v3 group of a sweep.

    Clients open the address without the Zarr key, as in
    `xarray.open_zarr(".../sweeps/{key}/zarr")`. A chunk is computed when it is read, whatever the
    size of the sweep. HEAD tells sizes and ETags without computing anything.
    """
    # A client that reads many chunks takes no thread from another's small slice.
    async with nullcontext() if path.endswith(".json") else slot_of(request):
        return await run_in_threadpool(_key_reply, request, views, key, path)


def _key_reply(request: Request, views: ZarrViews, key: str, path: str) -> Response:
    """Return the reply for a key of the Zarr group of a sweep."""
    view = views.view(key)
    missing = NotFoundError(
        f"This sweep has no Zarr key '{path[:80]}'. Open the address that ends in /zarr with a "
        "Zarr client; zarr.json names the arrays."
    )
    # A slash is a slash: an encoded one belongs to a name, and no name has one.
    if b"%2f" in request.scope.get("raw_path", b"").lower():
        raise missing
    try:
        length = view.length(path)
    except KeyError:
        raise missing from None
    # The last bits of values are those of this version of numpy.
    etag = etag_of(key, np.__version__, path)
    unchanged = not_modified(request, etag, FOR_EVER)
    if unchanged is not None:
        return unchanged
    media_type = "application/json" if path.endswith(".json") else "application/octet-stream"
    headers = {"ETag": etag, "Cache-Control": FOR_EVER}
    if request.method == "HEAD":
        return Response(headers={**headers, "Content-Length": str(length)}, media_type=media_type)
    return Response(view.read(path), headers=headers, media_type=media_type)
