"""Shares of what the service computes at once: nobody waits for all that somebody else asked."""

from __future__ import annotations

import asyncio
import threading
from types import SimpleNamespace

from local_client import local_client
from posted_sweeps import STUDY
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.app.web.shares import Shares, large_slot_of, slot_of
from vibrafeed.core.lazy.view import ZarrView
from waiting import PATIENCE, wait_for


def order_of(asked: list[tuple[str, int]], *, places: int, of_one: int) -> list[int]:
    """Return in which order requests of (owner, price) run while the first keep their places."""

    async def run() -> list[int]:
        shares, order = Shares(places, of_one), []

        async def ask(n: int, owner: str, price: int) -> None:
            async with shares.slot(owner, price):
                order.append(n)
                await asyncio.sleep(0)

        await asyncio.gather(*(ask(n, *one) for n, one in enumerate(asked)))
        return order

    return asyncio.run(run())


def test_an_owner_who_comes_last_is_next():
    asked = [("many", 0)] * 20 + [("few", 0)]
    assert order_of(asked, places=1, of_one=1).index(20) == 1
    # Where one owner has fewer places than there are, the last comes without waiting.
    assert order_of(asked, places=3, of_one=2).index(20) == 2


def test_owners_take_turns():
    asked = [("a", 0)] * 4 + [("b", 0)] * 4 + [("c", 0)] * 4
    order = order_of(asked, places=1, of_one=1)
    assert [asked[n][0] for n in order] == ["a", "b", "c"] * 4


def test_a_large_body_lets_small_ones_pass_but_not_for_ever():
    asked = [("a", 0), ("a", 5), *[("a", 0)] * 10]
    assert order_of(asked, places=1, of_one=1) == [0, 2, 3, 4, 5, 6, 1, 7, 8, 9, 10, 11]


def test_those_who_compute_share_the_cores(monkeypatch):
    monkeypatch.setattr("vibrafeed.app.web.shares.CORES", 5)

    async def run() -> list[int]:
        shares, found = Shares(9, 9), []

        async def ask() -> None:
            async with shares.slot("a"):
                found.append(shares.threads)
                if len(found) < 7:
                    await ask()

        await ask()
        assert shares.threads == 5
        return found

    assert asyncio.run(run()) == [5, 2, 1, 1, 1, 1, 1]


def test_who_leaves_gives_back_the_place_and_the_turn():
    async def run() -> None:
        shares = Shares(slots=1, of_owner=1)

        async def keep() -> None:
            async with shares.slot("a"):
                await asyncio.Event().wait()

        running, waiting = asyncio.create_task(keep()), asyncio.create_task(keep())
        await asyncio.sleep(0)
        waiting.cancel()
        running.cancel()
        await asyncio.gather(running, waiting, return_exceptions=True)
        async with shares.slot("b"):
            pass
        assert not shares._waiting
        assert not shares._taken.total()

    asyncio.run(run())


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
    app.state.shares, app.state.process_pool = Shares(slots=2, of_owner=1), blocked
    blocked.close = lambda: None
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


def test_a_large_slice_takes_a_place_of_either_kind():
    state = SimpleNamespace(shares=Shares(3, 2), large_shares=Shares(3, 1))

    async def connected():
        return False

    request = SimpleNamespace(
        app=SimpleNamespace(state=state),
        scope={"client": ("127.0.0.1", 1)},
        is_disconnected=connected,
    )
    seen = []

    async def cut(own):
        async with own(request):
            seen.append((state.shares._taken.total(), state.large_shares._taken.total()))
            await asyncio.sleep(0)

    async def run():
        await asyncio.gather(*(cut(large_slot_of) for _ in range(4)), cut(slot_of))

    asyncio.run(run())
    assert len(seen) == 5
    assert max(large for _, large in seen) == 1  # of one owner
    assert max(places for places, _ in seen) == 2  # the other request need not wait
    assert not state.shares._taken.total()
    assert not state.large_shares._taken.total()


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
        most = int(client.app.state.shares._of_owner)
        statuses = []

        def ask(wishes):
            path = f"{address}/zarr/{wishes}acceleration_x/c/0/0/0/0"
            statuses.append(client.get(path).status_code)

        threads = [
            threading.Thread(target=ask, args=(wishes,))
            for wishes in ["chunks=beta:1/", "chunks=beta:2/"] + [""] * 3 * most
        ]
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
