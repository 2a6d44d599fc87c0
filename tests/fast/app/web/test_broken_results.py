"""Results that are not what was written: none is served, each is computed again."""

import hashlib
import os
import shutil
import sqlite3
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from local_client import client_of, ended
from posted_sweeps import STUDY, problem, with_axes
from vibrafeed.app.jobs import integrity
from vibrafeed.app.jobs.manifest import JSON, NETCDF, ZARR
from waiting import PATIENCE

WAIT = {"Prefer": "respond-async, wait=300"}
LARGE = with_axes(frequency=20, amplitude=10, alpha=10, beta=10)


def flip(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def cut(path: Path) -> None:
    os.truncate(path, path.stat().st_size // 2)


def gone(path: Path) -> None:
    path.unlink()


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    folder = tmp_path_factory.mktemp("data")
    with client_of(folder, workers=1, max_wait_seconds=300, max_cells=10_000) as client:
        yield client


def carried_out(client: TestClient, study: dict[str, Any]) -> tuple[str, Path]:
    """Return the address of a job that has ended, and the folder of its result."""
    reply = client.post("/processes/sweep/execution", json=study, headers=WAIT)
    assert reply.status_code == 200, reply.text
    address = reply.headers["location"]
    status = client.get(address).json()
    assert status["status"] == "successful"
    return address, client.app.state.store.folder(status["study"])


@pytest.mark.parametrize(
    ("damage", "name", "method", "headers"),
    [
        (flip, NETCDF, "GET", {}),
        (cut, JSON, "GET", {}),
        (gone, NETCDF, "HEAD", {}),
        (flip, NETCDF, "GET", {"Range": "bytes=0-9"}),
    ],
)
def test_a_file_of_a_job_is_computed_again(client, damage, name, method, headers):
    address, folder = carried_out(client, STUDY)
    path = f"{address}/results/dataset{'?format=json' if name == JSON else ''}"
    before = client.get(path)
    assert before.status_code == 200
    damage(folder / name)
    reply = client.request(method, path, headers=headers)
    assert (reply.status_code, reply.headers["retry-after"]) == (404, "1")
    if method == "GET":
        assert "computed again" in problem(reply, 404, "/result-not-ready")["detail"]
    assert ended(client, address)["status"] == "successful"
    assert client.get(path).content == before.content


def test_all_jobs_of_equal_studies_wait_for_it_and_later_ones_are_not_told(client):
    (one, folder), (other, _) = carried_out(client, STUDY), carried_out(client, STUDY)
    before = client.get(f"{one}/results/dataset").content
    (folder / "manifest.json").write_text("{")
    assert client.get(f"{one}/results").status_code == 404
    assert ended(client, other)["status"] == ended(client, one)["status"] == "successful"
    assert client.get(f"{other}/results").status_code == 200
    cut(folder / NETCDF)
    later, _ = carried_out(client, STUDY)
    assert client.get(f"{later}/results/dataset").content == before


def test_a_result_whose_study_is_gone_is_gone(client):
    address, folder = carried_out(client, with_axes(frequency=7))
    shutil.rmtree(folder)
    for _ in range(2):
        assert "removed" in problem(client.get(f"{address}/results/dataset"), 404)["detail"]


@pytest.mark.parametrize(
    ("damage", "what"),
    [(flip, "zarr.json"), (cut, "frequency/c/0"), (gone, "transport_velocity/c/*/*/*/*")],
)
def test_what_a_group_has_is_computed_again(client, damage, what):
    address, folder = carried_out(client, LARGE)
    [file, *_] = (folder / ZARR).glob(what)
    path = f"{address}/results/zarr/{file.relative_to(folder / ZARR)}"
    before = client.get(path)
    assert before.status_code == 200
    assert before.headers["repr-digest"].startswith("sha-256=:")
    damage(file)
    problem(client.get(path), 404, "/result-not-ready")
    assert ended(client, address)["status"] == "successful"
    after = client.get(path)
    assert after.status_code == 200
    if what != "zarr.json":  # it holds what computing cost
        assert after.content == before.content


def test_the_digests_of_a_group_are_those_of_its_files(client):
    address, folder = carried_out(client, LARGE)
    for line in (folder / f"{ZARR}.sha256").read_text().splitlines():
        digest, name = line.split("  ")
        assert hashlib.sha256((folder / name).read_bytes()).hexdigest() == digest
    problem(client.get(f"{address}/results/files/{ZARR}"), 404)


@pytest.mark.parametrize("damage", [flip, cut, gone])
def test_a_download_is_computed_again_at_once(client, damage):
    key = client.post("/sweeps", json=STUDY).json()["id"]
    before = client.get(f"/sweeps/{key}/netcdf")
    damage(client.app.state.store.folder(key) / NETCDF)
    head = client.head(f"/sweeps/{key}/netcdf")
    assert head.status_code == 200
    assert "etag" not in head.headers  # nothing is known of a file that is to be made
    after = client.get(f"/sweeps/{key}/netcdf")
    assert (after.status_code, after.content) == (200, before.content)
    assert after.headers["etag"] == before.headers["etag"]


def test_a_file_is_read_once_and_after_each_change(client, monkeypatch):
    key = client.post("/sweeps", json=STUDY).json()["id"]
    client.get(f"/sweeps/{key}/netcdf")  # it may be written for this request
    whole = client.get(f"/sweeps/{key}/netcdf")
    read, plain = [], integrity._digest
    monkeypatch.setattr(integrity, "_digest", lambda file: read.append(file) or plain(file))
    for times in (0, 1):
        for _ in range(3):
            assert client.get(f"/sweeps/{key}/netcdf").content == whole.content
        assert len(read) == times
        os.utime(client.app.state.store.folder(key) / NETCDF)


def test_small_requests_do_not_wait_for_a_large_file(client, monkeypatch):
    """The large file is held while it is looked at; all else is answered meanwhile."""
    studies = STUDY, with_axes(frequency=2)
    large, small = [client.post("/sweeps", json=one).json()["id"] for one in studies]
    store = client.app.state.store
    for key in (large, small):
        assert client.get(f"/sweeps/{key}/netcdf").status_code == 200
        os.utime(store.folder(key) / NETCDF)
    looking, go_on = threading.Event(), threading.Event()
    plain, held = integrity._digest, (store.folder(large) / NETCDF).stat()

    def slow(file):
        if os.path.samestat(os.fstat(file.fileno()), held):
            looking.set()
            assert go_on.wait(PATIENCE)
        return plain(file)

    monkeypatch.setattr(integrity, "_digest", slow)
    monkeypatch.setattr(integrity, "LARGE", held.st_size - 1)
    with ThreadPoolExecutor(12) as threads:
        asked = [threads.submit(client.get, f"/sweeps/{large}/netcdf") for _ in range(12)]
        try:
            assert looking.wait(PATIENCE)
            for path in ("/healthz", "/scenes", f"/sweeps/{small}/netcdf"):
                assert client.get(path).status_code == 200
            assert not any(one.done() for one in asked)
        finally:
            go_on.set()
    assert {one.result().status_code for one in asked} == {200}


MALFORMED = sqlite3.DatabaseError("database disk image is malformed")
MALFORMED.sqlite_errorcode = sqlite3.SQLITE_CORRUPT


@pytest.mark.parametrize(
    ("fault", "told", "is_ready"),
    [
        (MALFORMED, "The ledger is damaged.", False),
        (sqlite3.OperationalError("database is locked"), "Another process holds the ledger", True),
    ],
)
def test_a_ledger_that_is_damaged_or_held(tmp_path, fault, told, is_ready):
    def fail(*_):
        raise fault

    with client_of(tmp_path, workers=1) as client:
        assert client.get("/readyz").status_code == 200
        dialect = client.app.state.admission.ledger.database._engine().dialect
        dialect.do_execute = fail
        reply = client.get("/jobs")
        del dialect.do_execute
        assert told in problem(reply, 503)["detail"]
        assert int(reply.headers.get("retry-after", 1)) >= 1
        assert client.get("/jobs").status_code == 200
        found = client.get("/readyz")
        assert (found.status_code == 200) == is_ready
        assert is_ready or "restore the backup" in problem(found, 503)["errors"][0]["message"]
        assert client.get("/healthz").status_code == 200
