"""Documents about processes and jobs, after OGC API - Processes, part 1.

Links are whole addresses, because clients of the standard fetch them as they stand; `base` is the
address of the service.
"""

from __future__ import annotations

import time
from datetime import UTC, datetime
from pathlib import PurePath
from typing import Any, Literal

import orjson
from pydantic import BaseModel, Field

from vibrafeed import core
from vibrafeed.app.jobs.ledger import ACTIVE, Job
from vibrafeed.app.jobs.manifest import JSON, NETCDF, ZARR, Manifest
from vibrafeed.app.web.execution import PROCESSES, Process

RESULTS = "http://www.opengis.net/def/rel/ogc/1.0/results"
EXECUTE = "http://www.opengis.net/def/rel/ogc/1.0/execute"
CONFORMANCE = tuple(
    f"http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/{name}"
    for name in ("core", "ogc-process-description", "json", "job-list", "dismiss")
)
NETCDF_TYPE = "application/x-netcdf"
ZARR_TYPE = "application/vnd.zarr; version=3"
MODES = ["sync-execute", "async-execute", "dismiss"]


class Link(BaseModel):
    """A link to another document."""

    href: str
    rel: str | None = None
    type: str | None = None
    title: str | None = None


class StatusInfo(BaseModel):
    """The status of a job."""

    processID: str  # noqa: N815
    type: Literal["process"]
    jobID: str  # noqa: N815
    status: Literal["accepted", "running", "successful", "failed", "dismissed"]
    message: str
    created: datetime
    started: datetime | None = None
    finished: datetime | None = None
    updated: datetime
    progress: int = Field(
        ge=0, le=100, description="Percentage of the blocks of the job that are computed so far."
    )
    cells: int = Field(description="Number of cells (grid points) of the study.")
    cellsDone: int = Field(description="Approximate number of cells of the study computed so far.")  # noqa: N815
    secondsLeft: float | None = Field(  # noqa: N815
        default=None,
        description="Expected remaining time of the job in seconds, from the speed since "
        "the server "
        "began; absent while unknown.",
    )
    elapsedSeconds: float = Field(  # noqa: N815
        description="Computing time of the job so far in seconds, summed over all workers."
    )
    study: str = Field(
        description="Identifier of the study; equal studies have the same identifier and "
        "share a result."
    )
    owner: str | None = Field(
        default=None,
        description="Name of the access key that posted the job; absent if the service needs "
        "no keys.",
    )
    shared: bool = Field(
        description="True if the holders of all access keys may read the job and its results."
    )
    links: list[Link]


class JobList(BaseModel):
    """Some jobs, the latest first."""

    jobs: list[StatusInfo]
    links: list[Link]


class ResultFile(Link):
    """A result by reference."""

    length: int = Field(
        description="Size in bytes of the result file, or of all files of a Zarr group."
    )
    elapsedSeconds: float = Field(description="Computing time in seconds.")  # noqa: N815
    cellsPerSecond: float  # noqa: N815
    version: str = Field(
        description="Version of vibrafeed that computed it, and a digest of the code, as in "
        "`0.2.0+1f2e3d4c`."
    )


class Results(BaseModel):
    """The results of a job."""

    dataset: ResultFile
    files: list[Link] | None = Field(
        default=None,
        description="Further files of the result: page and picture of a report on accuracy.",
    )


def summary(name: str, process: Process, base: str) -> dict[str, Any]:
    """Return the summary of a process for the list of processes, as OGC API - Processes defines it.

    `name` is the identifier of the process, such as `sweep`; `base` is the address of the service,
    for links.
    """
    return {
        "id": name,
        "version": core.__version__,
        "title": process.title,
        "description": process.description,
        "jobControlOptions": MODES,
        "outputTransmission": ["value", "reference"],
        "links": [
            _link(f"{base}/processes/{name}", "self", "The description of the process"),
            _link(f"{base}/processes/{name}/execution", EXECUTE, "URL to which studies are posted"),
        ],
    }


def process_list(base: str) -> dict[str, Any]:
    """Return the document that lists all processes, with links to the service at `base`."""
    return {
        "processes": [summary(name, process, base) for name, process in PROCESSES.items()],
        "links": [_link(f"{base}/processes", "self", "The processes")],
    }


def description(name: str, process: Process, base: str, schema: bytes) -> dict[str, Any]:
    """Return the description of a process, with the schemas of its inputs and outputs.

    `name` is the identifier of the process, `base` the address of the service, for links, and
    `schema` the JSON schema of its studies.
    """
    return {
        **summary(name, process, base),
        "inputs": {
            "study": {
                "title": "The study",
                "description": "A study, as in a file of the command line.",
                "schema": orjson.Fragment(schema),
            }
        },
        "outputs": {
            "dataset": {
                "title": "The dataset",
                "description": "By value JSON, by reference a CF-1.11 NetCDF-4 file.",
                "schema": {
                    "oneOf": [
                        {"type": "object", "contentMediaType": "application/json"},
                        {"type": "string", "format": "binary", "contentMediaType": NETCDF_TYPE},
                    ]
                },
            }
        },
    }


def status_info(
    job: Job, base: str, *, is_group: bool = False, waiting_reason: str | None = None
) -> dict[str, Any]:
    """Return the status document of a job, with its progress, the time left and links.

    Parameters
    ----------
    job : Job
        The job.
    base : str
        The service's address, for links.
    is_group : bool
        True if the result is a Zarr group that can be read already.
    waiting_reason : str or None
        The reason why unstarted work waits, other than its place in the queue.
    """
    fraction_done = job.done / job.blocks if job.blocks else 0.0
    # The last percent is the writing of the result.
    progress = 100 if job.state == "successful" else min(99, int(100 * fraction_done))
    seconds_left = None
    # Negative where the clock has been set: the next block that is noted puts it right.
    elapsed = -1.0 if job.began is None else time.time() - job.began
    done_since = job.done - job.done_then
    if elapsed >= 0 and done_since > 0:
        seconds_left = round(elapsed / done_since * (job.blocks - job.done), 1)
    url = f"{base}/jobs/{job.id}"
    links = [
        _link(url, "self", "This document"),
        _link(f"{url}/events", "monitor", "The status as a stream of events", "text/event-stream"),
    ]
    if job.state == "successful" and not job.gone:
        links.append(_link(f"{url}/results", RESULTS, "The results"))
    if is_group:
        links.append(_link(f"{url}/results/zarr", "item", "The results computed so far", ZARR_TYPE))
    if job.process == "sweep":
        links.append(
            _link(f"{base}/sweeps/{job.key}", "related", "The sweep, to be read in slices")
        )
    fields = {
        "processID": job.process,
        "type": "process",
        "jobID": job.id,
        "status": job.state,
        "message": _message(job, waiting_reason),
        "created": _time(job.created),
        "started": _time(job.started),
        "finished": _time(job.finished),
        "updated": _time(job.finished or time.time()),
        "progress": progress,
        "cells": job.cells,
        "cellsDone": job.cells if job.state == "successful" else int(job.cells * fraction_done),
        "secondsLeft": seconds_left,
        "elapsedSeconds": job.seconds,
        "study": job.key,
        "owner": job.owner or None,
        "shared": job.shared,
        "links": links,
    }
    return {name: value for name, value in fields.items() if value is not None}


def results(job: Job, manifest: Manifest, base: str) -> dict[str, Any]:
    """Return the document of a job's results: links to its files, and their cost.

    `manifest` lists the files; `base` is the address of the service, for links.
    """
    url = f"{base}/jobs/{job.id}/results"
    others = [name for name in manifest.files if name not in (NETCDF, ZARR, JSON)]
    is_group = ZARR in manifest.files
    title = "a Zarr v3 group, for a Zarr client to open" if is_group else "a CF-1.11 NetCDF-4 file"
    document: dict[str, Any] = {
        "dataset": {
            "href": f"{url}/{'zarr' if is_group else 'dataset'}",
            "type": ZARR_TYPE if is_group else NETCDF_TYPE,
            "title": f"The dataset as {title}",
            "length": manifest.files[ZARR if is_group else NETCDF]["bytes"],
            "elapsedSeconds": manifest.seconds,
            "cellsPerSecond": manifest.cells / max(manifest.seconds, 1e-9),
            "version": manifest.version,
        }
    }
    if others:
        document["files"] = [
            _link(f"{url}/files/{name}", "item", name, media_type_of(name)) for name in others
        ]
    return document


def media_type_of(name: str) -> str:
    """Return the media type of a result file, by its suffix."""
    return {".md": "text/markdown", ".png": "image/png", ".nc": NETCDF_TYPE}.get(
        PurePath(name).suffix, "application/octet-stream"
    )


def _message(job: Job, waiting_reason: str | None) -> str:
    """Return a sentence about the state of a job for its status document.

    `waiting_reason` is the reason why unstarted work waits, other than its place in the queue.
    """
    if job.gone:
        return "The result was removed to make room. Post the study again."
    if job.problem is not None:
        return f"{job.problem['title']}. {job.problem['detail']}"
    if job.state == "dismissed":
        done = f" with {job.done:,} of {job.blocks:,} blocks done" if job.done else ""
        return f"The job was dismissed{done}."
    if job.state not in ACTIVE:
        return "The results are ready." if job.state == "successful" else "The job failed."
    if job.state == "accepted":
        return (
            f"The job waits: {waiting_reason}." if waiting_reason else "The job waits for its turn."
        )
    return f"{job.done:,} of {job.blocks:,} blocks are done."


def _time(seconds: float | None) -> str | None:
    if seconds is None:
        return None
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="milliseconds")


def _link(href: str, rel: str, title: str, type_: str = "application/json") -> dict[str, str]:
    return {"href": href, "rel": rel, "type": type_, "title": title}
