"""How a job stands, in words and numbers."""

from __future__ import annotations

from dataclasses import replace

import pytest

from vibrafeed.app.jobs.ledger import Job
from vibrafeed.app.web.documents import status_info

NOW = 1.8e9
RUNNING = Job(
    id="a",
    key="b",
    process="sweep",
    state="running",
    cells=100,
    blocks=10,
    done=5,
    created=NOW - 100,
    started=NOW - 90,
    finished=None,
    seconds=20.0,
    problem=None,
    began=NOW - 50,
)


@pytest.fixture(autouse=True)
def clock(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vibrafeed.app.web.documents.time.time", lambda: NOW)


def test_the_time_left_follows_from_the_pace():
    assert status_info(RUNNING, "")["secondsLeft"] == 50


def test_a_clock_that_was_put_back_tells_no_time_left():
    assert "secondsLeft" not in status_info(replace(RUNNING, began=NOW + 86_400), "")


def test_what_has_not_begun_says_what_it_waits_for():
    waiting = replace(RUNNING, state="accepted", started=None, began=None, done=0)
    assert status_info(waiting, "")["message"] == "The job waits for its turn."
    found = status_info(waiting, "", waits="there are no workers")
    assert found["message"] == "The job waits: there are no workers."
    running = status_info(RUNNING, "", waits="all workers are busy")
    assert running["message"] == "5 of 10 blocks are done."
