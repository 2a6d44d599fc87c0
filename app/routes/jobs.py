"""Jobs after OGC API - Processes: status, list, events, results, dismissal."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator
from typing import Annotated, Literal

import orjson
from fastapi import APIRouter, Path, Query, Request
from fastapi.responses import Response, StreamingResponse

from app.dependencies import DeskOf
from app.downloads import file_reply
from app.errors import problem_document
from app.exceptions import NoSuchJobError, NotFoundError, NotReadyError
from app.jobs.desk import Desk
from app.jobs.documents import NETCDF_TYPE, JobList, Results, StatusInfo, results, status_info
from app.jobs.ledger import ACTIVE, STATES, Job
from app.processes import PROCESSES
from app.routes import json_reply, problems
from app.store import JSON, NETCDF, Manifest

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
    s422="The identifier is malformed, or the job failed at a limit",
    s500="The job failed: the service's own mistake",
    s507="The job failed: its result could not be stored",
)


@router.get("", summary="List jobs", response_model=JobList, responses=problems(s422="Bad query"))
def list_jobs(
    desk: DeskOf,
    process: Annotated[
        str | None, Query(alias="processID", max_length=100, description="Of this process only.")
    ] = None,
    status: Annotated[State | None, Query(description="In this state only.")] = None,
    limit: Annotated[int, Query(ge=1, le=MOST_LISTED)] = 100,
    offset: Annotated[int, Query(ge=0, le=10**9)] = 0,
) -> Response:
    """Return jobs, the latest first."""
    found = desk.ledger.jobs(process=process, state=status, limit=limit + 1, offset=offset)
    links = [{"href": "/jobs", "rel": "self", "type": "application/json"}]
    if len(found) > limit:
        wishes = {"processID": process, "status": status, "limit": limit, "offset": offset + limit}
        query = "&".join(f"{k}={v}" for k, v in wishes.items() if v is not None and _plain(v))
        links.append({"href": f"/jobs?{query}", "rel": "next", "type": "application/json"})
    return json_reply({"jobs": [status_info(job) for job in found[:limit]], "links": links})


def _plain(value: str | int) -> bool:
    return isinstance(value, int) or value in PROCESSES or value in STATES


@router.get("/{number}", summary="Tell how a job stands", response_model=StatusInfo,
            responses=NO_JOB)  # fmt: skip
def get_job(number: Number, desk: DeskOf) -> Response:
    """Return the state of a job, its progress, and the time that is left."""
    return json_reply(status_info(_job(desk, number)))


@router.delete("/{number}", summary="Dismiss a job", response_model=StatusInfo, responses=NO_JOB)
def dismiss_job(number: Number, desk: DeskOf) -> Response:
    """Dismiss a job; what is computed for it alone is stopped at the next block."""
    job = desk.dismiss(number)
    if job is None:
        raise _missing(number)
    return json_reply(status_info(job))


@router.get(
    "/{number}/events",
    summary="Follow a job",
    response_class=Response,
    responses={
        200: {
            "content": {"text/event-stream": {}},
            "description": "An event `status` at each change, with the job's status as data; the "
            "last one tells how it ended",
        },
        **NO_JOB,
    },
)
async def follow_job(request: Request, number: Number, desk: DeskOf) -> Response:
    """Return the changes of a job's state and progress as server-sent events."""
    await asyncio.to_thread(_job, desk, number)
    events = _events(desk, number, request.app.state.stopping.is_set)
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    return StreamingResponse(events, media_type="text/event-stream", headers=headers)


@router.get(
    "/{number}/results", summary="Tell what a job gave", response_model=Results, responses=NO_RESULT
)
def get_results(number: Number, desk: DeskOf) -> Response:
    """Return where the dataset is, how large it is, and what it cost."""
    return results_reply(desk, _job(desk, number))


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


def results_reply(desk: Desk, job: Job) -> Response:
    """Return the results of a job, or why there are none."""
    manifest = _manifest(desk, job)
    if isinstance(manifest, Response):
        return manifest
    return json_reply(results(job, manifest, manifest.files[NETCDF]["bytes"]))


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


async def _events(desk: Desk, number: str, stopping: object) -> AsyncIterator[bytes]:
    assert callable(stopping)
    told, at = None, time.monotonic()
    while not stopping():
        job = await asyncio.to_thread(desk.ledger.job, number)
        if job is None:
            return
        if (job.state, job.done) != told:
            told, at = (job.state, job.done), time.monotonic()
            yield b"event: status\ndata: " + orjson.dumps(status_info(job)) + b"\n\n"
            if job.state not in ACTIVE:
                return
        elif time.monotonic() - at > SIGN_OF_LIFE:
            at = time.monotonic()
            yield b": alive\n\n"
        await asyncio.sleep(LOOK)
