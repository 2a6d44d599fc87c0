"""Figures for Prometheus, readiness, traces of OpenTelemetry, and what is logged of kernels."""

import asyncio
import errno
import logging
import os
import sqlite3
import sys
import tempfile
import time
from pathlib import Path
from typing import NoReturn

import pytest
from fastapi.testclient import TestClient
from opentelemetry.sdk.trace.export.in_memory_span_exporter import InMemorySpanExporter
from prometheus_client.parser import text_string_to_metric_families

from local_client import Threads, client_of, ended
from posted_sweeps import STUDY, problem, with_axes
from vibrafeed import core
from vibrafeed.app import spans, traces
from vibrafeed.app.jobs.work import Task
from vibrafeed.app.web import warmth
from waiting import wait_for


@pytest.fixture
def client(tmp_path: Path) -> TestClient:
    return client_of(tmp_path / "data")


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


def full(**_: object) -> NoReturn:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_requests_are_counted_by_route_and_timed_and_refusals_by_their_cause(client):
    for _ in range(3):
        client.get("/scenes/rectangle-on-track")
    client.get("/scenes/nowhere")
    client.post("/sweeps", content=b"x")
    for _ in range(2):
        client.post("/sweeps", content=b" " * 2_000_000)
    found = figures(client)
    for key, expected in {
        ("requests_total", "GET", "/scenes/{name}", "200"): 3,
        ("requests_total", "GET", "/scenes/{name}", "404"): 1,
        ("requests_total", "POST", "/sweeps", "422"): 1,
        ("request_seconds_count", "GET", "/scenes/{name}"): 4,
        ("request_seconds_bucket", "+Inf", "GET", "/scenes/{name}"): 4,
        ("refusals_total", "body"): 2,
        ("refusals_total", "not-found"): 1,
    }.items():
        assert found[f"vibrafeed_{key[0]}", *key[1:]] == expected, key
    assert found["vibrafeed_request_seconds_sum", "GET", "/scenes/{name}"] > 0


def test_version_workers_disk_memory_and_processor_time_are_told(client):
    key = client.post("/sweeps", json=STUDY).json()["id"]
    settings = client.app.state.settings
    with client:
        wait_for(lambda: figures(client)["vibrafeed_loop_delay_seconds_count",] >= 2)
        found = figures(client)
        assert found["vibrafeed_info", core.__version__] == 1
        assert found["vibrafeed_workers",] == 0  # a thread stands for them
        assert found["vibrafeed_disk_used_bytes",] == client.app.state.store.bytes(key) > 0
        assert found["vibrafeed_disk_quota_bytes",] == settings.disk_quota_bytes
        assert found["vibrafeed_disk_free_bytes",] > 0
        assert found["process_resident_memory_bytes",] > 10e6
        assert found["process_cpu_seconds_total",] > 0


def test_without_a_ledger_the_other_figures_are_there(client, monkeypatch):
    def away(statement: object) -> NoReturn:
        raise sqlite3.DatabaseError("database disk image is malformed")

    monkeypatch.setattr(client.app.state.admission.ledger, "_read", away)
    found = figures(client)
    assert found["vibrafeed_disk_quota_bytes",] > 0
    assert ("vibrafeed_oldest_waiting_seconds",) not in found


def test_clients_cannot_make_new_labels(client):
    before = len(figures(client))
    settled = len(figures(client))
    for number in range(5):
        client.get(f"/nowhere/{number}")
        client.request(f"WORD{number}", "/scenes")
    more = len(figures(client)) - settled
    # Two pairs of method and route: a counter with its time of creation, a histogram with its own;
    # and one cause.
    assert settled > before
    assert more == 2 * (settled - before) + 2


def test_jobs_are_counted_by_their_state_in_one_look(client, monkeypatch):
    ledger, looks = client.app.state.admission.ledger, []
    states = set(ledger.counts())
    monkeypatch.setattr(ledger, "_read", lambda s, read=ledger._read: looks.append(s) or read(s))
    assert {key[1] for key in figures(client) if key[0] == "vibrafeed_jobs"} == states
    assert sum("GROUP BY" in str(statement) for statement in looks) == 1


def test_the_queue_tells_what_waits_and_for_how_long(client, monkeypatch):
    def told() -> tuple[float, ...]:
        found = figures(client)
        work = (found["vibrafeed_work", state] for state in ("waiting", "running"))
        return *work, pytest.approx(found["vibrafeed_oldest_waiting_seconds",], abs=1e-3)

    ledger, now = client.app.state.admission.ledger, time.time()
    assert told() == (0, 0, 0)
    for name, since in (("first", 100), ("second", 50)):
        monkeypatch.setattr(time, "time", lambda since=since: now - since)
        ledger.post(Task(name, "sweep", "", 1, 1, 1, 1, 0.0), finished_seconds=None)
    monkeypatch.setattr(time, "time", lambda: now)
    assert told() == (2, 0, 100)
    ledger.claim("server", 10.0)
    assert told() == (1, 1, 50)
    # A lease that has run out is waited for by others.
    monkeypatch.setattr(time, "time", lambda: now + 11)
    assert told()[0] == 2


def test_ready_or_why_not(client, tmp_path, monkeypatch):
    def breaks() -> None:
        raise RuntimeError("secret words")

    state, data = client.app.state, tmp_path / "data"
    with client:  # what is not started is not ready
        before = {path.name for path in data.iterdir()}
        reply = client.get("/readyz").json()
        assert reply["status"] == "ready"
        assert reply["checks"][:2] == ["stopping", "data_directory"]
        assert {path.name for path in data.iterdir()} == before
        with monkeypatch.context() as patch:
            patch.setattr(tempfile, "TemporaryFile", full)
            assert os.strerror(errno.ENOSPC) in str(problem(client.get("/readyz"), 503))
        (tmp_path / "file").write_text("")
        elsewhere = state.settings.model_copy(update={"data_directory": tmp_path / "file"})
        state.settings, settings = elsewhere, state.settings
        reply = client.get("/readyz")
        state.settings = settings
        (error,) = problem(reply, 503)["errors"]
        assert error["place"] == "data_directory"
        assert reply.headers["retry-after"]
        assert str(tmp_path) not in reply.text
        # Every check is asked, and those that fail are named.
        state.readiness += [("workers", lambda: "none has answered"), ("database", breaks)]
        found = problem(client.get("/readyz"), 503)["errors"]
        assert [error["place"] for error in found] == ["workers", "database"]
        assert "none has answered" in str(found)
        assert "secret" not in str(found)
        assert client.get("/healthz").status_code == 200


def test_request_job_and_blocks_share_a_trace(tmp_path, monkeypatch):
    sent = InMemorySpanExporter()
    monkeypatch.setattr(spans, "OTLPSpanExporter", lambda: sent)
    monkeypatch.setenv("OTEL_EXPORTER_OTLP_ENDPOINT", "http://127.0.0.1:9")
    trace, parent = "0af7651916cd43dd8448eb211c80319c", "b7ad6b7169203331"
    asked = {"traceparent": f"00-{trace}-{parent}-01", "Prefer": "respond-async"}
    with client_of(tmp_path, workers=1) as client:
        path = "/processes/sweep/execution?secret=word"
        job = client.post(path, json=with_axes(alpha=2), headers=asked)
        ended(client, job.headers["location"])
        told = figures(client)
    assert told["vibrafeed_block_seconds_count", "sweep"] == 1
    assert told["vibrafeed_block_seconds_sum", "sweep"] > 0
    assert told["vibrafeed_work_seconds_count", "done", "sweep"] == 1
    found = sent.get_finished_spans()
    assert {span.resource.attributes["service.name"] for span in found} == {"vibrafeed"}
    ours = {span.name: span for span in found if span.context.trace_id == int(trace, 16)}
    assert len(ours) == 3
    request = ours["POST /processes/{process}/execution"]
    assert request.parent.span_id == int(parent, 16)
    assert ours["work sweep"].parent.span_id == request.context.span_id
    assert ours["block"].parent.span_id == ours["work sweep"].context.span_id
    assert "secret" not in str([span.to_json() for span in found])


def test_traces_that_cannot_be_sent_are_told(monkeypatch):
    wanted = {"OTEL_EXPORTER_OTLP_ENDPOINT": "somewhere"}
    assert traces.fault({}) is None
    assert traces.fault(wanted) is None
    monkeypatch.setitem(sys.modules, "opentelemetry.exporter.otlp.proto.http", None)
    assert "extra" in traces.fault(wanted)
    assert traces.configured(wanted) is None


@pytest.mark.parametrize(
    ("function", "is_warm", "told"),
    [
        (lambda processes: "cache", True, ""),
        (lambda processes: None, False, ""),
        (lambda processes: full(), False, "No space left on device"),
    ],
)
def test_the_log_says_why_kernels_could_not_be_compiled(
    function, is_warm, told, monkeypatch, caplog
):
    monkeypatch.setattr(warmth, "ProcessPool", Threads)
    monkeypatch.setattr(warmth, "compile_kernels", function)
    warm = warmth.Warmth()
    with caplog.at_level(logging.WARNING, "vibrafeed"):
        asyncio.run(warm.compile())
    assert warm.is_warm == is_warm
    assert told in caplog.text
