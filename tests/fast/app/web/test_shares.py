"""Shares of what the service computes at once: nobody waits for all that somebody else asked."""

from __future__ import annotations

import asyncio
import threading
from concurrent.futures import ThreadPoolExecutor

from local_client import local_client
from posted_sweeps import STUDY
from vibrafeed.app.jobs.fair_queue import FairQueue
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.core.lazy.view import ZarrView
from waiting import PATIENCE, wait_for


def test_conversions_run_no_more_at_once_than_there_are_places(tmp_path):
    """A conversion that blocks keeps another from starting; it starts once the first is over."""
    free, under_way, most = threading.Event(), [], []

    async def blocked(function, *arguments, **options):
        under_way.append(function)
        most.append(len(under_way))
        assert await asyncio.to_thread(free.wait, PATIENCE)
        under_way.pop()
        return "text"

    app = create_app(Settings(data_directory=tmp_path))
    app.state.process_pool = blocked
    blocked.fair_queue = FairQueue(2)
    with local_client(app) as client, ThreadPoolExecutor(4) as threads:
        asked = [threads.submit(client.post, "/convert?to=toml", json=STUDY) for _ in range(4)]
        # Others are answered meanwhile, and what is small and read only needs no place.
        assert client.get("/scenes").status_code == 200
        free.set()
        assert [one.result().text for one in asked] == ["text"] * 4
    assert max(most) == 1


def test_who_reads_many_chunks_takes_no_thread_from_small_slices(tmp_path, monkeypatch):
    """Chunks that block keep others from starting; what is in memory and small slices do not."""
    free, under_way, read = threading.Event(), [], ZarrView.read

    def blocked(view, key):
        if not key.endswith(".json"):
            under_way.append(key)
            assert free.wait(PATIENCE)
        return read(view, key)

    monkeypatch.setattr(ZarrView, "read", blocked)
    app = create_app(Settings(data_directory=tmp_path, workers=2))
    most = app.state.process_pool.fair_queue.slots - 1
    with local_client(app) as client, ThreadPoolExecutor(3 * most + 2) as threads:
        address = f"/sweeps/{client.post('/sweeps', json=STUDY).json()['id']}"
        chunk = f"{address}/zarr/acceleration_x/c/0/0/0/0"
        asked = [threads.submit(client.get, chunk) for _ in range(3 * most + 2)]
        wait_for(lambda: len(under_way) >= most)
        fixed = "amplitude=0.35 mm&frequency=20 Hz&alpha=0"
        slice_ = f"/slice?output=acceleration_x&axes=beta&{fixed}"
        for path in (slice_, "/zarr/zarr.json", "/zarr/beta/zarr.json"):
            assert client.get(f"{address}{path}").status_code == 200
        assert len(under_way) == most
        free.set()
        assert {one.result().status_code for one in asked} == {200}
