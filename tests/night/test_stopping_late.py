"""A server that is told to stop, and has reasons not to."""

import http.client
import json
import signal

import psutil

from benchmarks.serving import served
from services import serving, wait_for_end
from waiting import PATIENCE, wait_for

STUCK = """
import asyncio, sys
from vibrafeed.app import logs
from vibrafeed.app.jobs.runner import Runner
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.app.web import server

async def stop(self):
    await asyncio.sleep(3600)

Runner.stop = stop
server.LAST = 1.0
logs.configure()
settings = Settings(shutdown_seconds=1)
server.serve_until_stopped(create_app(settings), settings, "127.0.0.1", int(sys.argv[-1]))
"""
STUDY = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["throw_number"],
    "parameters": {"frequency": 50, "amplitude": "0.5 mm", "beta": [0, 10, 20]},
}


def test_what_hangs_is_cut_short(tmp_path):
    with serving(tmp_path, code=STUCK) as server:
        server.ask("/healthz")
        server.process.terminate()
        assert server.process.wait(PATIENCE) == 0
        assert "is cut short" in server.log.read_text()


def test_a_download_that_nobody_reads_does_not_hold_the_server_for_ever():
    with served(shutdown_seconds=1) as server:
        path = server.file_of(STUDY, 64 << 20)
        client = http.client.HTTPConnection(*server.place, timeout=PATIENCE)
        client.request("GET", path)
        download = client.getresponse()
        download.read(1000)
        process = psutil.Process(server.pid)
        process.send_signal(signal.SIGTERM)
        wait_for_end([process])
        lines = [json.loads(line) for line in server.log.read_text().splitlines()]
        assert any(line.get("cut_short") for line in lines)
        client.close()


def test_a_service_that_stops_compiles_no_more(tmp_path, monkeypatch):
    cache = tmp_path / "empty"
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(cache))
    with serving(tmp_path, warm_at_start=True) as server:
        wait_for(lambda: list(cache.glob("*/*.nbi")))  # it compiles
        assert not server.get("/readyz")["warm"]
        workers = server.workers()
        server.process.terminate()
        server.process.wait(PATIENCE)
    compiled = sorted(cache.rglob("*.nbc"))
    # A process that imports notices the end of its parent a moment later.
    wait_for_end(workers)
    assert sorted(cache.rglob("*.nbc")) == compiled, "somebody still compiled"
