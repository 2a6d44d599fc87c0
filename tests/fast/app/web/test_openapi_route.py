"""The OpenAPI document is made once and told anew only where it differs."""

from __future__ import annotations

import subprocess
import sys

import pytest

from local_client import local_client
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.app.web.execution import PROCESSES
from vibrafeed.app.web.openapi import StudySchema

MOST_BYTES = 300_000


@pytest.mark.parametrize("root", ["", "/vibrafeed"])
def test_the_document_comes_from_memory_with_an_etag(tmp_path, root, monkeypatch, without_studies):
    app = create_app(Settings(data_directory=tmp_path))
    client = local_client(app, root_path=root)
    first = client.get("/openapi.json")
    assert first.status_code == 200
    assert len(first.content) < MOST_BYTES
    expected = app.openapi()
    assert first.json() == (expected | {"servers": [{"url": root}]} if root else expected)
    monkeypatch.setattr("fastapi.applications.get_openapi", None)  # it is not made again
    assert client.get("/openapi.json").content == first.content
    known = client.get("/openapi.json", headers={"If-None-Match": first.headers["etag"]})
    assert known.status_code == 304
    head = client.head("/openapi.json")
    assert head.headers["etag"] == first.headers["etag"]


def test_a_description_has_the_schema_of_its_studies(tmp_path):
    with local_client(create_app(Settings(data_directory=tmp_path))) as client:
        told = client.get("/processes/sweep").json()
    schema = told["inputs"]["study"]["schema"]
    assert schema == PROCESSES["sweep"].study.model_json_schema(schema_generator=StudySchema)
    assert told["links"][0]["href"].endswith("/processes/sweep")


def test_a_start_builds_no_schema_of_all_studies():
    # They are as much work as all else of a start, and only the document shows them.
    code = (
        "import vibrafeed.app.main\n"
        "from vibrafeed.app.web.execution import AnyStudy, MeasuredStudy\n"
        "print(AnyStudy.__pydantic_complete__, MeasuredStudy.__pydantic_complete__)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]
