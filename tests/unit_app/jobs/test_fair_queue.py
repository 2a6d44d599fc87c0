"""Whose turn it is on the workers, and what a server takes up."""

from __future__ import annotations

import asyncio
from pathlib import Path

from vibrafeed.app.jobs.fair_queue import FairQueue
from vibrafeed.app.jobs.ledger import Work
from vibrafeed.app.jobs.runner import next_item
from vibrafeed.app.settings import Settings


async def turned() -> None:
    """Let all go on that can."""
    for _ in range(5):
        await asyncio.sleep(0)


def test_who_comes_late_is_next():
    async def scene() -> None:
        fair_queue = FairQueue(10.0)
        fair_queue.resize(2)
        order: list[str] = []

        async def block(share: str, seconds: float) -> None:
            place = await fair_queue.take(share, seconds)
            order.append(share)
            await turned()
            place.since -= seconds  # it took as long as was expected
            fair_queue.leave(place)

        long = [asyncio.create_task(block(f"long {n % 6}", 1.0)) for n in range(24)]
        await turned()
        begun = len(order)
        await block("small", 0.01)
        assert order.index("small") - begun <= 2
        await asyncio.gather(*long)

    asyncio.run(scene())


def test_many_who_come_late_do_not_keep_out_who_was_there():
    async def scene() -> None:
        fair_queue = FairQueue(10.0)
        fair_queue.resize(1)
        order: list[str] = []

        async def block(share: str, seconds: float) -> None:
            place = await fair_queue.take(share, seconds)
            order.append(share)
            if place.share != "long":
                small.append(asyncio.create_task(block(f"small {len(small)}", 0.2)))
            await turned()
            place.since -= seconds
            fair_queue.leave(place)

        small: list[asyncio.Task[None]] = []
        small.extend(asyncio.create_task(block(f"first {n}", 0.2)) for n in range(2))
        await turned()
        long = asyncio.create_task(block("long", 1.0))
        await asyncio.wait_for(long, 30)
        assert order.index("long") < 60
        for task in small:
            task.cancel()
        await asyncio.gather(*small, return_exceptions=True)

    asyncio.run(scene())


def test_places_are_shared_out_evenly():
    async def scene() -> None:
        fair_queue = FairQueue(10.0)
        fair_queue.resize(2)
        order: list[str] = []

        async def block(share: str, seconds: float) -> None:
            place = await fair_queue.take(share, seconds)
            order.append(share)
            await turned()
            place.since -= seconds  # it took as long as was expected
            fair_queue.leave(place)

        blocks = [block(f"{n}", 1.0 + n) for n in range(3) for _ in range(20)]
        await asyncio.gather(*blocks)
        # Of a time each has the same: of blocks who has short ones has more.
        half = order[:22]
        assert half.count("0") > half.count("1") > half.count("2") > 0

    asyncio.run(scene())


def test_blocks_that_last_leave_a_place_to_others():
    async def scene() -> None:
        fair_queue = FairQueue(10.0)
        fair_queue.resize(2)
        await fair_queue.take("hours", 1000.0)
        other = asyncio.create_task(fair_queue.take("more hours", 1000.0))
        await turned()
        assert not other.done()
        small = await asyncio.wait_for(fair_queue.take("small", 0.1), 5)
        fair_queue.leave(small)
        await turned()
        assert not other.done()
        fair_queue.resize(3)
        await asyncio.wait_for(other, 5)

    asyncio.run(scene())


def test_one_worker_takes_what_lasts_too():
    async def scene() -> None:
        fair_queue = FairQueue(10.0)
        await asyncio.wait_for(fair_queue.take("hours", 1000.0), 5)

    asyncio.run(scene())


def test_who_gives_up_waiting_leaves_no_gap():
    async def scene() -> None:
        fair_queue = FairQueue(10.0)
        place = await fair_queue.take("a", 1.0)
        waiting = [asyncio.create_task(fair_queue.take(name, 1.0)) for name in "bc"]
        await turned()
        waiting[0].cancel()
        await turned()
        fair_queue.leave(place)
        fair_queue.leave(await asyncio.wait_for(waiting[1], 5))
        place = await fair_queue.take("a", 1.0)
        given = asyncio.create_task(fair_queue.take("d", 1.0))
        await turned()
        fair_queue.leave(place)
        given.cancel()  # with the place in its hand
        await turned()
        await asyncio.wait_for(fair_queue.take("e", 1.0), 5)
        assert set(fair_queue._had) == {"e"}

    asyncio.run(scene())


def test_short_work_is_taken_up_beside_long_work(tmp_path: Path):
    settings = Settings(data_directory=tmp_path, concurrent_jobs=2, block_seconds=0.1)
    long = [Work(f"long {n}", "simulate", 1, 1, 0.0, "", price=1.5) for n in range(4)]
    short = [Work(f"short {n}", "simulate", 1, 1, 0.0, "", price=0.5) for n in range(3)]
    waiting, active = [*long, *short], []
    while (item := next_item(waiting, active, settings)) is not None:
        active.append(item)
    assert active == [*long[:2], *short[:2]]
    assert next_item(waiting, active[:-1], settings) == short[1]


def test_who_is_cancelled_while_places_are_handed_out_takes_none():
    async def scene() -> None:
        fair_queue = FairQueue(10.0)
        fair_queue.resize(1)
        first = await fair_queue.take("failed", 1.0)
        waiting = [asyncio.create_task(fair_queue.take("failed", 1.0)) for _ in range(4)]
        await turned()
        for task in waiting:  # as for a job of which a block has failed
            task.cancel()
        fair_queue.leave(first)
        await asyncio.gather(*waiting, return_exceptions=True)
        assert not fair_queue.waiting
        place = await asyncio.wait_for(fair_queue.take("other", 1.0), 1)
        fair_queue.leave(place)

    asyncio.run(scene())
