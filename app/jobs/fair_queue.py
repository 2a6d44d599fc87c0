"""The one queue for the processes that compute, for what is answered at once and for jobs.

Fair shares: the next slot goes to the call that would be over first if all owners had the same
part of the time from the moment that they came (weighted fair queueing). So owners take turns, what
is small starts soon, and what is long goes on, however much small work comes.
"""

from __future__ import annotations

import asyncio
import itertools
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import NamedTuple

OF_KEY = "key "  # begins the name of an owner who has a key
SHORT = 0.5  # s; calls that take longer leave one slot to those that do not


@dataclass(eq=False)
class Slot:
    """A slot that somebody has: the owner, its expected time [s], and since when [s, monotonic].

    Attributes
    ----------
    owner : str
        On whose account.
    seconds : float
        How long it is expected to be taken.
    since : float
        The `time.monotonic` at which it was taken.
    """

    owner: str
    seconds: float
    since: float = field(default_factory=time.monotonic)

    @property
    def is_long(self) -> bool:
        """True if the call is expected to be long, or turns out to be."""
        return max(self.seconds, time.monotonic() - self.since) > SHORT


class _Waiter(NamedTuple):
    """A call that waits for a slot."""

    number: int  # in the order of arrival
    owner: str
    seconds: float
    slot: asyncio.Future[Slot]


class FairQueue:
    """Gives out slots, one for each call that can run at a time.

    If there are several, one of them is left to short calls, as no call can be interrupted; and one
    owner never has all of them.

    Parameters
    ----------
    slots : int
        The number of slots.
    max_of_owner : int, optional
        The most slots of one owner; by default all but one.
    """

    def __init__(self, slots: int, max_of_owner: int | None = None):
        """Give out a number of slots."""
        self.slots = slots
        self._max_of_owner = max_of_owner
        self._taken: list[Slot] = []
        self._waiting: list[_Waiter] = []
        self._charged: dict[str, float] = {}  # seconds of each owner that is here
        self._fair = 0.0  # seconds that an owner would have had that was here from the start
        self._numbers = itertools.count()

    @property
    def waiting(self) -> bool:
        """True if somebody waits for a slot."""
        return bool(self._waiting)

    @property
    def taken(self) -> int:
        """The number of slots that are taken."""
        return len(self._taken)

    def resize(self, slots: int) -> None:
        """Set the number of slots."""
        self.slots = slots
        self._hand_out()

    @asynccontextmanager
    async def slot(self, owner: str, seconds: float = 0.0) -> AsyncIterator[None]:
        """Wait for a slot and hold it during the block; `seconds` is the expected time [s]."""
        slot = await self._take(owner, seconds)
        try:
            yield
        finally:
            self._release(slot)

    async def _take(self, owner: str, seconds: float) -> Slot:
        # `_fair` is the time that an owner who was always here would have had: a new one begins
        # there, with neither a debt nor a claim to slots that others used before it came.
        if owner not in self._charged:
            self._charged[owner] = max(self._fair, min(self._charged.values(), default=0.0))
        slot: asyncio.Future[Slot] = asyncio.get_running_loop().create_future()
        waiter = _Waiter(next(self._numbers), owner, seconds, slot)
        self._waiting.append(waiter)
        self._hand_out()
        try:
            return await slot
        except asyncio.CancelledError:
            if waiter in self._waiting:
                self._waiting.remove(waiter)
            if slot.done() and not slot.cancelled():
                self._release(slot.result())
            self._forget(owner)
            raise

    def _release(self, slot: Slot) -> None:
        self._taken.remove(slot)
        used = time.monotonic() - slot.since
        self._charged[slot.owner] += used - slot.seconds  # it was charged for what was expected
        self._fair += used / len(self._charged)
        self._forget(slot.owner)
        self._hand_out()

    def _hand_out(self) -> None:
        # A call that was cancelled stays here until its task runs again.
        self._waiting = [waiter for waiter in self._waiting if not waiter.slot.done()]
        while len(self._taken) < self.slots:
            fitting = [waiter for waiter in self._waiting if self._fits(waiter)]
            if not fitting:
                return
            # The owner whose time would be least once the call is over; the first of equals.
            chosen = min(
                fitting,
                key=lambda waiter: (self._charged[waiter.owner] + waiter.seconds, waiter.number),
            )
            self._waiting.remove(chosen)
            slot = Slot(chosen.owner, chosen.seconds)
            self._taken.append(slot)
            self._charged[chosen.owner] += chosen.seconds
            chosen.slot.set_result(slot)

    def _fits(self, waiter: _Waiter) -> bool:
        """True if a slot is left for a call beside those that its owner has, and the long ones."""
        all_but_one = max(1, self.slots - 1)
        own = sum(slot.owner == waiter.owner for slot in self._taken)
        long = sum(slot.is_long for slot in self._taken)
        owner_may = own < (self._max_of_owner or all_but_one)
        return owner_may and (waiter.seconds <= SHORT or long < all_but_one)

    def _forget(self, owner: str) -> None:
        has_slot = any(slot.owner == owner for slot in self._taken)
        if not has_slot and all(waiter.owner != owner for waiter in self._waiting):
            self._charged.pop(owner, None)
