"""Sweeps: posted as a study, kept by content, read as slices or as NetCDF."""

from __future__ import annotations

import asyncio
from contextlib import nullcontext
from typing import Annotated, Any

import numpy as np
from anyio import to_thread
from fastapi import Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import Response

from vibrafeed.app.jobs.admission import Admission
from vibrafeed.app.jobs.keys import Key
from vibrafeed.app.jobs.manifest import NETCDF
from vibrafeed.app.web.accept import form_for
from vibrafeed.app.web.calculations import (
    describe_sweep,
    encode_slice,
    encode_slice_of,
    read_sweep,
)
from vibrafeed.app.web.dependencies import (
    AdmissionOf,
    Body,
    SettingsOf,
    StoreOf,
    SweepKey,
    WhoOf,
    WriterOf,
    refuse_repeated,
)
from vibrafeed.app.web.documents import NETCDF_TYPE
from vibrafeed.app.web.downloads import ASK_AGAIN, FOR_EVER, etag_of, file_reply, not_modified
from vibrafeed.app.web.execution import PROCESSES
from vibrafeed.app.web.replies import (
    BINARY,
    Document,
    Router,
    cached_replies,
    component,
    json_reply,
    problems,
    without_length,
)
from vibrafeed.app.web.shares import (
    POST,
    calculate_in_process,
    client_check,
    hold_slot,
    large_slot_of,
    slot_of,
    threads_of,
)
from vibrafeed.app.web.sharing import NO_SHARING, NOT_OWNER, SHARING_BODY, read_sharing
from vibrafeed.app.web.sweep_document import SweepDescription
from vibrafeed.app.web.tables import (
    TABLES,
    SliceForm,
    available_tables,
    missing_packages,
    most_rows,
    table_reply,
    writer_version,
)
from vibrafeed.core.dataset.frame import Frame
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.study.sweep_and_simulate import SweepStudy
from vibrafeed.core.sweep.slice import SliceCut, compute_slice, prepare_cut, table_of

router = Router(prefix="/sweeps", tags=["sweeps"])

BINARY_TYPE = "application/octet-stream"
FORMS = {"json": "application/json", "binary": BINARY_TYPE}
LARGE = 100_000  # values of a slice; a larger one waits for a slot and a process of its own
STUDY_BODY = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {
                "schema": component(SweepStudy.__name__),
                "example": PROCESSES["sweep"].example,
            }
        },
    }
}
AXIS_VALUES = {
    "parameters": [
        {
            "name": "at",
            "in": "query",
            "required": False,
            "style": "form",
            "explode": True,
            "schema": {
                "type": "object",
                "additionalProperties": {"type": "string", "maxLength": 200},
            },
            "description": "`name=value` for each axis that is not in `axes`: one of its grid "
            "values.",
        }
    ]
}


@router.post(
    "",
    summary="Post a sweep study",
    status_code=201,
    response_model=SweepDescription,
    responses={
        200: {"model": SweepDescription, "description": "The same study was posted before"},
        **problems(
            s413="The body is too large",
            s422="The study cannot be carried out",
            s507="There is no room for the study",
        ),
    },
    openapi_extra=STUDY_BODY,
)
async def post_sweep(
    request: Request, body: Body, settings: SettingsOf, admission: AdmissionOf, api_key: WhoOf
) -> Response:
    """Check a study and keep it; equal studies share one identifier. Nothing is computed yet.

    A sweep may be far larger than what is computed as a whole: slices and Zarr read pieces of it.
    """
    async with slot_of(request, len(body), POST):
        key, text, document = await calculate_in_process(
            request, read_sweep, body, settings, api_key.cells,
            seconds=settings.max_execution_seconds + settings.grace_seconds,
        )  # fmt: skip
    is_new = await run_in_threadpool(admission.keep_sweep, key, text, api_key)
    shared = await run_in_threadpool(_is_shared, admission, key, api_key)
    location = str(request.url_for("get_sweep", key=key))
    return json_reply(
        {**document, "shared": shared}, 201 if is_new else 200, headers={"Location": location}
    )


@router.get(
    "/{key}",
    summary="Describe a sweep",
    response_model=SweepDescription,
    responses=problems(
        s404="No such sweep",
        s409="The sweep is another version's: post it again",
        s422="The identifier is malformed",
    ),
)
def get_sweep(key: SweepKey, admission: AdmissionOf, api_key: WhoOf) -> Response:
    """Return the study of a sweep, its size, its axes, and the dimensions of its outputs."""
    return json_reply(_describe_sweep(admission, key, admission.store.sweep(key), api_key))


@router.patch(
    "/{key}",
    summary="Share a sweep with all access keys, or stop sharing it",
    response_model=SweepDescription,
    responses={
        **problems(s404="No such sweep", s409="The sweep is another version's: post it again"),
        **NOT_OWNER,
        **NO_SHARING,
    },
    openapi_extra=SHARING_BODY,
    dependencies=[hold_slot()],
)
def share_sweep(key: SweepKey, body: Body, admission: AdmissionOf, api_key: WhoOf) -> Response:
    """Let holders of all access keys read a sweep, or only those who have posted it."""
    sweep = admission.store.sweep(key)
    admission.share_sweep(key, read_sharing(body), api_key)
    return json_reply(_describe_sweep(admission, key, sweep, api_key))


def _describe_sweep(
    admission: Admission, key: str, sweep: Prepared, api_key: Key
) -> dict[str, Any]:
    """Return the description of a sweep, which says whether it is shared.

    An owner sees the sharing of its own record; all others that of any owner.
    """
    return {**describe_sweep(key, sweep), "shared": _is_shared(admission, key, api_key)}


def _is_shared(admission: Admission, key: str, api_key: Key) -> bool:
    is_own = admission.ownership.of(api_key.name, key) is not None and not api_key.sees_all
    return admission.ownership.is_shared(api_key.name if is_own else None, key)


@router.get(
    "/{key}/slice",
    summary="Read values of a sweep over one or two axes",
    response_model=Document,
    responses={
        **cached_replies("The slice", dict.fromkeys([BINARY_TYPE, *TABLES.values()], BINARY)),
        **problems(
            s404="No such sweep",
            s406="No format that Accept allows",
            s409="The sweep is another version's: post it again",
            s422="The slice cannot be taken, or takes too long",
            s503="The process that computed the slice was lost",
        ),
    },
    openapi_extra=AXIS_VALUES,
    dependencies=[refuse_repeated()],
)
async def get_slice(
    request: Request,
    key: SweepKey,
    output: Annotated[str, Query(description="Name of an output.", max_length=100)],
    axes: Annotated[
        str,
        Query(
            description="Names of the one or two axes over which values are returned, as in "
            "`beta,alpha`; all other axes need a value.",
            max_length=200,
        ),
    ],
    form: Annotated[
        SliceForm | None,
        Query(
            alias="format",
            description="Format of the slice; by default the one that `Accept` names, else JSON.",
        ),
    ] = None,
) -> Response:
    """Return an output over free axes, all other axes fixed by `name=value`, with its regime.

    HEAD says whether the slice can be taken, and computes nothing.
    """
    state = request.app.state
    fixed = {
        name: value
        for name, value in request.query_params.multi_items()
        if name not in ("output", "axes", "format")
    }
    chosen = form or form_for(request, FORMS | available_tables(), missing=missing_packages())
    names, max_cells = axes.split(","), state.settings.max_slice_cells
    writer = writer_version(chosen) if chosen in TABLES else chosen
    assignments = [f"{name}={value}" for name, value in sorted(fixed.items())]
    etag = etag_of(key, np.__version__, writer, output, axes, *assignments)
    reply = not_modified(request, etag, FOR_EVER)

    def prepare() -> tuple[Prepared, SliceCut, bytes | None]:
        """Return the sweep, the slice not computed yet, and its values encoded if it is small.

        A second thread for a small slice would take as long again. A wrong request is refused here,
        before it waits.
        """
        sweep = state.store.sweep(key)
        cut = prepare_cut(sweep, output=output, axes=names, at=fixed, most=max_cells)
        is_small = chosen in FORMS and request.method == "GET" and cut.grid.cells <= LARGE
        return sweep, cut, encode_slice(cut, chosen) if is_small else None

    if reply is not None:
        await run_in_threadpool(state.store.sweep, key)  # a removed sweep is 404, not 304
    else:
        sweep, cut, encoded = await run_in_threadpool(prepare)
        # Small slices wait neither for threads nor for slots of large ones.
        is_large = cut.grid.cells > LARGE
        limiter = state.large_slices if is_large else None
        slot = large_slot_of(request) if is_large else nullcontext()
        media_type = (FORMS | TABLES)[chosen]
        if request.method == "HEAD":
            reply = without_length(media_type)
        elif chosen in TABLES:
            rows = most_rows(state.settings, chosen, max_cells)
            async with slot:
                threads = threads_of(request)
                frame = await to_thread.run_sync(
                    lambda: Frame.of(table_of(sweep, compute_slice(cut, threads)), most=rows),
                    limiter=limiter,
                )
            reply = table_reply(frame, chosen, limiter=limiter)
        else:
            if encoded is None:
                async with slot:  # in a thread it would hold up everybody's small ones
                    text = await run_in_threadpool(sweep.study.canonical)
                    encoded = await calculate_in_process(
                        request, encode_slice_of, text, output, names, fixed, max_cells, chosen,
                        threads_of(request), seconds=state.settings.max_execution_seconds,
                    )  # fmt: skip
            reply = Response(encoded, media_type=media_type)
        reply.headers.update({"ETag": etag, "Cache-Control": FOR_EVER})
    reply.headers["Vary"] = "Accept"
    return reply


@router.get(
    "/{key}/netcdf",
    summary="Download a sweep as NetCDF",
    response_class=Response,
    responses={
        **cached_replies("A CF-1.11 NetCDF-4 file", {NETCDF_TYPE: BINARY}, in_ranges=True),
        **problems(
            s404="No such sweep",
            s409="The sweep is another version's: post it again",
            s422="The identifier is malformed, or the sweep is too large, or takes too long, for "
            "one reply",
            s507="There is no room for the file",
        ),
    },
)
async def get_netcdf(
    request: Request,
    key: SweepKey,
    store: StoreOf,
    writer: WriterOf,
    admission: AdmissionOf,
    api_key: WhoOf,
) -> Response:
    """Return the whole sweep as a CF-1.11 NetCDF-4 file; the first request computes it.

    One range of bytes can be asked for, so that a broken download resumes. The ETag is the SHA-256
    of the file. HEAD computes nothing: of a file that is not made it tells neither size nor ETag.
    """
    sweep = await run_in_threadpool(store.sweep, key)
    if request.method == "HEAD" and (
        await writer.manifest_of(key) is None
        or not await run_in_threadpool(admission.knows_result, key, api_key)
    ):
        writer.check(sweep)
        return _reply_without_file(key)
    manifest = await writer.manifest_of(key)
    if manifest is None:
        writer.check(sweep)
    if not api_key.sees_all:
        await run_in_threadpool(admission.take_result, key, sweep.bytes, api_key)
    if manifest is None:
        async with slot_of(request):
            manifest = await writer.write(key, sweep, api_key, client_check(request))
    return await asyncio.to_thread(
        file_reply,
        request,
        store.folder(key) / NETCDF,
        digest=manifest.files[NETCDF]["sha256"],
        media_type=NETCDF_TYPE,
        filename=_filename(key),
    )


def _filename(key: str) -> str:
    return f"vibrafeed-{key[:12]}.nc"


def _reply_without_file(key: str) -> Response:
    """Return the reply to HEAD for a file that only GET would compute: no length, no ETag."""
    headers = {"Cache-Control": ASK_AGAIN, "Accept-Ranges": "bytes"}
    headers["Content-Disposition"] = f'attachment; filename="{_filename(key)}"'
    return without_length(NETCDF_TYPE, headers)
