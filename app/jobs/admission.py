"""Admission of jobs: the queue, the quota of the disk, results that exist already."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable

from vibrafeed.app.jobs import audit, work
from vibrafeed.app.jobs.errors import NotFoundError, NotOwnerError, TooManyJobsError
from vibrafeed.app.jobs.keys import NOBODY, Key
from vibrafeed.app.jobs.ledger import Job, Ledger
from vibrafeed.app.jobs.quota import Quota
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.jobs.work import Task
from vibrafeed.app.settings import Settings
from vibrafeed.core.errors import StudyError

logger = logging.getLogger("vibrafeed.store")

DAY = 86_400.0  # s
MAX_JOBS = 100_000  # ended jobs of each owner that the ledger keeps: the latest


class Admission:
    """Takes jobs in, and keeps the data directory within its limits.

    Parameters
    ----------
    ledger, store
        Where jobs and their files are kept.
    settings : Settings
        The service's.
    wake : callable
        Called when the queue has changed.
    waits : callable
        Returns the reason why unstarted work waits, other than its place in the queue; else None.
    """

    def __init__(
        self,
        ledger: Ledger,
        store: Store,
        settings: Settings,
        wake: Callable[[], object],
        waits: Callable[[], str | None] = lambda: None,
    ):
        """Admit jobs to a ledger; `wake` wakes the runner, `waits` says why work waits."""
        self.ledger, self.store = ledger, store
        self._settings, self._wake = settings, wake
        self.waits = waits
        self._quota = Quota(ledger, store, settings)
        self.posted: Callable[[str], object] = lambda key: None  # told before others may claim it
        self.ownership = self._quota.ownership

    def post(self, task: Task, who: Key = NOBODY) -> Job:
        """Enter a job for a study into the ledger; the job is stored on disk on return.

        A job is successful at once if its result exists and the same API key asked for it before.
        If only other keys did, the job waits like any other and uses the result when its turn
        comes, so that the reply does not reveal their work.

        Parameters
        ----------
        task : Task
            The study, read and priced, and what to carry out.
        who : Key
            The API key that posts it.

        Raises
        ------
        NoRoomError
            If the result would not fit.
        QueueFullError
            If too much is waiting.
        TooManyJobsError
            If the key has as many jobs as it may.
        """
        key = task.key
        self._quota.look(key, task.bytes, who)
        # In one transaction, so that what is found here is not removed before the job is entered.
        with self.ledger.transaction():
            if who.jobs is not None and self.ledger.active(who.name) >= who.jobs:
                raise TooManyJobsError(
                    f"Your key may have at most {who.jobs:,} jobs that run or wait. Dismiss a "
                    "job, or wait until one is done."
                )
            manifest = self.store.manifest(key)
            held = self.ownership.of(who.name, key)
            is_own = who.sees_all or (held is not None and held.result)
            is_under_way = key in self.ledger.promised()
            is_there = manifest is not None or is_under_way
            if not (is_own and is_there):  # else others' work would be told by it
                self.ledger.check_queue(self._settings.max_queue, who.name)
                self._quota.make(key, task.bytes, who, is_there=is_there)
            if not is_there:
                self.store.put(key, task.text)
            finished = manifest.seconds if manifest and is_own and not is_under_way else None
            self.ownership.hold(who.name, key, len(task.text), result=True)
            job = self.ledger.post(
                task,
                finished_seconds=finished,
                known_seconds=manifest.seconds if manifest else 0.0,
                owner=who.name,
            )
            if manifest is None:
                self.posted(key)
            self._note(who, "post", job.id)
        self._wake()
        return job

    def mend(self, job: Job) -> bool:
        """Queue a successful job again if its result has been lost.

        False if it cannot be computed again.

        Parameters
        ----------
        job : Job
            The job, whose study may be gone or unreadable; the result is False then.

        Returns
        -------
        bool
            True if the result exists or the work was queued; then all
            successful jobs of the study are accepted again.

        Raises
        ------
        NoRoomError
            If the result would not fit.
        """
        try:
            prepared = self.store.get(job.key)
        except (NotFoundError, StudyError):
            return False
        task = work.task_of(prepared, job.process, self._settings)
        self._quota.look(job.key, task.bytes)
        with self.ledger.transaction():
            if self.store.manifest(job.key) is None:
                if not self.store.used(job.key):  # it has just made room for another
                    return False
                self._quota.make(job.key, task.bytes)
                self.ledger.reenter(task)
        logger.warning("a result is computed again: %s", job.key)
        self._wake()
        return True

    def keep(self, key: str, text: str, who: Key = NOBODY) -> bool:
        """Store a sweep without computing it, so that clients can read slices computed on demand.

        Room for it is made first, by the quota of the API key.

        Parameters
        ----------
        key, text : str
            Identifier and canonical text of the sweep, which is checked.
        who : Key
            The API key of the request; by default that of a service without keys.

        Returns
        -------
        bool
            True if this key had not posted the study before; for an admin, if the store did not
            have it.

        Raises
        ------
        NoRoomError
            If the data directory is full.
        """
        needed = len(text)
        is_there = self.store.used(key) > 0
        if is_there and self.ownership.of(who.name, key) is not None:
            self.ownership.readable(who.name, key)
            return self.store.put(key, text)
        self._quota.look(key, needed, who)
        with self.ledger.transaction():
            self._quota.make(key, needed, who, is_there=is_there)
            is_new = self.store.put(key, text)
            is_new_to_them = self.ownership.hold(who.name, key, needed, result=False)
            self._note(who, "post", key)
        return is_new if who.sees_all else is_new_to_them

    def job(self, number: str, who: Key) -> Job | None:
        """Return a job that an API key may read; None if it does not exist or may not be read.

        `number` is the job's identifier; `who` is the key: it reads its own jobs and shared ones.
        """
        job = self.ledger.job(number)
        if job is not None and (who.sees_all or job.shared or job.owner == who.name):
            return job
        return None

    def may_read(self, key: str, who: Key) -> bool:
        """True if an API key may read a study: its own, or one that is shared with all keys."""
        return who.sees_all or bool(self.ownership.readable(who.name, key))

    def knows_result(self, key: str, who: Key) -> bool:
        """True if an API key may learn that a study's result exists: its owner asked for it."""
        return who.sees_all or any(one.result for one in self.ownership.readable(who.name, key))

    def take_result(self, key: str, needed: int, who: Key) -> None:
        """Record that an API key asks for the result file of its study; make room in its quota.

        Parameters
        ----------
        key : str
            Identifier of the study.
        needed : int
            Bytes that the file may take at most.
        who : Key
            The API key.

        Raises
        ------
        NoRoomError
            If the key may not keep this much.
        NotOwnerError
            If the key has not posted the study, and the file does not exist.
        """
        held = self.ownership.of(who.name, key)
        if held is None and self.store.manifest(key) is None:
            raise NotOwnerError(
                "The result file of this study does not exist. POST the study to /sweeps "
                "yourself to "
                "have the file made."
            )
        if held is None or held.result:
            return
        self._quota.look(key, needed, who)
        with self.ledger.transaction():
            self._quota.make(key, needed, who, is_there=True)
            self.ownership.hold(who.name, key, held.bytes, result=True)

    def dismiss(self, number: str, who: Key = NOBODY) -> Job | None:
        """Dismiss a job and return it: stop its work and mark the job, which stays in the list.

        `number` is the job's identifier. The result is None if the API key `who` may read no such
        job.

        Raises
        ------
        NotOwnerError
            If the job belongs to another key, which shares it with `who`.
        """
        job = self.job(number, who)
        if job is None:
            return None
        _check_owner(job, who)
        with self.ledger.transaction():
            was_there = job.state != "dismissed"
            job = self.ledger.dismiss(number)
            if was_there:
                self._note(who, "dismiss", number)
                if job is not None and job.key not in self.ledger.promised():
                    self._quota.weigh(job.key)
        self._wake()
        return job

    def share_job(self, number: str, shared: bool, who: Key) -> Job | None:
        """Make a job and its results readable for all keys, or for its owner only; return the job.

        `number` is the job's identifier, `shared` is True for all keys. The result is None if the
        API key `who` may read no such job.

        Raises
        ------
        NotOwnerError
            If the job belongs to another key, which shares it with `who`.
        """
        job = self.job(number, who)
        if job is None:
            return None
        _check_owner(job, who)
        with self.ledger.transaction():
            self.ledger.share(number, shared)
            self._note(who, "share" if shared else "unshare", number)
        return self.ledger.job(number)

    def share_sweep(self, key: str, shared: bool, who: Key) -> None:
        """Make a sweep readable for all keys, or for its owner only.

        An admin does so for all owners. `key` is the sweep's identifier, `shared` is True for all
        keys, and `who` is the API key that asks.

        Raises
        ------
        NotOwnerError
            If `who` has not posted the sweep and is no admin.
        """
        with self.ledger.transaction():
            if self.ownership.of(who.name, key) is None:
                if not who.sees_all:
                    raise NotOwnerError(
                        "Only the owner of a sweep may share it. POST the study to /sweeps "
                        "yourself to "
                        "become an owner."
                    )
                if key not in self.ownership.studies():
                    self.ownership.hold(who.name, key, 0, result=False)
            self.ownership.share(None if who.sees_all else who.name, key, shared)
            self._note(who, "share" if shared else "unshare", key)

    def _note(self, who: Key, action: audit.Action, object_: str) -> None:
        audit.note(self.ledger.database, who.name, action, object_)

    def make_room(self, key: str, needed: int, who: Key = NOBODY) -> None:
        """Free disk space for a study's files by removing the studies that were used longest ago.

        `key` is the study's identifier, `needed` the bytes that its files may take at most, and
        `who` the API key in whose quota they count. Raises `NoRoomError` if they would not fit;
        nothing is removed then.
        """
        self._quota.look(key, needed, who)
        with self.ledger.transaction():
            self._quota.make(key, needed, who)

    def tidy(self) -> None:
        """Remove old jobs, unused studies, and files that killed writers and workers left.

        The service calls it every hour. Studies in work stay.
        """
        before = time.time() - self._settings.retention_days * DAY
        self.ledger.forget(before, MAX_JOBS)
        audit.forget(self.ledger.database)
        self.store.remove_leftovers()
        for key in self.store.studies():
            with self.ledger.transaction():
                if key not in self.ledger.promised():
                    self.store.drop_blocks(key)
                    if self.store.used(key) < before:
                        self._quota.remove(key)
        for key in self.ownership.studies() - set(self.store.studies()):
            with self.ledger.transaction():
                if not self.store.used(key):  # removed by hand, or by a server that was killed
                    self.ownership.let_go(key)
        self._quota.measure()

    def used_bytes(self) -> int:
        """Return the bytes that all studies take on disk; of those in work, the most."""
        return self._quota.used()


def _check_owner(job: Job, who: Key) -> None:
    if not who.sees_all and job.owner != who.name:
        raise NotOwnerError(
            "This job or sweep is shared with you for reading; only its owner may change it."
        )
