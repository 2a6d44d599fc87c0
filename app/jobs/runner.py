"""Claims the ledger's work, holds its lease while it is carried out, and notes its end."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import socket
import sqlite3
import time
import uuid
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import IO, Any, Protocol

from vibrafeed.app.jobs import disk
from vibrafeed.app.jobs.cluster import Cluster
from vibrafeed.app.jobs.dispatcher import Dispatcher, TooLongError, WorkersDieError
from vibrafeed.app.jobs.errors import BlindWorkerError, OtherVersionError, TornBlockError
from vibrafeed.app.jobs.ledger import Ledger, Work
from vibrafeed.app.jobs.process_pool import LostError, ProcessPool
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.settings import Settings

logger = logging.getLogger("vibrafeed.jobs")

POLL = 0.5  # s between looks at the ledger, in which other servers may have entered work
RETRY = 2.0  # s before a lost scheduler is tried again
CHECK_INTERVAL = 1.0  # s between looks at whether work is still wanted


def next_item(waiting: Sequence[Work], active: Collection[Work], settings: Settings) -> Work | None:
    """Return the item of work to begin next; None if none may begin.

    Owners take turns. As many items are computed at a time as `concurrent_jobs` says, and one
    besides that is smaller than all of them: small work does not wait until something long is over.
    On the workers they share time: see `vibrafeed.app.jobs.fair_queue`.

    Parameters
    ----------
    waiting : sequence of Work
        Items that wait, in the order of arrival.
    active : collection of Work
        Items that this server computes.
    settings : Settings
        The service's.
    """
    keys = {item.key for item in active}
    owners = Counter(item.asker for item in active)
    is_full = len(active) >= settings.concurrent_jobs
    for item in sorted(waiting, key=lambda item: owners[item.asker]):
        is_smallest = all(item.price < other.price for other in active)
        if item.key not in keys and (is_smallest or not is_full):
            return item
    return None


class Observer(Protocol):
    """An observer of work, such as metrics or traces; its methods return at once."""

    def began(self, item: Work) -> Mapping[str, str]:
        """Notice that an item of work was begun; return fields to add to its log lines."""

    def computed(self, item: Work, seconds: float) -> None:
        """Notice that a block of an item is done; `seconds` is its computing time [s]."""

    def ended(self, item: Work, outcome: str, seconds: float) -> None:
        """Notice that an item ended here, with its outcome and the time it was under way [s].

        The outcome is ``done``, ``failed``, ``given up`` or ``interrupted``.
        """


class Runner:
    """Claims work and has it carried out, also what a killed server has left; one per server.

    Parameters
    ----------
    ledger, store, workers
        Where work is kept, where its files are, and where it runs.
    settings : Settings
        The service's.

    Attributes
    ----------
    observers : list of Observer
        The observers of work, such as metrics and traces; each adds itself.
    """

    def __init__(
        self, ledger: Ledger, store: Store, workers: ProcessPool | Cluster, settings: Settings
    ):
        """Claim work of a ledger for this server, to be computed by workers."""
        self._ledger, self._store, self._workers = ledger, store, workers
        self._settings = settings
        self._directory = str(settings.data_directory.resolve())
        self._server = f"{socket.gethostname()} {os.getpid()} {uuid.uuid4().hex[:8]}"
        self._dispatcher = Dispatcher(ledger, store, workers, settings)
        self.observers: list[Observer] = []
        self._loop: asyncio.AbstractEventLoop | None = None
        self._wake = asyncio.Event()
        self._active: dict[str, tuple[Work, asyncio.Task[None]]] = {}
        self._main: asyncio.Task[None] | None = None
        self._lock_file: IO[bytes] | None = None

    async def start(self) -> None:
        """Release work that a killed server has left, and begin to claim work."""
        self._loop = asyncio.get_running_loop()
        await asyncio.to_thread(self._clear_up)
        self._main = asyncio.create_task(self._run(), name="jobs")

    async def stop(self) -> None:
        """Stop claiming and computing work; another server continues the items under way.

        Leases are released and workers ended. Errors while doing so go to the log, as a lease runs
        out by itself.
        """
        working = [task for _, task in self._active.values()]
        tasks = [task for task in (self._main, *working) if task is not None]
        for task in tasks:
            task.cancel()
        await asyncio.to_thread(self._workers.close)  # tasks wait for what they run
        await asyncio.gather(*tasks, return_exceptions=True)
        try:
            await asyncio.to_thread(self._ledger.release, self._server)
        except Exception:  # such as a full disk: the leases run out
            logger.exception("leases cannot be given up")
        if self._lock_file is not None:
            self._lock_file.close()

    def wake(self) -> None:
        """Wake the runner, from any thread: work has been added or dropped."""
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._wake.set)

    def fault(self) -> str | None:
        """Return the reason why jobs cannot be carried out; None if they can."""
        if self._main is None or self._main.done():
            return "no work is looked for"
        return self._workers.trouble

    def waiting_reason(self) -> str | None:
        """Return the reason why unstarted work waits, other than its place in the queue."""
        is_busy = self._workers.fair_queue.waiting
        return self._workers.trouble or ("all workers are busy" if is_busy else None)

    def _clear_up(self) -> None:
        """Release all leases and remove temporary files if no other server uses the data directory.

        A lock file there, which each server holds while it runs, shows that.
        """
        import fcntl  # Windows has none, and no shared locks: a service runs on POSIX systems

        path = Path(self._directory)
        path.mkdir(parents=True, exist_ok=True)
        self._lock_file = (path / ".lock").open("ab")
        try:
            fcntl.flock(self._lock_file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            fcntl.flock(self._lock_file, fcntl.LOCK_SH)
            return
        self._ledger.release()
        count = self._store.remove_leftovers(0)
        if count:
            logger.info("files of killed writers removed", extra={"count": count})
        fcntl.flock(self._lock_file, fcntl.LOCK_SH)  # beside other servers

    async def _run(self) -> None:
        """Claim work until cancelled: whenever `wake` is called, and every half second.

        A ledger that cannot be read is logged once, and tried again.
        """
        is_read = True
        while True:
            try:
                await self._claim_some()
            except Exception:
                if is_read:  # told once, however long it lasts
                    logger.exception("the ledger cannot be read")
                is_read = False
            else:
                if not is_read:
                    logger.info("the ledger can be read again")
                is_read = True
            self._wake.clear()
            # Not `wait_for`: before Python 3.12 it swallows a cancellation that meets a wake.
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(POLL):
                    await self._wake.wait()

    async def _claim_some(self) -> None:
        """Claim items of work as long as one may begin, and carry each out in a task of its own.

        To claim an item, a study that jobs wait for, is to take its lease in the ledger, which
        other servers use too.
        """
        while True:
            candidate = await asyncio.to_thread(self._next_item)
            if candidate is None:
                return
            lease = self._settings.lease_seconds
            item = await asyncio.to_thread(self._ledger.claim, self._server, lease, candidate.key)
            if item is not None:  # no other server was quicker
                task = asyncio.create_task(self._work_on(item), name=item.key)
                self._active[item.owner] = item, task

    def _next_item(self) -> Work | None:
        active = [item for item, _ in self._active.copy().values()]
        return next_item(self._ledger.waiting(), active, self._settings)

    async def _work_on(self, item: Work) -> None:
        """Carry out an item of work while this server has its lease; record how it ended.

        It runs as a task. Work that is interrupted by lost workers or a lost ledger is released, to
        be tried again; an item that no job waits for any more, or whose lease is lost, is given up.
        """
        log_fields: dict[str, Any] = {"key": item.key, "kind": item.process, "blocks": item.blocks}
        for observer in self.observers:
            log_fields |= observer.began(item)
        logger.info("work started", extra=log_fields)
        began, outcome, computed = time.monotonic(), "interrupted", 0

        def count_block(seconds: float) -> None:
            nonlocal computed
            computed += 1
            for observer in self.observers:
                observer.computed(item, seconds)

        task = asyncio.create_task(self._dispatcher.carry_out(item, count_block))
        try:
            await self._renew_lease_while(item, task)
            if not task.done():
                outcome = "given up"
                return
            problem = await self._problem_of(task)
            if problem is not None and await self._dispatcher.has_result(item):
                problem = None  # another server, which took this one for dead, has finished it
            size = await asyncio.to_thread(self._store.bytes, item.key)
            await asyncio.to_thread(self._ledger.end, item, problem, size)
            outcome = "done" if problem is None else "failed"
            if problem is not None:
                log_fields["title"] = problem["title"]
        except LostError as lost:
            logger.warning("work is tried again: %s", lost, extra=log_fields)
            await asyncio.sleep(RETRY)
            with contextlib.suppress(OSError, sqlite3.Error):  # then the lease runs out
                await asyncio.to_thread(self._ledger.release, item.owner)
        except Exception:
            # Such as a ledger on a full disk: the lease runs out, and the work is tried again.
            logger.exception("work interrupted", extra=log_fields)
        finally:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
            seconds = time.monotonic() - began
            log_fields |= {"computed": computed, "seconds": round(seconds, 3)}
            logger.info("work %s", outcome, extra=log_fields)
            for observer in self.observers:
                observer.ended(item, outcome, seconds)
            self._active.pop(item.owner, None)
            self._wake.set()

    async def _renew_lease_while(self, item: Work, task: asyncio.Task[None]) -> None:
        """Renew the lease of an item of work until the task that computes it ends.

        Return early if the lease is lost or no client wants the work any
        more. Raises the ledger's error only if it lasts longer than the lease.
        """
        lease = self._settings.lease_seconds
        renewed = time.monotonic()
        while not task.done():
            await asyncio.wait([task], timeout=min(CHECK_INTERVAL, lease / 4))
            if task.done():
                return
            age = time.monotonic() - renewed
            try:
                if not await asyncio.to_thread(self._ledger.holds, item):
                    return
                if age > lease / 4:
                    if not await asyncio.to_thread(self._ledger.renew, item, lease):
                        return
                    renewed += age  # the time before the renewal: it may have taken long
            except (OSError, sqlite3.Error):
                if age > lease:  # till then nobody else has it, and the ledger may come back
                    raise

    async def _problem_of(self, task: asyncio.Task[None]) -> Mapping[str, Any] | None:
        """Return the problem document of failed work: status, kind, title, detail.

        None for success. Errors that pass by
        themselves, as of lost workers or a busy disk, are raised, and the work is tried again.
        """
        try:
            await task
        except (LostError, sqlite3.OperationalError):  # it is tried again
            raise
        except TooLongError as error:
            return _problem(422, "limit", "The study takes longer than this service allows", error)
        except OtherVersionError as error:
            return _problem(
                409, "version", "The study belongs to another version of vibrafeed", error
            )
        except TornBlockError as error:
            logger.exception("storage failed")
            return _problem(507, "storage", "The disk loses written data", error)
        except OSError as error:
            if disk.is_temporary(error):
                raise LostError(str(error)) from error
            logger.exception("storage failed")
            return disk.problem(error)
        except BlindWorkerError as error:
            logger.error("%s", error)
            title = "A worker does not see the data directory"
            return _problem(500, "workers", title, error)
        except WorkersDieError as error:
            return _problem(500, "workers", "The study crashes its workers", error)
        except Exception:
            logger.exception("work failed")
            return _problem(
                500, "internal", "The service failed", "The error is in the service's log."
            )
        return None


def _problem(status: int, kind: str, title: str, detail: object) -> dict[str, Any]:
    return {"status": status, "kind": kind, "title": title, "detail": str(detail)}
