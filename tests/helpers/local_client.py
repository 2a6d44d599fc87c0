"""A client of the service in this process, which calls it by a name of this machine."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI
from fastapi.testclient import TestClient

from waiting import wait_for

HERE = "http://127.0.0.1"


def local_client(app: FastAPI, **options: Any) -> TestClient:
    """Return a client; by itself it would call the service `testserver`, which is refused."""
    return TestClient(app, base_url=HERE, **options)


def ended(client: TestClient, address: str) -> dict[str, Any]:
    """Return the status of the job at an address once it is over."""

    def over() -> dict[str, Any] | None:
        job: dict[str, Any] = client.get(address).json()
        return None if job["status"] in ("accepted", "running") else job

    return wait_for(over, lambda: client.get(address).json())
