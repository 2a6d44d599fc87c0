"""Processes after OGC API - Processes: studies that are carried out when they are posted."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

from fastapi import APIRouter
from fastapi.responses import Response

from app.dependencies import Body, SettingsOf
from app.routes import json_reply, problems
from core.dataset.document import to_document
from core.errors import Problem, StudyError
from core.kinds import prepare_content, tabulate
from core.quantities import MOTION_STATUSES
from core.study import SimulateStudy
from core.study.load import read_json
from core.watch import Watch

router = APIRouter(prefix="/processes", tags=["processes"])

EXECUTE_BODY = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {
                "schema": {
                    "anyOf": [
                        SimulateStudy.model_json_schema(),
                        {
                            "type": "object",
                            "required": ["inputs"],
                            "properties": {
                                "inputs": {
                                    "type": "object",
                                    "required": ["study"],
                                    "properties": {"study": SimulateStudy.model_json_schema()},
                                }
                            },
                        },
                    ]
                }
            }
        },
    }
}


@router.post(
    "/simulate/execution",
    summary="Simulate the motion in time",
    response_model=dict[str, Any],
    responses=problems(
        s413="The body is too large", s422="The study cannot be carried out, or is too large"
    ),
    openapi_extra=EXECUTE_BODY,
)
def execute_simulate(body: Body, settings: SettingsOf) -> Response:
    """Carry out a study of motion and return its dataset.

    The body is the study itself, or an execute request with the study under ``inputs.study``. What
    is not finished in the time allowed is null, with the status ``not_computed``, and ``complete``
    is false.
    """
    prepared = prepare_content(_study(read_json(body), "simulate"))
    prepared.check_limits(cells=settings.max_simulation_cells, bytes_=settings.max_bytes)
    started = time.monotonic()
    watch = Watch(deadline=started + settings.max_execution_seconds)
    table = tabulate(prepared, watch)
    statuses = table.variables["motion_status"].values
    return json_reply(
        {
            "complete": bool((statuses != MOTION_STATUSES["not_computed"].value).all()),
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
