"""What docs/operations.md tells is carried out: proxy, backup and restore, upgrade, container."""

from __future__ import annotations

import contextlib
import gzip
import json
import os
import re
import select
import shutil
import socket
import ssl
import subprocess
import sys
import tarfile
import urllib.parse
import urllib.request
from pathlib import Path

import pytest
import yaml
from dockerfile_parse import DockerfileParser

from benchmarks.serving import free_port
from tools import tool
from vibrafeed.core.code_version import code_version
from waiting import PATIENCE, SELDOM, wait_for

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "operations.md").read_text(encoding="utf-8")
OLD = ROOT / "tests" / "data" / "data-of-e09fcfb.tar.gz"
SWEEP = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["throw_number"],
    "parameters": {"frequency": 50, "amplitude": "0.5 mm", "beta": [0, 10, 20, 30]},
}


def blocks(language: str, section: str) -> list[str]:
    """Return the blocks of code of a section of the page."""
    text = re.split(r"^## ", PAGE.split(f"\n## {section}\n", 1)[1], maxsplit=1, flags=re.M)[0]
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.M | re.S)


def ask(address, path, study=None, context=None):
    body = None if study is None else json.dumps(study).encode()
    request = urllib.request.Request(address + path, body, {"Prefer": "respond-async"})
    with urllib.request.urlopen(request, timeout=PATIENCE, context=context) as reply:
        content = reply.read()
    return json.loads(content) if "json" in reply.headers["content-type"] else content


def finished(address, number, context=None):
    def ended():
        job = ask(address, f"/jobs/{number}", context=context)
        return job["status"] not in ("accepted", "running") and job

    return wait_for(ended, every=SELDOM)


@contextlib.contextmanager
def proxied(nginx, folder, service):
    """Run nginx with the page's server block; yield its port and its certificate."""
    port = free_port()
    certificate, key = folder / "vibrafeed.pem", folder / "vibrafeed.key"
    subprocess.run(
        [tool("openssl"), "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj",
         "/CN=localhost", "-addext", "subjectAltName=DNS:localhost", "-keyout", key, "-out",
         certificate],
        check=True, capture_output=True,
    )  # fmt: skip
    [block] = blocks("nginx", "Proxy, TLS, sub-path")
    for old, new in (
        ("listen 443 ssl", f"listen 127.0.0.1:{port} ssl"),
        ("/etc/ssl/vibrafeed.pem", str(certificate)),
        ("/etc/ssl/vibrafeed.key", str(key)),
        ("127.0.0.1:8000", f"127.0.0.1:{service.port}"),
    ):
        assert block.count(old) == 1
        block = block.replace(old, new)
    temporary = "\n".join(
        f"{name}_temp_path {folder / name};"
        for name in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    )
    configuration = folder / "nginx.conf"
    configuration.write_text(
        f"daemon off; pid {folder / 'pid'}; error_log {folder / 'errors'};\n"
        f"worker_rlimit_nofile 4096;\nevents {{ worker_connections 2048; }}\n"
        f"http {{ access_log off; {temporary}\n{block} }}\n"
    )
    process = subprocess.Popen([nginx, "-c", configuration, "-e", folder / "errors"])
    try:

        def answers():
            assert process.poll() is None
            with contextlib.suppress(OSError):
                socket.create_connection(("127.0.0.1", port), 1).close()
                return True
            return False

        wait_for(answers)
        yield f"https://localhost:{port}/vibrafeed", ssl.create_default_context(cafile=certificate)
    finally:
        process.terminate()
        process.wait(PATIENCE)


@pytest.fixture(scope="module")
def service(serve):
    """Return a service as it stands behind a proxy; by itself it is asked without the path."""
    return serve("--behind-proxy", root_path="/vibrafeed", workers=1)


def test_a_proxy_with_tls_and_a_path(service, tmp_path):
    nginx = tool("nginx")
    tool("openssl")
    with proxied(nginx, tmp_path, service) as (address, context):
        # Every link of the landing page, and of a job, leads through the proxy to what it names.
        links = ask(address, "/", context=context)["links"]
        number = ask(address, "/processes/sweep/execution", SWEEP, context)["jobID"]
        job = finished(address, number, context)
        assert job["status"] == "successful"
        for link in (*links, *job["links"]):
            assert link["href"].startswith(f"{address}/"), link
            assert ask(link["href"], "", context=context)
        request = urllib.request.Request(f"{address}/sweeps", json.dumps(SWEEP).encode())
        with urllib.request.urlopen(request, timeout=PATIENCE, context=context) as reply:
            location = reply.headers["location"]
        assert ask(urllib.parse.urljoin(f"{address}/sweeps", location), "", context=context)["id"]
        document = ask(address, "/openapi.json", context=context)
        assert document["servers"] == [{"url": "/vibrafeed"}]
        page = ask(address, "/docs", context=context).decode()
        files = re.findall(r'(?:src|href)="([^"]+)"', page)
        assert files
        for file in files:
            place = urllib.parse.urljoin(f"{address}/docs", file)
            assert place.startswith(f"{address}/")
            assert ask(place, "", context=context)
        events = ask(address, f"/jobs/{number}/events", context=context)
        assert b'"successful"' in events
    # Without the proxy, too: a container's health check asks so.
    assert ask(service.address, "/healthz")["status"] == "ok"


class Slow:
    """Clients that begin a request over TLS, and neither finish it nor read the reply."""

    def __init__(self, address: str, context: ssl.SSLContext, stack: contextlib.ExitStack):
        self._port, self._context, self._stack = urllib.parse.urlsplit(address).port, context, stack

    def begin(self, request: str, source: str = "127.0.0.1") -> ssl.SSLSocket:
        """Return a connection from an address of this machine, on which a text has been sent."""
        plain = socket.socket()
        plain.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        plain.settimeout(PATIENCE)
        plain.bind((source, 0))
        plain.connect(("127.0.0.1", self._port))
        client = self._context.wrap_socket(plain, server_hostname="localhost")
        self._stack.enter_context(contextlib.closing(client))
        client.sendall(request.replace("\n", "\r\n").encode())
        return client


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="an address of its own")
def test_slow_clients_stay_at_the_proxy(service, tmp_path):
    """None of them reaches the service: of its requests under way, there is that of the test."""
    nginx = tool("nginx")
    tool("openssl")
    large = {
        **SWEEP,
        "parameters": {
            **SWEEP["parameters"],
            "frequency": {"start": 10, "stop": 90, "num": 1000},
            "beta": {"start": 0, "stop": 90, "num": 1000},
        },
    }
    key = ask(service.address, "/sweeps", large)["id"]
    slice_ = f"/vibrafeed/sweeps/{key}/slice?output=throw_number&axes=frequency,beta&format=binary"

    def under_way() -> float:
        figures = ask(service.address, "/metrics").decode()
        return float(re.search(r"^vibrafeed_requests_under_way (.*)$", figures, re.M)[1])

    with proxied(nginx, tmp_path, service) as (address, context), contextlib.ExitStack() as stack:
        slow = Slow(address, context, stack)
        readers = [slow.begin(f"GET {slice_} HTTP/1.1\nHost: localhost\n\n") for _ in range(20)]
        for reader in readers:
            assert reader.recv(12) == b"HTTP/1.1 200"
        for _ in range(100):
            slow.begin("GET /vibrafeed/scenes HTTP/1.1\nHost: loc")
        post = "POST /vibrafeed/sweeps HTTP/1.1\nHost: localhost\nContent-Length: 1000\n\n{"
        bodies = [slow.begin(post) for _ in range(100)]
        wait_for(lambda: under_way() == 1)
        # One address has so many requests under way and no more; another is answered.
        refused = slow.begin(post)
        assert refused.recv(12) == b"HTTP/1.1 429"
        assert not select.select(bodies[:50], [], [], 0)[0]  # those wait on
        plain = "GET /vibrafeed/healthz HTTP/1.1\nHost: localhost\nConnection: close\n\n"
        for _ in range(20):
            assert slow.begin(plain, "127.0.0.2").recv(12) == b"HTTP/1.1 200"
        assert under_way() == 1


def test_the_proxy_compresses(service, tmp_path):
    nginx = tool("nginx")
    tool("openssl")
    with proxied(nginx, tmp_path, service) as (address, context):
        request = urllib.request.Request(f"{address}/scenes", headers={"Accept-Encoding": "gzip"})
        with urllib.request.urlopen(request, timeout=PATIENCE, context=context) as reply:
            assert reply.headers["content-encoding"] == "gzip"
            scenes = json.loads(gzip.decompress(reply.read()))
        assert scenes == ask(address, "/scenes", context=context)


def shell(commands, **variables):
    environment = {**os.environ, **{name: str(value) for name, value in variables.items()}}
    subprocess.run(["sh", "-eu", "-c", commands], env=environment, check=True, timeout=PATIENCE)


def test_backup_and_restore(service, tmp_path):
    for program in ("sqlite3", "rsync"):
        tool(program)
    backup, restore = blocks("sh", "Backup and restore")
    number = ask(service.address, "/processes/sweep/execution", SWEEP)["jobID"]
    assert finished(service.address, number)["status"] == "successful"
    jobs = ask(service.address, "/jobs")["jobs"]
    assert number in [job["jobID"] for job in jobs]
    content = ask(service.address, f"/jobs/{number}/results/dataset")
    data = service.folder / "data"
    shell(backup, DATA=data, BACKUP=tmp_path / "backup")
    service.kill()
    shutil.rmtree(data)
    shell(restore, DATA=data, BACKUP=tmp_path / "backup")
    service.start()
    assert ask(service.address, "/jobs")["jobs"] == jobs
    assert ask(service.address, f"/jobs/{number}/results/dataset") == content
    assert ask(service.address, "/processes/sweep/execution", SWEEP)["status"] == "successful"


@pytest.mark.night
def test_data_of_an_earlier_commit_are_served_and_its_work_goes_on(serve):
    service = serve(workers=1, retention_days=1_000_000)
    service.stop()
    data = service.folder / "data"
    shutil.rmtree(data)
    with tarfile.open(OLD) as archive:
        archive.extractall(service.folder, filter="data")
    results = {path.parent.name: path.read_bytes() for path in data.rglob("result.nc")}
    service.start()
    jobs = {job["processID"]: job for job in ask(service.address, "/jobs")["jobs"]}
    assert set(jobs) == {"sweep", "simulate"}
    done = jobs["sweep"]
    assert done["status"] == "successful"
    dataset = ask(service.address, f"/jobs/{done['jobID']}/results/dataset")
    assert dataset == results[done["study"]]
    about = ask(service.address, f"/jobs/{done['jobID']}/results")["dataset"]
    assert about["version"] == "0.1.0"
    waited = finished(service.address, jobs["simulate"]["jobID"])
    assert waited["status"] == "successful", waited
    about = ask(service.address, f"/jobs/{waited['jobID']}/results")["dataset"]
    assert about["version"] == code_version()


def test_the_container_is_as_the_page_tells():
    values = {
        entry["instruction"]: entry["value"]
        for entry in DockerfileParser(path=str(ROOT / "Dockerfile")).structure
    }
    [commands] = blocks("sh", "In a container")
    [compose] = blocks("yaml", "In a container")
    service = yaml.safe_load(compose)["services"]["vibrafeed"]
    volume, port = values["VOLUME"], values["EXPOSE"]
    assert f"-v vibrafeed:{volume} " in commands
    assert service["volumes"] == [f"vibrafeed:{volume}"]
    assert f"-p 127.0.0.1:{port}:{port} " in commands
    assert service["ports"] == [f"127.0.0.1:{port}:{port}"]
    assert f"user {values['USER']}" in PAGE


def test_every_metric_is_told(service):
    found = set(
        re.findall(r"^# TYPE (vibrafeed_\w+)", ask(service.address, "/metrics").decode(), re.M)
    )
    assert len(found) > 10
    assert not {name for name in found if name.removesuffix("_created") not in PAGE}
