"""Results that are not what was written: none is served, each is computed again."""

from __future__ import annotations

import os
import shutil
import sqlite3
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from local_client import ended, local_client
from posted_sweeps import STUDY, problem, with_axes
from vibrafeed.app.jobs.manifest import JSON, NETCDF, ZARR
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from waiting import PATIENCE

WAIT = {"Prefer": "respond-async, wait=300"}


def flip(path: Path) -> None:
    with path.open("r+b") as file:
        file.seek(path.stat().st_size // 2)
        byte = file.read(1)[0]
        file.seek(-1, os.SEEK_CUR)
        file.write(bytes([byte ^ 1]))


def cut(path: Path) -> None:
    os.truncate(path, path.stat().st_size // 2)


def gone(path: Path) -> None:
    path.unlink()


DAMAGE = (flip, cut, gone)


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    settings = Settings(
        data_directory=tmp_path_factory.mktemp("data"),
        workers=1,
        max_wait_seconds=300,
        max_cells=100_000,
    )
    with local_client(create_app(settings), raise_server_exceptions=False) as client:
        yield client


def carried_out(client: TestClient, study: dict[str, Any]) -> tuple[str, Path]:
    """Return the address of a job that has ended, and the folder of its result."""
    reply = client.post("/processes/sweep/execution", json=study, headers=WAIT)
    assert reply.status_code == 200, reply.text
    address = reply.headers["location"]
    status = client.get(address).json()
    assert status["status"] == "successful"
    return address, client.app.state.store.folder(status["study"])


def assert_mended(client: TestClient, address: str, path: str, before: bytes) -> None:
    """Look at what is told while a result is computed again, and at the result."""
    reply = client.get(f"{address}/results/{path}")
    document = problem(reply, 404)
    assert document["type"].endswith("/result-not-ready")
    assert "computed again" in document["detail"]
    assert reply.headers["retry-after"] == "1"
    assert ended(client, address)["status"] == "successful"
    assert client.get(f"{address}/results/{path}").content == before


@pytest.mark.service
class TestJob:
    @pytest.mark.by_day(3)
    @pytest.mark.parametrize("damage", DAMAGE)
    @pytest.mark.parametrize("name", [NETCDF, JSON])
    @pytest.mark.parametrize("method", ["GET", "HEAD"])
    def test_a_file_is_computed_again(self, client, damage, name, method):
        address, folder = carried_out(client, STUDY)
        path = "dataset" if name == NETCDF else "dataset?format=json"
        before = client.get(f"{address}/results/{path}")
        assert before.status_code == 200
        damage(folder / name)
        if method == "HEAD":
            assert client.head(f"{address}/results/{path}").status_code == 404
            assert ended(client, address)["status"] == "successful"
            assert client.get(f"{address}/results/{path}").content == before.content
        else:
            assert_mended(client, address, path, before.content)

    def test_all_jobs_of_equal_studies_wait_for_it(self, client):
        (one, folder), (other, _) = carried_out(client, STUDY), carried_out(client, STUDY)
        (folder / "manifest.json").write_text("{")
        assert client.get(f"{one}/results").status_code == 404
        assert ended(client, other)["status"] == ended(client, one)["status"] == "successful"
        assert client.get(f"{other}/results").status_code == 200

    def test_equal_studies_posted_later_are_not_told_of_what_is_broken(self, client):
        address, folder = carried_out(client, STUDY)
        before = client.get(f"{address}/results/dataset").content
        cut(folder / NETCDF)
        later, _ = carried_out(client, STUDY)
        assert client.get(f"{later}/results/dataset").content == before

    def test_what_a_range_or_a_condition_asks_for_is_looked_at_too(self, client):
        address, folder = carried_out(client, STUDY)
        flip(folder / NETCDF)
        headers = {"Range": "bytes=0-9"}
        assert client.get(f"{address}/results/dataset", headers=headers).status_code == 404
        assert ended(client, address)["status"] == "successful"
        assert client.get(f"{address}/results/dataset", headers=headers).status_code == 206

    def test_a_result_whose_study_is_gone_is_gone(self, client):
        address, folder = carried_out(client, with_axes(frequency=7))
        shutil.rmtree(folder)
        for _ in range(2):
            assert "removed" in problem(client.get(f"{address}/results/dataset"), 404)["detail"]


@pytest.mark.service
class TestGroup:
    LARGE = with_axes(frequency=20, amplitude=20, alpha=20, beta=20)

    @pytest.mark.by_day(2)
    @pytest.mark.parametrize("damage", DAMAGE)
    @pytest.mark.parametrize("what", ["zarr.json", "frequency/c/0", "transport_velocity/c/*/*/*/*"])
    def test_what_a_group_has_is_computed_again(self, client, damage, what):
        address, folder = carried_out(client, self.LARGE)
        [file, *_] = (folder / ZARR).glob(what)
        path = f"zarr/{file.relative_to(folder / ZARR)}"
        before = client.get(f"{address}/results/{path}")
        assert before.status_code == 200
        assert before.headers["repr-digest"].startswith("sha-256=:")
        damage(file)
        reply = client.get(f"{address}/results/{path}")
        document = problem(reply, 404)
        assert document["type"].endswith("/result-not-ready")
        assert ended(client, address)["status"] == "successful"
        after = client.get(f"{address}/results/{path}")
        assert after.status_code == 200
        if what != "zarr.json":  # it holds what computing cost
            assert after.content == before.content

    def test_a_group_is_no_further_file(self, client):
        address, _ = carried_out(client, self.LARGE)
        problem(client.get(f"{address}/results/files/{ZARR}"), 404)

    def test_the_list_of_digests_is_one_that_others_read(self, client, find_sums):
        _, folder = carried_out(client, self.LARGE)
        assert find_sums(folder / f"{ZARR}.sha256") == 0


@pytest.fixture
def find_sums() -> Callable[[Path], int]:
    import subprocess

    def check(path: Path) -> int:
        done = subprocess.run(
            ["sha256sum", "--check", "--quiet", path.name], cwd=path.parent, check=False
        )
        return done.returncode

    return check


class TestSweep:
    @pytest.mark.parametrize("damage", DAMAGE)
    def test_a_download_is_computed_again_at_once(self, client, damage):
        key = client.post("/sweeps", json=STUDY).json()["id"]
        before = client.get(f"/sweeps/{key}/netcdf")
        file = client.app.state.store.folder(key) / NETCDF
        damage(file)
        head = client.head(f"/sweeps/{key}/netcdf")
        assert head.status_code == 200
        assert "etag" not in head.headers  # nothing is known of a file that is to be made
        after = client.get(f"/sweeps/{key}/netcdf")
        assert (after.status_code, after.content) == (200, before.content)
        assert after.headers["etag"] == before.headers["etag"]


class TestSound:
    def test_a_file_is_read_once_and_after_each_change(self, client, monkeypatch):
        key = client.post("/sweeps", json=STUDY).json()["id"]
        client.get(f"/sweeps/{key}/netcdf")  # it may be written for this request
        whole = client.get(f"/sweeps/{key}/netcdf")
        read: list[object] = []
        digest = "vibrafeed.app.jobs.integrity._digest"
        from vibrafeed.app.jobs import integrity

        plain = integrity._digest
        monkeypatch.setattr(digest, lambda file: read.append(file) or plain(file))
        for _ in range(3):
            assert client.get(f"/sweeps/{key}/netcdf").content == whole.content
        assert read == []
        os.utime(client.app.state.store.folder(key) / NETCDF)
        for _ in range(3):
            assert client.get(f"/sweeps/{key}/netcdf").content == whole.content
        assert len(read) == 1

    def test_small_requests_do_not_wait_for_a_large_file(self, client, monkeypatch):
        """The large file is held while it is looked at; all else is answered meanwhile."""
        key = client.post("/sweeps", json=STUDY).json()["id"]
        other = client.post("/sweeps", json=with_axes(frequency=2)).json()["id"]
        for one in (key, other):
            assert client.get(f"/sweeps/{one}/netcdf").status_code == 200
        store = client.app.state.store
        looking, go_on = threading.Event(), threading.Event()
        from vibrafeed.app.jobs import integrity

        plain, held = integrity._digest, (store.folder(key) / NETCDF).stat()

        def slow(file):
            if os.path.samestat(os.fstat(file.fileno()), held):
                looking.set()
                assert go_on.wait(PATIENCE)
            return plain(file)

        monkeypatch.setattr("vibrafeed.app.jobs.integrity._digest", slow)
        monkeypatch.setattr("vibrafeed.app.jobs.integrity.LARGE", held.st_size - 1)
        os.utime(store.folder(key) / NETCDF)
        os.utime(store.folder(other) / NETCDF)
        replies: list[Any] = []
        asked = [
            threading.Thread(target=lambda: replies.append(client.get(f"/sweeps/{key}/netcdf")))
            for _ in range(12)
        ]
        for thread in asked:
            thread.start()
        try:
            assert looking.wait(PATIENCE)
            assert client.get("/healthz").status_code == 200
            assert client.get("/scenes").status_code == 200
            assert client.get(f"/sweeps/{other}/netcdf").status_code == 200
            assert replies == []
        finally:
            go_on.set()
            for thread in asked:
                thread.join(PATIENCE)
        assert [reply.status_code for reply in replies] == [200] * 12


def test_a_damaged_ledger_is_503_and_not_ready(tmp_path):
    settings = Settings(data_directory=tmp_path, workers=1)
    app = create_app(settings)
    with local_client(app, raise_server_exceptions=False) as client:
        assert client.get("/readyz").status_code == 200
        assert client.get("/jobs").status_code == 200
        database = app.state.admission.ledger.database
        malformed = sqlite3.DatabaseError("database disk image is malformed")
        malformed.sqlite_errorcode = sqlite3.SQLITE_CORRUPT

        def fail(*_):
            raise malformed

        database._engine().dialect.do_execute = fail
        assert problem(client.get("/jobs"), 503)["detail"] == "The ledger is damaged."
        del database._engine().dialect.do_execute
        assert client.get("/jobs").status_code == 200
        (error,) = problem(client.get("/readyz"), 503)["errors"]
        assert error["message"] == "The ledger is damaged: restore the backup."
        assert client.get("/healthz").status_code == 200
