"""Shares of what the service computes at once, beside its jobs: each owner has one.

Reading a study, converting it, carrying out a short one and cutting a large slice all hold the
interpreter. Few of them run at a time, and the next place goes to the owner who has the fewest, so
that who comes later does not wait for everything that somebody else has asked for before.
"""

from __future__ import annotations

import asyncio
import itertools
import os
from collections import Counter
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from typing import Any, TypeVar, cast

from fastapi import Depends, Request, params
from starlette.requests import ClientDisconnect

from vibrafeed.app.jobs.process_pool import ProcessPool
from vibrafeed.app.web.dependencies import Body
from vibrafeed.app.web.entry import owner_of

CORES = os.cpu_count() or 1
SLOTS = min(CORES, 8) + 1  # routes have a thread more: descriptions and small slices do not wait
_T = TypeVar("_T")
BYTES_A_TURN = 4_096  # of a body: one that is so much longer lets one more request pass


class Shares:
    """Gives out places for computing to owners in turns; a waiting request gets the next free one.

    The next place goes to the owner who has the fewest, then to the one who was served longest ago.
    Of one owner's requests the first comes first, unless its price lets later ones pass.

    Parameters
    ----------
    slots : int
        Number of places.
    of_owner : int
        The most places that one owner has at a time.
    """

    def __init__(self, slots: int = SLOTS, of_owner: int = SLOTS - 1):
        """Give out `slots` places for requests, of which one owner may have `of_owner`."""
        self._slots, self._of_owner = slots, of_owner
        self._taken: Counter[str] = Counter()
        self._served: dict[str, int] = {}  # the turn in which each owner that is here was served
        self._waiting: list[tuple[int, int, str, asyncio.Future[None]]] = []
        self._asked, self._turn = itertools.count(), itertools.count()

    @property
    def threads(self) -> int:
        """The share of the cores that each request with a slot has, as a number of threads."""
        return max(1, CORES // max(1, self._taken.total()))

    @asynccontextmanager
    async def slot(self, owner: str, price: int = 0) -> AsyncIterator[None]:
        """Wait for a computing slot and hold it during the block.

        Slots limit what requests compute at a time; owners get them in turns.

        Parameters
        ----------
        owner : str
            The account of the request.
        price : int
            Number of later requests of the same owner that may go before it: large ones wait
            longer.
        """
        asked = next(self._asked)
        got: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting.append((asked + price, asked, owner, got))
        self._hand_out()
        try:
            await got
            yield
        finally:
            if got.done() and not got.cancelled():
                self._taken[owner] -= 1
            self._hand_out()

    def _hand_out(self) -> None:
        """Give free slots to waiting requests, first to owners who have the fewest slots.

        The order is that of `_rank`. Requests of owners who have as many slots as one may have wait
        on. Records of owners without requests are dropped.
        """
        # Who was cancelled stays here until its task runs again.
        self._waiting = [waiter for waiter in self._waiting if not waiter[3].done()]
        self._taken = +self._taken
        here = {waiter[2] for waiter in self._waiting} | self._taken.keys()
        self._served = {owner: turn for owner, turn in self._served.items() if owner in here}
        while self._taken.total() < self._slots:
            fits = [waiter for waiter in self._waiting if self._taken[waiter[2]] < self._of_owner]
            if not fits:
                return
            chosen = min(fits, key=self._rank)
            self._waiting.remove(chosen)
            _, _, owner, got = chosen
            self._taken[owner] += 1
            self._served[owner] = next(self._turn)
            got.set_result(None)

    def _rank(
        self, waiter: tuple[int, int, str, asyncio.Future[None]]
    ) -> tuple[int, int, int, int]:
        """Return the sort key of a waiting request: the smallest is served next.

        The key is the number of slots of its owner, then the turn in which that owner was served
        last, then the request's order of arrival with its price added.
        """
        due, asked, owner, _ = waiter
        return self._taken[owner], self._served.get(owner, -1), due, -asked


@asynccontextmanager
async def slot_of(request: Request, size: int = 0) -> AsyncIterator[None]:
    """Wait for a computing slot for a request and hold it during the block.

    `size` is that of the body [bytes]: a larger one lets more requests of the same owner pass.

    Raises
    ------
    ClientDisconnect
        If the client has left while it waited.
    """
    shares = cast(Shares, request.app.state.shares)
    async with shares.slot(owner_of(request.scope), size // BYTES_A_TURN):
        await look_at(request)()
        yield


@asynccontextmanager
async def large_slot_of(request: Request) -> AsyncIterator[None]:
    """Hold a computing slot for a large slice during the block, as `slot_of` does.

    One owner has as many of them at a time as there are cores but one: their replies keep the event
    loop busy, too.
    """
    large = cast(Shares, request.app.state.large_shares)
    async with large.slot(owner_of(request.scope)), slot_of(request):
        yield


def threads_of(request: Request) -> int:
    """Return the number of threads that a request with a slot may compute with now."""
    return cast(Shares, request.app.state.shares).threads


async def calculate_in_process(
    request: Request, function: Callable[..., _T], *arguments: Any, seconds: float
) -> _T:
    """Run a function in a process of the pool and return its result; the caller holds a slot.

    The process is ended after `seconds` [s] with `StoppedError`, or with `ClientDisconnect` when
    the client leaves.
    """
    pool = cast(ProcessPool, request.app.state.process_pool)
    return await pool(function, *arguments, seconds=seconds, look=look_at(request))


def look_at(request: Request) -> Callable[[], Awaitable[None]]:
    """Return a function that raises `ClientDisconnect` if the client of a request has left.

    It is awaited now and then while something is computed for the client.
    """

    async def look() -> None:
        """Raise `ClientDisconnect` if the client has left."""
        if await request.is_disconnected():
            raise ClientDisconnect

    return look


async def _placed(request: Request, body: Body) -> AsyncIterator[None]:
    """Hold a place for a request, from its whole body to its reply."""
    async with slot_of(request, len(body)):
        yield


def hold_slot() -> params.Depends:
    """Return a dependency that holds a place for a route, from its body to its reply."""
    return cast(params.Depends, Depends(_placed, scope="function"))
