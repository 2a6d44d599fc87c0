"""Processes after OGC API - Processes: studies that are carried out when they are posted."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

from fastapi import APIRouter
from fastapi.responses import Response
from pydantic import BaseModel

from app.dependencies import Body, SettingsOf
from app.routes import json_reply, problems
from app.settings import Settings
from core.dataset.document import to_document
from core.errors import Problem, StudyError
from core.kinds import prepare_content, tabulate
from core.optimise.exact import OPTIMUM_STATUSES
from core.quantities import MOTION_STATUSES, Flag
from core.study import OptimiseStudy, SimulateStudy
from core.study.load import read_json
from core.watch import Watch

router = APIRouter(prefix="/processes", tags=["processes"])


def _execute_body(study: type[BaseModel]) -> dict[str, Any]:
    """Return the body of a process in OpenAPI: the study, or an execute request with it."""
    schema = study.model_json_schema()
    request = {
        "type": "object",
        "required": ["inputs"],
        "properties": {
            "inputs": {
                "type": "object",
                "required": ["study"],
                "properties": {"study": schema},
            }
        },
    }
    content = {"application/json": {"schema": {"anyOf": [schema, request]}}}
    return {"requestBody": {"required": True, "content": content}}


@router.post(
    "/simulate/execution",
    summary="Simulate the motion in time",
    response_model=dict[str, Any],
    responses=problems(
        s413="The body is too large", s422="The study cannot be carried out, or is too large"
    ),
    openapi_extra=_execute_body(SimulateStudy),
)
def execute_simulate(body: Body, settings: SettingsOf) -> Response:
    """Carry out a study of motion and return its dataset.

    The body is the study itself, or an execute request with the study under ``inputs.study``. What
    is not finished in the time allowed is null, with the status ``not_computed``, and ``complete``
    is false.
    """
    return _execute(body, settings, "simulate", "motion_status", MOTION_STATUSES)


@router.post(
    "/optimise/execution",
    summary="Find the best drive",
    response_model=dict[str, Any],
    responses=problems(
        s413="The body is too large", s422="The study cannot be carried out, or is too large"
    ),
    openapi_extra=_execute_body(OptimiseStudy),
)
def execute_optimise(body: Body, settings: SettingsOf) -> Response:
    """Carry out a study of optimisation and return its dataset.

    The body is the study itself, or an execute request with the study under ``inputs.study``. What
    is not finished in the time allowed is null, with the status ``not_computed``, and ``complete``
    is false.
    """
    return _execute(body, settings, "optimise", "optimum_status", OPTIMUM_STATUSES)


def _execute(
    body: bytes, settings: Settings, kind: str, variable: str, statuses: Mapping[str, Flag]
) -> Response:
    """Carry out the study in a body and return its dataset."""
    prepared = prepare_content(_study(read_json(body), kind))
    prepared.check_limits(cells=settings.max_simulation_cells, bytes_=settings.max_bytes)
    started = time.monotonic()
    watch = Watch(deadline=started + settings.max_execution_seconds)
    table = tabulate(prepared, watch)
    values = table.variables[variable].values
    return json_reply(
        {
            "complete": bool((values != statuses["not_computed"].value).all()),
            "cells": prepared.cells,
            "seconds": time.monotonic() - started,
            **to_document(table),
        }
    )


def _study(content: object, kind: str) -> object:
    """Return the study in a body, of the kind of the process whether it says so or not."""
    if isinstance(content, Mapping) and "inputs" in content:
        inputs = content["inputs"]
        if not isinstance(inputs, Mapping) or not isinstance(inputs.get("study"), Mapping):
            fix = 'Send {"inputs": {"study": {...}}}'
            raise StudyError([Problem("inputs.study", "there is no study", fix)])
        content = inputs["study"]
    if not isinstance(content, Mapping):
        return content
    named = content.get("kind", kind)
    if named != kind:
        problem = Problem(
            "kind", f"this process carries out kind '{kind}', not {str(named)[:60]!r}", "Mend kind"
        )
        raise StudyError([problem])
    return {"kind": kind, **content}
