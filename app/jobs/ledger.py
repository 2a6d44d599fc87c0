"""The ledger of jobs: a database that several servers and threads may share.

Every change is one transaction, committed to the disk before the call returns. A *job* is what a
client posted. An *item of work* is what has to be computed, once for all jobs of equal studies; it
exists only until it is done. The server that works on an item holds a lease on it, which it renews;
a lease that has run out may be taken over. Its owner is one claim, not one server: a server that
was late with a lease and claims the item again does not take itself for the first claim.
"""

from __future__ import annotations

import json
import sqlite3
import time
import uuid
from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sqlalchemy import ColumnElement, Connection, Row, exists, func, or_, select, tuple_
from sqlalchemy.sql.expression import Insert, Select

from vibrafeed.app.jobs.database import Database
from vibrafeed.app.jobs.disk import DAMAGED, cause_of
from vibrafeed.app.jobs.errors import QueueFullError
from vibrafeed.app.jobs.tables import AUDIT, JOBS, KEYS, OWNED_STUDIES, SIZES, VERSION, WORK

if TYPE_CHECKING:
    from vibrafeed.app.jobs.work import Task  # whose processes load no database

ACTIVE = ("accepted", "running")
STATES = (*ACTIVE, "successful", "failed", "dismissed")
TICK = 1e-6  # s between the times of entry of two jobs, at least


@dataclass(frozen=True)
class Wanted:
    """The filter of a list of jobs; a field that is empty or None does not restrict the list.

    Attributes
    ----------
    processes, states : tuple
        Names of which a job has to have one.
    created : pair of float or None
        Times between which a job was entered [s since the epoch].
    seconds : pair of int or None
        Least and largest time from a job's beginning to its end, or until now [s].
    seen_by : str or None
        Name of a key: jobs that it owns, and shared ones.
    """

    processes: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    created: tuple[float | None, float | None] = (None, None)
    seconds: tuple[int | None, int | None] = (None, None)
    seen_by: str | None = None


@dataclass(frozen=True)
class Job:
    """A job as a client posted it; times in seconds since the epoch.

    Attributes
    ----------
    done : int
        Blocks that have been computed.
    began, done_then : float or None, int
        When the server that works on it took it up, and how many blocks were there then.
    seconds : float
        Time that computing took, summed over all workers.
    problem : mapping or None
        Why it failed: status, kind, title, detail of a problem document.
    owner : str
        Name of the key that it was posted with; empty where none was needed.
    shared : bool
        True if all keys may read the job and its results.
    gone : bool
        Whether its result has made room for others of its owner, or of the service.
    """

    id: str
    key: str
    process: str
    state: str
    cells: int
    blocks: int
    done: int
    created: float
    started: float | None
    finished: float | None
    seconds: float
    problem: Mapping[str, Any] | None
    began: float | None = None
    done_then: int = 0
    owner: str = ""
    shared: bool = False
    gone: bool = False


@dataclass(frozen=True)
class Work:
    """An item of work: what one or more jobs of equal studies need to have computed.

    Attributes
    ----------
    key, process : str
        The study's identifier, and what is carried out.
    block_cells, blocks : int
        Cells of a block, and number of blocks.
    seconds : float
        Computing time so far [s], summed over workers.
    owner : str
        The claim, under which a server holds the lease; empty if no server does.
    asker : str
        Name of the key whose job has waited longest for it.
    price : float
        Expected time of computing it on one core [s].
    """

    key: str
    process: str
    block_cells: int
    blocks: int
    seconds: float
    owner: str
    asker: str = ""
    price: float = 0.0


@dataclass(frozen=True)
class Queue:
    """The items of work: those that wait, those under way, the age of the oldest that waits [s]."""

    waiting: int
    running: int
    oldest: float


JOB = select(
    JOBS,
    func.coalesce(WORK.c.done, 0).label("done"),
    func.coalesce(WORK.c.seconds, 0).label("spent"),
    WORK.c.began,
    func.coalesce(WORK.c.done_then, 0).label("done_then"),
).select_from(JOBS.outerjoin(WORK, WORK.c.key == JOBS.c.key))

# With the owner of the job that has waited longest.
_WORK = select(
    WORK,
    select(JOBS.c.owner)
    .where(JOBS.c.key == WORK.c.key, JOBS.c.state.in_(ACTIVE))
    .order_by(JOBS.c.created)
    .limit(1)
    .correlate(WORK)
    .scalar_subquery()
    .label("asker"),
)


class Ledger:
    """Reads and writes the ledger.

    Parameters
    ----------
    location : Path or str
        The SQLite file, made if missing; or the URL of a database.

    Attributes
    ----------
    database : Database
        Where other tables may stand beside those of jobs.
    """

    def __init__(self, location: Path | str):
        """Use the ledger in an SQLite file, or in a database at a URL."""
        self.database = Database(location)

    def close(self) -> None:
        """Close the database; the next use opens it again."""
        self.database.close()

    def transaction(self) -> AbstractContextManager[Connection]:
        """Run the block in one write transaction; no other process changes the ledger meanwhile.

        Its methods may be called inside, from this thread.
        """
        return self.database.transaction()

    def fault(self) -> str | None:
        """Return the reason why the ledger cannot be read, or None; damage once found stays one."""
        if self.database.is_damaged:
            return f"{DAMAGED}: restore the backup."
        try:
            self._read(select(VERSION))
        except (OSError, sqlite3.Error) as error:
            return f"{cause_of(error)}."
        return None

    def is_empty(self) -> bool:
        """True if it holds no job, key, study or entry of the audit log."""
        entered = or_(
            *(exists().select_from(table) for table in (JOBS, KEYS, OWNED_STUDIES, AUDIT))
        )
        return not self._read(select(entered))[0][0]

    def _read(self, statement: Select[*tuple[Any, ...]]) -> list[Row[*tuple[Any, ...]]]:
        return self.database.read(statement)

    # --- what clients do

    def check_queue(self, places: int, owner: str = "") -> None:
        """Raise `QueueFullError` if the queue is full, or an owner has used its share of it.

        `places` is the size of the queue; `owner` is the name of the API key that posts, empty
        without keys. Each of n owners with work, this one included, has places/(n + 1), at least
        one, so that a new owner finds room.
        """
        if owner:
            query = select(JOBS.c.owner, JOBS.c.key).where(JOBS.c.state.in_(ACTIVE)).distinct()
            active = self._read(query)
            own = sum(study.owner == owner for study in active)
            owners = len({study.owner for study in active} | {owner})
            share = max(1, places // (owners + 1))
            if own >= share:
                raise QueueFullError(
                    f"The share of your key in the queue is full: {own:,} of its studies run "
                    f"or wait, and its share is {share:,} of {places:,} places. Post again when "
                    "one of them is done."
                )
        [(waiting,)] = self._read(select(func.count()).select_from(WORK))
        if waiting >= places:
            raise QueueFullError(
                f"The queue is full: {waiting:,} studies run or wait. Post again when one "
                "of them is done."
            )

    def post(
        self,
        task: Task,
        *,
        finished_seconds: float | None,
        known_seconds: float = 0.0,
        owner: str = "",
    ) -> Job:
        """Enter a job for a study and return it; it is successful at once if its result exists.

        Parameters
        ----------
        task : Task
            The study, and what to carry out.
        finished_seconds : float or None
            Computing time of the result [s] if it exists and the job may use it at once; else None.
        known_seconds : float
            Computing time of an existing result [s] that the job is to find only when it runs.
        owner : str
            Name of the API key that posts it.
        """
        number, now = uuid.uuid4().hex, time.time()
        is_there = finished_seconds is not None
        state, blocks = "successful" if is_there else "accepted", task.blocks
        started = finished = now if is_there else None
        with self.transaction() as database:
            # The order of entry is that of the list, also where the clock has been set back.
            latest = database.execute(select(func.max(JOBS.c.created))).scalar_one()
            created = now if latest is None else max(now, latest + TICK)
            if not is_there:
                query = select(WORK.c.began, WORK.c.blocks).where(WORK.c.key == task.key)
                work = database.execute(query).one_or_none()
                if work is None:
                    database.execute(_new_work(task, known_seconds))
                else:
                    blocks = work.blocks  # it may have been cut when blocks were of another size
                    if work.began is not None:
                        state, started = "running", now
            database.execute(
                JOBS.insert().values(
                    id=number, key=task.key, process=task.process, state=state, cells=task.cells,
                    blocks=blocks,
                    created=created, started=started, finished=finished, seconds=finished_seconds,
                    owner=owner, shared=0, gone=0, done_at_end=None,
                )
            )  # fmt: skip
            job = self.job(number)
        assert job is not None
        return job

    def reenter(self, task: Task) -> None:
        """Queue a study again whose result is lost; its successful jobs become accepted again.

        Nothing happens if no such job is left, or the study is in the queue already.
        """
        with self.transaction() as database:
            waiting = database.execute(
                JOBS.update()
                .where(JOBS.c.key == task.key, JOBS.c.state == "successful", JOBS.c.gone == 0)
                .values(state="accepted", started=None, finished=None, seconds=None)
            )
            is_there = select(WORK.c.key).where(WORK.c.key == task.key)
            # All of them may have been dismissed meanwhile: then nobody waits for it.
            if waiting.rowcount and database.execute(is_there).first() is None:
                database.execute(_new_work(task))

    def job(self, number: str) -> Job | None:
        """Return a job; None if there is no such job."""
        rows = self._read(JOB.where(JOBS.c.id == number))
        return job_of(rows[0]) if rows else None

    def jobs(
        self, wanted: Wanted | None = None, *, limit: int, after: tuple[float, str] | None = None
    ) -> list[Job]:
        """Return `limit` jobs that match a filter, newest first; None matches all jobs.

        `after` is the time of entry and the identifier of a job: the list goes on behind it.
        """
        query = JOB.where(*conditions(wanted or Wanted()))
        if after is not None:
            query = query.where(tuple_(JOBS.c.created, JOBS.c.id) < after)
        latest = query.order_by(JOBS.c.created.desc(), JOBS.c.id.desc())
        return [job_of(row) for row in self._read(latest.limit(limit))]

    def dismiss(self, number: str) -> Job | None:
        """Mark a job as dismissed by its client, and return it; None if there is no such job.

        `number` is the job's identifier. Its item of work, the computation, is removed if no other
        job waits for it; the share that was computed stays in the record of the job.
        """
        with self.transaction() as database:
            query = select(JOBS.c.key, JOBS.c.state).where(JOBS.c.id == number)
            row = database.execute(query).one_or_none()
            if row is None:
                return None
            key, state = row
            # How far a running job came stays in its record.
            progress = select(WORK.c.done.label("done_at_end"), WORK.c.seconds).where(
                WORK.c.key == key
            )
            is_running = state == "running"
            at_end = database.execute(progress).mappings().first() if is_running else None
            database.execute(
                JOBS.update()
                .where(JOBS.c.id == number)
                .values(
                    state="dismissed",
                    finished=func.coalesce(JOBS.c.finished, time.time()),
                    problem=None,
                    **(at_end or {}),
                )
            )
            waiting = select(JOBS.c.id).where(JOBS.c.key == key, JOBS.c.state.in_(ACTIVE))
            database.execute(WORK.delete().where(WORK.c.key == key, ~waiting.exists()))
        return self.job(number)

    def share(self, number: str, shared: bool) -> None:
        """Make a job readable for all keys, or for its owner only."""
        with self.transaction() as database:
            database.execute(JOBS.update().where(JOBS.c.id == number).values(shared=int(shared)))

    def active(self, owner: str) -> int:
        """Return the number of jobs of an owner, the name of an API key, that run or wait."""
        active = select(func.count()).where(JOBS.c.owner == owner, JOBS.c.state.in_(ACTIVE))
        [(count,)] = self._read(active)
        return int(count)

    def counts(self) -> dict[str, int]:
        """Return the number of jobs in each state."""
        rows = self._read(select(JOBS.c.state, func.count()).group_by(JOBS.c.state))
        return dict.fromkeys(STATES, 0) | {row[0]: row[1] for row in rows}

    # --- what servers do

    def waiting(self) -> list[Work]:
        """Return the items of work on which no server has a valid lease, longest waiting first.

        An item is a study that jobs wait for; a lease that has run out counts as none.
        """
        rows = self._read(_WORK.where(_is_free(time.time())).order_by(WORK.c.created))
        return [_work_of(row, "") for row in rows]

    def claim(self, server: str, lease_seconds: float, key: str | None = None) -> Work | None:
        """Take the lease of an item of work for a server, so that no other server computes it.

        An item of work is a study that jobs wait for.

        Parameters
        ----------
        server : str
            Name of the server; the owner of the lease is this name and a random suffix.
        lease_seconds : float
            Time after which the lease runs out unless it is renewed [s].
        key : str, optional
            Identifier of the study; by default the item that has waited longest.

        Returns
        -------
        Work or None
            The item with its owner; None if there is none, or another server holds its lease. Its
            jobs count as running from the first `advance`.
        """
        now, owner = time.time(), f"{server} {uuid.uuid4().hex[:8]}"
        free = _WORK.where(_is_free(now)).order_by(WORK.c.created).limit(1)
        if key is not None:
            free = free.where(WORK.c.key == key)
        with self.transaction() as database:
            row = database.execute(free).one_or_none()
            if row is None:
                return None
            database.execute(
                WORK.update()
                .where(WORK.c.key == row.key)
                .values(owner=owner, lease=now + lease_seconds, began=None, done_then=None)
            )
        return _work_of(row, owner)

    def holds(self, work: Work) -> bool:
        """True if this server still has the lease of an item, and a job still waits for it."""
        return bool(self._read(select(WORK.c.key).where(_claimed(work))))

    def renew(self, work: Work, lease_seconds: float) -> bool:
        """Extend this server's lease of an item of work by `lease_seconds` from now [s].

        True if that succeeded; False if another server has taken the lease over, or no job waits
        for the item any more.
        """
        with self.transaction() as database:
            changed = database.execute(
                WORK.update().where(_claimed(work)).values(lease=time.time() + lease_seconds)
            )
            return changed.rowcount == 1

    def advance(self, work: Work, *, done: int, seconds: float, elapsed: float = 0.0) -> None:
        """Record the number of finished blocks of an item, and the time since the last record.

        The first record of a claim counts the blocks that existed before it, and sets the item's
        jobs to running. Nothing is written if the claim is lost.

        Parameters
        ----------
        work : Work
            The item with its claim.
        done : int
            Number of blocks that are stored.
        seconds : float
            Computing time since the last record [s], summed over workers.
        elapsed : float
            Time since the first block began [s], measured by a monotonic clock.
        """
        now = time.time()
        with self.transaction() as database:
            changed = database.execute(
                WORK.update()
                .where(_claimed(work))
                .values(
                    done=done,
                    seconds=WORK.c.seconds + seconds,
                    began=now - elapsed,
                    done_then=func.coalesce(WORK.c.done_then, done),
                )
            )
            if changed.rowcount:
                database.execute(
                    JOBS.update()
                    .where(JOBS.c.key == work.key, JOBS.c.state == "accepted")
                    .values(state="running", started=now)
                )

    def end(self, work: Work, problem: Mapping[str, Any] | None, bytes_: int) -> None:
        """Remove an item of work whose result is on the disk, or that failed, and end its jobs.

        Nothing happens if this server's claim on the item is lost. `problem` is the problem
        document that says why it failed, or None; `bytes_` is the size of all files of the study.
        """
        now = time.time()
        state = "successful" if problem is None else "failed"
        with self.transaction() as database:
            ended = database.execute(
                WORK.delete().where(_claimed(work)).returning(WORK.c.seconds, WORK.c.done)
            ).one_or_none()
            if ended is not None:
                database.execute(
                    JOBS.update()
                    .where(JOBS.c.key == work.key, JOBS.c.state.in_(ACTIVE))
                    .values(
                        state=state,
                        # A result that was there all along is found in no time.
                        started=func.coalesce(JOBS.c.started, now if problem is None else None),
                        finished=now,
                        seconds=ended.seconds,
                        done_at_end=ended.done,
                        problem=None if problem is None else json.dumps(dict(problem)),
                    )
                )
                database.execute(SIZES.update().where(SIZES.c.key == work.key).values(bytes=bytes_))

    def release(self, owner: str = "") -> None:
        """Release leases of items of work, so that any server may claim these items at once.

        `owner` is the beginning of the owners whose leases are released: the owner of a claim for
        one item, the name of a server for all of its items, or an empty text for all items of all
        servers.
        """
        with self.transaction() as database:
            database.execute(
                WORK.update()
                .where(func.substr(WORK.c.owner, 1, len(owner)) == owner)
                .values(owner=None, lease=0.0)
            )

    def promised(self) -> dict[str, int]:
        """Return the bytes that each unfinished item may take on disk, by study."""
        return {row[0]: row[1] for row in self._read(select(WORK.c.key, WORK.c.bytes))}

    def forget(self, before: float, most: int) -> None:
        """Remove jobs that ended before a time, and all but the latest ended jobs of each owner.

        `before` is in seconds since the epoch; `most` is the number of jobs that each owner keeps.
        """
        latest = func.row_number().over(partition_by=JOBS.c.owner, order_by=JOBS.c.finished.desc())
        ended = select(JOBS.c.id, latest.label("place")).where(JOBS.c.finished.is_not(None))
        numbered = ended.subquery()
        oldest = select(numbered.c.id).where(numbered.c.place > most)
        with self.transaction() as database:
            database.execute(JOBS.delete().where(JOBS.c.finished < before))
            database.execute(JOBS.delete().where(JOBS.c.id.in_(oldest)))

    def queue(self) -> Queue:
        """Return the numbers of studies that wait and run, and the longest waiting time [s]."""
        now = time.time()
        [(total,)] = self._read(select(func.count()).select_from(WORK))
        free = select(func.count(), func.min(WORK.c.created)).where(_is_free(now))
        [(waiting, first)] = self._read(free)
        oldest = 0.0 if first is None else max(0.0, now - first)
        return Queue(waiting, total - waiting, oldest)


def _is_free(now: float) -> ColumnElement[bool]:
    return WORK.c.owner.is_(None) | (WORK.c.lease < now)


def _new_work(task: Task, seconds: float = 0.0) -> Insert:
    """Return the SQL statement that enters an item of work, of which no block is computed."""
    return WORK.insert().values(
        key=task.key, process=task.process, cells=task.cells, block_cells=task.block_cells,
        blocks=task.blocks, bytes=task.bytes, price=task.price, created=time.time(), done=0,
        seconds=seconds, lease=0.0,
    )  # fmt: skip


def _work_of(row: Row[*tuple[Any, ...]], owner: str) -> Work:
    """Return the item of work in a row of the ledger.

    `row` has the columns of the work and `asker`, the owner of the job that has waited longest for
    it. `owner` is the claim under which a server holds the item, empty if none does.
    """
    return Work(
        row.key, row.process, row.block_cells, row.blocks, row.seconds, owner, row.asker or "",
        row.price,
    )  # fmt: skip


def _claimed(work: Work) -> ColumnElement[bool]:
    return (WORK.c.key == work.key) & (WORK.c.owner == work.owner)


def conditions(wanted: Wanted) -> list[ColumnElement[bool]]:
    """Return the SQL conditions of a filter of jobs, all of which a job has to meet.

    A field of `wanted` that is empty or None gives none.
    """
    # What has not begun has no duration.
    seconds = func.coalesce(JOBS.c.finished, time.time()) - JOBS.c.started
    (after, before), (least, most) = wanted.created, wanted.seconds
    clauses: list[ColumnElement[bool]] = []
    if wanted.seen_by is not None:
        clauses.append((JOBS.c.owner == wanted.seen_by) | (JOBS.c.shared == 1))
    if wanted.processes:
        clauses.append(JOBS.c.process.in_(wanted.processes))
    if wanted.states:
        clauses.append(JOBS.c.state.in_(wanted.states))
    # A job is told the millisecond in which it was entered, and is found by it.
    if after is not None:
        clauses.append(JOBS.c.created >= after - TICK / 2)
    if before is not None:
        clauses.append(JOBS.c.created < before + 1e-3 - TICK / 2)
    if least is not None:
        clauses.append(seconds >= least)
    if most is not None:
        clauses.append(seconds <= most)
    return clauses


def job_of(row: Row[*tuple[Any, ...]]) -> Job:
    """Return the job in a row of the ledger: the columns of `JOB`, a job joined with its work."""
    has_ended = row.state not in ACTIVE
    return Job(
        id=row.id,
        key=row.key,
        process=row.process,
        state=row.state,
        cells=row.cells,
        blocks=row.blocks,
        done=_done(row),
        created=row.created,
        started=row.started,
        finished=row.finished,
        # What has not begun has taken nothing, though it may find a result that has.
        seconds=(row.seconds or 0.0) if has_ended else row.spent * (row.state == "running"),
        problem=json.loads(row.problem) if row.problem else None,
        began=None if has_ended else row.began,
        done_then=row.done_then,
        owner=row.owner,
        shared=bool(row.shared),
        gone=bool(row.gone),
    )


def _done(row: Row[*tuple[Any, ...]]) -> int:
    """Return the number of finished blocks of the job in a row; of an ended job, that at its end.

    `row` has the columns of `JOB`, a job joined with its work.
    """
    if row.state == "successful":
        return int(row.blocks)
    if row.state in ACTIVE:
        return int(row.done)
    return int(row.done_at_end or 0)  # work of this study is that of other jobs
