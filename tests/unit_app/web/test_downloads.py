"""What clients keep, ask for again and resume: NetCDF files, binary slices, Zarr keys."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import hashlib
import json
import os
import struct
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from fastapi import Request
from fastapi.testclient import TestClient

from app.jobs.errors import NotFoundError
from app.jobs.manifest import NETCDF
from app.main import create_app
from app.settings import Settings
from app.web.downloads import PIECE, etag_of, file_reply
from app.web.routes.sweeps import prefers_binary
from app.web.zarr_views import ZarrViews
from core.kinds import prepare_content
from core.study import parse_study
from core.sweep import sweep
from core.sweep.zarr_view import ZarrView

STUDY = {
    "kind": "sweep",
    "scene": "rectangle-on-track",
    "outputs": ["acceleration_x", "transport_velocity", "throw_number"],
    "parameters": {
        "frequency": {"start": "20 Hz", "stop": "120 Hz", "num": 11},
        "amplitude": ["0.35 mm", "0.5 mm"],
        "alpha": {"start": 0, "stop": 90, "num": 10},
        "beta": {"start": 0, "stop": 90, "num": 7},
        "friction": 0.3,
        "radius": "0.8 m",
        "distance": "0.2 mm",
    },
}


def with_axes(**sizes: int) -> dict:
    ends = {"frequency": (20, 120), "amplitude": (1e-4, 1e-3), "alpha": (0, 90), "beta": (0, 90)}
    axes = {
        name: {"start": ends[name][0], "stop": ends[name][1], "num": size}
        for name, size in sizes.items()
    }
    return {**STUDY, "parameters": {**STUDY["parameters"], **axes}}


TRILLION = with_axes(frequency=1000, amplitude=1000, alpha=1000, beta=1000)


@pytest.fixture
def client(tmp_path: Path):
    settings = Settings(data_directory=tmp_path, max_cells=10**6)
    app = create_app(settings)
    headers = {"X-Request-ID": "one"}  # so that replies to GET and HEAD have equal headers
    with TestClient(app, raise_server_exceptions=False, headers=headers) as client:
        yield client


@pytest.fixture
def address(client: TestClient) -> str:
    return f"/sweeps/{client.post('/sweeps', json=STUDY).json()['id']}"


def problem(response, status: int) -> dict:
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    document = response.json()
    assert document["status"] == status
    return document


def result_of(client: TestClient, address: str) -> Path:
    """Return the file that a sweep is downloaded from."""
    return client.app.state.store.folder(address.rpartition("/")[2]) / NETCDF


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

    @pytest.mark.parametrize(
        ("wanted", "start", "stop"),
        [
            ("bytes=0-0", 0, 1),
            ("bytes=100-", 100, None),
            ("bytes=100-199", 100, 200),
            ("Bytes=5-999999999999999999", 5, None),
            ("bytes=-100", -100, None),
            ("bytes=-999999999999999999", 0, None),
        ],
    )
    def test_a_range(self, client, address, whole, wanted, start, stop):
        part = client.get(f"{address}/netcdf", headers={"Range": wanted})
        assert part.status_code == 206
        expected = whole.content[start:stop]
        assert part.content == expected
        first = start % len(whole.content)
        last, size = first + len(expected) - 1, len(whole.content)
        assert part.headers["content-range"] == f"bytes {first}-{last}/{size}"
        assert part.headers["content-length"] == str(len(expected))
        assert part.headers["etag"] == whole.headers["etag"]

    @pytest.mark.parametrize(
        "wanted",
        ["bytes=", "bytes=-", "bytes=9-1", "bytes=a-b", "lines=0-1", "bytes=0-1,4-5", "bytes=--1",
         "bytes=" + "9" * 60 + "-", "0-1", ""],
    )  # fmt: skip
    def test_a_range_that_is_none_gives_the_whole(self, client, address, whole, wanted):
        response = client.get(f"{address}/netcdf", headers={"Range": wanted})
        assert (response.status_code, response.content) == (200, whole.content)

    @pytest.mark.parametrize("wanted", ["bytes={size}-", "bytes=999999999999-", "bytes=-0"])
    def test_a_range_past_the_end(self, client, address, whole, wanted):
        size = len(whole.content)
        headers = {"Range": wanted.format(size=size)}
        response = client.get(f"{address}/netcdf", headers=headers)
        assert problem(response, 416)["type"].endswith("range")
        assert response.headers["content-range"] == f"bytes */{size}"

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
        for stale in ('"other"', f"W/{etag}", "Sat, 21 Nov 2026 09:00:00 GMT"):
            assert get(If_Range=stale, Range="bytes=0-1").status_code == 200
        assert get(If_Match=etag).status_code == 200
        assert get(If_Match="*").status_code == 200
        problem(get(If_Match='"other"'), 412)
        problem(get(If_Match=f"W/{etag}"), 412)
        assert client.head(f"{address}/netcdf", headers={"Range": "bytes=0-1"}).status_code == 200

    def test_it_is_sent_in_pieces(self, client, monkeypatch):
        monkeypatch.setattr("app.web.downloads.PIECE", 1000)
        key = client.post("/sweeps", json=STUDY).json()["id"]
        with client.stream("GET", f"/sweeps/{key}/netcdf") as response:
            content = response.read()
        assert len(content) == int(response.headers["content-length"]) > 1000
        assert PIECE == 2**20

    @pytest.mark.parametrize("method", ["GET", "HEAD"])
    def test_a_file_that_is_not_there_any_more(self, client, address, whole, method):
        """Removed to make room after its manifest was read."""
        result_of(client, address).unlink()
        response = client.request(method, f"{address}/netcdf")
        assert response.status_code == 404
        if method == "GET":
            assert "has been removed" in problem(response, 404)["detail"]

    def test_a_file_that_goes_before_the_first_header(self, client, address, whole, monkeypatch):
        def removed(request, path, **about):
            reply = file_reply(request, path, **about)
            path.unlink()
            return reply

        monkeypatch.setattr("app.web.routes.sweeps.file_reply", removed)
        document = problem(client.get(f"{address}/netcdf"), 404)
        assert document["type"] == "urn:vibrafeed:problem:not-found"

    @pytest.mark.parametrize("number", [errno.EMFILE, errno.ENFILE])
    def test_too_many_open_files(self, client, address, whole, monkeypatch, number):
        def open_(path, *arguments, **options):
            raise OSError(number, os.strerror(number), str(path))

        with monkeypatch.context() as full:
            full.setattr(Path, "open", open_)
            response = client.get(f"{address}/netcdf")
        document = problem(response, 503)
        assert document["type"] == "urn:vibrafeed:problem:busy"
        assert "many files" in document["detail"]
        assert "netcdf" not in document["detail"]  # nor any path
        assert int(response.headers["retry-after"]) >= 1
        assert client.get(f"{address}/netcdf").content == whole.content

    def test_no_reply_leaves_the_file_open(self, client, address, whole):
        path, etag = result_of(client, address), whole.headers["etag"]
        for status, method, headers in (
            (200, "GET", {}),
            (200, "HEAD", {}),
            (206, "GET", {"Range": "bytes=5-9"}),
            (304, "GET", {"If-None-Match": etag}),
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
            "type": "http", "method": "GET", "headers": [], "asgi": {"spec_version": version}
        }  # fmt: skip
        reply = file_reply(
            Request(scope), path, digest="00" * 32, media_type="text/plain", filename="x"
        )
        seen = []

        async def receive():
            await asyncio.Event().wait()

        async def send(message):
            seen.append((message["type"], times_open(path)))
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
            assert seen == [("http.response.start", 1)]  # open before the first header
        assert times_open(path) == 0

    def test_a_sweep_that_is_too_large_for_a_file_is_refused_and_read_in_pieces(self, client):
        posted = client.post("/sweeps", json=TRILLION)
        assert posted.status_code == 201
        assert posted.json()["cells"] == 10**12
        address = f"/sweeps/{posted.json()['id']}"
        document = problem(client.get(f"{address}/netcdf"), 422)
        assert document["type"].endswith("limit")
        assert "1,000,000" in document["detail"]
        params = {"output": "acceleration_x", "axes": "beta", "alpha": 90, "amplitude": 1e-3}
        piece = client.get(f"{address}/slice", params={**params, "frequency": 20})
        assert piece.status_code == 200
        assert len(piece.json()["values"]["data"]) == 1000

    def test_what_is_too_large_to_be_kept_is_refused(self, client):
        long = with_axes(frequency=10_000_000)
        document = problem(client.post("/sweeps", json=long), 422)
        assert "Give frequency 2,000,000 values or fewer" in document["detail"]
        many = with_axes(frequency=10**6, amplitude=10**6, alpha=10**6)
        assert "cells" in problem(client.post("/sweeps", json=many), 422)["detail"]


def unpack(content: bytes) -> tuple[dict, dict[str, np.ndarray]]:
    """Read a binary slice by `docs/api.md` alone."""
    (length,) = struct.unpack_from("<Q", content)
    header = json.loads(content[8 : 8 + length])
    values = content[8 + length :]

    def array(place: dict) -> np.ndarray:
        dtype, shape = np.dtype(place["dtype"]), tuple(place["shape"])
        count = int(np.prod(shape))
        assert (8 + length + place["offset"]) % dtype.itemsize == 0
        return np.frombuffer(values, dtype, count, place["offset"]).reshape(shape)

    arrays = {axis["name"]: array(axis["values"]) for axis in header["axes"]}
    return header, arrays | {name: array(header[name]["data"]) for name in ("values", "regime")}


CUT = {
    "output": "transport_velocity",
    "axes": "alpha,frequency",
    "beta": "15 deg",
    "amplitude": "0.5 mm",
}


class TestSlice:
    def test_binary_and_json_are_the_same_slice(self, client, address):
        told = client.get(f"{address}/slice", params=CUT)
        raw = client.get(f"{address}/slice", params={**CUT, "format": "binary"})
        by_accept = client.get(
            f"{address}/slice", params=CUT, headers={"Accept": "application/octet-stream"}
        )
        assert told.headers["content-type"] == "application/json"
        assert raw.headers["content-type"] == "application/octet-stream"
        assert by_accept.content == raw.content
        header, arrays = unpack(raw.content)
        assert header.keys() == told.json().keys()
        for name in ("output", "unit", "fixed", "regimes"):
            assert header[name] == told.json()[name]
        whole = sweep(parse_study(STUDY)).sel(beta=15, amplitude=5e-4)
        np.testing.assert_array_equal(arrays["values"].T, whole.transport_velocity)
        np.testing.assert_array_equal(arrays["regime"].T, whole.regime)
        assert arrays["regime"].dtype == np.int8
        for axis in ("alpha", "frequency"):
            np.testing.assert_array_equal(arrays[axis], whole[axis])
        assert header["values"]["dims"] == ["alpha", "frequency"]

    def test_what_json_has_no_word_for_is_kept(self, client):
        study = {
            "kind": "sweep",
            "scene": "rectangle-on-track",
            "outputs": ["transport_velocity"],
            "parameters": {**STUDY["parameters"], "distance": [1e-4, 1e3], "friction": [0, 5]},
        }
        key = client.post("/sweeps", json=study).json()["id"]
        params = {**CUT, "axes": "distance,friction", "alpha": 0, "frequency": 20}
        told = client.get(f"/sweeps/{key}/slice", params=params).json()["values"]["data"]
        raw = client.get(f"/sweeps/{key}/slice", params={**params, "format": "binary"})
        _, arrays = unpack(raw.content)
        np.testing.assert_array_equal(np.array(told, dtype=float), arrays["values"])

    def test_etags(self, client, address):
        seen = set()
        for change in ({}, {"format": "binary"}, {"beta": 30}, {"axes": "frequency,alpha"}):
            params = {**CUT, **change}
            response = client.get(f"{address}/slice", params=params)
            etag = response.headers["etag"]
            assert response.headers["vary"] == "Accept"
            assert "immutable" in response.headers["cache-control"]
            again = client.get(f"{address}/slice", params=params, headers={"If-None-Match": etag})
            assert (again.status_code, again.content) == (304, b"")
            assert again.headers["vary"] == "Accept"
            seen.add(etag)
        assert len(seen) == 4

    @pytest.mark.parametrize(
        ("accept", "expected"),
        [
            ("", False),
            ("*/*", False),
            ("application/json", False),
            ("application/octet-stream", True),
            ("application/octet-stream, */*;q=0.1", True),
            ("application/json, application/octet-stream", False),
            ("application/json;q=0.5, application/octet-stream;q=0.9", True),
            ("application/octet-stream;q=0", False),
            ("application/octet-stream;q=x", False),
            ("Application/Octet-Stream ; v=1", True),
        ],
    )
    def test_accept(self, accept, expected):
        assert prefers_binary(accept) is expected

    def test_wrong_forms(self, client, address):
        params = {**CUT, "format": "xml"}
        assert problem(client.get(f"{address}/slice", params=params), 422)["errors"]
        params = {**CUT, "format": "binary", "output": "nothing"}
        assert problem(client.get(f"{address}/slice", params=params), 422)["errors"]
        problem(client.get(f"/sweeps/{'0' * 64}/slice", params=CUT), 404)


class TestZarr:
    def test_keys_are_those_of_the_core(self, client, address):
        view = ZarrView(prepare_content(STUDY))
        for key, media_type in (
            ("zarr.json", "application/json"),
            ("regime/zarr.json", "application/json"),
            ("regime/c/0/0/0/0", "application/octet-stream"),
            ("transport_velocity/c/0/0/0/0", "application/octet-stream"),
            ("frequency/c/0", "application/octet-stream"),
            ("friction/c", "application/octet-stream"),
        ):
            response = client.get(f"{address}/zarr/{key}")
            assert response.status_code == 200
            assert response.content == view.read(key)
            assert response.headers["content-type"] == media_type
            assert response.headers["cache-control"] == "max-age=31536000, immutable"
            head = client.head(f"{address}/zarr/{key}")
            assert (head.status_code, head.content) == (200, b"")
            assert dict(head.headers) == dict(response.headers)

    def test_the_sweep_names_its_group(self, client, address):
        assert client.get(address).json()["links"]["zarr"] == f"{address}/zarr"
        documented = client.get("/openapi.json").json()["paths"]["/sweeps/{key}/zarr/{path}"]
        assert set(documented["get"]["responses"]) == {"200", "304", "401", "404", "422"}

    def test_an_etag_is_known_without_computing(self, client, monkeypatch):
        key = client.post("/sweeps", json=TRILLION).json()["id"]
        path = f"/sweeps/{key}/zarr/acceleration_x/c/1/2/3/4"
        etag = client.get(path).headers["etag"]
        assert etag == client.get(path).headers["etag"]
        assert etag != client.get(path[:-1] + "5").headers["etag"]
        monkeypatch.setattr(ZarrView, "_values", None)  # whatever computes would fail
        again = client.get(path, headers={"If-None-Match": etag})
        assert (again.status_code, again.content) == (304, b"")
        assert again.headers["etag"] == etag
        head = client.head(path[:-1] + "7")
        assert (head.status_code, head.headers["content-length"]) == (200, str(16**4 * 8))
        problem(client.get(path[:-1] + "7"), 500)

    @pytest.mark.parametrize(
        "path",
        [
            "", ".zgroup", ".zmetadata", "zarr.json/", "c/0", "nothing/zarr.json", "regime",
            "acceleration_x/c/0", "acceleration_x/c/0/0/0/-1", "acceleration_x/c/0/0/0/1",
            "acceleration_x/c/0/0/0/" + "9" * 200, "acceleration_x/c/0/0/0/00",
            "acceleration_x/c/0/0/0/0x0", "acceleration_x/c/0/0/0/0%00",
            "acceleration_x%2Fzarr.json", "acceleration_x%2fc%2f0%2f0%2f0%2f0",
            "%2e%2e%2fstudy.json", "..%2Fstudy.json", "..%5Cstudy.json", "%2Fetc%2Fpasswd",
            "acceleration_x/c/%D9%A1/0/0/0", "%ff%fe",
        ],
    )  # fmt: skip
    @pytest.mark.parametrize("method", ["GET", "HEAD"])
    def test_other_keys_are_not_found(self, client, address, path, method):
        response = client.request(method, f"{address}/zarr/{path}")
        assert response.status_code == 404
        if method == "GET":
            problem(response, 404)

    def test_long_keys_and_other_sweeps(self, client, address):
        problem(client.get(f"{address}/zarr/{'x' * 301}"), 422)
        problem(client.get(f"/sweeps/{'0' * 64}/zarr/zarr.json"), 404)
        problem(client.get("/sweeps/..%2F..%2Fx/zarr/zarr.json"), 404)
        problem(client.put(f"{address}/zarr/zarr.json"), 405)

    def test_many_readers_get_the_same_bytes(self, client):
        key = client.post("/sweeps", json=TRILLION).json()["id"]
        paths = [f"/sweeps/{key}/zarr/transport_velocity/c/9/9/9/{i % 2}" for i in range(32)]
        with ThreadPoolExecutor(16) as pool:
            contents = list(pool.map(lambda path: client.get(path).content, paths))
        view = ZarrView(prepare_content(TRILLION))
        assert set(contents) == {view.read(f"transport_velocity/c/9/9/9/{i}") for i in (0, 1)}


class TestMemory:
    class Store:
        def __init__(self):
            self.asked: list[str] = []
            self.is_there = True

        def used(self, key: str) -> float:
            return float(self.is_there)

        def note_use(self, key: str) -> None:
            pass

        def sweep(self, key: str):
            self.asked.append(key)
            if not self.is_there:
                raise NotFoundError(key)
            return prepare_content(TRILLION)

    def test_chunks_that_were_read_last_are_kept_within_the_budget(self, monkeypatch):
        store = self.Store()
        views = ZarrViews(store, most_bytes=2 * 524_288)
        computed = []
        read = ZarrView.read
        monkeypatch.setattr(
            ZarrView, "read", lambda v, path: computed.append(path) or read(v, path)
        )
        a, b, c = (f"acceleration_x/c/0/0/0/{i}" for i in range(3))
        for path in (a, b, a, c, a, b):
            assert len(views.read("k", path)) == 524_288
        assert computed == [a, b, c, b]  # b is the one that was not read for the longest time
        assert store.asked == ["k"]

    def test_a_sweep_that_has_been_removed_is_forgotten(self):
        store = self.Store()
        views = ZarrViews(store, most_bytes=1_000_000)
        views.view("k")
        store.is_there = False
        for _ in range(2):
            with pytest.raises(NotFoundError):
                views.view("k")

    def test_no_budget_keeps_nothing(self):
        views = ZarrViews(self.Store(), most_bytes=0)
        assert views.read("k", "zarr.json") == views.read("k", "zarr.json")
        with pytest.raises(KeyError):
            views.read("k", "nothing")


def test_an_etag_tells_words_apart():
    assert etag_of("ab", "c") != etag_of("a", "bc")
    assert etag_of("a")[0] == etag_of("a")[-1] == '"'
