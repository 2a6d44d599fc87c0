"""A client of the service in this process, which calls it by a name of this machine."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI
from fastapi.testclient import TestClient

HERE = "http://127.0.0.1"


def local_client(app: FastAPI, **options: Any) -> TestClient:
    """Return a client; by itself it would call the service `testserver`, which is refused."""
    return TestClient(app, base_url=HERE, **options)
