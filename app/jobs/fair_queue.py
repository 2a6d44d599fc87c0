"""The fair queue of blocks for places on the workers.

Fair shares: the next place goes to the block that would be over first if all shares had the same
part of the workers' time from the moment that they came (weighted fair queueing). What is small
starts within about a block's time, and what is long goes on, however much small work comes.
"""

from __future__ import annotations

import asyncio
import itertools
import time
from dataclasses import dataclass, field

from vibrafeed.app.jobs.ledger import Work


def share_of(item: Work) -> str:
    """Return the account that an item of work is charged to: its owner, or itself without keys.

    Work of one share takes turns in the order of asking.
    """
    return f"owner {item.asker}" if item.asker else item.key


@dataclass(eq=False)
class Slot:
    """A place on a worker that somebody has.

    Attributes
    ----------
    share : str
        On whose account.
    seconds : float
        How long it is expected to be taken.
    since : float
        The `time.monotonic` at which it was taken.
    """

    share: str
    seconds: float
    since: float = field(default_factory=time.monotonic)


class FairQueue:
    """Gives out places on workers (slots), one for each block that can run at a time.

    If there are two slots or more, long calls leave one of them to short calls: they cannot be
    interrupted.

    Parameters
    ----------
    longest : float
        A call that takes more than this time [s] is long.
    """

    def __init__(self, longest: float):
        """Begin with one slot; work of more than `longest` seconds counts as long."""
        self._longest = longest
        self._slots = 1
        self._taken: list[Slot] = []
        self._waiting: list[tuple[int, str, float, asyncio.Future[Slot]]] = []
        self._had: dict[str, float] = {}  # seconds of each share that is here
        self._due = 0.0  # seconds that each share would have had that was here from the start
        self._number = itertools.count()

    @property
    def waiting(self) -> bool:
        """True if somebody waits for a slot."""
        return bool(self._waiting)

    def resize(self, slots: int) -> None:
        """Set the number of slots; there is one before any worker is known."""
        self._slots = max(1, slots)
        self._hand_out()

    async def take(self, share: str, seconds: float) -> Slot:
        """Wait for a slot, a place on a worker, and return it.

        The next free slot goes to the account that has had the least time so far. `share` is the
        account that is charged, and `seconds` the expected time of use [s]. A caller that is
        cancelled gets none, and gives back a slot that it has just got.
        """
        # `_due` is the time that an account which was always here would have had: a new one begins
        # there, with neither a debt nor a claim to slots that others used before it came.
        if share not in self._had:
            self._had[share] = max(self._due, min(self._had.values(), default=0.0))
        got: asyncio.Future[Slot] = asyncio.get_running_loop().create_future()
        asked = (next(self._number), share, seconds, got)
        self._waiting.append(asked)
        self._hand_out()
        try:
            return await got
        except asyncio.CancelledError:
            if asked in self._waiting:
                self._waiting.remove(asked)
            if got.done() and not got.cancelled():
                self.leave(got.result())
            self._forget(share)
            raise

    def leave(self, slot: Slot) -> None:
        """Free a slot and give it to the next call that waits.

        The account of the slot, which was charged for the expected time, is charged for the time
        that it was really used.
        """
        self._taken.remove(slot)
        used = time.monotonic() - slot.since
        self._had[slot.share] += used - slot.seconds  # it was charged for what was expected
        self._due += used / len(self._had)
        self._forget(slot.share)
        self._hand_out()

    def _hand_out(self) -> None:
        """Give free slots to waiting calls, so that every account gets an equal share of time.

        A slot is a place on a worker; an account is that of an API key. The next call is the one
        whose account would have had the least time with it [s], and among equals the first that
        asked. A long call gets no slot while long calls hold all slots but one, which stays free
        for short ones.
        """
        # Who was cancelled stays here until its task runs again.
        self._waiting = [waiter for waiter in self._waiting if not waiter[3].done()]
        while self._waiting and len(self._taken) < self._slots:
            lasting = sum(self._is_long(slot.seconds, slot) for slot in self._taken)
            no_more = self._slots > 1 and lasting >= self._slots - 1
            fits = [
                waiter for waiter in self._waiting if not (no_more and self._is_long(waiter[2]))
            ]
            if not fits:
                return
            chosen = min(fits, key=lambda waiter: (self._had[waiter[1]] + waiter[2], waiter[0]))
            self._waiting.remove(chosen)
            _, share, seconds, got = chosen
            slot = Slot(share, seconds)
            self._taken.append(slot)
            self._had[share] += seconds
            got.set_result(slot)

    def _is_long(self, seconds: float, slot: Slot | None = None) -> bool:
        """True if work counts as long, by its expected time or the time it has run."""
        run = 0.0 if slot is None else time.monotonic() - slot.since
        return max(seconds, run) > self._longest

    def _slots_of(self, share: str) -> int:
        """Return the number of slots that an account uses."""
        return sum(place.share == share for place in self._taken)

    def _forget(self, share: str) -> None:
        """Remove the record of an account that neither uses a slot nor waits."""
        if not self._slots_of(share) and all(one[1] != share for one in self._waiting):
            self._had.pop(share, None)
