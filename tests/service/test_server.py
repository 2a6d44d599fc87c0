"""The server's process: how it is set up, how it starts and how it ends."""

from __future__ import annotations

import contextlib
import hashlib
import http.client
import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from access import BEARER, HASH, KEY, give_key
from benchmarks.serving import free_port
from local_client import local_client
from vibrafeed import core
from vibrafeed.app.cli import app as commands
from vibrafeed.app.jobs.manifest import NETCDF, Manifest
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from waiting import PATIENCE, SELDOM, wait_for

ROOT = Path(__file__).parents[4]
STUDY: dict[str, Any] = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["throw_number"],
    "parameters": {"frequency": 50, "amplitude": "0.5 mm", "beta": [0, 10, 20, 30, 40, 50, 60]},
}


def problem(response: Any, status: int, kind: str) -> dict[str, Any]:
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    document = response.json()
    assert document["type"] == f"urn:vibrafeed:problem:{kind}"
    assert document["status"] == status
    return document


SERVE = "from vibrafeed.app.cli import main; main()"  # as `vibrafeed` does, from this source tree


@contextmanager
def server(
    folder: Path, *arguments: str, code: str = SERVE, **environment: str
) -> Iterator[tuple[subprocess.Popen[bytes], int, Path]]:
    """Run `vibrafeed serve` until it answers; yield its process, its port and its log."""
    port = free_port()
    log = folder / "log"
    with log.open("wb") as stream:
        process = subprocess.Popen(
            [sys.executable, "-c", code, "serve", *arguments, "--port", str(port)],
            cwd=ROOT,
            env={**os.environ, "VIBRAFEED_DATA_DIRECTORY": str(folder / "data"), **environment},
            stdout=stream,
            stderr=stream,
        )
    try:

        def listens() -> bool:
            assert process.poll() is None, log.read_text()
            with contextlib.suppress(OSError):
                socket.create_connection(("127.0.0.1", port), 1).close()
                return True
            return False

        wait_for(listens, log.read_text)
        yield process, port, log
    finally:
        process.kill()
        process.wait(PATIENCE)


def is_warm(port: int) -> bool:
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/readyz", timeout=PATIENCE) as reply:
        return json.load(reply)["warm"]


def test_a_service_says_when_all_is_compiled(tmp_path):
    with server(tmp_path, VIBRAFEED_WARM_AT_START="true") as (_, port, _log):
        wait_for(lambda: is_warm(port), every=SELDOM)


@pytest.mark.night
def test_a_service_that_stops_compiles_no_more(tmp_path):
    cache = tmp_path / "empty"
    settings = {"VIBRAFEED_WARM_AT_START": "true", "NUMBA_CACHE_DIR": str(cache)}
    with server(tmp_path, **settings) as (process, port, _):
        wait_for(lambda: list(cache.glob("*/*.nbi")))  # it compiles
        assert not is_warm(port)
        process.terminate()
        process.wait(PATIENCE)
    compiled = sorted(cache.rglob("*.nbc"))
    # A process that imports notices the end of its parent a moment later.
    wait_for(lambda: not processes_with(str(cache)))
    assert sorted(cache.rglob("*.nbc")) == compiled, "somebody still compiled"


def processes_with(text: str) -> list[Path]:
    """Return the processes that have a text in their environment."""
    found = []
    for environment in Path("/proc").glob("[0-9]*/environ"):
        with contextlib.suppress(OSError):
            if text.encode() in environment.read_bytes():
                found.append(environment)
    return found


def test_the_service_refuses_to_open_itself_without_keys(tmp_path, monkeypatch):
    monkeypatch.setenv("VIBRAFEED_DATA_DIRECTORY", str(tmp_path))  # whoever runs it may have keys
    for host in ("0.0.0.0", "::", "lab.example"):
        result = CliRunner().invoke(commands, ["serve", "--host", host])
        assert result.exit_code == 2
        assert "vibrafeed key add" in result.output


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_a_server_with_keys_on_every_address_finishes_its_downloads(tmp_path):
    """The server as it is run: open to others, with a key; stopped during a download."""
    give_key(tmp_path / "data")
    with server(tmp_path, "--host", "0.0.0.0") as (process, port, log):
        plain = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE)
        plain.request("GET", "/scenes?key=" + KEY)
        refused = plain.getresponse()
        refused.read()
        assert refused.status == 401
        assert refused.getheader("server") is None
        assert refused.getheader("x-content-type-options") == "nosniff"
        # 50 MB are refused by their length; the answer is there although nothing was sent.
        plain.request("POST", "/sweeps", headers={**BEARER, "Content-Length": "50000000"})
        with plain.getresponse() as refused:
            assert refused.status == 413
            refused.read()
        plain.close()
        plain.request("POST", "/sweeps", json.dumps({**STUDY, "notes": "private"}), BEARER)
        key = json.loads(plain.getresponse().read())["id"]
        # A file that is there is sent as it is: far more than sockets hold.
        content = os.urandom(1 << 20) * 64
        stored(tmp_path, key, content)
        plain.request("GET", f"/sweeps/{key}/netcdf", headers=BEARER)
        download = plain.getresponse()
        received = download.read(1000)
        process.send_signal(signal.SIGTERM)
        time.sleep(0.5)
        assert process.poll() is None
        with pytest.raises(OSError, match="refused"):
            socket.create_connection(("127.0.0.1", port), 1)
        received += download.read()
        assert received == content
        plain.close()
        assert process.wait(PATIENCE) == 0
        text = log.read_text()
    lines = [json.loads(line) for line in text.splitlines()]
    assert sum(line["event"] == "request" for line in lines) == 4
    [warning] = [line["event"] for line in lines if line["level"] == "warning"]
    assert "--behind-proxy" in warning
    assert any("Uvicorn running" in line["event"] for line in lines)
    for secret in (KEY, HASH, "Bearer", "Authorization", "private", key):
        assert secret.lower() not in text.lower(), secret


def stored(tmp_path, key, content):
    """Give a study a result of any content."""
    folder = tmp_path / "data" / "studies" / key
    (folder / NETCDF).write_bytes(content)
    file = {"bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}
    manifest = Manifest(key, "sweep", core.__version__, 1, 1, 0.1, {NETCDF: file})
    (folder / "manifest.json").write_text(json.dumps(asdict(manifest)))


@pytest.mark.night
@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_a_download_that_nobody_reads_does_not_hold_the_server_for_ever(tmp_path):
    with server(tmp_path, VIBRAFEED_SHUTDOWN_SECONDS="1") as (process, port, log):
        client = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE)
        client.request("POST", "/sweeps", json.dumps(STUDY))
        key = json.loads(client.getresponse().read())["id"]
        stored(tmp_path, key, bytes(64 << 20))
        client.request("GET", f"/sweeps/{key}/netcdf")
        download = client.getresponse()
        download.read(1000)
        process.send_signal(signal.SIGTERM)
        process.wait(PATIENCE)
        assert '"cut_short": true' in log.read_text()
        download.close()
        client.close()


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


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_a_stream_without_end_comes_piece_by_piece_and_ends_when_the_service_stops(tmp_path):
    with server(tmp_path, code=ENDLESS) as (process, port, log):
        client = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE)
        client.request("GET", "/events")
        with client.getresponse() as stream:
            assert stream.read(5) == b"first"  # no layer waits for more
            process.send_signal(signal.SIGHUP)  # a terminal that is closed
            assert stream.read() == b"last"
        client.close()
        assert process.wait(PATIENCE) == 0
        assert "cut_short" not in log.read_text()


def test_only_a_proxy_is_believed_who_the_client_is(tmp_path):
    told = {"X-Forwarded-Proto": "https", "X-Forwarded-For": "192.0.2.7"}
    for option, scheme, client in (
        ([], "http", "127.0.0.1"),
        (["--behind-proxy"], "https", "192.0.2.7"),
    ):
        folder = tmp_path / scheme
        folder.mkdir()
        with server(folder, *option) as (_, port, log):
            request = urllib.request.Request(f"http://127.0.0.1:{port}/", headers=told)
            with urllib.request.urlopen(request, timeout=PATIENCE) as reply:
                [link, *_] = json.load(reply)["links"]
            assert link["href"].startswith(f"{scheme}://")
            line = f'"client": "{client}"'
            wait_for(lambda log=log, line=line: line in log.read_text())


def test_a_signal_tells_the_app_before_connections_are_waited_for(tmp_path, monkeypatch):
    import uvicorn

    from vibrafeed.app.web import server as module

    monkeypatch.setattr(module, "_after", lambda seconds, call: None)  # it would end this process
    app = create_app(Settings(data_directory=tmp_path))
    server = module.Server(uvicorn.Config(app, log_config=None))
    assert not app.state.stopping.is_set()
    server.handle_exit(signal.SIGTERM, None)
    assert app.state.stopping.is_set()
    assert server.should_exit
    problem(local_client(app).get("/readyz"), 503, "not-ready")
