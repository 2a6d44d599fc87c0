"""Jobs after OGC API - Processes: status, list, events, results, dismissal."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator, Callable
from datetime import datetime
from typing import Annotated, Literal
from urllib.parse import urlencode

import orjson
from fastapi import APIRouter, Path, Query, Request
from fastapi.responses import Response, StreamingResponse
from pydantic import AfterValidator

from app.jobs.desk import Desk
from app.jobs.errors import NotFoundError
from app.jobs.ledger import ACTIVE, STATES, Job, Wanted
from app.jobs.store import JSON, NETCDF, Manifest
from app.web.dependencies import BaseOf, DeskOf, once
from app.web.documents import (
    NETCDF_TYPE,
    JobList,
    Results,
    StatusInfo,
    media_type_of,
    results,
    status_info,
)
from app.web.downloads import file_reply
from app.web.problems import NoSuchJobError, NotReadyError
from app.web.replies import json_reply, problem_document, problems

router = APIRouter(prefix="/jobs", tags=["jobs"])

Number = Annotated[str, Path(description="Identifier of a job.", max_length=100)]
State = Literal["accepted", "running", "successful", "failed", "dismissed"]
assert set(STATES) == set(State.__args__)  # type: ignore[attr-defined]

LOOK = 0.25  # s between looks at a job whose events are followed
SIGN_OF_LIFE = 15.0  # s after which an idle stream says that it is alive
MOST_LISTED = 1000
NO_JOB = problems(s404="No such job", s422="The identifier is malformed")
NO_RESULT = problems(
    s404="No such job, or its results are not there",
    s409="The study is another version's: post it again",
    s422="The identifier is malformed, or the job failed at a limit",
    s500="The job failed: the service's own mistake",
    s507="The job failed: its result could not be stored",
)


def interval(text: str | None) -> tuple[float | None, float | None]:
    """Return start and end [s since the epoch] of a time or an interval; None for an open one.

    Raises
    ------
    ValueError
        If it is neither.
    """
    if text is None:
        return None, None
    words = text.split("/")
    if len(words) > 2 or set(words) <= {"", ".."}:
        raise ValueError("it is neither a time nor an interval START/END")
    ends: list[float | None] = []
    for word in words:
        time_ = None if word in ("", "..") else datetime.fromisoformat(word)
        if time_ is not None and time_.tzinfo is None:
            raise ValueError(f"{word[:40]!r} has no time zone, as in 2026-01-01T00:00:00Z")
        ends.append(None if time_ is None else time_.timestamp())
    return ends[0], ends[-1]


def checked(text: str | None) -> str | None:
    """Return a time or an interval as it is; raise `ValueError` if it is neither."""
    interval(text)
    return text


@router.get("", summary="List jobs", response_model=JobList, responses=problems(s422="Bad query"),
            dependencies=[once("processID", "status", "type")])  # fmt: skip
def list_jobs(
    desk: DeskOf,
    base: BaseOf,
    process: Annotated[
        list[str], Query(alias="processID", max_length=20, description="Of these processes only.")
    ] = [],  # noqa: B006 - not changed; None would make the schema nullable
    status: Annotated[list[State], Query(max_length=20, description="In these states only.")] = [],  # noqa: B006
    kind: Annotated[
        list[str], Query(alias="type", max_length=20, description="All jobs are of type process.")
    ] = [],  # noqa: B006
    created: Annotated[
        str | None,
        Query(
            alias="datetime",
            max_length=100,
            description="Made at a time (RFC 3339), or between two, as in "
            "`2026-01-01T00:00:00Z/..`.",
        ),
        AfterValidator(checked),
    ] = None,
    least: Annotated[
        int | None,
        Query(alias="minDuration", ge=0, le=10**9, description="Ran so many seconds or longer."),
    ] = None,
    longest: Annotated[
        int | None,
        Query(alias="maxDuration", ge=0, le=10**9, description="Ran so many seconds or shorter."),
    ] = None,
    limit: Annotated[int, Query(ge=1, le=MOST_LISTED)] = 100,
    offset: Annotated[int, Query(ge=0, le=10**9)] = 0,
) -> Response:
    """Return jobs, the latest first."""
    wanted = Wanted(tuple(process), tuple(status), interval(created), (least, longest))
    found = []
    if not kind or "process" in kind:
        found = desk.ledger.jobs(wanted, limit=limit + 1, offset=offset)
    wishes = {
        "processID": process, "status": status, "type": kind, "datetime": created,
        "minDuration": least, "maxDuration": longest, "limit": limit,
    }  # fmt: skip
    pages = {"self": offset}
    if len(found) > limit:
        pages["next"] = offset + limit
    if offset:
        pages["prev"] = max(0, offset - limit)
    links = []
    for rel, start in pages.items():
        asked = {k: v for k, v in {**wishes, "offset": start}.items() if v is not None}
        href = f"{base}/jobs?{urlencode(asked, doseq=True)}"
        links.append({"href": href, "rel": rel, "type": "application/json"})
    return json_reply({"jobs": [status_info(job, base) for job in found[:limit]], "links": links})


@router.get("/{number}", summary="Tell how a job stands", response_model=StatusInfo,
            responses=NO_JOB)  # fmt: skip
def get_job(number: Number, desk: DeskOf, base: BaseOf) -> Response:
    """Return the state of a job, its progress, and the time that is left."""
    return json_reply(status_info(_job(desk, number), base))


@router.delete("/{number}", summary="Dismiss a job", response_model=StatusInfo, responses=NO_JOB)
def dismiss_job(number: Number, desk: DeskOf, base: BaseOf) -> Response:
    """Dismiss a job; what is computed for it alone is stopped at the next block."""
    job = desk.dismiss(number)
    if job is None:
        raise _missing(number)
    return json_reply(status_info(job, base))


@router.get(
    "/{number}/events",
    summary="Follow a job",
    response_class=Response,
    responses={
        200: {
            "content": {"text/event-stream": {"schema": {}}},
            "description": "An event `status` at each change, with the job's status as data; the "
            "last one tells how it ended",
        },
        **NO_JOB,
    },
)
async def follow_job(request: Request, number: Number, desk: DeskOf, base: BaseOf) -> Response:
    """Return the changes of a job's state and progress as server-sent events."""
    await asyncio.to_thread(_job, desk, number)
    events = _events(desk, number, base, request.app.state.stopping.is_set)
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    return StreamingResponse(events, media_type="text/event-stream", headers=headers)


@router.get(
    "/{number}/results", summary="Tell what a job gave", response_model=Results, responses=NO_RESULT
)
def get_results(number: Number, desk: DeskOf, base: BaseOf) -> Response:
    """Return where the dataset is, how large it is, and what it cost."""
    return results_reply(desk, _job(desk, number), base)


@router.get(
    "/{number}/results/dataset",
    summary="Download what a job gave",
    response_class=Response,
    responses={
        200: {
            "content": {
                NETCDF_TYPE: {"schema": {"type": "string", "format": "binary"}},
                "application/json": {"schema": {"type": "object"}},
            },
            "description": "The dataset",
            "headers": {"ETag": {"schema": {"type": "string"}}},
        },
        206: {
            "content": {NETCDF_TYPE: {"schema": {"type": "string", "format": "binary"}}},
            "description": "The range of it that was asked for",
            "headers": {"Content-Range": {"schema": {"type": "string"}}},
        },
        304: {"description": "The client has it: its ETag stands in If-None-Match"},
        **NO_RESULT,
        **problems(
            s412="It is not the file that If-Match names",
            s416="The range holds no byte of the file",
        ),
    },
)
@router.head("/{number}/results/dataset", include_in_schema=False)
def get_dataset(
    request: Request,
    number: Number,
    desk: DeskOf,
    form: Annotated[
        Literal["netcdf", "json"],
        Query(alias="format", description="JSON for small results only."),
    ] = "netcdf",
) -> Response:
    """Return the dataset as a NetCDF file, or as JSON; ranges can be asked for."""
    job = _job(desk, number)
    manifest = _manifest(desk, job)
    if isinstance(manifest, Response):
        return manifest
    name = NETCDF if form == "netcdf" else JSON
    if name not in manifest.files:
        raise NotFoundError("The result is too large for JSON: download it as NetCDF.")
    return file_reply(
        request,
        desk.store.folder(job.key) / name,
        digest=manifest.files[name]["sha256"],
        media_type=NETCDF_TYPE if form == "netcdf" else "application/json",
        filename=f"vibrafeed-{job.key[:12]}{'.nc' if form == 'netcdf' else '.json'}",
    )


@router.get(
    "/{number}/results/files/{name}",
    summary="Download a further file of a job",
    response_class=Response,
    responses={
        200: {
            "content": {
                "text/markdown": {"schema": {"type": "string"}},
                "image/png": {"schema": {"type": "string", "format": "binary"}},
            },
            "description": "The file",
            "headers": {"ETag": {"schema": {"type": "string"}}},
        },
        206: {
            "content": {
                "text/markdown": {"schema": {"type": "string"}},
                "image/png": {"schema": {"type": "string", "format": "binary"}},
            },
            "description": "The range of it that was asked for",
            "headers": {"Content-Range": {"schema": {"type": "string"}}},
        },
        304: {"description": "The client has it: its ETag stands in If-None-Match"},
        **NO_RESULT,
        **problems(
            s412="It is not the file that If-Match names",
            s416="The range holds no byte of the file",
        ),
    },
)
def get_file(
    request: Request,
    number: Number,
    name: Annotated[str, Path(description="As the results name it.", max_length=100)],
    desk: DeskOf,
) -> Response:
    """Return a page or a picture that the results name."""
    job = _job(desk, number)
    manifest = _manifest(desk, job)
    if isinstance(manifest, Response):
        return manifest
    # Only names that the manifest holds reach the disk.
    if name not in manifest.files:
        raise NotFoundError(f"The job has no file '{name[:80]}'; its results name those it has.")
    return file_reply(
        request,
        desk.store.folder(job.key) / name,
        digest=manifest.files[name]["sha256"],
        media_type=media_type_of(name),
        filename=name,
    )


def results_reply(desk: Desk, job: Job, base: str) -> Response:
    """Return the results of a job, or why there are none."""
    manifest = _manifest(desk, job)
    if isinstance(manifest, Response):
        return manifest
    return json_reply(results(job, manifest, base))


def _manifest(desk: Desk, job: Job) -> Manifest | Response:
    """Return what is known of a job's result, or the problem document if it failed."""
    if job.problem is not None:
        return problem_document(**job.problem)
    if job.state in ACTIVE:
        raise NotReadyError(f"The job {job.id} is {job.state}; its results are not there yet.")
    manifest = None if job.state == "dismissed" else desk.store.manifest(job.key)
    if manifest is None:
        raise NotFoundError(f"The results of the job {job.id} have been removed.")
    return manifest


def _job(desk: Desk, number: str) -> Job:
    job = desk.ledger.job(number)
    if job is None:
        raise _missing(number)
    return job


def _missing(number: str) -> NoSuchJobError:
    return NoSuchJobError(f"There is no job '{number[:80]}'. GET /jobs lists them.")


async def _events(
    desk: Desk, number: str, base: str, stopping: Callable[[], bool]
) -> AsyncIterator[bytes]:
    told, at = None, time.monotonic()
    while not stopping():
        job = await asyncio.to_thread(desk.ledger.job, number)
        if job is None:
            return
        if (job.state, job.done) != told:
            told, at = (job.state, job.done), time.monotonic()
            yield b"event: status\ndata: " + orjson.dumps(status_info(job, base)) + b"\n\n"
            if job.state not in ACTIVE:
                return
        elif time.monotonic() - at > SIGN_OF_LIFE:
            at = time.monotonic()
            yield b": alive\n\n"
        await asyncio.sleep(LOOK)
