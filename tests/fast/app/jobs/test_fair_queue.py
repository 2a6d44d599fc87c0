"""Whose turn it is on the workers, and what a server takes up."""

import asyncio
from pathlib import Path

import pytest

from vibrafeed.app.jobs.fair_queue import FairQueue
from vibrafeed.app.jobs.ledger import Work
from vibrafeed.app.jobs.runner import next_item
from vibrafeed.app.settings import Settings
from waiting import PATIENCE

pytestmark = pytest.mark.anyio


async def turned() -> None:
    """Let all go on that can."""
    for _ in range(5):
        await asyncio.sleep(0)


async def taken(queue: FairQueue, share: str, seconds: float):
    return await asyncio.wait_for(queue._take(share, seconds), PATIENCE)


async def block(queue: FairQueue, order: list[str], share: str, seconds: float) -> None:
    """Hold a place for as long as was expected."""
    slot = await queue._take(share, seconds)
    order.append(share)
    await turned()
    slot.since -= seconds
    queue._release(slot)


async def test_who_comes_late_is_next():
    queue, order = FairQueue(2), []
    long = [asyncio.create_task(block(queue, order, f"long {n % 6}", 1.0)) for n in range(24)]
    await turned()
    begun = len(order)
    await block(queue, order, "small", 0.01)
    assert order.index("small") - begun <= 2
    await asyncio.gather(*long)


async def test_many_who_come_late_do_not_keep_out_who_was_there():
    queue, order, small = FairQueue(1), [], []

    async def again(share: str) -> None:
        await block(queue, order, share, 0.2)
        small.append(asyncio.create_task(again(f"small {len(small)}")))

    small.extend(asyncio.create_task(again(f"first {n}")) for n in range(2))
    await turned()
    await asyncio.wait_for(block(queue, order, "long", 1.0), PATIENCE)
    assert order.index("long") < 60
    for task in small:
        task.cancel()
    await asyncio.gather(*small, return_exceptions=True)


async def test_places_are_shared_out_evenly():
    queue, order = FairQueue(2), []
    shares = [(f"{n}", 1.0 + n) for n in range(3) for _ in range(20)]
    await asyncio.gather(*(block(queue, order, *share) for share in shares))
    # Of a time each has the same: of blocks who has short ones has more.
    half = order[:22]
    assert half.count("0") > half.count("1") > half.count("2") > 0


async def test_blocks_that_last_leave_a_place_to_others_where_there_are_some():
    queue = FairQueue(2)
    await queue._take("hours", 1000.0)
    other = asyncio.create_task(queue._take("more hours", 1000.0))
    await turned()
    assert not other.done()
    queue._release(await taken(queue, "small", 0.1))
    await turned()
    assert not other.done()
    queue.resize(3)
    await asyncio.wait_for(other, PATIENCE)
    await taken(FairQueue(1), "hours", 1000.0)


async def test_who_gives_up_waiting_leaves_no_gap():
    queue = FairQueue(1)
    slot = await queue._take("a", 1.0)
    given_up, waiting = (asyncio.create_task(queue._take(name, 1.0)) for name in "bc")
    await turned()
    given_up.cancel()
    await turned()
    queue._release(slot)
    queue._release(await asyncio.wait_for(waiting, PATIENCE))
    slot = await queue._take("a", 1.0)
    given = asyncio.create_task(queue._take("d", 1.0))
    await turned()
    queue._release(slot)
    given.cancel()  # with the slot in its hand
    await turned()
    await taken(queue, "e", 1.0)
    assert set(queue._charged) == {"e"}


async def test_who_is_cancelled_while_places_are_handed_out_takes_none():
    queue = FairQueue(1)
    first = await queue._take("failed", 1.0)
    waiting = [asyncio.create_task(queue._take("failed", 1.0)) for _ in range(4)]
    await turned()
    for task in waiting:  # as for a job of which a block has failed
        task.cancel()
    queue._release(first)
    await asyncio.gather(*waiting, return_exceptions=True)
    assert not queue.waiting
    queue._release(await taken(queue, "other", 1.0))


@pytest.mark.parametrize(
    ("asked", "slots", "expected"),
    [
        # One owner leaves a place to others.
        ([("many", 0.0)] * 6 + [("few", 0.0)], 3, [0, 1, 6]),
        # Two owners take turns.
        ([("a", 0.1)] * 4 + [("b", 0.1)] * 4, 2, [0, 4, 1, 5, 2, 6, 3, 7]),
        # Small requests pass large ones of their owner.
        ([("a", 0.1), ("a", 0.1), ("a", 0.0)], 1, [0, 2, 1]),
    ],
)
async def test_the_order_of_requests(asked, slots, expected):
    queue, order = FairQueue(slots), []

    async def ask(number: int, owner: str, seconds: float) -> None:
        async with queue.slot(owner, seconds):
            order.append(number)
            await turned()

    await asyncio.gather(*(ask(number, *one) for number, one in enumerate(asked)))
    assert order[: len(expected)] == expected


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
