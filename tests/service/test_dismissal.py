"""A job that is dismissed, or over its time, frees its workers, however long a cell takes."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.service.test_durability import QUICK, Server

# Some bytes that ask for hours: a part that hops and never repeats, by the method that is slowest.
HOURS: dict[str, Any] = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "method": "reference",
    "most_periods": 100_000,
    "parameters": {
        "frequency": 50,
        "amplitude": "2.1 mm",
        "beta": 41,
        "friction": 0.4,
        "restitution": 0.6,
    },
}
SMALL = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "parameters": {"frequency": 50, "amplitude": "0.2 mm", "beta": 30, "friction": 0.4},
}


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    one = Server(tmp_path, **QUICK, VIBRAFEED_WORKERS="1")
    yield one
    one.stop()


def test_dismissed_work_frees_its_worker(server: Server) -> None:
    long = server.post(HOURS)
    server.waited(long, lambda job: job["status"] == "running")
    time.sleep(5)  # the worker loads, and is amid the cell
    server.ask(f"/jobs/{long}", method="DELETE")
    small = server.finished(server.post(SMALL), seconds=120)
    assert small["status"] == "successful", small


def test_work_over_its_time_fails_alone(tmp_path: Path) -> None:
    server = Server(tmp_path, **QUICK, VIBRAFEED_WORKERS="1", VIBRAFEED_MAX_JOB_SECONDS="20")
    try:
        long = server.finished(server.post(HOURS), seconds=120)
        assert long["status"] == "failed"
        assert "longer than this service allows" in long["message"]
        small = server.finished(server.post(SMALL), seconds=120)
        assert small["status"] == "successful", small
    finally:
        server.stop()
