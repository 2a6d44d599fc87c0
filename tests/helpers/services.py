"""A service of one's own, run as users run it."""

from __future__ import annotations

import os
import subprocess
import sys
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from benchmarks.serving import free_port
from waiting import PATIENCE, wait_for

ROOT = Path(__file__).parents[2]


class Service:
    """`vibrafeed serve` on a folder; it can be killed and started again, on the same port."""

    def __init__(self, folder: Path, **settings: Any):
        self.folder = folder
        self.port = free_port()
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

        def answers() -> bool:
            assert self.process is not None
            assert self.process.poll() is None, log.read_text()
            try:
                urllib.request.urlopen(f"{self.address}/healthz", timeout=PATIENCE).close()
            except OSError:
                return False
            return True

        wait_for(answers, log.read_text)

    def kill(self) -> None:
        """Kill it, as a power cut would."""
        assert self.process is not None
        self.process.kill()
        self.process.wait(PATIENCE)

    def stop(self) -> None:
        assert self.process is not None
        self.process.terminate()
        self.process.wait(PATIENCE)


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
