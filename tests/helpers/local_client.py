"""A client of the service in this process, which calls it by a name of this machine."""

import asyncio
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from fastapi import FastAPI
from fastapi.testclient import TestClient

from vibrafeed.app.jobs.process_pool import ProcessPool, _until_done
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.core.errors import StoppedError
from waiting import wait_for

HERE = "http://127.0.0.1"

_THREAD = ThreadPoolExecutor(1, "pool")  # one: the NetCDF library takes no two


class Threads(ProcessPool):
    """Carries out in a thread what the processes of a pool would: a test starts none."""

    async def __call__(
        self, function, *arguments, seconds=float("inf"), check=None, on_start=None, grace=0.0
    ) -> Any:
        call = asyncio.wrap_future(_THREAD.submit(function, *arguments))
        try:
            if on_start is not None:
                await on_start()
            if not await _until_done(call, seconds, check):
                raise StoppedError(f"stopped after {seconds:g} s")
            return call.result()
        finally:
            call.cancel()


def local_client(app: FastAPI, **options: Any) -> TestClient:
    """Return a client; by itself it would call the service `testserver`, which is refused."""
    if type(app.state.process_pool) is ProcessPool:  # not a test's own
        app.state.process_pool.__class__ = Threads  # all parts of the app hold the same one
    return TestClient(app, base_url=HERE, **options)


def client_of(folder: Path, **settings: Any) -> TestClient:
    """Return a client of a service with a data directory and settings; mistakes are replies."""
    app = create_app(Settings(data_directory=folder, **settings))
    return local_client(app, raise_server_exceptions=False)


def ended(client: TestClient, address: str) -> dict[str, Any]:
    """Return the status of the job at an address once it is over."""

    def over() -> dict[str, Any] | None:
        job: dict[str, Any] = client.get(address).json()
        return None if job["status"] in ("accepted", "running") else job

    return wait_for(over, lambda: client.get(address).json())
