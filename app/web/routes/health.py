"""Routes for the operator: is the service alive, can it take work, and its figures."""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Callable
from pathlib import Path

from fastapi import Request
from fastapi.responses import PlainTextResponse, Response
from prometheus_client.exposition import CONTENT_TYPE_LATEST
from pydantic import BaseModel, Field

from vibrafeed import core
from vibrafeed.app.web.dependencies import SettingsOf
from vibrafeed.app.web.replies import Router, json_reply, problem_document, problems
from vibrafeed.core.errors import Problem

logger = logging.getLogger("vibrafeed")

router = Router(tags=["service"])


class Health(BaseModel):
    """The service is alive."""

    status: str
    version: str


class Readiness(BaseModel):
    """The service takes work; what has been looked at, and whether kernels are compiled."""

    status: str
    checks: list[str]
    warm: bool = Field(
        description="True if all simulation code is compiled, so that no study has to wait for it."
    )


@router.get("/healthz", summary="Alive", response_model=Health)
async def healthz() -> Response:
    """Return ``ok`` and the version; touches neither disk nor store."""
    return json_reply({"status": "ok", "version": core.__version__})


@router.get(
    "/readyz",
    summary="Ready for work",
    response_model=Readiness,
    responses=problems(s503="The service is not ready; `errors` names the failing checks"),
)
def readyz(request: Request, settings: SettingsOf) -> Response:
    """Return ``ready`` if the data directory can be written and every part is ready."""
    # Parts of the service append their own, which return None or a text that says what is wrong.
    checks: list[tuple[str, Callable[[], str | None]]] = [
        (
            "stopping",
            lambda: "the service is stopping" if request.app.state.stopping.is_set() else None,
        ),
        ("data_directory", lambda: _write_fault(settings.data_directory)),
        *request.app.state.readiness,
    ]
    failed = []
    for name, check in checks:
        try:
            fault = check()
        except Exception:
            # Whatever it is, the service is not ready; its text may speak of files.
            logger.exception("the check %s failed", name)
            fault = "the check failed"
        if fault is not None:
            failed.append(Problem(name, fault, "See the log of the service"))
    if failed:
        detail = "errors names what fails."
        retry = {"Retry-After": "5"}
        return problem_document(
            503, "not-ready", "The service is not ready", detail, failed, headers=retry
        )
    warm = request.app.state.warmth.is_warm
    return json_reply({"status": "ready", "checks": [name for name, _ in checks], "warm": warm})


@router.get("/metrics", summary="Figures for Prometheus", response_class=PlainTextResponse)
def metrics(request: Request) -> Response:
    """Return counts of requests, their times, what is under way, memory and processor time."""
    return Response(request.app.state.metrics.text(), media_type=CONTENT_TYPE_LATEST)


def _write_fault(directory: Path) -> str | None:
    """Return the reason why no file can be written in a directory, as a text; None if one can.

    A file is written there to find out; a missing directory is created.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=directory) as file:
            file.write(b"ready")
            file.flush()
    except OSError as error:
        return f"it cannot be written: {error.strerror}"
    return None
