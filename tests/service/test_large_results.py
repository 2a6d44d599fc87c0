"""Sweeps too large for one file: a Zarr group that clients read while it grows, kills or not."""

from __future__ import annotations

import random
import time
import urllib.parse
from typing import Any

import numpy as np
import xarray
from obstore.store import HTTPStore
from zarr.storage import ObjectStore

from night import count
from services import QUICK, Server, refusal
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate

KILLS = count(1, 4, "KILLS")
FREQUENCIES = 110 if KILLS == 1 else 320  # the last kill is to meet work

STUDY: dict[str, Any] = {
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
    larger = {**STUDY["parameters"], "gravity": {"start": 9, "stop": 10, "num": 1000}}
    told = refusal(lambda: server.post({**STUDY, "parameters": larger}), 422)["detail"]
    assert "bytes, the limit is 50,000,000,000" in told
    assert "It fits with" in told
    number = server.post(STUDY)
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
    want = tabulate(prepare_content({**STUDY, "verify": None}).within(box)).to_xarray()
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
