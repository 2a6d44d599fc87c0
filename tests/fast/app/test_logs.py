"""The log: one JSON line for each request, an identifier for each, and nothing private."""

import io
import itertools
import json
import logging
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from fastapi import Request
from fastapi.responses import StreamingResponse
from fastapi.testclient import TestClient
from starlette.requests import ClientDisconnect

from local_client import local_client
from vibrafeed.app import logs
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.app.web import observe

Lines = Callable[[], list[dict[str, Any]]]


@pytest.fixture
def lines() -> Iterator[Lines]:
    """Configure the log as `serve` does, into memory; give its lines."""
    names = (None, "vibrafeed", "uvicorn", "uvicorn.error")
    before = [
        (log, log.handlers[:], log.propagate, log.level) for log in map(logging.getLogger, names)
    ]
    stream = io.StringIO()
    logs.configure(stream)
    yield lambda: [json.loads(line) for line in stream.getvalue().splitlines()]
    for log, handlers, propagate, level in before:
        log.handlers, log.propagate = handlers, propagate
        log.setLevel(level)


@pytest.fixture
def client(tmp_path: Path) -> TestClient:
    return local_client(create_app(Settings(data_directory=tmp_path)))


def requests(lines: Lines) -> list[dict[str, Any]]:
    return [line for line in lines() if line["event"] == "request"]


def test_a_request_is_one_line(client, lines, monkeypatch):
    clock = itertools.count(
        step=0.25
    )  # s: it is read when the request comes and when it is answered
    monkeypatch.setattr(observe, "time", SimpleNamespace(perf_counter=lambda: next(clock)))
    reply = client.get("/scenes/rectangle-on-track?variant=thesis")
    (line,) = requests(lines)
    assert line.pop("milliseconds") == 250
    assert line.pop("timestamp").endswith("Z")
    assert line == {
        "event": "request",
        "level": "info",
        "logger": "vibrafeed.requests",
        "method": "GET",
        "route": "/scenes/{name}",
        "status": 200,
        "bytes": len(reply.content),
        "request_id": reply.headers["x-request-id"],
        "client": "testclient",
    }


@pytest.mark.parametrize(
    ("method", "path", "route", "status"),
    [
        ("GET", "/sweeps/abc/netcdf", "/sweeps/{key}/netcdf", 404),
        ("HEAD", "/sweeps/abc/zarr/x/zarr.json", "/sweeps/{key}/zarr/{path}", 404),
        ("POST", "/processes/simulate/execution", "/processes/{process}/execution", 422),
        ("DELETE", "/scenes", "/scenes", 405),
        ("GET", "/private/words", "(none)", 404),
        ("GET", "/static-offline-docs/swagger-ui.css", "/static-offline-docs/{path}", 200),
        ("GET", "/docs", "/docs", 200),
    ],
)
def test_routes_are_templates(client, lines, method, path, route, status):
    client.request(method, path)
    (line,) = requests(lines)
    assert (line["method"], line["status"]) == (method, status)
    assert line["route"].replace(":path", "") == route


def test_the_log_holds_nothing_of_a_request_but_that_line(client, lines):
    secret = "private-words"
    client.post(
        f"/{secret}?{secret}", content=secret, headers={"X-Other": secret, "Cookie": secret}
    )
    client.post("/sweeps", json={secret: secret}, headers={"Authorization": f"Bearer {secret}"})
    client.get("/scenes", headers={"Host": "evil.example", "User-Agent": secret})
    assert len(requests(lines)) == 3
    assert secret not in json.dumps(lines())


@pytest.mark.parametrize(
    ("given", "kept"),
    [
        ("a.B-3_c", "a.B-3_c"),
        *((wrong, "[0-9a-f]{32}") for wrong in ("", "a b", "a" * 65, 'x"y', "é".encode(), "a\\nb")),
    ],
)
def test_a_well_formed_request_id_is_kept_and_another_is_not(client, given, kept):
    reply = client.get("/healthz", headers={"X-Request-ID": given})
    assert re.fullmatch(kept, reply.headers["x-request-id"])


def test_an_unforeseen_error_has_its_traceback_in_the_log_and_its_identifier_in_the_reply(
    client, lines
):
    def fail() -> None:
        raise RuntimeError("secret words")

    client.app.add_api_route("/fails/{key}", fail)
    reply = client.get("/fails/private", headers={"X-Request-ID": "here"})
    assert reply.status_code == 500
    assert reply.json()["instance"] == "urn:vibrafeed:request:here"
    assert reply.headers["x-request-id"] == "here"
    assert "secret" not in reply.text
    error, line = lines()
    assert error["level"] == "error"
    assert error["request_id"] == line["request_id"] == "here"
    assert "secret words" in error["exception"]
    assert "in fail" in error["exception"]
    assert "private" not in json.dumps(error)
    assert (line["status"], line["bytes"]) == (500, len(reply.content))


def test_what_is_bound_stands_in_every_later_line_of_the_request(client, lines):
    def work(job_id: str) -> dict[str, str]:  # in a thread of the pool
        logs.bind(job_id=job_id)
        logging.getLogger("vibrafeed").warning("halfway")
        return {}

    client.app.add_api_route("/task/{job_id}", work)
    client.get("/task/7")
    client.get("/healthz")
    logs.bind(job_id="nobody's")
    halfway, first, second = lines()
    assert halfway["event"] == "halfway"
    assert halfway["request_id"] == first["request_id"]
    assert halfway["job_id"] == first["job_id"] == "7"
    assert "job_id" not in second


def test_a_stream_that_breaks_is_said_so(client, lines):
    def pieces() -> Iterator[bytes]:
        yield b"abc"
        raise OSError("gone")

    client.app.add_api_route("/stream", lambda: StreamingResponse(pieces()))
    assert client.get("/stream").content == b"abc"
    error, line = lines()
    assert "gone" in error["exception"]
    assert line["cut_short"] is True
    assert (line["status"], line["bytes"]) == (200, 3)


def test_a_client_that_goes_is_no_error(client, lines):
    async def left(request: Request) -> None:
        raise ClientDisconnect

    client.app.add_api_route("/left", left)
    with pytest.raises(AssertionError):  # of the test client, which is not answered
        client.get("/left")
    (line,) = lines()
    assert (line["status"], line["cut_short"]) == (499, True)


def test_lines_of_uvicorn_look_alike(lines):
    logging.getLogger("uvicorn.error").info("on %s", "x", extra={"color_message": "\x1b[1mon %s"})
    (line,) = lines()
    assert line.pop("timestamp")
    assert line == {"event": "on x", "level": "info", "logger": "uvicorn.error"}
