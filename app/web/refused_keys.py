"""Wrong keys are slowed: the more come from an address, the longer each waits for its answer."""

from __future__ import annotations

import logging
import time
from asyncio import sleep, to_thread
from collections import Counter, OrderedDict, deque
from collections.abc import Callable

logger = logging.getLogger("vibrafeed.keys")

REMEMBERED = 60.0  # s for which a wrong key counts
SLOWER = 0.1  # s that each of them adds to the next one's wait
MAX_WAIT = 3.0  # s that the reply to a wrong key waits at most
MAX_WAITING = 4  # of one address; more are refused at once
MAX_WAITING_IN_ALL = 64
MAX_ADDRESSES = 10_000  # addresses whose wrong keys are remembered
MAX_COUNTED = 100  # wrong keys that are counted of one address
MAX_NOTED = 10  # entries in the audit a minute: each is written to the disk


class RefusedKeys:
    """Counts the wrong keys of each address.

    Parameters
    ----------
    note : callable
        Takes an address, and the name of the key if it was in force once; writes it down.
    """

    def __init__(self, note: Callable[[str, str], None]):
        """Begin without wrong keys; `note` writes an entry into the audit log."""
        self._note = note
        self._times: OrderedDict[str, deque[float]] = OrderedDict()
        self._waiting: Counter[str] = Counter()
        self._noted: deque[float] = deque(maxlen=MAX_NOTED)

    async def slowed(self, address: str, name: str) -> bool:
        """Delay the reply to a wrong API key and return True; False at once if too many wait.

        `address` is the client's; `name` is the key's if it was in force once, else empty. The
        delay grows with the number of wrong keys that the address sent within a minute, up to 3 s,
        so that keys cannot be guessed by trying many.
        """
        count = self._count(address)
        if count == 1:
            await self._write_down(address, name)
        if self._waiting[address] >= MAX_WAITING or self._waiting.total() >= MAX_WAITING_IN_ALL:
            return False
        self._waiting[address] += 1
        try:
            await sleep(min(MAX_WAIT, SLOWER * (count - 1)))
        finally:
            self._waiting[address] -= 1
            if not self._waiting[address]:
                del self._waiting[address]
        return True

    def _count(self, address: str) -> int:
        """Count one more wrong API key of a client's address; return those of the last minute.

        Only the latest addresses are remembered, and the latest times of each.
        """
        now = time.monotonic()
        times = self._times.setdefault(address, deque(maxlen=MAX_COUNTED))
        self._times.move_to_end(address)
        if len(self._times) > MAX_ADDRESSES:
            self._times.popitem(last=False)
        while times and now - times[0] > REMEMBERED:
            times.popleft()
        times.append(now)
        return len(times)

    async def _write_down(self, address: str, name: str) -> None:
        """Write the first wrong API key of a client's address into the audit log.

        `name` is the key's if it was in force once, else empty. At most ten a minute are written in
        total.
        """
        now = time.monotonic()
        if len(self._noted) == MAX_NOTED and now - self._noted[0] < REMEMBERED:
            return
        self._noted.append(now)
        try:
            await to_thread(self._note, address, name)
        except Exception:  # such as a full disk: the key is refused all the same
            logger.exception("a refused key cannot be noted")
