"""Clients that are not ours: xarray with zarr, curl, bare sockets."""

from __future__ import annotations

import hashlib
import http.client
import json
import os
import subprocess
import sys
import urllib.request
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.kinds.results import outline
from vibrafeed.core.lazy.view import ZarrView
from waiting import PATIENCE, wait_for

ENDS = {"frequency": (20, 120), "amplitude": (1e-4, 1e-3), "alpha": (0, 90), "beta": (0, 90)}
FIXED = {"friction": 0.3, "radius": "0.8 m", "distance": "0.2 mm"}


def study(outputs: list[str], **axes: object) -> dict[str, Any]:
    return {
        "kind": "sweep",
        "scene": "rectangle-on-track",
        "outputs": outputs,
        "parameters": {**FIXED, **axes},
    }


def sized(outputs: list[str], **sizes: int) -> dict[str, Any]:
    axes = {n: {"start": ENDS[n][0], "stop": ENDS[n][1], "num": size} for n, size in sizes.items()}
    return study(outputs, **axes)


TRILLION = sized(
    ["acceleration_x", "transport_velocity", "throw_number"],
    frequency=1000, amplitude=1000, alpha=1000, beta=1000,
)  # fmt: skip
LONG = sized(["transport_velocity"], frequency=10**6, amplitude=10**6)
LONG["parameters"] |= {"alpha": 10, "beta": 30}


def view_of(content: dict[str, Any]) -> ZarrView:
    sweep = prepare_content(content)
    return ZarrView(sweep, outline(sweep))


def post(server: str, content: dict[str, Any]) -> str:
    """Post a study; return the address of its sweep."""
    request = urllib.request.Request(
        f"{server}/sweeps", json.dumps(content).encode(), {"Content-Type": "application/json"}
    )
    with urllib.request.urlopen(request, timeout=PATIENCE) as response:
        return f"{server}/sweeps/{json.load(response)['id']}"


CLIENT = """
import json, sys, warnings
import numpy, xarray
first, second, path = sys.argv[1:]
xarray.open_zarr(first + "/zarr", chunks=None)  # loads what a client needs for its first group
sweep = xarray.open_zarr(second + "/zarr", chunks=None)
piece = sweep.isel(frequency=[0, 333, 999], amplitude=500, beta=slice(100, 900, 97)).sel(alpha=90)
piece.load()
print(json.dumps({
    "cells": sweep.transport_velocity.size,
    "dims": sweep.throw_number.dims,
    "regime": [str(sweep.regime.dtype), sweep.regime.attrs["flag_meanings"]],
    "scalars": {name: float(sweep[name]) for name in ("friction", "radius", "gravity")},
    "filled": [n for n, v in sweep.variables.items() if "_FillValue" in {*v.attrs, *v.encoding}],
}))
numpy.savez(path, **{name: piece[name].values for name in piece.variables})
"""


def zarr_requests(server):
    """Return how many requests for parts of Zarr groups the service has answered."""
    with urllib.request.urlopen(f"{server}/metrics", timeout=PATIENCE) as reply:
        lines = reply.read().decode().splitlines()
    counts = (line for line in lines if line.startswith("vibrafeed_requests_total"))
    return sum(float(line.rpartition(" ")[2]) for line in counts if "zarr" in line)


def test_xarray_opens_a_trillion_cells_at_once_and_slices_them(server, tmp_path):
    path = tmp_path / "piece.npz"
    addresses = [post(server, content) for content in (LONG, TRILLION)]
    before = zarr_requests(server)
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", CLIENT, *addresses, str(path)],
        capture_output=True, text=True, timeout=PATIENCE, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert report["cells"] == 10**12
    # What describes the two groups, ends of axes and the chunks of the piece: no more is fetched.
    assert zarr_requests(server) - before < 200
    assert report["dims"] == ["frequency", "amplitude", "beta"]
    assert report["regime"][0] == "int8"
    assert "flight" in report["regime"][1].split()
    assert report["scalars"] == {"friction": 0.3, "radius": 0.8, "gravity": 9.80665}
    assert report["filled"] == []
    with np.load(path) as piece:
        axes = {name: piece[name].tolist() for name in ENDS}
        # The witness: the same points as a small sweep of listed values.
        expected = tabulate(prepare_content(study(TRILLION["outputs"], **axes))).to_xarray()
        for name in ("transport_velocity", "acceleration_x", "throw_number", "regime"):
            order = [name for name in ("frequency", "beta") if name in expected[name].dims]
            wanted = expected[name].squeeze(drop=True).transpose(*order).values
            np.testing.assert_array_equal(piece[name], wanted)
        assert len(np.unique(piece["regime"])) > 1


def test_a_million_values_on_an_axis_are_chunks_too(server):
    view = view_of(LONG)
    address = post(server, LONG)
    for key in ("frequency/c/15", "transport_velocity/c/3906/3906"):
        with urllib.request.urlopen(f"{address}/zarr/{key}", timeout=PATIENCE) as response:
            assert response.read() == view.read(key)


def test_sixteen_readers_at_a_time_get_identical_bytes(server):
    address = post(server, TRILLION)
    keys = [f"{name}/c/31/31/31/{i}" for name in ("acceleration_x", "regime") for i in (0, 1)]

    def read(number: int) -> tuple[str, str]:
        key = keys[number % len(keys)]
        with urllib.request.urlopen(f"{address}/zarr/{key}", timeout=PATIENCE) as response:
            return key, hashlib.sha256(response.read()).hexdigest()

    with ThreadPoolExecutor(16) as pool:
        seen = set(pool.map(read, range(64)))
    view = view_of(TRILLION)
    assert seen == {(key, hashlib.sha256(view.read(key)).hexdigest()) for key in keys}


@pytest.mark.parametrize(
    "path",
    ["/../study.json", "/../../../../etc/passwd", "/c/0", "/acceleration_x/../zarr.json", "//",
     "/acceleration_x/c/0/0/0/-1", "/%2e%2e/netcdf", "/zarr.json%00", "/regime/c/1e9/0/0/0",
     "/acceleration_x%2Fzarr.json", "/" + "9/" * 140],
)  # fmt: skip
def test_no_path_leads_out_of_the_group(server, path):
    """Sent as it stands: most clients would tidy it first."""
    address = post(server, TRILLION)
    connection = http.client.HTTPConnection(server.removeprefix("http://"), timeout=PATIENCE)
    connection.request("GET", address.removeprefix(server) + "/zarr" + path)
    response = connection.getresponse()
    assert response.status == 404
    assert response.headers["content-type"] == "application/problem+json"
    assert json.load(response)["status"] == 404
    connection.close()


def test_a_head_is_followed_by_nothing(server):
    """A body after a HEAD would be taken for the next reply."""
    address = post(server, TRILLION).removeprefix(server)
    connection = http.client.HTTPConnection(server.removeprefix("http://"), timeout=PATIENCE)
    for key in ("zarr.json", "acceleration_x/c/0/0/0/0"):
        lengths = []
        for method in ("HEAD", "GET"):
            connection.request(method, f"{address}/zarr/{key}")
            response = connection.getresponse()
            assert response.status == 200
            lengths.append((response.headers["content-length"], len(response.read())))
        (told, nothing), (told_again, length) = lengths
        assert (told, nothing, told_again) == (str(length), 0, str(length))
    connection.close()


@pytest.fixture(scope="module")
def download(server) -> str:
    """Return the address of a file of several megabytes."""
    outputs = ["acceleration_x", "transport_velocity"]
    return post(server, sized(outputs, frequency=50, amplitude=10, alpha=50, beta=80)) + "/netcdf"


class TestCurl:
    def run(self, curl: str, *options: str | Path) -> subprocess.CompletedProcess[str]:
        command = [curl, "--silent", "--show-error", "--noproxy", "*", *map(str, options)]
        return subprocess.run(
            command, capture_output=True, text=True, timeout=PATIENCE, check=False
        )

    def test_a_broken_download_is_resumed(self, curl, download, tmp_path):
        file, headers = tmp_path / "x.nc", tmp_path / "headers"
        assert self.run(curl, "-o", file, download).returncode == 0  # HEAD makes no file
        told = self.run(curl, "--head", download)
        assert told.returncode == 0, told.stderr
        fields = dict(line.split(": ", 1) for line in told.stdout.splitlines() if ": " in line)
        size, etag = int(fields["content-length"]), fields["etag"]
        broken = self.run(curl, "--limit-rate", "1M", "--max-time", "1.5", "-o", file, download)
        assert broken.returncode == 28, broken.stderr  # out of time
        partial = file.stat().st_size
        assert 0 < partial < size
        resumed = self.run(curl, "-C", "-", "-D", headers, "-o", file, download)
        assert resumed.returncode == 0, resumed.stderr
        text = headers.read_text().lower()
        assert " 206 " in text.splitlines()[0]
        assert f"content-range: bytes {partial}-{size - 1}/{size}" in text
        assert f'"{hashlib.sha256(file.read_bytes()).hexdigest()}"' == etag
        assert file.stat().st_size == size

    def test_a_job_s_file_is_resumed_after_the_server_was_killed(self, curl, serve, tmp_path):
        service = serve(workers=1, max_wait_seconds=PATIENCE)
        content = sized(
            ["acceleration_x", "transport_velocity"], frequency=25, amplitude=30, alpha=50, beta=80
        )  # of more bytes than sockets hold
        study = tmp_path / "study.json"
        study.write_text(json.dumps(content))
        execution = f"{service.address}/processes/sweep/execution"
        wait = [
            "-H",
            f"Prefer: respond-async, wait={PATIENCE:.0f}",
            "-H",
            "Content-Type: application/json",
        ]
        told = self.run(curl, *wait, "-d", f"@{study}", execution)
        result = json.loads(told.stdout)["dataset"]
        whole, file = tmp_path / "whole.nc", tmp_path / "x.nc"
        assert self.run(curl, "-o", whole, result["href"]).returncode == 0
        assert whole.stat().st_size == result["length"]
        slow = [curl, "--silent", "--noproxy", "*", "--limit-rate", "1M", "-o", file]
        with subprocess.Popen([*slow, result["href"]]) as broken:
            wait_for(lambda: file.exists() and file.stat().st_size)
            service.kill()
            assert broken.wait(PATIENCE) == 18  # a part of the file
        partial = file.stat().st_size
        assert 0 < partial < result["length"]
        service.start()
        resumed = self.run(curl, "-C", "-", "-w", "%{http_code}", "-o", file, result["href"])
        assert (resumed.returncode, resumed.stdout) == (0, "206"), resumed.stderr
        assert file.read_bytes() == whole.read_bytes()

    def test_what_is_complete_is_not_sent_again(self, curl, download, tmp_path):
        file, kept = tmp_path / "x.nc", tmp_path / "etag"
        assert self.run(curl, "-o", file, "--etag-save", kept, download).returncode == 0
        again = self.run(
            curl, "-o", tmp_path / "y.nc", "--etag-compare", kept, "-w", "%{http_code}", download
        )
        assert again.stdout == "304"
        assert not (tmp_path / "y.nc").exists() or (tmp_path / "y.nc").stat().st_size == 0

    def test_the_service_answers_while_a_slow_client_downloads(self, curl, server, download):
        slow = subprocess.Popen(
            [curl, "--silent", "--noproxy", "*", "--limit-rate", "100k", "-o", os.devnull, download]
        )
        try:
            for _ in range(20):
                urllib.request.urlopen(f"{server}/healthz", timeout=PATIENCE).close()
            # A blocked loop would have waited for the client, which takes minutes.
            assert slow.poll() is None
        finally:
            slow.terminate()
            slow.wait(PATIENCE)
