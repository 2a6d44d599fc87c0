"""The server's process: how it starts, how it is told to stop, and how it ends."""

import contextlib
import hashlib
import http.client
import json
import os
import signal
import socket
import urllib.request
from dataclasses import asdict
from pathlib import Path
from typing import Any

from access import BEARER, HASH, KEY, give_key
from services import refusal, serving, wait_for_end
from vibrafeed import core
from vibrafeed.app.jobs.manifest import NETCDF, Manifest
from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from waiting import PATIENCE, SELDOM, wait_for

SWEEP: dict[str, Any] = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["throw_number"],
    "parameters": {
        "frequency": {"start": 1, "stop": 100, "num": 1000},
        "amplitude": "0.5 mm",
        "beta": {"start": 1, "stop": 60, "num": 1000},
    },
}
MOTION = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity", "flight_fraction"],
    "parameters": {
        "frequency": 40,
        "amplitude": {"start": "0.05 mm", "stop": "0.75 mm", "num": 151},
        "beta": {"start": 5, "stop": 60, "num": 151},
        "friction": 0.4,
        "restitution": 0.3,
    },
}
ENDLESS = """
import asyncio, sys
from fastapi.responses import StreamingResponse
from vibrafeed.app import logs
from vibrafeed.app.main import create_app
from vibrafeed.app.web.server import serve_until_stopped
from vibrafeed.app.settings import Settings

settings = Settings(shutdown_seconds=3600)
app = create_app(settings)

async def events():
    yield b"first"
    while not app.state.stopping.is_set():
        await asyncio.sleep(0.05)
    yield b"last"

app.add_api_route("/events", lambda: StreamingResponse(events()))
logs.configure()
serve_until_stopped(app, settings, "127.0.0.1", int(sys.argv[-1]))
"""


def refuses(port: int) -> bool:
    """Return whether nobody listens any more."""
    with contextlib.suppress(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", port), PATIENCE).close()
        return False
    return True


def stored(folder: Path, key: str, content: bytes) -> None:
    """Give a study a result of any content."""
    place = folder / "data" / "studies" / key
    (place / NETCDF).write_bytes(content)
    file = {"bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}
    manifest = Manifest(key, "sweep", core.__version__, 1, 1, 0.1, {NETCDF: file})
    (place / "manifest.json").write_text(json.dumps(asdict(manifest)))


def test_a_service_says_when_all_is_compiled(serve):
    service = serve(warm_at_start=True)
    wait_for(lambda: service.get("/readyz")["warm"], every=SELDOM)


def test_a_server_with_keys_on_every_address_finishes_its_downloads(tmp_path):
    """The server as it is run: open to others, with a key; stopped during a download."""
    give_key(tmp_path / "data")
    with serving(tmp_path, "--host", "0.0.0.0") as server:
        server.ask("/healthz")
        plain = http.client.HTTPConnection("127.0.0.1", server.port, timeout=PATIENCE)
        plain.request("GET", "/scenes?key=" + KEY)
        with plain.getresponse() as refused:
            assert refused.status == 401
            assert refused.getheader("server") is None
            assert refused.getheader("x-content-type-options") == "nosniff"
            refused.read()
        # 50 MB are refused by their length; the answer is there although nothing was sent.
        plain.request("POST", "/sweeps", headers={**BEARER, "Content-Length": "50000000"})
        with plain.getresponse() as refused:
            assert refused.status == 413
            refused.read()
        plain.close()
        study = {**SWEEP, "notes": "private"}
        key = json.loads(server.ask("/sweeps", study, headers=BEARER.items()))["id"]
        # A file that is there is sent as it is: far more than sockets hold.
        content = os.urandom(1 << 20) * 64
        stored(tmp_path, key, content)
        plain.request("GET", f"/sweeps/{key}/netcdf", headers=BEARER)
        download = plain.getresponse()
        received = download.read(1000)
        server.process.send_signal(signal.SIGTERM)
        wait_for(lambda: refuses(server.port))
        assert server.process.poll() is None
        received += download.read()
        assert received == content
        plain.close()
        assert server.process.wait(PATIENCE) == 0
    text = server.log.read_text()
    lines = [json.loads(line) for line in text.splitlines()]
    asked = [line for line in lines if line["event"] == "request"]
    assert len([line for line in asked if "healthz" not in str(line["route"])]) == 4
    [warning] = [line["event"] for line in lines if line["level"] == "warning"]
    assert "--behind-proxy" in warning
    for secret in (KEY, HASH, "Bearer", "Authorization", "private", key):
        assert secret.lower() not in text.lower(), secret


def test_a_stream_without_end_comes_piece_by_piece_and_ends_when_the_service_stops(tmp_path):
    with serving(tmp_path, code=ENDLESS) as server:
        server.ask("/healthz")
        with urllib.request.urlopen(f"{server.address}/events", timeout=PATIENCE) as stream:
            assert stream.read(5) == b"first"  # no layer waits for more
            # A terminal that is closed; `nohup` keeps it from all that it starts.
            ignored = signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
            server.process.send_signal(signal.SIGTERM if ignored else signal.SIGHUP)
            assert stream.read() == b"last"
        assert server.process.wait(PATIENCE) == 0
        assert "cut_short" not in server.log.read_text()


def test_only_a_proxy_is_believed_who_the_client_is(serve):
    told = {"X-Forwarded-Proto": "https", "X-Forwarded-For": "192.0.2.7"}
    for options, scheme, client in (
        ([], "http", "127.0.0.1"),
        (["--behind-proxy"], "https", "192.0.2.7"),
    ):
        service = serve(*options)
        [link, *_] = json.loads(service.ask("/", headers=told.items()))["links"]
        assert link["href"].startswith(f"{scheme}://")
        line = f'"client": "{client}"'
        wait_for(lambda log=service.log, line=line: line in log.read_text())


def asking(port: int, path: str, buffer: int = 1 << 16) -> socket.socket:
    """Return a connection that has asked, and reads the head of the reply only."""
    client = socket.socket()
    client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer)
    client.settimeout(PATIENCE)
    client.connect(("127.0.0.1", port))
    client.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
    assert client.recv(12) == b"HTTP/1.1 200"
    return client


def test_all_of_it_ends_in_time_and_the_next_server_goes_on(serve, tmp_path):
    """Under load: workers compute, a stream of events is open, a reader reads nothing."""
    service = serve(lease_seconds=600, block_seconds=0.3, workers=2)
    number = service.post(MOTION)
    service.begun(number)
    key = json.loads(service.ask("/sweeps", SWEEP))["id"]
    slice_ = f"/sweeps/{key}/slice?output=throw_number&axes=frequency,beta"
    with asking(service.port, f"/jobs/{number}/events"), asking(service.port, slice_, 4096):
        workers = service.workers()
        assert len(workers) >= 2
        assert service.job(number)["status"] == "running"
        service.process.send_signal(signal.SIGTERM)
        service.process.wait(PATIENCE)
    # One that tracks their shared memory is no worker, and sees a little later that it is alone.
    wait_for_end(workers)
    assert "is cut short" not in service.log.read_text()
    service.start()
    assert service.finished(number)["status"] == "successful"
    write_netcdf(tabulate(prepare_content(MOTION)), tmp_path / "whole.nc")
    assert service.dataset(number) == (tmp_path / "whole.nc").read_bytes()


def test_draining_refuses_new_work_and_answers_the_rest(serve):
    service = serve(drain_seconds=600)
    key = json.loads(service.ask("/sweeps", SWEEP))["id"]
    service.process.send_signal(signal.SIGTERM)
    wait_for(lambda: "is stopping" in str(refusal(lambda: service.ask("/readyz"), 503)))
    for ask in (lambda: service.ask("/sweeps", SWEEP), lambda: service.post(MOTION)):
        refusal(ask, 503, "problem:stopping")
    assert service.get(f"/sweeps/{key}")["id"] == key
    # A second signal is heeded at once.
    service.process.send_signal(signal.SIGTERM)
    assert service.process.wait(PATIENCE) == 0
