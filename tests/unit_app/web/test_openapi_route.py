"""The OpenAPI document is made once and told anew only where it differs."""

from __future__ import annotations

import pytest

from app.main import create_app
from app.settings import Settings
from app.web import documents
from app.web.execution import PROCESSES
from local_client import local_client


@pytest.mark.parametrize("root", ["", "/vibrafeed"])
def test_the_document_comes_from_memory_with_an_etag(tmp_path, root, monkeypatch):
    app = create_app(Settings(data_directory=tmp_path))
    client = local_client(app, root_path=root)
    first = client.get("/openapi.json")
    assert first.status_code == 200
    expected = app.openapi()
    assert first.json() == (expected | {"servers": [{"url": root}]} if root else expected)
    monkeypatch.setattr(app, "openapi", None)  # it is not made again
    assert client.get("/openapi.json").content == first.content
    known = client.get("/openapi.json", headers={"If-None-Match": first.headers["etag"]})
    assert known.status_code == 304
    head = client.head("/openapi.json")
    assert head.headers["etag"] == first.headers["etag"]


def test_a_process_is_described_from_memory(tmp_path):
    documents._schema_of.cache_clear()
    client = local_client(create_app(Settings(data_directory=tmp_path)))
    first, again = (client.get("/processes/sweep").content for _ in range(2))
    assert first == again
    counts = documents._schema_of.cache_info()
    assert (counts.misses, counts.hits) == (1, 1)
    assert PROCESSES["sweep"].study.model_json_schema() == documents._schema_of(
        PROCESSES["sweep"].study
    )
