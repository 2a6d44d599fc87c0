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
        fair_queue = FairQueue(2)
        order: list[str] = []

        async def block(share: str, seconds: float) -> None:
            slot = await fair_queue._take(share, seconds)
            order.append(share)
            await turned()
            slot.since -= seconds  # it took as long as was expected
            fair_queue._leave(slot)

        long = [asyncio.create_task(block(f"long {n % 6}", 1.0)) for n in range(24)]
        await turned()
        begun = len(order)
        await block("small", 0.01)
        assert order.index("small") - begun <= 2
        await asyncio.gather(*long)

    asyncio.run(scene())


def test_many_who_come_late_do_not_keep_out_who_was_there():
    async def scene() -> None:
        fair_queue = FairQueue(1)
        order: list[str] = []

        async def block(share: str, seconds: float) -> None:
            slot = await fair_queue._take(share, seconds)
            order.append(share)
            if slot.owner != "long":
                small.append(asyncio.create_task(block(f"small {len(small)}", 0.2)))
            await turned()
            slot.since -= seconds
            fair_queue._leave(slot)

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
        fair_queue = FairQueue(2)
        order: list[str] = []

        async def block(share: str, seconds: float) -> None:
            slot = await fair_queue._take(share, seconds)
            order.append(share)
            await turned()
            slot.since -= seconds  # it took as long as was expected
            fair_queue._leave(slot)

        blocks = [block(f"{n}", 1.0 + n) for n in range(3) for _ in range(20)]
        await asyncio.gather(*blocks)
        # Of a time each has the same: of blocks who has short ones has more.
        half = order[:22]
        assert half.count("0") > half.count("1") > half.count("2") > 0

    asyncio.run(scene())


def test_blocks_that_last_leave_a_place_to_others():
    async def scene() -> None:
        fair_queue = FairQueue(2)
        await fair_queue._take("hours", 1000.0)
        other = asyncio.create_task(fair_queue._take("more hours", 1000.0))
        await turned()
        assert not other.done()
        small = await asyncio.wait_for(fair_queue._take("small", 0.1), 5)
        fair_queue._leave(small)
        await turned()
        assert not other.done()
        fair_queue.resize(3)
        await asyncio.wait_for(other, 5)

    asyncio.run(scene())


def test_one_worker_takes_what_lasts_too():
    async def scene() -> None:
        fair_queue = FairQueue(1)
        await asyncio.wait_for(fair_queue._take("hours", 1000.0), 5)

    asyncio.run(scene())


def test_who_gives_up_waiting_leaves_no_gap():
    async def scene() -> None:
        fair_queue = FairQueue(1)
        slot = await fair_queue._take("a", 1.0)
        waiting = [asyncio.create_task(fair_queue._take(name, 1.0)) for name in "bc"]
        await turned()
        waiting[0].cancel()
        await turned()
        fair_queue._leave(slot)
        fair_queue._leave(await asyncio.wait_for(waiting[1], 5))
        slot = await fair_queue._take("a", 1.0)
        given = asyncio.create_task(fair_queue._take("d", 1.0))
        await turned()
        fair_queue._leave(slot)
        given.cancel()  # with the slot in its hand
        await turned()
        await asyncio.wait_for(fair_queue._take("e", 1.0), 5)
        assert set(fair_queue._had) == {"e"}

    asyncio.run(scene())


def test_small_work_is_taken_up_beside_long_work_and_owners_take_turns(tmp_path: Path):
    settings = Settings(data_directory=tmp_path, concurrent_jobs=3)
    of_one = [Work(f"one {n}", "simulate", 1, 1, 0.0, "", price=5.0, asker="one") for n in range(4)]
    other = Work("other", "simulate", 1, 1, 0.0, "", price=9.0, asker="other")
    small = [Work(f"small {n}", "simulate", 1, 1, 0.0, "", price=0.5, asker="one") for n in "ab"]
    waiting, active = [*of_one, other, *small], []
    while (item := next_item(waiting, active, settings)) is not None:
        active.append(item)
    assert active == [of_one[0], other, of_one[1], small[0]]
    assert next_item(waiting, active[:-1], settings) == small[0]
    assert next_item(waiting, active[1:], settings) is None


def test_who_is_cancelled_while_places_are_handed_out_takes_none():
    async def scene() -> None:
        fair_queue = FairQueue(1)
        first = await fair_queue._take("failed", 1.0)
        waiting = [asyncio.create_task(fair_queue._take("failed", 1.0)) for _ in range(4)]
        await turned()
        for task in waiting:  # as for a job of which a block has failed
            task.cancel()
        fair_queue._leave(first)
        await asyncio.gather(*waiting, return_exceptions=True)
        assert not fair_queue.waiting
        slot = await asyncio.wait_for(fair_queue._take("other", 1.0), 1)
        fair_queue._leave(slot)

    asyncio.run(scene())


def order_of(asked: list[tuple[str, float]], slots: int) -> list[int]:
    """Return in which order requests of (owner, seconds) run while the first keep their slots."""

    async def scene() -> list[int]:
        fair_queue, order = FairQueue(slots), []

        async def ask(number: int, owner: str, seconds: float) -> None:
            async with fair_queue.slot(owner, seconds):
                order.append(number)
                await turned()

        await asyncio.gather(*(ask(number, *one) for number, one in enumerate(asked)))
        return order

    return asyncio.run(scene())


def test_one_owner_leaves_a_place_to_others():
    asked = [("many", 0.0)] * 20 + [("few", 0.0)]
    assert order_of(asked, slots=3).index(20) == 2  # at once


def test_two_owners_take_turns():
    order = order_of([("a", 0.1)] * 4 + [("b", 0.1)] * 4, slots=2)
    assert ["ab"[number // 4] for number in order] == list("abababab")


def test_small_requests_pass_large_ones_of_their_owner():
    order = order_of([("a", 0.1), ("a", 0.1), ("a", 0.0)], slots=1)
    assert order == [0, 2, 1]
