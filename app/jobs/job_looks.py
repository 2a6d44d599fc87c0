"""Looks at jobs that clients wait for: one query tells all who ask at about the same time."""

from __future__ import annotations

import asyncio
from collections import defaultdict

from app.jobs.ledger import Job, Ledger

TOGETHER = 0.02  # s in which those who ask are answered by one query


class JobLooks:
    """Returns jobs as they are now; hundreds who wait cost the ledger what one does.

    Parameters
    ----------
    ledger : Ledger
        Where the jobs are.
    """

    def __init__(self, ledger: Ledger):
        self._ledger = ledger
        self._asked: defaultdict[str, list[asyncio.Future[Job | None]]] = defaultdict(list)
        self._tasks: set[asyncio.Task[None]] = set()

    async def job(self, number: str) -> Job | None:
        """Return a job, None if there is no such job; raises as the ledger does."""
        future: asyncio.Future[Job | None] = asyncio.get_running_loop().create_future()
        if not self._asked:
            task = asyncio.create_task(self._look())
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)
        self._asked[number].append(future)
        return await future

    async def _look(self) -> None:
        await asyncio.sleep(TOGETHER)
        asked, self._asked = self._asked, defaultdict(list)
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
