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


class FairQueue:
    """Gives out slots, one for each call that can run at a time.

    If there are several, one of them is left to short calls, as no call can be interrupted; and one
    owner never has all of them.

    Parameters
    ----------
    slots : int
        The number of slots.
    of_owner : int, optional
        The most slots of one owner; by default all but one.
    """

    def __init__(self, slots: int, of_owner: int | None = None):
        """Give out a number of slots."""
        self.slots = slots
        self._of_owner = of_owner
        self._taken: list[Slot] = []
        self._waiting: list[tuple[int, str, float, asyncio.Future[Slot]]] = []
        self._had: dict[str, float] = {}  # seconds of each owner that is here
        self._due = 0.0  # seconds that an owner would have had that was here from the start
        self._number = itertools.count()

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
            self._leave(slot)

    async def _take(self, owner: str, seconds: float) -> Slot:
        # `_due` is the time that an account which was always here would have had: a new one begins
        # there, with neither a debt nor a claim to slots that others used before it came.
        if owner not in self._had:
            self._had[owner] = max(self._due, min(self._had.values(), default=0.0))
        got: asyncio.Future[Slot] = asyncio.get_running_loop().create_future()
        asked = (next(self._number), owner, seconds, got)
        self._waiting.append(asked)
        self._hand_out()
        try:
            return await got
        except asyncio.CancelledError:
            if asked in self._waiting:
                self._waiting.remove(asked)
            if got.done() and not got.cancelled():
                self._leave(got.result())
            self._forget(owner)
            raise

    def _leave(self, slot: Slot) -> None:
        self._taken.remove(slot)
        used = time.monotonic() - slot.since
        self._had[slot.owner] += used - slot.seconds  # it was charged for what was expected
        self._due += used / len(self._had)
        self._forget(slot.owner)
        self._hand_out()

    def _hand_out(self) -> None:
        # Who was cancelled stays here until its task runs again.
        self._waiting = [waiter for waiter in self._waiting if not waiter[3].done()]
        while len(self._taken) < self.slots:
            fits = [waiter for waiter in self._waiting if self._fits(waiter[1], waiter[2])]
            if not fits:
                return
            chosen = min(fits, key=lambda waiter: (self._had[waiter[1]] + waiter[2], waiter[0]))
            self._waiting.remove(chosen)
            _, owner, seconds, got = chosen
            slot = Slot(owner, seconds)
            self._taken.append(slot)
            self._had[owner] += seconds
            got.set_result(slot)

    def _fits(self, owner: str, seconds: float) -> bool:
        """True if a slot is left for a call beside those that its owner has, and the long ones."""
        most = max(1, self.slots - 1)
        own = sum(slot.owner == owner for slot in self._taken)
        long = sum(slot.is_long for slot in self._taken)
        return own < (self._of_owner or most) and (seconds <= SHORT or long < most)

    def _forget(self, owner: str) -> None:
        taken = any(slot.owner == owner for slot in self._taken)
        if not taken and all(waiter[1] != owner for waiter in self._waiting):
            self._had.pop(owner, None)
