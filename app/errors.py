"""Every error of the service as a problem document (RFC 9457)."""

from __future__ import annotations

import http
from collections.abc import Iterable
from typing import Any

import orjson
from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import Response
from starlette.exceptions import HTTPException

from core.errors import LimitError, Problem, StudyError, VibrafeedError

MEDIA_TYPE = "application/problem+json"


class NotFoundError(VibrafeedError):
    """A resource does not exist; the message says which."""


class TooLargeError(VibrafeedError):
    """The body of a request is larger than the limit, which the message names."""

    def __init__(self, most: int):
        super().__init__(f"A body may hold {most:,} bytes; this one holds more.")


# What each error means over HTTP: status, kind, title.
STATUS: dict[type[Exception], tuple[int, str, str]] = {
    StudyError: (422, "study", "The study cannot be carried out"),
    LimitError: (422, "limit", "The study is larger than this service allows"),
    NotFoundError: (404, "not-found", "There is no such resource"),
    TooLargeError: (413, "body", "The request is too large"),
}


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
    """Return a problem document."""
    content: dict[str, Any] = {
        "type": f"urn:vibrafeed:problem:{kind}",
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


def _known(request: Request, error: Exception) -> Response:
    status, kind, title = STATUS[type(error)]
    if isinstance(error, StudyError):
        count = len(error.problems)
        detail = f"{count} problem{'s' if count > 1 else ''}; errors names each with its place."
        return problem_document(status, kind, title, detail, error.problems)
    return problem_document(status, kind, title, str(error))


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
    return response


def unforeseen(request_id: str) -> Response:
    """Return what a client is told of a mistake of ours.

    The text of the error stays in the log, under the identifier: it may speak of files and memory.
    """
    detail = "The error is in the service's log, under the request's identifier."
    instance = f"urn:vibrafeed:request:{request_id}"
    return problem_document(500, "internal", "The service failed", detail, instance=instance)
