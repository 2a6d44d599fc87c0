"""Dependencies of routes: identifiers, settings, the store, the body within its limit.

All are coroutines: FastAPI would send a plain function to a thread, and that takes longer than it.
"""

from __future__ import annotations

from typing import Annotated, cast

from fastapi import Depends, Path, Request, params
from fastapi.concurrency import run_in_threadpool
from fastapi.exceptions import HTTPException, RequestValidationError

from vibrafeed.app.jobs import keys
from vibrafeed.app.jobs.admission import Admission
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.jobs.studies import unknown
from vibrafeed.app.jobs.writer import Writer
from vibrafeed.app.settings import Settings
from vibrafeed.app.web.outcomes import no_such_job
from vibrafeed.app.web.problems import TooLargeError
from vibrafeed.app.web.zarr_views import ZarrViews


async def settings_of(request: Request) -> Settings:
    """Return the settings of the application."""
    return cast(Settings, request.app.state.settings)


async def store_of(request: Request) -> Store:
    """Return the store of the application."""
    return cast(Store, request.app.state.store)


async def writer_of(request: Request) -> Writer:
    """Return the writer of the application's result files."""
    return cast(Writer, request.app.state.writer)


async def admission_of(request: Request) -> Admission:
    """Return the object that admits and manages jobs."""
    return cast(Admission, request.app.state.admission)


async def who_of(request: Request) -> keys.Key:
    """Return the key that the request was sent with."""
    return cast(keys.Key, request.state.key)


async def views_of(request: Request) -> ZarrViews:
    """Return the application's views of sweeps as Zarr groups."""
    return cast(ZarrViews, request.app.state.views)


async def base_of(request: Request) -> str:
    """Return the address of the service as the client sees it, without a trailing slash."""
    return str(request.base_url).rstrip("/")


def refuse_repeated(*several: str) -> params.Depends:
    """Return a dependency of a route that refuses repeated query parameters.

    `several` are the names of the parameters that may be repeated.
    """

    async def check(request: Request) -> None:
        """Raise `RequestValidationError`, which becomes a 422, if a query parameter is repeated."""
        names = [name for name in _names(request) if name not in several]
        if len(names) == len(set(names)):
            return
        repeated = {name for name in names if names.count(name) > 1}
        message = "the parameter is given more than once"
        raise RequestValidationError(
            [{"loc": ("query", name[:60]), "msg": message} for name in sorted(repeated)]
        )

    return cast(params.Depends, Depends(check))


def _names(request: Request) -> list[str]:
    """Return the names of all query parameters, repeated ones as often as they occur."""
    return [name for name, _ in request.query_params.multi_items()]


async def body_of(request: Request) -> bytes:
    """Return the request body; raise `TooLargeError` as soon as it exceeds the limit.

    The limit is the setting `max_body_bytes`. A coded body is 415: it may unpack to any size.
    """
    coding = request.headers.get("content-encoding", "identity")
    if coding.lower() != "identity":
        detail = f"The body has the content coding {coding[:40]}. Send it without Content-Encoding."
        raise HTTPException(415, detail, headers={"Accept-Encoding": "identity"})
    limit = (await settings_of(request)).max_body_bytes
    pieces, size = [], 0
    async for piece in request.stream():
        size += len(piece)
        if size > limit:
            raise TooLargeError(limit)
        pieces.append(piece)
    return b"".join(pieces)


SettingsOf = Annotated[Settings, Depends(settings_of)]
StoreOf = Annotated[Store, Depends(store_of)]
WriterOf = Annotated[Writer, Depends(writer_of)]
AdmissionOf = Annotated[Admission, Depends(admission_of)]
WhoOf = Annotated[keys.Key, Depends(who_of)]


async def readable_sweep(
    request: Request,
    key: Annotated[str, Path(description="Identifier of a sweep.", max_length=100)],
) -> str:
    """Return the identifier of a sweep that the client may read; raise `NotFoundError` otherwise.

    `key` is the identifier in the path. Each dependency takes FastAPI some 20 microseconds: what
    the application holds is taken from the request.
    """
    who = await who_of(request)
    if not who.sees_all:
        admission = await admission_of(request)
        if not await run_in_threadpool(admission.may_read, key, who):
            raise unknown(key)
    return key


async def readable_job(
    request: Request,
    number: Annotated[str, Path(description="Identifier of a job.", max_length=100)],
) -> str:
    """Return the identifier of a job that the client may read; raise `NoSuchJobError` otherwise.

    `number` is the identifier in the path.
    """
    who = await who_of(request)
    if not who.sees_all:
        admission = await admission_of(request)
        if await run_in_threadpool(admission.job, number, who) is None:
            raise no_such_job(number)
    return number


SweepKey = Annotated[str, Depends(readable_sweep)]
Number = Annotated[str, Depends(readable_job)]
ViewsOf = Annotated[ZarrViews, Depends(views_of)]
BaseOf = Annotated[str, Depends(base_of)]
Body = Annotated[bytes, Depends(body_of)]
