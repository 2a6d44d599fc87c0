"""A client of the service, and a sweep that it was posted; some files have their own client."""

import pytest
from fastapi.testclient import TestClient

from local_client import client_of
from posted_sweeps import STUDY


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory):
    """Return a client of the service whose replies to GET and HEAD have equal headers."""
    with client_of(tmp_path_factory.mktemp("data"), max_cells=10**6, workers=2) as client:
        client.headers["X-Request-ID"] = "one"
        yield client


@pytest.fixture
def without_studies(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the OpenAPI document be without the models of studies, which take it some seconds."""
    monkeypatch.setattr("vibrafeed.app.web.openapi._components", dict)


@pytest.fixture(scope="module")
def address(client: TestClient) -> str:
    """Return where the study stands once it is posted."""
    return f"/sweeps/{client.post('/sweeps', json=STUDY).json()['id']}"
