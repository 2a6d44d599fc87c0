"""Processes after OGC API - Processes: what there is, and the carrying out of studies."""

from __future__ import annotations

import asyncio
import contextlib
import sqlite3
import time
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Annotated

import orjson
from fastapi import Path, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import Response
from starlette.requests import ClientDisconnect

from vibrafeed.app.jobs.admission import Admission
from vibrafeed.app.jobs.keys import Key
from vibrafeed.app.jobs.ledger import ACTIVE, Job
from vibrafeed.app.jobs.work import Task
from vibrafeed.app.settings import Settings
from vibrafeed.app.web.accept import preferred
from vibrafeed.app.web.calculations import execute_at_once, read_task
from vibrafeed.app.web.dependencies import AdmissionOf, BaseOf, Body, SettingsOf, WhoOf
from vibrafeed.app.web.documents import (
    CONFORMANCE,
    StatusInfo,
    description,
    process_list,
    status_info,
)
from vibrafeed.app.web.execution import ACCURACY, PROCESSES, AnyStudy, ExecuteRequest
from vibrafeed.app.web.openapi import StudySchema
from vibrafeed.app.web.outcomes import results_reply
from vibrafeed.app.web.prefer import Preferences, preferences
from vibrafeed.app.web.problems import NoSuchProcessError
from vibrafeed.app.web.replies import Document, Router, component, json_reply, problems
from vibrafeed.app.web.routes import page
from vibrafeed.app.web.shares import POST, calculate_in_process, slot_of, threads_of
from vibrafeed.core.errors import StoppedError

router = Router(tags=["processes"])

REL = "http://www.opengis.net/def/rel/ogc/1.0/"
JSON = "application/json"
OPENAPI = "application/vnd.oai.openapi+json;version=3.1"
# s between looks at a job that a client waits for: short jobs are soon told, long ones cost little
POLL, LONGEST_POLL = 0.05, 0.5
_NAME = Path(description="Identifier of a process.", max_length=100)


@router.get("/", summary="Landing page", response_model=Document)
def landing_page(request: Request, base: BaseOf) -> Response:
    """Return links to what the service offers; to a browser, the page."""
    accept = ",".join(request.headers.getlist("accept"))
    if preferred(accept, (JSON, "text/html")) == "text/html":
        return page.index()
    links = [
        ("/", "self", "This document", JSON),
        ("/openapi.json", "service-desc", "The OpenAPI document", OPENAPI),
        ("/docs", "service-doc", "Its pages", "text/html"),
        ("/conformance", f"{REL}conformance", "Conformance", JSON),
        ("/processes", f"{REL}processes", "The processes", JSON),
        ("/jobs", f"{REL}job-list", "The jobs", JSON),
        ("/scenes", "related", "The scenes", JSON),
    ]
    return json_reply(
        {
            "title": "vibrafeed",
            "description": "Sweeps, motion in time and best drives of parts on feeder tracks.",
            "links": [
                {"href": f"{base}{path}", "rel": rel, "title": title, "type": type_}
                for path, rel, title, type_ in links
            ],
        }
    )


@router.get("/conformance", summary="Conformance classes", response_model=Document)
def conformance() -> Response:
    """Return the classes of OGC API - Processes that the service conforms to."""
    return json_reply({"conformsTo": CONFORMANCE})


@router.get("/processes", summary="List the processes", response_model=Document)
def list_processes(base: BaseOf) -> Response:
    """Return the processes: one for each kind of study."""
    return json_reply(process_list(base))


@router.get(
    "/processes/{process}",
    summary="Describe a process",
    response_model=Document,
    responses=problems(s404="No such process", s422="The identifier is malformed"),
)
def describe_process(process: Annotated[str, _NAME], base: BaseOf) -> Response:
    """Return a process with the schemas of what it takes and gives."""
    if process not in PROCESSES:
        raise _no_such_process(process)
    return json_reply(description(process, PROCESSES[process], base, _schema_of(process)))


@cache
def _schema_of(process: str) -> bytes:
    schema = PROCESSES[process].study.model_json_schema(schema_generator=StudySchema)
    return orjson.dumps(schema)


_PREFER = {
    "name": "Prefer",
    "in": "header",
    "required": False,
    "schema": {"type": "string"},
    "description": "`respond-async` for a job in any case; `wait=10` to wait up to 10 seconds "
    "for a job to end.",
}
_STUDY = {
    "required": True,
    "content": {
        JSON: {
            "schema": {"anyOf": [component(AnyStudy.__name__), component(ExecuteRequest.__name__)]},
            "examples": {
                name: {"summary": process.title, "value": process.example}
                for name, process in PROCESSES.items()
            },
        }
    },
}


@router.post(
    "/processes/{process}/execution",
    summary="Execute a process",
    response_model=Document,
    responses={
        201: {
            "model": StatusInfo,
            "description": "A job was created",
            "headers": {"Location": {"schema": {"type": "string"}}},
        },
        **problems(
            s404="No such process",
            s413="The body is too large",
            s415="The body has a content coding",
            s422="The study cannot be carried out, or is too large",
            s429="The queue of jobs is full, or the key has as many jobs or requests as it may; "
            "Retry-After says when to try again",
            s500="The job that was waited for failed",
            s507="There is no room for the result",
        ),
    },
    openapi_extra={"requestBody": _STUDY, "parameters": [_PREFER]},
)
async def execute(
    request: Request,
    process: Annotated[str, _NAME],
    body: Body,
    settings: SettingsOf,
    admission: AdmissionOf,
    api_key: WhoOf,
    base: BaseOf,
) -> Response:
    """Carry out a study, or an execute request with the study under `inputs.study`.

    A short study is answered with its dataset. A long study, and each study of `accuracy`, becomes
    a job: the reply is 201 with the status of the job and its `Location`, or 200 with the results
    if `Prefer: wait` was long enough.
    """
    if process not in PROCESSES:
        raise _no_such_process(process)
    wishes = preferences(request.headers.getlist("prefer"))
    job = await _reply_or_job(
        request, process, body, settings, admission, api_key, respond_async=wishes.respond_async
    )
    if isinstance(job, Response):
        return job
    if wishes.wait is not None:
        seconds = min(wishes.wait, int(settings.max_wait_seconds))
        wishes = replace(wishes, wait=seconds)  # as it is applied
        job = await _wait_for_job(request, admission, job, seconds)
        if job.state in ACTIVE and not wishes.respond_async:
            await _dismiss_if_left(request, admission, job, api_key)
    if job.state in ACTIVE or wishes.wait is None:
        reply = json_reply(status_info(job, base), 201)
    else:
        reply = await asyncio.to_thread(results_reply, admission, job, base)
    reply.headers["Location"] = f"{base}/jobs/{job.id}"
    applied = _applied_preferences(wishes)
    if applied:
        reply.headers["Preference-Applied"] = applied
    return reply


async def _reply_or_job(
    request: Request,
    name: str,
    body: bytes,
    settings: Settings,
    admission: Admission,
    api_key: Key,
    *,
    respond_async: bool,
) -> Response | Job:
    """Return the reply with the dataset of a short study, or the job that the study has become.

    The request waits for a computing slot of its owner before its study is read.

    Parameters
    ----------
    request, name, body : Request, str, bytes
        The request, the process, such as `sweep`, and the study or execute request as JSON.
    settings, admission : Settings, Admission
        The service's.
    api_key : Key
        The API key of the request.
    respond_async : bool
        True if the client asks for a job in any case.

    Raises
    ------
    ClientDisconnect
        If the client has left and has not asked for a job; a job that was posted is dismissed.
    """
    reply_or_task: bytes | Task
    if name == ACCURACY or respond_async:
        async with slot_of(request, len(body), POST):
            reply_or_task = await _read_in_process(request, name, body, settings, api_key)
    else:
        async with slot_of(request, len(body)):
            reply_or_task = await _dataset_in_time(request, name, body, settings, api_key)
    if isinstance(reply_or_task, bytes):
        return Response(reply_or_task, media_type=JSON)
    job = await run_in_threadpool(admission.post, reply_or_task, api_key)
    if not respond_async:
        await _dismiss_if_left(request, admission, job, api_key)
    return job


async def _dismiss_if_left(request: Request, admission: Admission, job: Job, api_key: Key) -> None:
    """Dismiss a job and raise `ClientDisconnect` if its client has left: nobody knows of it."""
    if await request.is_disconnected():
        await run_in_threadpool(admission.dismiss, job.id, api_key)
        raise ClientDisconnect


async def _dataset_in_time(
    request: Request, name: str, body: bytes, settings: Settings, api_key: Key
) -> bytes | Task:
    """Compute a study for the reply to its request, or read its task if that takes too long.

    It is computed in a process that is ended after `max_execution_seconds` and some grace.

    Parameters
    ----------
    request : Request
        The request; nothing is computed further for a client that has left.
    name : str
        The process of the service, such as `sweep`.
    body : bytes
        The execute request as JSON.
    settings : Settings
        Limits and times of the service.
    api_key : Key
        The API key, whose limit of cells holds.

    Returns
    -------
    bytes or Task
        The result as a JSON document; else the task of computing it.

    Raises
    ------
    StudyError, LimitError
        If the study is invalid or too large.
    """
    seconds = settings.max_execution_seconds + settings.grace_seconds
    try:
        return await calculate_in_process(
            request, execute_at_once, name, body, settings, api_key.cells, threads_of(request),
            seconds=seconds,
        )  # fmt: skip
    except StoppedError:  # its process was ended, perhaps before the study was read
        return await _read_in_process(request, name, body, settings, api_key)


async def _read_in_process(
    request: Request, name: str, body: bytes, settings: Settings, api_key: Key
) -> Task:
    # On a busy machine the process may begin late.
    seconds = settings.max_execution_seconds + settings.grace_seconds
    return await calculate_in_process(
        request, read_task, name, body, settings, api_key.cells, seconds=seconds
    )


async def _wait_for_job(request: Request, admission: Admission, job: Job, seconds: float) -> Job:
    """Wait until a job ends, and return it with the state that it has then.

    The ledger of jobs is read at growing intervals; if it cannot be read, the last known state
    counts.

    Parameters
    ----------
    request : Request
        The request; the wait ends when its client leaves, or the service stops.
    admission : Admission
        The object that holds the ledger.
    job : Job
        The job.
    seconds : float
        Time after which the wait ends in any case [s].
    """
    stopping: Callable[[], bool] = request.app.state.stopping.is_set
    deadline, pause = time.monotonic() + seconds, POLL
    while job.state in ACTIVE and time.monotonic() < deadline and not stopping():
        if await request.is_disconnected():
            break
        await asyncio.sleep(min(pause, max(0.0, deadline - time.monotonic())))
        pause = min(1.5 * pause, LONGEST_POLL)
        # The client is to learn of its job, though the ledger cannot be read.
        with contextlib.suppress(OSError, sqlite3.OperationalError):
            latest = await asyncio.to_thread(admission.ledger.job, job.id)
            job = latest or job
    return job


def _applied_preferences(wishes: Preferences) -> str:
    """Return the text of the Preference-Applied header: which wishes of Prefer were honoured.

    `wishes` has the time of waiting as it was applied; the text is empty without wishes.
    """
    words = ["respond-async"] if wishes.respond_async else []
    if wishes.wait is not None:
        words.append(f"wait={wishes.wait}")
    return ", ".join(words)


def _no_such_process(process: str) -> NoSuchProcessError:
    known = ", ".join(PROCESSES)
    return NoSuchProcessError(f"There is no process '{process[:80]}'. The processes are {known}.")
