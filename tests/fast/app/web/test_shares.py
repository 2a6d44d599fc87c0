"""Shares of what the service computes at once: nobody waits for all that somebody else asked."""

from __future__ import annotations

import asyncio
import threading

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
        assert await asyncio.to_thread(free.wait, 60)
        under_way.pop()
        return "text"

    app = create_app(Settings(data_directory=tmp_path))
    app.state.process_pool = blocked
    blocked.fair_queue = FairQueue(2)
    study = {
        "kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["acceleration_x"],
        "parameters": {"frequency": 50, "amplitude": "0.3 mm", "beta": 20, "friction": 0.3},
    }  # fmt: skip
    with local_client(app) as client:
        replies = []
        threads = [
            threading.Thread(
                target=lambda: replies.append(client.post("/convert?to=toml", json=study))
            )
            for _ in range(4)
        ]
        for thread in threads:
            thread.start()
        # Others are answered meanwhile, and what is small and read only needs no place.
        assert client.get("/scenes").status_code == 200
        free.set()
        for thread in threads:
            thread.join()
    assert [reply.text for reply in replies] == ["text"] * 4
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
    app = create_app(Settings(data_directory=tmp_path))
    with local_client(app) as client:
        address = f"/sweeps/{client.post('/sweeps', json=STUDY).json()['id']}"
        most = client.app.state.process_pool.fair_queue.slots - 1
        statuses = []

        def ask():
            path = f"{address}/zarr/acceleration_x/c/0/0/0/0"
            statuses.append(client.get(path).status_code)

        threads = [threading.Thread(target=ask) for _ in range(3 * most + 2)]
        assert client.get(f"{address}/zarr/zarr.json").status_code == 200
        for thread in threads:
            thread.start()
        wait_for(lambda: len(under_way) >= most)
        fixed = "amplitude=0.35 mm&frequency=20 Hz&alpha=0"
        cut = client.get(f"{address}/slice?output=acceleration_x&axes=beta&{fixed}")
        assert cut.status_code == 200
        assert client.get(f"{address}/zarr/beta/zarr.json").status_code == 200
        assert len(under_way) == most
        free.set()
        for thread in threads:
            thread.join()
    assert statuses == [200] * len(threads)
