"""Results in an object store: a server of its own folder serves what another has computed."""

from __future__ import annotations

import errno
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from local_client import local_client
from posted_sweeps import STUDY, problem, with_axes
from vibrafeed.app.jobs import object_store
from vibrafeed.app.jobs.errors import LostStoreError
from vibrafeed.app.jobs.manifest import MANIFEST, NETCDF, ZARR
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate

pytestmark = pytest.mark.service
URL = "s3://results/some/where"
WAIT = {"Prefer": "respond-async, wait=300"}
LARGE = with_axes(frequency=20, amplitude=20, alpha=20, beta=20)


@pytest.fixture
def bucket(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    import boto3
    from moto.server import ThreadedMotoServer

    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    try:
        address = f"http://127.0.0.1:{server.get_host_and_port()[1]}"
        for name, value in {
            "AWS_ENDPOINT_URL": address,
            "AWS_ALLOW_HTTP": "true",
            "AWS_ACCESS_KEY_ID": "any",
            "AWS_SECRET_ACCESS_KEY": "any",
            "AWS_REGION": "us-east-1",
        }.items():
            monkeypatch.setenv(name, value)
        bucket = boto3.resource("s3", endpoint_url=address).create_bucket(Bucket="results")
        yield bucket
        for one in bucket.objects.all():
            one.delete()
        bucket.delete()
        bucket.meta.client.close()
    finally:
        server.stop()


@pytest.fixture
def serve(tmp_path: Path) -> Callable[[str], TestClient]:
    def start(name: str) -> TestClient:
        settings = Settings(
            data_directory=tmp_path / name,
            results_url=URL,
            workers=1,
            max_wait_seconds=300,
            max_cells=100_000,
        )
        return local_client(create_app(settings), raise_server_exceptions=False)

    return start


def keys(bucket: Any) -> set[str]:
    return {one.key.rpartition("/")[2] for one in bucket.objects.all()}


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("study", "path"),
    [(STUDY, "dataset"), (LARGE, "zarr/frequency/c/0"), (LARGE, "zarr/zarr.json")],
)
def test_a_server_with_an_empty_folder_serves_what_another_has_computed(
    bucket, serve, tmp_path, study, path
):
    with serve("one") as client:
        posted = client.post("/processes/sweep/execution", json=study, headers=WAIT)
        assert posted.status_code == 200, posted.text
        address = posted.headers["location"]
        before = client.get(f"{address}/results/{path}")
        assert before.status_code == 200
    (tmp_path / "two").mkdir()
    shutil.copy(tmp_path / "one" / "jobs.sqlite3", tmp_path / "two")
    shutil.rmtree(tmp_path / "one")
    with serve("two") as client:
        after = client.get(f"{address}/results/{path}")
        assert (after.status_code, after.content) == (200, before.content)
        for name in ("etag", "repr-digest"):
            assert after.headers[name] == before.headers[name]
        part = client.get(f"{address}/results/{path}", headers={"Range": "bytes=3-8"})
        assert (part.status_code, part.content) == (206, before.content[3:9])
        again = client.post("/processes/sweep/execution", json=study, headers=WAIT)
        assert again.status_code == 200


def finished(store: Store) -> str:
    prepared = prepare_content(STUDY)
    key, _ = store.add(prepared.study)
    store.finish(key, tabulate(prepared), process="sweep", cells=9, blocks=1, seconds=1.0)
    return key


KILLED = """
import os, sys
from pathlib import Path
from vibrafeed.app.jobs import object_store
from vibrafeed.app.jobs.store import Store
plain = object_store._names
def names(folder, manifest):
    for name in plain(folder, manifest):
        yield name
        os._exit(9)
object_store._names = names
Store(Path(sys.argv[1]), sys.argv[2]).send(sys.argv[3])
"""


def test_what_was_killed_in_the_middle_is_not_there(bucket, tmp_path):
    one, two = Store(tmp_path / "one", URL), Store(tmp_path / "two", URL)
    key = finished(one)
    command = [sys.executable, "-c", KILLED, str(tmp_path / "one"), URL, key]
    assert subprocess.run(command, check=False).returncode == 9
    assert NETCDF in keys(bucket)
    assert MANIFEST not in keys(bucket)
    assert two.fetch(key) is False
    assert two.manifest(key) is None
    one.send(key)
    assert two.fetch(key) is True
    assert two.manifest(key) == one.manifest(key)
    assert two.folder(key).joinpath(NETCDF).read_bytes() == (
        one.folder(key).joinpath(NETCDF).read_bytes()
    )
    for store in (one, two):
        store.close()


def test_what_is_cut_here_is_replaced(bucket, tmp_path):
    one = Store(tmp_path / "one", URL)
    key = finished(one)
    one.send(key)
    (one.folder(key) / NETCDF).write_bytes(b"cut")
    assert one.manifest(key) is None
    assert one.fetch(key) is True
    assert one.manifest(key) is not None
    one.close()


def test_what_is_broken_there_is_no_result_and_is_sent_again(bucket, tmp_path):
    one, two = Store(tmp_path / "one", URL), Store(tmp_path / "two", URL)
    key = finished(one)
    one.send(key)
    [stored] = [found for found in bucket.objects.all() if found.key.endswith(NETCDF)]
    stored.put(Body=b"nonsense")
    assert two.fetch(key) is False
    assert two.manifest(key) is None
    assert MANIFEST not in keys(bucket)
    one.send(key)
    assert two.fetch(key) is True
    for store in (one, two):
        store.close()


def test_what_fails_here_leaves_what_is_there(bucket, tmp_path, monkeypatch):
    one, two = Store(tmp_path / "one", URL), Store(tmp_path / "two", URL)
    key = finished(one)
    one.send(key)

    def gone(path: Path) -> None:
        raise FileNotFoundError(errno.ENOENT, "somebody tidied", str(path))

    with monkeypatch.context() as broken:
        broken.setattr(object_store, "sync", gone)
        with pytest.raises(LostStoreError):
            two.fetch(key)
    assert MANIFEST in keys(bucket)
    assert two.fetch(key) is True
    for store in (one, two):
        store.close()


def test_a_result_that_is_broken_here_is_fetched(bucket, serve):
    with serve("one") as client:
        posted = client.post("/processes/sweep/execution", json=STUDY, headers=WAIT)
        address = posted.headers["location"]
        before = client.get(f"{address}/results/dataset")
        folder = client.app.state.store.folder(client.get(address).json()["study"])
        content = bytearray((folder / NETCDF).read_bytes())
        content[100] ^= 1
        (folder / NETCDF).write_bytes(content)
        problem(client.get(f"{address}/results/dataset"), 404)
        after = client.get(f"{address}/results/dataset")
        assert (after.status_code, after.content) == (200, before.content)
        assert not (folder / ZARR).exists()
