"""Jobs after OGC API - Processes: status, list, events, dismissal."""

from __future__ import annotations

import asyncio
import re
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from datetime import datetime
from typing import Annotated, Literal

import orjson
from fastapi import Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import Response, StreamingResponse
from pydantic import AfterValidator
from starlette.datastructures import URL

from vibrafeed.app.jobs.admission import Admission
from vibrafeed.app.jobs.keys import NOBODY, Key, Keys
from vibrafeed.app.jobs.ledger import ACTIVE, STATES, Wanted
from vibrafeed.app.web.dependencies import AdmissionOf, BaseOf, Body, Number, WhoOf, refuse_repeated
from vibrafeed.app.web.documents import (
    JobList,
    StatusInfo,
    status_info,
)
from vibrafeed.app.web.entry import owner_of
from vibrafeed.app.web.execution import PROCESSES
from vibrafeed.app.web.outcomes import find_job, no_such_job
from vibrafeed.app.web.replies import Router, json_reply, problems, without_length
from vibrafeed.app.web.shares import hold_slot
from vibrafeed.app.web.sharing import NO_SHARING, NOT_OWNER, SHARING_BODY, read_sharing

router = Router(prefix="/jobs", tags=["jobs"])

State = Literal["accepted", "running", "successful", "failed", "dismissed"]
assert set(STATES) == set(State.__args__)  # type: ignore[attr-defined]

POLL = 0.25  # s between looks at a job whose events are followed
SIGN_OF_LIFE = 15.0  # s after which an idle stream says that it is alive
MAX_LISTED = 1000
NO_JOB = problems(s404="No such job", s422="The identifier is malformed")


def parse_interval(text: str | None) -> tuple[float | None, float | None]:
    """Return start and end [s since the epoch] of a time or an interval; None for an open end.

    `text` is a time of RFC 3339 with time zone, or START/END, of which one may be `..`; a single
    time is both start and end.

    Raises
    ------
    ValueError
        If it is neither.
    """
    if text is None:
        return None, None
    words = text.split("/")
    if len(words) > 2 or set(words) <= {"", ".."}:
        raise ValueError("the query parameter datetime is neither a time nor an interval START/END")
    ends: list[float | None] = []
    for word in words:
        end = None if word in ("", "..") else datetime.fromisoformat(word)
        if end is not None and end.tzinfo is None:
            raise ValueError(
                f"{word[:40]!r} in datetime has no time zone: write it as in 2026-01-01T00:00:00Z"
            )
        ends.append(None if end is None else end.timestamp())
    return ends[0], ends[-1]


def checked(parse: Callable[[str | None], object]) -> AfterValidator:
    """Return a validator that keeps the text of a query parameter if it can be parsed."""

    def check(text: str | None) -> str | None:
        """Return the text unchanged; raise the `ValueError` of `parse` if it is wrong."""
        parse(text)
        return text

    return AfterValidator(check)


def refuse_offset(text: str | None) -> None:
    """Raise `ValueError`: lists go on by `after`."""
    raise ValueError("offset has been replaced by after: follow the link `next`")


def parse_cursor(text: str | None) -> tuple[float, str] | None:
    """Return the time of entry and the identifier of the job after which a list goes on.

    `text` is that of the link `next`. Raises `ValueError` if it is another.
    """
    if text is None:
        return None
    match = re.fullmatch(r"([0-9]{1,12}\.[0-9]{1,9}),([0-9a-f-]{1,40})", text, re.ASCII)
    if match is None:
        raise ValueError("the query parameter after is not that of a link `next`")
    return float(match[1]), match[2]


@router.get("", summary="List jobs", response_model=JobList, responses=problems(s422="Bad query"),
            dependencies=[refuse_repeated("processID", "status", "type")])  # fmt: skip
async def list_jobs(
    request: Request,
    admission: AdmissionOf,
    base: BaseOf,
    api_key: WhoOf,
    process: Annotated[
        list[str],
        Query(
            alias="processID",
            max_length=20,
            description="Only jobs of these processes, such as sweep or simulate.",
        ),
    ] = [],  # noqa: B006 - not changed; None would make the schema nullable
    status: Annotated[
        list[State],
        Query(
            max_length=20, description="Only jobs in these states, such as running or successful."
        ),
    ] = [],  # noqa: B006
    kind: Annotated[
        list[str],
        Query(
            alias="type",
            max_length=20,
            description="Only jobs of these types; all jobs are of type process.",
        ),
    ] = [],  # noqa: B006
    created: Annotated[
        str | None,
        Query(
            alias="datetime",
            max_length=100,
            description="Only jobs that were posted at this time (RFC 3339) or in this interval, "
            "as in `2026-01-01T00:00:00Z/..`.",
        ),
        checked(parse_interval),
    ] = None,
    least: Annotated[
        int | None,
        Query(
            alias="minDuration",
            ge=0,
            le=10**9,
            description="Only jobs that ran for at least this many seconds.",
        ),
    ] = None,
    longest: Annotated[
        int | None,
        Query(
            alias="maxDuration",
            ge=0,
            le=10**9,
            description="Only jobs that ran for at most this many seconds.",
        ),
    ] = None,
    limit: Annotated[int, Query(ge=1, le=MAX_LISTED)] = 100,
    after: Annotated[
        str | None,
        Query(max_length=100, description="The place in the list, as the link `next` has it."),
        checked(parse_cursor),
    ] = None,
    offset: Annotated[str | None, Query(include_in_schema=False), checked(refuse_offset)] = None,
) -> Response:
    """Return jobs, the latest first; the link `next` leads to further ones."""
    seen_by = None if api_key.sees_all else api_key.name
    known_processes = [name for name in process if name in PROCESSES]
    wanted = Wanted(
        tuple(known_processes), tuple(status), parse_interval(created), (least, longest), seen_by
    )
    list_url = URL(f"{base}/jobs").replace(query=request.url.query)

    def link(rel: str, url: URL) -> dict[str, str]:
        return {"href": str(url), "rel": rel, "type": "application/json"}

    def read() -> Response:
        jobs = []
        if (known_processes or not process) and (not kind or "process" in kind):
            jobs = admission.ledger.jobs(wanted, limit=limit + 1, after=parse_cursor(after))
        links = [link("self", list_url)]
        if len(jobs) > limit:
            last = jobs[limit - 1]
            next_url = list_url.include_query_params(after=f"{last.created!r},{last.id}")
            links.append(link("next", next_url))
        statuses = [
            status_info(job, base, waiting_reason=admission.waiting_reason())
            for job in jobs[:limit]
        ]
        return json_reply({"jobs": statuses, "links": links})

    # One list of an owner at a time: those of many jobs leave threads to others.
    async with request.app.state.lists.slot(owner_of(request.scope)):
        return await run_in_threadpool(read)


@router.get("/{number}", summary="Show the status of a job", response_model=StatusInfo,
            responses=NO_JOB)  # fmt: skip
def get_job(number: Number, admission: AdmissionOf, base: BaseOf) -> Response:
    """Return the state of a job, its progress, and the time that is left."""
    job = find_job(admission, number)
    is_group = job.state in ("running", "successful") and admission.store.in_group(job.key).exists()
    return json_reply(
        status_info(job, base, is_group=is_group, waiting_reason=admission.waiting_reason())
    )


@router.delete("/{number}", summary="Dismiss a job", response_model=StatusInfo,
               responses={**NO_JOB, **NOT_OWNER})  # fmt: skip
def dismiss_job(number: Number, admission: AdmissionOf, base: BaseOf, api_key: WhoOf) -> Response:
    """Dismiss a job; what is computed for it alone is stopped."""
    job = admission.dismiss(number, api_key)
    if job is None:
        raise no_such_job(number)
    return json_reply(status_info(job, base))


@router.patch("/{number}", summary="Share a job with all access keys, or stop sharing it",
              response_model=StatusInfo,
              responses={**NO_JOB, **NOT_OWNER, **NO_SHARING},
              openapi_extra=SHARING_BODY, dependencies=[hold_slot()])  # fmt: skip
def share_job(
    number: Number, body: Body, admission: AdmissionOf, base: BaseOf, api_key: WhoOf
) -> Response:
    """Let holders of all access keys read a job and its results, or only its owner."""
    job = admission.share_job(number, read_sharing(body), api_key)
    if job is None:
        raise no_such_job(number)
    return json_reply(status_info(job, base, waiting_reason=admission.waiting_reason()))


@router.get(
    "/{number}/events",
    summary="Follow a job",
    response_class=Response,
    responses={
        200: {
            "content": {"text/event-stream": {"schema": {}}},
            "description": "An event `status` at each change, with the job's status as data; the "
            "last one says how it ended",
        },
        **NO_JOB,
    },
)
async def follow_job(
    request: Request, number: Number, admission: AdmissionOf, base: BaseOf, api_key: WhoOf
) -> Response:
    """Return the changes of a job's state and progress as server-sent events."""
    await asyncio.to_thread(find_job, admission, number)
    keys: Keys = request.app.state.keys

    async def has_ended() -> bool:
        """True if the stream has to end: the service stops or the key is no longer in force."""
        if request.app.state.stopping.is_set():
            return True
        if api_key == NOBODY:
            return False
        if keys.is_due:
            await asyncio.to_thread(keys.refresh)
        key = keys.of_hash(api_key.hash)
        return key is None or not key.in_force(time.time())

    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    if request.method == "HEAD":
        return without_length("text/event-stream", headers)
    events = _events(admission, number, api_key, base, has_ended)
    return StreamingResponse(events, media_type="text/event-stream", headers=headers)


async def _events(
    admission: Admission,
    number: str,
    api_key: Key,
    base: str,
    has_ended: Callable[[], Awaitable[bool]],
) -> AsyncIterator[bytes]:
    """Yield a server-sent event whenever a job's state or progress changes, until it ends.

    Parameters
    ----------
    admission : Admission
        Reads the job.
    number : str
        The job's identifier.
    api_key : Key
        The API key of the reader; the stream ends when it may no longer read the job.
    base : str
        Address of the service, for links.
    has_ended : callable
        Awaited before each look; True ends the stream.
    """
    sent, sent_at = None, time.monotonic()
    while not await has_ended():
        job = await asyncio.to_thread(admission.job, number, api_key)
        if job is None:
            return
        if (job.state, job.done) != sent:
            sent, sent_at = (job.state, job.done), time.monotonic()
            status = orjson.dumps(status_info(job, base, waiting_reason=admission.waiting_reason()))
            yield b"event: status\ndata: " + status + b"\n\n"
            if job.state not in ACTIVE:
                return
        elif time.monotonic() - sent_at > SIGN_OF_LIFE:
            sent_at = time.monotonic()
            yield b": alive\n\n"
        await asyncio.sleep(POLL)
