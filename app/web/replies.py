"""Replies in JSON, problem documents (RFC 9457), and how the OpenAPI document tells of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeVar

import orjson
from fastapi import APIRouter
from fastapi.responses import Response
from pydantic import BaseModel, ConfigDict

from vibrafeed.app import logs
from vibrafeed.core.errors import MAX_PROBLEMS, Problem

_Function = TypeVar("_Function", bound=Callable[..., Any])
PROBLEM_TYPE = "application/problem+json"


class ProblemItem(BaseModel):
    """One of several problems."""

    place: str
    message: str
    fix: str


class ProblemDocument(BaseModel):
    """A problem document (RFC 9457)."""

    type: str
    title: str
    status: int
    detail: str
    instance: str | None = None
    errors: list[ProblemItem] | None = None


class Document(BaseModel):
    """A JSON object."""

    model_config = ConfigDict(extra="allow")


def component(name: str) -> dict[str, Any]:
    """Return a JSON reference to a schema that `vibrafeed.app.web.openapi` adds to the document."""
    return {"$ref": f"#/components/schemas/{name}"}


OBJECT = component(Document.__name__)
BINARY = {"type": "string", "format": "binary"}
ETAG = {"ETag": {"schema": {"type": "string"}}}


def cached_replies(
    description: str, content: Mapping[str, Mapping[str, Any]], *, in_ranges: bool = False
) -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI replies of content with an ETag: 200, and 304 if the client has it.

    Parameters
    ----------
    description : str
        Description of the reply 200.
    content : mapping
        The schema of each media type.
    in_ranges : bool
        True to add the replies to requests for byte ranges (206, 412, 416); JSON is sent whole
        only.
    """
    types = {name: {"schema": schema} for name, schema in content.items()}
    replies: dict[int | str, dict[str, Any]] = {
        200: {"content": types, "description": description, "headers": ETAG},
        304: {"description": "The client has this version already: its ETag is in If-None-Match"},
    }
    if in_ranges:
        replies[206] = {
            "content": {
                name: media for name, media in types.items() if media["schema"] is not OBJECT
            },
            "description": "The requested byte range",
            "headers": {"Content-Range": {"schema": {"type": "string"}}},
        }
        replies |= problems(
            s412="The file is not the one named by If-Match",
            s416="The byte range is beyond the end of the file",
        )
    return replies


PROBLEM: dict[str, Any] = {
    "content": {PROBLEM_TYPE: {"schema": component(ProblemDocument.__name__)}}
}


def problems(**descriptions: str) -> dict[int | str, dict[str, Any]]:
    """Return OpenAPI descriptions of error replies, as in ``problems(s404="No such sweep")``."""
    return {
        int(status[1:]): {"description": text, **PROBLEM} for status, text in descriptions.items()
    }


def json_reply(content: Any, status: int = 200, headers: dict[str, str] | None = None) -> Response:
    """Return a JSON reply; numpy arrays become lists, NaN and infinity null."""
    return Response(
        orjson.dumps(content, option=orjson.OPT_SERIALIZE_NUMPY),
        status,
        media_type="application/json",
        headers=headers,
    )


class Router(APIRouter):
    """A router whose routes of GET answer HEAD, which the OpenAPI document leaves out."""

    def get(self, path: str, **options: Any) -> Callable[[_Function], _Function]:
        """Return the decorator that adds a route of GET and of HEAD; `options` are FastAPI's."""
        dependencies = options.get("dependencies")
        head = self.head(path, include_in_schema=False, dependencies=dependencies)
        get = super().get(path, **options)
        return lambda function: get(head(function))


def without_length(media_type: str, headers: Mapping[str, str] | None = None) -> Response:
    """Return a reply to HEAD for content that is not made yet, so without a length."""
    reply = Response(headers=headers, media_type=media_type)
    del reply.headers["Content-Length"]  # 0, which it will not be
    return reply


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
    """Return a problem document (RFC 9457) as a reply.

    Parameters
    ----------
    status : int
        The HTTP status.
    kind : str
        A short word for the type of problem, or a whole URL.
    title, detail : str
        The type in words, and what is special about this case.
    problems : iterable of Problem
        Single problems, of which the first ones are listed; the detail says how many more there
        are.
    instance : str, optional
        An identifier of this case.
    headers : dict, optional
        Further headers of the reply.
    """
    logs.bind(problem=kind.rpartition("/")[2])
    problems = tuple(problems)
    if len(problems) > MAX_PROBLEMS:
        more = len(problems) - MAX_PROBLEMS
        detail += f" The first {MAX_PROBLEMS} are named; there are {more:,} more."
    content: dict[str, Any] = {
        "type": kind if ":" in kind else f"urn:vibrafeed:problem:{kind}",
        "title": title,
        "status": status,
        "detail": detail,
    }
    if instance:
        content["instance"] = instance
    errors = [problem.document() for problem in problems[:MAX_PROBLEMS]]
    if errors:
        content["errors"] = errors
    return Response(orjson.dumps(content), status, headers, PROBLEM_TYPE)
