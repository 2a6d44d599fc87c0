"""What docs/operations.md tells is carried out: proxy, backup and restore, upgrade, container."""

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
import urllib.parse
import urllib.request
from pathlib import Path

import pytest
import yaml
from dockerfile_parse import DockerfileParser

from benchmarks.serving import free_port
from tools import tool
from waiting import PATIENCE, wait_for

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "operations.md").read_text(encoding="utf-8")
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


def ask(address, path="", study=None, context=None):
    body = None if study is None else json.dumps(study).encode()
    request = urllib.request.Request(address + path, body, {"Prefer": "respond-async"})
    with urllib.request.urlopen(request, timeout=PATIENCE, context=context) as reply:
        content = reply.read()
    return json.loads(content) if "json" in reply.headers["content-type"] else content


@contextlib.contextmanager
def proxied(folder, service):
    """Run nginx with the page's server block; yield its address and the context of a client."""
    nginx, port = tool("nginx"), free_port()
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
    names = ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    temporary = "\n".join(f"{name}_temp_path {folder / name};" for name in names)
    configuration = folder / "nginx.conf"
    configuration.write_text(
        f"daemon off; pid {folder / 'pid'}; error_log {folder / 'errors'};\n"
        f"worker_rlimit_nofile 4096;\nevents {{ worker_connections 2048; }}\n"
        f"http {{ access_log off; {temporary}\n{block} }}\n"
    )
    process = subprocess.Popen([nginx, "-c", configuration, "-e", folder / "errors"])
    try:
        wait_for(lambda: (folder / "pid").exists() or process.poll() is not None)
        assert process.poll() is None
        yield f"https://localhost:{port}/vibrafeed", ssl.create_default_context(cafile=certificate)
    finally:
        process.terminate()
        process.wait(PATIENCE)


@pytest.fixture(scope="module")
def service(serve):
    """Return a service as it stands behind a proxy; by itself it is asked without the path."""
    return serve("--behind-proxy", root_path="/vibrafeed", workers=1)


def test_a_proxy_with_tls_and_a_path(service, tmp_path):
    with proxied(tmp_path, service) as (address, context):

        def get(place, study=None):
            return ask(urllib.parse.urljoin(f"{address}/docs", place), "", study, context)

        # Every link of the landing page, and of a job, leads through the proxy to what it names.
        number = get("processes/sweep/execution", SWEEP)["jobID"]
        assert service.finished(number)["status"] == "successful"
        for link in (*get(f"{address}/")["links"], *get(f"jobs/{number}")["links"]):
            assert link["href"].startswith(f"{address}/"), link
            assert get(link["href"])
        key = get("sweeps", SWEEP)["id"]
        assert get(f"sweeps/{key}")["id"] == key
        assert get("openapi.json")["servers"] == [{"url": "/vibrafeed"}]
        files = re.findall(r'(?:src|href)="([^"]+)"', get("docs").decode())
        assert files
        for file in files:
            assert get(file)
        assert b'"successful"' in get(f"jobs/{number}/events")
        request = urllib.request.Request(f"{address}/scenes", headers={"Accept-Encoding": "gzip"})
        with urllib.request.urlopen(request, timeout=PATIENCE, context=context) as reply:
            assert reply.headers["content-encoding"] == "gzip"
            assert json.loads(gzip.decompress(reply.read())) == get("scenes")
    # Without the proxy, too: a container's health check asks so.
    assert service.get("/healthz")["status"] == "ok"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="an address of its own")
def test_slow_clients_stay_at_the_proxy(service, tmp_path):
    """None of them reaches the service: of its requests under way, there is that of the test."""
    large = {"frequency": {"start": 10, "stop": 90, "num": 1000},
             "beta": {"start": 0, "stop": 90, "num": 1000}}  # fmt: skip
    large = {**SWEEP, "parameters": {**SWEEP["parameters"], **large}}
    key = json.loads(service.ask("/sweeps", large))["id"]
    slice_ = f"/vibrafeed/sweeps/{key}/slice?output=throw_number&axes=frequency,beta&format=binary"

    def under_way() -> float:
        figures = service.ask("/metrics").decode()
        return float(re.search(r"^vibrafeed_requests_under_way (.*)$", figures, re.M)[1])

    with proxied(tmp_path, service) as (address, context), contextlib.ExitStack() as stack:

        def begin(request: str, source: str = "127.0.0.1") -> ssl.SSLSocket:
            """Return a connection from an address of this machine, on which a text was sent."""
            plain = socket.socket()
            plain.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            plain.settimeout(PATIENCE)
            plain.bind((source, 0))
            plain.connect(("127.0.0.1", urllib.parse.urlsplit(address).port))
            client = context.wrap_socket(plain, server_hostname="localhost")
            stack.enter_context(contextlib.closing(client))
            client.sendall(request.replace("\n", "\r\n").encode())
            return client

        for _ in range(20):
            reader = begin(f"GET {slice_} HTTP/1.1\nHost: localhost\n\n")
            assert reader.recv(12) == b"HTTP/1.1 200"
        for _ in range(100):
            begin("GET /vibrafeed/scenes HTTP/1.1\nHost: loc")
        post = "POST /vibrafeed/sweeps HTTP/1.1\nHost: localhost\nContent-Length: 1000\n\n{"
        bodies = [begin(post) for _ in range(100)]
        wait_for(lambda: under_way() == 1)
        # One address has so many requests under way and no more; another is answered.
        assert begin(post).recv(12) == b"HTTP/1.1 429"
        assert not select.select(bodies[:50], [], [], 0)[0]  # those wait on
        plain = "GET /vibrafeed/healthz HTTP/1.1\nHost: localhost\nConnection: close\n\n"
        assert begin(plain, "127.0.0.2").recv(12) == b"HTTP/1.1 200"
        assert under_way() == 1


def shell(commands, data, backup):
    places = {**os.environ, "DATA": str(data), "BACKUP": str(backup)}
    subprocess.run(["sh", "-eu", "-c", commands], env=places, check=True, timeout=PATIENCE)


def test_backup_and_restore(service, tmp_path):
    for program in ("sqlite3", "rsync"):
        tool(program)
    backup, restore = blocks("sh", "Backup and restore")
    number = service.post(SWEEP)
    assert service.finished(number)["status"] == "successful"
    jobs, content = service.get("/jobs")["jobs"], service.dataset(number)
    assert number in [job["jobID"] for job in jobs]
    data = service.folder / "data"
    shell(backup, data, tmp_path / "backup")
    service.kill()
    shutil.rmtree(data)
    shell(restore, data, tmp_path / "backup")
    service.start()
    assert service.get("/jobs")["jobs"] == jobs
    assert service.dataset(number) == content
    assert service.job(service.post(SWEEP))["status"] == "successful"


def test_the_container_is_as_the_page_tells():
    structure = DockerfileParser(path=str(ROOT / "Dockerfile")).structure
    values = {entry["instruction"]: entry["value"] for entry in structure}
    [commands] = blocks("sh", "In a container")
    [compose] = blocks("yaml", "In a container")
    service = yaml.safe_load(compose)["services"]["vibrafeed"]
    volume, port = values["VOLUME"], values["EXPOSE"]
    assert f"-v vibrafeed:{volume} " in commands
    assert service["volumes"] == [f"vibrafeed:{volume}"]
    assert f"-p 127.0.0.1:{port}:{port} " in commands
    assert service["ports"] == [f"127.0.0.1:{port}:{port}"]
    assert f"user {values['USER']}" in PAGE


def test_alerts_are_on_metrics_that_are_there(service):
    figures = service.ask("/metrics").decode()
    described = set(re.findall(r"^# HELP (vibrafeed_\w+) \S", figures, re.M))
    assert len(described) > 10
    alerts = set(
        re.findall(r"`(vibrafeed_\w+)`", PAGE.partition("Alert on")[2].partition("\n\n")[0])
    )
    assert {name.removesuffix("_count") for name in alerts} <= described
