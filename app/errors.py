"""Every error of the service as a problem document (RFC 9457)."""

from __future__ import annotations

import errno
import http
import logging
import sqlite3
from collections.abc import Iterable
from typing import Any

import orjson
from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import Response
from starlette.exceptions import HTTPException
from starlette.routing import Match

from app.exceptions import (
    NoRoomError,
    NoSuchJobError,
    NoSuchProcessError,
    NotFoundError,
    NotReadyError,
    QueueFullError,
    TooLargeError,
)
from core.errors import LimitError, Problem, StudyError

logger = logging.getLogger("vibrafeed")

FILES = "The service has as many files open as it may"
HELD = "Another process holds the ledger"
PASSING = (FILES, HELD)  # soon, and by themselves

# What the disk says when it cannot take more, and what to tell of it.
STORAGE = {
    errno.ENOSPC: "The disk is full",
    errno.EDQUOT: "The disk quota is used up",
    errno.EROFS: "The data directory can only be read",
    errno.EACCES: "The data directory may not be written",
    errno.EPERM: "The data directory may not be written",
    errno.EMFILE: FILES,
    errno.ENFILE: FILES,
}
SQLITE = {
    "full": "The disk is full",
    "readonly": "The data directory can only be read",
    "locked": HELD,
    "I/O": "The disk fails",
    "unable to open": "The data directory cannot be written",
}

MEDIA_TYPE = "application/problem+json"


OGC = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"

# What each error means over HTTP: status, kind, title.
STATUS: dict[type[Exception], tuple[int, str, str]] = {
    StudyError: (422, "study", "The study cannot be carried out"),
    LimitError: (422, "limit", "The study is larger than this service allows"),
    NotFoundError: (404, "not-found", "There is no such resource"),
    TooLargeError: (413, "body", "The request is too large"),
    NoSuchProcessError: (404, f"{OGC}no-such-process", "There is no such process"),
    NoSuchJobError: (404, f"{OGC}no-such-job", "There is no such job"),
    NotReadyError: (404, f"{OGC}result-not-ready", "The results are not there yet"),
    QueueFullError: (429, "queue", "The queue of jobs is full"),
    NoRoomError: (507, "storage", "There is no room for the result"),
}
RETRY_AFTER = {429: "5", 503: "1"}


def problem_document(
    status: int,
    kind: str,
    title: str,
    detail: str,
    problems: Iterable[Problem] = (),
    *,
    instance: str | None = None,
    headers: dict[str, str] | None = None,
) -> Response:
    """Return a problem document; `kind` is a word of ours, or a whole address."""
    content: dict[str, Any] = {
        "type": kind if ":" in kind else f"urn:vibrafeed:problem:{kind}",
        "title": title,
        "status": status,
        "detail": detail,
    }
    if instance:
        content["instance"] = instance
    errors = [{"place": p.place, "message": p.message, "fix": p.fix} for p in problems]
    if errors:
        content["errors"] = errors
    return Response(orjson.dumps(content), status, headers, MEDIA_TYPE)


def install(app: FastAPI) -> None:
    """Give the app its error handlers; `app.observe` answers what none of them knows."""
    for error in STATUS:
        app.add_exception_handler(error, _known)
    app.add_exception_handler(RequestValidationError, _invalid)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(OSError, _storage)
    app.add_exception_handler(sqlite3.OperationalError, _storage)


def _known(request: Request, error: Exception) -> Response:
    status, kind, title = STATUS[type(error)]
    if isinstance(error, StudyError):
        count = len(error.problems)
        detail = f"{count} problem{'s' if count > 1 else ''}; errors names each with its place."
        return problem_document(status, kind, title, detail, error.problems)
    retry = {"Retry-After": RETRY_AFTER[status]} if status in RETRY_AFTER else None
    return problem_document(status, kind, title, str(error), headers=retry)


def _storage(request: Request, error: Exception) -> Response:
    assert isinstance(error, OSError | sqlite3.OperationalError)
    logger.error("storage failed", exc_info=error)
    if passes(error):
        headers = {"Retry-After": RETRY_AFTER[503]}
        why = f"{_why(error)}."
        return problem_document(503, "busy", "The service is busy", why, headers=headers)
    return problem_document(**storage_problem(error))


def passes(error: OSError | sqlite3.OperationalError) -> bool:
    """Return whether what is wrong soon passes by itself."""
    return _why(error) in PASSING


def storage_problem(error: OSError | sqlite3.OperationalError) -> dict[str, Any]:
    """Return the parts of the problem document of a file that cannot be written."""
    return {
        "status": 507,
        "kind": "storage",
        "title": "The service cannot store what it should",
        "detail": f"{_why(error)}. What was there is not touched. Ask again when that is mended: "
        "a job goes on where it was.",
    }


def _why(error: OSError | sqlite3.OperationalError) -> str:
    if isinstance(error, OSError):
        return STORAGE.get(error.errno or 0, "A file cannot be written")
    return next((why for word, why in SQLITE.items() if word in str(error)), "The ledger fails")


def _invalid(request: Request, error: Exception) -> Response:
    # The input is not echoed: it may hold values that JSON has no word for.
    assert isinstance(error, RequestValidationError)
    problems = [
        Problem(".".join(map(str, item["loc"])), item["msg"], "Mend the value")
        for item in error.errors()
    ]
    return problem_document(
        422, "request", "The request is not valid", "errors names each problem.", problems
    )


def _http(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    phrase = http.HTTPStatus(error.status_code).phrase
    response = problem_document(error.status_code, "http", phrase, str(error.detail))
    response.headers.update(error.headers or {})
    if error.status_code == http.HTTPStatus.METHOD_NOT_ALLOWED:
        response.headers["Allow"] = ", ".join(_methods(request))
    return response


def _methods(request: Request) -> list[str]:
    """Return the methods that a path answers; the router names those of one of its routes only."""
    allowed: set[str] = set()
    for route in request.app.router.routes:
        if route.matches(request.scope)[0] is not Match.NONE:
            allowed.update(getattr(route, "methods", None) or ())
    return sorted(allowed)


def unforeseen(request_id: str) -> Response:
    """Return what a client is told of a mistake of ours.

    The text of the error stays in the log, under the identifier: it may speak of files and memory.
    """
    detail = "The error is in the service's log, under the request's identifier."
    instance = f"urn:vibrafeed:request:{request_id}"
    return problem_document(500, "internal", "The service failed", detail, instance=instance)
