"""The ledger of jobs: an SQLite database that several servers and threads may share.

Every change is one transaction, committed to the disk before the call returns. A *job* is what a
client posted. An *item of work* is what has to be computed, once for all jobs of equal studies; it
exists only until it is done. The server that works on an item holds a lease on it, which it renews;
a lease that has run out may be taken over. Its owner is one claim, not one server: a server that
was late with a lease and claims the item again does not take itself for the first claim.
"""

from __future__ import annotations

import fcntl
import json
import sqlite3
import threading
import time
import uuid
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.jobs.errors import QueueFullError

ACTIVE = ("accepted", "running")
STATES = (*ACTIVE, "successful", "failed", "dismissed")

_SCHEMA = """
CREATE TABLE IF NOT EXISTS work (
    key TEXT PRIMARY KEY,
    process TEXT NOT NULL,
    cells INTEGER NOT NULL,
    block_cells INTEGER NOT NULL,
    blocks INTEGER NOT NULL,
    bytes INTEGER NOT NULL,
    done INTEGER NOT NULL DEFAULT 0,
    seconds REAL NOT NULL DEFAULT 0,
    created REAL NOT NULL,
    began REAL,
    done_then INTEGER,
    owner TEXT,
    lease REAL NOT NULL DEFAULT 0
) STRICT;
CREATE TABLE IF NOT EXISTS jobs (
    id TEXT PRIMARY KEY,
    key TEXT NOT NULL,
    process TEXT NOT NULL,
    state TEXT NOT NULL,
    cells INTEGER NOT NULL,
    blocks INTEGER NOT NULL,
    created REAL NOT NULL,
    started REAL,
    finished REAL,
    seconds REAL,
    problem TEXT
) STRICT;
CREATE INDEX IF NOT EXISTS jobs_by_key ON jobs (key);
CREATE INDEX IF NOT EXISTS jobs_by_time ON jobs (created);
CREATE INDEX IF NOT EXISTS jobs_by_state ON jobs (state);
"""

_JOB = """
SELECT jobs.*, coalesce(work.done, 0) AS done, coalesce(work.seconds, 0) AS spent,
work.began AS began, coalesce(work.done_then, 0) AS done_then
FROM jobs LEFT JOIN work ON work.key = jobs.key
"""

# Times are compared as they are told, to the millisecond. What has not begun has no duration.
_WANTED = """
WHERE (?1 = '[]' OR jobs.process IN (SELECT value FROM json_each(?1)))
AND (?2 = '[]' OR jobs.state IN (SELECT value FROM json_each(?2)))
AND (?3 IS NULL OR CAST(round(jobs.created * 1e6) AS INTEGER) / 1000 >= round(?3 * 1000))
AND (?4 IS NULL OR CAST(round(jobs.created * 1e6) AS INTEGER) / 1000 <= round(?4 * 1000))
AND (?6 IS NULL OR coalesce(jobs.finished, ?5) - jobs.started >= ?6)
AND (?7 IS NULL OR coalesce(jobs.finished, ?5) - jobs.started <= ?7)
"""


@dataclass(frozen=True)
class Wanted:
    """Which jobs a list is to hold; what is empty or None chooses nothing.

    Attributes
    ----------
    processes, states : tuple
        One of these.
    created : pair of float or None
        Entered between these times [s since the epoch].
    seconds : pair of int or None
        Least and longest time from their beginning to their end, or until now.
    """

    processes: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    created: tuple[float | None, float | None] = (None, None)
    seconds: tuple[int | None, int | None] = (None, None)


@dataclass(frozen=True)
class Job:
    """What a client posted; times in seconds since the epoch.

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


@dataclass(frozen=True)
class Work:
    """An item of work that this server holds the lease of.

    Attributes
    ----------
    owner : str
        The claim.
    """

    key: str
    process: str
    block_cells: int
    blocks: int
    seconds: float
    owner: str


class Ledger:
    """Reads and writes the ledger.

    Parameters
    ----------
    path : Path
        The database; made if missing.
    """

    def __init__(self, path: Path):
        self._path = path
        self._lock = threading.RLock()
        self._opened: sqlite3.Connection | None = None

    def close(self) -> None:
        """Close the database; the next use opens it again."""
        with self._lock:
            if self._opened is not None:
                self._opened.close()
                self._opened = None

    def _database(self) -> sqlite3.Connection:
        """Return the connection, made when it is first needed; the lock is held."""
        if self._opened is None:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            database = sqlite3.connect(
                self._path, timeout=30, isolation_level=None, check_same_thread=False
            )
            try:
                database.row_factory = sqlite3.Row
                # Making a new file one for WAL does not wait for another process that does so.
                with self._path.with_name(".ledger.lock").open("ab") as making:
                    fcntl.flock(making, fcntl.LOCK_EX)
                    database.execute("PRAGMA journal_mode = WAL")
                    database.execute("PRAGMA synchronous = FULL")  # on the disk before the reply
                    database.executescript(_SCHEMA)
            except BaseException:
                database.close()
                raise
            self._opened = database
        return self._opened

    @contextmanager
    def transaction(self) -> Iterator[sqlite3.Connection]:
        """Make all that is done inside one transaction: nobody else changes the ledger meanwhile.

        Its methods may be called inside, from this thread.
        """
        with self._lock:
            database = self._database()
            if database.in_transaction:  # that of this thread, or the lock would not be ours
                yield database
                return
            # IMMEDIATE: one that reads before it writes would fail under another writer.
            database.execute("BEGIN IMMEDIATE")
            try:
                yield database
                database.execute("COMMIT")
            except BaseException:
                if database.in_transaction:
                    database.execute("ROLLBACK")
                raise

    def _read(self, statement: str, *values: object) -> list[sqlite3.Row]:
        with self._lock:
            return self._database().execute(statement, values).fetchall()

    # --- what clients do

    def check_queue(self, most: int) -> None:
        """Raise `QueueFullError` if there are so many items of work."""
        [row] = self._read("SELECT count(*) AS waiting FROM work")
        if row["waiting"] >= most:
            raise QueueFullError(
                f"{row['waiting']:,} studies are being carried out or waiting; no more are taken "
                "before one is done."
            )

    def post(
        self,
        key: str,
        process: str,
        *,
        cells: int,
        block_cells: int,
        blocks: int,
        bytes_: int,
        finished_seconds: float | None,
    ) -> Job:
        """Enter a job; one whose result is there already is successful at once.

        Parameters
        ----------
        bytes_ : int
            What its files may take on the disk.
        finished_seconds : float or None
            What computing took, if the result is there.
        """
        number, now = uuid.uuid4().hex, time.time()
        is_there = finished_seconds is not None
        state = "successful" if is_there else "accepted"
        started = finished = now if is_there else None
        with self.transaction() as database:
            if not is_there:
                database.execute(
                    "INSERT INTO work (key, process, cells, block_cells, blocks, bytes, created) "
                    "VALUES (?, ?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING",
                    (key, process, cells, block_cells, blocks, bytes_, now),
                )
                # It may have been cut when blocks were of another size.
                [began, blocks] = database.execute(
                    "SELECT began, blocks FROM work WHERE key = ?", (key,)
                ).fetchone()
                if began is not None:
                    state, started = "running", now
            database.execute(
                "INSERT INTO jobs (id, key, process, state, cells, blocks, created, started, "
                "finished, seconds) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                (number, key, process, state, cells, blocks, now, started, finished,
                 finished_seconds),
            )  # fmt: skip
            job = self.job(number)
        assert job is not None
        return job

    def reenter(
        self, key: str, process: str, *, cells: int, block_cells: int, blocks: int, bytes_: int
    ) -> None:
        """Enter work again whose result is lost; its successful jobs wait for it as at first."""
        with self.transaction() as database:
            database.execute(
                "INSERT INTO work (key, process, cells, block_cells, blocks, bytes, created) "
                "VALUES (?, ?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING",
                (key, process, cells, block_cells, blocks, bytes_, time.time()),
            )
            database.execute(
                "UPDATE jobs SET state = 'accepted', started = NULL, finished = NULL, "
                "seconds = NULL WHERE key = ? AND state = 'successful'",
                (key,),
            )

    def job(self, number: str) -> Job | None:
        """Return a job, or None if there is no such job."""
        rows = self._read(f"{_JOB} WHERE jobs.id = ?", number)
        return _job(rows[0]) if rows else None

    def jobs(self, wanted: Wanted | None = None, *, limit: int, offset: int = 0) -> list[Job]:
        """Return jobs, the latest first."""
        wanted = wanted or Wanted()
        rows = self._read(
            f"{_JOB} {_WANTED} ORDER BY jobs.created DESC, jobs.id LIMIT ?8 OFFSET ?9",
            json.dumps(wanted.processes), json.dumps(wanted.states), *wanted.created,
            time.time(), *wanted.seconds, limit, offset,
        )  # fmt: skip
        return [_job(row) for row in rows]

    def dismiss(self, number: str) -> Job | None:
        """Dismiss a job; work that no other job waits for is given up. None if there is none."""
        with self.transaction() as database:
            row = database.execute("SELECT key FROM jobs WHERE id = ?", (number,)).fetchone()
            if row is None:
                return None
            database.execute(
                "UPDATE jobs SET state = 'dismissed', finished = coalesce(finished, ?), "
                "problem = NULL WHERE id = ?",
                (time.time(), number),
            )
            database.execute(
                "DELETE FROM work WHERE key = ?1 AND NOT EXISTS "
                "(SELECT 1 FROM jobs WHERE key = ?1 AND state IN ('accepted', 'running'))",
                (row["key"],),
            )
        return self.job(number)

    def counts(self) -> dict[str, int]:
        """Return how many jobs there are in each state."""
        rows = self._read("SELECT state, count(*) AS count FROM jobs GROUP BY state")
        return dict.fromkeys(STATES, 0) | {row["state"]: row["count"] for row in rows}

    # --- what servers do

    def waiting(self) -> list[Work]:
        """Return the items of work that are free to be claimed, what has waited longest first."""
        rows = self._read(
            "SELECT key, process, block_cells, blocks, seconds, '' AS owner FROM work "
            "WHERE owner IS NULL OR lease < ? ORDER BY created",
            time.time(),
        )
        return [Work(**row) for row in rows]

    def claim(self, server: str, lease_seconds: float, key: str | None = None) -> Work | None:
        """Take the lease of an item of work; None if it is not free.

        Without a key it is the one that has waited longest. Its jobs run from the first `advance`.
        """
        now, owner = time.time(), f"{server} {uuid.uuid4().hex[:8]}"
        with self.transaction() as database:
            row = database.execute(
                "SELECT * FROM work WHERE (owner IS NULL OR lease < ?1) "
                "AND (?2 IS NULL OR key = ?2) ORDER BY created LIMIT 1",
                (now, key),
            ).fetchone()
            if row is None:
                return None
            database.execute(
                "UPDATE work SET owner = ?, lease = ?, began = NULL, done_then = NULL "
                "WHERE key = ?",
                (owner, now + lease_seconds, row["key"]),
            )
        names = ("key", "process", "block_cells", "blocks", "seconds")
        return Work(**{name: row[name] for name in names}, owner=owner)

    def holds(self, work: Work) -> bool:
        """Return whether a claim still stands: not lost, and the work is still wanted."""
        return bool(
            self._read("SELECT 1 FROM work WHERE key = ? AND owner = ?", work.key, work.owner)
        )

    def renew(self, work: Work, lease_seconds: float) -> bool:
        """Renew a lease; False if it has been lost, or the work is wanted no more."""
        with self.transaction() as database:
            changed = database.execute(
                "UPDATE work SET lease = ? WHERE key = ? AND owner = ?",
                (time.time() + lease_seconds, work.key, work.owner),
            )
            return changed.rowcount == 1

    def advance(self, work: Work, *, done: int, seconds: float, elapsed: float = 0.0) -> None:
        """Note how many blocks are done, and time spent since the last note.

        The first note of a claim tells what is there already; its jobs run from then. `elapsed` is
        the time since, by a clock that nobody sets.
        """
        now = time.time()
        with self.transaction() as database:
            changed = database.execute(
                "UPDATE work SET done = ?1, seconds = seconds + ?2, began = ?3, "
                "done_then = coalesce(done_then, ?1) WHERE key = ?4 AND owner = ?5",
                (done, seconds, now - elapsed, work.key, work.owner),
            )
            if changed.rowcount:
                database.execute(
                    "UPDATE jobs SET state = 'running', started = ? "
                    "WHERE key = ? AND state = 'accepted'",
                    (now, work.key),
                )

    def succeed(self, work: Work) -> None:
        """Note that an item of work is done; its result is on the disk."""
        self._end(work, "successful", None)

    def fail(self, work: Work, problem: Mapping[str, Any]) -> None:
        """Note that an item of work cannot be done, and why."""
        self._end(work, "failed", json.dumps(dict(problem)))

    def _end(self, work: Work, state: str, problem: str | None) -> None:
        with self.transaction() as database:
            row = database.execute(
                "DELETE FROM work WHERE key = ? AND owner = ? RETURNING seconds",
                (work.key, work.owner),
            ).fetchone()
            if row is not None:
                database.execute(
                    "UPDATE jobs SET state = ?, finished = ?, seconds = ?, problem = ? "
                    "WHERE key = ? AND state IN ('accepted', 'running')",
                    (state, time.time(), row["seconds"], problem, work.key),
                )

    def release(self, owner: str = "") -> None:
        """Give up the lease of a claim, of all of a server, or of all: another goes on."""
        with self.transaction() as database:
            database.execute(
                "UPDATE work SET owner = NULL, lease = 0 WHERE substr(owner, 1, length(?1)) = ?1",
                (owner,),
            )

    def promised(self) -> dict[str, int]:
        """Return the keys of all items of work, and the bytes that each may take on the disk."""
        return {row["key"]: row["bytes"] for row in self._read("SELECT key, bytes FROM work")}

    def forget(self, before: float, most: int) -> None:
        """Remove the jobs that were finished before a time, and of the others all but so many."""
        with self.transaction() as database:
            database.execute("DELETE FROM jobs WHERE finished < ?", (before,))
            database.execute(
                "DELETE FROM jobs WHERE id IN (SELECT id FROM jobs WHERE finished IS NOT NULL "
                "ORDER BY finished DESC LIMIT -1 OFFSET ?)",
                (most,),
            )


def _job(row: sqlite3.Row) -> Job:
    over = row["state"] not in ACTIVE
    return Job(
        id=row["id"],
        key=row["key"],
        process=row["process"],
        state=row["state"],
        cells=row["cells"],
        blocks=row["blocks"],
        done=row["blocks"] if row["state"] == "successful" else row["done"],
        created=row["created"],
        started=row["started"],
        finished=row["finished"],
        seconds=(row["seconds"] or 0.0) if over else row["spent"],
        problem=json.loads(row["problem"]) if row["problem"] else None,
        began=None if over else row["began"],
        done_then=row["done_then"],
    )
