"""A server that is told to stop says so, ends in time, and hands its work on."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import urllib.error
import urllib.request
from pathlib import Path

import pytest

from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from waiting import PATIENCE, SELDOM, wait_for

IN_ALL = 10.0  # s, what containers give
SWEEP = {
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


def ask(service, path, study=None):
    """Return the JSON of a reply."""
    body = None if study is None else json.dumps(study).encode()
    headers = {"Prefer": "respond-async"}
    request = urllib.request.Request(service.address + path, body, headers)
    with urllib.request.urlopen(request, timeout=PATIENCE) as reply:
        return json.load(reply)


def descendants(parent):
    """Return the processes below one, by /proc."""
    found = []
    for path in Path(f"/proc/{parent}/task").glob("*/children"):
        for child in map(int, path.read_text().split()):
            found += [child, *descendants(child)]
    return found


def is_computing(process):
    """Return whether it is there and no zombie."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def asking(port, path, **options):
    """Return a connection that has asked, and reads nothing."""
    client = socket.socket()
    for name, value in options.items():
        client.setsockopt(socket.SOL_SOCKET, getattr(socket, name), value)
    client.settimeout(60)
    client.connect(("127.0.0.1", port))
    client.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
    return client


def test_all_of_it_ends_in_time_and_the_next_server_goes_on(serve, tmp_path):
    """Under load: workers compute, a stream of events is open, a reader reads nothing."""
    service = serve(lease_seconds=600, block_seconds=0.3, workers=2)
    number = ask(service, "/processes/simulate/execution", MOTION)["jobID"]
    wait_for(lambda: ask(service, f"/jobs/{number}")["cellsDone"] > 0)
    key = ask(service, "/sweeps", SWEEP)["id"]
    slice_ = f"/sweeps/{key}/slice?output=throw_number&axes=frequency,beta"
    with (
        asking(service.port, f"/jobs/{number}/events") as events,
        asking(service.port, slice_, SO_RCVBUF=4096) as deaf,
    ):
        assert events.recv(12) == b"HTTP/1.1 200"
        assert deaf.recv(12) == b"HTTP/1.1 200"
        workers = descendants(service.process.pid)
        assert len(workers) >= 2
        assert ask(service, f"/jobs/{number}")["status"] == "running"
        service.process.send_signal(signal.SIGTERM)
        service.process.wait(PATIENCE)
    # One that tracks their shared memory is no worker, and sees a little later that it is alone.
    wait_for(lambda: not [one for one in workers if is_computing(one)])
    log = (service.folder / "log").read_text()
    assert "is cut short" not in log
    service.start()
    wait_for(lambda: ask(service, f"/jobs/{number}")["status"] == "successful", every=SELDOM)
    with urllib.request.urlopen(f"{service.address}/jobs/{number}/results/dataset") as reply:
        content = reply.read()
    write_netcdf(tabulate(prepare_content(MOTION)), tmp_path / "whole.nc")
    assert content == (tmp_path / "whole.nc").read_bytes()


def test_draining_refuses_new_work_and_answers_the_rest(serve):
    service = serve(drain_seconds=600)
    key = ask(service, "/sweeps", SWEEP)["id"]
    service.process.send_signal(signal.SIGTERM)
    wait_for(lambda: is_stopping(service))
    for path, study in (("/sweeps", SWEEP), ("/processes/simulate/execution", MOTION)):
        with pytest.raises(urllib.error.HTTPError) as refused:
            ask(service, path, study)
        with refused.value as reply:
            assert (reply.code, bool(reply.headers["retry-after"])) == (503, True)
            assert json.load(reply)["type"] == "urn:vibrafeed:problem:stopping"
    assert ask(service, f"/sweeps/{key}")["id"] == key
    # A second signal is heeded at once.
    service.process.send_signal(signal.SIGTERM)
    assert service.process.wait(PATIENCE) == 0


def is_stopping(service):
    try:
        ask(service, "/readyz")
    except urllib.error.HTTPError as refused:
        with refused:
            return "it stops" in refused.read().decode()
    return False


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
server.serve_until_stopped(create_app(settings), settings, "127.0.0.1", int(sys.argv[1]))
"""


@pytest.mark.night
def test_what_hangs_is_cut_short(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    log = tmp_path / "log"
    with log.open("wb") as stream:
        process = subprocess.Popen(
            [sys.executable, "-c", STUCK, str(port)],
            env={**os.environ, "VIBRAFEED_DATA_DIRECTORY": str(tmp_path / "data")},
            stderr=stream,
            cwd=Path(__file__).parents[2],
        )
    try:
        wait_for(lambda: b"startup complete" in log.read_bytes() or process.poll() is not None)
        process.terminate()
        assert process.wait(PATIENCE) == 0
        assert "is cut short" in log.read_text()
    finally:
        process.kill()
        process.wait(PATIENCE)
