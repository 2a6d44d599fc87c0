"""A job that is dismissed, or over its time, frees its workers, however long a cell takes."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from services import QUICK, Server

# Some bytes that ask for hours: a part that hops and never repeats, by the method that is slowest.
HOURS: dict[str, Any] = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "method": "reference",
    "max_periods": 100_000,
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
# Its report has two families of measurements, of a few seconds each.
CLOSED_FORMS = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["throw_number"],
    "parameters": {"frequency": 50, "amplitude": "0.2 mm", "beta": 30},
}


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    one = Server(tmp_path, **QUICK, workers=1)
    one.launch()
    yield one
    one.stop()


def test_dismissed_work_frees_its_worker(server: Server) -> None:
    long = server.post(HOURS)
    server.waited(long, lambda job: job["status"] == "running")
    time.sleep(3)  # the worker loads, and is amid the cell
    server.ask(f"/jobs/{long}", method="DELETE")
    small = server.finished(server.post(SMALL))
    assert small["status"] == "successful", small


def test_work_over_its_time_fails_alone(tmp_path: Path) -> None:
    server = Server(tmp_path, **QUICK, workers=1, max_job_seconds=12)
    server.launch()
    try:
        long = server.post(HOURS)
        server.waited(long, lambda job: job["status"] == "running")
        # What is short does not wait for it.
        small = server.finished(server.post(SMALL))
        assert small["status"] == "successful", small
        over = server.finished(long)
        assert over["status"] == "failed"
        assert "longer than this service allows" in over["message"]
    finally:
        server.stop()


@pytest.mark.night
def test_a_small_job_does_not_wait_for_long_ones(tmp_path: Path) -> None:
    server = Server(tmp_path, **QUICK, workers=2)
    server.launch()
    try:
        grid = {"start": "0.05 mm", "stop": "0.75 mm", "num": 1001}
        long = [
            server.post(
                {**SMALL, "parameters": {**SMALL["parameters"], "frequency": 40 + n, **axes}}
            )
            for n in range(6)
            for axes in [{"amplitude": grid, "beta": {"start": 5, "stop": 60, "num": 1001}}]
        ]
        server.begun(long[0])
        small = server.finished(server.post(SMALL))
        assert small["status"] == "successful", small
        assert {server.job(number)["status"] for number in long} <= {"accepted", "running"}
    finally:
        server.stop()


@pytest.mark.night
def test_accuracy_is_measured_and_can_be_dismissed(tmp_path: Path) -> None:
    server = Server(tmp_path, **QUICK, workers=1)
    server.launch()
    try:
        path = "/processes/accuracy/execution"
        number = json.loads(server.ask(path, CLOSED_FORMS))["jobID"]
        assert server.finished(number)["status"] == "successful"
        assert server.job(number)["elapsedSeconds"] > 0
        others = [json.loads(server.ask(path, study_at(60 + n)))["jobID"] for n in range(3)]
        server.waited(others[0], lambda job: job["status"] == "running")
        for one in others:
            server.ask(f"/jobs/{one}", method="DELETE")
        small = server.finished(server.post(study_at(70)))
        assert small["status"] == "successful", small
        assert {server.job(one)["status"] for one in others} == {"dismissed"}
    finally:
        server.stop()


def study_at(frequency: float) -> dict[str, Any]:
    return {**SMALL, "parameters": {**SMALL["parameters"], "frequency": frequency}}
