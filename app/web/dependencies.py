"""Dependencies of routes: identifiers, settings, the store, the body within its limit.

All are coroutines: FastAPI would send a plain function to a thread, and that takes longer than it.
"""

from __future__ import annotations

from collections import Counter
from typing import Annotated, Any, cast

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

MAX_DIGITS = 20  # of a length that fits a limit


def _from_state(name: str) -> Any:

    async def read(request: Request) -> Any:
        return getattr(request.app.state, name)

    return Depends(read)


async def who_of(request: Request) -> keys.Key:
    """Return the key that the request was sent with."""
    return cast(keys.Key, request.state.key)


async def base_of(request: Request) -> str:
    """Return the address of the service as the client sees it, without a trailing slash."""
    return str(request.base_url).rstrip("/")


def refuse_repeated(*repeatable: str) -> params.Depends:
    """Return a dependency of a route that refuses repeated query parameters.

    `repeatable` are the names of the parameters that may be repeated.
    """

    async def check(request: Request) -> None:
        """Raise `RequestValidationError`, which becomes a 422, if a query parameter is repeated."""
        names = Counter(name for name, _ in request.query_params.multi_items())
        repeated = [name for name, times in names.items() if times > 1 and name not in repeatable]
        message = "the parameter is given more than once"
        if repeated:
            raise RequestValidationError(
                [{"loc": ("query", name[:60]), "msg": message} for name in sorted(repeated)]
            )

    return cast(params.Depends, Depends(check))


async def body_of(request: Request) -> bytes:
    """Return the request body; raise `TooLargeError` as soon as it exceeds the limit.

    The limit is the setting `max_body_bytes`. A coded body is 415: it may unpack to any size.
    """
    coding = request.headers.get("content-encoding", "identity")
    if coding.lower() != "identity":
        detail = f"The body has the content coding {coding[:40]}. Send it without Content-Encoding."
        raise HTTPException(415, detail, headers={"Accept-Encoding": "identity"})
    limit = request.app.state.settings.max_body_bytes
    declared = request.headers.get("content-length", "")
    if declared.isdecimal() and (len(declared) > MAX_DIGITS or int(declared) > limit):
        raise TooLargeError(limit)
    pieces, size = [], 0
    async for piece in request.stream():
        size += len(piece)
        if size > limit:
            raise TooLargeError(limit)
        pieces.append(piece)
    return b"".join(pieces)


SettingsOf = Annotated[Settings, _from_state("settings")]
StoreOf = Annotated[Store, _from_state("store")]
WriterOf = Annotated[Writer, _from_state("writer")]
AdmissionOf = Annotated[Admission, _from_state("admission")]
ViewsOf = Annotated[ZarrViews, _from_state("views")]
WhoOf = Annotated[keys.Key, Depends(who_of)]
BaseOf = Annotated[str, Depends(base_of)]
Body = Annotated[bytes, Depends(body_of)]


async def readable_sweep(
    request: Request,
    key: Annotated[str, Path(description="Identifier of a sweep.", max_length=100)],
) -> str:
    """Return the identifier of a sweep that the client may read; raise `NotFoundError` otherwise.

    `key` is the identifier in the path. Each dependency takes FastAPI some 20 microseconds: what
    the application holds is taken from the request.
    """
    api_key, admission = request.state.key, request.app.state.admission
    if api_key.sees_all or await run_in_threadpool(admission.may_read, key, api_key):
        return key
    raise unknown(key)


async def readable_job(
    request: Request,
    number: Annotated[str, Path(description="Identifier of a job.", max_length=100)],
) -> str:
    """Return the identifier of a job that the client may read; raise `NoSuchJobError` otherwise.

    `number` is the identifier in the path.
    """
    api_key, admission = request.state.key, request.app.state.admission
    if api_key.sees_all or await run_in_threadpool(admission.job, number, api_key) is not None:
        return number
    raise no_such_job(number)


SweepKey = Annotated[str, Depends(readable_sweep)]
Number = Annotated[str, Depends(readable_job)]
