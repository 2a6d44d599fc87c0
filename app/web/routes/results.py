"""Results of jobs after OGC API - Processes: where they are, and their files."""

from __future__ import annotations

import re
from typing import Annotated, Literal

from fastapi import APIRouter, Path, Query, Request
from fastapi.responses import Response

from app.jobs.errors import NotFoundError
from app.jobs.manifest import JSON, NETCDF, ZARR
from app.web.dependencies import BaseOf, DeskOf, Number
from app.web.documents import NETCDF_TYPE, Results, media_type_of
from app.web.downloads import etag_of, file_reply
from app.web.outcomes import check_of, find_job, lost, manifest_of, results_reply
from app.web.replies import problems
from app.web.routes.zarr import ZarrKey

router = APIRouter(prefix="/jobs", tags=["jobs"])

# What a group may have: nothing else of a request reaches the disk.
_KEY = re.compile(r"(zarr\.json|[a-z][a-z0-9_]{0,79}/(zarr\.json|c(/[0-9]{1,12}){0,20}))")

NO_RESULT = problems(
    s404="No such job, or its results are not there",
    s409="The study is another version's: post it again",
    s422="The identifier is malformed, or the job failed at a limit",
    s500="The job failed: the service's own mistake",
    s507="The job failed: its result could not be stored",
)


@router.get(
    "/{number}/results", summary="Tell what a job gave", response_model=Results, responses=NO_RESULT
)
def get_results(number: Number, desk: DeskOf, base: BaseOf) -> Response:
    """Return where the dataset is, how large it is, and what it cost."""
    return results_reply(desk, find_job(desk, number), base)


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
    job = find_job(desk, number)
    manifest = manifest_of(desk, job)
    if isinstance(manifest, Response):
        return manifest
    name = NETCDF if form == "netcdf" else JSON
    if ZARR in manifest.files:
        raise NotFoundError("The result is a Zarr group: open the address that its results name.")
    if name not in manifest.files:
        raise NotFoundError("The result is too large for JSON: download it as NetCDF.")
    file = desk.store.folder(job.key) / name
    return file_reply(
        request,
        file,
        digest=manifest.files[name]["sha256"],
        check=check_of(desk, job, file),
        media_type=NETCDF_TYPE if form == "netcdf" else "application/json",
        filename=f"vibrafeed-{job.key[:12]}{'.nc' if form == 'netcdf' else '.json'}",
    )


@router.get(
    "/{number}/results/zarr/{path:path}",
    summary="Read a large result as a Zarr group, also while it grows",
    response_class=Response,
    responses={
        200: {
            "content": {
                "application/octet-stream": {"schema": {"type": "string", "format": "binary"}},
                "application/json": {"schema": {"type": "object"}},
            },
            "description": "A document, or a shard",
            "headers": {"ETag": {"schema": {"type": "string"}}},
        },
        206: {
            "content": {
                "application/octet-stream": {"schema": {"type": "string", "format": "binary"}}
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
@router.head("/{number}/results/zarr/{path:path}", include_in_schema=False)
def get_group(request: Request, number: Number, path: ZarrKey, desk: DeskOf) -> Response:
    """Return a key of the Zarr v3 group of a sweep too large for one file.

    Clients open the address without the key, as in `xarray.open_zarr(".../results/zarr")`. It can
    be read as soon as the job runs: a shard that is not there yet is 404, which clients read as
    NaN, or as regime 0.
    """
    job = find_job(desk, number)
    manifest = None if job.state == "running" else manifest_of(desk, job)
    if isinstance(manifest, Response):
        return manifest
    if not _KEY.fullmatch(path):
        raise NotFoundError(f"A Zarr group has no key '{path[:80]}'.")
    file = desk.store.in_group(job.key, path)
    digest = None if manifest is None else desk.store.digest(job.key, path, manifest)
    if not file.is_file():
        if digest is not None:
            raise lost(desk, job, file)
        raise NotFoundError(f"The group of this job has no key '{path[:80]}', or not yet.")
    is_document = path.endswith(".json")
    return file_reply(
        request,
        file,
        # A shard appears whole and never changes; the group's document does when it is complete.
        etag=etag_of(job.key, path, file.name),
        digest=digest,
        check=check_of(desk, job, file),
        media_type="application/json" if is_document else "application/octet-stream",
        filename=path.rpartition("/")[2],
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
    job = find_job(desk, number)
    manifest = manifest_of(desk, job)
    if isinstance(manifest, Response):
        return manifest
    # Only names that the manifest holds reach the disk.
    if name not in manifest.files or name == ZARR:
        raise NotFoundError(f"The job has no file '{name[:80]}'; its results name those it has.")
    file = desk.store.folder(job.key) / name
    return file_reply(
        request,
        file,
        digest=manifest.files[name]["sha256"],
        check=check_of(desk, job, file),
        media_type=media_type_of(name),
        filename=name,
    )
