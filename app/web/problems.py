"""Every error of the service as a problem document (RFC 9457)."""

from __future__ import annotations

import http
import logging
import sqlite3

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import Response
from starlette.exceptions import HTTPException
from starlette.routing import Match, Mount

from vibrafeed.app.jobs import disk
from vibrafeed.app.jobs.errors import (
    GoneError,
    NoRoomError,
    NotFoundError,
    NotOwnerError,
    OtherVersionError,
    QueueFullError,
    TooManyJobsError,
)
from vibrafeed.app.jobs.process_pool import EndedError, LostError, SlowError
from vibrafeed.app.web.replies import problem_document
from vibrafeed.core.errors import (
    LimitError,
    MissingPackageError,
    Problem,
    StoppedError,
    StudyError,
    VibrafeedError,
)

logger = logging.getLogger("vibrafeed")


class NoSuchProcessError(NotFoundError):
    """There is no such process."""


class NoSuchJobError(NotFoundError):
    """There is no such job."""


class FailedError(VibrafeedError):
    """A job failed; its argument is the problem document."""


class NotReadyError(NotFoundError):
    """The results of a job are not there yet."""


class TooLargeError(VibrafeedError):
    """The body of a request is larger than the limit, which the message names."""

    def __init__(self, most: int):
        """Name the limit, `most` bytes, in the message."""
        super().__init__(f"A body may have {most:,} bytes; this one has more.")


class NotAcceptableError(VibrafeedError):
    """There is nothing in a form that the client takes; the message names what there is."""


class BusyError(VibrafeedError):
    """The service has too much under way to take this now."""


OGC = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"

# What each error means over HTTP: status, kind, title.
STATUS: dict[type[Exception], tuple[int, str, str]] = {
    StudyError: (422, "study", "The study cannot be carried out"),
    LimitError: (422, "limit", "The study is larger than this service allows"),
    StoppedError: (422, "limit", "The study takes longer than this service allows"),
    NotFoundError: (404, "not-found", "There is no such resource"),
    NotAcceptableError: (406, "form", "Unknown format"),
    MissingPackageError: (406, "form", "Unknown format"),
    OtherVersionError: (409, "version", "The study belongs to another version of vibrafeed"),
    TooLargeError: (413, "body", "The request is too large"),
    NoSuchProcessError: (404, f"{OGC}no-such-process", "There is no such process"),
    NoSuchJobError: (404, f"{OGC}no-such-job", "There is no such job"),
    NotReadyError: (404, f"{OGC}result-not-ready", "The results are not there yet"),
    NotOwnerError: (403, "owner", "The job or sweep belongs to another key"),
    GoneError: (410, "gone", "The result is gone"),
    TooManyJobsError: (429, "jobs", "The key has as many jobs as it may"),
    QueueFullError: (429, "queue", "The queue of jobs is full"),
    SlowError: (503, "busy", "The service is busy"),
    EndedError: (503, "busy", "The service is busy"),
    LostError: (503, "busy", "The service is busy"),
    BusyError: (503, "busy", "The service is busy"),
    NoRoomError: (507, "storage", "There is no room for the result"),
}
METHODS = ("DELETE", "GET", "HEAD", "PATCH", "POST", "PUT")
RETRY_AFTER = {429: "5", 503: "1"}


def install(app: FastAPI) -> None:
    """Register the error handlers of the application, which turn exceptions into problem documents.

    They are for errors of the service, invalid requests, HTTP errors, and failures of storage.
    """
    app.add_exception_handler(FailedError, _failed)
    for error in STATUS:
        app.add_exception_handler(error, _known)
    app.add_exception_handler(RequestValidationError, _invalid)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(OSError, _storage)
    app.add_exception_handler(sqlite3.OperationalError, _storage)


def _known(request: Request, error: Exception) -> Response:
    """Return the problem document of an error that the service raises on purpose.

    Status, kind and title come from `STATUS`; the detail is the error's message.
    """
    status, kind, title = STATUS[type(error)]
    if isinstance(error, StudyError):
        count = len(error.problems)
        detail = f"{count} problem{'s' if count > 1 else ''}; `errors` lists each with its place."
        return problem_document(status, kind, title, detail, error.problems)
    retry = {"Retry-After": RETRY_AFTER[status]} if status in RETRY_AFTER else None
    if isinstance(error, NotReadyError):
        retry = {"Retry-After": RETRY_AFTER[503]}
    return problem_document(status, kind, title, str(error), headers=retry)


def _failed(request: Request, error: Exception) -> Response:
    return problem_document(**error.args[0])


def _storage(request: Request, error: Exception) -> Response:
    """Return the problem document of a storage error: 503 if it is likely to pass, else 507.

    The error, of a file or of the ledger's database, goes to the log.
    """
    assert isinstance(error, OSError | sqlite3.OperationalError)
    logger.error("storage failed", exc_info=error)
    if disk.is_temporary(error):
        headers = {"Retry-After": RETRY_AFTER[503]}
        detail = f"{disk.cause_of(error)}."
        return problem_document(503, "busy", "The service is busy", detail, headers=headers)
    return problem_document(**disk.problem(error))


def _invalid(request: Request, error: Exception) -> Response:
    """Return the problem document 422 of a request that FastAPI found invalid."""
    # The input is not echoed: it may hold values that JSON has no word for.
    assert isinstance(error, RequestValidationError)
    problems = [
        Problem(".".join(map(str, item["loc"]))[:60] or "body", item["msg"], "Correct the value")
        for item in error.errors()
    ]
    return problem_document(
        422, "request", "The request is not valid", "errors names each problem.", problems
    )


def _http(request: Request, error: Exception) -> Response:
    """Return the problem document of an HTTP error of the framework, such as 404 or 405.

    A handler of FastAPI. A reply 405 names all methods that the path of the request supports.
    """
    assert isinstance(error, HTTPException)
    phrase = http.HTTPStatus(error.status_code).phrase
    response = problem_document(error.status_code, "http", phrase, str(error.detail))
    response.headers.update(error.headers or {})
    if error.status_code == http.HTTPStatus.METHOD_NOT_ALLOWED:
        response.headers["Allow"] = ", ".join(_methods(request))
    return response


def _methods(request: Request) -> list[str]:
    """Return all methods that the path of a request supports, sorted.

    The router reports only those of one route, and files of the page none.
    """
    routes = [route for route in request.app.router.routes if not isinstance(route, Mount)]
    scopes = {method: {**request.scope, "method": method} for method in METHODS}
    return [
        method
        for method, scope in scopes.items()
        if any(route.matches(scope)[0] is Match.FULL for route in routes)
    ] or ["GET", "HEAD"]


def unforeseen(request_id: str) -> Response:
    """Return the reply 500 to an unexpected error of the service; `request_id` names the request.

    The text of the error stays in the log, under this identifier: it may speak of files and memory.
    """
    detail = "The error is in the service's log, under the request's identifier."
    instance = f"urn:vibrafeed:request:{request_id}"
    return problem_document(500, "internal", "The service failed", detail, instance=instance)
