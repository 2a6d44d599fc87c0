"""A server of its own for a benchmark: `vibrafeed serve` on a free port and an empty directory."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import tempfile
import time
import urllib.parse
import urllib.request
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from http.client import HTTPConnection, HTTPMessage
from pathlib import Path
from typing import Any, NamedTuple

from vibrafeed.app.jobs.manifest import MANIFEST, NETCDF, fingerprint
from vibrafeed.app.jobs.store import Store

PATIENCE = 240.0  # s for a server to start: others may load the machine


class Reply(NamedTuple):
    """A reply: its status, its headers, its body."""

    status: int
    headers: HTTPMessage
    body: bytes


@dataclass(frozen=True)
class Served:
    """A running server: its address, its process, its data directory."""

    address: str
    pid: int
    data: Path
    log: Path

    @property
    def place(self) -> tuple[str, int]:
        """The host and port of the server."""
        parts = urllib.parse.urlsplit(self.address)
        return str(parts.hostname), int(parts.port or 0)

    def get(self, path: str) -> Any:
        """Return the JSON document at a path."""
        with urllib.request.urlopen(f"{self.address}{path}", timeout=60) as reply:
            return json.load(reply)

    def post(self, path: str, content: Any, **headers: str) -> Any:
        """Return the JSON reply to a posted JSON document."""
        request = urllib.request.Request(
            f"{self.address}{path}",
            json.dumps(content).encode(),
            {"Content-Type": "application/json", **headers},
        )
        with urllib.request.urlopen(request, timeout=60) as reply:
            return json.load(reply)

    def post_job(self, process: str, study: Any) -> str:
        """Return the number of the job that carries out a study."""
        path = f"/processes/{process}/execution"
        return str(self.post(path, study, Prefer="respond-async")["jobID"])

    def ask(
        self, method: str, path: str, content: Any = None, *, source: str = "",
        timeout: float = 60, **headers: str,
    ) -> Reply:  # fmt: skip
        """Return the reply, whatever its status, on a connection of its own.

        `source` is another address of this machine from which to ask: another owner's.
        """
        start = (source, 0) if source else None
        body = None if content is None else json.dumps(content).encode()
        with closing(HTTPConnection(*self.place, timeout=timeout, source_address=start)) as client:
            client.request(method, path, body, headers)
            reply = client.getresponse()
            return Reply(reply.status, reply.headers, reply.read())

    def file_of(self, study: Any, size: int) -> str:
        """Return the path of a download of `size` random bytes, put in place of a result."""
        key = self.post("/sweeps", study)["id"]
        path = f"/sweeps/{key}/netcdf"
        self.ask("GET", path)
        folder = Store(self.data).folder(key)
        block = os.urandom(1 << 20)
        with (folder / NETCDF).open("wb") as file:
            for start in range(0, size, len(block)):
                file.write(block[: size - start])
        manifest = json.loads((folder / MANIFEST).read_text())
        manifest["files"][NETCDF] = fingerprint(folder / NETCDF)
        (folder / MANIFEST).write_text(json.dumps(manifest))
        return path

    def memory(self) -> int:
        """Return the resident memory of the server without its workers [bytes]."""
        fields = Path(f"/proc/{self.pid}/statm").read_text().split()
        return int(fields[1]) * os.sysconf("SC_PAGE_SIZE")


def free_port() -> int:
    """Return a free port of this machine."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        return int(probe.getsockname()[1])


SERVE = """
try:
    from vibrafeed.app.cli import main
except ModuleNotFoundError:  # of an older tree
    from app.cli import main
main()
"""


@contextmanager
def served(tree: Path | None = None, **settings: object) -> Iterator[Served]:
    """Yield a running server with some settings, and stop it afterwards.

    `tree` is another source tree whose server it is; None is this one.
    """
    port = free_port()
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "data"
        given = {"data_directory": data, **settings}
        environment = {f"VIBRAFEED_{name.upper()}": str(value) for name, value in given.items()}
        if tree is not None:
            environment["PYTHONPATH"] = str(tree)
        command = [sys.executable, "-c", SERVE, "serve"]
        path = Path(folder) / "log"
        with path.open("wb") as log:
            process = subprocess.Popen(
                [*command, "--port", str(port)],
                cwd=tree,
                stderr=log,
                env={**os.environ, **environment},
            )
            try:
                found = Served(f"http://127.0.0.1:{port}", process.pid, data, path)
                _wait_for(found)
                yield found
            finally:
                process.terminate()
                process.wait(60)


def _wait_for(server: Served) -> None:
    """Wait until the server answers."""
    until = time.monotonic() + PATIENCE
    while True:
        try:
            server.get("/healthz")
        except OSError:
            if time.monotonic() > until:
                raise
            time.sleep(0.05)
        else:
            return


def percentile(values: list[float], share: float) -> float:
    """Return the value below which a share of the values lies."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else float("nan")
