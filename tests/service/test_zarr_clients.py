"""Clients that are not ours: xarray with zarr, curl, bare sockets; groups that grow."""

import json
import random
import re
import subprocess
import sys
import time
import urllib.parse
from typing import Any

import numpy as np
import xarray
from obstore.store import HTTPStore
from zarr.storage import ObjectStore

from night import count
from posted_sweeps import TRILLION, with_axes
from services import QUICK, Server, refusal
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from waiting import PATIENCE, wait_for

LONG = with_axes(frequency=10**6, amplitude=10**6)
LONG["parameters"] |= {"alpha": 10, "beta": 30}


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
    counts = re.findall(
        r"^vibrafeed_requests_total.*zarr.* (\S+)$", server.ask("/metrics").decode(), re.M
    )
    return sum(map(float, counts))


def test_xarray_opens_a_trillion_cells_at_once_and_slices_them(shared, tmp_path):
    path = tmp_path / "piece.npz"
    keys = [json.loads(shared.ask("/sweeps", content))["id"] for content in (LONG, TRILLION)]
    addresses = [f"{shared.address}/sweeps/{key}" for key in keys]
    before = zarr_requests(shared)
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", CLIENT, *addresses, str(path)],
        capture_output=True, text=True, timeout=PATIENCE, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert report["cells"] == 10**12
    # What describes the two groups, ends of axes and the chunks of the piece: no more is fetched.
    assert zarr_requests(shared) - before < 200
    assert report["dims"] == ["frequency", "amplitude", "beta"]
    assert report["regime"][0] == "int8"
    assert "flight" in report["regime"][1].split()
    assert report["scalars"] == {"friction": 0.3, "radius": 0.8, "gravity": 9.80665}
    assert report["filled"] == []
    with np.load(path) as piece:
        axes = {name: piece[name].tolist() for name in TRILLION["parameters"] if name in piece}
        # The witness: the same points as a small sweep of listed values.
        expected = tabulate(
            prepare_content({**TRILLION, "parameters": {**TRILLION["parameters"], **axes}})
        ).to_xarray()
        for name in ("transport_velocity", "acceleration_x", "throw_number", "regime"):
            order = [name for name in ("frequency", "beta") if name in expected[name].dims]
            wanted = expected[name].squeeze(drop=True).transpose(*order).values
            np.testing.assert_array_equal(piece[name], wanted)
        assert len(np.unique(piece["regime"])) > 1


def curled(curl: str, *options: object) -> subprocess.CompletedProcess[str]:
    command = [curl, "--silent", "--show-error", "--noproxy", "*", *map(str, options)]
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)


def test_a_download_is_resumed_after_the_server_was_killed(curl, serve, tmp_path):
    service = serve(workers=1)
    # Of more bytes than sockets hold.
    content = with_axes(frequency=25, amplitude=30, alpha=50, beta=80)
    job = service.finished(service.post(content))
    result = service.get(f"/jobs/{job['jobID']}/results")["dataset"]
    whole, file, headers = tmp_path / "whole.nc", tmp_path / "x.nc", tmp_path / "headers"
    assert curled(curl, "-o", whole, result["href"]).returncode == 0
    assert whole.stat().st_size == result["length"]
    slow = [curl, "--silent", "--noproxy", "*", "--limit-rate", "1M", "-o", file]
    with subprocess.Popen([*slow, result["href"]]) as broken:
        wait_for(lambda: file.exists() and file.stat().st_size)
        service.kill()
        assert broken.wait(PATIENCE) == 18  # a part of the file
    partial = file.stat().st_size
    assert 0 < partial < result["length"]
    service.start()
    resumed = curled(curl, "-C", "-", "-D", headers, "-o", file, result["href"])
    assert resumed.returncode == 0, resumed.stderr
    told = f"content-range: bytes {partial}-{result['length'] - 1}/{result['length']}"
    assert told in headers.read_text().lower()
    assert file.read_bytes() == whole.read_bytes()


KILLS = count(1, 4, "KILLS")
FREQUENCIES = 110 if KILLS == 1 else 320  # the last kill is to meet work

GROWING: dict[str, Any] = {
    "kind": "sweep",
    "scene": "rectangle-on-track",
    "outputs": ["transport_velocity", "throw_number"],
    "verify": 3,
    "parameters": {
        "frequency": {"start": "20 Hz", "stop": "120 Hz", "num": FREQUENCIES},
        "amplitude": {"start": "0.1 mm", "stop": "1 mm", "num": 80},
        "alpha": {"start": 0, "stop": 90, "num": 13},
        "beta": {"start": 0, "stop": 90, "num": 80},
        "friction": 0.3,
        "radius": 0.8,
        "distance": "0.2 mm",
    },
}


def group(server: Server, number: str) -> xarray.Dataset:
    """Open the result of a job; the client is Rust's, which leaves no socket of Python behind."""
    address = f"http://127.0.0.1:{server.port}/jobs/{number}/results/zarr"
    files = HTTPStore.from_url(address, client_options={"allow_http": True})
    return xarray.open_zarr(ObjectStore(files, read_only=True), chunks=None)


def test_it_is_read_while_it_grows_and_survives_kills(serve: Any) -> None:
    server = serve(**QUICK, max_cells=1_000_000, workers=1)
    # What is more than the disk or a job may take is refused.
    larger = {**GROWING["parameters"], "gravity": {"start": 9, "stop": 10, "num": 1000}}
    told = refusal(lambda: server.post({**GROWING, "parameters": larger}), 422)["detail"]
    assert "bytes, the limit is 50,000,000,000" in told
    assert "It fits with" in told
    number = server.post(GROWING)
    job = server.waited(number, lambda job: job["progress"] >= 10)
    assert job["status"] == "running"
    for key in ("unfinished.json", "growing.json", "../study.json", "throw_number/c/99/0/0", "a/b"):
        path = f"/jobs/{number}/results/zarr/{urllib.parse.quote(key, safe='/')}"
        refusal(lambda path=path: server.ask(path), 404)
    growing = group(server, number)
    assert "unfinished" in growing.attrs
    assert list(growing.sizes.values()) == [FREQUENCIES, 80, 13, 80]
    assert float(growing.frequency[-1]) == 120
    there = growing.transport_velocity.isel(amplitude=3, alpha=2, beta=7).values
    assert np.isfinite(there).any()

    chance = random.Random(16)
    for _ in range(KILLS):
        time.sleep(chance.uniform(0.3, 1.5))
        server.kill()
        server.launch()
    job = server.finished(number)
    assert job["status"] == "successful", job
    assert any(link["href"].endswith("/results/zarr") for link in job["links"])

    result = server.get(f"/jobs/{number}/results")["dataset"]
    assert result["href"].endswith(f"/jobs/{number}/results/zarr")
    assert result["length"] > 10_000_000
    whole = group(server, number)
    assert whole.attrs["verified_cells"] == 3
    assert "being written" not in whole.attrs["comment"]
    box = {"frequency": (100, 105), "amplitude": (40, 48)}
    want = tabulate(prepare_content({**GROWING, "verify": None}).within(box)).to_xarray()
    found = whole.isel({name: slice(*ends) for name, ends in box.items()})
    for name in ("transport_velocity", "throw_number", "regime"):
        np.testing.assert_array_equal(found[name].values, want[name].values)
    assert "Zarr group" in refusal(lambda: server.dataset(number), 404)["detail"]
    (folder,) = (server.folder / "data" / "studies").iterdir()
    assert sorted(one.name for one in folder.iterdir()) == [
        "manifest.json", "result.zarr", "result.zarr.sha256", "study.json",
    ]  # fmt: skip
    # Nobody else on the machine reads a study or a result.
    for path in (server.folder / "data").rglob("*"):
        assert path.stat().st_mode & 0o077 == 0, path
