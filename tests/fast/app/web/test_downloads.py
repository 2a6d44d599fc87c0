"""What clients keep, ask for again and resume: NetCDF files."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import hashlib
import os
from pathlib import Path

import pytest
from fastapi import Request

from posted_sweeps import TRILLION, problem, with_axes
from vibrafeed.app.jobs.manifest import NETCDF
from vibrafeed.app.web.downloads import file_reply


def times_open(path: Path) -> int:
    """Return how often this process has a file open."""
    count = 0
    for descriptor in Path("/proc/self/fd").iterdir():
        with contextlib.suppress(FileNotFoundError):
            count += descriptor.readlink() == path
    return count


class TestFile:
    @pytest.fixture
    def whole(self, client, address):
        response = client.get(f"{address}/netcdf")
        assert response.status_code == 200
        return response

    def test_its_headers(self, client, address, whole):
        digest = hashlib.sha256(whole.content).hexdigest()
        assert whole.headers["etag"] == f'"{digest}"'
        assert whole.headers["accept-ranges"] == "bytes"
        assert whole.headers["content-length"] == str(len(whole.content))
        assert whole.headers["content-disposition"].startswith('attachment; filename="vibrafeed-')
        assert whole.headers["repr-digest"].startswith("sha-256=:")
        head = client.head(f"{address}/netcdf")
        assert (head.status_code, head.content) == (200, b"")
        assert dict(head.headers) == dict(whole.headers)

    def test_ranges(self, client, address, whole):
        size, etag = len(whole.content), whole.headers["etag"]
        for wanted, start, stop in (
            ("bytes=0-0", 0, 1),
            ("bytes=100-", 100, None),
            ("bytes=100-199", 100, 200),
            ("Bytes=5-999999999999999999", 5, None),
            ("bytes=-100", -100, None),
            ("bytes=-999999999999999999", 0, None),
        ):
            part = client.get(f"{address}/netcdf", headers={"Range": wanted})
            expected = whole.content[start:stop]
            assert (part.status_code, part.content) == (206, expected)
            first = start % size
            told = f"bytes {first}-{first + len(expected) - 1}/{size}"
            assert part.headers["content-range"] == told
            assert part.headers["content-length"] == str(len(expected))
            assert part.headers["etag"] == etag
        for wanted in (f"bytes={size}-", "bytes=999999999999-"):
            past = client.get(f"{address}/netcdf", headers={"Range": wanted})
            assert past.status_code == 416
            assert past.headers["content-range"] == f"bytes */{size}"

    def test_conditions(self, client, address, whole):
        etag = whole.headers["etag"]
        get = lambda **headers: client.get(  # noqa: E731
            f"{address}/netcdf", headers={k.replace("_", "-"): v for k, v in headers.items()}
        )
        for known in (etag, f"W/{etag}", f'"other", {etag}', "*"):
            response = get(If_None_Match=known)
            assert (response.status_code, response.content) == (304, b"")
            assert response.headers["etag"] == etag
        assert get(If_None_Match='"other"').status_code == 200
        assert get(If_None_Match=etag, Range="bytes=0-1").status_code == 304
        assert get(If_Range=etag, Range="bytes=0-1").status_code == 206
        for stale in ('"other"', f"W/{etag}"):
            assert get(If_Range=stale, Range="bytes=0-1").status_code == 200
        assert get(If_Match=etag).status_code == 200
        assert get(If_Match="*").status_code == 200
        problem(get(If_Match='"other"'), 412)
        problem(get(If_Match=f"W/{etag}"), 412)

    def test_too_many_open_files(self, client, address, whole, monkeypatch):
        def open_(path, *arguments, **options):
            raise OSError(errno.EMFILE, os.strerror(errno.EMFILE), str(path))

        with monkeypatch.context() as full:
            full.setattr(Path, "open", open_)
            response = client.get(f"{address}/netcdf")
        document = problem(response, 503, "problem:busy")
        assert "limit of open files" in document["detail"]
        assert "netcdf" not in document["detail"]  # nor any path
        assert int(response.headers["retry-after"]) >= 1
        assert client.get(f"{address}/netcdf").content == whole.content

    def test_no_reply_leaves_the_file_open(self, client, address, whole):
        path = client.app.state.store.folder(address.rpartition("/")[2]) / NETCDF
        for status, method, headers in (
            (200, "GET", {}),
            (200, "HEAD", {}),
            (206, "GET", {"Range": "bytes=5-9"}),
            (304, "GET", {"If-None-Match": whole.headers["etag"]}),
            (412, "GET", {"If-Match": '"other"'}),
            (416, "GET", {"Range": "bytes=999999999-"}),
        ):
            response = client.request(method, f"{address}/netcdf", headers=headers)
            assert response.status_code == status
            assert times_open(path) == 0

    @pytest.mark.parametrize("version", ["2.3", "2.4"])
    @pytest.mark.parametrize("leaves", ["a failing connection", "a cancelled request", "never run"])
    def test_a_client_that_leaves_before_the_first_byte(self, tmp_path, version, leaves):
        path = tmp_path / "result"
        path.write_bytes(b"12345")
        scope = {
            "type": "http", "method": "GET", "headers": [], "asgi": {"spec_version": version},
            "state": {"enlarge": lambda size: None},
        }  # fmt: skip
        reply = file_reply(
            Request(scope), path, digest="00" * 32, media_type="text/plain", filename="x"
        )
        seen = []

        async def receive():
            await asyncio.Event().wait()

        async def send(message):
            seen.append(message["type"])
            if leaves == "a failing connection":
                raise OSError("gone")
            await asyncio.Event().wait()

        async def serve():
            task = asyncio.create_task(reply(scope, receive, send))
            while not seen:
                await asyncio.sleep(0.001)
            task.cancel()
            await asyncio.wait([task])
            assert task.cancelled() or task.exception() is not None

        if leaves != "never run":
            asyncio.run(serve())
            assert seen == ["http.response.start"]
        assert times_open(path) == 0

    def test_a_sweep_that_is_too_large_for_a_file_is_refused_and_read_in_pieces(self, client):
        posted = client.post("/sweeps", json=TRILLION)
        assert posted.status_code == 201
        assert posted.json()["cells"] == 10**12
        address = f"/sweeps/{posted.json()['id']}"
        document = problem(client.get(f"{address}/netcdf"), 422, "problem:limit")
        assert "1,000,000" in document["detail"]
        params = {"output": "acceleration_x", "axes": "beta", "alpha": 90, "amplitude": 1e-3}
        piece = client.get(f"{address}/slice", params={**params, "frequency": 20})
        assert piece.status_code == 200
        assert len(piece.json()["values"]["data"]) == 1000
        long = with_axes(frequency=10_000_000)
        document = problem(client.post("/sweeps", json=long), 422)
        assert "Give frequency 2,000,000 values or fewer" in document["detail"]
        many = with_axes(frequency=10**6, amplitude=10**6, alpha=10**6)
        assert "cells" in problem(client.post("/sweeps", json=many), 422)["detail"]


def test_head_of_a_file_that_is_not_made_computes_nothing(client, monkeypatch):
    posted = client.post("/sweeps", json=with_axes(frequency=5)).json()
    path = f"/sweeps/{posted['id']}/netcdf"
    with monkeypatch.context() as patch:
        patch.setattr(client.app.state.writer, "write", None)
        head = client.head(path)
    assert head.status_code == 200
    assert not {"content-length", "etag"} & set(head.headers)
    made = client.get(path)
    assert made.headers["content-type"] == head.headers["content-type"]
    assert client.head(path).headers["etag"] == made.headers["etag"]
