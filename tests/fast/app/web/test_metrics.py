"""Figures for Prometheus, and readiness."""

from __future__ import annotations

import errno
import os
import sqlite3
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NoReturn

import pytest
from fastapi.testclient import TestClient
from prometheus_client.parser import text_string_to_metric_families

from local_client import local_client
from posted_sweeps import STUDY
from vibrafeed import core
from vibrafeed.app.jobs.ledger import Work
from vibrafeed.app.jobs.work import Task
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from waiting import PATIENCE, wait_for


@pytest.fixture
def client(tmp_path: Path) -> TestClient:
    return local_client(create_app(Settings(data_directory=tmp_path / "data")))


def figures(client: TestClient) -> dict[tuple[str, ...], float]:
    """Return the figures as Prometheus itself reads them: by name and the values of labels."""
    reply = client.get("/metrics")
    assert reply.status_code == 200
    assert reply.headers["content-type"].startswith("text/plain; version=")
    return {
        (sample.name, *sample.labels.values()): sample.value
        for family in text_string_to_metric_families(reply.text)
        for sample in family.samples
    }


def test_requests_are_counted_by_route_and_timed(client):
    for _ in range(3):
        client.get("/scenes/rectangle-on-track")
    client.get("/scenes/nowhere")
    client.post("/sweeps", content=b"x")
    found = figures(client)
    assert found["vibrafeed_requests_total", "GET", "/scenes/{name}", "200"] == 3
    assert found["vibrafeed_requests_total", "GET", "/scenes/{name}", "404"] == 1
    assert found["vibrafeed_requests_total", "POST", "/sweeps", "422"] == 1
    assert found["vibrafeed_request_seconds_count", "GET", "/scenes/{name}"] == 4
    assert found["vibrafeed_request_seconds_bucket", "+Inf", "GET", "/scenes/{name}"] == 4
    assert found["vibrafeed_request_seconds_sum", "GET", "/scenes/{name}"] > 0


def test_refusals_are_counted_by_their_cause(client):
    for _ in range(2):
        client.post("/sweeps", content=b" " * 2_000_000)
    client.get("/scenes/nowhere")
    found = figures(client)
    assert found["vibrafeed_refusals_total", "body"] == 2
    assert found["vibrafeed_refusals_total", "not-found"] == 1


def test_the_delay_of_the_event_loop_is_measured(client):
    with client:
        wait_for(lambda: figures(client)["vibrafeed_loop_delay_seconds_count",] >= 2)


def test_without_a_ledger_the_other_figures_are_there(client, monkeypatch):
    ledger = client.app.state.admission.ledger

    def away(statement: object) -> NoReturn:
        raise sqlite3.DatabaseError("database disk image is malformed")

    monkeypatch.setattr(ledger, "_read", away)
    found = figures(client)
    assert found["vibrafeed_disk_quota_bytes",] > 0
    assert ("vibrafeed_oldest_waiting_seconds",) not in found


def test_clients_cannot_make_new_labels(client):
    before = len(figures(client))
    figures(client)
    settled = len(figures(client))
    for number in range(20):
        client.get(f"/nowhere/{number}")
        client.request(f"WORD{number}", "/scenes")
    more = len(figures(client)) - settled
    assert before <= settled
    # Two pairs of method and route: a counter with its time of creation, a histogram with its own;
    # and one cause.
    one = settled - before
    assert one > 0
    assert more == 2 * one + 2


def test_requests_under_way_are_counted_while_they_are(client):
    entered, go = threading.Event(), threading.Event()

    def wait() -> dict[str, str]:
        entered.set()
        go.wait(PATIENCE)
        return {}

    client.app.add_api_route("/wait", wait)
    with client:
        thread = threading.Thread(target=client.get, args=("/wait",))
        thread.start()
        assert entered.wait(PATIENCE)
        assert figures(client)["vibrafeed_requests_under_way",] == 2  # and this one itself
        go.set()
        thread.join(PATIENCE)
        assert figures(client)["vibrafeed_requests_under_way",] == 1


def test_memory_and_processor_time_are_told(client):
    found = figures(client)
    assert found["process_resident_memory_bytes",] > 10e6
    assert found["process_cpu_seconds_total",] > 0


def test_parts_add_gauges_and_apps_share_nothing(client, tmp_path):
    values = {"cold": 3.0}
    client.app.state.metrics.gauges("vibrafeed_pots", "Pots.", "state", lambda: values)
    assert figures(client)["vibrafeed_pots", "cold"] == 3
    values.update(cold=4.0, warm=1.0)
    assert figures(client)["vibrafeed_pots", "cold"] == 4
    assert figures(client)["vibrafeed_pots", "warm"] == 1
    other = local_client(create_app(Settings(data_directory=tmp_path)))
    assert ("vibrafeed_pots", "cold") not in figures(other)


def test_jobs_are_counted_by_their_state_in_one_look(client, monkeypatch):
    ledger = client.app.state.admission.ledger
    looks = []
    counts = ledger.counts
    monkeypatch.setattr(ledger, "_read", lambda s, read=ledger._read: looks.append(s) or read(s))
    found = figures(client)
    assert {key[1] for key in found if key[0] == "vibrafeed_jobs"} == set(counts())
    looks = [statement for statement in looks if "GROUP BY" in str(statement)]
    assert len(looks) == 2  # that of this test among them


def test_the_queue_tells_what_waits_and_for_how_long(client, monkeypatch):
    ledger = client.app.state.admission.ledger
    assert figures(client)["vibrafeed_oldest_waiting_seconds",] == 0
    now = time.time()
    monkeypatch.setattr(time, "time", lambda: now - 100)
    ledger.post(Task("first", "sweep", "", 1, 1, 1, 1, 0.0), finished_seconds=None)
    monkeypatch.setattr(time, "time", lambda: now - 50)
    ledger.post(Task("second", "sweep", "", 1, 1, 1, 1, 0.0), finished_seconds=None)
    monkeypatch.setattr(time, "time", lambda: now)
    found = figures(client)
    assert found["vibrafeed_work", "waiting"] == 2
    assert found["vibrafeed_oldest_waiting_seconds",] == pytest.approx(100, abs=1e-3)
    ledger.claim("server", 10.0)
    found = figures(client)
    assert (found["vibrafeed_work", "waiting"], found["vibrafeed_work", "running"]) == (1, 1)
    assert found["vibrafeed_oldest_waiting_seconds",] == pytest.approx(50, abs=1e-3)
    # A lease that has run out is waited for by others.
    monkeypatch.setattr(time, "time", lambda: now + 11)
    assert figures(client)["vibrafeed_work", "waiting"] == 2


def test_version_workers_and_disk_are_told(client):
    key = client.post("/sweeps", json=STUDY).json()["id"]
    settings = client.app.state.settings
    found = figures(client)
    assert found["vibrafeed_info", core.__version__] == 1
    assert found["vibrafeed_workers",] >= 1  # one has read the study
    assert found["vibrafeed_disk_used_bytes",] == client.app.state.store.bytes(key) > 0
    assert found["vibrafeed_disk_quota_bytes",] == settings.disk_quota_bytes
    assert found["vibrafeed_disk_free_bytes",] > 0


def test_blocks_and_work_are_timed(client):
    item = Work("key", "sweep", 1, 2, 0.0, "owner")
    metrics = client.app.state.metrics
    metrics.began(item)
    metrics.computed(item, 0.25)
    metrics.computed(item, 2.0)
    metrics.ended(item, "done", 2.25)
    found = figures(client)
    assert found["vibrafeed_block_seconds_count", "sweep"] == 2
    assert found["vibrafeed_block_seconds_sum", "sweep"] == 2.25
    assert found["vibrafeed_work_seconds_count", "done", "sweep"] == 1


class TestReadiness:
    @pytest.fixture
    def client(self, client: TestClient) -> Iterator[TestClient]:
        with client:  # what is not started is not ready
            yield client

    def test_ready(self, client, tmp_path):
        assert client.get("/readyz").status_code == 200
        before = {path.name for path in (tmp_path / "data").iterdir()}
        reply = client.get("/readyz")
        assert reply.json()["status"] == "ready"
        assert reply.json()["checks"][:2] == ["stopping", "data_directory"]
        assert {path.name for path in (tmp_path / "data").iterdir()} == before

    def test_a_full_disk(self, client, monkeypatch):
        def full(dir: Path) -> NoReturn:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

        monkeypatch.setattr(tempfile, "TemporaryFile", full)
        reply = client.get("/readyz")
        assert reply.status_code == 503
        assert os.strerror(errno.ENOSPC) in reply.text

    def test_a_data_directory_that_cannot_be_written(self, client, tmp_path):
        (tmp_path / "file").write_text("")
        elsewhere = client.app.state.settings.model_copy(
            update={"data_directory": tmp_path / "file"}
        )
        client.app.state.settings = elsewhere
        reply = client.get("/readyz")
        assert reply.status_code == 503
        assert reply.headers["retry-after"]
        assert reply.headers["content-type"] == "application/problem+json"
        (error,) = reply.json()["errors"]
        assert error["place"] == "data_directory"
        assert str(tmp_path) not in reply.text
        assert client.get("/healthz").status_code == 200

    def test_every_check_is_asked_and_those_that_fail_are_named(self, client):
        def breaks() -> None:
            raise RuntimeError("secret words")

        client.app.state.readiness += [
            ("workers", lambda: "none has answered"),
            ("database", breaks),
            ("cache", lambda: None),
        ]
        reply = client.get("/readyz")
        assert reply.status_code == 503
        assert [error["place"] for error in reply.json()["errors"]] == ["workers", "database"]
        assert "none has answered" in reply.text
        assert "secret" not in reply.text
        del client.app.state.readiness[-3:-1]
        assert client.get("/readyz").status_code == 200
