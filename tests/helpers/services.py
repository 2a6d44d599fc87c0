"""A service of one's own, run as users run it; and what is said where a tool is not there."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn

import pytest

ROOT = Path(__file__).parents[2]
REQUIRED = "VIBRAFEED_REQUIRE_TOOLS"


def absent(reason: str) -> NoReturn:
    """Skip, or fail where the tools must be there."""
    if os.environ.get(REQUIRED) == "1":
        pytest.fail(f"{reason}, and {REQUIRED}=1 asks for it")
    pytest.skip(reason)


class Service:
    """`vibrafeed serve` on a folder; it can be killed and started again, on the same port."""

    def __init__(self, folder: Path, **settings: Any):
        self.folder = folder
        with socket.create_server(("127.0.0.1", 0)) as free:
            self.port = free.getsockname()[1]
        self.address = f"http://127.0.0.1:{self.port}"
        self._environment = {**os.environ, "VIBRAFEED_DATA_DIRECTORY": str(folder / "data")}
        for name, value in settings.items():
            self._environment[f"VIBRAFEED_{name.upper()}"] = str(value)
        self.process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        serve = "from app.cli import main; main()"  # as `vibrafeed` does, from this source tree
        command = [sys.executable, "-c", serve, "serve", "--port", str(self.port)]
        log = self.folder / "log"
        with log.open("ab") as file:
            self.process = subprocess.Popen(
                command, cwd=ROOT, env=self._environment, stdout=file, stderr=file
            )
        for _ in range(300):
            try:
                urllib.request.urlopen(f"{self.address}/healthz", timeout=1).close()
                return
            except OSError:
                assert self.process.poll() is None, log.read_text()
                time.sleep(0.1)
        pytest.fail("the service does not answer\n" + log.read_text())

    def kill(self) -> None:
        """Kill it, as a power cut would."""
        assert self.process is not None
        self.process.kill()
        self.process.wait(20)

    def stop(self) -> None:
        assert self.process is not None
        self.process.terminate()
        self.process.wait(20)


@contextmanager
def services(folders: pytest.TempPathFactory) -> Iterator[Callable[..., Service]]:
    """Yield a function that starts a service with settings; all of them stop in the end."""
    started: list[Service] = []

    def start(**settings: Any) -> Service:
        service = Service(folders.mktemp("service"), **settings)
        started.append(service)
        service.start()
        return service

    try:
        yield start
    finally:
        for service in started:
            service.stop()
