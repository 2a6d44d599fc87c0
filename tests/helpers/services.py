"""A service of one's own, run as users run it."""

import json
import os
import subprocess
import sys
import urllib.error
import urllib.request
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from http import HTTPStatus
from pathlib import Path
from typing import Any

import psutil
import pytest

from benchmarks.serving import free_port
from waiting import EVERY, PATIENCE, SELDOM, wait_for

ROOT = Path(__file__).parents[2]
SERVE = "from vibrafeed.app.cli import main; main()"  # as `vibrafeed` does, from here

QUICK = {"lease_seconds": 3, "block_seconds": 0.3}
"""Settings with which work that was left behind is soon taken up again."""


class Service:
    """`vibrafeed serve` on a folder; it can be killed and started again, on the same port."""

    def __init__(self, folder: Path, *options: str, code: str = SERVE, **settings: Any):
        self.options, self.code = options, code
        self.folder, self.log = folder, folder / "log"
        self.port = free_port()
        self.address = f"http://127.0.0.1:{self.port}"
        self._environment = {**os.environ, "VIBRAFEED_DATA_DIRECTORY": str(folder / "data")}
        for name, value in settings.items():
            self._environment[f"VIBRAFEED_{name.upper()}"] = str(value)
        self.process: subprocess.Popen[bytes] | None = None

    def launch(self) -> None:
        """Start it, and do not wait for it."""
        command = [sys.executable, "-c", self.code, "serve", *self.options]
        command += ["--port", str(self.port)]
        with self.log.open("ab") as file:
            self.process = subprocess.Popen(
                command, cwd=ROOT, env=self._environment, stdout=file, stderr=file
            )

    def start(self) -> None:
        """Start it, and wait until it answers."""
        self.launch()

        def answers() -> bool:
            assert self.process is not None
            assert self.process.poll() is None, self.log.read_text()
            try:
                urllib.request.urlopen(f"{self.address}/healthz", timeout=PATIENCE).close()
            except OSError:
                return False
            return True

        wait_for(answers, self.log.read_text)

    def kill(self) -> None:
        """Kill it, as a power cut would."""
        assert self.process is not None
        self.process.kill()
        self.process.wait(PATIENCE)

    def workers(self) -> list[psutil.Process]:
        """Return the processes below that of the server."""
        assert self.process is not None
        return psutil.Process(self.process.pid).children(recursive=True)

    def stop(self) -> None:
        """Ask it to stop, if it runs."""
        assert self.process is not None
        if self.process.poll() is None:
            self.process.terminate()
            self.process.wait(PATIENCE)


class Server(Service):
    """A service with a client that follows its jobs, while it is killed and started again."""

    def ask(
        self,
        path: str,
        content: object = None,
        method: str | None = None,
        headers: Iterable[tuple[str, str]] = (),
    ) -> bytes:
        """Return a reply's content; a server that is being started again is waited for."""
        body = None if content is None else json.dumps(content).encode()

        def replied() -> tuple[bytes] | None:
            request = urllib.request.Request(
                f"{self.address}{path}", body, dict(headers), method=method
            )
            try:
                with urllib.request.urlopen(request, timeout=PATIENCE) as reply:
                    return (reply.read(),)
            except urllib.error.HTTPError:
                raise
            except OSError:
                assert self.process is not None
                ended = self.process.poll()  # negative where it was killed
                assert ended is None or ended < 0, self.log.read_text()
                return None

        return wait_for(replied)[0]

    def get(self, path: str) -> Any:
        return json.loads(self.ask(path))

    def job(self, number: str) -> Any:
        return self.get(f"/jobs/{number}")

    def dataset(self, number: str) -> bytes:
        return self.ask(f"/jobs/{number}/results/dataset")

    def post(self, study: Mapping[str, Any]) -> str:
        path = f"/processes/{study['kind']}/execution"
        return json.loads(self.ask(path, study, headers=[("Prefer", "respond-async")]))["jobID"]

    def post_to_a_busy_one(self, study: Mapping[str, Any]) -> str:
        """Return the number of a job; a service that is busy is asked again."""

        def posted() -> str | None:
            try:
                return self.post(study)
            except urllib.error.HTTPError as error:
                if error.code != HTTPStatus.SERVICE_UNAVAILABLE:
                    raise
                return None

        return wait_for(posted)

    def waited(self, number: str, enough: Callable[[Any], bool], every: float = EVERY) -> Any:
        """Return a job once it is as it should be, or over."""

        def reached() -> Any:
            job = self.job(number)
            return (job["status"] not in ("accepted", "running") or enough(job)) and job

        return wait_for(reached, lambda: self.job(number), every)

    def finished(self, number: str) -> Any:
        return self.waited(number, lambda job: False, SELDOM)

    def begun(self, number: str) -> Any:
        """Return a job that has done some of its cells; it must not be over."""
        job = self.waited(number, lambda job: job["cellsDone"] > 0)
        assert job["status"] == "running", job
        return job


@contextmanager
def serving(folder: Path, *options: str, **settings: Any) -> Iterator[Server]:
    """Yield a server that has been launched, and stop it in the end."""
    server = Server(folder, *options, **settings)
    server.launch()
    try:
        yield server
    finally:
        server.stop()


def wait_for_end(processes: Iterable[psutil.Process]) -> None:
    """Wait until processes are over; nobody may ask for the exit code of those of others."""

    def is_over(process: psutil.Process) -> bool:
        try:
            return process.status() == psutil.STATUS_ZOMBIE
        except psutil.NoSuchProcess:
            return True

    wait_for(lambda: all(is_over(process) for process in processes))


def refusal(ask: Callable[[], object], status: int, kind: str = "") -> Any:
    """Return the problem document, of a kind, of a reply that has to be one."""
    with pytest.raises(urllib.error.HTTPError) as refused:
        ask()
    with refused.value as reply:
        document = json.load(reply)
    assert (reply.code, reply.headers["content-type"]) == (status, "application/problem+json")
    assert document["type"].endswith(kind)
    return document


@contextmanager
def services(folders: pytest.TempPathFactory) -> Iterator[Callable[..., Server]]:
    """Yield a function that starts a service with settings; all of them stop in the end."""
    started: list[Server] = []

    def start(*options: str, **settings: Any) -> Server:
        service = Server(folders.mktemp("service"), *options, **settings)
        started.append(service)
        service.start()
        return service

    try:
        yield start
    finally:
        for service in started:
            service.stop()
