"""Looks at jobs that clients wait for: one query tells all who ask at about the same time."""

from __future__ import annotations

import asyncio
from collections import defaultdict
from typing import TypeAlias
from weakref import WeakKeyDictionary

from vibrafeed.app.jobs.ledger import Job, Ledger

TOGETHER = 0.02  # s; requests that come within it are answered by one query
_Asked: TypeAlias = defaultdict[str, list[asyncio.Future[Job | None]]]


class JobLooks:
    """Returns jobs as they are now; hundreds who wait cost the ledger what one does.

    Parameters
    ----------
    ledger : Ledger
        Where the jobs are.
    """

    def __init__(self, ledger: Ledger):
        """Answer requests for jobs from a ledger, many with one query."""
        self._ledger = ledger
        # A loop never waits for the query of another, which may have ended.
        self._asked: WeakKeyDictionary[asyncio.AbstractEventLoop, _Asked] = WeakKeyDictionary()
        self._tasks: set[asyncio.Task[None]] = set()

    async def job(self, number: str) -> Job | None:
        """Return the current state of a job; None if there is no such job.

        `number` is the job's identifier. Calls within 20 ms share one query of the ledger. Raises
        the `OSError` or `sqlite3.Error` of a ledger that cannot be read.
        """
        loop = asyncio.get_running_loop()
        future: asyncio.Future[Job | None] = loop.create_future()
        if loop not in self._asked:
            self._asked[loop] = defaultdict(list)
            task = asyncio.create_task(self._look())
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)
        self._asked[loop][number].append(future)
        return await future

    async def _look(self) -> None:
        """Read all jobs that were asked for within 20 ms with one query, and set their futures.

        A job that does not exist is None; an error of the ledger goes to all who asked.
        """
        await asyncio.sleep(TOGETHER)
        asked = self._asked.pop(asyncio.get_running_loop())
        jobs: dict[str, Job] = {}
        error: Exception | None = None
        try:
            jobs = await asyncio.to_thread(self._ledger.by_number, list(asked))
        except Exception as why:  # theirs who ask
            error = why
        for number, futures in asked.items():
            for future in futures:
                if future.done():  # its client has left
                    continue
                if error is None:
                    future.set_result(jobs.get(number))
                else:
                    future.set_exception(error)
