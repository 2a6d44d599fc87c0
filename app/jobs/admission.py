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
    waiting_reason : callable
        Returns the reason why unstarted work waits, other than its place in the queue; else None.
    """

    def __init__(
        self,
        ledger: Ledger,
        store: Store,
        settings: Settings,
        wake: Callable[[], object],
        waiting_reason: Callable[[], str | None] = lambda: None,
    ):
        """Admit jobs to a ledger; `wake` wakes the runner, `waiting_reason` says why work waits."""
        self.ledger, self.store = ledger, store
        self._settings, self._wake = settings, wake
        self.waiting_reason = waiting_reason
        self._quota = Quota(ledger, store, settings)
        self.posted: Callable[[str], object] = lambda key: None  # told before others may claim it
        self.ownership = self._quota.ownership

    def post(self, task: Task, api_key: Key = NOBODY) -> Job:
        """Enter a job for a study into the ledger; the job is stored on disk on return.

        A job is successful at once if its result exists and the same API key asked for it before.
        If only other keys did, the job waits like any other and uses the result when its turn
        comes, so that the reply does not reveal their work.

        Parameters
        ----------
        task : Task
            The study, read and priced, and what to carry out.
        api_key : Key
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
        self._quota.measure_if_short(key, task.bytes, api_key)
        # In one transaction, so that what is found here is not removed before the job is entered.
        with self.ledger.transaction():
            if api_key.jobs is not None and self.ledger.active(api_key.name) >= api_key.jobs:
                raise TooManyJobsError(
                    f"Your key may have at most {api_key.jobs:,} jobs that run or wait. Dismiss a "
                    "job, or wait until one is done."
                )
            manifest = self.store.manifest(key)
            owned = self.ownership.of(api_key.name, key)
            is_own = api_key.sees_all or (owned is not None and owned.result)
            is_under_way = key in self.ledger.promised()
            is_there = manifest is not None or is_under_way
            if not (is_own and is_there):  # else it would reveal others' work
                self.ledger.check_queue(self._settings.max_queue, api_key.name)
                self._quota.make_room(key, task.bytes, api_key, is_there=is_there)
            if not is_there:
                self.store.put(key, task.text)
            is_finished = manifest is not None and is_own and not is_under_way
            known_seconds = manifest.seconds if manifest else 0.0
            self.ownership.hold(api_key.name, key, len(task.text), result=True)
            job = self.ledger.post(
                task,
                finished_seconds=known_seconds if is_finished else None,
                known_seconds=known_seconds,
                owner=api_key.name,
            )
            if manifest is None:
                self.posted(key)
            self._audit(api_key, "post", job.id)
        self._wake()
        return job

    def recompute(self, job: Job) -> bool:
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
        self._quota.measure_if_short(job.key, task.bytes)
        with self.ledger.transaction():
            if self.store.manifest(job.key) is None:
                if not self.store.last_use(job.key):  # it has just been removed for another
                    return False
                self._quota.make_room(job.key, task.bytes)
                self.ledger.reenter(task)
        logger.warning("a result is computed again: %s", job.key)
        self._wake()
        return True

    def keep_sweep(self, key: str, text: str, api_key: Key = NOBODY) -> bool:
        """Store a sweep without computing it, so that clients can read slices computed on demand.

        Room for it is made first, by the quota of the API key.

        Parameters
        ----------
        key, text : str
            Identifier and canonical text of the sweep, which is checked.
        api_key : Key
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
        is_stored = self.store.last_use(key) > 0
        if is_stored and self.ownership.of(api_key.name, key) is not None:
            self.ownership.readable(api_key.name, key)  # notes the use
            return self.store.put(key, text)
        self._quota.measure_if_short(key, needed, api_key)
        with self.ledger.transaction():
            self._quota.make_room(key, needed, api_key, is_there=is_stored)
            is_new = self.store.put(key, text)
            is_new_to_owner = self.ownership.hold(api_key.name, key, needed, result=False)
            self._audit(api_key, "post", key)
        return is_new if api_key.sees_all else is_new_to_owner

    def job(self, number: str, api_key: Key) -> Job | None:
        """Return a job that an API key may read; None if it does not exist or may not be read.

        `number` is the job's identifier; the key reads its own jobs and shared ones.
        """
        job = self.ledger.job(number)
        if job is not None and (api_key.sees_all or job.shared or job.owner == api_key.name):
            return job
        return None

    def may_read(self, key: str, api_key: Key) -> bool:
        """True if an API key may read a study: its own, or one that is shared with all keys."""
        return api_key.sees_all or bool(self.ownership.readable(api_key.name, key))

    def knows_result(self, key: str, api_key: Key) -> bool:
        """True if an API key may learn that a study's result exists: its owner asked for it."""
        return api_key.sees_all or any(
            study.result for study in self.ownership.readable(api_key.name, key)
        )

    def take_result(self, key: str, needed: int, api_key: Key) -> None:
        """Record that an API key asks for the result file of its study; make room in its quota.

        Parameters
        ----------
        key : str
            Identifier of the study.
        needed : int
            Bytes that the file may take at most.
        api_key : Key
            The API key.

        Raises
        ------
        NoRoomError
            If the key may not keep this much.
        NotOwnerError
            If the key has not posted the study, and the file does not exist.
        """
        owned = self.ownership.of(api_key.name, key)
        if owned is None and self.store.manifest(key) is None:
            raise NotOwnerError(
                "The result file of this study does not exist. POST the study to /sweeps "
                "yourself to "
                "have the file made."
            )
        if owned is None or owned.result:
            return
        self._quota.measure_if_short(key, needed, api_key)
        with self.ledger.transaction():
            self._quota.make_room(key, needed, api_key, is_there=True)
            self.ownership.hold(api_key.name, key, owned.bytes, result=True)

    def dismiss(self, number: str, api_key: Key = NOBODY) -> Job | None:
        """Dismiss a job and return it: stop its work and mark the job, which stays in the list.

        `number` is the job's identifier. The result is None if `api_key` may read no such
        job.

        Raises
        ------
        NotOwnerError
            If the job belongs to another key, which shares it with `api_key`.
        """
        job = self.job(number, api_key)
        if job is None:
            return None
        _check_owner(job, api_key)
        with self.ledger.transaction():
            was_dismissed = job.state == "dismissed"
            job = self.ledger.dismiss(number)
            if not was_dismissed:
                self._audit(api_key, "dismiss", number)
                if job is not None and job.key not in self.ledger.promised():
                    self._quota.measure_one(job.key)
        self._wake()
        return job

    def share_job(self, number: str, shared: bool, api_key: Key) -> Job | None:
        """Make a job and its results readable for all keys, or for its owner only; return the job.

        `number` is the job's identifier, `shared` is True for all keys. The result is None if the
        API key `api_key` may read no such job.

        Raises
        ------
        NotOwnerError
            If the job belongs to another key, which shares it with `api_key`.
        """
        job = self.job(number, api_key)
        if job is None:
            return None
        _check_owner(job, api_key)
        with self.ledger.transaction():
            self.ledger.share(number, shared)
            self._audit(api_key, "share" if shared else "unshare", number)
        return self.ledger.job(number)

    def share_sweep(self, key: str, shared: bool, api_key: Key) -> None:
        """Make a sweep readable for all keys, or for its owner only.

        An admin does so for all owners. `key` is the sweep's identifier, `shared` is True for all
        keys, and `api_key` is the API key that asks.

        Raises
        ------
        NotOwnerError
            If `api_key` has not posted the sweep and is no admin.
        """
        with self.ledger.transaction():
            if self.ownership.of(api_key.name, key) is None:
                if not api_key.sees_all:
                    raise NotOwnerError(
                        "Only the owner of a sweep may share it. POST the study to /sweeps "
                        "yourself to "
                        "become an owner."
                    )
                if key not in self.ownership.studies():
                    self.ownership.hold(api_key.name, key, 0, result=False)
            self.ownership.share(None if api_key.sees_all else api_key.name, key, shared)
            self._audit(api_key, "share" if shared else "unshare", key)

    def _audit(self, api_key: Key, action: audit.Action, object_: str) -> None:
        audit.note(self.ledger.database, api_key.name, action, object_)

    def make_room(self, key: str, needed: int, api_key: Key = NOBODY) -> None:
        """Free disk space for a study's files by removing the studies that were used longest ago.

        `key` is the study's identifier, `needed` the bytes that its files may take at most, and
        `api_key` the API key in whose quota they count. Raises `NoRoomError` if they would not fit;
        nothing is removed then.
        """
        self._quota.measure_if_short(key, needed, api_key)
        with self.ledger.transaction():
            self._quota.make_room(key, needed, api_key)

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
                    if self.store.last_use(key) < before:
                        self._quota.remove(key)
        for key in self.ownership.studies() - set(self.store.studies()):
            with self.ledger.transaction():
                if not self.store.last_use(key):  # removed by hand, or by a server that was killed
                    self.ownership.release(key)
        self._quota.measure()

    def used_bytes(self) -> int:
        """Return the bytes that all studies take on disk; of those in work, the most."""
        return self._quota.used()


def _check_owner(job: Job, api_key: Key) -> None:
    if not api_key.sees_all and job.owner != api_key.name:
        raise NotOwnerError(
            "This job or sweep is shared with you for reading; only its owner may change it."
        )
