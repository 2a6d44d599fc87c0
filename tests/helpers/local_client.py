"""A client of the service in this process, which calls it by a name of this machine."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI
from fastapi.testclient import TestClient

from vibrafeed.app.jobs.process_pool import ProcessPool
from waiting import wait_for

HERE = "http://127.0.0.1"

_idle: list[Any] = []  # processes that all services share


def local_client(app: FastAPI, **options: Any) -> TestClient:
    """Return a client; by itself it would call the service `testserver`, which is refused."""
    _hand_on(app.state.process_pool)
    return TestClient(app, base_url=HERE, **options)


def ended(client: TestClient, address: str) -> dict[str, Any]:
    """Return the status of the job at an address once it is over."""

    def over() -> dict[str, Any] | None:
        job: dict[str, Any] = client.get(address).json()
        return None if job["status"] in ("accepted", "running") else job

    return wait_for(over, lambda: client.get(address).json())


def _hand_on(pool: Any) -> None:
    """Let a pool share the idle processes of those before and after it.

    A process of its own for each service that a test makes would load what is compiled anew: a
    second each time.
    """
    if not isinstance(pool, ProcessPool):
        return  # a test's own
    pool._idle = _idle
    close = pool.close

    def leave_and_close() -> None:
        pool._idle = []
        close()

    pool.close = leave_and_close
