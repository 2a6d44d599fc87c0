"""Results of jobs after OGC API - Processes: where they are, and their files."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import fastapi
from anyio import to_thread
from fastapi import Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import Response

from vibrafeed.app.jobs.admission import Admission
from vibrafeed.app.jobs.errors import NotFoundError
from vibrafeed.app.jobs.manifest import JSON, NETCDF, ZARR
from vibrafeed.app.web.accept import form_for
from vibrafeed.app.web.dependencies import AdmissionOf, BaseOf, Number, SettingsOf
from vibrafeed.app.web.documents import NETCDF_TYPE, Results, media_type_of
from vibrafeed.app.web.downloads import ASK_AGAIN, etag_of, file_reply, not_modified
from vibrafeed.app.web.outcomes import (
    check_file,
    find_job,
    manifest_of,
    results_reply,
)
from vibrafeed.app.web.replies import (
    BINARY,
    OBJECT,
    Router,
    cached_replies,
    problems,
    without_length,
)
from vibrafeed.app.web.routes.zarr import ZarrKey
from vibrafeed.app.web.tables import (
    TABLES,
    ResultForm,
    available_tables,
    missing_packages,
    most_rows,
    table_reply,
    writer_version,
)
from vibrafeed.core.dataset.frame import Frame
from vibrafeed.core.dataset.read import read_netcdf

router = Router(prefix="/jobs", tags=["jobs"])

# What a group may have: nothing else of a request reaches the disk.
_KEY = re.compile(r"(zarr\.json|[a-z][a-z0-9_]{0,79}/(zarr\.json|c(/[0-9]{1,12}){0,20}))")

FORMS = {"netcdf": NETCDF_TYPE, "json": "application/json"}
NO_RESULT = problems(
    s404="No such job, or its results are not there",
    s409="The study belongs to another version of vibrafeed: post it again",
    s422="The identifier is malformed, or the job failed at a limit",
    s500="The job failed by a fault of the service, not of the study: report it",
    s507="The job failed: its result could not be stored",
)


@router.get(
    "/{number}/results",
    summary="Show links to the results of a job",
    response_model=Results,
    responses=NO_RESULT,
)
def get_results(number: Number, admission: AdmissionOf, base: BaseOf) -> Response:
    """Return the address, the size and the computing time of the dataset."""
    return results_reply(admission, find_job(admission, number), base)


@router.get(
    "/{number}/results/dataset",
    summary="Download the dataset of a job",
    response_class=Response,
    responses={
        **cached_replies(
            "The dataset",
            {
                NETCDF_TYPE: BINARY,
                "application/json": OBJECT,
                **dict.fromkeys(TABLES.values(), BINARY),
            },
            in_ranges=True,
        ),
        **NO_RESULT,
        **problems(s406="No format that Accept allows"),
    },
)
async def get_dataset(
    request: Request,
    number: Number,
    admission: AdmissionOf,
    settings: SettingsOf,
    form: Annotated[
        ResultForm | None,
        Query(
            alias="format",
            description="Format of the dataset; by default the one that `Accept` names, else "
            "NetCDF. Only small results are available as JSON.",
        ),
    ] = None,
) -> Response:
    """Return the dataset as a NetCDF file, as JSON, or as a table with one row a cell.

    Ranges of NetCDF and JSON can be asked for.
    """
    chosen = form or form_for(request, FORMS | available_tables(), missing=missing_packages())
    stored = await run_in_threadpool(_stored_dataset, request, admission, number, chosen)
    if isinstance(stored, Response):
        reply = stored
    else:
        path, etag = stored
        limiter = request.app.state.large_slices
        rows = most_rows(settings, chosen, settings.max_table_rows)
        frame = await to_thread.run_sync(
            lambda: Frame.of(read_netcdf(path, most_rows=rows), most=rows), limiter=limiter
        )
        reply = table_reply(frame, chosen, limiter=limiter)
        name = f"{path.parent.name[:12]}.{chosen}"
        reply.headers["Content-Disposition"] = f'attachment; filename="vibrafeed-{name}"'
        reply.headers.update({"ETag": etag, "Cache-Control": ASK_AGAIN})
    reply.headers["Vary"] = "Accept"
    return reply


def _stored_dataset(
    request: Request, admission: Admission, number: str, form: str
) -> Response | tuple[Path, str]:
    """Return the reply with a stored table, or the NetCDF file and ETag from which it is written.

    `number` is the job's identifier; `form` is netcdf, json, or a table format such as csv, which
    has to be written from the NetCDF file. Raises `NotFoundError` if the result has no such form.
    """
    job = find_job(admission, number)
    manifest = manifest_of(admission, job)
    if ZARR in manifest.files:
        raise NotFoundError(
            "The result is a Zarr group, not a file: open the address of the group in "
            "a Zarr client. GET /jobs/ID/results names it."
        )
    name = JSON if form == "json" else NETCDF
    if name not in manifest.files:
        raise NotFoundError("The result is too large for JSON: download it as NetCDF.")
    digest = manifest.files[name]["sha256"]
    path = admission.store.folder(job.key) / name
    check_file(admission, job, path, digest)
    if form in TABLES:
        etag = etag_of(digest, writer_version(form))
        reply = not_modified(request, etag, ASK_AGAIN)
        if reply is None and request.method == "HEAD":
            reply = without_length(TABLES[form], {"ETag": etag, "Cache-Control": ASK_AGAIN})
        return reply or (path, etag)
    return file_reply(
        request,
        path,
        digest=digest,
        media_type=FORMS[form],
        filename=f"vibrafeed-{job.key[:12]}{'.nc' if form == 'netcdf' else '.json'}",
    )


@router.get(
    "/{number}/results/zarr/{path:path}",
    summary="Read a large result as a Zarr group, even while the job computes it",
    response_class=Response,
    responses={
        **cached_replies(
            "A document, or a chunk",
            {"application/octet-stream": BINARY, "application/json": OBJECT},
            in_ranges=True,
        ),
        **NO_RESULT,
    },
)
def get_group(request: Request, number: Number, path: ZarrKey, admission: AdmissionOf) -> Response:
    """Return a key of the Zarr v3 group of a sweep too large for one file.

    Clients open the address without the Zarr key, as in `xarray.open_zarr(".../results/zarr")`. It
    can be read as soon as the job runs: a chunk that is not there yet is 404, which clients read as
    NaN, or as regime 0.
    """
    job = find_job(admission, number)
    manifest = None if job.state == "running" else manifest_of(admission, job)
    if not _KEY.fullmatch(path):
        raise NotFoundError(
            f"'{path[:80]}' is not a key of a Zarr group. Open the address that ends "
            "in /zarr with a Zarr client."
        )
    file = admission.store.in_group(job.key, path)
    digest = None if manifest is None else admission.store.digest(job.key, path, manifest)
    if digest is not None:
        check_file(admission, job, file, digest)
    elif not file.is_file():
        raise NotFoundError(
            f"The Zarr group of this job has no key '{path[:80]}', or its values are "
            "not computed yet. The file zarr.json names the arrays."
        )
    is_document = path.endswith(".json")
    return file_reply(
        request,
        file,
        # A chunk appears whole and never changes; the group's document does when it is complete.
        etag=etag_of(job.key, path, file.name),
        digest=digest,
        media_type="application/json" if is_document else "application/octet-stream",
        filename=path.rpartition("/")[2],
    )


@router.get(
    "/{number}/results/files/{name}",
    summary="Download a page or picture of an accuracy report",
    response_class=Response,
    responses={
        **cached_replies(
            "The file", {"text/markdown": {"type": "string"}, "image/png": BINARY}, in_ranges=True
        ),
        **NO_RESULT,
    },
)
def get_file(
    request: Request,
    number: Number,
    name: Annotated[
        str, fastapi.Path(description="Name of the file, as listed in the results.", max_length=100)
    ],
    admission: AdmissionOf,
) -> Response:
    """Return a page or a picture of an accuracy report, as named in the results of its job."""
    job = find_job(admission, number)
    manifest = manifest_of(admission, job)
    # Only names that the manifest holds reach the disk.
    if name not in manifest.files or name == ZARR:
        raise NotFoundError(
            f"The job has no file '{name[:80]}'. GET /jobs/ID/results lists its files."
        )
    file, digest = admission.store.folder(job.key) / name, manifest.files[name]["sha256"]
    check_file(admission, job, file, digest)
    return file_reply(
        request,
        file,
        digest=digest,
        media_type=media_type_of(name),
        filename=name,
    )
