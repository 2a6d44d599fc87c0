"""Traces: a request, its job and the job's blocks are one trace, at a receiver of our own."""

from __future__ import annotations

import subprocess
import sys
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest
from opentelemetry.proto.collector.trace.v1.trace_service_pb2 import ExportTraceServiceRequest

from local_client import local_client
from vibrafeed.app import traces
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from waiting import PATIENCE, wait_for

TRACE = "0af7651916cd43dd8448eb211c80319c"
STUDY = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["throw_number"],
    "parameters": {"frequency": 50, "amplitude": "0.5 mm", "beta": [0, 10, 20]},
}


class Receiver(BaseHTTPRequestHandler):
    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers["Content-Length"]))
        self.server.received.append((self.path, body))  # type: ignore[attr-defined]
        self.send_response(200)
        self.send_header("Content-Length", "0")
        self.end_headers()

    def log_message(self, *words: object) -> None:
        pass


@pytest.fixture
def receiver(monkeypatch) -> Iterator[ThreadingHTTPServer]:
    server = ThreadingHTTPServer(("127.0.0.1", 0), Receiver)
    server.received = []  # type: ignore[attr-defined]
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    address = f"http://127.0.0.1:{server.server_address[1]}"
    monkeypatch.setenv("OTEL_EXPORTER_OTLP_ENDPOINT", address)
    try:
        yield server
    finally:
        server.shutdown()
        server.server_close()
        thread.join(PATIENCE)


def spans(receiver):
    """Return the names of the spans of the trace with their own and their parent's identifiers."""
    found = []
    for path, body in receiver.received:
        assert path == "/v1/traces"
        for resource in ExportTraceServiceRequest.FromString(body).resource_spans:
            names = {one.key: one.value.string_value for one in resource.resource.attributes}
            assert names["service.name"] == "vibrafeed"
            found += [span for scope in resource.scope_spans for span in scope.spans]
    return found


def test_request_job_and_blocks_share_a_trace(receiver, tmp_path):
    parent = {"traceparent": f"00-{TRACE}-b7ad6b7169203331-01", "Prefer": "respond-async"}
    app = create_app(Settings(data_directory=tmp_path, workers=1))
    with local_client(app) as client:
        path = "/processes/sweep/execution?secret=word"
        number = client.post(path, json=STUDY, headers=parent).json()["jobID"]
        wait_for(lambda: client.get(f"/jobs/{number}").json()["status"] == "successful")
    ours = {span.name: span for span in spans(receiver) if span.trace_id.hex() == TRACE}
    request = ours["POST /processes/{process}/execution"]
    assert request.parent_span_id.hex() == "b7ad6b7169203331"
    assert ours["work sweep"].parent_span_id == request.span_id
    assert ours["block"].parent_span_id == ours["work sweep"].span_id
    assert len(ours) == 3
    assert not [body for _, body in receiver.received if b"secret" in body]


def test_nothing_is_imported_unless_it_is_asked_for():
    code = (
        "import sys; from vibrafeed.app.main import create_app; "
        "from vibrafeed.app.settings import Settings; "
        "create_app(Settings()); parts = ('opentelemetry.sdk', 'opentelemetry.exporter'); "
        "print([name for name in sys.modules if name.startswith(parts)])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_what_is_not_installed_is_told(monkeypatch):
    wanted = {"OTEL_EXPORTER_OTLP_ENDPOINT": "somewhere"}
    assert traces.fault({}) is None
    assert traces.fault(wanted) is None
    monkeypatch.setitem(sys.modules, "opentelemetry.exporter.otlp.proto.http", None)
    assert "extra" in traces.fault(wanted)
    assert traces.configured(wanted) is None
