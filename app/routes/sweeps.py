"""Sweeps: posted as a study, kept by content, read as slices or as NetCDF."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Path, Query, Request
from fastapi.responses import FileResponse, Response

from app.dependencies import Body, SettingsOf, StoreOf
from app.routes import json_reply, problems
from core.quantities import QUANTITIES
from core.study import SweepStudy
from core.study.load import read_json
from core.study.models import PARAMETERS
from core.sweep import Sweep, prepare_content
from core.sweep.slice import cut

router = APIRouter(prefix="/sweeps", tags=["sweeps"])

Key = Annotated[str, Path(description="Identifier of a sweep.", max_length=100)]

STUDY_BODY = {
    "requestBody": {
        "required": True,
        "content": {"application/json": {"schema": SweepStudy.model_json_schema()}},
    }
}
AXIS_VALUES = {
    "parameters": [
        {
            "name": name,
            "in": "query",
            "required": False,
            "schema": {"type": "string", "maxLength": 200},
            "description": f"Value of the axis {name}, where it is not free; one of its values.",
        }
        for name in PARAMETERS
    ]
}


@router.post(
    "",
    summary="Post a sweep study",
    status_code=201,
    response_model=dict[str, Any],
    responses={
        200: {"description": "The same study was there already"},
        **problems(s413="The body is too large", s422="The study cannot be carried out"),
    },
    openapi_extra=STUDY_BODY,
)
def post_sweep(request: Request, body: Body, settings: SettingsOf, store: StoreOf) -> Response:
    """Check a study and keep it; equal studies share one identifier. Nothing is computed yet."""
    sweep = prepare_content(read_json(body))
    sweep.check_limits(cells=settings.max_cells, bytes_=settings.max_bytes)
    key, is_new = store.add(sweep.study)
    location = str(request.url_for("get_sweep", key=key))
    return json_reply(
        _description(key, sweep), 201 if is_new else 200, headers={"Location": location}
    )


@router.get(
    "/{key}",
    summary="Describe a sweep",
    response_model=dict[str, Any],
    responses=problems(s404="No such sweep", s422="The identifier is malformed"),
)
def get_sweep(key: Key, store: StoreOf) -> Response:
    """Return the study of a sweep, its size, its axes, and the dimensions of its outputs."""
    return json_reply(_description(key, store.get(key)))


@router.get(
    "/{key}/slice",
    summary="Read values over one or two axes",
    response_model=dict[str, Any],
    responses=problems(s404="No such sweep", s422="The slice cannot be taken"),
    openapi_extra=AXIS_VALUES,
)
def get_slice(
    request: Request,
    key: Key,
    store: StoreOf,
    settings: SettingsOf,
    output: Annotated[str, Query(description="Name of an output.", max_length=100)],
    axes: Annotated[
        str, Query(description="One or two free axes, as in `beta,alpha`.", max_length=200)
    ],
) -> Response:
    """Return an output over free axes, all other axes fixed by `name=value`, with its regime."""
    fixed = {k: v for k, v in request.query_params.multi_items() if k not in ("output", "axes")}
    piece = cut(
        store.get(key), output=output, axes=axes.split(","), at=fixed, most=settings.max_slice_cells
    )
    return json_reply(piece)


@router.get(
    "/{key}/netcdf",
    summary="Download a sweep as NetCDF",
    response_class=FileResponse,
    responses={
        200: {"content": {"application/x-netcdf": {}}, "description": "A CF-1.11 NetCDF-4 file"},
        **problems(s404="No such sweep", s422="The identifier is malformed"),
    },
)
def get_netcdf(key: Key, store: StoreOf) -> FileResponse:
    """Return the whole sweep as a CF NetCDF-4 file; the first request computes it."""
    path = store.netcdf(key)
    return FileResponse(
        path, media_type="application/x-netcdf", filename=f"vibrafeed-{key[:12]}.nc"
    )


def _description(key: str, sweep: Sweep) -> dict[str, Any]:
    """Return what the service says of a sweep."""
    equations = {equation.gives: equation for equation in sweep.plan.equations}
    return {
        "id": key,
        "study": sweep.study.content(),
        "scene": sweep.plan.scene.name,
        "variant": sweep.plan.variant,
        "validity": sweep.plan.scene.validity,
        "cells": sweep.cells,
        "bytes": sweep.bytes,
        "axes": [
            {"name": name, "unit": QUANTITIES[name].unit, "size": axis.size}
            for name, axis in sweep.grid.axes.items()
        ],
        "outputs": [
            {
                "name": name,
                "unit": QUANTITIES[name].unit,
                "label": QUANTITIES[name].label,
                "dims": list(dims),
                "source": equations[name].source if name in equations else None,
            }
            for name, dims in sweep.dims.items()
        ],
        "regimes": list(sweep.plan.regimes),
        "links": {
            name: f"/sweeps/{key}{end}"
            for name, end in (("self", ""), ("slice", "/slice"), ("netcdf", "/netcdf"))
        },
    }
